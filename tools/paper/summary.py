"""The begin of report.md: whether the paper is reproduced, in a few lines, each from the results."""

import bands
import plan
from bands import in_words
from block import waters_of
from report import judgements_of
from words import SET_UPS

LOST = ("S8", "S9", "S11", "S12")  # nobody arrives in the paper


def bands_line(context):
    """The set that is closest, and what it misses."""
    judged = {s: [one for one in judgements_of(context, s) if one.holds is not None] for s in context.sets}
    judged = {scene_set: found for scene_set, found in judged.items() if found}
    if not judged:
        return ""
    best = max(judged, key=lambda s: sum(one.holds for one in judged[s]) / len(judged[s]))
    missed = [one.name for one in judged[best] if not one.holds]
    words = f"; missed: {', '.join(missed)}" if missed else ""
    return (
        f"* With one number fitted, the goal radius, {sum(one.holds for one in judged[best])} of {len(judged[best])} bands hold"
        f" {SET_UPS[best]}{words}.\n"
    )


def lost_line(context):
    """Where nobody arrives, as in the paper."""
    lines = []
    for scene_set in context.sets:
        results = [context.scenario(scene_set, name) for name in LOST]
        if all(results):
            some = [f"{name} {in_words(one.arrived)}" for name, one in zip(LOST, results) if one.arrived[0] > bands.SLACK]
            lines.append(f"{SET_UPS[scene_set]} {', '.join(some) + ' of 50 arrive' if some else 'nobody arrives either'}")
    return f"* Where the paper loses everybody ({', '.join(LOST)}): {'; '.join(lines)}.\n" if lines else ""


def losses_line(context):
    """The numbers that the paper gives and water at v_F does not."""
    lines = []
    waters = [(SET_UPS[s], plan.reading_of(s, "", ())) for s in context.sets]
    waters += [(f"as run, emitter at {push:g} v_F", plan.emitter_cases("paper", push)) for push in plan.EMITTER_PUSHES]
    for words, cases in waters:
        results = [context.get(case) for case in cases]
        if results and results[-1] is not None and results[plan.PUSHED.index("S6")] is not None:
            s6, groups = results[plan.PUSHED.index("S6")], results[-1]
            lines.append(f"{words} {s6.arrived[0]:.1f} and {groups.arrived_of('walkers')[0]:.1f}")
    if not lines:
        return ""
    return (
        f"* Arrivals in S6 and of those who cross in two groups, of 50 each (paper: 35, and 8 in all): {'; '.join(lines)}. Water at"
        " v_F loses too few.\n"
    )


def block_line(context):
    found = [(water, water.saving_places()) for water in waters_of(context, context.sets)]
    words = [f"{water.words} at x {', '.join(f'{place:g}' for place in places)} m" for water, places in found if places]
    if not words:
        return ""
    return (
        f"* The block of 7 x 7 m saves people where it stands among or upstream of them: {'; '.join(words)}. At x"
        f" {plan.OBSTACLE_AT} m, the place assumed, it does not.\n"
    )


def summary_section(context):
    lines = bands_line(context) + lost_line(context) + losses_line(context) + block_line(context)
    if not lines:
        return ""
    return "## In short\n\n" + lines + "* All that differs, and why as far as it is known, stands under What does not agree.\n"
