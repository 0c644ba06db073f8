#!/usr/bin/env python3
"""Runs validation cases side by side and writes their table and report; tools/validate.sh calls it."""

import os
import sys
from pathlib import Path

import beside
import report
import results
import run_folder
import runs

ROOT = Path(__file__).resolve().parents[2]


def main():
    parser = run_folder.suite_arguments("validate.sh", "validation", "--cases", "--levels")
    parser.add_argument("--threads", type=run_folder.processors, default=1)
    parser.add_argument("--set", action="append", default=[], dest="settings")
    parser.add_argument("--beside", type=Path)
    parser.set_defaults(jobs=None)
    arguments = parser.parse_args()
    if arguments.beside and not (arguments.beside / "runs").is_dir():
        print(f"validate.sh: --beside {arguments.beside}: has no runs; allowed: an --out of this command", file=sys.stderr)
        return 2
    jobs = arguments.jobs or max(1, (os.cpu_count() or 1) // arguments.threads)
    run_folder.end_children_on_signals()
    try:
        cases = runs.list_cases(arguments.program)
        if arguments.list:
            for case in cases:
                run_folder.say(case.describe())
            return 0
        plan = runs.plan(cases, arguments.cases, arguments.levels, arguments.quick, arguments.long)
    except ValueError as error:
        print(f"validate.sh: {error}", file=sys.stderr)
        return 2
    runs.tell_left_out(arguments.cases, plan)
    fingerprint_of = runs.Fingerprints(arguments.program, ROOT, arguments.settings)
    arguments.out.mkdir(parents=True, exist_ok=True)
    runner = runs.Runner(arguments.program, arguments.out, fingerprint_of, run_folder.Children(), arguments.threads)
    runner.settings = arguments.settings
    interrupted = runs.run_all(plan, runner, jobs, arguments.again)

    tables = ROOT / "tests" / "validation"
    judge = results.Judge(tables / "thresholds.csv", tables / "known_failures.csv")
    # What older programs found stays in the report, marked, until it is repeated.
    found = results.read_runs(arguments.out / "runs", cases)
    results.write_csv(found, judge, arguments.out / "validation.csv")
    held_against = beside.section(found, arguments.beside, cases, judge) if arguments.beside else []
    report.write(found, cases, judge, fingerprint_of, arguments.out, arguments.settings, held_against)
    run_folder.say(f"report: {arguments.out / 'report.md'}, table: {arguments.out / 'validation.csv'}")
    if interrupted:
        return interrupted
    return results.print_summary(plan, found, judge)


if __name__ == "__main__":
    sys.exit(main())
