"""Section of report.md on the scenarios beside Table 1."""

import statistics

from wade.reports.tables import markdown, section
from wade.suites.paper import plan
from wade.suites.paper.bands import in_words
from wade.suites.paper.words import SET_UPS, arrived_of, met_of, shown, time_of


def others_section(context):
    lines = []
    for scene_set in context.sets:
        for case in plan.others_cases(scene_set):
            result, name = context.get(case), case.name.replace("_", " ")
            if result is None:
                continue
            if case.name != "two_groups":
                lines.append([name, SET_UPS[scene_set], time_of(result), arrived_of(result), shown(result.dead, 1),
                              met_of(result)])
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
    return section("Two groups, obstacle, switch of tau", text, markdown(head, lines))
