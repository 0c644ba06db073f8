"""The section of block on the place of the obstacle, on results that are made up."""

import unittest
from types import SimpleNamespace

from wade.suites.paper import block, plan
from wade.suites.paper.report import Context


def result(arrived, lee=None):
    """Arrivals with an interval of two to either side; lee: as pictures.lee_of() has it."""
    runs = [SimpleNamespace(outcome={"lee": lee} if lee else {})]
    return SimpleNamespace(arrived=(arrived, arrived - 2, arrived + 2), agents=52, runs=runs, depth=1.0, speed=1.5)


def context(results):
    return Context({case.key: result(*values) for case, values in results.items()}, ["observed", "paper"], {})


NEAR, FAR = (plan.block_case("paper", place, plan.BLOCK_PUSH) for place in (67, 74))
RESULTS = {
    plan.no_block_case("paper"): (50,),
    plan.block_case("paper", plan.OBSTACLE_AT): (49, [0, 30, 35]),
    plan.no_block_case("paper", plan.BLOCK_PUSH): (7,),
    NEAR: (10, [14, 26, 20]),
    FAR: (17, [20, 20, 15]),
}


class Block(unittest.TestCase):
    def test_each_water_is_held_against_its_own_crossing_without_the_obstacle(self):
        waters = block.waters_of(context(RESULTS), ["paper"])
        self.assertEqual([water.words for water in waters], ["as run", "as run, emitter at 1.4 v_F"])
        self.assertEqual([water.without.arrived[0] for water in waters], [50, 7])
        self.assertEqual([list(water.by_place) for water in waters], [[60], [67, 74]])

    def test_a_place_saves_people_where_the_intervals_are_apart(self):
        waters = block.waters_of(context(RESULTS), ["paper"])
        self.assertEqual([water.saving_places() for water in waters], [[], [74]], "8 to 12 and 5 to 9 are not apart")

    def test_the_section_shows_arrivals_and_lees(self):
        text = block.block_section(context(RESULTS))
        self.assertRegex(text, r"\| as run, emitter at 1.4 v_F \| 7.0 \(5.0 to 9.0\) +\| - +\| - +\| - +\| 10.0")
        self.assertIn("20; 20 m at 15 s", text)
        self.assertIn("the intervals apart, at x 74 m; the most, 17.0 (15.0 to 19.0), at x 74 m", text)

    def test_without_runs_there_is_no_section(self):
        self.assertEqual(block.block_section(context({})), "")

    def test_faster_water_without_the_obstacle_is_that_of_the_readings(self):
        waters = {case.water for case in plan.emitter_cases("paper", plan.BLOCK_PUSH)}
        self.assertIn(plan.no_block_case("paper", plan.BLOCK_PUSH).water, waters)


if __name__ == "__main__":
    unittest.main()
