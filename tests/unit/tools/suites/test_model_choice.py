"""The choice of the model: errors, the table and its measurements, the report. Runs nothing."""

import tempfile
import unittest
from pathlib import Path

from wade.suites.model_choice import report, runs, table
from wade.suites.model_choice.table import SCENES


def row(**values):
    usual = {
        "scene": "river_deep", "demand": "0.1", "kind": "river", "chosen": "dfsph, d = 0.2 m", "pilot": "",
        "went_up": "no",
        "estimated_median": "0.05", "estimated_p95": "0.2", "actual_median": "0.02", "actual_p95": "0.1", "held": "yes",
        "default_median": "0.2", "particle_steps": "1", "cpu_s_per_sim_s": "1", "cost_over_default": "2",
        "choice_cpu_s": "0.1",
    }
    return usual | values


class Errors(unittest.TestCase):
    def test_error_is_relative_to_the_load_of_the_finest_run(self):
        truth = {0: (-3.0, 4.0, 10.0), 1: (1.0, 0.0, 1.0), 2: (0.0, 0.0, 0.0)}
        standing = {0: (0.0, 0.0, 0.0), 1: (1.0, 0.25, 1.1), 2: (5.0, 0.0, 5.0)}
        self.assertEqual(runs.errors_of(standing, truth), [0.5, 0.25])
        median, p95 = runs.median_and_p95(standing, truth)
        self.assertAlmostEqual(median, 0.375)
        self.assertAlmostEqual(p95, 0.4875)

    def test_standing_table_is_read_as_it_was_stored(self):
        document = {
            "particles": 1, "steps": 2, "solver_cpu_s": 3.0,
            "standing_columns": ["agent", "impulse_x_kg_m", "impulse_z_kg_m", "load_kg_m"],
            "standing": [[7, -1.5, 0.25, 2.0]],
        }
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "standing.csv"
            runs.store_standing(document, ["command"], file)
            self.assertEqual(runs.read_standing(file), {7: (-1.5, 0.25, 2.0)})

    def test_what_is_there_is_not_run_again(self):
        with tempfile.TemporaryDirectory() as folder:
            scene = runs.file_of("river_deep")
            self.assertIsNone(runs.run(scene, [], Path(folder), only_stored=True))
            self.assertEqual(list(Path(folder).iterdir()), [])


class Table(unittest.TestCase):
    def test_finest_run_has_an_error_too(self):
        self.assertAlmostEqual(table.beyond_finest("river", "dfsph", 2 * SCENES["river"][2]), 2)
        self.assertEqual(table.beyond_finest("river", "shallow_water", 0.1), 1)

    def test_the_table_of_the_server_is_what_the_measurements_give(self):
        self.assertEqual(table.TABLE.read_text(), table.table_text())

    def test_scenes_of_the_check_are_not_in_the_table(self):
        measured = {Path(scene).stem for scene, _, _ in SCENES.values()}
        self.assertFalse(measured & set(runs.FINEST))
        for name in runs.FINEST:
            self.assertTrue((runs.ROOT / runs.file_of(name)).exists(), name)


class Report(unittest.TestCase):
    def test_counts_what_held_and_names_what_did_not(self):
        rows = [row(), row(demand="0.05", held="no", actual_median="0.07"),
                row(demand="0.3", refused="x; allowed: >= 0.4.")]
        lines = "\n".join(report.summary(rows))
        self.assertIn("Of 3 demands in 1 scenes 2 were taken on and 1 refused", lines)
        self.assertIn("**1 of 2 held**", lines)
        self.assertIn("* river_deep, demand 0.05: dfsph, d = 0.2 m, estimated 0.05, actual 0.07", lines)
        self.assertIn("In 2 of 2 dfsph was chosen with less than twice the spacing", lines)
        self.assertIn("refused; allowed: >= 0.4", report.table(rows))
        with tempfile.TemporaryDirectory() as folder:
            report.write(rows, ["river_deep"], Path(folder))
            self.assertIn("## All demands", (Path(folder) / "report.md").read_text())


if __name__ == "__main__":
    unittest.main()
