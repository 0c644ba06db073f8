"""Pictures of run folders."""
