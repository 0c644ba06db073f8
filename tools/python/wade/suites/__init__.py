"""The suites: each runs its programs, keeps what they say, and writes one report.md with its table and figures."""
