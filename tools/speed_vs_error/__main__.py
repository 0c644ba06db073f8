#!/usr/bin/env python3
"""Measures error and cost over the settings of the water; see tools/speed_vs_error.sh.

Needs matplotlib for the plots.
"""

import argparse
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

from machine import machine_of
from measure import Runner, of_seeds
from settings import FACTORS, OTHER_MODELS, QUICK_FACTORS, ROOT, SEEDS, Setting, default_setting
from settings import combinations, near_front, one_at_a_time, probes
from splishsplash import measure_all
from table import ERRORS, error_names, error_of, groups_of, is_default, write_table
from run_folder import end_children_on_signals, exit_code, say, write_whole

# River with agents, dam break, box in a tank, bump, obstacle, standing wave, river, water at rest; each at up to three
# spacings of its case.
CASES = ("impulse_river", "impulse_front", "impulse_lee", "dam_break", "bump_transcritical", "block", "bump_subcritical",
         "spheric2", "sloshing", "uniform_river", "column")
# Two spacings each, or one where the second one alone would take most of the two minutes.
QUICK_CASES = {"impulse_river": 2, "impulse_front": 2, "impulse_lee": 2, "dam_break": 1}


def arguments():
    parser = argparse.ArgumentParser(prog="speed_vs_error.sh", description="Speed against error.")
    parser.add_argument("--validate", required=True, type=lambda name: Path(name).resolve(), help="the program `validate`")
    parser.add_argument("--out", type=Path, default=ROOT / "runs" / "speed_vs_error")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--repeats", type=int)
    parser.add_argument("--cases", help="comma-separated, default: " + ",".join(CASES))
    parser.add_argument("--spacings", type=int, choices=(1, 2, 3), help="how many, from the coarse one")
    parser.add_argument("--time-limit", type=float, default=3600.0)
    parser.add_argument("--splishsplash")
    options = parser.parse_args()
    if options.repeats is None:
        options.repeats = 1 if options.quick else 3
    if options.repeats < 1:
        parser.error(f"--repeats {options.repeats}: allowed: 1 and more")
    if not options.time_limit > 0:
        parser.error(f"--time-limit {options.time_limit:g}: allowed: more than 0 s")
    return options


def listed_cases(program):
    """name -> (spacings, those of them that take hours and are left out)"""
    answer = subprocess.run([program, "--list"], stdout=subprocess.PIPE, text=True, check=True)
    cases = {}
    levels = {"coarse": 0, "medium": 1, "fine": 2}
    for line in answer.stdout.splitlines():
        words = line.split()
        marks = dict(w.split("=") for w in words[1:] if "=" in w)
        spacings = [float(w) for w in words[1:] if "=" not in w]
        short = levels[marks["long"]] if "long" in marks else len(spacings)
        cases[words[0]] = (spacings[:short], spacings[short:])
    return cases


def wanted_cases(options, there):
    """The cases to run; ends the program with 2 if one that was asked for by name cannot be."""
    if options.cases is None:
        return list(QUICK_CASES if options.quick else CASES)
    wanted = options.cases.split(",")
    unknown = [case for case in wanted if case not in there or case not in ERRORS]
    if unknown:
        allowed = ", ".join(case for case in there if case in ERRORS)
        say(f'speed_vs_error.sh: --cases: "{unknown[0]}" is not allowed; allowed: {allowed}', sys.stderr)
        sys.exit(2)
    return wanted


def sweep(runner, case, spacing, factors):
    """One factor at a time around the default, and the other models."""
    points = [runner.run(s, ROOT) for s in one_at_a_time(case, spacing, factors)]
    for model in OTHER_MODELS.get(case, ()):
        setting = Setting(case=case, spacing=spacing, model=model)
        runs = []
        for seed in SEEDS:
            runs.append(runner.run(replace(setting, seed=seed), ROOT))
            if runs[-1].failure:  # which is that of the point
                break
        points.append(of_seeds(setting, runs))
    return points


def compared(points):
    """(setting, cost, error) of those that have the main error of their case."""
    solved = [(p, error_of(p.metrics, ERRORS[p.setting.case][0])) for p in points if p.setting.model == "dfsph"]
    return [(p.setting, p.cpu, error) for p, error in solved if error is not None]


def join(runner, case, spacing, coarser, points):
    """Settings that differ from the default in several factors, and the probes of chance.

    At the coarsest spacing: those that join what alone lies near the front. Finer: those that were on the front there.
    """
    if coarser:
        near = [replace(s, spacing=spacing) for s in near_front(compared(coarser), slack=0)]
    else:
        near = combinations(default_setting(case, spacing), near_front(compared(points)))
    there = {p.setting for p in points}
    more = [s for s in near if s not in there] + probes(case, spacing)
    return [runner.run(s, ROOT) for s in more]


def seconds_expected(points, spacing):
    """Of the default at a finer spacing: the particles grow with d^-3, the steps with 1/d."""
    default = next((p for p in points if is_default(p.setting) and not p.failure), None)
    return 0 if default is None else default.run_time * (default.setting.spacing / spacing) ** 4


def main():
    options = arguments()
    end_children_on_signals()
    try:
        sweep_all(options)
    except KeyboardInterrupt as interrupt:  # what was measured is in the table but for the spacing it was at
        say("interrupted; the same command goes on from here", sys.stderr)
        return exit_code(interrupt)
    return 0


def sweep_all(options):
    there = listed_cases(options.validate)
    factors = QUICK_FACTORS if options.quick else FACTORS
    wanted = wanted_cases(options, there)
    remarks = []
    measured = []
    options.out.mkdir(parents=True, exist_ok=True)
    runner = Runner(options.validate, options.out / "points", options.repeats, options.time_limit)
    for case in wanted:
        if case not in there or case not in ERRORS:
            remarks.append(f"Case {case} is not in this version of `validate` and was left out.")
            continue
        spacings, too_long = there[case]
        count = options.spacings or (QUICK_CASES.get(case, 1) if options.quick else 3)
        if too_long and count > len(spacings):
            remarks.append(f"{case}: spacings {', '.join(f'{d:g} m' for d in too_long)} take hours and were left out.")
        coarser = []
        for spacing in spacings[:count]:
            expected = seconds_expected(coarser, spacing)
            if expected > options.time_limit:
                remarks.append(f"{case}: {spacing:g} m was left out; a run of the default would take about {expected:.0f} s "
                               f"of CPU time (--time-limit {options.time_limit:g}).")
                break
            points = sweep(runner, case, spacing, factors)
            if not options.quick:
                points += join(runner, case, spacing, coarser, points)
            measured += points
            coarser = points
            write_results(options, measured, remarks)
        if not any(error_names(case, p.metrics) for p in measured if p.setting.case == case and p.metrics):
            remarks.append(f"{case}: its runs report no error; an impulse case needs its reference in tests/validation/data.")
    if options.splishsplash:
        crowd_client = options.validate.parent / "crowd_client"
        spacings = sorted({p.setting.spacing for p in measured if p.setting.case == "impulse_front"}, reverse=True)
        if not spacings:
            remarks.append("SPlisHSPlasH is compared in impulse_front only, which was not asked for.")
        folder = options.out / "splishsplash"
        points, more = measure_all(options.splishsplash, crowd_client, spacings, options.repeats, folder)
        measured += points
        remarks += more
    write_results(options, measured, remarks)
    say(options.out / "report.md")


def write_results(options, measured, remarks):
    """After each spacing, so that a sweep that is cut short leaves what it has."""
    from plots import has_plot, plot, plot_name
    from report import report_text

    groups = groups_of(measured)
    write_table(options.out / "speed_vs_error.csv", groups)
    for group in filter(has_plot, groups):
        plot(group, options.out / plot_name(group))
    text = report_text(groups, machine_of(), remarks, options.quick)
    write_whole(options.out / "report.md", text)


if __name__ == "__main__":
    sys.exit(main())
