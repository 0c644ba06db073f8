"""A short campaign of tools/wade paper with real runs: its tables are complete, and say what the runs' files say.

Set as observed only, so that no water is solved: four scenarios with two seeds each.
"""

import csv
import json
import re
import shutil
import statistics
import subprocess
import tempfile
import unittest
from pathlib import Path

from wade.paths import module_command

SCENARIOS, SEEDS = ("S1", "S4", "S5", "S8"), (1, 2)


def reproduce(out, *more):
    command = [*module_command("wade.suites.paper"), "--out", out, "--quick", "--seeds", len(SEEDS), "--max-seeds", len(SEEDS),
               "--set-of-scenes", "observed", "--threads", "1", *more]
    return subprocess.run(list(map(str, command)), capture_output=True, text=True)


def section(report, title):
    return re.search(rf"^## {re.escape(title)}$(.*?)(?=^## |\Z)", report, re.MULTILINE | re.DOTALL)[1]


def rows_of(text):
    """Rows of the first table of a section: {first cell: [cells]}."""
    lines = [line for line in text.splitlines() if line.startswith("|")]
    cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines[2:]]
    return {row[0]: row for row in cells}


class ShortCampaign(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory(prefix="wade-test-")
        cls.addClassCleanup(cls.temporary.cleanup)
        cls.out = Path(cls.temporary.name) / "campaign"
        cls.answer = reproduce(cls.out)
        if not (cls.out / "report.md").exists():
            raise AssertionError(cls.answer.stderr)
        cls.report = (cls.out / "report.md").read_text()
        with open(cls.out / "table1.csv", newline="", encoding="utf-8") as file:
            cls.table = {row["scenario"]: row for row in csv.DictReader(file)}

    def outcomes(self, scenario):
        folders = [next(self.out.glob(f"observed/*/{scenario.lower()}-seed{seed}")) for seed in SEEDS]
        return [json.loads((folder / "outcome.json").read_text()) for folder in folders], folders

    def test_it_ends_well_and_judges_its_runs(self):
        self.assertEqual(self.answer.returncode, 0, self.answer.stderr)
        self.assertIn("All of it holds.", section(self.report, "Verdict"))

    def test_the_table_has_every_scenario_and_no_other(self):
        self.assertEqual(tuple(self.table), SCENARIOS)
        self.assertEqual(tuple(rows_of(section(self.report, "Table 1"))), SCENARIOS)
        self.assertEqual({row["seeds"] for row in self.table.values()}, {"2"})

    def test_the_table_holds_the_means_of_the_outcome_files(self):
        for scenario, row in self.table.items():
            outcomes, folders = self.outcomes(scenario)
            for column, key in (("arrived_mean", "arrived"), ("dead_mean", "dead"), ("time_s_mean", "last_arrival_s")):
                known = [outcome[key] for outcome in outcomes if outcome[key] is not None]
                with self.subTest(f"{scenario} {key}"):
                    if known:
                        self.assertAlmostEqual(float(row[column]), statistics.fmean(known), delta=1e-3)
                    else:
                        self.assertEqual(row[column], "")
            agents = []
            for folder in folders:
                with open(folder / "agents.csv", newline="", encoding="utf-8") as file:
                    agents += list(csv.DictReader(file))
            met = [float(agent["mean_depth_m"]) for agent in agents if float(agent["mean_depth_m"]) > 0]
            self.assertAlmostEqual(float(row["agent_depth_m"]), statistics.fmean(met), delta=1e-3)
            # The water is 1 m deep and moves at v_F. At 1.5 m/s its front is in an agent's cell of 2 m for half a second of
            # more than twenty; at 0.5 m/s many agents are across soon after it.
            if row["v_f_m_s"] == "1.5":
                self.assertAlmostEqual(float(row["agent_depth_m"]), 1, delta=0.03)
            self.assertAlmostEqual(float(row["agent_speed_m_s"]), float(row["v_f_m_s"]), delta=0.01)

    def test_the_report_says_the_same_as_the_table(self):
        lines, bands = rows_of(section(self.report, "Table 1")), rows_of(section(self.report, "Bands"))
        for scenario, row in self.table.items():
            time, _error, _diff, arrived, dead = lines[scenario][6:]
            with self.subTest(scenario):
                self.assertAlmostEqual(float(arrived.split()[0]), float(row["arrived_mean"]), delta=0.051)
                self.assertAlmostEqual(float(dead), float(row["dead_mean"]), delta=0.051)
                if row["time_s_mean"]:
                    self.assertAlmostEqual(float(time.split()[0]), float(row["time_s_mean"]), delta=0.051)
                else:
                    self.assertEqual(time, "-")
                self.assertEqual(bands[scenario][2].strip("*"), row["in_band"])
        self.assertEqual({name for name, cells in bands.items() if cells[2] != "-"}, set(SCENARIOS))

    def test_the_report_counts_every_run(self):
        waters = rows_of(section(self.report, "The runs of the fluid"))
        self.assertEqual(set(waters), {"observed/v0.5", "observed/v1.5"})
        self.assertEqual(sum(int(cells[1]) for cells in waters.values()), len(SCENARIOS) * len(SEEDS))

    def test_people_by_their_bodies_have_a_page_of_their_own(self):
        page = (self.out / "measured.md").read_text()
        rows = rows_of(section(page, "Tau given, tau computed, and who arrives"))
        self.assertEqual(rows["as observed"][1:4], ["1.5", "1.5 m2/s, very high", "0: 50, 0.2: 50, 0.8: 0, 1: 0"])
        agents = []
        for seed in SEEDS:
            folder = self.out / "observed" / "v1.5-g9.81" / f"measured-normal-seed{seed}"
            with open(folder / "agents.csv", encoding="utf-8") as file:
                agents += list(csv.DictReader(file))
        self.assertEqual({agent["worst_state"] for agent in agents if agent["outcome"] == "dead"}, {"carried"})
        tau = statistics.fmean(float(agent["mean_tau"]) for agent in agents if float(agent["mean_depth_m"]) > 0)
        self.assertEqual(rows["as observed"][6], f"{tau:.2f}: 0")
        self.assertNotIn("measured-", self.report)

    def test_every_picture_of_the_report_is_there(self):
        pictures = re.findall(r"\]\(([^)]*\.png)\)", self.report)
        self.assertTrue(pictures)
        for picture in pictures:
            self.assertTrue((self.out / picture).is_file(), picture)

    def copy(self, *left_out):
        """A copy of the campaign, as a fresh clone has it if its run folders are left out."""
        out = Path(tempfile.mkdtemp(dir=self.temporary.name)) / "copy"
        shutil.copytree(self.out, out, ignore=shutil.ignore_patterns(*left_out))
        return out

    def ran(self, answer):
        self.assertEqual(answer.returncode, 0, answer.stderr)
        return [line.split(":")[0] for line in answer.stderr.splitlines() if line.endswith("(run)")]

    def test_a_run_that_is_lost_is_run_again_and_no_other(self):
        out = self.copy()
        lost = next(out.glob("observed/*/s4-seed2")) / "outcome.json"
        before = lost.read_text()
        lost.unlink()
        self.assertEqual(self.ran(reproduce(out)), [], "the store has it")
        self.assertEqual((out / "report.md").read_text(), self.report)
        store = out / "runs.jsonl"
        lines = store.read_text().splitlines(keepends=True)
        store.write_text("".join(line for line in lines if '"observed/v0.5/s4","seed":2' not in line))
        self.assertEqual(self.ran(reproduce(out)), ["observed/v0.5/s4 seed 2"])
        for key in ("arrived", "last_arrival_s", "frame_hash"):
            self.assertEqual(json.loads(lost.read_text())[key], json.loads(before)[key], key)
        self.assertEqual((out / "report.md").read_text(), self.report)

    def test_the_store_alone_gives_the_same_report(self):
        out = self.copy("observed", "*.png", "*.md", "table1.csv")
        self.assertEqual([file.name for file in out.iterdir()], ["runs.jsonl"])
        self.assertEqual(self.ran(reproduce(out)), [])
        for name in ("runs.jsonl", "report.md", "table1.csv", "table1.png"):
            self.assertEqual((out / name).read_bytes(), (self.out / name).read_bytes(), name)

    def test_folders_alone_give_the_store(self):
        out = self.copy("runs.jsonl", "report.md")
        self.assertEqual(self.ran(reproduce(out, "--report-only")), [])
        self.assertEqual((out / "table1.csv").read_bytes(), (self.out / "table1.csv").read_bytes())
        again, kept = (sorted((folder / "runs.jsonl").read_text().splitlines()) for folder in (out, self.out))
        self.assertEqual(again, kept)

    def test_a_report_of_nothing_does_not_replace_one(self):
        out = self.copy("observed", "runs.jsonl")
        answer = reproduce(out, "--report-only")
        self.assertEqual(answer.returncode, 1)
        self.assertIn("no run in", answer.stderr)
        self.assertEqual((out / "report.md").read_text(), self.report)

    def test_results_of_another_program_are_told(self):
        out = self.copy("observed")
        store = out / "runs.jsonl"
        lines = [json.loads(line) for line in store.read_text().splitlines()]
        for line in lines:
            if line.get("run") == "observed/v1.5/s5" and line["seed"] == 2:
                line.update(commit="0ld")
        store.write_text("".join(json.dumps(line) + "\n" for line in lines))
        self.assertEqual(self.ran(reproduce(out)), [])
        self.assertIn("1 of commit 0ld", (out / "report.md").read_text())
        with open(out / "table1.csv", newline="", encoding="utf-8") as file:
            commits = {row["scenario"]: len(row["commits"].split()) for row in csv.DictReader(file)}
        self.assertEqual(commits, {"S1": 1, "S4": 1, "S5": 2, "S8": 1})


if __name__ == "__main__":
    unittest.main()
