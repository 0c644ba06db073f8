"""Front, settings and table of the sweep; runs nothing."""

import csv
import tempfile
import unittest
from dataclasses import replace
from pathlib import Path

from wade.reports.jobs import Fingerprints
from wade.suites import speed_vs_error
from wade.suites.speed_vs_error.table import cheapest_below, distance_to_front, front
from wade.suites.speed_vs_error.measure import Measured, Runner, of_seeds
from wade.suites.speed_vs_error.report import beyond_chance, overall_section
from wade.suites.speed_vs_error.settings import (FACTORS, Setting, combinations, default_setting, near_front,
                                                 one_at_a_time, probes)
from wade.suites.speed_vs_error.table import HEADER, error_of, groups_of, write_table

# What scripts outside of this project read, in this order; more columns may follow.
CONTRACT = (
    "case,model,spacing_m,tolerance,cfl,threads,particles,cpu_s_per_sim_s,wall_s_per_sim_s,particle_steps_per_s,"
    "error_metric,error,on_front"
).split(",")


class Front(unittest.TestCase):
    def test_a_point_that_is_beaten_in_both_is_off_the_front(self):
        self.assertEqual(front([(1, 4), (2, 2), (4, 1), (3, 3), (4, 2)]), [True, True, True, False, False])

    def test_equal_points_are_both_on_the_front(self):
        self.assertEqual(front([(1, 1), (1, 1), (1, 2), (2, 1)]), [True, True, False, False])

    def test_a_point_without_error_takes_no_part(self):
        self.assertEqual(front([(0.1, None), (1, 1)]), [False, True])

    def test_cheapest_below(self):
        points = [(1, 4), (2, 2), (4, 1), (1.5, None)]
        self.assertEqual(cheapest_below(points, 2.5), 1)
        self.assertEqual(cheapest_below(points, 0.5), None)

    def test_distance(self):
        cost, error = distance_to_front([(1, 1), (4, 1), (3, 0.5)], 1)
        self.assertEqual((cost, error), (4, 2))


class CommandLine(unittest.TestCase):
    def test_a_case_that_is_not_there_is_refused(self):
        there = dict.fromkeys(("dam_break", "no_error_of_its_own"))
        for cases in ("nosuch", "dam_break,nosuch", "no_error_of_its_own", ""):
            with self.subTest(cases), self.assertRaises(ValueError) as refused:
                speed_vs_error.wanted_cases(speed_vs_error.parse(["--cases", cases]), there)
            self.assertEqual(str(refused.exception),
                             f'--cases: "{cases.split(",")[-1]}" is not allowed; allowed: dam_break')


class Settings(unittest.TestCase):
    def test_the_default_is_that_of_the_schema_and_comes_first(self):
        points = one_at_a_time("dam_break", 0.1, FACTORS)
        self.assertEqual(points[0], default_setting("dam_break", 0.1))
        self.assertEqual(len(points), len(set(points)))
        for point in points[1:]:
            changed = [n for n in FACTORS if getattr(point, n) != getattr(points[0], n)]
            self.assertEqual(len(changed), 1)

    def test_each_setting_has_a_folder_of_its_own(self):
        points = one_at_a_time("dam_break", 0.1, FACTORS) + probes("dam_break", 0.1)
        self.assertEqual(len({p.key() for p in points}), len(points))

    def test_combinations_join_changes_of_different_factors(self):
        default = default_setting("dam_break", 0.1)
        near = [default, replace(default, tolerance=1e-2), replace(default, tolerance=1e-3), replace(default, cfl=1.0)]
        joined = combinations(default, near)
        self.assertEqual({(p.tolerance, p.cfl) for p in joined}, {(1e-2, 1.0), (1e-3, 1.0)})

    def test_near_front_forgives_ten_percent(self):
        self.assertEqual(near_front([("a", 1, 1), ("b", 1.05, 1.05), ("c", 2, 2)]), ["a", "b"])

    def test_no_divergence_solve(self):
        text = " ".join(replace(default_setting("dam_break", 0.1), divergence_tolerance="off").overrides())
        self.assertIn("/fluid/divergence_solve/max_iterations=0", text)


class Table(unittest.TestCase):
    def test_the_columns_that_others_rely_on(self):
        self.assertEqual(HEADER[: len(CONTRACT)], CONTRACT)

    def test_a_mean_over_metrics(self):
        self.assertEqual(error_of({"height_rms_h1": 1.0, "height_rms_h2": 3.0, "x": 9.0}, "height_rms_*"), 2.0)
        self.assertIsNone(error_of({"height_rms_h1": None}, "height_rms_*"))

    def test_rows(self):
        default = default_setting("dam_break", 0.1)
        measured = [
            Measured(default, 100, 2.0, 2.5, 1e5, 3, {"depth_l1": 0.1, "speed_l1": 0.2}),
            Measured(replace(default, cfl=1.0), 100, 1.0, 1.5, 1e5, 3, {"depth_l1": 0.05, "speed_l1": 0.3}),
            Measured(replace(default, tolerance=1e-2), 0, repeats=1, metrics={}, failure="a particle, too fast"),
            Measured(replace(default, gravity_change=1e-4), 100, 2.0, 2.5, 1e5, 3, {"depth_l1": 0.12, "speed_l1": 0.2}),
        ]
        groups = groups_of(measured)
        self.assertEqual(groups[0].spread, {0.1: (0.1, 0.12)})
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "speed_vs_error.csv"
            write_table(file, groups)
            rows = list(csv.DictReader(file.read_text().splitlines()))
        self.assertEqual(len(rows), 6)
        self.assertEqual([r["on_front"] for r in rows], ["no", "yes", "no", "yes", "yes", "no"])
        self.assertEqual(rows[0]["is_default"], "yes")
        self.assertEqual((rows[2]["error"], rows[2]["failure"]), ("", "a particle, too fast"))


    def test_seeds_of_a_model_are_one_point(self):
        setting = Setting("impulse_river", 0.5, model="kinematic")
        runs = [
            Measured(replace(setting, seed=k), 10, cpu, cpu, 1e5, 1,
                     {"impulse_median": error, "outcome_changed": other})
            for k, cpu, error, other in ((1, 3.0, 0.1, 0.0), (2, 1.0, 0.5, 0.2), (3, 2.0, 0.2, 0.4))
        ]
        point = of_seeds(setting, runs)
        self.assertEqual((point.cpu, point.repeats, point.setting), (2.0, 3, setting))
        self.assertEqual(point.metrics["impulse_median"], 0.2)
        self.assertEqual(point.ranges["impulse_median"], (0.1, 0.5))
        self.assertEqual(point.metrics["outcome_changed"], 0.0)  # of the scene's own crowd
        self.assertNotIn("outcome_changed", point.ranges)
        self.assertEqual(len({run.setting.key() for run in runs}), 3)

    def test_a_seed_that_fails_fails_the_point(self):
        setting = Setting("impulse_river", 0.5, model="kinematic")
        runs = [Measured(setting, metrics={"impulse_median": 0.1}), Measured(setting, metrics={}, failure="too fast")]
        self.assertEqual(of_seeds(setting, runs).failure, "too fast")


class Overall(unittest.TestCase):
    def test_within_chance_is_no_difference(self):
        self.assertEqual([beyond_chance(e, 0.1, 0.2) for e in (0.1, 0.15, 0.2, 0.4, 0.05, 9)], [1, 1, 1, 2, 0.5, 10])
        self.assertEqual((beyond_chance(0.1, 0.0, 0.0), beyond_chance(0.0, 0.0, 0.1)), (10, 1))

    def test_each_case_counts_once(self):
        measured = []
        for case, cost, error in (("dam_break", 0.5, 0.4), ("bump_subcritical", 0.125, 0.1)):
            default = default_setting(case, 0.1)
            errors = {"depth_l1": 0.1, "speed_l1": 0.1, "depth_l2": 0.1}
            measured += [
                Measured(default, 100, 1.0, metrics=errors),
                Measured(replace(default, gravity_change=1e-4), 100, 1.0, metrics=errors),
                Measured(replace(default, cfl=1.0), 100, cost, metrics=dict.fromkeys(errors, error)),
            ]
        measured.append(Measured(replace(default_setting("dam_break", 0.1), tolerance=1e-2), 100, 1.0, metrics=errors))
        lines = overall_section(groups_of(measured)).splitlines()
        self.assertIn("| cfl 1 | 0.25 | 2.00 | 2 of 3 | 4 times in dam_break, depth_l1, d = 0.1 m |", lines)
        self.assertFalse(any("tol 0.01" in line for line in lines))  # of one case only


class Running(unittest.TestCase):
    def point(self, script, time_limit):
        program = Path(self.folder.name) / "validate"
        program.write_text("#!/bin/sh\n" + script)
        program.chmod(0o755)
        runner = Runner(program, Path(self.folder.name) / "points", Fingerprints([program], Path(self.folder.name), ()),
                        1, time_limit)
        return runner.run(default_setting("dam_break", 0.1))

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def test_a_crash_is_noted(self):
        self.assertIn("exit code 3", self.point("exit 3\n", 10).failure)
        self.assertEqual(list(Path(self.folder.name).glob("points/*/*/result.json")), [])

    def test_a_larger_time_limit_tries_again(self):
        marker = Path(self.folder.name) / "started"
        script = f"echo >> {marker}\nexec sleep 10\n"
        for limit, starts in ((0.3, 1), (0.3, 1), (0.2, 1), (0.4, 2)):
            self.assertIn("--time-limit", self.point(script, limit).failure)
            self.assertEqual(len(marker.read_text()), starts)


if __name__ == "__main__":
    unittest.main()
