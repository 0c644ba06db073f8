"""Sections of report.md on the scenarios beside Table 1, and on the agents that the paper loses and we do not."""

import statistics

from wade.reports.tables import markdown, section
from wade.suites.paper import plan, plots
from wade.suites.paper.bands import in_words
from wade.suites.paper.words import SET_UPS, arrived_of, crossing, met_of, shown, time_of


def others_section(context):
    lines = []
    for scene_set in context.sets:
        for case in plan.others_cases(scene_set):
            result, name = context.get(case), case.name.replace("_", " ")
            if result is None:
                continue
            if case.name != "two_groups":
                lines.append([name, SET_UPS[scene_set], time_of(result), arrived_of(result), shown(result.dead, 1), met_of(result)])
                continue
            for group in ("walkers", "upstream"):
                dead = statistics.fmean(run.outcome["groups"][group]["dead"] for run in result.runs)
                lines.append([f"{name}: {group}", SET_UPS[scene_set], time_of(result) if group == "walkers" else "-",
                              in_words(result.arrived_of(group)), shown(dead, 1), met_of(result)])
    if not lines:
        return ""
    head = ["scenario", "set", "time of the last arrival, s", "arrived", "dead", "water met"]
    text = (
        "Paper: 8 of 100 arrive with two groups; 26 of 52 with the obstacle (x 60 to 67 m, an assumption) and 8 "
        "without; all after the switch of tau.")
    return section("Two groups, obstacle, switch of tau", text, markdown(head, lines), when_paper_counts(context))


def when_paper_counts(context):
    """The times at which the numbers of the paper have arrived in our runs: what a run that was cut off would show."""
    lines = []
    for name, count in (("S6", 35), ("two groups", 8), ("no obstacle", 8), ("obstacle", 26)):
        for scene_set in context.sets:
            scenario = name.replace(" ", "_")
            result = context.other(scene_set, scenario) if name != "S6" else context.scenario(scene_set, name)
            if result is None or not plan.has_scene(scene_set, scenario):
                continue
            times = [run.arrival_times()[count - 1] for run in result.runs if len(run.arrival_times()) >= count]
            words = f"after {min(times):.0f} to {max(times):.0f} s" if times else "never"
            some = f" (in {len(times)} of {len(result.runs)} runs)" if 0 < len(times) < len(result.runs) else ""
            lines.append([name, SET_UPS[scene_set], count, words + some])
    head = ["scenario", "set", "arrive in the paper", "so many have arrived in ours"]
    return "When the paper's numbers are reached, should its runs have been cut off in time:\n\n" + markdown(head, lines)


def s6_section(context):
    cases = {f"S6 {SET_UPS[scene_set]}": plan.scenario_case(scene_set, "S6") for scene_set in context.sets}
    cases |= {f"S6 as run, emitter at {push:g} v_F": plan.emitter_case("S6", push) for push in plan.EMITTER_PUSHES}
    cases |= {f"S6 as observed, {depth:g} m deep": plan.depth_case("S6", depth) for depth in (1.2, 1.5, 2.0)}
    curves = {words: (sorted(time for run in result.runs for time in run.arrival_times()), len(result.runs))
              for words, case in cases.items() if (result := context.get(case)) is not None}
    if not curves:
        return ""
    plots.arrivals_plot(context.out / "s6.png", curves, [(160, 35, "paper: 35 after 160 s")])
    text = "Number that has arrived over time, in the sets, in faster and in deeper water."
    return section("S6: 35 of 50", text, "![S6](s6.png)")


def value_at(points, target):
    """Where a curve of (x, y) first passes a height, linear between its points; None if it does not."""
    for (x0, y0), (x1, y1) in zip(points, points[1:]):
        if (y0 - target) * (y1 - target) <= 0 and y0 != y1:
            return x0 + (x1 - x0) * (target - y0) / (y1 - y0)
    return None


def losses_section(context):
    """What it would take to lose as many as the paper: depth, speed, and the other group."""
    lines = []
    for words, name, count, group in (("S6", "S6", 35, None), ("two groups, crossing", "two_groups", 8, "walkers"),
                                      ("no obstacle", "no_obstacle", 8, None)):
        cells = [words, count]
        for case_of, values in ((plan.depth_case, plan.DEPTHS), (plan.push_case, plan.PUSHES)):
            known = [(v, context.get(case_of(name, v))) for v in sorted((*values, 1))]
            at = value_at([(v, (r.arrived_of(group) if group else r.arrived)[0]) for v, r in known if r is not None], count)
            cells.append("-" if at is None else f"{at:.2f}")
        lines.append(cells)
    if all(line[2:] == ["-", "-"] for line in lines):
        return ""
    both, alone = context.other("observed", "two_groups"), context.get(plan.phase_case(0.6, 1.5))
    text = (
        "Set as observed. Depth of the water, or speed with which it pushes, at which as many arrive as in the paper; "
        "linear between the values that were run; `-`: at none of them.")
    other = (f"The other group is not what stops them: {crossing(both)} of 50 cross with it, {arrived_of(alone)} without it (same tau"
             " and water)." if both and alone else "")
    head = ["scenario", "arrive in the paper", "at a depth of, m", "at a speed of, v_F"]
    return section("What it would take to lose as many as the paper", text, markdown(head, lines), other)
