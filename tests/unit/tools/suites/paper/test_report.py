"""The begin of the report, on made-up results."""

import unittest
from types import SimpleNamespace

from wade.suites.paper import TABLE1, plan, report
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
        self.assertNotIn("bands hold", report.summary_section(context({})))

    def test_it_names_the_bands_that_are_missed(self):
        found = table1("observed", {"S4": (50, 54.0), "S8": (4, 170.0), "S9": (0,), "S11": (0,), "S12": (0,)})
        text = report.summary_section(context(found))
        self.assertIn("4 of 5 bands hold as observed; missed: S8.", text)
        self.assertIn("as observed S8 4.0 (3.0 to 5.0) of 50 arrive", text)


if __name__ == "__main__":
    unittest.main()
