"""What stands behind tools/wade: runs, pictures, suites and reports."""
