"""A short comparison with real runs: three models on two cheap cases and the first second of four scenes of Table 1."""

import csv
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PROGRAMS = Path(os.environ.get("WADE_PROGRAMS", ROOT / "build" / "release"))
MODELS = ("dfsph", "shallow_water", "mixed")


def compare(out, *options):
    command = ["/usr/bin/python3", ROOT / "tools" / "compare_models", "--programs", PROGRAMS, "--out", out, "--quick"]
    command += ["--cases", "dam_break,impulse_front", "--models", ",".join(MODELS), "--until-s", "1", *options]
    return subprocess.run(list(map(str, command)), capture_output=True, text=True)


def rows_of(file):
    with open(file, newline="", encoding="utf-8") as lines:
        return list(csv.DictReader(lines))


class ShortComparison(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory(prefix="wade-test-")
        cls.addClassCleanup(cls.temporary.cleanup)
        cls.out = Path(cls.temporary.name) / "first"
        cls.answer = compare(cls.out)
        if not (cls.out / "report.md").exists():
            raise AssertionError(cls.answer.stderr)
        cls.report = (cls.out / "report.md").read_text()

    def test_it_ends_well_with_all_its_files(self):
        self.assertEqual(self.answer.returncode, 0, self.answer.stderr)
        for name in ("models.csv", "models_table1.csv", "error_over_cost.png", "impulse.png", "table1_river.png"):
            self.assertTrue((self.out / name).is_file(), name)

    def test_dfsph_is_read_and_the_others_are_run(self):
        rows = rows_of(self.out / "models.csv")
        self.assertEqual({(row["model"], row["source"]) for row in rows},
                         {("dfsph", "validation.csv"), ("shallow_water", "run"), ("mixed", "run"),
                          ("mixed", "")})  # it refuses the dam break: nobody is there whom it could follow
        self.assertEqual({row["case"] for row in rows}, {"dam_break", "impulse_front"})

    def test_the_grid_is_cheaper_and_keeps_the_limits_of_the_dam_break(self):
        by_model = {row["model"]: row for row in rows_of(self.out / "models.csv")
                    if (row["case"], row["metric"]) == ("dam_break", "depth_l1")}
        cost = {model: float(row["cpu_s_per_sim_s"]) for model, row in by_model.items()}
        self.assertLess(3 * cost["shallow_water"], cost["dfsph"])  # 67 times when this was written
        self.assertEqual(by_model["shallow_water"]["met"], "yes")
        self.assertRegex(self.report, r"\| `dam_break` +\| shallow water +\| coarse")

    def test_table_1_has_all_models_with_their_costs(self):
        rows = rows_of(self.out / "models_table1.csv")
        self.assertEqual({(row["model"], row["scenario"]) for row in rows},
                         {(model, name) for model in MODELS for name in ("S1", "S4", "S5", "S8")})
        self.assertEqual({row["spacing_m"] for row in rows}, {"0.4642"})

    def test_what_is_complete_is_not_run_again(self):
        before = {file: file.stat().st_mtime_ns for file in self.out.glob("**/outcome.json")}
        again = compare(self.out)
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertNotIn("(1 of 1)", again.stderr)
        self.assertEqual({file: file.stat().st_mtime_ns for file in self.out.glob("**/outcome.json")}, before)
        self.assertEqual((self.out / "report.md").read_text().split("## Machine")[0], self.report.split("## Machine")[0])

    def test_a_campaign_is_read_and_left_as_it_is(self):
        campaign, second = self.out / "table1", self.out.with_name("second")
        before = {file: file.stat().st_mtime_ns for file in campaign.glob("**/*")}
        answer = compare(second, "--parts", "table1", "--dfsph-campaign", campaign, "--report-only")
        self.assertEqual(answer.returncode, 0, answer.stderr)
        rows = rows_of(second / "models_table1.csv")
        self.assertEqual({(row["model"], row["source"]) for row in rows}, {("dfsph", "read from a campaign")})
        self.assertEqual({file: file.stat().st_mtime_ns for file in campaign.glob("**/*")}, before)

    def test_what_was_kept_of_the_runs_is_enough_for_the_report(self):
        kept = self.out.with_name("kept")
        for file in [self.out / "table1" / "runs.jsonl", *self.out.glob("cases/*/*/result.json")]:
            (kept / file.relative_to(self.out)).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(file, kept / file.relative_to(self.out))
        answer = compare(kept, "--report-only")
        self.assertEqual(answer.returncode, 0, answer.stderr)
        for table in ("models.csv", "models_table1.csv"):
            self.assertEqual(rows_of(kept / table), rows_of(self.out / table))
        self.assertEqual(len(list(kept.glob("**/outcome.json"))), 0)

    def test_wrong_words_are_refused_with_what_is_allowed(self):
        for option, word, allowed in (("--models", "no_such", "dfsph"), ("--cases", "no_such", "dam_break"),
                                      ("--parts", "figures", "table1"),
                                      ("--set", "steering:/a=1", "MODEL"), ("--set-of-scenes", "observed", "river")):
            answer = compare(self.out, option, word)
            self.assertEqual(answer.returncode, 2, answer.stderr)
            self.assertIn(f"compare_models.sh: {option} {word}", answer.stderr)
            self.assertIn(allowed, answer.stderr)


if __name__ == "__main__":
    sys.exit(unittest.main())
