"""What a subcommand refuses."""


class UsageError(Exception):
    """A wrong command line or scene; ends with exit code 2."""
