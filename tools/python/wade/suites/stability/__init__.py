"""Runs each hard case (configs/stability) with each solver setting, and sweeps CFL factor and tolerance in three of them.

A complete run of the same program and scenes is not repeated. Exit code 1:
a run left no result, or one at one of the settings breaks a rule and is not a known failure
(tests/stability/known_failures.csv); the sweeps look for what breaks and do not count. 2: wrong
options; 130, 143: interrupted.
"""

import subprocess

from wade.paths import BUILD, ROOT
from wade.reports import options
from wade.reports.files import complain, publish, say
from wade.reports.jobs import Fingerprints, Job, do_all, read_result
from wade.suites.stability import report, results

INPUTS = ("configs/stability/*.json", "tests/stability/scenes.json", "configs/scene.schema.json")


def parse(arguments):
    parser = options.parser_of("stability", "stability", __doc__, "stability.csv")
    options.add_jobs(parser)
    parser.add_argument("--settings", metavar="S,T", help="only these, for example default,cfl_1; without sweeps")
    parser.add_argument("--long", action="store_true", help="a million steps in the case `leak`")
    chosen = parser.parse_args(arguments)
    if chosen.quick and chosen.long:
        parser.error("--quick and --long: allowed: one of them")
    return chosen


def job_of(case, name, form, folder, fingerprint):
    """Each form has a folder of its own, so that none replaces another."""
    program = BUILD / "stability"
    command = [program, "--case", case.name, "--setting", name, "--threads", "1", "--out", folder, "--fingerprint",
               fingerprint]
    command += [] if form == "full" else [f"--{form}"]
    if name == "default" and not (form == "long" and case.name == "leak"):
        command += ["--compare-threads", "2"]
    command += [word for override in results.overrides_of(name) for word in ("--set", override)]
    return Job(f"{case.name} ({name})", tuple(command), folder / f"{case.name}-{name}.json", fingerprint, fine=(0, 1))


def main(arguments):
    chosen = parse(arguments)
    program = BUILD / "stability"
    lines = subprocess.run([program, "--list"], check=True, capture_output=True, text=True).stdout.splitlines()
    cases = [results.Case(line) for line in lines if line]
    if chosen.list:
        for case in cases:
            say(f"{case.name}: {case.trouble}{'' if case.varied else '; at the default settings only'}")
        say("settings: " + ", ".join(results.SETTINGS))
        return 0
    try:
        cases = options.choose(cases, chosen.cases)
        plan = results.plan(cases, chosen.settings, chosen.quick)
    except ValueError as error:
        complain(f"stability: {error}")
        return 2
    form = "quick" if chosen.quick else "long" if chosen.long else "full"
    fingerprint = Fingerprints([program], ROOT, INPUTS, [form])()
    jobs = [job_of(case, name, form, chosen.out / "runs" / form, fingerprint) for case, name in plan]
    interrupted = do_all(jobs, chosen.jobs, chosen.again)
    known = results.read_known_failures(ROOT / "tests" / "stability" / "known_failures.csv")
    found = {}  # a run without result of this program is left out
    for (case, name), job in zip(plan, jobs):
        if (run := read_result(job.result)) and run["fingerprint"] == fingerprint:
            results.judge(run, known)
            found[case.name, name] = run
    results.write_table(found, chosen.out / "stability.csv")
    report.write(cases, found, known, form, fingerprint, chosen.out)
    say(f"report: {chosen.out / 'report.md'}, table: {chosen.out / 'stability.csv'}")
    if chosen.publish:
        publish(chosen.out, "stability", "stability.csv")
    return interrupted or results.print_summary(plan, found, known)
