"""Morris and Sobol indices of Ishigami and Homma's function, against their closed forms."""

import unittest

import numpy as np

from wade.statistics.indices import elementary_effects, sobol_indices, sobol_points, trajectories

A, B = 7, 0.1
FIRST, TOTAL = (0.3139, 0.4424, 0), (0.5576, 0.4424, 0.2437)


def ishigami(unit):
    x = 2 * np.pi * unit - np.pi
    return np.sin(x[..., 0]) + A * np.sin(x[..., 1]) ** 2 + B * x[..., 2] ** 4 * np.sin(x[..., 0])


class Morris(unittest.TestCase):
    def test_each_step_changes_one_input_within_the_cube(self):
        ways = trajectories(5, 30, 1)
        self.assertEqual(ways.shape, (30, 6, 5))
        self.assertTrue((np.count_nonzero(np.diff(ways, axis=1), axis=2) == 1).all())
        self.assertTrue((np.abs(np.diff(ways, axis=1)).sum(axis=1) > 0.5).all(), "every input once")
        self.assertTrue(-1e-12 <= ways.min() and ways.max() <= 1 + 1e-12)

    def test_ishigami_and_an_input_that_does_nothing(self):
        # On four levels sin^2 of x_2 changes by 3/4 in each step of 2/3: 7 * 3/4 * 3/2 = 7.875, all alike. x_1: half of the
        # effects are 1.299 (1 + pi^4 / 10), half 1.299 (1 + (pi/3)^4 / 10), mean 7.70, sd 6.25; x_3: 6.25 with half 0, sd 6.25.
        ways = trajectories(4, 400, 1)
        effects = elementary_effects(ways, ishigami(ways))
        np.testing.assert_allclose(effects.size, [7.70, 7.875, 6.25, 0], atol=3 * 6.25 / 20)
        self.assertAlmostEqual(effects.size[1], 7.875)
        self.assertEqual(effects.size[3], 0)
        self.assertTrue((effects.low <= effects.size).all() and (effects.size <= effects.high).all())

    def test_twenty_ways_tell_who_matters(self):
        ways = trajectories(4, 20, 2)
        self.assertEqual((elementary_effects(ways, ishigami(ways)).low > 1).tolist(), [True, True, True, False])

    def test_effects_of_a_straight_function_are_its_slopes(self):
        ways = trajectories(3, 10, 2)
        effects = elementary_effects(ways, ways @ np.array([3.0, -2, 0]))
        np.testing.assert_allclose(effects.size, [3, 2, 0], atol=1e-12)
        np.testing.assert_allclose(effects.spread, 0, atol=1e-12)


class Sobol(unittest.TestCase):
    def test_ishigami(self):
        # Scrambled Sobol points converge about as 1/N: 0.01 at N = 1024 by an earlier trial of the design.
        found = sobol_indices(ishigami(sobol_points(3, 1024, 1)))
        np.testing.assert_allclose(found.first, FIRST, atol=0.01)
        np.testing.assert_allclose(found.total, TOTAL, atol=0.01)
        self.assertTrue(np.isnan(found.noise))

    def test_intervals_hold_the_truth_with_few_points(self):
        found = sobol_indices(ishigami(sobol_points(3, 128, 3)))
        for low, high, truth in ((found.first_low, found.first_high, FIRST), (found.total_low, found.total_high, TOTAL)):
            self.assertTrue(((low - 0.02 <= truth) & (truth <= high + 0.02)).all(), (low, high, truth))

    def test_chance_is_told_apart_by_repeated_runs(self):
        # Variance of Ishigami 13.845; chance of variance 3 makes 3 / 16.845 = 0.178, standard error about 0.01.
        random, points = np.random.default_rng(4), sobol_points(3, 512, 5)
        noisy = ishigami(points) + random.normal(0, 3**0.5, points.shape[:2])
        again = ishigami(points[0]) + random.normal(0, 3**0.5, points.shape[1])
        self.assertAlmostEqual(sobol_indices(noisy, again).noise, 3 / 16.845, delta=0.03)


if __name__ == "__main__":
    unittest.main()
