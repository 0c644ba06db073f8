"""Linked people against single ones: pairs of the comparison, and the exact test."""

import unittest

from wade import UsageError
from wade.sweeps import together


def people(*states, group="a"):
    return [{"group": group, "worst_state": state} for state in states]


class Pairs(unittest.TestCase):
    def test_the_same_people_are_compared_one_by_one(self):
        with_hands = together.worst_states(people("walking", "sliding", "carried", "effort"))
        alone = together.worst_states(people("walking", "toppled", "effort", "drowned"))
        rows = [list(row.values()) for row in together.compared("s", 3, with_hands, alone)]
        self.assertEqual(rows, [["s", "a", "stood firm", 3, 4, 2, 2, 1, 1], ["s", "a", "kept the feet", 3, 4, 3, 2, 2, 1]])

    def test_hands_are_let_go_of_in_the_groups_that_have_them(self):
        groups = [{"hand_in_hand": "none"}, {"hand_in_hand": "along_z"}]
        self.assertEqual(together.without_hands({"crowd": {"groups": groups}}), {"/crowd/groups/1/hand_in_hand": "none"})
        with self.assertRaisesRegex(UsageError, "hand_in_hand"):
            together.without_hands({"crowd": {"groups": groups[:1]}})


class Test(unittest.TestCase):
    def test_mcnemar_is_the_binomial_of_those_who_differ(self):
        self.assertAlmostEqual(together.mcnemar(10, 0), 2 / 2**10)
        self.assertAlmostEqual(together.mcnemar(1, 5), 2 * (1 + 6) / 2**6)
        self.assertEqual(together.mcnemar(3, 3), 1)
        self.assertEqual(together.mcnemar(0, 0), 1)

    def test_the_table_has_the_mean_difference_with_its_interval(self):
        firm, one_falls = ["walking"] * 4, ["walking"] * 3 + ["toppled"]
        rows = [row for seed in range(1, 5) for row in together.compared("s", seed, {"a": firm}, {"a": one_falls})]
        line = together.summary(rows).splitlines()[-1]
        self.assertIn("1.0 (-1.6 .. 2.6)", line)
        self.assertIn("| 0.12 |", line)


if __name__ == "__main__":
    unittest.main()
