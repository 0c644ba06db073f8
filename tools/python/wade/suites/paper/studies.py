"""Sections of report.md on scenarios beside Table 1, readings, ten times the particles, arrivals over tau and v_F."""

import statistics

from wade.reports.tables import markdown, section
from wade.suites.paper import pictures, plan
from wade.suites.paper.bands import (SET_UPS, arrived_of, count_in_words, crossing, in_words, judge_scenario, met_of,
                                     outcome, shown, time_error, time_of)
from wade.sweeps.limits import loss_velocity, of_limit

TAUS = (0, 0.2, 0.8, 1)  # of S1 to S3, S4 to S6 and so on
TABLE = {name: (TAUS[i // 3], plan.velocity_of(name)) for i, name in enumerate(plan.SCENARIOS)}


def factor_words(context, result_of):
    error = time_error(context.paper, result_of)
    return "-" if error is None else f"{error:.2f}"


def readings_section(context):
    head = ["reading", *plan.PUSHED, "two groups: cross", "water met in S5", "bands of S4 to S10 met",
            "times wrong by a factor of"]
    tables = []
    for scene_set in context.sets:
        rows = {"the scenes as they are": plan.reading_of(scene_set, "", ())}
        rows["contact rule `sum`"] = plan.contact_cases(scene_set)
        rows["coupling rule `continuous`"] = plan.continuous_cases(scene_set)
        for words, (suffix, changes) in plan.water_readings(scene_set).items():
            rows[words] = plan.reading_of(scene_set, suffix, changes)
        for push in plan.EMITTER_PUSHES:
            rows[f"emitter at {push:g} v_F"] = plan.emitter_cases(scene_set, push)
        lines = []
        for words, cases in rows.items():
            results = [context.get(case) for case in cases]
            if any(results):
                lines.append([words, *map(outcome, results[:-1]), crossing(results[-1]), met_of(results[1]),
                              count_in_words(map(judge_scenario, plan.PUSHED, results)),
                              factor_words(context, dict(zip(plan.PUSHED, results)).get)])
        if len(lines) > 1:
            tables.append(section(SET_UPS[scene_set], markdown(head, lines), level=3))
    text = (
        "Time of the last arrival, s, and how many of 50 arrive where not all do. `sum` is the paper's text (contact "
        "within 0.75 m, 1767 kg a metre of depth), `difference` its authors' program (0.25 m, 196 kg). Paper: S4 54 s, "
        "S5 93 s, S6 160 s with 35, S7 97 s, S8 nobody, S10 140 s, two groups 8 in all. `continuous` is Eq. 9 as a "
        "differential equation with the same steady state (`tools/wade frame-rates` shows either rule at 15 to 120 "
        "frames/s).")
    return section("Readings", text, *tables) if tables else ""


def particles_section(context):
    lines = []
    for scene_set in context.sets:
        for coarse, fine in zip(plan.coarse_cases(scene_set), plan.fine_cases(scene_set)):
            results = context.get(coarse), context.get(fine)
            if all(results):
                told = crossing if fine.name == "two_groups" else outcome
                cells = [SET_UPS[scene_set], fine.name.replace("_", " ")]
                lines.append([*cells, *map(told, results), *map(met_of, results)])
    head = ["set", "scenario", "27,000 particles", "270,000 particles", "water met", "water met"]
    text = (
        "The mean contact mass does not depend on the particles' size, its scatter does, and Eq. 9 is concave in it: "
        "with fewer, heavier particles an agent is often untouched and walks freely for a frame, so that it gets "
        "further than its mean contact mass would allow. Of the two groups: those who cross.")
    return section("Ten times the particles", text, markdown(head, lines)) if lines else ""


def phase_section(context):
    points = [(tau, velocity) for tau in plan.PHASE_TAU for velocity in plan.PHASE_V_F]
    results = {point: result for point in points if (result := context.get(plan.phase_case(*point)))}
    if not results:
        return ""
    some = next(iter(results.values()))
    marked = {name: point for name, point in TABLE.items() if point[0] > 0}
    pictures.phase_plot(context.out / "phase.png", results, marked, some.scene)
    across = [of_limit(result.scene) for result in results.values()
              if of_limit(result.scene) > 1 and result.arrived[0] >= 0.5 * some.agents]
    lost = of_limit(some.scene, tau=1, velocity=loss_velocity(some.scene, 1))
    far = f" Simulated, most still arrive up to {max(across):.2f} of the limit." if across else ""
    text = (
        f"{len(results)} points of {len(some.runs)} seeds or more, set as observed, simulated with the pair. The "
        "closed form says where an agent that walks straight against the stream stands still. These agents cross it: "
        "heading straight across, they are lost where they drift as far as the fall before they are over, at v_F = "
        f"{lost:.2f} of that limit (way to the fall over width of the river).{far}")
    return section("Who crosses, over tau and v_F", text, "![phase diagram](phase.png)")


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
    text = ("Paper: 8 of 100 arrive with two groups; 26 of 52 with the obstacle (x 60 to 67 m, an assumption) and 8 "
            "without; all after the switch of tau.")
    return section("Two groups, obstacle, switch of tau", text, markdown(head, lines))
