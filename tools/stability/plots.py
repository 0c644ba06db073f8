"""Plots of the report."""

import io

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

import results
import settings
from run_folder import write_whole

COLOURS = {"pass": "#2a7f3f", "known": "#d9a400", "fail": "#c0392b", None: "#dddddd"}
LABELS = {
    "pass": "all rules hold",
    "known": "known failure",
    "fail": "fails",
    None: "not run",
}


def save(figure, file):
    data = io.BytesIO()
    figure.savefig(data, format="png", dpi=90)
    plt.close(figure)
    write_whole(file, data.getvalue())


def draw_map(cases, found, file):
    """Cases against settings, the verdict as colour."""
    names = [name for name in settings.SETTINGS if any(key[1] == name for key in found)]
    figure, axes = plt.subplots(figsize=(2.8 + 0.75 * len(names), 1.6 + 0.26 * len(cases)), layout="constrained")
    used = set()
    for row, case in enumerate(cases):
        for column, name in enumerate(names):
            run = found.get((case.name, name))
            verdict = run["verdict"] if run else None
            used.add(verdict)
            axes.add_patch(plt.Rectangle((column, row), 0.94, 0.9, color=COLOURS[verdict]))
    axes.set_xlim(0, len(names))
    axes.set_ylim(len(cases), 0)
    axes.set_xticks([k + 0.47 for k in range(len(names))], names, rotation=35, ha="right", fontsize=8)
    axes.set_yticks([k + 0.45 for k in range(len(cases))], [case.name for case in cases], fontsize=8)
    axes.tick_params(length=0)
    for spine in axes.spines.values():
        spine.set_visible(False)
    handles = [plt.Rectangle((0, 0), 1, 1, color=COLOURS[v], label=LABELS[v]) for v in COLOURS if v in used]
    axes.legend(handles=handles, loc="lower left", bbox_to_anchor=(0, 1.0), fontsize=8, frameon=False)
    save(figure, file)


def draw_sweep(found, sweep, label, file):
    """Compression and energy over the swept value; crosses where a rule is broken."""
    figure, panels = plt.subplots(1, 2, figsize=(8.2, 3.2), layout="constrained")
    for case in settings.SWEPT_CASES:
        values = [v for v in settings.SWEEPS[sweep][1] if (case, settings.sweep_name(sweep, v)) in found]
        runs = [found[case, settings.sweep_name(sweep, value)] for value in values]
        x = [float(value) for value in values]
        for axes, key, factor in ((panels[0], "mean_density_error", 100), (panels[1], "energy_ratio", 1)):
            y = [factor * float(run[key]) for run in runs]
            (line,) = axes.plot(x, y, "-", label=case, linewidth=1)
            for k, run in enumerate(runs):
                axes.plot(x[k], y[k], "o" if results.is_stable(run) else "x", color=line.get_color(), markersize=5)
    panels[0].set_yscale("log")
    panels[0].axhline(1, color="grey", linestyle=":")
    panels[0].set_ylabel("largest mean compression, %")
    panels[1].axhline(1.05, color="grey", linestyle=":")
    panels[1].set_ylabel("energy over energy put in")
    for axes in panels:
        axes.set_xlabel(label)
        if sweep == "tolerance":
            axes.set_xscale("log")
    panels[0].legend(fontsize=8, frameon=False)
    save(figure, file)
