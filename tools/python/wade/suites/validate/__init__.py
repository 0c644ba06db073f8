"""Runs each case of the water at its coarse, medium and fine resolution and compares it with what is known.

The truths are analytic solutions, published experiments and tables. report.md has the observed
order of convergence and a plot of the dam break, DIR/runs/ the numbers and curves of each run. The
cases of the crowd, crowd_*, are those of verify-crowd, and run here if --cases names them. A
complete run of the same program and scenes is not repeated, so that the command goes
on where it was stopped; a commit repeats runs only if it changes what is computed. With --quick a
case runs at one resolution, as the tests run it. Give runs with --set a folder of their own: runs of
other settings count as those of another version.

WADE_SPHERIC2_DATA names a folder with spheric_test2_50Hz_boxavg.csv, the measured series of SPHERIC
test 2, for the case spheric2 instead of a short table. Exit code 1: a run failed, or a value is above
its threshold and no known failure (tests/validation/known_failures.csv); 2: wrong options; 130, 143:
interrupted.
"""

import os
from pathlib import Path

from wade.paths import BUILD, ROOT
from wade.reports import options
from wade.reports.files import complain, publish, say
from wade.reports.jobs import Fingerprints, Job, do_all
from wade.suites import cases as known_cases
from wade.suites.validate import report, results

TABLES = ROOT / "tests" / "validation"


class Suite:
    """Validation cases that make one report: the water's, or the crowd's.

    folder: below runs/ and docs/reports/, and the name of the table; text: of --help; has: whether a case, by its name, is
    run unless --cases says otherwise; head: of the report; front: of (runs, judge), a section before the verdicts.
    """

    def __init__(self, command, folder, text, has, head, front=lambda runs, judge: ""):
        self.command, self.folder, self.text, self.has = command, folder, text, has
        self.head, self.front, self.table = head, front, f"{folder}.csv"


def is_of_people(name):
    return name.startswith("crowd_")


WATER = Suite("validate", "validation", __doc__, lambda name: not is_of_people(name), report.HEAD)


def parse(arguments, suite):
    parser = options.parser_of(suite.command, suite.folder, suite.text, suite.table)
    options.add_jobs(parser)
    parser.set_defaults(jobs=None)
    parser.add_argument("--levels", metavar="L,M", help="only these of coarse, medium and fine")
    parser.add_argument("--long", action="store_true", help="also what takes hours, as --list says")
    parser.add_argument("--threads", type=options.whole(1, 1024), default=1, metavar="N",
                        help="of each run [1]; results have the same bits for any number")
    parser.add_argument("--set", action="append", default=[], dest="settings", metavar="/POINTER=VALUE",
                        help="a value of all scenes, for example /fluid/kernel=quartic_spline")
    parser.add_argument("--beside", type=Path, metavar="DIR",
                        help="hold errors and costs against those in DIR, an --out with other settings")
    chosen = parser.parse_args(arguments)
    if chosen.beside and not (chosen.beside / "runs").is_dir():
        parser.error(f"--beside {chosen.beside}: has no runs; allowed: an --out of this command")
    return chosen


def job_of(case, level, chosen, fingerprint):
    command = [BUILD / "validate", "--case", case.name, "--level", level, "--threads", chosen.threads, "--out",
               chosen.out]
    starts = 1 if chosen.quick else case.starts_at(level)
    fingerprint = report.stamp(fingerprint, starts)
    command += ["--starts", str(starts), "--fingerprint", fingerprint]
    command += [word for setting in chosen.settings for word in ("--set", setting)]
    result = chosen.out / "runs" / f"{case.name}-{level}.json"
    return Job(f"{case.name} {level}", tuple(command), result, fingerprint, chosen.threads)


def main(arguments, suite=WATER):
    chosen = parse(arguments, suite)
    everything = known_cases.list_cases(BUILD / "validate")
    cases = everything if chosen.cases else [case for case in everything if suite.has(case.name)]
    if chosen.list:
        say("\n".join(case.describe() for case in cases))
        return 0
    try:
        plan = known_cases.plan(cases, chosen.cases, chosen.levels, chosen.quick, chosen.long)
    except ValueError as error:
        complain(f"{suite.command}: {error}")
        return 2
    fingerprint_of = Fingerprints([BUILD / "validate"], ROOT, known_cases.INPUTS, chosen.settings)
    jobs = [job_of(case, level, chosen, fingerprint_of(case.name)) for case, level in plan]
    interrupted = do_all(jobs, chosen.jobs or max(1, (os.cpu_count() or 1) // chosen.threads), chosen.again)

    judge = results.Judge(TABLES / "thresholds.csv", TABLES / "known_failures.csv")
    # What older programs found stays in the report, marked, until it is repeated.
    found = results.read_runs(chosen.out / "runs", everything)
    results.write_table(found, judge, chosen.out / suite.table)
    held_against = report.beside_text(found, chosen.beside, everything, judge) if chosen.beside else ""
    ran = {run["case"] for run in found}
    shown = [case for case in everything if case.name in ran or suite.has(case.name)]
    report.write(found, shown, judge, fingerprint_of, chosen.out,
                 chosen.settings, held_against, suite.head, suite.front(found, judge))
    say(f"report: {chosen.out / 'report.md'}, table: {chosen.out / suite.table}")
    if chosen.publish:
        publish(chosen.out, suite.folder, suite.table)
    return interrupted or results.print_summary(plan, found, judge)
