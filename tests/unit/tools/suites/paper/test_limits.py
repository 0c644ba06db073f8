"""The closed form, for a tau and a mass that are numbers or drawn, and its use in the sweep over depth and velocity."""

import copy
import math
import unittest

from wade.sweeps import limits
from wade.sweeps import depth_sweep

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


if __name__ == "__main__":
    unittest.main()
