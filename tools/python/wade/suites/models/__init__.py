"""All models of the water in one comparison: error and cost on the validation cases.

Runs each validation case that a model can run (a case refuses the others by itself), nothing changed
but /fluid/model, one run at a time in one thread. Writes report.md, with a plot and with grades that
follow from the numbers by rule, and models.csv. A complete run of the same program and scenes is
not repeated. Some hours, most of them for DFSPH; with --quick the quick cases at one
resolution each. Table 1 of the paper by a model: tools/wade paper --model NAME --parts table1.

Exit code 1: a run failed; 2: wrong options; 130, 143:
interrupted. A limit that is missed is a result, not a failure.
"""

from wade import UsageError
from wade.paths import BUILD, ROOT
from wade.reports import options
from wade.reports.files import publish, say, write_whole
from wade.reports.jobs import Fingerprints, exit_code
from wade.reports.machine import machine_line
from wade.reports.tables import document, section
from wade.suites import cases as known_cases
from wade.suites.models import drawings, rules, sections
from wade.suites.models.outcomes import run_cases, water_cases, write_table
from wade.suites.speed_vs_error.measure import Runner
from wade.suites.validate import TABLES
from wade.suites.validate.results import Judge

DEFAULT_MODELS = ("dfsph", "mixed", "shallow_water", "steering", "kinematic")

def parse(arguments):
    parser = options.parser_of("models", "models", __doc__, "models.csv")
    parser.add_argument("--models", type=options.some_of(known_cases.known_models()), metavar="A,B",
                        default=list(DEFAULT_MODELS),
                        help=f"models, as /fluid/model names them [{','.join(DEFAULT_MODELS)}]")
    options.add_cases(parser)
    parser.add_argument("--levels", metavar="L,M", help="resolutions of coarse, medium and fine [coarse,medium]")
    parser.add_argument("--time-limit", type=options.above_0, default=600.0, metavar="S",
                        help="wall time after which a run of a case is given up, s; a finer resolution that is expected to "
                        "take more CPU time is left out and named [600]")
    chosen = parser.parse_args(arguments)
    chosen.levels = chosen.levels or ("" if chosen.quick else "coarse,medium")
    return chosen


def compare_cases(chosen):
    """[Outcome]"""
    program = BUILD / "validate"
    try:
        plan = known_cases.plan(water_cases(known_cases.list_cases(program)), chosen.cases, chosen.levels, chosen.quick,
                                False)
    except ValueError as error:
        raise UsageError(error) from error
    fingerprint_of = Fingerprints([program], ROOT, known_cases.INPUTS)
    runner = Runner(program, chosen.out / "cases", fingerprint_of, 1, chosen.time_limit)
    return run_cases(plan, chosen.models, runner)


HEAD = """# Models of the water in one comparison

Written by `tools/wade models`. Each validation case that a model can run, with its limits of
`tests/validation/thresholds.csv`, with nothing changed but `/fluid/model`. `models.csv` holds the numbers.
[Table 1 of the paper by each model](README.md).
"""
COSTS = "* CPU times are of the solver, one thread, without set-up and measurement; they grow with what else the machine does."


def write_report(chosen, outcomes):
    judge = Judge(TABLES / "thresholds.csv", TABLES / "known_failures.csv")
    limits, reasons = judge.thresholds, judge.reasons
    graded = rules.limits_of_people(outcomes, limits, reasons)
    models, out = chosen.models, chosen.out
    write_table(out / "models.csv", outcomes, limits)
    commits = sorted({o.commit for o in outcomes if o.commit})
    made = f"* {machine_line()}\n* Programs of commit {', '.join(commits) or 'none'}.\n{COSTS}"
    write_whole(out / "report.md", document(
        HEAD, sections.grades_section(outcomes, models, graded, reasons),
        sections.cheapest_section(outcomes, models, graded, reasons),
        section("Error over cost", drawings.WORDS, "![error over cost](error_over_cost.png)")
        if drawings.error_over_cost(out / "error_over_cost.png", outcomes, models, limits) else "",
        sections.cases_section(outcomes, models, limits),
        sections.impulse_section(outcomes),
        sections.refusals_section(outcomes, models), sections.missing_section(outcomes),
        section("Machine and programs", made)))


def main(arguments):
    chosen = parse(arguments)
    try:
        outcomes = compare_cases(chosen)
    except KeyboardInterrupt as interrupt:
        return exit_code(interrupt)
    write_report(chosen, outcomes)
    say(f"{chosen.out / 'report.md'}, {chosen.out / 'models.csv'}")
    if chosen.publish:
        publish(chosen.out, "models", "models.csv")
    return 1 if any(outcome.status == "failed" for outcome in outcomes) else 0
