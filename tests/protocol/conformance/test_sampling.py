"""The check `sampling`: its integral of the cone, and its verdict on uniform water from cells of any size."""

import json
import math
import re
import subprocess
import sys
import tempfile
import unittest
from array import array
from dataclasses import dataclass, field
from pathlib import Path

from wade.conformance.checks_sampling import Water, blocks_of, judge, mean_of_cone
from wade.conformance.expectation import NotApplicable, Violation

ROOT = Path(__file__).resolve().parents[3]
DEPTH, SPEED = 0.8, 1.2
CELLS = (0.25, 0.5, 0.75, 1, 1.5, 2)


@dataclass
class UniformWater:
    """Header and frame of a stream 0.8 m deep, 1.2 m/s, from square cells: 20 m x 14 m."""

    cell: float
    column_width: tuple = (0.0, 0.0)
    particle_radius: float = 0.0
    rest_density: float = 1000.0
    metres_per_unit: float = 1.0
    origin: tuple = (0.0, 0.0, 0.0)
    axes: tuple = (1, 2, 3)
    fields: list = field(default_factory=list)
    frame: int = 1

    def __post_init__(self):
        cells = [(i, j) for j in range(round(14 / self.cell)) for i in range(round(20 / self.cell))]
        self.count = len(cells)
        values = ([1000 * DEPTH * self.cell**2] * self.count, [-0.6 * SPEED] * self.count, [0] * self.count,
                  [0.8 * SPEED] * self.count, [self.cell * (i + 0.5) for i, _ in cells], [DEPTH / 2] * self.count,
                  [self.cell * (j + 0.5) for _, j in cells])
        self.fields = [array("f", each).tobytes() for each in values]


def columns(cell):
    return UniformWater(cell, (cell, cell))


class Cone(unittest.TestCase):
    def test_its_mean_over_a_rectangle_is_that_of_many_points(self):
        """The rule of four points leaves 5e-4, counting squares of 1/100 of the rectangle 5e-4."""
        n = 100
        for x, z, width_x, width_z in ((0, 0, 1, 1), (0.3, -0.7, 0.5, 0.4), (1.2, 0.9, 2, 4), (0.9, 0, 0.3, 0.3), (0, 0, 4, 4)):
            with self.subTest(x=x, z=z, width_x=width_x, width_z=width_z):
                points = [(k + 0.5) / n - 0.5 for k in range(n)]
                counted = sum(max(0, 1 - math.hypot(x + a * width_x, z + b * width_z)) for a in points for b in points) / n**2
                self.assertAlmostEqual(mean_of_cone(x, z, width_x, width_z), counted, delta=1e-3)

    def test_columns_side_by_side_have_the_whole_cone(self):
        """The rule of four points leaves 1e-3."""
        for cell in (0.5, 1.3, 2, 4):
            whole = sum(mean_of_cone(i * cell + 0.37, j * cell - 0.11, cell, cell) for i in range(-4, 5) for j in range(-4, 5))
            self.assertAlmostEqual(whole * cell * cell, math.pi / 3, delta=1e-3)


class Verdicts(unittest.TestCase):
    def test_columns_of_uniform_water_are_sampled_within_3_percent_everywhere(self):
        for cell in CELLS:
            with self.subTest(cell=cell):
                water = Water(columns(cell), columns(cell))
                for block in blocks_of(water):
                    for sample in block.samples:
                        self.assertAlmostEqual(sample.depth, DEPTH, delta=0.03 * DEPTH)
                        self.assertAlmostEqual(sample.speed, SPEED, delta=0.03 * SPEED)
                self.assertIn("columns of", judge(water))

    def test_one_point_a_cell_passes_up_to_a_quarter_metre(self):
        self.assertIn("points, R = 0.5 m", judge(Water(UniformWater(0.25), UniformWater(0.25))))
        for cell in CELLS[1:]:
            with self.subTest(cell=cell), self.assertRaisesRegex(Violation, "Remedy: .*Header.column_width.*wade_columns"):
                judge(Water(UniformWater(cell), UniformWater(cell)))

    def test_particles_of_a_solver_are_sampled_within_1_5_spacings(self):
        solver = UniformWater(0.5, particle_radius=0.25)
        self.assertIn("points, R = 0.75 m", judge(Water(solver, solver)))
        too_small = UniformWater(1, particle_radius=0.25)
        with self.assertRaisesRegex(Violation, "at most 60 %"):
            judge(Water(too_small, too_small))

    def test_the_spacing_of_the_scene_stands_over_a_radius_that_the_producer_claims(self):
        claimed = UniformWater(1, particle_radius=0.5)
        self.assertIn("R = 1.5 m", judge(Water(claimed, claimed)))
        with self.assertRaisesRegex(Violation, "R = 0.696 m"):
            judge(Water(claimed, claimed, 0.4642))

    def test_units_and_axes_of_the_stream_do_not_matter(self):
        stored = columns(1)
        stored.metres_per_unit, stored.axes, stored.origin = 0.5, (-3, 2, 1), (7.0, 0.0, -3.0)
        stored.column_width = (0.5, 0.5)
        self.assertIn("speed 0.6 .. 0.6", judge(Water(stored, stored)))

    def test_a_narrow_stream_is_left_to_itself(self):
        narrow = UniformWater(0.125)
        narrow.count = 800  # five rows
        narrow.fields = [data[: 4 * 800] for data in narrow.fields]
        with self.assertRaisesRegex(NotApplicable, "3 m wide"):
            judge(Water(narrow, narrow))


class Page(unittest.TestCase):
    def test_the_table_of_the_page_is_true(self):
        """Positions over a whole cell, 1/40 of it apart, which tell areas to 1 %; the page has two digits."""
        text = (ROOT / "docs" / "people_in_water.md").read_text()
        rows = re.findall(r"(?m)^\| ([\d.]+) m \| ([\d.]+) to ([\d.]+) m \| (\d+) % \| ([\d.]+) m \|$", text)
        self.assertEqual([float(row[0]) for row in rows], list(CELLS))
        for cell, least, most, dry, of_columns in (map(float, row) for row in rows):
            with self.subTest(cell=cell):
                points, exact = Water(UniformWater(cell), UniformWater(cell)), Water(columns(cell), columns(cell))
                places = [cell * (6 + k / 40) for k in range(40)]
                depths = [points.sample(x, z).depth for x in places for z in places]
                self.assertEqual((f"{min(depths):.2g}", f"{max(depths):.2g}"), (f"{least:.2g}", f"{most:.2g}"))
                self.assertAlmostEqual(100 * depths.count(0) / len(depths), dry, delta=1.5)
                self.assertAlmostEqual(sum(depths) / len(depths), DEPTH, delta=0.01 * DEPTH)
                self.assertAlmostEqual(exact.sample(places[3], places[17]).depth, of_columns, delta=0.01 * of_columns)


class Producer(unittest.TestCase):
    """The model for owners of a depth-averaged code, as a process."""

    def verdict(self, *options):
        with tempfile.TemporaryDirectory(prefix="wade-sampling-") as folder:
            report = Path(folder) / "report.json"
            words = [ROOT / "tools" / "conformance.sh", "--only=header", "--only=frames", "--only=plausible", "--only=sampling",
                     "--keep-going", "--report", report, "--", sys.executable, "-B",
                     ROOT / "tools" / "producers" / "python" / "producer_columns.py", *options]
            subprocess.run(list(map(str, words)), stdout=subprocess.DEVNULL, check=False)
            return [check["verdict"] for check in json.loads(report.read_text())["checks"]]

    def test_columns_pass_and_points_fail(self):
        self.assertEqual(self.verdict("--cell-m", "2.5"), ["pass"] * 4)
        self.assertEqual(self.verdict("--cell-m", "1", "--points"), ["pass"] * 3 + ["FAIL"])


if __name__ == "__main__":
    unittest.main()
