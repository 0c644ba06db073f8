"""Options that all suites share: --out, --publish, and checks of allowed values."""

import argparse
import fnmatch
import os
from pathlib import Path

from wade.paths import RUNS
from wade.terminal import Parser


def parser_of(command, suite, text, table):
    """The parser of a suite: --out, --quick, --publish; `text` ends its --help.

    table: name of its CSV, which --publish puts beside the report.
    """
    parser = Parser(command, text.partition("\n\n")[0], text.partition("\n\n")[2])
    parser.epilog += "\n\nThe columns of the table: docs/reports/README.md."
    parser.add_argument("--out", type=lambda name: Path(name).resolve(), default=RUNS / suite, metavar="DIR",
                        help=f"folder of runs, report.md and {table} [runs/{suite}]")
    parser.add_argument("--quick", action="store_true", help="the short form")
    parser.add_argument("--publish", action="store_true",
                        help=f"put report, table and figures into docs/reports/{suite}")
    return parser


def add_cases(parser):
    parser.add_argument("--cases", metavar="A,B", help="only these; patterns such as 'wet_bed*' may stand for several")


def add_jobs(parser):
    add_cases(parser)
    parser.add_argument("--jobs", type=whole(1, 1024), default=os.cpu_count() or 1, metavar="N",
                        help="runs side by side [processors]")
    parser.add_argument("--again", action="store_true", help="repeat runs that are complete")
    parser.add_argument("--list", action="store_true", help="list what there is, and end")


def whole(low, high=None):
    """A type of whole numbers in a range."""

    def read(text):
        if not text.isdecimal() or int(text) < low or (high is not None and int(text) > high):
            allowed = f"{low} to {high}" if high is not None else f"whole numbers from {low}"
            raise argparse.ArgumentTypeError(f'"{text}" is out of range; allowed: {allowed}')
        return int(text)

    return read


def above_0(text):
    """A type of numbers above 0."""
    try:
        value = float(text)
    except ValueError:
        value = 0
    if not value > 0:
        raise argparse.ArgumentTypeError(f'"{text}" is out of range; allowed: numbers above 0')
    return value


def some_of(allowed):
    """A type of lists separated by commas, of words that are allowed."""

    def read(text):
        words = [word.strip() for word in text.split(",") if word.strip()]
        unknown = [word for word in words if word not in allowed]
        if unknown or not words:
            raise argparse.ArgumentTypeError(f'"{(unknown or [text])[0]}" is not allowed; allowed: {", ".join(allowed)}')
        return words

    return read


def patterns_of(text):
    return [pattern.strip() for pattern in text.split(",")] if text else []


def choose(cases, patterns, option="--cases"):
    """The cases, which have a name, that go by patterns as 'wet_bed*'; all of them without a pattern."""
    wanted = patterns_of(patterns)
    for pattern in wanted:
        if not any(fnmatch.fnmatchcase(case.name, pattern) for case in cases):
            raise ValueError(f"{option} {pattern}: no such case; allowed: {', '.join(case.name for case in cases)}")
    return [case for case in cases if not wanted or any(fnmatch.fnmatchcase(case.name, p) for p in wanted)]
