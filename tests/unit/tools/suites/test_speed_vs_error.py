"""Front, settings and table of the sweep; runs nothing."""

import csv
import math
import sys
import tempfile
import unittest
from dataclasses import replace
from pathlib import Path
from unittest import mock

import numpy as np

from wade.paths import ROOT
from wade.reports.jobs import Fingerprints
from wade.suites import speed_vs_error
from wade.suites.speed_vs_error.table import cheapest_below, distance_to_front, front
from wade.suites.speed_vs_error.measure import Measured, Runner, of_seeds
from wade.suites.speed_vs_error.report import PICTURE, beyond_chance, overall_section, with_section
from wade.suites.speed_vs_error.settings import (FACTORS, Setting, combinations, default_setting, near_front,
                                                 one_at_a_time, probes)
from wade.suites.speed_vs_error.table import HEADER, error_of, groups_of, write_table

sys.path.append(str(ROOT / "tests" / "validation"))
import beside_cases as truths  # noqa: E402

from wade.suites.speed_vs_error import beside_splishsplash as beside  # noqa: E402

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


# Stands for both engines: water at rest, 1 m deep, that moves at a tenth of sqrt(g H) and carries 0.9 of its weight. It
# says that the peer took twice as many seconds for half as many steps.
STUB = """#!{python}
import json, math, sys
from pathlib import Path
import numpy as np
words = sys.argv[1:]
peer = words[0] != "--frames"
out = Path(words[2])
places = (np.mgrid[0:10, 0:10, 0:10].reshape(3, -1) + 0.5) * 0.1
speeds = np.zeros((3, 1000)); speeds[0] = 0.1 * math.sqrt(9.81)
pressure = 0.9 * 1000 * 9.81 * (1 - places[1])
with open(out / "frames.bin", "wb") as file:
    for time in (1.0, 3.0, 4.0):
        file.write(np.float64(time).tobytes() + np.uint64(1000).tobytes())
        file.write(np.vstack([places, speeds, pressure]).astype(np.float32).tobytes())
cost = dict(engine="Peer 1" if peer else "Wade", particles=1000, particle_mass_kg=1, rest_density_kg_m3=1000,
            steps=100 if peer else 200, particle_steps=1e5 if peer else 2e5, simulated_s=4.0,
            solver_cpu_s=4.0 if peer else 2.0, solver_wall_s=9.0, density_iterations=2, divergence_iterations=1,
            mean_density_error=0.002 if peer else 0.001, max_density_error=0.1)
(out / "cost.json").write_text(json.dumps(cost))
"""


def scene_named(name):
    return next(scene for scene in beside.SCENES if scene.name == name)


class BesideSPlisHSPlasH(unittest.TestCase):
    def run_main(self, folder, *words):
        stub = Path(folder) / "tests" / "bench" / "bench_fluid"
        stub.parent.mkdir(parents=True)
        stub.write_text(STUB.format(python=sys.executable))
        stub.chmod(0o755)
        with mock.patch.object(beside, "BUILD", Path(folder)), mock.patch.object(beside, "VARIANTS", {"default": {}}):
            return speed_vs_error.main(["--splishsplash", str(stub), "--out", folder, "--repeats", "1", *words])

    def test_known_costs_and_errors_come_out(self):
        with tempfile.TemporaryDirectory() as folder:
            self.assertEqual(self.run_main(folder, "--cases", "column_0.05"), 0)
            out = Path(folder) / "beside_splishsplash"
            with open(out / beside.TABLE, newline="") as file:
                rows = {(row["setting"][:6], row["error_metric"]): row for row in csv.DictReader(file)}
            for engine, cost in (("tolera", 0.5), ("volume", 1.0)):
                row = rows[(engine, "rms_speed")]
                self.assertAlmostEqual(float(row["error"]), 0.1, places=4)
                self.assertAlmostEqual(float(row["cpu_s_per_sim_s"]), cost)
                # The middle of the lowest layer lies at 0.95 of the depth.
                self.assertAlmostEqual(float(rows[(engine, "bed_pressure")]["error"]), 0.1 * 0.95, places=4)
                self.assertAlmostEqual(float(rows[(engine, "level")]["error"]), 0, places=4)
            report = (out / "report.md").read_text()
            self.assertRegex(report, r"\| default +\| 1000 +\| 20 +\| 0.1 +\| 0.5 +\| 4.0 +\| 2.0 +\|")
            self.assertTrue((out / PICTURE).is_file())

    def test_a_program_or_scene_that_is_not_there_is_refused(self):
        with tempfile.TemporaryDirectory() as folder:
            self.assertEqual(speed_vs_error.main(["--splishsplash", f"{folder}/none", "--out", folder]), 2)
            self.assertEqual(self.run_main(folder, "--cases", "none"), 2)

    def test_both_engines_get_the_same_volume_of_water(self):
        for scene in (s for s in beside.SCENES if s.kind == "spheric2"):
            block, d = beside.splishsplash_scene(scene)["FluidBlocks"][0], scene.spacing
            sides = [b - a for a, b in zip(block["start"], block["end"])]
            # As SPlisHSPlasH counts the particles of its denser pattern.
            rows = [round(side / d) - 2 for side in sides[::2]] + [round(sides[1] / (math.sqrt(3) / 2 * d)) - 1]
            asked = math.prod(scene.block)
            self.assertAlmostEqual(math.prod(rows) * 0.8 * d**3, asked, delta=asked / rows[2] / 2 * 1.001)

    def test_compression_of_a_lattice_that_is_squeezed(self):
        scene = scene_named("column_0.05")
        d = scene.spacing
        places = (np.mgrid[0:20, 0:20, 0:20].reshape(3, -1) + 0.5) * d
        frame = truths.Frame(0, places, np.zeros_like(places), np.zeros(8000))
        less, more = (truths.compression(scene, frame, volume * d**3) for volume in (1.05, 1.1))
        # Two of the eighteen layers away from the bed are near the surface, where less is seen.
        self.assertAlmostEqual(less, 0.05, delta=0.05 * 2 / 18)
        self.assertAlmostEqual(more, 0.1, delta=0.1 * 2 / 18)
        self.assertIsNone(truths.compression(scene_named("river"), frame, d**3))

    def test_the_truths_are_those_of_the_validation(self):
        front = truths.martin_and_moyce()
        self.assertEqual((len(front), front[0], front[-1]), (14, (0.41, 1.11), (3.11, 3.89)))
        heights, pressures, peaks = truths.kleefsman()
        self.assertEqual((heights[3][0], pressures[0][2], peaks), (0.55, 6564, [9658, 6310]))

    def test_a_river_that_is_exact_has_no_error(self):
        scene, time = scene_named("river"), 28
        speed, wave = scene.velocity, math.sqrt(scene.gravity)
        pace = np.linspace(0, (speed + 2 * wave) * time, 20001)[:-1]
        xi = np.maximum(pace / time, speed - wave)
        c = (speed + 2 * wave - xi) / 3
        # A particle a short stretch, as heavy as its water: repeated by weight, which the measure takes as equal volumes.
        counts = np.round(1000 * c**2 / scene.gravity).astype(int)
        x = scene.tank[0] - np.repeat(pace, counts)
        v = np.zeros((3, x.size))
        v[0] = -np.repeat(xi + c, counts)
        volume = (pace[1] - pace[0]) * scene.tank[2] / 1000
        frame = truths.Frame(time, np.vstack([x, x * 0, x * 0]), v, x * 0)
        errors = truths.measure_river(scene, [frame], volume)
        self.assertLess(errors["depth"], 2e-3)
        self.assertLess(errors["speed"], 5e-3)

    def test_the_section_of_a_report_is_replaced_or_added(self):
        part = "## Beside SPlisHSPlasH\n\nnew\n"
        self.assertEqual(with_section("# A\n\nx\n", part), "# A\n\nx\n\n" + part)
        old = "# A\n\n## Beside SPlisHSPlasH\n\nold\n\n## Remarks\n"
        self.assertEqual(with_section(old, part), "# A\n\n" + part + "\n## Remarks\n")


if __name__ == "__main__":
    unittest.main()
