"""Curves over time against published values and counts; bands by simulation (`--long`)."""

import sys
import unittest

import numpy as np

from wade.statistics.times import Lives, fn_curve, incidences, staying

LONG = "--long" in sys.argv


class KaplanMeier(unittest.TestCase):
    def test_published_example(self):
        # Freireich et al. 1963, the 21 patients of 6-mercaptopurine; estimates as in Cox and Oakes 1984, table 4.1.
        times = np.array([6, 6, 6, 6, 7, 9, 10, 10, 11, 13, 16, 17, 19, 20, 22, 23, 25, 32, 32, 34, 35], float)
        fell_ill = np.array([1, 1, 1, 0, 1, 0, 1, 0, 0, 1, 1, 0, 0, 0, 1, 1, 0, 0, 0, 0, 0])
        curve = staying(Lives(np.zeros(21, int), times, fell_ill))
        self.assertEqual(curve.times.tolist(), [0, 6, 7, 10, 13, 16, 22, 23])
        for found, printed in zip(curve.share, (1, 0.857, 0.807, 0.753, 0.690, 0.627, 0.538, 0.448)):
            self.assertAlmostEqual(found, printed, delta=5e-4)
        self.assertIsNone(curve.low, "one run has no band")


class AalenJohansen(unittest.TestCase):
    def test_without_censoring_it_counts(self):
        lives = Lives(np.repeat([0, 1], 4), np.array([1.0, 2, 3, 4, 1, 2, 2, 5]), np.array([1, 2, 1, 1, 2, 1, 1, 2]))
        curves = incidences(lives, (1, 2, 3))
        self.assertAlmostEqual(curves[1].share[-1], 5 / 8)
        self.assertAlmostEqual(curves[2].share[-1], 3 / 8)
        self.assertAlmostEqual(curves[1].at(2.5)[0], 3 / 8)
        self.assertEqual(curves[3].share.max(), 0)

    def test_causes_and_who_is_left_add_up_with_censoring(self):
        random = np.random.default_rng(1)
        lives = Lives(random.integers(0, 12, 600), random.exponential(50, 600).round(), random.integers(0, 3, 600))
        curves, left = incidences(lives, (1, 2)), staying(lives)
        np.testing.assert_allclose(curves[1].share + curves[2].share + left.share, 1, atol=1e-12)

    def test_two_constant_hazards(self):
        # Incidence of cause 1 at t: a/(a + b) (1 - exp(-(a + b) t)); standard error 0.5 / sqrt(20000) = 0.0035.
        random, a, b = np.random.default_rng(2), 0.02, 0.01
        ends = random.exponential(1 / (a + b), 20000)
        cause = np.where(random.random(20000) < a / (a + b), 1, 2)
        censored = random.uniform(10, 120, 20000)
        lives = Lives(np.zeros(20000, int), np.minimum(ends, censored), np.where(ends <= censored, cause, 0))
        self.assertAlmostEqual(incidences(lives, (1,))[1].at(40)[0], 2 / 3 * (1 - np.exp(-1.2)), delta=0.014)


class Bands(unittest.TestCase):
    def test_cover_where_runs_differ(self):
        # Hazards of runs log-normal, log-sd 0.6; Greenwood's covers 0.67 there. Wanted 0.90: percentiles of a bootstrap are
        # narrow with few runs; three standard errors of the simulation are allowed for.
        times, runs, size = (600 if LONG else 25), 20, 30
        random, hits = np.random.default_rng(3), 0
        truth = np.mean(np.exp(-0.5 * np.exp(random.normal(-0.18, 0.6, size=200000))))
        for _ in range(times):
            hazard = np.exp(random.normal(-0.18, 0.6, size=runs)) / 60
            end = random.exponential(1 / np.repeat(hazard, size))
            censored = random.uniform(20, 120, size=runs * size)
            lives = Lives(np.repeat(np.arange(runs), size), np.minimum(end, censored).round(), (end <= censored).astype(int))
            _, low, high = staying(lives).at(30)
            hits += low <= truth <= high
        self.assertGreater(hits / times, 0.90 - 3 * (0.9 * 0.1 / times) ** 0.5)
        print(f"coverage {hits / times:.3f}")


class Many(unittest.TestCase):
    def test_the_fn_curve_is_the_share_of_runs(self):
        rows = fn_curve([0, 0, 3, 1, 10])
        self.assertEqual([(n, share) for n, share, _, _ in rows], [(1, 0.6), (3, 0.4), (10, 0.2)])
        self.assertTrue(all(low < share < high for _, share, low, high in rows))
        self.assertEqual(fn_curve([0, 0])[0][:3], (1, 0, 0))


if __name__ == "__main__":
    sys.argv = [word for word in sys.argv if word != "--long"]
    unittest.main()
