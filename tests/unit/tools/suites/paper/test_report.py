"""The begin of the report and its list of what does not agree, on made-up results."""

import unittest
from types import SimpleNamespace

from wade.suites.paper import TABLE1, causes, losses, plan, report
from wade.suites.paper.report import Context
from wade.suites.paper.results import read_paper

PAPER = read_paper(TABLE1)


def result(arrived, time=None, crossing=None):
    """A Result with as many arrivals, the last after a time, s; crossing: those of the walkers of two groups."""
    interval = (arrived, max(0, arrived - 1), min(50, arrived + 1))
    walkers = (crossing, crossing, crossing) if crossing is not None else interval
    return SimpleNamespace(arrived=interval, agents=50, time=None if time is None else (time, time, time), runs=[],
                           depth=1.0, speed=1.5, arrived_of=lambda group: walkers if group == "walkers" else (0, 0, 0))


def context(outcomes, scene_set="observed"):
    """outcomes: {case: result}."""
    return Context({case.key: found for case, found in outcomes.items()}, [scene_set], PAPER)


def table1(scene_set, outcomes):
    return {plan.scenario_case(scene_set, name): result(*found) for name, found in outcomes.items()}


class Summary(unittest.TestCase):
    def test_without_results_there_is_none(self):
        self.assertEqual(report.summary_section(context({})), "")
        self.assertEqual(causes.disagreement_section(context({})), "")

    def test_it_names_the_bands_that_are_missed(self):
        found = table1("observed", {"S4": (50, 54.0), "S8": (4, 170.0), "S9": (0,), "S11": (0,), "S12": (0,)})
        text = report.summary_section(context(found))
        self.assertIn("4 of 5 bands hold as observed; missed: S8.", text)
        self.assertIn("as observed S8 4.0 (3.0 to 5.0) of 50 arrive", text)

    def test_it_sets_the_numbers_of_faster_water_beside_those_of_the_scenes(self):
        found = {plan.scenario_case("paper", "S6"): result(50, 90.0), plan.other_case("paper", "two_groups"): result(50, 1, 49)}
        for case in plan.emitter_cases("paper", 1.6):
            found[case] = result(44, 156.0, 4)
        text = report.losses_line(context(found, "paper"))
        self.assertIn("as run 50.0 and 49.0; as run, emitter at 1.6 v_F 44.0 and 4.0", text)


class Causes(unittest.TestCase):
    def test_bands_with_one_cause_stand_together(self):
        text = causes.disagreement_section(context(table1("paper", {"S5": (50, 58.0), "S7": (50, 65.0)}), "paper"))
        self.assertEqual(text.count(causes.THIN), 1)
        self.assertIn("  * S5: 58.0", text)
        self.assertIn("  * S7: 65.0", text)

    def test_faster_water_is_judged_by_the_same_bands(self):
        times = {"S4": 54.0, "S5": 93.0, "S6": 160.0, "S7": 97.0, "S8": None, "S10": 140.0}
        cases = plan.emitter_cases("paper", 1.4)
        found = {case: result(0 if times[name] is None else 50, times[name]) for case, name in zip(cases, plan.PUSHED)}
        found[cases[-1]] = result(15, 140.0, 15)
        text = causes.faster_water(context(found, "paper"))
        self.assertIn("as run, emitter at 1.4 v_F: 6 of 6 bands of S4 to S10", text)
        self.assertIn("wrong by a factor of 1.00", text)
        self.assertEqual(text.count("v_F: "), 1, "what was not run has no line")

    def test_the_contact_rule_of_the_text_is_held_against_its_table(self):
        found = {case: result(0) for case in plan.contact_cases("paper")}
        text = causes.contact_rule(context(found, "paper"))
        self.assertIn("as run 0.0 (0.0 to 1.0) arrive in S5, 1 of 6 bands of S4 to S10", text)


class Losses(unittest.TestCase):
    def test_every_number_of_the_paper_has_its_line(self):
        run = SimpleNamespace(arrival_times=lambda group=None: [float(second) for second in range(40)])
        found = SimpleNamespace(runs=[run])
        cases = [plan.scenario_case("paper", "S6")]
        cases += [plan.other_case("paper", name) for name in ("two_groups", "no_obstacle", "obstacle")]
        lines = losses.when_paper_counts(context(dict.fromkeys(cases, found), "paper")).splitlines()[4:]
        self.assertEqual([line.split("|")[1].strip() for line in lines], ["S6", "two groups", "no obstacle", "obstacle"])
        self.assertIn("after 34 to 34 s", lines[0])


if __name__ == "__main__":
    unittest.main()
