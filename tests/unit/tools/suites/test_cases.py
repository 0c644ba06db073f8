"""The validation cases: which of their runs are planned."""

import unittest

from wade.suites import cases

CASES = [cases.Case("wave 0.1 0.05 0.025 quick=medium"), cases.Case("river 0.25 0.125 long=medium"),
         cases.Case("crowd 0")]


def names(plan):
    return [f"{case.name}-{level}" for case, level in plan]


class Planning(unittest.TestCase):
    def test_everything_but_long_runs_coarse_first(self):
        expected = ["wave-coarse", "river-coarse", "crowd-coarse", "wave-medium", "wave-fine"]
        self.assertEqual(names(cases.plan(CASES, "", "", False, False)), expected)

    def test_quick_long_and_patterns(self):
        self.assertEqual(names(cases.plan(CASES, "", "", True, False)), ["wave-medium"])
        self.assertEqual(names(cases.plan(CASES, "r*,crowd", "", False, True)),
                         ["river-coarse", "crowd-coarse", "river-medium"])
        self.assertEqual(names(cases.plan(CASES, "wave", "fine", False, False)), ["wave-fine"])

    def test_starts_are_as_many_as_the_program_says_where_a_run_does_not_take_hours(self):
        tank = cases.Case("tank 0.1 0.05 0.025 long=fine starts=5")
        self.assertEqual([tank.starts_at(level) for level in tank.levels], [5, 5, 1])
        self.assertEqual(tank.describe(), "tank: 0.1, 0.05, 0.025; long from fine on; medians of 5 starts")
        self.assertEqual(CASES[0].starts_at("coarse"), 1)

    def test_cases_without_a_run_are_named(self):
        some = cases.plan(CASES, "river, wave", "fine", False, False)
        self.assertEqual(cases.left_out("river, wave", some), ["river"])
        self.assertEqual(cases.left_out("w*", some), [])
        self.assertEqual(cases.left_out(None, some), [])

    def test_what_does_not_exist_is_refused_by_name(self):
        for patterns, levels, word in (("wafe", "", "wafe"), ("", "rough", "rough"),
                                       ("river", "medium", "nothing to run")):
            with self.assertRaisesRegex(ValueError, word):
                cases.plan(CASES, patterns, levels, False, False)


if __name__ == "__main__":
    unittest.main()
