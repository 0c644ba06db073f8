"""Losses at other hazards of drowning, against people with known whole drifts, and how drifts ended."""

import types
import unittest

import numpy as np

from wade.statistics import drifts, table

RUNS, PEOPLE = 20, 2000
MEAN_S = 120.0  # of the exposure of a drift, were there no drowning
LEFT = 0.2  # of the drifts that end off the map


class Known:
    """People with drawn exposures, chances and ends, and their fates at a hazard."""

    def __init__(self, seed=1):
        random, count = np.random.default_rng(seed), RUNS * PEOPLE
        self.run = np.repeat(np.arange(RUNS), PEOPLE)
        self.whole = np.where(random.random(count) < 0.5, random.exponential(MEAN_S, count), 0)  # half stay on their feet
        self.leaves = (random.random(count) < LEFT) & (self.whole > 0)
        self.chance = random.exponential(1, count)

    def lost(self, hazard):
        """Returns a mask of the people that are lost at a hazard."""
        return self.leaves | (hazard * self.whole >= self.chance)

    def case(self, hazard):
        """The people as a run with this hazard shows them."""
        drowned = hazard * self.whole >= self.chance
        x = np.where(drowned, self.chance / hazard, self.whole) if hazard else self.whole
        ends = np.where(self.whole == 0, "", np.where(drowned, "drowned", np.where(self.leaves, "swept_away", "feet_down")))
        people = {"run": self.run, "exposure_s": x, "adrift_s": x + 20 * (self.whole > 0), "dead": drowned | self.leaves,
                  "fate": np.where(drowned, "drowned", np.where(self.leaves, "swept away", "walking")), "drift_end": ends,
                  "can_swim": np.zeros(len(x)), "off_feet_s": np.where(self.whole > 0, 1.0, np.nan)}
        crowd = {"drift_hazard_per_s": [0.002, hazard, 0.02]}
        return types.SimpleNamespace(people=people, runs=[None] * RUNS, manifest=lambda: {"resolved_scene": {"crowd": crowd}})


class Hazards(unittest.TestCase):
    def test_one_hazard_tells_of_others(self):
        """Within 1.5 points, as the note on the hazard asks: some five standard errors of 40,000 people."""
        known = Known()
        for acts, rules in ((0.0, drifts.HAZARDS), (0.006, drifts.HAZARDS), (0.02, (0.02,))):
            case = known.case(acts)
            for rule in rules:
                share, low, high = drifts.lost_at(case, rule)
                self.assertAlmostEqual(share, known.lost(rule).mean(), delta=0.015, msg=f"{rule} from {acts}")
                self.assertTrue(low <= share <= high)

    def test_the_hazard_that_acts_tells_the_lost_themselves(self):
        known = Known()
        self.assertEqual(drifts.lost_at(known.case(0.006), 0.006)[0], known.lost(0.006).mean())

    def test_the_earlier_rule_is_an_upper_bound(self):
        known = Known()
        expected = (known.leaves | (known.whole + 20 * (known.whole > 0) >= 60)).mean()
        self.assertAlmostEqual(drifts.lost_at(known.case(0.0), "under")[0], expected)
        self.assertGreater(drifts.lost_at(known.case(0.006), "under")[0], expected)

    def test_a_smaller_hazard_never_loses_more(self):
        for seed in range(5):
            case = Known(seed).case(0.006)
            shares = [drifts.lost_at(case, rule)[0] for rule in (0.0, 0.001, 0.002, 0.004, 0.006, 0.02)]
            self.assertEqual(shares, sorted(shares))

    def test_ends_of_drifts_are_counted(self):
        known = Known()
        case = known.case(0.006)
        found = drifts.drifts_of(case)
        self.assertEqual(sum(found.ends.values()), found.drifted)
        self.assertEqual(found.drowned_adrift, int((case.people["fate"] == "drowned").sum()))
        self.assertEqual((found.held_under, found.still), (0, 0))
        self.assertEqual([row[0] for row in table.hazard_rows(case)], ["low", "best", "high", "earlier rule"])

    def test_a_large_hazard_tells_nothing_of_smaller_ones(self):
        self.assertEqual([row[:2] for row in drifts.lost_by_rules(Known().case(0.02))], [("high", 0.02), ("earlier rule", "under")])

    def test_many_still_adrift_are_warned_of(self):
        case = Known().case(0.006)
        self.assertEqual(table.adrift_warning(case), "")
        case.people["drift_end"][case.people["drift_end"] == "feet_down"] = "adrift"
        self.assertIn("still adrift", table.adrift_warning(case))

    def test_without_drifts_there_is_nothing(self):
        case = Known().case(0.006)
        case.people["drift_end"][:] = ""
        self.assertEqual((drifts.drifts_of(case), table.drifts_rows(case), drifts.lost_by_rules(case)), (None, [], []))


if __name__ == "__main__":
    unittest.main()
