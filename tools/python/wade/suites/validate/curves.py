"""The curves of a case beside its reference, one picture a case."""

import csv
import math

from wade.reports import plots
from wade.reports.plots import pyplot

TRUTHS = ("exact_", "measured_", "reference_")
COLOURS = {"coarse": "#8fbcdb", "medium": "#2f7fc1", "fine": "#0b3c6f"}
COLUMNS = 2  # panels side by side


# Cases that have a picture; the numbers of the others stand in the report.
PICTURED = ("dam_break", "crowd_openings")
# Prefixes of curves with all columns in one panel, of the finest run only.
TOGETHER = ("people_", "last_one_out", "speed_by_")


def read_curve(run, curve):
    with open(run["folder"] / curve["file"], newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    columns = {}
    for index, name in enumerate(rows[0]):
        columns[name] = [float(row[index]) if row[index] else math.nan for row in rows[1:]]
    return rows[0][0], columns


def label(name):
    """depth_m -> "depth, m": the last part is the unit where it looks like one."""
    units = {"m": "m", "s": "s", "Pa": "Pa", "pa": "Pa", "N": "N", "1": "", "m_s": "m/s", "m_s2": "m/s2",
             "m2_s": "m2/s", "per_m2": "1/m2"}
    for ending in sorted(units, key=len, reverse=True):
        if name.endswith("_" + ending):
            text = name[: -len(ending) - 1].replace("_", " ")
            return f"{text}, {units[ending]}" if units[ending] else text
    return name.replace("_", " ")


def panels_of(runs):
    """Returns (curve, column) of each simulated column, by first appearance; (curve, None) of curves in one panel."""
    panels = []
    for run in runs:
        for curve in run["curves"]:
            for column in [None] if curve["name"].startswith(TOGETHER) else curve["columns"][1:]:
                if not (column or "").startswith(TRUTHS) and (curve["name"], column) not in panels:
                    panels.append((curve["name"], column))
    return panels


# Truths from published computations, not measurements.
COMPUTED = {
    ("cavity_100", "measured_"): ("ko", "Ghia et al. 1982"),
    ("cavity_400", "measured_"): ("ko", "Ghia et al. 1982"),
    ("cavity_1000", "measured_"): ("ko", "Ghia et al. 1982"),
    ("wet_bed_05", "exact_"): ("k-", "Stoker 1957"),
    ("wet_bed_05", "reference_"): ("k--", "Serre 1953"),
}


def truths_of(columns, column):
    """(prefix, name of the column) of each truth beside a simulated column: measured_height_m beside height_m; one of
    another name, such as measured_ghia, where the curve holds but one simulated column."""
    simulated = [name for name in list(columns)[1:] if not name.startswith(TRUTHS)]
    for prefix in TRUTHS:
        for name in columns:
            rest = name[len(prefix) :]
            if name.startswith(prefix) and (rest == column or (len(simulated) == 1 and rest not in columns)):
                yield prefix, name


def draw_truth(axes, case, x, columns, column):
    """Draws the truths of a column. The legend names a truth with a name of its own, as measured_Kretz_2006."""
    styles = {"exact_": ("k-", "exact"), "measured_": ("ko", "measured"), "reference_": ("k--", "reference")}
    markers = iter("o^sv")
    for prefix, name in truths_of(columns, column):
        style, words = COMPUTED.get((case, prefix), styles[prefix])
        if (case, prefix) not in COMPUTED and name != prefix + column:
            words = name[len(prefix) :].replace("_", " ")
            style = style.replace("o", next(markers))
        axes.plot(x, columns[name], style, label=words, linewidth=1, markersize=3, zorder=3, fillstyle="none")


def draw_together(axes, run, name):
    curve = next(curve for curve in run["curves"] if curve["name"] == name)
    abscissa, columns = read_curve(run, curve)
    for column in curve["columns"][1:]:
        style = next((("k:" if prefix == "reference_" else "k--") for prefix in TRUTHS if column.startswith(prefix)), "-")
        axes.plot(columns[abscissa], columns[column], style, linewidth=1.2, label=label(column.removeprefix("exact_")))
    axes.set_xlabel(label(abscissa), fontsize=8)
    axes.set_ylabel(label(name), fontsize=8)
    axes.tick_params(labelsize=7)
    axes.legend(fontsize=7)


def draw_panel(axes, runs, name, column):
    finest = None
    for run in runs:
        for curve in run["curves"]:
            if curve["name"] == name and column in curve["columns"]:
                abscissa, columns = read_curve(run, curve)
                x, y = columns[abscissa], columns[column]
                shown = [(a, b) for a, b in zip(x, y) if not (math.isnan(a) or math.isnan(b))]
                what = f"{run['spacing_m']:g} m" if run["spacing_m"] else run["level"]
                marker = "." if len(shown) < 25 else ""
                axes.plot(*zip(*shown) if shown else ([], []), marker=marker, color=COLOURS[run["level"]],
                          linewidth=1.2, label=what)
                finest = (x, columns, abscissa)
    if finest:
        draw_truth(axes, runs[-1]["case"], finest[0], finest[1], column)
        axes.set_xlabel(label(finest[2]), fontsize=8)
    axes.set_ylabel(label(column), fontsize=8)
    axes.tick_params(labelsize=7)
    axes.legend(fontsize=7)


def draw(runs, file):
    """Draws one case's runs, coarse to fine; whether it did: not if it has no picture, or a curve's file is missing."""
    panels = panels_of(runs)
    if runs[0]["case"] not in PICTURED or not panels or not all((run["folder"] / curve["file"]).exists() for run in runs
                                        for curve in run["curves"]):
        return False
    across = min(COLUMNS, len(panels))
    down = math.ceil(len(panels) / across)
    figure, axes = pyplot.subplots(down, across, figsize=(4.2 * across, 2.7 * down), squeeze=False)
    names = [column for _, column in panels]
    for axis, panel in zip(axes.flat, panels):
        if panel[1] is None:
            draw_together(axis, [run for run in runs if any(c["name"] == panel[0] for c in run["curves"])][-1], panel[0])
            continue
        draw_panel(axis, runs, *panel)
        if names.count(panel[1]) > 1:  # told apart by the curve alone
            axis.set_title(panel[0].replace("_", " "), fontsize=8)
    for axis in axes.flat[len(panels) :]:
        axis.set_axis_off()
    figure.tight_layout()
    plots.save(figure, file, dpi=90)
    return True
