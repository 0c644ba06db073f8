"""Sections of report.md on readings, particles, phase diagram, goal radius, depth of the water and variations."""

import plan
import plots
from bands import count_in_words, in_words, judge_scenario, time_error
from limits import loss_velocity, of_limit
from words import SET_UPS, arrived_of, markdown_table, met_of, shown, time_of

TAUS = (0, 0.2, 0.8, 1)  # of S1 to S3, S4 to S6 and so on
TABLE = {name: (TAUS[i // 3], plan.velocity_of(name)) for i, name in enumerate(plan.SCENARIOS)}


def outcome(result):
    if result is None:
        return "-"
    if result.arrived[0] == 0:
        return "nobody" + result.mark
    some = f"; {in_words(result.arrived)} arrive" if result.arrived[0] < result.agents else ""
    return time_of(result) + some + result.mark


def crossing(result):
    """Arrivals of those who cross the river where two groups walk, of 50."""
    return "-" if result is None else in_words(result.arrived_of("walkers")) + result.mark


def readings_section(context):
    text = ""
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
                cells = [words, *map(outcome, results[:-1]), crossing(results[-1]), met_of(results[1])]
                judged = map(judge_scenario, plan.PUSHED, results)
                error = time_error(context.paper, dict(zip(plan.PUSHED, results)).get)
                lines.append([*cells, count_in_words(judged), "-" if error is None else f"{error:.2f}"])
        if len(lines) > 1:
            head = ["reading", *plan.PUSHED, "two groups: cross", "water met in S5", "bands of S4 to S10 met"]
            head.append("times wrong by a factor of")
            text += f"### {SET_UPS[scene_set]}\n\n" + markdown_table(head, lines) + "\n"
    if not text:
        return ""
    return (
        "## Readings\n\nTime of the last arrival, s, and how many of 50 arrive where not all do. `sum` is the paper's"
        " text (contact within 0.75 m, 1767 kg a metre of depth), `difference` its\nauthors' program (0.25 m, 196 kg)."
        " Paper: S4 54 s, S5 93 s, S6 160 s with 35, S7 97 s, S8 nobody, S10 140 s,\ntwo groups 8 in all. `continuous` is Eq. 9 as a"
        " differential equation with the same steady state (`docs/results.md` shows either rule at 15 to 120"
        " frames/s).\n\n"
    ) + text


def particles_section(context):
    lines = []
    for scene_set in context.sets:
        for coarse, fine in zip(plan.coarse_cases(scene_set), plan.fine_cases(scene_set)):
            results = context.get(coarse), context.get(fine)
            if all(results):
                cells = [SET_UPS[scene_set], fine.name.replace("_", " ")]
                told = crossing if fine.name == "two_groups" else outcome
                lines.append([*cells, *map(told, results), *map(met_of, results)])
    if not lines:
        return ""
    head = ["set", "scenario", "27,000 particles", "270,000 particles", "water met", "water met"]
    return (
        "## Ten times the particles\n\nThe mean contact mass does not depend on the particles' size, its scatter does,"
        " and Eq. 9 is concave in it: with fewer, heavier particles\nan agent is often untouched and walks freely for"
        " a frame, so that it gets further than its mean contact mass would allow. Of the two groups: those who cross.\n\n"
    ) + markdown_table(head, lines)


def phase_section(context, out):
    results = {}
    for tau in plan.PHASE_TAU:
        for velocity in plan.PHASE_V_F:
            result = context.get(plan.phase_case(tau, velocity))
            if result is not None:
                results[(tau, velocity)] = result
    if not results:
        return ""
    some = next(iter(results.values()))
    marked = {name: point for name, point in TABLE.items() if point[0] > 0}
    plots.phase_plot(out / "phase.png", results, marked, some.scene)
    rows = [(tau, velocity, len(r.runs), *r.arrived, r.dead, r.time[0] if r.time else "", of_limit(r.scene))
            for (tau, velocity), r in results.items()]
    with open(out / "phase.csv", "w", encoding="utf-8") as file:
        file.write("tau,v_f_m_s,seeds,arrived_mean,arrived_lo,arrived_hi,dead_mean,time_s_mean,v_f_over_limit,commits\n")
        for row, result in zip(rows, results.values()):
            cells = [f"{value:.6g}" if isinstance(value, float) else str(value) for value in row]
            file.write(",".join([*cells, " ".join(result.commits)]) + "\n")
    above = [row for row in rows if row[-1] > 1]
    across = [row for row in above if row[3] >= 0.5 * some.agents]
    far = max((row[-1] for row in across), default=None)
    lost = of_limit(some.scene, tau=1, velocity=loss_velocity(some.scene, 1))
    text = (
        f"## Who crosses, over tau and v_F\n\n{len(results)} points of {rows[0][2]} seeds or more, set as observed,"
        " simulated with the pair (`phase.csv`).\nThe closed form says where an agent that walks straight against the"
        " stream stands still. These agents cross it: heading straight across, they are\nlost where they drift as far"
        " as"
        f" the fall before they are over, at v_F = {lost:.2f} of that limit (way to the fall over width of the"
        f" river).\n"
    )
    if far:
        text += f"Simulated, most still arrive up to {far:.2f} of the limit.\n"
    return text + "\n![phase diagram](phase.png)\n"


def goal_section(context, out, paper_time=46):
    points = [(radius, context.get(plan.goal_case(radius))) for radius in plan.GOAL_RADII]
    points = [(radius, result) for radius, result in points if result is not None and result.time is not None]
    if not points:
        return ""
    curve = {"S1": [(radius, result.time) for radius, result in points]}
    plots.curves_plot(out / "goal.png", [("last arrival of S1, s", curve, [(paper_time, "paper")])], "goal radius, m")
    lines = [[f"{radius:g}", time_of(result), arrived_of(result)] for radius, result in points]
    return (
        "## The fitted number: the goal radius\n\nWhen an agent has arrived is not published. The scenes take 1.4 m,"
        " fitted on S1 alone.\n\n"
    ) + markdown_table(["goal radius, m", "S1: last arrival, s", "arrived"], lines) + "\n![goal radius](goal.png)\n"


def sweep_table(context, case_of, values, unit):
    """(table, panels of the plot) of the outcomes over a property of the water; ("", []) without results."""
    values = sorted((*values, 1))
    arrived, times, lines = {}, {}, []
    for name in plan.SWEPT:
        known = {value: result for value in values if (result := context.get(case_of(name, value))) is not None}
        if len(known) < 2:
            continue
        label = name.replace("_", " ")
        group = "walkers" if name == "two_groups" else None
        arrived[label] = [(v, r.arrived_of(group) if group else r.arrived) for v, r in known.items()]
        times[label] = [(v, r.time) for v, r in known.items()]
        lines.append([label, *(crossing(known.get(v)) if group else outcome(known.get(v)) for v in values)])
    if not lines:
        return "", []
    bands_met = []
    for value in values:
        results = [context.get(case_of(name, value)) for name in plan.PUSHED]
        bands_met.append(count_in_words(map(judge_scenario, plan.PUSHED, results)))
    lines.append(["bands of S4 to S10 met", *bands_met])
    errors = [time_error(context.paper, lambda name, v=value: context.get(case_of(name, v))) for value in values]
    lines.append(["times wrong by a factor of", *("-" if error is None else f"{error:.2f}" for error in errors)])
    panels = [("agents that arrive (of those that cross)", arrived, []), ("last arrival, s", times, [])]
    return markdown_table(["", *(f"{value:g}{unit}" for value in values)], lines), panels


def depth_section(context, out):
    table, panels = sweep_table(context, plan.depth_case, plan.DEPTHS, " m")
    if not table:
        return ""
    plots.curves_plot(out / "depth.png", panels, "depth of the water, m")
    return (
        "## The depth of the water\n\nThe contact mass is proportional to the depth of the water at the agents, which"
        " the paper does not give for its runs (1 m is the\nopening of its emitter). Set as observed, all else"
        " unchanged.\n\n"
    ) + table + "\n![depth](depth.png)\n"


def push_section(context, out):
    table, panels = sweep_table(context, plan.push_case, plan.PUSHES, " v_F")
    if not table:
        return ""
    plots.curves_plot(out / "push.png", panels, "speed with which the water pushes, over v_F")
    return (
        "## The speed of the water at the agents\n\nThe authors' logs of the run with v_F 1.5 m/s have 2.9 to 3.9 m/s"
        " at the agents near the front, 1.9 to 2.6 times v_F. The set as\nobserved moves front and particles at 2.6"
        " v_F and pushes with v_F; here it pushes faster, all else unchanged.\n\n"
    ) + table + "\n![speed](push.png)\n"


def variations_section(context):
    lines = []
    for scene_set in context.sets:
        for name in plan.VARIATIONS:
            result = context.other(scene_set, name) if plan.has_scene(scene_set, name) else None
            if result is None:
                continue
            groups = [group["name"] for group in result.scene["crowd"]["groups"]]
            each = "; ".join(f"{group} {result.arrived_of(group)[0]:.1f}" for group in groups)
            cells = [name.replace("_", " "), SET_UPS[scene_set], str(result.agents), time_of(result)]
            lines.append([*cells, arrived_of(result), shown(result.dead, 1), each if len(groups) > 1 else "-"])
    if not lines:
        return ""
    head = ["scene", "set", "agents", "last arrival, s", "arrived", "dead", "arrived by group"]
    text = "## Variations\n\nWhat the paper's conclusions call for; it gives no numbers.\n\n"
    return text + markdown_table(head, lines)
