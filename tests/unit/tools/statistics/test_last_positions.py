"""Density of last positions and drift, against closed forms."""

import unittest

import numpy as np

from wade.statistics.last_positions import (BANDWIDTH_M, density_of, drift, mixing_of, search_order, start_drift)


def uniform(depth, u):
    return lambda x, z: (np.full(len(x), depth), np.full(len(x), u), np.zeros(len(x)))


class Drifting(unittest.TestCase):
    def test_a_uniform_stream_carries_by_u_t_and_spreads_by_2_k_t(self):
        # Standard error of a variance of 20,000 is 1 %; 5 % is asked for by the design.
        depth, u, time = 1.5, 1.2, 60
        bodies = drift(start_drift(np.full(20000, 50.0), np.full(20000, 30.0), 1.7), uniform(depth, u), time, 0.5, 1)
        k = 0.1 * depth * u * 9.81**0.5 * 0.03 * depth ** (-1 / 6)
        self.assertAlmostEqual(mixing_of(depth, u), k)
        self.assertAlmostEqual(bodies.x.mean() - 50, u * time, delta=0.05 * u * time)
        for spread in (bodies.x.var(), bodies.z.var()):
            self.assertAlmostEqual(spread, 2 * k * time, delta=0.05 * 2 * k * time)

    def test_bodies_spread_evenly_stay_so_where_mixing_changes(self):
        # A stream that is slow at both banks, 20 m wide: each tenth keeps a tenth of 10,000, standard error 3 %.
        # Without grad K they lose up to 17 % to the banks, where water mixes little.
        def water(x, z):
            return np.full(len(x), 2.0), 2 * np.clip(1 - ((z - 10) / 10) ** 2, 0, None), np.zeros(len(x))

        start = np.random.default_rng(2).uniform(0, 20, 10000)
        bodies = drift(start_drift(np.zeros(10000), start, 1.7), water, 200, 0.5, 3)
        tenths = np.histogram(bodies.z, np.linspace(0, 20, 11))[0] / 1000
        self.assertLess(np.abs(tenths - 1).max(), 0.12, tenths)

    def test_who_lies_in_a_quarter_of_the_height_for_ten_seconds_is_stranded(self):
        # 0.42 m is below a quarter of 1.7 m, 0.43 m is not; it goes on for the ten seconds.
        for depth, way in ((0.42, 10), (0.43, 60)):
            bodies = drift(start_drift([0.0], [0.0], 1.7), uniform(depth, 1.0), 60, 0.5, 1)
            self.assertAlmostEqual(bodies.x[0], way, delta=3 * (2 * mixing_of(depth, 1.0) * 60) ** 0.5 + 0.5)
            self.assertEqual(bool(bodies.stranded[0]), depth < 0.425)

    def test_the_same_seed_gives_the_same_places(self):
        ends = [drift(start_drift(np.zeros(50), np.zeros(50), 1.7), uniform(1, 1), 30, 0.5, seed).x for seed in (1, 1, 2)]
        np.testing.assert_array_equal(ends[0], ends[1])
        self.assertFalse(np.array_equal(ends[0], ends[2]))

    def test_who_leaves_the_map_is_gone(self):
        bodies = drift(start_drift([1.0], [5.0], 1.7), uniform(1, -1), 60, 0.5, 1, inside=lambda x, z: x > 0)
        self.assertTrue(bodies.gone[0])


class Map(unittest.TestCase):
    def test_one_place_far_from_the_edges_is_the_kernel(self):
        # Of a normal distribution in two dimensions a circle of sigma sqrt(-2 ln(1 - p)) holds p; cells of 1 m, 3 %.
        found = density_of([100.5], [60.5], 200, 120)
        self.assertAlmostEqual(found.share.sum(), 1)
        for held in (0.5, 0.9):
            self.assertAlmostEqual(found.area(held), np.pi * -2 * np.log(1 - held) * BANDWIDTH_M**2,
                                   delta=0.03 * np.pi * -2 * np.log(1 - held) * BANDWIDTH_M**2)

    def test_nothing_leaves_at_the_edges(self):
        found = density_of([0.0, 40.0, 3.0], [0.0, 8.0, 4.0], 40, 8)
        self.assertAlmostEqual(found.share.sum(), 1)
        even = density_of(np.repeat(np.arange(40) + 0.5, 8), np.tile(np.arange(8) + 0.5, 40), 40, 8)
        np.testing.assert_allclose(even.share, 1 / 320, rtol=1e-9)

    def test_the_best_square_is_searched_first(self):
        found = density_of([15, 15, 15, 75], [15, 15, 15, 35], 100, 50)
        rows = search_order(found)
        self.assertEqual(rows[0][:2], (10, 10))
        self.assertTrue(all(a[2] >= b[2] for a, b in zip(rows, rows[1:])))
        self.assertAlmostEqual(rows[-1][3], 1)
        self.assertAlmostEqual(rows[-1][4], 5000)


if __name__ == "__main__":
    unittest.main()
