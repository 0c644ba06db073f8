"""What all suites share: files, tables, plots, intervals, the machine, and runs that are kept and continued."""
