"""Log-log plots of error over cost, with the front drawn and labelled."""

from wade.reports.plots import pyplot, save
from wade.suites.speed_vs_error.settings import default_setting
from wade.suites.speed_vs_error.table import ERRORS, is_default

MARKERS = {"dfsph": "o", "kinematic": "D", "shallow_water": "s", "steering": "^", "mixed": "P"}
COLOURS = ("#1b6ca8", "#d1701f", "#3a8a4d", "#8a4d9e", "#777777")

WORDS = {
    "impulse_median": "impulse on standing agents: median relative error",
    "impulse_p95": "impulse on standing agents: 95th percentile of the relative error",
    "outcome_changed": "share of walking agents with another outcome",
    "end_place_median": "last place of walking agents: median distance from the true one, m",
    "depth_l1": "L1 error of depth / H",
    "speed_l1": "L1 error of speed / sqrt(g H)",
    "height_rms_*": "RMS error of the heights at the gauges / 0.55 m, mean of the gauges",
    "pressure_rms_*": "RMS error of the pressure, mean of P1 and P3",
    "pressure_peak_p*": "relative error of the pressure's peak, mean of P1 and P3",
    "depth_l2": "L2 error of the depth",
    "depth": "relative error of the depth",
    "period": "relative error of the period",
    "pressure_rms": "RMS error of the pressure / rho g H",
    "rms_speed": "RMS speed of water at rest / sqrt(g H)",
    "closure": "momentum budget of the block: what is missing of the force",
}


def words(metric):
    return WORDS.get(metric, metric.rstrip("_*").replace("_", " "))


def plot_name(group):
    return f"{group.case}-{group.metric.rstrip('_*')}.png"


PLOTTED = ("impulse_front",)


def has_plot(group):
    """The main error of some cases has one; a logarithmic axis needs two errors above 0."""
    main = group.case in PLOTTED and group.metric == ERRORS[group.case][0]
    return main and sum(e is not None and e > 0 for e in group.errors) >= 2


def plot(group, file):
    """Draws one group. Errors of 0 have no place on a logarithmic axis and are left out; the table has them."""
    figure, axes = pyplot.subplots(figsize=(8.8, 4.4))
    shown = [(p, e, f) for p, e, f in zip(group.points, group.errors, group.flags) if e is not None and e > 0]
    spacings = sorted({p.setting.spacing for p in group.points}, reverse=True)
    for k, spacing in enumerate(spacings):
        here = [(p, e) for p, e, _ in shown if p.setting.spacing == spacing]
        colour = COLOURS[k % len(COLOURS)]
        for model, marker in MARKERS.items():
            some = [(p, e) for p, e in here if p.setting.model == model]
            if some:
                label = f"d = {spacing:g} m" + ("" if model == "dfsph" else f", {model.replace('_', ' ')}")
                axes.scatter([p.cpu for p, _ in some], [e for _, e in some], s=26 if model == "dfsph" else 34,
                             marker=marker, color=colour, alpha=0.75, linewidths=0, label=label)
        for p, e in here:
            if is_default(p.setting):
                lo, hi = group.spread.get(spacing, (e, e))
                axes.plot([p.cpu, p.cpu], [max(lo, 1e-3 * hi), hi], color=colour, linewidth=1.2)
                axes.scatter([p.cpu], [e], s=110, marker="o", facecolors="none", edgecolors=colour, linewidths=1.4)
    for p, bounds in zip(group.points, group.ranges):
        if bounds and bounds[0] > 0:
            colour = COLOURS[spacings.index(p.setting.spacing) % len(COLOURS)]
            axes.plot([p.cpu, p.cpu], bounds, color=colour, linewidth=0.8)
    best = sorted(((p.cpu, e, p) for p, e, f in shown if f), key=lambda b: b[:2])
    if best:
        axes.plot([c for c, _, _ in best], [e for _, e, _ in best], color="black", linewidth=1, zorder=0, label="front")
    axes.set_xscale("log")
    axes.set_yscale("log")
    names = []
    for k, (cost, error, p) in enumerate(best, start=1):
        name = p.setting.label(default_setting(p.setting.case, p.setting.spacing))
        names.append(f"{k}: d {p.setting.spacing:g}, {name}")
        axes.annotate(str(k), (cost, error), textcoords="offset points", xytext=(-9, -9), fontsize=8, weight="bold")
    axes.text(1.02, 0.0, "\n".join(names), transform=axes.transAxes, fontsize=7, va="bottom", ha="left")
    axes.set_xlabel("CPU seconds per simulated second")
    axes.set_ylabel(words(group.metric), fontsize=8)
    axes.set_title(f"{group.case}: error over cost (ring: default; bars: chance)", fontsize=10)
    axes.grid(True, which="both")
    axes.margins(x=0.15, y=0.12)
    axes.legend(fontsize=7, bbox_to_anchor=(1.01, 1), loc="upper left")
    save(figure, file, dpi=90)
