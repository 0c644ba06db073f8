"""Sections of report.md on the scenarios beside Table 1, and on the agents that the paper loses and we do not."""

import statistics

import plan
import plots
from bands import in_words
from words import SET_UPS, arrived_of, markdown_table, met_of, shown, time_of


def others_section(context):
    head = ["scenario", "set", "time of the last arrival, s", "arrived", "dead", "water met"]
    lines = []
    for scene_set in context.sets:
        for case in plan.others_cases(scene_set):
            result = context.get(case)
            if result is None:
                continue
            name = case.name.replace("_", " ")
            if case.name == "two_groups":
                for group in ("walkers", "upstream"):
                    cells = [f"{name}: {group}", SET_UPS[scene_set], time_of(result) if group == "walkers" else "-"]
                    cells += [in_words(result.arrived_of(group)) + result.mark, shown(dead_of(result, group), 1), met_of(result)]
                    lines.append(cells)
                continue
            cells = [name, SET_UPS[scene_set], time_of(result), arrived_of(result), shown(result.dead, 1)]
            lines.append([*cells, met_of(result)])
    if not lines:
        return ""
    text = (
        "## Two groups, obstacle, switch of tau\n\nPaper: 8 of 100 arrive with two groups; 26 of 52 with the obstacle"
        " (x 60 to 67 m, an assumption) and 8 without; all after the switch of tau.\n\n"
    )
    return text + markdown_table(head, lines) + "\n" + when_paper_counts(context)


def dead_of(result, group):
    return statistics.fmean(run.outcome["groups"][group]["dead"] for run in result.runs)


def when_paper_counts(context):
    """The times at which the numbers of the paper have arrived in our runs: what a run that was cut off would show."""
    lines = []
    for name, count, case_of in (
        ("S6", 35, lambda s: plan.scenario_case(s, "S6")),
        ("two groups", 8, lambda s: plan.other_case(s, "two_groups")),
        ("no obstacle", 8, lambda s: plan.other_case(s, "no_obstacle")),
        ("obstacle", 26, lambda s: plan.other_case(s, "obstacle")),
    ):
        for scene_set in context.sets:
            result = context.get(case_of(scene_set)) if plan.has_scene(scene_set, name.replace(" ", "_")) else None
            if result is None:
                continue
            times = [run.arrival_times()[count - 1] for run in result.runs if len(run.arrival_times()) >= count]
            if times:
                words = f"after {min(times):.0f} to {max(times):.0f} s"
            else:
                words = "never"
            some = f" (in {len(times)} of {len(result.runs)} runs)" if 0 < len(times) < len(result.runs) else ""
            lines.append([name, SET_UPS[scene_set], str(count), words + some + result.mark])
    head = ["scenario", "set", "arrive in the paper", "so many have arrived in ours"]
    text = "When the paper's numbers are reached, should its runs have been cut off in time:\n\n"
    return text + markdown_table(head, lines)


def s6_section(context, out):
    cases = {f"S6 {SET_UPS[scene_set]}": plan.scenario_case(scene_set, "S6") for scene_set in context.sets}
    for push in plan.EMITTER_PUSHES:
        cases[f"S6 as run, emitter at {push:g} v_F"] = plan.emitter_case("S6", push)
    for depth in (1.2, 1.5, 2.0):
        cases[f"S6 as observed, {depth:g} m deep"] = plan.depth_case("S6", depth)
    curves = {}
    for words, case in cases.items():
        result = context.get(case)
        if result is not None:
            curves[words] = sorted(time for run in result.runs for time in run.arrival_times()), len(result.runs)
    if not curves:
        return ""
    plots.arrivals_plot(out / "s6.png", curves, [(160, 35, "paper: 35 after 160 s")])
    return "## S6: 35 of 50\n\nNumber that has arrived over time, in the sets, in faster and in deeper water.\n\n![S6](s6.png)\n"


def value_at(points, target):
    """Where a curve of (x, y) first passes a height, linear between its points; None if it does not."""
    for (x0, y0), (x1, y1) in zip(points, points[1:]):
        if (y0 - target) * (y1 - target) <= 0 and y0 != y1:
            return x0 + (x1 - x0) * (target - y0) / (y1 - y0)
    return None


def losses_section(context):
    """What it would take to lose as many as the paper: depth, speed, and the other group."""
    lines = []
    for words, name, count, group in (
        ("S6", "S6", 35, None),
        ("two groups, crossing", "two_groups", 8, "walkers"),
        ("no obstacle", "no_obstacle", 8, None),
    ):
        cells = [words, str(count)]
        for case_of, values in ((plan.depth_case, plan.DEPTHS), (plan.push_case, plan.PUSHES)):
            known = [(v, context.get(case_of(name, v))) for v in sorted((*values, 1))]
            mark = max((r.mark for _, r in known if r is not None), default="")
            means = [(v, (r.arrived_of(group) if group else r.arrived)[0]) for v, r in known if r is not None]
            at = value_at(means, count)
            cells.append("-" if at is None else f"{at:.2f}{mark}")
        lines.append(cells)
    both, alone = context.other("observed", "two_groups"), context.get(plan.phase_case(0.6, 1.5))
    if all(line[2] == "-" and line[3] == "-" for line in lines):
        return ""
    text = (
        "## What it would take to lose as many as the paper\n\nSet as observed. Depth of the water, or speed with"
        " which it pushes, at which as many arrive as in the paper; linear between the\nvalues that were run; `-`: at"
        " none of them.\n\n"
    )
    text += markdown_table(["scenario", "arrive in the paper", "at a depth of, m", "at a speed of, v_F"], lines)
    if both and alone:
        crossing = in_words(both.arrived_of("walkers"))
        text += (
            f"\nThe other group is not what stops them: {crossing}{both.mark} of 50 cross with it, {arrived_of(alone)} without it"
            " (same tau and water).\n"
        )
    return text
