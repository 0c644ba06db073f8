"""Sets the error of each setting of the water beside what it costs, in cases of the validation suite.

Cases, among them the impulse of the water on people, at three spacings and with other tolerances
of both solves, fewest iterations, CFL numbers, kernels and numbers of threads: one at a time around
the default, then joined where each alone lies near the front. report.md says "for an error below x
choose this", with a plot of error over CPU time a case. Takes hours; a run that is there, of the
same program and scenes, is not repeated. --quick: two spacings, few settings, one run each.
"""

import os
import sys
from dataclasses import replace

from wade import progress
from wade.paths import BUILD, ROOT
from wade.reports import options
from wade.reports.files import complain, publish, say
from wade.reports.jobs import Fingerprints, exit_code
from wade.suites import cases as known_cases
from wade.suites.speed_vs_error import report
from wade.suites.speed_vs_error.measure import Runner, make_reference, of_seeds
from wade.suites.speed_vs_error.settings import (FACTORS, OTHER_MODELS, QUICK_FACTORS, SEEDS, Setting, combinations,
                                                 default_setting, near_front, one_at_a_time, probes)
from wade.suites.speed_vs_error.table import ERRORS, error_names, error_of, groups_of, is_default, write_table

# River with agents, dam break, box in a tank, bump, obstacle, standing wave, river, water at rest; each at up to three
# spacings of its case.
CASES = ("impulse_river", "impulse_front", "impulse_lee", "dam_break", "bump_transcritical", "block",
         "bump_subcritical", "spheric2", "sloshing", "uniform_river", "column")
# Two spacings each, or one where the second one alone would take most of the two minutes.
QUICK_CASES = {"impulse_river": 2, "impulse_front": 2, "impulse_lee": 2, "dam_break": 1}


def parse(arguments):
    parser = options.parser_of("speed-vs-error", "speed_vs_error", __doc__, "speed_vs_error.csv")
    parser.add_argument("--cases", metavar="A,B", help="only these [" + ", ".join(CASES) + "]")
    parser.add_argument("--spacings", type=options.whole(1, 3), metavar="N",
                        help="only the N coarsest spacings of a case [3]")
    parser.add_argument("--repeats", type=options.whole(1), metavar="N",
                        help="runs of each point; its cost is their median [3, quick: 1]")
    parser.add_argument("--time-limit", type=options.above_0, default=3600.0, metavar="S",
                        help="wall time after which a run is given up, s [3600]; a larger limit tries it again, and a "
                        "spacing whose default is expected to take more CPU time is left out and named")
    parser.add_argument("--reference", metavar="CASE",
                        help="only make the reference of an impulse case, at --spacing: what "
                        "each agent met in a fine run, tests/validation/data/CASE_standing.csv and _walking.csv")
    parser.add_argument("--spacing", metavar="D", help="of --reference, m")
    parser.add_argument("--threads", type=options.whole(1), default=os.cpu_count(), metavar="N", help="of --reference")
    parser.add_argument("--splishsplash", metavar="PROGRAM",
                        help="instead, both engines in turns on the cases of tests/validation/beside_cases.py: the bridge of "
                        "tools/splishsplash, linked; report, plot and table in DIR/beside_splishsplash")
    chosen = parser.parse_args(arguments)
    if bool(chosen.reference) != bool(chosen.spacing):
        parser.error("--reference and --spacing need one another")
    chosen.repeats = chosen.repeats or (1 if chosen.quick else 3)
    return chosen


def wanted_cases(chosen, there):
    """The cases to run. ValueError if one that was asked for by name cannot be."""
    if chosen.cases is None:
        return list(QUICK_CASES if chosen.quick else CASES)
    wanted = chosen.cases.split(",")
    for case in wanted:
        if case not in there or case not in ERRORS:
            raise ValueError(f'--cases: "{case}" is not allowed; allowed: {", ".join(c for c in there if c in ERRORS)}')
    return wanted


def sweep(runner, case, spacing, factors):
    """One factor at a time around the default, and the other models."""
    words = f"measures {case} with {spacing:g} m"
    points = [runner.run(setting) for setting in progress.over(list(one_at_a_time(case, spacing, factors)), words)]
    for model in OTHER_MODELS.get(case, ()):
        setting = Setting(case=case, spacing=spacing, model=model)
        runs = []
        for seed in SEEDS:
            runs.append(runner.run(replace(setting, seed=seed)))
            if runs[-1].failure:  # which is that of the point
                break
        points.append(of_seeds(setting, runs))
    return points


def compared(points):
    """Returns (setting, cost, error) of the dfsph points that have the main error of their case."""
    solved = [(p, error_of(p.metrics, ERRORS[p.setting.case][0])) for p in points if p.setting.model == "dfsph"]
    return [(p.setting, p.cpu, error) for p, error in solved if error is not None]


def join(runner, case, spacing, coarser, points):
    """Settings that differ from the default in several factors, and the probes of chance.

    At the coarsest spacing: those that join what alone lies near the front. Finer: those that were on the front there.
    """
    if coarser:
        near = [replace(setting, spacing=spacing) for setting in near_front(compared(coarser), slack=0)]
    else:
        near = combinations(default_setting(case, spacing), near_front(compared(points)))
    there = {p.setting for p in points}
    more = [s for s in near if s not in there] + probes(case, spacing)
    return [runner.run(s) for s in progress.over(more, f"measures {case} with {spacing:g} m near the best")]


def seconds_expected(points, spacing):
    """Of the default at a finer spacing: the particles grow with d^-3, the steps with 1/d."""
    default = next((p for p in points if is_default(p.setting) and not p.failure), None)
    return 0 if default is None else default.run_time * (default.setting.spacing / spacing) ** 4


def sweep_case(case, chosen, runner, measured, remarks):
    """Measures a case at its spacings, coarse to fine; writes after each, so that a sweep cut short leaves what it has."""
    count = chosen.spacings or (QUICK_CASES.get(case.name, 1) if chosen.quick else 3)
    spacings, too_long = case.spacings[: case.long_from], case.spacings[case.long_from :]
    if too_long and count > len(spacings):
        remarks.append(f"{case.name}: spacings {', '.join(f'{d:g} m' for d in too_long)} take hours and were left out.")
    coarser = []
    for spacing in spacings[:count]:
        expected = seconds_expected(coarser, spacing)
        if expected > chosen.time_limit:
            remarks.append(f"{case.name}: {spacing:g} m was left out; a run of the default would take about {expected:.0f} s "
                           f"of CPU time (--time-limit {chosen.time_limit:g}).")
            break
        points = sweep(runner, case.name, spacing, QUICK_FACTORS if chosen.quick else FACTORS)
        points += [] if chosen.quick else join(runner, case.name, spacing, coarser, points)
        measured += points
        coarser = points
        write_results(chosen, measured, remarks)
    if not any(error_names(case.name, p.metrics) for p in measured if p.setting.case == case.name and p.metrics):
        remarks.append(f"{case.name}: its runs report no error; an impulse case needs its reference in tests/validation/data.")


def write_results(chosen, measured, remarks):
    groups = groups_of(measured)
    write_table(chosen.out / "speed_vs_error.csv", groups)
    report.write(chosen.out, groups, remarks, chosen.quick)


def main(arguments):
    chosen = parse(arguments)
    if chosen.splishsplash:
        sys.path.append(str(ROOT / "tests" / "validation"))  # its cases stand beside the truths
        from wade.suites.speed_vs_error import beside_splishsplash
        return beside_splishsplash.main(chosen)
    program = BUILD / "validate"
    there = {case.name: case for case in known_cases.list_cases(program)}
    try:
        if chosen.reference:
            return make_reference(program, chosen.reference, chosen.spacing, chosen.threads)
        wanted = wanted_cases(chosen, there)
        fingerprint_of = Fingerprints([program], ROOT, known_cases.INPUTS)
        runner = Runner(program, chosen.out / "points", fingerprint_of, chosen.repeats, chosen.time_limit)
        measured, remarks = [], []
        for case in wanted:
            sweep_case(there[case], chosen, runner, measured, remarks)
        write_results(chosen, measured, remarks)
    except ValueError as error:
        complain(f"speed-vs-error: {error}")
        return 2
    except KeyboardInterrupt as interrupt:  # what was measured is in the table but for the spacing it was at
        return exit_code(interrupt)
    say(chosen.out / "report.md")
    if chosen.publish:
        report.carry_over(chosen.out)
        publish(chosen.out, "speed_vs_error", "speed_vs_error.csv")
    return 0
