"""Runs the tests of crowds that ISO 20414, RiMEA and IMO ask for, and those of two-way flow, doors and water.

Each test is a scene of configs/validation, a truth from the guideline or from experiments, and limits
set before the results (tests/validation/thresholds.csv, with their reasons). report.md lists the tests
of the guidelines with their cases, or why they do not apply, with a plot of openings; DIR/runs/ has the
numbers and curves of each run. Cases with bodies count their levels by the runs that they make: coarse
is what the tests run, medium and fine have more seeds, widths and rates; the others count them by the
markers. A complete run of the same program and scenes is not repeated.

Exit code 1: a run failed,
or a value is above its threshold and no known failure (tests/validation/known_failures.csv); 2: wrong
options; 130, 143: interrupted.
"""

from wade.reports.tables import markdown, section
from wade.suites import validate

HEAD = """# Verification of the crowd

Tests of the guidelines by which evacuation models are verified, and more of the same kind: people with bodies (`human` unless
said otherwise) on dry ground, but for the case in which water pushes them. Thresholds were written down before the results
(`tests/validation/thresholds.csv`, with their reasons). A threshold that is missed is a failure, also if it is known
(`tests/validation/known_failures.csv`).

`tools/wade verify-crowd` writes this file; `verify_crowd.csv` holds the same numbers.
"""
SOURCES = """Numbers of the tests: RiMEA guideline 3.0 and 4.0, IMO MSC.1/Circ.1533 (annex 3, appendix), NIST TN 1822 (Ronchi et al. 2013), from which
ISO 20414:2020 comes. The texts of RiMEA were read as the documentation of JuPedSim's tests quotes them, the names of NIST's as a
list of JuPedSim's scenarios has them; ISO 20414 itself is not public. Measured flows are cited at the cases."""

# RiMEA, IMO, NIST, what is tested, the cases that do it; or why none does.
TESTS = (
    ("1", "1", "2.1", "speed in a corridor", "crowd_walks crowd_rimea_01 crowd_free_speed", ""),
    ("2, 3", "2, 3", "2.2", "speed on stairs", "", "the ground has no stairs"),
    ("4", "12", "", "speed and flow over density", "crowd_bodies crowd_rimea_04", ""),
    ("5", "5", "1.1", "time before people start", "", "all start at once"),
    ("6", "6", "2.3", "a corner", "crowd_corner crowd_rimea_06", ""),
    ("7", "7", "2.4, 2.10", "speeds of ages, and of the disabled", "crowd_walks", ""),
    ("8", "", "", "parameters, over three storeys", "", "there is one storey; parameters: step rate and cells, below"),
    ("", "8", "2.8", "counter-flow", "crowd_rooms", ""),
    ("9", "9", "", "1000 people, four doors and two", "crowd_exits crowd_rimea_09", ""),
    ("10", "10", "3.1", "exits that are assigned", "crowd_cabins", ""),
    ("11", "", "", "choice of an exit", "", "a scene assigns the goals, nobody changes his"),
    ("12", "4", "5.2", "flow through bottlenecks", "crowd_openings crowd_rimea_12", ""),
    ("13", "11", "5.1", "a jam before stairs", "", "the ground has no stairs"),
    ("14", "", "", "a short or a long way, over two storeys", "", "there is one storey"),
    ("15", "", "", "a large crowd at a corner", "crowd_corner", ""),
    ("", "", "2.5, 2.6, 2.7", "smoke, incapacitation, lifts", "", "not of floods; water: the paper's endurance"),
    ("", "", "2.9, 3.2, 3.3", "groups, influence, affiliation", "", "people decide for themselves"),
    ("", "", "4.1", "exits that open and close", "", "walls stay as they are during a run"),
)
BEYOND = (
    ("doors of 0.6 to 2.0 m", "crowd_doors"),
    ("two-way flow over density", "crowd_two_way crowd_counterflow"),
    ("two blocks meet", "crowd_blocks"),
    ("two-way doors", "crowd_two_way_doors"),
    ("crossing and junction", "crowd_crossing"),
    ("two people head on, fifty on a circle", "crowd_head_on crowd_circle"),
    ("pressed by water against walls and gaps", "crowd_pushed"),
    ("any step rate, any cells of the ways", "crowd_step_rates crowd_openings"),
    ("mirrored scenes", "crowd_mirror"),
)
WORDS = {"yes": "pass", "known": "**FAIL** (known)", "no": "**FAIL**"}


def verdict_of(case, runs, judge):
    """The worst of a case: of its thresholds, or that a run did not complete."""
    of_case = [run for run in runs if run["case"] == case]
    found = {judge.verdict(run, metric) for run in of_case for metric in run["metrics"]}
    if any(run["status"] != "completed" for run in of_case):
        found.add("no")
    worst = next((word for word in ("no", "known", "yes") if word in found), "")
    return WORDS.get(worst, "reported" if of_case else "not run")


def cases_text(cases, runs, judge):
    return "; ".join(f"[{case}](#{case}) {verdict_of(case, runs, judge)}" for case in cases.split())


def front(runs, judge):
    """Returns the section that lists the tests of the guidelines with their cases and verdicts."""
    asked = markdown(("RiMEA", "IMO", "NIST", "test", "case, or why it does not apply"),
                     [(*numbers, what, cases_text(cases, runs, judge) if cases else f"does not apply: {why}")
                      for *numbers, what, cases, why in TESTS])
    more = markdown(("beyond the guidelines", "case"), [(what, cases_text(cases, runs, judge)) for what, cases in BEYOND])
    return section("Tests of the guidelines", asked, SOURCES, more)


SUITE = validate.Suite("verify-crowd", "verify_crowd", __doc__, validate.is_of_people, HEAD, front)


def main(arguments):
    return validate.main(arguments, SUITE)
