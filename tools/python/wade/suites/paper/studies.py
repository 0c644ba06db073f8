"""Sections of report.md on readings, particles, phase diagram, goal radius, depth of the water and variations."""

from wade.reports.tables import markdown, section
from wade.suites.paper import plan, plots
from wade.suites.paper.bands import count_in_words, judge_scenario, time_error
from wade.sweeps.limits import loss_velocity, of_limit
from wade.suites.paper.words import SET_UPS, arrived_of, crossing, met_of, outcome, shown, time_of

TAUS = (0, 0.2, 0.8, 1)  # of S1 to S3, S4 to S6 and so on
TABLE = {name: (TAUS[i // 3], plan.velocity_of(name)) for i, name in enumerate(plan.SCENARIOS)}


def factor_words(context, result_of):
    error = time_error(context.paper, result_of)
    return "-" if error is None else f"{error:.2f}"


def readings_section(context):
    head = ["reading", *plan.PUSHED, "two groups: cross", "water met in S5", "bands of S4 to S10 met", "times wrong by a factor of"]
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
    plots.phase_plot(context.out / "phase.png", results, marked, some.scene)
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


def goal_section(context, paper_time=46):
    points = [(radius, context.get(plan.goal_case(radius))) for radius in plan.GOAL_RADII]
    points = [(radius, result) for radius, result in points if result is not None and result.time is not None]
    if not points:
        return ""
    curve = {"S1": [(radius, result.time) for radius, result in points]}
    plots.curves_plot(context.out / "goal.png", [("last arrival of S1, s", curve, [(paper_time, "paper")])], "goal radius, m")
    lines = [[f"{radius:g}", time_of(result), arrived_of(result)] for radius, result in points]
    text = "When an agent has arrived is not published. The scenes take 1.4 m, fitted on S1 alone."
    return section("The fitted number: the goal radius", text, markdown(["goal radius, m", "S1: last arrival, s", "arrived"], lines),
                   "![goal radius](goal.png)")


def sweep_section(context, title, text, case_of, values, unit, picture, label):
    """Outcomes over a property of the water; "" without results."""
    values = sorted((*values, 1))
    arrived, times, lines = {}, {}, []
    for name in plan.SWEPT:
        known = {value: result for value in values if (result := context.get(case_of(name, value))) is not None}
        if len(known) < 2:
            continue
        words, group = name.replace("_", " "), "walkers" if name == "two_groups" else None
        arrived[words] = [(v, r.arrived_of(group) if group else r.arrived) for v, r in known.items()]
        times[words] = [(v, r.time) for v, r in known.items()]
        lines.append([words, *(crossing(known.get(v)) if group else outcome(known.get(v)) for v in values)])
    if not lines:
        return ""
    by_value = [{name: context.get(case_of(name, value)) for name in plan.PUSHED} for value in values]
    lines.append(["bands of S4 to S10 met", *(count_in_words(map(judge_scenario, plan.PUSHED, found.values())) for found in by_value)])
    lines.append(["times wrong by a factor of", *(factor_words(context, found.get) for found in by_value)])
    panels = [("agents that arrive (of those that cross)", arrived, []), ("last arrival, s", times, [])]
    plots.curves_plot(context.out / picture, panels, label)
    return section(title, text, markdown(["", *(f"{value:g}{unit}" for value in values)], lines), f"![{title}]({picture})")


def depth_section(context):
    text = (
        "The contact mass is proportional to the depth of the water at the agents, which the paper does not give for "
        "its runs (1 m is the opening of its emitter). Set as observed, all else unchanged.")
    return sweep_section(context, "The depth of the water", text, plan.depth_case, plan.DEPTHS, " m", "depth.png",
                         "depth of the water, m")


def push_section(context):
    text = (
        "The authors' logs of the run with v_F 1.5 m/s have 2.9 to 3.9 m/s at the agents near the front, 1.9 to 2.6 "
        "times v_F. The set as observed moves front and particles at 2.6 v_F and pushes with v_F; here it pushes "
        "faster, all else unchanged.")
    return sweep_section(context, "The speed of the water at the agents", text, plan.push_case, plan.PUSHES, " v_F", "push.png",
                         "speed with which the water pushes, over v_F")


def variations_section(context):
    lines = []
    for scene_set in context.sets:
        for name in plan.VARIATIONS:
            result = context.other(scene_set, name) if plan.has_scene(scene_set, name) else None
            if result is None:
                continue
            groups = [group["name"] for group in result.scene["crowd"]["groups"]]
            each = "; ".join(f"{group} {result.arrived_of(group)[0]:.1f}" for group in groups)
            lines.append([name.replace("_", " "), SET_UPS[scene_set], result.agents, time_of(result), arrived_of(result),
                          shown(result.dead, 1), each if len(groups) > 1 else "-"])
    head = ["scene", "set", "agents", "last arrival, s", "arrived", "dead", "arrived by group"]
    return section("Variations", "What the paper's conclusions call for; it gives no numbers.", markdown(head, lines)) if lines else ""
