"""All models of the water in one comparison: error and cost on the validation cases, and Table 1 of the paper by each.

Runs each validation case that a model can run (a case refuses the others by itself) and the scenes of
Table 1 with each model, nothing changed but /fluid/model, one run at a time in one thread. Writes
report.md, with plots and with grades that follow from the numbers by rule, and models.csv. A run
that is complete and whose program and scenes are the same is not repeated. Shallow water, steering and
kinematic take about an hour on one core, DFSPH some hours more. With --quick: the quick cases at one
resolution each, and S1, S4, S5 and S8 of configs/river with one seed.

Columns of models.csv, a line a metric of a run: case, model, level, spacing_m; status: completed,
refused, failed or left out; particles, or cells of a grid; metric, value, unit; limit; met, yes or no,
empty if the metric has no limit; cpu_s of the solver, simulated_s, cpu_s_per_sim_s; commit of the
program; remark, why there is no result. Exit code 1: a run failed; 2: wrong options; 130, 143:
interrupted. A limit that is missed is a result, not a failure.
"""

import json

from wade.errors import UsageError
from wade.paths import BUILD, CONFIGS, ROOT
from wade.reports import options
from wade.reports.files import publish, say, write_whole
from wade.reports.jobs import end_children_on_signals, exit_code
from wade.reports.machine import machine_line
from wade.reports.programs import Fingerprints
from wade.reports.tables import document, section
from wade.run.processes import Pair
from wade.suites import cases as known_cases
from wade.suites.models import drawings, rules, sections
from wade.suites.models.case_runs import run_cases, water_cases
from wade.suites.models.outcomes import write_table
from wade.suites.models.table_one import SETS, run_table
from wade.suites.paper import TABLE1
from wade.suites.paper.ensembles import Programs
from wade.suites.paper.results import read_paper
from wade.suites.paper.store import StoreError
from wade.suites.speed_vs_error.measure import Runner
from wade.suites.validate import TABLES
from wade.suites.validate.results import Judge

DEFAULT_MODELS = ("dfsph", "mixed", "shallow_water", "steering", "kinematic")
PARTS = ("cases", "table1")


def known_models():
    schema = json.loads((CONFIGS / "scene.schema.json").read_text(encoding="utf-8"))
    return schema["properties"]["fluid"]["properties"]["model"]["enum"]


def parse(arguments):
    parser = options.parser_of("models", "models", __doc__, "models.csv")
    parser.add_argument("--models", type=options.some_of(known_models()), metavar="A,B", default=list(DEFAULT_MODELS),
                        help=f"models, as /fluid/model names them [{','.join(DEFAULT_MODELS)}]")
    parser.add_argument("--cases", metavar="A,B", help="only these cases; patterns such as 'wet_bed*' may stand for several")
    parser.add_argument("--levels", metavar="L,M", help="resolutions of coarse, medium and fine [coarse,medium]")
    parser.add_argument("--parts", type=options.some_of(PARTS), default=list(PARTS), metavar="A,B",
                        help="only these of cases and table1")
    parser.add_argument("--set-of-scenes", dest="sets", type=options.some_of(SETS), metavar="A,B",
                        help="scenes of Table 1: river (a river 1 m deep that flows), paper (an emitter, dry start) "
                        "[river,paper; quick: river]")
    parser.add_argument("--seeds", type=options.whole(1), metavar="N", help="crowds of each scenario of Table 1, with the seeds "
                        "1 to N; they share one run of the water, but for mixed, which follows people [3, quick: 1]")
    parser.add_argument("--time-limit", type=options.above_0, default=600.0, metavar="S",
                        help="wall time after which a run of a case is given up, s; a finer resolution that is expected to "
                        "take more CPU time is left out and named [600]")
    parser.add_argument("--until-s", type=options.above_0, metavar="T",
                        help="simulated time at which the runs of Table 1 end, s [the scene's, 400]")
    chosen = parser.parse_args(arguments)
    chosen.sets = chosen.sets or list(SETS[:1] if chosen.quick else SETS)
    chosen.seeds = chosen.seeds or (1 if chosen.quick else 3)
    chosen.levels = chosen.levels or ("" if chosen.quick else "coarse,medium")
    return chosen


def compare_cases(chosen):
    """[Outcome]"""
    program = BUILD / "validate"
    try:
        plan = known_cases.plan(water_cases(known_cases.list_cases(program)), chosen.cases, chosen.levels, chosen.quick, False)
    except ValueError as error:
        raise UsageError(error) from error
    fingerprint_of = Fingerprints([program], ROOT, known_cases.INPUTS)
    runner = Runner(program, chosen.out / "cases", fingerprint_of, 1, chosen.time_limit)
    return run_cases(plan, chosen.models, runner)


def compare_table1(chosen):
    """{set: [ModelRuns]}, failures in words, exit code of a signal."""
    programs = Programs(BUILD, chosen.until_s)
    found, failures, interrupted = run_table(programs, chosen.out / "table1", Pair(), chosen)
    return {s: of_set for s in chosen.sets if (of_set := [runs for runs in found if runs.set == s])}, failures, interrupted


HEAD = """# Models of the water in one comparison

Written by `tools/wade models`. Each validation case that a model can run, with its limits of `tests/validation/thresholds.csv`, and the
scenes of Table 1 of the paper, with nothing changed but `/fluid/model`. `models.csv` holds the numbers of the cases. Mixed water follows
the people of one crowd: in Table 1 each of its crowds has a run of the water of its own, while those of the other models share one.
"""
COSTS = """* CPU times of cases are of the solver, one thread, without set-up and measurement; wall times of Table 1 are those of the solver. They
  grow with what else the machine does."""


def write_report(chosen, outcomes, table1, failures):
    judge = Judge(TABLES / "thresholds.csv", TABLES / "known_failures.csv")
    paper = read_paper(TABLE1)
    limits, reasons = judge.thresholds, judge.reasons
    graded = rules.limits_of_people(outcomes, limits, reasons)
    models, out = chosen.models, chosen.out
    write_table(out / "models.csv", outcomes, limits)
    commits = sorted({o.commit for o in outcomes if o.commit})
    made = f"* {machine_line()}\n* Validation cases: programs of commit {', '.join(commits) or 'none'}.\n{COSTS}"
    write_whole(out / "report.md", document(
        HEAD, sections.grades_section(outcomes, models, graded, reasons),
        sections.cheapest_section(outcomes, models, graded, reasons),
        section("Error over cost", drawings.WORDS, "![error over cost](error_over_cost.png)")
        if drawings.error_over_cost(out / "error_over_cost.png", outcomes, models, limits) else "",
        sections.cases_section(outcomes, models, limits),
        sections.impulse_section(outcomes),
        *(sections.table1_section(of_set, paper, out) for of_set in table1.values()),
        sections.refusals_section(outcomes, models), sections.missing_section(outcomes, failures),
        section("Machine and programs", made)))


def main(arguments):
    chosen = parse(arguments)
    end_children_on_signals()
    outcomes, table1, failures, interrupted = [], {}, [], 0
    try:
        if "cases" in chosen.parts:
            outcomes = compare_cases(chosen)
        if "table1" in chosen.parts:
            table1, failures, interrupted = compare_table1(chosen)
    except StoreError as error:
        raise UsageError(error) from error
    except KeyboardInterrupt as interrupt:
        return exit_code(interrupt)
    write_report(chosen, outcomes, table1, failures)
    say(f"{chosen.out / 'report.md'}, {chosen.out / 'models.csv'}")
    if chosen.publish:
        publish(chosen.out, "models", "models.csv")
    return interrupted or (1 if failures or any(outcome.status == "failed" for outcome in outcomes) else 0)
