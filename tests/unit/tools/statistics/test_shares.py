"""Shares and their intervals against published values, limits, and by simulation of ensembles.

`test_shares.py --long` simulates coverage in all cells; without it in some.
"""

import itertools
import math
import sys
import unittest

import numpy as np

from wade.statistics.shares import (arrival_interval, bootstrap_mean, compared, design_effect, precise_enough, runs_needed,
                                    share_of, share_of_runs, t_quantile, wilson)

LONG = "--long" in sys.argv


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


class Quantiles(unittest.TestCase):
    def test_those_of_students_tables(self):
        for degrees, printed in ((1, 12.706), (2, 4.303), (4, 2.776), (9, 2.262), (19, 2.093), (120, 1.980)):
            self.assertAlmostEqual(t_quantile(degrees), printed, delta=5e-4)

    def test_share_of_runs_is_that_of_clopper_and_pearson(self):
        # None of n: one-sided, 1 - 0.05^(1/n), as Share.limit. 4 of 20: 0.0573 to 0.4366 in their charts' tables.
        self.assertAlmostEqual(share_of_runs(0, 20)[1], 1 - 0.05 ** (1 / 20), places=9)
        self.assertEqual(share_of_runs(0, 20)[0], 0.0)
        self.assertAlmostEqual(share_of_runs(20, 20)[0], 0.05 ** (1 / 20), places=9)
        low, high = share_of_runs(4, 20)
        self.assertAlmostEqual(low, 0.0573, delta=5e-5)
        self.assertAlmostEqual(high, 0.4366, delta=5e-5)

    def test_share_of_runs_is_known_for_thousands(self):
        self.assertAlmostEqual(share_of_runs(0, 5000)[1], 1 - 0.05 ** (1 / 5000), places=12)
        low, high = share_of_runs(2500, 5000)  # nearly normal: 1.96 sqrt(0.25 / 5000), and half a run
        self.assertAlmostEqual(high - low, 2 * (1.96 * (0.25 / 5000) ** 0.5 + 0.5 / 5000), delta=2e-5)


class DesignEffect(unittest.TestCase):
    def test_is_one_for_runs_that_vary_no_more_than_independent_agents(self):
        for counts in ([25, 25, 25], [0, 0, 0], [7]):
            self.assertEqual(design_effect(counts, [50] * len(counts)), 1.0)

    def test_is_the_number_of_agents_if_all_share_one_fate(self):
        # Half of many runs lose all agents: the variance is n^2/4 instead of n/4.
        self.assertAlmostEqual(design_effect([0, 50] * 200, [50] * 400), 50, delta=0.2)

    def test_widens_the_interval(self):
        narrow, wide = arrival_interval([25] * 10, 50), arrival_interval([10, 40] * 5, 50)
        self.assertEqual(narrow[0], wide[0])
        self.assertGreater(wide[2] - wide[1], 2 * (narrow[2] - narrow[1]))


class Refusal(unittest.TestCase):
    def why(self, counts, size=50):
        return share_of(counts, [size] * len(counts)).refused

    def test_each_rule_gives_its_reason(self):
        self.assertIn("fewer than 10 runs", self.why([25] * 9))
        self.assertIn("in 4 of 20 runs only", self.why([3] * 4 + [0] * 16))
        self.assertIn("everybody in all of 20 runs", self.why([50] * 20))
        self.assertIn("in all but 2 of 20 runs", self.why([50] * 18 + [20] * 2))
        self.assertEqual(self.why([0] * 20), "in none of 20 runs")
        self.assertIn("independent cases", self.why([1] * 5 + [0] * 15))
        self.assertEqual(self.why([25, 20, 30, 22] * 5), "")
        self.assertEqual(share_of([0] * 20, [0] * 20).refused, "nobody")

    def test_a_run_more_or_less_in_size_changes_little(self):
        same, unlike = share_of([20, 25, 30] * 5, [50] * 15), share_of([16, 25, 36] * 5, [40, 50, 60] * 5)
        self.assertAlmostEqual(same.mean, 0.5)
        self.assertGreater(unlike.width, 0)
        self.assertAlmostEqual(unlike.mean, 77 / 150)


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
    def test_fewer_than_twenty_runs_are_never_enough(self):
        self.assertFalse(precise_enough([50] * 19, 50, [46.0, 46.2] * 9))

    def test_runs_that_agree_are_enough(self):
        self.assertTrue(precise_enough([50] * 20, 50, [46.0, 46.2] * 10))
        self.assertTrue(precise_enough([0] * 20, 50, []))

    def test_wide_arrivals_or_times_ask_for_more(self):
        self.assertFalse(precise_enough([5, 45] * 10, 50, [100.0] * 20))
        self.assertFalse(precise_enough([50] * 20, 50, [100.0, 200.0] * 10))
        self.assertFalse(precise_enough([0] * 19 + [1], 50, [100.0]), "no interval can be given")

    def test_as_many_more_runs_as_told_make_the_interval_that_narrow(self):
        needed = runs_needed([10, 40] * 10, [50] * 20)
        self.assertGreater(needed, 20)
        share = share_of(([10, 40] * needed)[:needed], [50] * needed)
        self.assertAlmostEqual(share.width, 0.1, delta=0.003)  # sqrt(19 / 20), as the design effect has n - 1
        self.assertIsNone(runs_needed([10, 40] * 9, [50] * 18))
        self.assertIsNone(runs_needed([1] + [0] * 30, [50] * 31))


class Pairs(unittest.TestCase):
    def test_a_warning_that_saves_five_of_fifty_is_needed_by_ten(self):
        first = [20, 30, 25, 22, 28] * 4
        result = compared(first, [n + d for n, d in zip(first, [4, 6, 5, 5] * 5)], [50] * 20)
        self.assertAlmostEqual(result.difference, 0.1)
        self.assertAlmostEqual(result.per, 10)
        self.assertTrue(result.per_low < 10 < result.per_high)
        self.assertAlmostEqual(1 / result.per_low, result.high)

    def test_without_a_certain_difference_there_is_no_interval_of_the_number(self):
        result = compared([20, 30] * 10, [30, 20] * 10, [50] * 20)
        self.assertIsNone(result.per_high)
        self.assertIn("may be 0", result.refused)
        self.assertIn("unlike in 1 of 20", compared([20] * 20, [20] * 19 + [25], [50] * 20).refused)
        self.assertIn("fewer than 10 pairs", compared([1] * 5, [2] * 5, [50] * 5).refused)


class Alike(unittest.TestCase):
    def test_pairs_that_all_differ_alike_leave_room_for_another(self):
        for pairs in (10, 20, 200):
            result = compared([4] * pairs, [2] * pairs, [4] * pairs)
            most = 1 - 0.05 ** (1 / pairs)  # of pairs that differ otherwise
            self.assertAlmostEqual(result.low, -0.5 - 0.5 * most)
            self.assertAlmostEqual(result.high, -0.5 + 1.5 * most)
            self.assertAlmostEqual(result.per_high, 1 / abs(result.high))
        result = compared([4] * 10, [0] * 10, [4] * 10)
        self.assertEqual(result.low, -1)
        self.assertAlmostEqual(result.high, -1 + 2 * (1 - 0.05**0.1))

    def test_a_few_unlike_pairs_make_it_wider_and_never_certain(self):
        widths = []
        for unlike in range(12):
            result = compared([4] * 20, [3] * unlike + [2] * (20 - unlike), [4] * 20)
            self.assertLess(result.low, result.difference)
            self.assertLess(result.difference, result.high)
            widths.append(result.high - result.low)
        self.assertEqual(sorted(widths[:5]), widths[:5])

    def test_a_difference_in_no_pair_or_the_same_in_two_may_be_0(self):
        self.assertIn("unlike in 0 of 20", compared([2] * 20, [2] * 20, [4] * 20).refused)
        self.assertIn("may be 0", compared([2] * 10, [1] * 10, [8] * 10).refused + compared([3] * 10, [2] * 10, [8] * 10).refused)

    def test_bounds_hold_where_a_pair_in_ten_differs_otherwise(self):
        random, wrong, times = np.random.default_rng(36), 0, 400
        for _ in range(times):
            second = random.choice([2, 4], size=20, p=(0.9, 0.1)).tolist()  # of 4; mean difference -0.45
            result = compared([4] * 20, second, [4] * 20)
            wrong += result.low is not None and not result.low <= -0.45 <= result.high
        self.assertGreater(by_chance(wrong, times), 0.001)


def simulated(random, share, alike, runs, people, times):
    """Counts of ensembles, beta-binomial: correlation `alike` between the people of a run."""
    if alike == 0:
        return random.binomial(people, share, size=(times, runs))
    a, b = share * (1 - alike) / alike, (1 - share) * (1 - alike) / alike
    return random.binomial(people, random.beta(a, b, size=(times, runs)))


def by_chance(wrong, given, share=0.07):
    """The probability of so many wrong ones or more among those given if so large a share is wrong."""
    below = sum(math.comb(given, k) * share**k * (1 - share) ** (given - k) for k in range(wrong))
    return 1 - below


# (people a run, shares, correlations of people, runs): of the quick set, and of the wide one that chose nothing.
QUICK = (50,), (0.05, 0.1, 0.5), (0, 0.1, 0.3), (10, 20, 40)
WIDE = ((10, 30, 100, 400), (0.007, 0.015, 0.03, 0.08, 0.15, 0.35, 0.45, 0.75), (0, 0.02, 0.05, 0.08, 0.15, 0.25, 0.3),
        (10, 12, 17, 25, 50, 120, 300))
FEWEST_JUDGED = 0.02  # of the ensembles of a cell: where fewer get an interval nothing is promised
CLASSES = (0.02, 0.1, 0.5, 0.9, 1.01)  # of cells by the share of ensembles that get one


class Coverage(unittest.TestCase):
    """Given intervals of nominal 0.95 cover at least 0.93, in each cell where 2 % of the ensembles get an interval.

    A cell fails if so many wrong intervals have a chance below 1 in 1000 at 0.07 wrong; classes of cells have no slack.
    """

    def test_of_given_intervals(self):
        times = 1000 if LONG else 100
        random, cells = np.random.default_rng(34), []
        for people, share, alike, runs in itertools.product(*(WIDE if LONG else QUICK)):
            found = [share_of(counts, [people] * runs)
                     for counts in simulated(random, share, alike, runs, people, times).tolist()]
            told = [one for one in found if not one.refused]
            wrong = sum(not one.low <= share <= one.high for one in told)
            cells.append((len(told), wrong))
            if len(told) >= FEWEST_JUDGED * times:
                with self.subTest(people=people, share=share, alike=alike, runs=runs, given=len(told), wrong=wrong):
                    self.assertGreater(by_chance(wrong, len(told)), 0.001)
        for low, high in itertools.pairwise(CLASSES):
            own = [cell for cell in cells if low <= cell[0] / times < high]
            given, wrong = map(sum, zip(*own))
            worst = max(own, key=lambda cell: cell[1] / cell[0])
            print(f"{low:.0%} to {high:.0%} given: {len(own)} cells, {given} intervals, coverage {1 - wrong / given:.4f}, "
                  f"worst cell {1 - worst[1] / worst[0]:.3f} of {worst[0]}")
            if LONG:
                self.assertLess(wrong / given, 0.07)
        print(f"none given: {1 - sum(given for given, _ in cells) / times / len(cells):.3f} of {len(cells)} cells")

    def test_of_differences_of_pairs(self):
        random, times, people = np.random.default_rng(35), 1500 if LONG else 60, 50
        every = ((0.02, 0.1, 0.5, 0.9), (0.02, 0.1, 0.3), (10, 20, 80)) if LONG else ((0.1, 0.5), (0.05, 0.3), (10, 20))
        for share, alike, runs in itertools.product(*every):
            told = []
            a, b = share * (1 - alike) / alike, (1 - share) * (1 - alike) / alike
            for _ in range(times):
                water = random.beta(a, b, size=runs)  # common to both runs of a pair
                first, second = random.binomial(people, 0.8 * water), random.binomial(people, water)
                result = compared(first.tolist(), second.tolist(), [people] * runs)
                if result.low is not None:
                    told.append(result.low <= 0.2 * share <= result.high)
            if len(told) >= FEWEST_JUDGED * times:
                with self.subTest(share=share, alike=alike, runs=runs, given=len(told)):
                    self.assertGreater(by_chance(told.count(False), len(told)), 0.001)


if __name__ == "__main__":
    sys.argv = [word for word in sys.argv if word != "--long"]
    unittest.main()
