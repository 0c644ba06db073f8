"""Section of report.md on the obstacle: where it stands, and how fast the water is."""

from dataclasses import dataclass

from wade.reports.tables import markdown, section
from wade.suites.paper import plan
from wade.suites.paper.bands import LEE_AT_S, LEE_LENGTH_M, in_words, judge_obstacle
from wade.suites.paper.pictures import lee_of
from wade.suites.paper.results import Result
from wade.suites.paper.words import SET_UPS, arrived_of, met_of

PLACES = sorted((*plan.OBSTACLE_PLACES, plan.OBSTACLE_AT))  # x_min, m


@dataclass(frozen=True)
class Water:
    """A water in which the crowd has walked without the obstacle, and with it in some places."""

    words: str
    without: Result
    by_place: dict  # of x_min, m: Result

    def saving_places(self):
        """The places at which the obstacle saves people by the measure of its band."""
        return [place for place, result in self.by_place.items() if judge_obstacle(result, self.without).holds]


def waters_of(context, sets):
    waters = []
    for scene_set in sets:
        for push in (1, plan.BLOCK_PUSH) if plan.block_cases(scene_set) else (1,):
            if not plan.has_scene(scene_set, "obstacle"):
                continue
            words = SET_UPS[scene_set] + ("" if push == 1 else f", emitter at {push:g} v_F")
            known = {place: result for place in PLACES if (result := context.get(plan.block_case(scene_set, place, push)))}
            without = context.get(plan.no_block_case(scene_set, push))
            if known and without is not None:
                waters.append(Water(words, without, known))
    return waters


def listed(places):
    return f"x {', '.join(f'{place:g}' for place in places)} m"


def lee_words(result):
    lee = None if result is None else lee_of(result)
    return "-" if lee is None else f"{lee[0]:.0f}; {lee[1]:.0f} m at {lee[2]} s"


def found_words(water):
    saved = water.saving_places()
    most = max(water.by_place, key=lambda place: water.by_place[place].arrived[0])
    found = (f"more arrive with it, the intervals apart, at {listed(saved)}" if saved
             else "at none of the places run do more arrive with it")
    return f"* {water.words}: {found}; the most, {in_words(water.by_place[most].arrived)}, at {listed([most])}."


def table(waters, cell_of, with_none=True):
    """A line for each water, a column for each place, of what has anything to show; with_none: also without the obstacle."""
    head = ["water", *(["without it"] if with_none else []), *(listed([place]) for place in PLACES)]
    lines = [[water.words, *([cell_of(water.without)] if with_none else []),
              *(cell_of(water.by_place.get(place)) for place in PLACES)] for water in waters]
    return markdown(head, [line for line in lines if any(cell != "-" for cell in line[1:])])


def block_section(context):
    waters = waters_of(context, context.sets)
    if not waters:
        return ""
    text = (
        f"Where the block of 7 x 7 m stood is not published. The scenes assume x {plan.OBSTACLE_AT} m; the other "
        "places were tried after that result, and so was the speed of the emitter, which was chosen by the times of "
        "Table 1. 52 people start from x 65 to 86 m for a goal at x 75 m and drift towards x 0. Arrivals, of 52 (the "
        "paper: 26 with the block, 8 without it); `-`: not run:")
    lees = []
    if any(lee_of(result) for water in waters for result in water.by_place.values()):
        lees = [f"Length of the dry lee at {LEE_AT_S} s, m, of seed 1 (the paper's picture has at least {LEE_LENGTH_M} m), and the"
                " longest of the first two minutes; `-`: not kept, or not run:", table(waters, lee_words, False)]
    return section("The place of the obstacle", text, table(waters, arrived_of), "\n".join(map(found_words, waters)), "Water met:",
                   table(waters, met_of), *lees)
