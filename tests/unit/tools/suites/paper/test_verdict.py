"""The verdict, on outcomes that are made up."""

import sqlite3
import tempfile
import unittest
from pathlib import Path
from types import SimpleNamespace

from wade.suites.paper.verdict import checks_of, path_hash, verdict_text

PATH = [(0, 0, 75.0, 10.0, 0.0, 1.0), (1, 0, 75.0, 10.04, 0.0, 1.0)]
RIVER = {"S1": 50, "S2": 50, "S3": 50, "S4": 50, "S5": 50, "S6": 12, "S7": 3, "S8": 2, "S9": 0, "S10": 7}
RIVER |= {"S11": 0, "S12": 0}


class Verdict(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory(prefix="wade-test-")
        self.addCleanup(self.temporary.cleanup)

    def run_of(self, scenario, arrived=50, scene_set="river", seed=1, last=46.0, clamps=0, path=None):
        folder = Path(tempfile.mkdtemp(dir=self.temporary.name))
        database = sqlite3.connect(folder / "trajectories.sqlite")
        database.execute("CREATE TABLE trajectory_data (frame, id, pos_x, pos_y, ori_x, ori_y)")
        database.executemany("INSERT INTO trajectory_data VALUES (?, ?, ?, ?, ?, ?)", path or PATH)
        database.commit()
        database.close()
        fluid = {"position_clamps": clamps}
        outcome = {"arrived": arrived, "agents": 50, "last_arrival_s": last if arrived else None, "fluid": fluid}
        outcome["path_hash"] = path_hash(folder)
        return SimpleNamespace(set=scene_set, scenario=scenario, seed=seed, outcome=outcome)

    def river(self, **changed):
        """All twelve runs of the river set, as they should be but for the arrivals that are named."""
        return [self.run_of(scenario, arrived) for scenario, arrived in {**RIVER, **changed}.items()]

    def exceptions(self, runs):
        return [exception for check in checks_of(runs) for exception in check.exceptions]

    def test_results_of_the_paper_hold(self):
        checks = checks_of(self.river())
        self.assertEqual([check.sentence for check in checks if not check.holds], [])
        self.assertEqual(len(checks), 6)

    def test_agents_that_should_arrive_and_do_not_are_named(self):
        self.assertEqual(self.exceptions(self.river(S4=49, S5=0)), ["S4 seed 1: 49 of 50", "S5 seed 1: 0 of 50"])

    def test_agents_that_should_not_arrive_and_do_are_named(self):
        found = self.exceptions(self.river(S8=3, S9=1, S11=2, S12=50))
        names = ["S8 seed 1: 3 of 50", "S9 seed 1: 1 of 50", "S11 seed 1: 2 of 50", "S12 seed 1: 50 of 50"]
        self.assertEqual(found, names)

    def test_arrivals_are_judged_in_the_river_set_only(self):
        runs = [self.run_of(name, arrived, "paper") for name, arrived in {"S4": 0, "S8": 50, "S12": 50}.items()]
        self.assertEqual(self.exceptions(runs), [])

    def test_one_bit_in_a_path_is_a_difference(self):
        x = 75.0 + 2**-46  # the next double
        moved = [PATH[0], (1, 0, x, *PATH[1][3:])]
        runs = [self.run_of("S1"), self.run_of("S2"), self.run_of("S3", path=moved)]
        self.assertEqual(self.exceptions(runs), ["S3 seed 1 differs from S1"])

    def test_a_path_that_ends_early_is_a_difference(self):
        runs = [self.run_of("S1"), self.run_of("S2", path=PATH[:1])]
        self.assertEqual(self.exceptions(runs), ["S2 seed 1 differs from S1"])

    def test_paths_are_compared_within_set_and_seed(self):
        other = [(0, 0, 1.0, 1.0, 0.0, 1.0)]
        runs = [self.run_of("S1"), self.run_of("S2"), self.run_of("S1", seed=2, path=other)]
        runs += [self.run_of("S2", seed=2, path=other), self.run_of("S1", scene_set="paper", path=other)]
        self.assertEqual(self.exceptions(runs), [])

    def test_times_without_push_lie_in_the_band(self):
        for last, arrived, found in (
            (38.0, 50, []),
            (50.0, 50, []),
            (37.9, 50, ["S1 seed 1: 37.9 s"]),
            (50.1, 50, ["S1 seed 1: 50.1 s"]),
            (46.0, 0, ["S1 seed 1: nobody arrived"]),
        ):
            with self.subTest(last=last, arrived=arrived):
                self.assertEqual(self.exceptions([self.run_of("S1", arrived, "paper", last=last)]), found)

    def test_a_clamp_in_any_run_is_named(self):
        runs = [self.run_of("S6", scene_set="paper", clamps=4), self.run_of("S6")]
        self.assertEqual(self.exceptions(runs), ["paper S6 seed 1: 4"])

    def test_scenes_that_were_not_run_are_left_out(self):
        checks = checks_of([self.run_of("S1"), self.run_of("S8", 1)])
        text = "".join(check.in_words() for check in checks)
        for scenario in ("S2", "S3", "S4", "S5", "S9", "S11", "S12"):
            self.assertNotIn(scenario, text)
        self.assertEqual(checks_of([]), [])

    def test_text_says_what_holds(self):
        runs = self.river(S9=1)
        text = verdict_text(checks_of(runs))
        self.assertIn("* river S4, S5: all agents arrive: yes\n", text)
        self.assertIn("nobody arrives: NO (S9 seed 1: 1 of 50)\n", text)
        self.assertIn("1 of 6 do not hold.", text)

    def test_runs_cut_short_are_not_judged(self):
        self.assertIn("None: --until-s", verdict_text([], cut_short=True))


if __name__ == "__main__":
    unittest.main()
