"""The checks of the shared-memory contract, turned on any producer: a second consumer in plain Python."""
