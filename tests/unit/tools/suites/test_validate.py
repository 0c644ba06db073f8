"""The suite of validation: how runs are judged, what the report says of them."""

import csv
import json
import re
import tempfile
import unittest
from pathlib import Path
from unittest import mock

from wade.paths import ROOT
from wade.suites import cases, verify_crowd
from wade.suites.validate import TABLES, curves, report, results

HEADER = "case,model,spacing_m,particles,metric,value,unit,threshold,pass,wall_s,cpu_s,reference"
CASES = [cases.Case("wave 0.1 0.05 0.025 quick=medium"), cases.Case("river 0.25 0.125 long=medium"),
         cases.Case("crowd 0")]


def run_of(case, level, spacing, error, fingerprint="now"):
    return {
        "case": case, "level": level, "status": "completed", "error": "", "truth": "The truth.",
        "reference": "somebody 1900",
        "model": "dfsph", "spacing_m": spacing, "particles": 10, "steps": 5, "particle_steps": 50.0, "simulated_s": 2.0,
        "solver_cpu_s": 1.5, "solver_wall_s": 3.0, "threads": 1, "processor": "P", "processors": 2, "compiler": "C",
        "version": "0",
        "git": "abc", "fingerprint": fingerprint,
        "metrics": [{"name": "height", "value": error, "unit": "1"}, {"name": "rest", "value": 7.0, "unit": "m"}],
        "curves": [{"name": "line", "file": f"{case}-{level}-line.csv",
                    "columns": ["x_m", "height_m", "exact_height_m"]}],
    }  # fmt: skip


class Order(unittest.TestCase):
    def test_of_a_power_law(self):
        self.assertAlmostEqual(results.observed_order([0.4, 0.2, 0.1], [0.16, 0.04, 0.01]), 2)

    def test_none_where_errors_do_not_fall(self):
        self.assertIsNone(results.observed_order([0.4, 0.2, 0.1], [0.03, 0.02, 0.04]))
        self.assertIsNone(results.observed_order([0.4, 0.2, 0.1], [0.01, 0.02, 0.04]))
        self.assertIsNone(results.observed_order([0.4, 0.2], [0.2, 0.1]))
        self.assertIsNone(results.observed_order([0.4, 0.2, 0.1], [1e-7, 5e-8, 0]))
        self.assertIsNone(results.observed_order([0.4, 0.2, 0.1], [0.1, None, 0.02]))


class Reporting(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.out = Path(folder.name)
        (self.out / "runs").mkdir()
        (self.out / "t.csv").write_text("case,metric,coarse,medium,fine,reason\nwave,height,0.2,,0.02,because, it, is\n")
        (self.out / "k.csv").write_text("case,metric,level,guard,reason\nwave,height,fine,0.05,thin\n")
        self.judge = results.Judge(self.out / "t.csv", self.out / "k.csv")
        pictured = mock.patch.object(curves, "PICTURED", ("wave",))
        pictured.start()
        self.addCleanup(pictured.stop)

    def put(self, run):
        (self.out / "runs" / f"{run['case']}-{run['level']}.json").write_text(json.dumps(run))
        for curve in run["curves"]:
            (self.out / "runs" / curve["file"]).write_text("x_m,height_m,exact_height_m\n0,1,1\n1,,2\n2,3,3\n")

    def test_verdicts(self):
        def verdict(level, value):
            run = run_of("wave", level, 0.1, value)
            return self.judge.verdict(run, run["metrics"][0])

        self.assertEqual(verdict("coarse", 0.2), "yes")
        self.assertEqual(verdict("coarse", 0.21), "no")
        self.assertEqual(verdict("medium", 0.1), "yes")
        self.assertEqual(verdict("fine", 0.04), "known")
        self.assertEqual(verdict("fine", 0.06), "no")
        self.assertEqual(verdict("fine", None), "no")

    def test_of_several_starts_the_report_has_the_median_and_the_range(self):
        run = run_of("wave", "coarse", 0.1, 0.25, report.stamp("now", 5)) | {"starts": 5}
        run["metrics"][0] |= {"low": 0.15, "high": 0.5}
        self.put(run)
        found = results.read_runs(self.out / "runs", CASES)
        report.write(found, CASES, self.judge, lambda case: "now", self.out)
        text = (self.out / "report.md").read_text()
        self.assertIn("**height** 0.25 (0.15 to 0.5) (limit 0.2)", text)
        self.assertNotIn("another version", text)
        self.assertEqual(self.judge.verdict(run, run["metrics"][0]), "no")

    def test_a_known_failure_that_passes_is_listed(self):
        runs_found = [run_of("wave", "coarse", 0.1, 0.1), run_of("wave", "fine", 0.1, 0.01)]
        lines = list(self.judge.now_pass(runs_found))
        self.assertEqual(lines, ["known failure that now passes: wave fine: height = 0.01, threshold 0.02"])
        self.assertEqual(list(self.judge.now_pass([run_of("wave", "fine", 0.1, 0.04)])), [])

    def test_table_and_report_hold_every_run(self):
        for level, spacing, error in (("coarse", 0.1, 0.3), ("medium", 0.05, 0.1), ("fine", 0.025, 0.04)):
            self.put(run_of("wave", level, spacing, error, "now" if level != "fine" else "before"))
        failed = run_of("crowd", "coarse", 0, 0)
        failed.update(status="failed", error="it ran away", metrics=[], curves=[])
        self.put(failed)
        found = results.read_runs(self.out / "runs", CASES)
        self.assertEqual(len(found), 4)
        results.write_table(found, self.judge, self.out / "validation.csv")
        report.write(found, CASES, self.judge, lambda case: "now", self.out)

        lines = (self.out / "validation.csv").read_text().splitlines()
        self.assertEqual(lines[0], HEADER)
        rows = list(csv.DictReader(lines))
        self.assertEqual([row["pass"] for row in rows], ["no", "", "yes", "", "no", "", "no"])
        self.assertEqual(rows[-1]["metric"], "run_completed")
        text = (self.out / "report.md").read_text()
        for words in ("**FAIL** (known)", "it ran away", "The truth.", "because, it, is", "another version", "| 1.5 |"):
            self.assertIn(words, text)
        picture = self.out / "figures" / "wave.png"
        self.assertLess(picture.stat().st_size, 60_000)
        plan = [(case, level) for case, level in cases.plan(CASES, "wave,crowd", "", False, False)]
        self.assertEqual(results.print_summary(plan, found, self.judge), 1)

    def test_a_picture_whose_curves_are_not_there_stays_as_it_was_drawn(self):
        self.put(run_of("wave", "coarse", 0.1, 0.1) | {"threads": 2})
        found = results.read_runs(self.out / "runs", CASES)
        report.write(found, CASES, self.judge, lambda case: "now", self.out)
        self.assertIn("but 2 in wave coarse.", (self.out / "report.md").read_text())
        drawn = (self.out / "figures" / "wave.png").read_bytes()
        (self.out / "runs" / "wave-coarse-line.csv").unlink()
        report.write(found, CASES, self.judge, lambda case: "now", self.out)
        self.assertEqual((self.out / "figures" / "wave.png").read_bytes(), drawn)
        self.assertIn("![wave](figures/wave.png)", (self.out / "report.md").read_text())

    def test_what_was_not_run_is_listed_with_what_it_would_cost(self):
        one, two = run_of("wave", "coarse", 0.1, 0.1), run_of("wave", "medium", 0.05, 0.1)
        two["solver_cpu_s"] = 8 * one["solver_cpu_s"]
        self.assertEqual(list(report.missing_runs([one, two], CASES[:1])), [("wave", "fine", "0.025 m", "1.6 min")])
        self.assertEqual(report.seconds_expected([one], 0.05), 16 * one["solver_cpu_s"])
        self.assertEqual(list(report.missing_runs([], CASES[2:])), [("crowd", "coarse", "-", "-")])

    def test_what_was_not_run_costs_as_much_as_the_starts_that_it_has(self):
        five = run_of("splash", "coarse", 0.1, 0.1) | {"starts": 5, "solver_cpu_s": 50.0}
        long, short = cases.Case("splash 0.1 0.05 long=medium starts=5"), cases.Case("splash 0.1 0.05 starts=5")
        self.assertEqual(list(report.missing_runs([five], [long])), [("splash", "medium", "0.05 m", "2.7 min")])
        self.assertEqual(list(report.missing_runs([five], [short])), [("splash", "medium", "0.05 m", "13 min")])

    def test_runs_of_other_settings_are_held_against_these(self):
        there = self.out / "there"
        (there / "runs").mkdir(parents=True)
        other = {**run_of("wave", "coarse", 0.1, 0.4), "particle_steps": 100.0}
        (there / "runs" / "wave-coarse.json").write_text(json.dumps(other))
        here = [{**run_of(*run), "folder": self.out / "runs"}
                for run in (("wave", "coarse", 0.1, 0.2), ("river", "coarse", 0.25, 1.0))]
        text = report.beside_text(here, there, CASES, self.judge)
        self.assertIn("Of 1 limits in 1 runs of water 0 are missed here and 1 there", text)
        self.assertIn("Errors are 0.50 times those there and a particle's step costs 2.00 times as much", text)
        self.assertIn("| [wave](#wave) | coarse | height 0.4! -> 0.2 | 1.00 | 2.00 |", text)
        report.write(here, CASES, self.judge, lambda case: "now", self.out, ["/fluid/kernel=quartic_spline"], text)
        text = (self.out / "report.md").read_text()
        self.assertIn("All runs have `/fluid/kernel=quartic_spline`, whatever their scene says.", text)
        self.assertLess(text.index("## Beside the other settings"), text.index("## Verdicts"))
        self.assertEqual(report.beside_text(here[1:], there, CASES, self.judge), "No case of water is complete in both.\n")

    def test_the_program_and_the_script_read_the_same_tables(self):
        judge = results.Judge(TABLES / "thresholds.csv", TABLES / "known_failures.csv")
        for key, (guard, _) in judge.guards.items():
            self.assertGreater(guard, judge.thresholds[key], key)


class Guidelines(unittest.TestCase):
    def test_each_case_of_people_stands_in_the_tables_and_no_other(self):
        listed = re.findall(r"\b(crowd_\w+)_case\(\)", (ROOT / "tests/validation/cases.cpp").read_text())
        shown = " ".join([row[4] for row in verify_crowd.TESTS] + [row[1] for row in verify_crowd.BEYOND]).split()
        self.assertEqual(set(shown), set(listed))
        self.assertTrue(all(bool(names) != bool(why) for *_, names, why in verify_crowd.TESTS))

    def test_the_worst_verdict_of_a_case_is_shown(self):
        class Judge:
            def verdict(self, run, metric):
                return metric

        runs = [{"case": "a", "status": "completed", "metrics": ["yes", ""]},
                {"case": "b", "status": "completed", "metrics": ["yes", "known"]},
                {"case": "b", "status": "completed", "metrics": ["no"]},
                {"case": "c", "status": "failed", "metrics": []}, {"case": "d", "status": "completed", "metrics": [""]}]
        found = [verify_crowd.verdict_of(name, runs, Judge()) for name in "abcde"]
        self.assertEqual(found, ["pass", "**FAIL**", "**FAIL**", "reported", "not run"])


if __name__ == "__main__":
    unittest.main()
