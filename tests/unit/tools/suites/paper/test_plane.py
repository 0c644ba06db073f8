"""The sections on depth times velocity, on a sweep that is made up."""

import csv
import tempfile
import unittest
from pathlib import Path
from unittest import mock

from test_limits import SCENE

from wade.suites.paper import plane
from wade.suites.paper.report import Context
from wade.sweeps import depth_sweep

# depth, m: number of 10 that arrive at 0.5, 1 and 2 m/s
ARRIVED = {0.5: (10, 10, 10), 1.0: (10, 8, 2), 1.5: (6, 0, 0)}
SPEEDS = (0.5, 1.0, 2.0)


def rows_of_sweep(tau=0.8):
    for depth, numbers in ARRIVED.items():
        for speed, arrived in zip(SPEEDS, numbers):
            product = depth * speed
            yield {"scene": "made_up", "tau": tau, "depth_m": depth, "v_f_m_s": speed, "dv_m2_s": product,
                   "level": depth_sweep.level_of(product), "seed": 1, "agents": 10, "arrived": arrived,
                   "dead": 10 - arrived, "active": 0, "last_arrival_s": 50.0, "level_met": "low",
                   "agents_at_level_met": 10, "commit": "abc", "until_s": ""}


class Plane(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="wade-test-")
        self.addCleanup(temporary.cleanup)
        self.out = Path(temporary.name)
        patch = mock.patch.object(plane, "resolved", lambda _scene: SCENE)
        patch.start()
        self.addCleanup(patch.stop)

    def section(self):
        return plane.plane_section(Context({}, ["observed"], {}, out=self.out))

    def write(self, columns=depth_sweep.COLUMNS):
        with (self.out / "depth_sweep.csv").open("w", newline="", encoding="utf-8") as file:
            table = csv.DictWriter(file, columns, extrasaction="ignore")
            table.writeheader()
            table.writerows(rows_of_sweep())

    def test_half_arrive_between_two_velocities(self):
        products, depths = plane.half_products(list(rows_of_sweep()))
        self.assertEqual(depths, 3)
        self.assertEqual(set(products), {1.0, 1.5}, "in 0.5 m all arrive at every velocity")
        self.assertAlmostEqual(products[1.0], 2**0.5, msg="half-way between 1 and 2 m/s in the logarithm")
        self.assertAlmostEqual(products[1.5], 1.5 * 0.5 * 2 ** (1 / 6), msg="a sixth of the way from 6 of 10 to none")

    def test_levels_count_points_and_people(self):
        levels = plane.by_level(list(rows_of_sweep()))
        self.assertEqual({level: points for level, (points, _) in levels.items()},
                         {"low": 1, "moderate": 2, "high": 1, "very_high": 5})
        self.assertEqual(levels["high"][1], 0.6)
        self.assertEqual(levels["very_high"][1], (10 + 8 + 2 + 0 + 0) / 50)

    def test_the_section_draws_the_sweep_and_names_its_commit(self):
        self.write()
        text = self.section()
        self.assertIn("9 points, depths of 0.5 to 1.5 m and v_F of 0.5 to 2 m/s", text)
        self.assertIn("seeds 1 to 1, programs of commit abc", text)
        self.assertIn("half arrive at H v_F of 0.84 to 1.41 m2/s at 2 of 3 depths, elsewhere", text)
        self.assertIn("stand against up to 0.53 m2/s", text)
        self.assertGreater((self.out / "depth_sweep.png").stat().st_size, 10000)

    def test_the_legend_lies_within_the_picture_for_one_tau_and_for_two(self):
        rows = [{name: str(value) for name, value in row.items()} for row in rows_of_sweep()]
        for taus in ((0.8,), (0.2, 0.8)):
            with self.subTest(taus=taus), mock.patch.object(depth_sweep.pyplot, "close"):
                chosen = [{**row, "tau": str(tau)} for row in rows for tau in taus]
                depth_sweep.draw(chosen, SCENE, self.out / "plane.png")
            drawing = depth_sweep.pyplot.gcf()
            self.addCleanup(depth_sweep.pyplot.close, drawing)
            legend = drawing.legends[0].get_window_extent()
            self.assertTrue(drawing.bbox.x0 <= legend.x0 and legend.x1 <= drawing.bbox.x1,
                            f"{legend} in {drawing.bbox}")

    def test_without_a_sweep_there_is_no_section(self):
        self.assertEqual(self.section(), "")

    def test_a_table_with_other_columns_is_named_and_stays(self):
        self.write(depth_sweep.COLUMNS[:-1])
        before = (self.out / "depth_sweep.csv").read_bytes()
        self.assertIn("expected are scene,tau,depth_m", self.section())
        self.assertEqual((self.out / "depth_sweep.csv").read_bytes(), before)

    def test_runs_of_another_length_are_not_gone_on_with(self):
        self.write()
        self.assertEqual(len(depth_sweep.rows_to_go_on_with(self.out / "depth_sweep.csv", None)), 9)
        with self.assertRaisesRegex(depth_sweep.TableError, "--until-s of the scene"):
            depth_sweep.rows_to_go_on_with(self.out / "depth_sweep.csv", 5.0)


if __name__ == "__main__":
    unittest.main()
