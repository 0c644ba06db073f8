"""Runs the scenarios of the paper with many seeds, in four set-ups, and writes a report beside the paper's table.

Set-ups: configs/observed (the water of the authors' logs, kinematic, cheap), configs/paper (as they
ran it), configs/river (as the paper describes it) and configs/manning (that river on a slope with
friction, with four layers of particles, about ten times the cost). One run of the fluid serves all
crowds of a water. Writes report.md, table1.csv and pictures, and prints the report; the part measured
has a page of its own, measured.md, and alone leaves the report as it is.

DIR/runs.jsonl keeps what each run came to, a line each. A crowd that is there, or complete as a
folder in DIR, is not run again if its scene is still the same, whichever version of the programs
ran it; the report names their commits. Run folders hold what pictures in the paper's style need;
without them such a picture stays as it was drawn before. What was not run has no part in the report.

Exit code 1: a run failed, or the verdict has a no (the bands are reported, they do not count);
2: runs.jsonl or a scene is not valid.
"""

from pathlib import Path

from wade import UsageError
from wade.paths import BUILD
from wade.reports import options
from wade.reports.files import complain, publish, say, write_whole
from wade.reports.tables import document, write_csv
from wade.run.processes import Pair
from wade.suites.cases import FOLLOWS_PEOPLE, known_models, model_changes
from wade.suites.paper import (bands, measured, pictures, plan, plane, report, studies, verdict)
from wade.suites.paper.ensembles import Ensembles, OwnWaters, PlanError, Programs
from wade.suites.paper.results import COLUMNS, Result, read_paper, table_row
from wade.suites.paper.store import Store, StoreError
from wade.suites.paper.bands import SET_UPS

SETS_OF = {"both": ("paper", "river"), "all": plan.SETS, **{name: (name,) for name in plan.SETS}}
QUICK_SETS = ("observed", "paper", "river")  # what --quick takes where nothing is asked for: the others need an hour
WIDE_PARTS = ("phase", "rules", "readings")  # many cases: half of the seeds each
TABLE1 = Path(__file__).with_name("table1.csv")


def parse(arguments):
    parts = "; ".join(f"{name}: {words}" for name, words in plan.PARTS.items())
    parser = options.parser_of("paper", "paper", f"{__doc__.rstrip()}\n\nParts: {parts}.", "table1.csv")
    parser.add_argument("--seeds", type=options.whole(1), metavar="N",
                        help="crowds of each scenario, with the seeds 1 to N; parts with many cases take half [10, quick: 1]")
    parser.add_argument("--max-seeds", type=options.whole(1), metavar="N",
                        help="more seeds, N at most, where an interval of 95 %% is wider than a tenth [3 times --seeds in "
                        "the set observed, --seeds in the others]")
    parser.add_argument("--parts", type=options.some_of(tuple(plan.PARTS)), metavar="A,B",
                        help="only these, see below [all; quick: table1 with S1, S4, S5 and S8, measured as observed]")
    parser.add_argument("--set-of-scenes", choices=tuple(SETS_OF), help="[all; quick: all but manning]")
    parser.add_argument("--model", choices=known_models(), help="water by this model instead of the scenes' own")
    parser.add_argument("--threads", type=options.whole(1), default=2, metavar="N", help="of each program [2]")
    parser.add_argument("--until-s", type=options.above_0, metavar="T",
                        help="simulated time at which each run ends, s [the scene's, 400]; such runs are not judged")
    parser.add_argument("--keep-all", action="store_true", help="keep paths and pictures of the water of all runs")
    parser.add_argument("--report-only", action="store_true", help="run nothing: the report of what is complete in DIR")
    chosen = parser.parse_args(arguments)
    chosen.seeds = chosen.seeds or (1 if chosen.quick else 10)
    chosen.parts = chosen.parts or (["table1", "measured"] if chosen.quick else list(plan.PARTS))
    chosen.sets = SETS_OF[chosen.set_of_scenes] if chosen.set_of_scenes else QUICK_SETS if chosen.quick else plan.SETS
    return chosen


def most_seeds(chosen, case):
    """Up to three times the seeds where the water costs little; else one run of the fluid unless more are asked for."""
    if chosen.max_seeds:
        return max(chosen.max_seeds, chosen.seeds)
    return chosen.seeds * (3 if case.water.set in plan.KINEMATIC and chosen.seeds > 1 else 1)


def wanted_cases(chosen):
    """{case: (seeds of a round, most seeds)} of all parts, the cheap set first; what several parts need is run once."""
    wanted = {}
    for scene_set in sorted(chosen.sets, key=plan.SETS.index):
        for part in chosen.parts:
            for case in plan.cases_of(part, chosen.sets, chosen.quick):
                if case.water.set == scene_set:
                    half = max(1, chosen.seeds // 2)
                    counts = (half, half) if part in WIDE_PARTS else (chosen.seeds, most_seeds(chosen, case))
                    if part == "measured":
                        counts = (plan.measured_seeds(case, chosen.seeds),) * 2
                    wanted[case] = max(counts, wanted.get(case, counts))
    return wanted


def wants_plane(chosen):
    """Returns true if the sweep over depth and v_F is wanted; runs that are cut short would say nothing."""
    return "plane" in chosen.parts and "observed" in chosen.sets and chosen.until_s is None


def rows_of(context, cut_short):
    """Rows for table1.csv, with the commits of the programs."""
    for scene_set in context.sets:
        base = context.scenario(scene_set, "S1")
        for name in plan.SCENARIOS:
            if result := context.scenario(scene_set, name):
                in_band = None if cut_short else bands.judge_scenario(name, result).holds
                time = base.time[0] if base and base.time else None
                row = table_row(scene_set, name, result, context.paper[name], time, in_band)
                yield {**row, "commits": " ".join(result.commits)}


def write_measured(chosen, results, paper):
    """measured.md with its picture; whether there is something to tell."""
    sets = [scene_set for scene_set in chosen.sets if any(key.startswith(f"{scene_set}/") for key in results)]
    context = report.Context(results, sets, paper, out=chosen.out)
    text = "" if chosen.until_s is not None else measured.page(report.command_of(chosen), context)
    if text:
        write_whole(chosen.out / measured.PAGE, text)
        say(text)
        say(chosen.out / measured.PAGE)
    return bool(text)


def write_report(chosen, ensembles, results, paper, drawn):
    sets = [scene_set for scene_set in chosen.sets if any(key.startswith(f"{scene_set}/") for key in results)]
    obstacles = {scene_set: pictures.case_of(scene_set, "obstacle") for scene_set in sets}
    lee = {scene_set: pictures.lee_of(results.get(case.key)) for scene_set, case in obstacles.items()
           if case is not None}
    context = report.Context(results, sets, paper, lee, chosen.out)
    cut_short = chosen.until_s is not None
    write_csv(chosen.out / "table1.csv", (*COLUMNS, "commits"), rows_of(context, cut_short))
    by_set = {s: {n: r for n in plan.SCENARIOS if (r := context.scenario(s, n))} for s in sets}
    if any(by_set.values()):
        pictures.table1_plot(chosen.out / "table1.png", paper, {s: v for s, v in by_set.items() if v}, SET_UPS)
    judged = [run for of_set in by_set.values() for result in of_set.values() for run in result.runs]
    checks = [] if cut_short else verdict.checks_of(judged)
    sections = [report.table1_section]
    if not cut_short:
        sections = [report.summary_section, report.bands_section, report.table1_section, report.limit_section,
                    plane.danger_section, studies.others_section]
        sections += [studies.readings_section, studies.particles_section, studies.phase_section]
        sections += [plane.plane_section] if wants_plane(chosen) else []
    all_runs = [run for result in results.values() for run in result.runs]
    text = document(report.head_text(chosen, all_runs), *(section(context) for section in sections),
                    report.figures_section(drawn), verdict.verdict_text(checks, cut_short),
                    report.runs_section(all_runs, ensembles.failures))
    write_whole(chosen.out / "report.md", text)
    say(text)
    say(f"{chosen.out / 'table1.csv'}, {chosen.out / 'report.md'}")
    return 1 if ensembles.failures or not all(check.holds for check in checks) else 0


def main(arguments):
    chosen = parse(arguments)
    paper = read_paper(TABLE1)
    try:
        chosen.out.mkdir(parents=True, exist_ok=True)
        store = Store(chosen.out / "runs.jsonl")
    except (StoreError, OSError) as error:
        raise UsageError(f"--out: {error}") from error
    pair = Pair()
    programs = Programs(BUILD, chosen.until_s, model_changes(chosen.model) if chosen.model else ())
    kind = OwnWaters if chosen.model in FOLLOWS_PEOPLE else Ensembles
    ensembles = kind(programs, chosen.out, pair, chosen.threads, chosen.keep_all, store)
    try:
        wanted = wanted_cases(chosen)
        ensembles.collect(wanted) if chosen.report_only else ensembles.run(wanted)
    except PlanError as error:
        return error.code
    if ensembles.interrupted:
        return ensembles.interrupted
    if wants_plane(chosen) and not chosen.report_only:
        code = plane.run_plane(chosen, pair)
        if pair.signal:
            return 128 + pair.signal
        if code != 0:
            ensembles.failures.append(f"the sweep of the part plane (exit code {code})")
    if chosen.report_only and not ensembles.runs:
        complain(f"paper: --report-only: no run in {chosen.out} is complete; the report stays as it is")
        return 1
    results = {key: Result(runs) for key, runs in ensembles.runs.items()}
    by_body = {key: result for key, result in results.items() if result.runs[0].outcome.get("people")}
    others = {key: result for key, result in results.items() if key not in by_body}
    pages = []
    if "measured" in chosen.parts and write_measured(chosen, by_body, paper):
        pages.append((measured.PAGE, None))
    code = 1 if ensembles.failures else 0
    if chosen.parts != ["measured"]:
        drawn = []
        if "figures" in chosen.parts and chosen.until_s is None:
            drawn = pictures.draw_figures(others, chosen.sets, chosen.out, pair)
        code = write_report(chosen, ensembles, others, paper, drawn)
        pages.append(("report.md", "table1.csv"))
    for page, table in pages if chosen.publish else ():
        publish(chosen.out, "paper", table, page)
    return code
