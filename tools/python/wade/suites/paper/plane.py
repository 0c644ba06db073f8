"""Sections of report.md on the safety argument: depth times velocity (Table 2 of the paper) beside the arrivals.

What the people of Table 1 meet, and the sweep over the plane of depth and v_F, which `tools/wade depth-sweep` runs.
"""

import math
import sys

from wade.paths import CONFIGS, module_command
from wade.reports.tables import markdown, section
from wade.run.processes import resolved
from wade.suites.paper import plan
from wade.suites.paper.bands import SET_UPS
from wade.sweeps.depth_sweep import (BOUNDS, TableError, draw, level_of, limit_in_words, limit_of, read_table,
                                     shares)

SCENE = CONFIGS / "observed" / "observed.json"
TAUS = (0.2, 0.8)  # those of S4 to S6 and of S7 to S9


def run_plane(chosen, pair):
    """The sweep in the set as observed, into the report's folder. Returns its exit code."""
    words = ["--scene", SCENE, "--taus", ",".join(map(str, TAUS)), "--seeds", f"1-{max(1, chosen.seeds // 2)}"]
    words += ["--out", chosen.out]
    return pair.start(list(map(str, [*module_command("wade.sweeps.depth_sweep"), *words])), stdout=sys.stderr).wait()


def level_words(product):
    return level_of(product).replace("_", " ")


def danger_section(context):
    """Returns the arrivals of each scenario of Table 1 beside the levels of Table 2, of the water asked for and met."""
    head = ["", "tau", "asked for: H v_F", "level"]
    for scene_set in context.sets:
        head += [f"{SET_UPS[scene_set]}: met", "level", "arrive, %"]
    lines = []
    for name, paper in context.paper.items():
        results = [context.scenario(scene_set, name) for scene_set in context.sets]
        if not any(results):
            continue
        asked = plan.velocity_of(name)  # in 1 m of water
        cells = [name, f"{float(paper['tau']):g}", f"{asked:g}", level_words(asked)]
        for result in results:
            met = None if result is None or result.depth is None else round(result.depth * result.speed, 2)
            cells += ["-", "-"] if met is None else [f"{met:.2f}", level_words(met)]
            cells.append("-" if result is None else f"{100 * result.arrived[0] / result.agents:.0f}")
        lines.append(cells)
    if not lines:
        return ""
    bounds = ", ".join(f"{level.replace('_', ' ')} from {bound:g}" for level, bound in BOUNDS.items())
    text = (
        f"Table 2 of the paper (Viseu) grades water by depth times velocity, m2/s: {bounds}. Met: mean depth times "
        "mean speed of the water that the people met, the front among it, so that it may lie a level below what was "
        "asked for. A level alone does not say who arrives: people of tau 0 walk through water of the highest.")
    return section("Danger levels", text, markdown(head, lines))


def value_at(points, target):
    """Where a curve of (x, y) first passes a height, linear between its points; None if it does not."""
    for (x0, y0), (x1, y1) in zip(points, points[1:]):
        if (y0 - target) * (y1 - target) <= 0 and y0 != y1:
            return x0 + (x1 - x0) * (target - y0) / (y1 - y0)
    return None


def half_products(rows):
    """Returns {depth: H v_F where half of the people arrive, m2/s}, and the number of all depths. Interpolates linearly
    in the logarithm of the velocity; leaves out depths without such a point between two velocities of the sweep."""
    depths, speeds, share = shares(rows)
    found = {depth: value_at(list(zip(map(math.log, speeds), line)), 0.5) for depth, line in zip(depths, share)}
    return {depth: depth * math.exp(log) for depth, log in found.items() if log is not None}, len(depths)


def half_words(tau, rows, scene):
    products, depths = half_products(rows)
    half = "at no depth does the share that arrives pass a half"
    if products:
        low, high = min(products.values()), max(products.values())
        rest = ", elsewhere at no velocity of the sweep" if len(products) < depths else ""
        half = f"half arrive at H v_F of {low:.2f} to {high:.2f} m2/s at {len(products)} of {depths} depths{rest}"
    return f"* tau {tau:g}: {half}; Eq. 9 lets an agent stand against up to {limit_in_words(limit_of(scene, tau))} m2/s."


def by_level(rows):
    """{level: (points of the sweep, share that arrives)} of the depth times velocity asked for."""
    levels = {}
    for row in rows:
        points, arrived, agents = levels.get(row["level"], (set(), 0, 0))
        point = row["depth_m"], row["v_f_m_s"]
        levels[row["level"]] = points | {point}, arrived + int(row["arrived"]), agents + int(row["agents"])
    return {level: (len(points), arrived / agents) for level, (points, arrived, agents) in levels.items()}


def plane_section(context):
    """Draws the sweep that is in the folder of the report, if there is one, and says what it shows."""
    title = "Depth times velocity"
    try:
        rows = read_table(context.out / "depth_sweep.csv")
    except TableError as error:
        return section(title, f"Not drawn: {error}.")
    if not rows:
        return ""
    scene = resolved(SCENE)
    draw(rows, scene, context.out / "depth_sweep.png")
    taus = sorted({float(row["tau"]) for row in rows})
    of_tau = {tau: [row for row in rows if float(row["tau"]) == tau] for tau in taus}
    seeds, commits = sorted({int(row["seed"]) for row in rows}), sorted({row["commit"] for row in rows})
    depths, speeds, share = shares(rows)
    levels = {tau: by_level(of_tau[tau]) for tau in taus}
    lines = []
    for level in BOUNDS:
        known = [levels[tau].get(level) for tau in taus]
        if any(known):
            lines.append([level.replace("_", " "), max(found[0] for found in known if found),
                          *("-" if found is None else f"{100 * found[1]:.0f}" for found in known)])
    text = (f"Who arrives at {(share == share).sum()} points, depths of {depths[0]:g} to {depths[-1]:g} m and v_F of "
            f"{speeds[0]:g} to {speeds[-1]:g} m/s, set as observed, simulated with the pair (seeds {seeds[0]} to "
            f"{seeds[-1]}, programs of commit {', '.join(commits)}). Water shallower than the particles' spacing has "
            "smaller particles. The shares of a level are means over its points and depend on where these lie.")
    table = markdown(["level of H v_F", "points", *(f"tau {tau:g}: arrive, %" for tau in taus)], lines)
    return section(title, text, table, "\n".join(half_words(tau, of_tau[tau], scene) for tau in taus),
                   "![depth times velocity](depth_sweep.png)")
