"""What stands behind tools/wade: runs, pictures, suites and reports."""


class UsageError(Exception):
    """A wrong command line or scene; ends with exit code 2."""
