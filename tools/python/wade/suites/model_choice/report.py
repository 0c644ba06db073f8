"""The report of the choice of the model, and its plot: estimated against actual error."""

import re
import statistics

from wade.reports import plots
from wade.reports.files import write_whole
from wade.reports.machine import machine_line
from wade.reports.plots import pyplot
from wade.reports.tables import document, markdown, section
from wade.suites.model_choice import runs

MARKS = {"0.05": "o", "0.1": "s", "0.3": "^"}
INTRO = """\
# Choice of the model by tolerance

Written by `tools/wade model-choice`. Machine: {machine} One thread; costs are CPU time of the solver.

Each scene was run with `"model": "auto"` and a `max_impulse_error` of {demands}, with its default settings (dfsph at the paper's
spacing of 0.4642 m), and with dfsph at a fine spacing. Errors are those of the impulse on each person who stands against the
fine run, relative to its load (`tests/validation/impulse.hpp`). The fine run is our own and no truth; its spacing is in the last
table. *Held*: the actual median error is at most the demand. None of the scenes is one that the table of the choice
(`fluid_server/model_choice/table.csv`) was measured with.

Rules and the margin of 1.5 in the estimates were fixed before these runs. The table was changed once after them: of the first
35 demands 29 held, and four of the six others were rivers by the kinematic stream, whose row rested on one seed, a lucky one.
Since then the rows of models that draw numbers hold the largest error of eight seeds, as those of dfsph held that of a changed
gravity from the start. The scenes {unseen} were added after that change.
"""


def near_finest(row):
    """Whether the fine run is hardly finer than what was chosen, so that their distance says less than the error."""
    found = re.match(r"dfsph, d = (\S+) m", row["chosen"])
    return found is not None and float(found[1]) < 2 * runs.FINEST[row["scene"]]


def summary(rows):
    met = [r for r in rows if not r.get("refused")]
    held = [r for r in met if r["held"] == "yes"]
    below = [r for r in met if float(r["actual_median"]) <= float(r["estimated_median"])]
    p95 = [r for r in met if float(r["actual_p95"]) <= float(r["estimated_p95"])]
    lines = [f"* Of {len(rows)} demands in {len({r['scene'] for r in rows})} scenes {len(met)} were taken on and "
             f"{len(rows) - len(met)} refused as no candidate is estimated to meet them.",
             f"* Of those taken on, **{len(held)} of {len(met)} held**."]
    for demand in runs.DEMANDS:
        some = [r for r in met if float(r["demand"]) == demand]
        if some:
            good = sum(r["held"] == "yes" for r in some)
            cost = statistics.median(float(r["cost_over_default"]) for r in some)
            lines.append(f"* Demand {demand:g}: {good} of {len(some)} held; median cost {cost:.2g} times that of the default.")
    lines.append(
        f"* The median was at most the estimate in {len(below)} of {len(met)}, the 95th percentile at most its own in "
        f"{len(p95)} of {len(met)}."
    )
    some = [r for r in met if r["scene"] in runs.UNSEEN]
    if some:
        good = sum(r["held"] == "yes" for r in some)
        lines.append(f"* In the scenes that were added after the table was changed {good} of {len(some)} held.")
    lines.append(f"* The pilot contradicted the first choice in {sum(r['went_up'] == 'yes' for r in met)} of {len(met)}.")
    distinct = {r["scene"]: float(r["default_median"]) for r in rows}
    for demand in runs.DEMANDS:
        good = sum(v <= demand for v in distinct.values())
        lines.append(f"* The default settings have an error of at most {demand:g} in {good} of {len(distinct)} runs.")
    near = [r for r in met if near_finest(r)]
    if near:
        lines.append(
            f"* In {len(near)} of {len(met)} dfsph was chosen with less than twice the spacing of the fine run: there "
            "the actual error is a lower bound (>= in the table) and *held* says little."
        )
    failed = [r for r in met if r["held"] != "yes"]
    if failed:
        lines += ["", "Not held:", ""]
        lines += [f"* {r['scene']}, demand {r['demand']}: {r['chosen']}, estimated {r['estimated_median']}, actual "
                  f"{r['actual_median']}" for r in failed]
    return lines


def table(rows):
    lines = []
    for r in rows:
        if r.get("refused"):
            smallest = r["refused"].split("allowed: ")[-1].rstrip(".")
            lines.append([r["scene"], r["demand"], f"refused; allowed: {smallest}", "", "", "", "", r["default_median"],
                          "", ""])
            continue
        chosen = r["chosen"] + (" (pilot went up)" if r["went_up"] == "yes" else "")
        actual = (">= " if near_finest(r) else "") + r["actual_median"]
        held = "yes" if r["held"] == "yes" else "**no**"
        lines.append([r["scene"], r["demand"], chosen, r["estimated_median"], actual, held,
                      f"{r['estimated_p95']}, {r['actual_p95']}", r["default_median"], r["cost_over_default"],
                      r["choice_cpu_s"]])
    head = ("scene", "demand", "chosen", "estimate", "actual median", "held", "95 %: estimate, actual",
            "default's median", "cost / default", "CPU s of the choice")
    return markdown(head, lines)


def references(names):
    left_out = ", ".join(f"{name} at {demand:g}" for name, demand in sorted(runs.LEFT_OUT) if name in names)
    note = f"Left out, as the run as chosen would take longer than the finest: {left_out}." if left_out else ""
    rows = [(f"`{runs.file_of(name)}`", f"{runs.FINEST[name]:g}") for name in names]
    return section("Finest runs", note, markdown(("scene", "spacing, m"), rows))


def draw(rows, file):
    """A point a scene and demand; below the diagonal the estimate was too low."""
    taken = [r for r in rows if not r.get("refused")]
    figure, axes = pyplot.subplots(figsize=(6.4, 5.6))
    models = sorted({r["chosen"].split(",")[0] for r in taken})
    seen = set()
    for r in taken:
        model = r["chosen"].split(",")[0]
        label, colour = f"{model}, demand {r['demand']}", plots.COLOURS[models.index(model)]
        axes.loglog(float(r["actual_median"]), float(r["estimated_median"]), MARKS.get(r["demand"], "o"), color=colour,
                    markerfacecolor="none" if r["held"] == "yes" else colour, markersize=8,
                    label=None if label in seen else label)
        seen.add(label)
    limits = (2e-3, 1.0)
    axes.plot(limits, limits, color="0.5", linewidth=1)
    for demand in MARKS:
        axes.axvline(float(demand), color="0.8", linewidth=0.8, linestyle=":")
    axes.set(xlim=limits, ylim=limits, xlabel="actual median error of the impulse", ylabel="estimated median error")
    axes.set_title("Choice of the model: filled marks did not hold", fontsize=10)
    axes.legend(fontsize=7)
    plots.save(figure, file)


def write(rows, names, out):
    draw(rows, out / "estimate_against_actual.png")
    demands = ", ".join(f"{d:g}" for d in runs.DEMANDS[:-1]) + f" and {runs.DEMANDS[-1]:g}"
    head = INTRO.format(machine=machine_line(), demands=demands, unseen=" and ".join(runs.UNSEEN))
    picture = "![estimate against actual error](estimate_against_actual.png)"
    write_whole(out / "report.md", document(head, section("How often it held", "\n".join(summary(rows)), picture),
                                            section("All demands", table(rows)), references(names)))
