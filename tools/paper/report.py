"""report.md: sections on what was run, each from the results of its cases; what was not run is left out."""

import bands
import plan
from limits import limits_of, of_limit
from words import SET_UPS, arrived_of, error_percent, markdown_table, met_of, shown, time_of


class Context:
    """What the sections read: results by case, the sets that were asked for, the paper's table."""

    def __init__(self, results, sets, paper, lee=None):
        self.results, self.sets, self.paper, self.lee = results, sets, paper, lee or {}

    def get(self, case):
        return self.results.get(case.key)

    def scenario(self, scene_set, name):
        return self.get(plan.scenario_case(scene_set, name))

    def other(self, scene_set, name):
        return self.get(plan.other_case(scene_set, name))


def judgements_of(context, scene_set):
    """All bands for one set, in the order of the report."""
    found = [bands.judge_scenario(name, context.scenario(scene_set, name)) for name in plan.SCENARIOS]
    found.append(bands.judge_two_groups(context.other(scene_set, "two_groups")))
    found.append(bands.judge_switch(context.other(scene_set, "tau_switch")))
    found.append(bands.judge_obstacle(context.other(scene_set, "obstacle"), context.other(scene_set, "no_obstacle")))
    found.append(bands.judge_lee(context.lee.get(scene_set)))
    pairs = {}
    for coarse, fine in zip(plan.coarse_cases(scene_set), plan.fine_cases(scene_set)):
        pairs[plan_name(fine)] = context.get(coarse), context.get(fine)
    found.append(bands.judge_particles(pairs))
    return found


def plan_name(case):
    return case.name.upper() if case.name[0] == "s" else case.name.replace("_", " ")


def answer(judgement):
    return "-" if judgement.holds is None else "yes" if judgement.holds else "**no**"


def bands_section(context):
    by_set = {scene_set: judgements_of(context, scene_set) for scene_set in context.sets}
    head = ["", "asked for"]
    for scene_set in context.sets:
        head += [SET_UPS[scene_set], "found"]
    lines = []
    for row in zip(*by_set.values()):
        cells = [row[0].name, row[0].asked]
        for judgement in row:
            cells += [answer(judgement), judgement.found or "-"]
        lines.append(cells)
    text = (
        "## Bands\n\nFixed before any result was known (`tools/paper/bands.py`), one set of parameters for all rows,"
        " contact rule `difference`.\nThe one number fitted is the goal radius, 1.4 m, on S1 alone. Times are those of"
        " the last arrival.\nIntervals are of 95 %: bootstrap over seeds for times; Wilson, with the design effect of"
        " runs, for numbers of agents.\n\n"
    )
    return text + markdown_table(head, lines) + "\n" + closest(context, by_set)


def closest(context, by_set):
    lines, scores = [], {}
    for scene_set, judgements in by_set.items():
        judged = [judgement for judgement in judgements if judgement.holds is not None]
        met = sum(judgement.holds for judgement in judged)
        error = bands.time_error(context.paper, lambda name: context.scenario(scene_set, name))
        words = f", times of S4 to S7 and S10 wrong by a factor of {error:.2f} on average" if error else ""
        lines.append(f"* {SET_UPS[scene_set]}: {met} of {len(judged)} bands{words}")
        if judged:
            scores[scene_set] = met / len(judged)
    text = "\n".join(lines) + "\n"
    common = [row for row in zip(*by_set.values()) if all(judgement.holds is not None for judgement in row)]
    if len(by_set) > 1 and common:
        counts = [f"{SET_UPS[name]} {sum(row[i].holds for row in common)}" for i, name in enumerate(by_set)]
        text += f"\nOf the {len(common)} bands judged in each of them: {', '.join(counts)}."
        text += " S1 to S3 hold by construction: nothing pushes at tau 0, and the goal radius is fitted on S1.\n"
    missed = [row[0].name for row in zip(*by_set.values()) if not any(judgement.holds for judgement in row)]
    judged = [row[0].name for row in zip(*by_set.values()) if any(judgement.holds is not None for judgement in row)]
    missed = [name for name in missed if name in judged]
    every = "Each band that was judged is met by at least one set."
    if "obstacle" in missed:
        missed[missed.index("obstacle")] = f"obstacle (at x {plan.OBSTACLE_AT} m; for other places see The place of the obstacle)"
    text += f"\nMet by no set: {', '.join(missed)}.\n" if missed else f"\n{every}\n"
    if len(scores) > 1:
        best = max(scores, key=scores.get)
        text += f"\nThe set {SET_UPS[best]} (`configs/{best}`) comes closest.\n"
    return text


def table1_section(context):
    head = ["", "tau", "v_F", "paper: time", "diff %", "arrived"]
    for scene_set in context.sets:
        head += [f"{SET_UPS[scene_set]}: time", "error %", "diff %", "arrived", "dead"]
    lines = []
    for name, paper in context.paper.items():
        results = [context.scenario(scene_set, name) for scene_set in context.sets]
        if not any(results):
            continue
        cells = [name, shown(paper["tau"], 1), shown(paper["v_f_m_s"], 1), shown(paper["time_s"])]
        cells += [shown(paper["diff_percent"]), shown(paper["arrived"])]
        for scene_set, result in zip(context.sets, results):
            base = context.scenario(scene_set, "S1")
            slower = ""
            if result and result.time and base and base.time:
                slower = 100 * (result.time[0] / base.time[0] - 1)
            cells += [time_of(result), error_percent(result, paper["time_s"]), shown(slower), arrived_of(result)]
            cells.append("-" if result is None else shown(result.dead, 1))
        lines.append(cells)
    text = (
        "## Table 1\n\nTime: arrival of the last agent that arrives, s, `-`: nobody; error: to the paper's time; diff:"
        " to S1 in the same columns.\nThe paper has one run a scenario and gives the number that arrives for S6 only;"
        " the others are read from its text.\n\n"
    )
    return text + markdown_table(head, lines) + "\n![Table 1](table1.png)\n"


def limit_section(context):
    """Where each scenario lies against the closed form, with the water asked for and with that met."""
    head = ["", "limit of v_F, m/s", "v_F / limit"]
    for scene_set in context.sets:
        head += [f"{SET_UPS[scene_set]}: water met", "/ limit", "arrived"]
    lines = []
    for name in plan.SCENARIOS[3:]:
        results = [context.scenario(scene_set, name) for scene_set in context.sets]
        known = next((result for result in results if result), None)
        if known is None:
            continue
        low, high = limits_of(known.scene)
        limit = f"{low:.2f}" if low == high else f"{low:.2f} to {high:.2f}"
        cells = [name, limit, f"{of_limit(known.scene):.2f}"]
        for result in results:
            share = "-"
            if result and result.depth:
                share = f"{of_limit(result.scene, velocity=result.speed, depth=result.depth):.2f}"
            cells += [met_of(result), share, arrived_of(result)]
        lines.append(cells)
    text = (
        "## The closed form\n\nAn agent that walks straight against a uniform stream holds its ground if and only if"
        " v_F < v_B m_a / (tau m_c), with v_B = 0.989 x 1.3 m/s,\nm_a = 65 kg and the mean contact mass m_c = rho h pi"
        " r_c^2, 196 kg in 1 m of water. Above the limit an agent drifts downstream while it crosses,\nand arrives"
        " only if it is across before the fall. Water met: means over the time that each agent was in the"
        " water, of the depth and of the speed\n(depth times speed over depth) in its 2 x 2 m cell, then over the"
        " agents.\n\n"
    )
    return text + markdown_table(head, lines)
