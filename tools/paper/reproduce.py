#!/usr/bin/env python3
"""Runs the scenarios of the paper with many seeds and writes the report beside it.

tools/reproduce_paper.sh calls it once the programs are built.
"""

import argparse
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

import bands  # noqa: E402
import block  # noqa: E402
import causes  # noqa: E402
import frame  # noqa: E402
import losses  # noqa: E402
import plan  # noqa: E402
import plane  # noqa: E402
import plots  # noqa: E402
import report  # noqa: E402
import studies  # noqa: E402
import summary  # noqa: E402
from ensembles import Ensembles, PlanError, Programs  # noqa: E402
from pair_processes import Pair  # noqa: E402
from pictures import case_of, draw_figures, draw_runs, lee_of  # noqa: E402
from scatter import scatter_section  # noqa: E402
from store import Store, StoreError  # noqa: E402
from table1 import COLUMNS, Result, read_paper, table_row, write_table  # noqa: E402
from verdict import checks_of, verdict_text  # noqa: E402
from words import SET_UPS  # noqa: E402

SETS_OF = {"both": ("paper", "river"), "all": plan.SETS, **{name: (name,) for name in plan.SETS}}
QUICK_SETS = ("observed", "paper", "river")  # what --quick takes where nothing is asked for: the others need an hour
WIDE_PARTS = ("phase", "depth", "push", "rules", "readings", "variations")  # many cases: half of the seeds each


def part_list(text):
    parts = [part for part in text.split(",") if part]
    for part in parts:
        if part not in plan.PARTS:
            raise argparse.ArgumentTypeError(f'"{part}" is not allowed; allowed: {", ".join(plan.PARTS)}')
    return parts


def positive(text):
    if not text.isdigit() or int(text) < 1:
        raise argparse.ArgumentTypeError(f'"{text}" is out of range; allowed: whole numbers from 1')
    return int(text)


def parse(arguments):
    parser = argparse.ArgumentParser(prog="reproduce_paper.sh", usage="reproduce_paper.sh --help", allow_abbrev=False)
    parser.add_argument("--programs", type=Path, required=True)
    parser.add_argument("--out", type=Path, default=ROOT / "runs" / "reproduce_paper")
    parser.add_argument("--seeds", type=positive)
    parser.add_argument("--max-seeds", type=positive)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--parts", type=part_list)
    parser.add_argument("--set-of-scenes", choices=tuple(SETS_OF))
    parser.add_argument("--threads", type=positive, default=2)
    parser.add_argument("--until-s", type=float)
    parser.add_argument("--keep-all", action="store_true")
    parser.add_argument("--report-only", action="store_true")
    options = parser.parse_args(arguments)
    options.seeds = options.seeds or (1 if options.quick else 10)
    options.parts = options.parts or (["table1"] if options.quick else list(plan.PARTS))
    options.sets = SETS_OF[options.set_of_scenes] if options.set_of_scenes else QUICK_SETS if options.quick else plan.SETS
    return options


def most_seeds(options, case):
    """Up to three times the seeds where the water costs little; else one run of the fluid unless more are asked for."""
    if options.max_seeds:
        return max(options.max_seeds, options.seeds)
    rounds = 3 if case.water.set in plan.KINEMATIC and options.seeds > 1 else 1
    return options.seeds * rounds


def wanted_cases(options):
    """{case: (seeds of a round, most seeds)} of all parts, the cheap set first; what several parts need is run once."""
    wanted = {}
    for scene_set in sorted(options.sets, key=plan.SETS.index):
        for part in options.parts:
            for case in plan.cases_of(part, options.sets, options.quick):
                if case.water.set != scene_set:
                    continue
                half = max(1, options.seeds // 2)
                counts = (half, half) if part in WIDE_PARTS else (options.seeds, most_seeds(options, case))
                wanted[case] = max(counts, wanted.get(case, counts))
    return wanted


def wants_plane(options):
    """The sweep over depth and v_F; of runs that are cut short it would say nothing."""
    return "plane" in options.parts and "observed" in options.sets and options.until_s is None


def rows_of(context, cases):
    """Rows for table1.csv of cases that are scenarios of Table 1, with the commits of the programs."""
    rows = []
    for case in cases:
        result = context.get(case)
        scenario = case.name.split("-")[0].upper()
        if result is None or scenario not in plan.SCENARIOS:
            continue
        plain = case == plan.scenario_case(case.water.set, scenario)
        in_band = bands.judge_scenario(scenario, result).holds if plain else None
        base = context.scenario(case.water.set, "S1")
        time = base.time[0] if base and base.time else None
        row = table_row(case.water.set, scenario, result, context.paper[scenario], time, in_band)
        rows.append({**row, "commits": " ".join(result.commits)})
    return rows


def write_report(options, ensembles, wanted, paper, drawn):
    results = {key: Result(runs) for key, runs in ensembles.runs.items()}
    sets = [scene_set for scene_set in options.sets if any(key.startswith(f"{scene_set}/") for key in results)]
    obstacles = {scene_set: case_of(scene_set, "obstacle") for scene_set in sets}
    lee = {scene_set: lee_of(results.get(case.key)) for scene_set, case in obstacles.items() if case is not None}
    context = report.Context(results, sets, paper, lee)
    cut_short = options.until_s is not None

    table = [case for scene_set in sets for case in plan.table1_cases(scene_set)]
    rows = rows_of(context, table)
    for row in rows if cut_short else ():
        row["in_band"] = ""
    columns = *COLUMNS, "commits"
    write_table(options.out / "table1.csv", rows, columns)
    readings = [case for part in ("rules", "readings") for case in plan.cases_of(part, sets)]
    if any(context.get(case) for case in readings):
        write_table(options.out / "readings.csv", rows_of(context, readings), columns)

    by_set = {s: {n: r for n in plan.SCENARIOS if (r := context.scenario(s, n))} for s in sets}
    if any(by_set.values()):
        plots.table1_plot(options.out / "table1.png", paper, {s: v for s, v in by_set.items() if v}, SET_UPS)

    all_runs = [run for result in results.values() for run in result.runs]
    judged = [run for of_set in by_set.values() for result in of_set.values() for run in result.runs]
    checks = [] if cut_short else checks_of(judged)
    sections = [report.table1_section(context)]
    if not cut_short:
        sections[:0] = [summary.summary_section(context), report.bands_section(context)]
        sections += [report.limit_section(context), plane.danger_section(context), losses.others_section(context)]
        sections += [block.block_section(context), losses.s6_section(context, options.out)]
        sections.append("" if options.quick else scatter_section())
        sections += [studies.readings_section(context), studies.particles_section(context)]
        sections += [studies.phase_section(context, options.out), studies.goal_section(context, options.out)]
        sections += [studies.depth_section(context, options.out), studies.push_section(context, options.out)]
        sections += [plane.plane_section(options.out, ensembles.programs) if wants_plane(options) else ""]
        sections += [losses.losses_section(context)]
        sections += [studies.variations_section(context), causes.disagreement_section(context)]
    sections += [frame.figures_section(drawn), verdict_text(checks, judged, cut_short)]
    sections.append(frame.runs_section(all_runs, ensembles.failures, ensembles.left_out(wanted)))
    text = frame.head_text(options, all_runs, ensembles.programs.version) + "\n".join(section for section in sections if section)
    (options.out / "report.md").write_text(text, encoding="utf-8")
    print(text)
    print(f"{options.out / 'table1.csv'}, {options.out / 'report.md'}")
    return 1 if ensembles.failures or not all(check.holds for check in checks) else 0


def main():
    options = parse(sys.argv[1:])
    paper = read_paper(Path(__file__).with_name("table1.csv"))
    try:
        options.out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        sys.exit(f"reproduce_paper.sh: --out: cannot write to {options.out}: {error.strerror}")
    try:
        store = Store(options.out / "runs.jsonl")
    except StoreError as error:
        print(f"reproduce_paper.sh: {error}", file=sys.stderr)
        return 2
    pair = Pair()
    programs = Programs(options.programs, options.until_s)
    ensembles = Ensembles(programs, options.out, pair, options.threads, options.keep_all, store)
    try:
        wanted = wanted_cases(options)
        ensembles.collect(wanted) if options.report_only else ensembles.run(wanted)
    except PlanError as error:
        return error.code
    store.tidy()
    if ensembles.interrupted:
        return ensembles.interrupted
    if wants_plane(options) and not options.report_only:
        code = plane.run_plane(options, pair)
        if pair.signal:
            return 128 + pair.signal
        if code != 0:
            ensembles.failures.append(f"the sweep of the part plane (exit code {code})")
    if options.report_only and not ensembles.runs:
        sys.exit(f"reproduce_paper.sh: --report-only: no run in {options.out} is complete; the report stays as it is")
    drawn, results = [], {key: Result(runs) for key, runs in ensembles.runs.items()}
    if "table1" in options.parts:
        draw_runs(results, options.sets, pair)
    if "figures" in options.parts and options.until_s is None:
        drawn = draw_figures(results, options.sets, options.out, pair)
    return write_report(options, ensembles, wanted, paper, drawn)


if __name__ == "__main__":
    sys.exit(main())
