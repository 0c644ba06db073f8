"""What is read from run folders of a campaign, on folders that are made up."""

import csv
import json
import shutil
import struct
import tempfile
import unittest
from pathlib import Path

from wade.suites.paper import TABLE1, plan
from wade.suites.paper.ensembles import is_done
from wade.suites.paper.pictures import lee_length, lee_of, longest_lee, note_what_is_seen
from wade.suites.paper.results import record_of
from wade.suites.paper.results import COLUMNS, Result, Run, read_paper, table_row

SCENE = {
    "name": "made_up",
    "seed": 1,
    "frame_rate_hz": 30,
    "world": {"gravity_m_s2": 9.81},
    "channel": {"velocity_m_s": 1.5, "depth_m": 1, "initial_river": "dry"},
    "coupling": {"contact_rule": "difference"},
    "crowd": {"groups": [{"name": "a", "tau": 0.2}, {"name": "b", "tau": 0.2}]},
    "fluid": {"particle_spacing_m": 0.5, "rest_density_kg_m3": 1000},
    "obstacles": [{"x_min_m": 60, "x_max_m": 67, "z_min_m": 21.5, "z_max_m": 28.5, "height_m": 1}],
}
# id, group, outcome, time, depth, depth times speed: two of each group
AGENTS = (
    (0, "a", "arrived", 40.0, 1.0, 1.5), (1, "a", "dead", 30.0, 2.0, 5.0), (2, "b", "arrived", 60.0, 0.0, 0.0),
    (3, "b", "active", 90.0, 1.0, 1.5),
)


class Results(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory(prefix="wade-test-")
        self.addCleanup(self.temporary.cleanup)

    def run_folder(self, agents=AGENTS, status="completed"):
        folder = Path(tempfile.mkdtemp(dir=self.temporary.name))
        times = [agent[3] for agent in agents if agent[2] == "arrived"]
        outcome = {name: sum(agent[2] == name for agent in agents) for name in ("arrived", "dead", "active")}
        outcome.update(status=status, agents=len(agents), last_arrival_s=max(times, default=None), step_rate_hz=30.0)
        (folder / "outcome.json").write_text(json.dumps(outcome))
        (folder / "manifest.json").write_text(json.dumps({"resolved_scene": SCENE, "git_hash": "abc"}))
        with open(folder / "agents.csv", "w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(("id", "group", "outcome", "time_s", "mean_depth_m", "mean_dv_m2_s"))
            writer.writerows(agents)
        return folder

    def run_of(self, **changed):
        folder = self.run_folder(**changed)
        return Run(plan.scenario_case("paper", "S5"), "S5", 1, *record_of(folder), folder)

    def test_means_over_runs_and_groups(self):
        nobody = [(i, "ab"[i // 2], "dead", 10.0, 1.0, 1.5) for i in range(4)]
        result = Result([self.run_of(), self.run_of(agents=nobody)])
        self.assertEqual((result.arrived[0], result.dead), (1.0, 2.5))
        self.assertEqual(result.time, (60.0, None, None), "runs without arrivals have no time")
        self.assertEqual(result.arrived_of("a")[0], 0.5)

    def test_water_met_leaves_out_agents_that_stayed_dry(self):
        result = Result([self.run_of()])
        self.assertAlmostEqual(result.depth, 4 / 3)
        self.assertAlmostEqual(result.speed, (1.5 + 2.5 + 1.5) / 3)

    def test_a_row_has_all_columns_and_the_difference_to_s1(self):
        paper = read_paper(TABLE1)["S5"]
        row = table_row("paper", "S5", Result([self.run_of()]), paper, base=48.0, in_band=False)
        self.assertEqual(tuple(row), tuple(COLUMNS))
        self.assertEqual((row["diff_percent"], row["in_band"], row["paper_time_s"]), (25.0, "no", "93"))
        self.assertEqual(row["particle_mass_kg"], 125.0)

    def test_a_drawn_tau_is_written_as_its_limits(self):
        result = Result([self.run_of()])
        drawn = {"min": 0.4, "max": 0.8}
        result.scene = {**SCENE, "crowd": {"groups": [{"name": "a", "tau": drawn, "mass_kg": drawn}]}}
        paper = dict.fromkeys(("time_s", "diff_percent", "arrived"), "")
        self.assertEqual(table_row("paper", "S5", result, paper)["tau"], "0.4 to 0.8")

    def test_a_run_is_done_only_if_complete_and_of_this_scene(self):
        folder = self.run_folder()
        self.assertTrue(is_done(folder, {**SCENE, "name": "other"}))
        self.assertFalse(is_done(folder, {**SCENE, "seed": 2}))
        self.assertFalse(is_done(self.run_folder(status="running"), SCENE))
        self.assertFalse(is_done(folder / "nowhere", SCENE))

    def water_file(self, run, depths):
        """water.bin of one snapshot at 15 s, cells of 1 m from (0, 11.5); depths: rows of m."""
        rows, columns = len(depths), len(depths[0])
        data = b"WADEWAT1" + struct.pack("<IIdddd", columns, rows, 1.0, 0.0, 11.5, 0.0)
        data = data.ljust(64, b"\0") + struct.pack("<Qd", 450, 15.0)
        data += b"".join(struct.pack("<H", round(1000 * depth)) for row in depths for depth in row)
        (run.folder / "water.bin").write_bytes(data)

    def test_the_lee_is_dry_ground_behind_the_block_beside_a_stream(self):
        run = self.run_of()
        depths = [[1.0 if x >= 20 else 0.0 for x in range(100)] for _ in range(27)]
        for row in range(10, 17):
            for x in range(36, 60):
                depths[row][x] = 0.0
        self.water_file(run, depths)
        self.assertEqual(lee_length(run), 24)
        self.assertEqual(longest_lee(run), (24, 15))
        self.assertIsNone(lee_of(Result([run])))
        note_what_is_seen(run)
        shutil.rmtree(run.folder)
        self.assertEqual(lee_of(Result([run])), [24, 24, 15], "what is kept is enough")
        run.folder.mkdir()
        for row in range(27):
            for x in range(50):
                depths[row][x] = 0.0
        self.water_file(run, depths)
        self.assertEqual(lee_length(run), 10, "no lee where the front has not passed")


if __name__ == "__main__":
    unittest.main()
