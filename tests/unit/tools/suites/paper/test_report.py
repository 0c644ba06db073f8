"""The start of the report, and the page on the measured response of people, on made-up results."""

import tempfile
import unittest
from pathlib import Path
from types import SimpleNamespace

from wade.suites.paper import TABLE1, measured, pictures, plan, report
from wade.suites.paper.report import Context
from wade.suites.paper.results import Result, Run, read_paper

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


class Pictures(unittest.TestCase):
    def test_a_share_without_an_interval_stands_alone(self):
        self.assertEqual(pictures.percent_in_words((25, 20, 30.2), 50), "50\n(40\u201360)")
        self.assertEqual(pictures.percent_in_words((25, None, None), 50), "50")


class Summary(unittest.TestCase):
    def test_without_results_there_is_none(self):
        self.assertNotIn("bands hold", report.summary_section(context({})))

    def test_it_names_the_bands_that_are_missed(self):
        found = table1("observed", {"S4": (50, 54.0), "S8": (4, 170.0), "S9": (0,), "S11": (0,), "S12": (0,)})
        text = report.summary_section(context(found))
        self.assertIn("4 of 5 bands hold as observed; missed: S8.", text)
        self.assertIn("as observed S8 4.0 (3.0 to 5.0) of 50 arrive", text)


def by_body(case, worst, state, taus):
    """A Result of runs of walkers; worst, state: numbers of each run; taus: of each run [number in the water, mean]."""
    agents, arrived = sum(worst.values()), state.get("arrived", 0)
    steps = [300] * min(1, arrived) + [1] * (arrived - 1)
    record = {"agents": agents, "arrived": arrived, "dead": agents - arrived, "last_arrival_s": None, "commit": "abc",
              "step_rate_hz": 30, "water_met": [0, None, None],
              "groups": {"walkers": {"agents": agents, "dead": 0, "arrival_steps": steps}}}
    people = [{"people": {"walkers": {"worst": worst, "state": state, "tau": tau}}} for tau in taus]
    return Result([Run(case, case.name, seed, {**record, **one}, {}) for seed, one in enumerate(people, 1)])


class ByBody(unittest.TestCase):
    def page(self, results):
        folder = tempfile.TemporaryDirectory(prefix="wade-test-")
        self.addCleanup(folder.cleanup)
        self.out = Path(folder.name)
        found = {case.key: by_body(case, *told) for case, told in results.items()}
        return measured.page("--parts measured", Context(found, ["river"], PAPER, out=self.out))

    def test_tau_is_the_mean_over_the_people_in_the_water_of_all_runs(self):
        case = plan.measured_case("river", 0.5, "good")
        self.assertAlmostEqual(measured.tau_of(by_body(case, {"walking": 4}, {}, ([1, 0.2], [3, 0.6]))), 0.5)
        self.assertIsNone(measured.tau_of(by_body(case, {"walking": 4}, {}, ([0, None],))))

    def test_what_becomes_of_people_adds_up_twice(self):
        worst = {"walking": 10, "effort": 5, "sliding": 15, "toppled": 1, "afloat": 1, "carried": 16, "drowned": 2}
        state = {"arrived": 20, "dead": 8, "drowned": 2, "recovering": 12, "carried": 8}
        found = by_body(plan.measured_case("river", 1.0, "normal"), worst, state, ([50, 0.5],) * 2)
        self.assertEqual(measured.fates(found), [15, 15, 20, 20, 8, 2, 20])
        self.assertEqual(measured.off_feet(found)[0], 20)

    def test_the_page_tells_what_was_run_and_no_more(self):
        at = {(v, skill): plan.measured_case("river", v, skill) for v in (0.5, 1.5) for skill in ("braced", "poor")}
        all_walk, all_lost = ({"effort": 50}, {"arrived": 50}), ({"carried": 50}, {"dead": 50})
        text = self.page({
            at[0.5, "braced"]: (*all_walk, ([50, 0.0],)), at[0.5, "poor"]: (*all_lost, ([50, 0.6],)),
            at[1.5, "braced"]: (*all_lost, ([50, 0.33],)), at[1.5, "poor"]: (*all_lost, ([50, 0.95],)),
        })
        self.assertIn("at least half arrive up to v_F, m/s: braced 0.5, poor none.", text)
        self.assertIn("(0.5 m2/s, moderate): at least half arrive of braced; tau computed 0.00 to 0.60. In the paper, ", text)
        self.assertIn("(1.5 m2/s, very high): at least half arrive of none; tau computed 0.33 to 0.95. In the paper, ", text)
        self.assertNotIn("Tau counts slipping alone", text)
        self.assertIn("0: 50, 0.2: 50, 0.8: 0, 1: 0 | 0.33: 0 | - | - | - | 0.95: 0 |", text)
        self.assertIn("4 runs, seeds 1 to 1, by programs: 4 of commit abc", text)
        self.assertGreater((self.out / "measured.png").stat().st_size, 5000)
        self.assertNotIn("What two ways change", text)
        self.assertEqual(self.page({}), "")

    def test_it_names_people_who_topple_and_do_not_slip(self):
        case = plan.measured_case("river", 0.5, "unaware")
        text = self.page({case: ({"carried": 44, "effort": 6}, {"arrived": 50}, ([50, 0.001],))})
        self.assertIn("at 0.5 m/s unaware people have tau 0.00, and 44 of 50 lose their feet.", text)

    def test_two_ways_stand_beside_one(self):
        cases = {ways: plan.measured_pushing("S5", 0.75, "normal", *ways) for ways in plan.WAYS}
        arrive = dict(zip(plan.WAYS, (30, 40, 35, 48)))
        told = {ways: ({"effort": n, "carried": 50 - n}, {"arrived": n}, ([50, 0.3],)) for ways, n in arrive.items()}
        text = self.page({case: told[ways] for ways, case in cases.items()})
        self.assertIn("the 50 of Table 1, normal, 0.75 m/s: 30.0 arrive one way, 48.0 with both.", text)
        line = next(line for line in text.splitlines() if line.startswith("| the 50 of Table 1"))
        arriving = [cell.split(";")[0].strip() for cell in line.split("|")[4:8]]  # one seed has no interval
        self.assertEqual(arriving, ["30.0", "40.0", "35.0", "48.0"])

    def test_a_block_of_people_is_told_beside_the_same_people_without_it(self):
        told = {}
        for name, arrive in (("no_obstacle", 52), ("obstacle_of_people", 35)):
            for ways in plan.WAYS:
                state = {"arrived": arrive, "standing": 52 - arrive}
                case = plan.measured_pushing(name, 0.75, "normal", *ways)
                told[case] = {"effort": 52}, {key: n for key, n in state.items() if n}, ([52, 0.3],)
        text = self.page(told)
        self.assertIn("with both, of 52 arrive: normal 35.0 with it, 52.0 without.", text)
        self.assertIn("in the order of the columns: normal 17.0, 17.0, 17.0, 17.0.", text.replace("\n", " "))


if __name__ == "__main__":
    unittest.main()
