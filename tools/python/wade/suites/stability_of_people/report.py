"""The report of the stability of people, with its picture."""

import numpy as np

from wade.reports.files import write_whole
from wade.reports.plots import COLOURS, MARKS, panels, save
from wade.reports.tables import document, markdown, section
from wade.suites.stability_of_people.calibration import (CHILDREN, DEEPEST, DEFRA, DEPTH_TIMES_SPEED, SETS, critical, demands,
                                                         errors, rms)

FLUME_GOAL = 0.03  # largest deviation from the equations, each person; half of it for the 0.6 s from failure to motion
PERSON = (1.70, 65)  # height, m, and mass, kg, of the curves in the picture
HEAD = """# When water takes people off their feet

The equations of the response `measured` (`crowd_client/people/person.hpp`) beside what flumes found. Errors are of ln u,
u the speed at which somebody slips or topples. Each set has bodies that span those of its people.

`tools/wade stability-of-people` writes this file; `stability_of_people.csv` holds each point.
"""


def percent(value):
    return f"{100 * value:.1f} %"


def calibration(constants, missed):
    rows = []
    for data in SETS:
        found = errors(data, data.bodies, constants[data.name])
        if rms(found) > data.goal:
            missed.append(f"{data.title}: RMS {percent(rms(found))}, goal {percent(data.goal)}")
        mu, arm = constants[data.name]
        low, high = data.depths
        rows.append((data.title, f"{len(data.bodies)}, {low:g} to {high:g} m", f"{mu:.2f}", f"{arm:.3f}", percent(rms(found)),
                     percent(data.goal), percent(float(np.abs(found).max())), data.skill or "-"))
    return section(
        "Calibration", "Two constants a set, fitted to it: friction mu and arm of the weight lambda, over the height. "
        "These errors are what the form of the equations leaves, no forecast. In 0.2 m of water and more no one keeps the "
        "footing above 3 m/s, a limit of the equations without a constant to fit.",
        markdown(("set", "bodies, depths", "mu", "lambda", "RMS", "goal", "worst", "skill in scenes"), rows),
        "Karvonen's formulas know the product of height and mass alone, which no balance of forces gives: their errors are a floor.")


def prediction(constants):
    rows = []
    for data in SETS:
        if data.children:
            for height, mass in CHILDREN:
                found = errors(data, ((height, mass),), constants[data.name])
                rows.append((data.title, f"{height:g} m, {mass:g} kg", percent(rms(found)), f"{100 * np.mean(found):+.0f} %"))
    return section("Prediction: children with the constants of adults",
                   "The published formula is itself an extrapolation here, as the set's bodies were those of adults.",
                   markdown(("set", "child", "RMS", "mean"), rows))


def flume(in_flume, missed):
    rows = []
    for data in SETS:
        of_set = [row for row in in_flume if row[0] is data]
        off = [found / expected - 1 for *_, expected, found in of_set if found is not None]
        stood = [row for row in of_set if row[-1] is None]
        if not of_set:
            continue
        worst = max(off, key=abs, default=0.0)
        if stood or abs(worst) > FLUME_GOAL:
            missed.append(f"flume, {data.title}: worst {100 * worst:+.1f} %, {len(stood)} never failed; goal {percent(FLUME_GOAL)}")
        depths = ", ".join(f"{depth:g}" for depth in sorted({row[3] for row in of_set}))
        rows.append((data.title, depths, len(of_set), f"{100 * np.mean(off):+.1f} %", f"{100 * worst:+.1f} %"))
    return section(
        "Flume: both programs against the equations",
        "People of the set's bodies and constants stand in water (the shallow-water equations) whose speed grows by 2 % a second. They "
        f"fail when they move. Goal: each within {percent(FLUME_GOAL)}.",
        markdown(("bodies and constants of", "depths, m", "people", "mean", "worst"), rows))


def picture(folder, constants, in_flume):
    figure, (curves, points) = panels(2, (6.2, 5.2), (("depth, m", "speed of the water, m/s"),
                                                      ("published, m/s", "equations with the set's constants, m/s")))
    for k, data in enumerate(SETS):
        style = {"color": COLOURS[k], "label": data.title}
        depths = np.linspace(data.depths[0], min(data.depths[1], DEEPEST * PERSON[0]), 60)
        rows = [(*PERSON, depth) for depth in depths]
        curves.plot(depths, [data.critical(*row) for row in rows], linewidth=1.8, **style)
        curves.plot(depths, critical(demands(rows), constants[data.name]), "--", color=COLOURS[k], linewidth=1.1)
        for bodies, filled in ((data.bodies, True), (CHILDREN if data.children else (), False)):
            own = [(*body, depth) for body in bodies for depth in np.linspace(*data.depths, 10) if depth <= DEEPEST * body[0]]
            if own:
                points.plot([data.critical(*row) for row in own], critical(demands(own), constants[data.name]), MARKS[k],
                            markersize=3.5, markerfacecolor=COLOURS[k] if filled else "none", markeredgecolor=COLOURS[k],
                            markeredgewidth=0.8, label=data.title if filled else f"{data.title}, children")
        for *body, depth, _, found in (row[1:] for row in in_flume if row[0] is data):
            if found is not None and tuple(body) in (PERSON, (1.68, 60)):
                curves.plot(depth, found, MARKS[k], color=COLOURS[k], markersize=5, markeredgecolor="k", markeredgewidth=0.6)
    depths = np.linspace(0.2, 1.2, 100)
    for (name, product), line in zip(DEPTH_TIMES_SPEED, ("-.", ":", "--", "-")):
        curves.plot(depths, product / depths, line, color="#9a9aa2", linewidth=0.9, label=f"{name}: {product:g} m2/s")
    curves.plot(depths, DEFRA[1] / depths - 0.5, color="#9a9aa2", linewidth=2.2, alpha=0.5, label=f"{DEFRA[0]}, {DEFRA[1]:g}")
    curves.set(ylim=(0, 4), xlim=(0.15, 1.25), title=f"{PERSON[0]:.2f} m, {PERSON[1]} kg")
    ends = np.array([0.08, 8])
    for share, line in ((1, "-"), (1.1, ":"), (1 / 1.1, ":")):
        points.plot(ends, share * ends, line, color="#5a5a60", linewidth=0.8)
    ticks = (0.2, 0.5, 1, 2, 5)
    points.set(xscale="log", yscale="log", title="all bodies; dotted: 10 %")
    points.set_xticks(ticks, ticks)
    points.set_yticks(ticks, ticks)
    points.set(xlim=(0.15, 6), ylim=(0.15, 6))
    for panel in (curves, points):
        panel.legend(fontsize=7, loc="upper center", bbox_to_anchor=(0.5, -0.12), ncol=2)
    save(figure, folder / "stability_of_people.png", 130)
    return section(
        "In one picture", "![When people lose their footing](stability_of_people.png)",
        "Left: published formulas (lines) and the equations with constants fitted to them (dashes); marks with a black edge are of "
        "the flume, with the set's constants and its body nearest to this one. Grey: limits of guidelines, which do not know "
        "the body and are not scored. Right: each body at each depth.")


def write(folder, constants, in_flume):
    """report.md and its picture; the goals that were missed, as texts."""
    missed = []
    parts = [picture(folder, constants, in_flume), calibration(constants, missed), prediction(constants), flume(in_flume, missed)]
    goals = "Every goal is kept." if not missed else "\n".join(["Missed:", "", *(f"* {text}" for text in missed)])
    write_whole(folder / "report.md", document(HEAD, goals + "\n", *parts, section(
        "Sources", "Abt, Wittler, Taylor, Love, Water Resources Bulletin 25, 1989. Karvonen et al., RESCDAM, 2000. Xia, Falconer, Wang, Xiao, "
        "Journal of Hydrology 511, 2014. AR&R, Book 6 chapter 7. Defra FD2320, 2006. Viseu, 2006, as the paper quotes it.")))
    return missed
