"""Intervals against published values and limits."""

import unittest

from wade.reports.intervals import arrival_interval, bootstrap_mean, design_effect, precise_enough, wilson


class Wilson(unittest.TestCase):
    def test_published_example(self):
        # Newcombe 1998, Table I, method 3: 81 of 263, 15 of 148, 0 of 20, 1 of 29; printed to four digits.
        for successes, trials, low, high in (
            (81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605), (0, 20, 0.0, 0.1611), (1, 29, 0.0061, 0.1718),
        ):
            found = wilson(successes, trials)
            self.assertAlmostEqual(found[0], low, delta=5e-5)
            self.assertAlmostEqual(found[1], high, delta=5e-5)

    def test_all_is_the_mirror_of_none(self):
        self.assertEqual(wilson(20, 20)[1], 1.0)
        self.assertAlmostEqual(wilson(20, 20)[0], 1 - wilson(0, 20)[1])

    def test_nothing_tried_tells_nothing(self):
        self.assertEqual(wilson(0, 0), (0.0, 1.0))


class DesignEffect(unittest.TestCase):
    def test_is_one_for_runs_that_vary_no_more_than_independent_agents(self):
        self.assertEqual(design_effect([25, 25, 25], 50), 1.0)
        self.assertEqual(design_effect([0, 0], 50), 1.0)
        self.assertEqual(design_effect([7], 50), 1.0)

    def test_is_the_number_of_agents_if_all_share_one_fate(self):
        # Half of many runs lose everybody: the variance is n^2/4 instead of n/4.
        self.assertAlmostEqual(design_effect([0, 50] * 200, 50), 50, delta=0.2)

    def test_widens_the_interval(self):
        narrow, wide = arrival_interval([25] * 10, 50), arrival_interval([10, 40] * 5, 50)
        self.assertEqual(narrow[0], wide[0])
        self.assertGreater(wide[2] - wide[1], 2 * (narrow[2] - narrow[1]))


class Bootstrap(unittest.TestCase):
    def test_same_values_give_the_same_interval(self):
        values = [43.1, 44.0, 42.7, 43.9, 45.2]
        self.assertEqual(bootstrap_mean(values), bootstrap_mean(values))

    def test_holds_the_mean_and_lies_within_the_values(self):
        mean, low, high = bootstrap_mean([1.0, 2.0, 4.0, 9.0])
        self.assertEqual(mean, 4.0)
        self.assertTrue(1 <= low < mean < high <= 9)

    def test_width_is_that_of_the_normal_interval_for_many_values(self):
        values = [float(i) for i in range(400)]  # standard error 400/sqrt(12 * 400) = 5.774
        _, low, high = bootstrap_mean(values)
        self.assertAlmostEqual(high - low, 2 * 1.96 * 5.774, delta=0.05 * 2 * 1.96 * 5.774)

    def test_one_value_has_no_interval(self):
        self.assertEqual(bootstrap_mean([46.0]), (46.0, None, None))
        self.assertEqual(bootstrap_mean([46.0, 46.0]), (46.0, 46.0, 46.0))


class Stopping(unittest.TestCase):
    def test_one_run_is_never_enough(self):
        self.assertFalse(precise_enough([50], 50, [46.0]))

    def test_runs_that_agree_are_enough(self):
        self.assertTrue(precise_enough([50] * 10, 50, [46.0, 46.2] * 5))
        self.assertTrue(precise_enough([0] * 10, 50, []))

    def test_wide_arrivals_or_times_ask_for_more(self):
        self.assertFalse(precise_enough([5, 45] * 5, 50, [100.0] * 10))
        self.assertFalse(precise_enough([50] * 10, 50, [100.0, 200.0] * 5))
        self.assertFalse(precise_enough([0] * 9 + [1], 50, [100.0]), "one time has no interval")


if __name__ == "__main__":
    unittest.main()
