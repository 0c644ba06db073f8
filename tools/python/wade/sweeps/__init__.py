"""One scene at many settings."""
