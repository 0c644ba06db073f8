"""The closed form of people that withstand the water, and the sections on depth times velocity, on a made-up sweep."""

import copy
import csv
import math
import tempfile
import unittest
from pathlib import Path
from unittest import mock

from wade import UsageError
from wade.suites.paper import plane
from wade.suites.paper.report import Context
from wade.sweeps import depth_sweep, limits

SCENE = {
    "channel": {"x_min_m": 0, "z_min_m": 11.5, "z_max_m": 38.5, "depth_m": 1, "velocity_m_s": 1.5},
    "coupling": {"contact_rule": "difference", "agent_radius_m": 0.5, "particle_radius_m": 0.25},
    "crowd": {
        "speed_rule": "pi",
        "groups": [{"tau": 0.8, "mass_kg": 65, "desired_speed_m_s": 1.3, "columns": 10,
                    "start": {"x_m": 65, "pitch_x_m": 2.5}}],
    },
    "fluid": {"rest_density_kg_m3": 1000},
}
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


def scene_with(**group):
    scene = copy.deepcopy(SCENE)
    scene["crowd"]["groups"][0].update(group)
    return scene


class Limits(unittest.TestCase):
    def test_numbers_have_one_limit(self):
        # 0.989 * 1.3 * 65 / (0.8 * 1000 * pi * 0.25^2)
        low, high = limits.limits_of(SCENE)
        self.assertAlmostEqual(low, 0.532026, places=5)
        self.assertEqual(low, high)
        self.assertAlmostEqual(limits.of_limit(SCENE), 1.5 / low)

    def test_a_drawn_tau_has_the_limits_of_its_ends(self):
        low, high = limits.limits_of(scene_with(tau={"min": 0.4, "max": 0.8}))
        self.assertAlmostEqual(low, limits.limits_of(scene_with(tau=0.8))[0])
        self.assertAlmostEqual(high, limits.limits_of(scene_with(tau=0.4))[0])

    def test_people_without_a_tau_are_refused_by_name(self):
        by_body = scene_with(name="walkers")
        del by_body["crowd"]["groups"][0]["tau"]
        for ask in (limits.limits_of, limits.of_limit):
            with self.assertRaisesRegex(UsageError, '"walkers" has no tau, as /crowd/response is "measured"'):
                ask(by_body)
        self.assertAlmostEqual(limits.of_limit(by_body, tau=0.8), limits.of_limit(SCENE))

    def test_the_lightest_who_yields_most_has_the_lowest_limit(self):
        low, high = limits.limits_of(scene_with(tau={"min": 0.4, "max": 0.8}, mass_kg={"min": 40, "max": 100}))
        self.assertAlmostEqual(low, limits.limits_of(scene_with(tau=0.8, mass_kg=40))[0])
        self.assertAlmostEqual(high, limits.limits_of(scene_with(tau=0.4, mass_kg=100))[0])

    def test_a_drawn_tau_from_0_on_has_no_highest_limit(self):
        self.assertEqual(limits.limits_of(scene_with(tau={"min": 0, "max": 0.8}))[1], math.inf)

    def test_one_number_is_that_of_the_mean_agent(self):
        drawn = scene_with(tau={"min": 0.4, "max": 0.8}, mass_kg={"min": 40, "max": 100})
        mean = scene_with(tau=0.6, mass_kg=70)
        self.assertAlmostEqual(limits.of_limit(drawn), limits.of_limit(mean))
        self.assertAlmostEqual(limits.loss_velocity(drawn, 0.6), limits.loss_velocity(mean, 0.6))

    def test_words(self):
        self.assertEqual(limits.in_words(0.2), "0.2")
        self.assertEqual(limits.in_words({"min": 0.4, "max": 0.8}), "0.4 to 0.8")

    def test_the_speed_rule_decides_the_walking_speed(self):
        scene = copy.deepcopy(SCENE)
        scene["crowd"]["speed_rule"] = "per_frame"
        self.assertEqual(limits.walking_speed(scene), 1.3)

    def test_the_sweep_takes_its_own_tau_and_the_mass_of_the_scene(self):
        drawn = scene_with(tau=0.2, mass_kg={"min": 40, "max": 100})
        low, high = depth_sweep.limit_of(drawn, 0.8)
        self.assertAlmostEqual(low, 0.532026 * 40 / 65, places=5)
        self.assertAlmostEqual(high, 0.532026 * 100 / 65, places=5)
        self.assertEqual(drawn["crowd"]["groups"][0]["tau"], 0.2)
        self.assertEqual(depth_sweep.limit_in_words((0.5, 0.5)), "0.50")
        self.assertEqual(depth_sweep.limit_in_words((0.5, 1.0)), "0.50 to 1.00")
        self.assertAlmostEqual(depth_sweep.limit_of(SCENE, {"min": 0.4, "max": 0.8})[1], 2 * 0.532026, places=4)


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
