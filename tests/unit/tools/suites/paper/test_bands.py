"""The bands of bands on results that are made up, and the closed form of limits.py."""

import unittest
from types import SimpleNamespace

from wade.suites.paper import bands
from wade.sweeps.limits import contact_mass, limit_velocity, loss_velocity, of_limit


def result(arrived, time=None, agents=50):
    times = None if time is None else (time, time - 1, time + 1)
    return SimpleNamespace(arrived=(arrived, arrived - 1, arrived + 1), time=times, agents=agents)


def scene(tau, velocity, rule="difference"):
    return {
        "crowd": {"groups": [{"mass_kg": 65, "desired_speed_m_s": 1.3, "tau": tau}]},
        "channel": {"velocity_m_s": velocity, "depth_m": 1},
        "fluid": {"rest_density_kg_m3": 1000},
        "coupling": {"contact_rule": rule, "agent_radius_m": 0.5, "particle_radius_m": 0.25},
    }


class Bands(unittest.TestCase):
    def test_the_papers_own_results_are_within(self):
        paper = {"S1": 46, "S4": 54, "S5": 93, "S7": 97, "S10": 140}
        for name, time in paper.items():
            self.assertTrue(bands.judge_scenario(name, result(50, time)).holds, name)
        self.assertTrue(bands.judge_scenario("S6", result(35, 160)).holds)
        for name in bands.NOBODY:
            self.assertTrue(bands.judge_scenario(name, result(0)).holds, name)

    def test_times_and_numbers_outside_are_not(self):
        self.assertFalse(bands.judge_scenario("S1", result(50, 43.2)).holds)
        self.assertFalse(bands.judge_scenario("S4", result(40, 54)).holds)
        self.assertFalse(bands.judge_scenario("S6", result(29, 160)).holds)
        self.assertFalse(bands.judge_scenario("S8", result(13, 186)).holds)
        self.assertFalse(bands.judge_scenario("S10", result(0)).holds)

    def test_what_was_not_run_is_not_judged(self):
        self.assertIsNone(bands.judge_scenario("S5", None).holds)
        self.assertIsNone(bands.judge_obstacle(result(26), None).holds)
        self.assertIsNone(bands.judge_lee(None).holds)
        self.assertFalse(bands.judge_lee((0.0, 26.0, 30)).holds, "judged at 15 s")
        self.assertIsNone(bands.judge_particles({"S5": (result(50), None)}).holds)

    def test_the_obstacle_must_help_beyond_the_intervals(self):
        self.assertTrue(bands.judge_obstacle(result(26, agents=52), result(8, agents=52)).holds)
        self.assertFalse(bands.judge_obstacle(result(26, agents=52), result(25, agents=52)).holds)
        few = SimpleNamespace(arrived=(26, None, None), agents=52)
        self.assertIsNone(bands.judge_obstacle(few, result(8, agents=52)).holds, "without an interval")

    def test_ten_times_the_particles_change_no_number_by_more_than_a_tenth(self):
        self.assertTrue(bands.judge_particles({"S5": (result(50, 70), result(45, 70))}).holds)
        pairs = {"S5": (result(50, 70), result(50, 70)), "S8": (result(13, 70), result(0))}
        self.assertFalse(bands.judge_particles(pairs).holds)

    def test_the_error_of_the_times_is_a_mean_factor(self):
        paper = {name: {"time_s": "100"} for name in ("S4", "S5", "S6", "S7", "S10")}
        times = {"S4": 100, "S5": 200, "S6": 50, "S7": 100, "S10": 100}
        factor = bands.time_error(paper, lambda name: result(50, times[name]))
        self.assertAlmostEqual(factor, 2 ** (2 / 5))
        self.assertIsNone(bands.time_error(paper, lambda name: result(0)))

    def test_the_switch_of_tau(self):
        self.assertTrue(bands.judge_switch(result(50, 73.7)).holds)
        self.assertFalse(bands.judge_switch(result(49, 73.7)).holds)
        self.assertFalse(bands.judge_switch(result(50, 95)).holds)


class ClosedForm(unittest.TestCase):
    def test_contact_mass_does_not_depend_on_the_particles(self):
        self.assertAlmostEqual(contact_mass(scene(0.2, 1.5)), 196.35, places=2)
        self.assertAlmostEqual(contact_mass(scene(0.2, 1.5, "sum")), 1767.15, places=2)

    def test_order_of_the_scenarios(self):
        known = {(0.2, 0.5): 0.23, (0.2, 1.5): 0.70, (0.8, 0.5): 0.94, (1, 0.5): 1.17, (0.2, 2.5): 1.17}
        known |= {(0.8, 1.5): 2.8, (1, 1.5): 3.5, (0.8, 2.5): 4.7, (1, 2.5): 5.9}
        for (tau, velocity), share in known.items():
            self.assertAlmostEqual(of_limit(scene(tau, velocity)), share, delta=0.055)

    def test_who_heads_across_is_lost_at_the_limit_times_way_over_width(self):
        of_paper = scene(0.8, 1.5)
        of_paper["channel"].update(x_min_m=0, z_min_m=11.5, z_max_m=38.5)
        of_paper["crowd"]["groups"][0].update(columns=10, start={"x_m": 65, "pitch_x_m": 2.5})
        speed = loss_velocity(of_paper, 0.8)
        self.assertAlmostEqual(of_limit(of_paper, velocity=speed), 76.25 / 27)
        k = 0.8 * contact_mass(of_paper) / (65 + 0.8 * contact_mass(of_paper))
        self.assertAlmostEqual(27 / ((1 - k) * 0.989 * 1.3) * k * speed, 76.25)

    def test_nothing_moves_an_agent_of_tau_0(self):
        self.assertEqual(limit_velocity(65, 1.3, 0, 196), float("inf"))
        self.assertEqual(of_limit(scene(0, 2.5)), 0)


if __name__ == "__main__":
    unittest.main()
