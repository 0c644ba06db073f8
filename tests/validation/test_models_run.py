"""A short comparison with real runs: three models on two cheap cases, and the first second of Table 1 by a model."""

import json
import subprocess
import tempfile
import unittest
from pathlib import Path

from wade.paths import module_command
from wade.reports.tables import read_csv

MODELS = ("dfsph", "shallow_water", "mixed")


def compare(out, *options):
    command = [*module_command("wade.suites.models"), "--out", out, "--quick"]
    command += ["--cases", "dam_break,impulse_front", "--models", ",".join(MODELS), *options]
    return subprocess.run(list(map(str, command)), capture_output=True, text=True)


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
        for name in ("models.csv", "error_over_cost.png"):
            self.assertTrue((self.out / name).is_file(), name)

    def test_each_model_is_run_or_says_why_not(self):
        rows = read_csv(self.out / "models.csv")
        self.assertEqual({(row["case"], row["model"], row["status"]) for row in rows},
                         {(case, model, "completed") for case in ("dam_break", "impulse_front") for model in MODELS}
                         - {("dam_break", "mixed", "completed")}
                         | {("dam_break", "mixed", "refused")})  # it has no agents for its particle region to follow

    def test_the_grid_is_cheaper_and_keeps_the_limits_of_the_dam_break(self):
        by_model = {row["model"]: row for row in read_csv(self.out / "models.csv")
                    if (row["case"], row["metric"]) == ("dam_break", "depth_l1")}
        cost = {model: float(row["cpu_s_per_sim_s"]) for model, row in by_model.items()}
        self.assertLess(3 * cost["shallow_water"], cost["dfsph"])  # 67 times when this was written
        self.assertEqual(by_model["shallow_water"]["met"], "yes")
        self.assertRegex(self.report, r"\| `dam_break` +\| shallow water +\| coarse")

    def test_table_1_is_run_by_any_model(self):
        for model in ("shallow_water", "mixed"):
            out = self.out.with_name(model)
            command = [*module_command("wade.suites.paper"), "--out", out, "--quick", "--set-of-scenes", "river", "--model", model,
                       "--until-s", "1", "--threads", "1"]
            answer = subprocess.run(list(map(str, command)), capture_output=True, text=True)
            self.assertEqual(answer.returncode, 0, answer.stderr)
            rows = read_csv(out / "table1.csv")
            self.assertEqual([(row["scenario"], row["arrived_mean"]) for row in rows], [(n, "0") for n in ("S1", "S4", "S5", "S8")])
            kept = [json.loads(line) for line in (out / "runs.jsonl").read_text().splitlines()]
            self.assertEqual({line["is"]["fluid"]["model"] for line in kept if "is" in line}, {model})

    def test_what_is_complete_is_not_run_again(self):
        before = {file: file.stat().st_mtime_ns for file in self.out.glob("**/result.json")}
        again = compare(self.out)
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertNotIn("(1 of 1)", again.stderr)
        self.assertEqual({file: file.stat().st_mtime_ns for file in self.out.glob("**/result.json")}, before)
        self.assertEqual((self.out / "report.md").read_text().split("## Machine")[0], self.report.split("## Machine")[0])

    def test_wrong_words_are_refused_with_what_is_allowed(self):
        for option, word, allowed in (("--models", "no_such", "dfsph"), ("--cases", "no_such", "dam_break")):
            answer = compare(self.out, option, word)
            self.assertEqual(answer.returncode, 2, answer.stderr)
            for words in (option, word, allowed):
                self.assertIn(words, answer.stderr)


if __name__ == "__main__":
    unittest.main()
