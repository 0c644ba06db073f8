#!/usr/bin/env python3
"""Runs hard cases side by side and writes their table and report; tools/stability.sh calls it."""

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "tools" / "validation"))  # for run_folder

import report  # noqa: E402
import results  # noqa: E402
import run_folder  # noqa: E402
import runs  # noqa: E402
import settings  # noqa: E402


def read_arguments():
    parser = run_folder.suite_arguments("stability.sh", "stability", "--cases", "--settings")
    arguments = parser.parse_args()
    if arguments.quick and arguments.long:
        parser.error("--quick and --long: allowed: one of them")
    return arguments


def main():
    arguments = read_arguments()
    run_folder.end_children_on_signals()
    cases = runs.list_cases(arguments.program)
    if arguments.list:
        for case in cases:
            run_folder.say(f"{case.name}: {case.trouble}{'' if case.varied else '; at the default settings only'}")
        run_folder.say("settings: " + ", ".join(settings.SETTINGS))
        return 0
    try:
        chosen = runs.choose(cases, arguments.cases)
        plan = runs.plan(chosen, arguments.settings, arguments.quick)
    except ValueError as error:
        print(f"stability.sh: {error}", file=sys.stderr)
        return 2
    form = "quick" if arguments.quick else "long" if arguments.long else "full"
    fingerprint = runs.fingerprint(arguments.program, ROOT, form)
    runner = runs.Runner(arguments.program, arguments.out / "runs", fingerprint, form, run_folder.Children())
    interrupted = runs.run_all(plan, runner, arguments.jobs, arguments.again)
    known = results.read_known_failures(ROOT / "tests" / "stability" / "known_failures.csv")
    found = results.read_runs(runner, plan, known)
    results.write_csv(found, arguments.out / "stability.csv")
    report.write(chosen, found, known, form, fingerprint, arguments.out)
    run_folder.say(f"report: {arguments.out / 'report.md'}, table: {arguments.out / 'stability.csv'}")
    return interrupted or results.print_summary(plan, found, known)


if __name__ == "__main__":
    sys.exit(main())
