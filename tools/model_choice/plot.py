"""Estimated against actual error."""

from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

MARKS = {"0.05": "o", "0.1": "s", "0.3": "^"}


def write(rows, file):
    """A point a scene and demand; below the diagonal the estimate was too low."""
    taken = [r for r in rows if not r.get("refused")]
    figure, axes = plt.subplots(figsize=(6.4, 5.6))
    models = sorted({r["chosen"].split(",")[0] for r in taken})
    colours = {model: f"C{k}" for k, model in enumerate(models)}
    seen = set()
    for r in taken:
        model = r["chosen"].split(",")[0]
        label = f"{model}, demand {r['demand']}"
        axes.loglog(
            float(r["actual_median"]), float(r["estimated_median"]), MARKS.get(r["demand"], "o"), color=colours[model],
            markerfacecolor="none" if r["held"] == "yes" else colours[model], markersize=8,
            label=None if label in seen else label,
        )
        seen.add(label)
    limits = (2e-3, 1.0)
    axes.plot(limits, limits, color="0.5", linewidth=1)
    for demand in MARKS:
        axes.axvline(float(demand), color="0.8", linewidth=0.8, linestyle=":")
    axes.set(xlim=limits, ylim=limits, xlabel="actual median error of the impulse", ylabel="estimated median error")
    axes.set_title("Choice of the model: filled marks did not hold", fontsize=10)
    axes.legend(fontsize=7)
    figure.tight_layout()
    part = Path(str(file) + ".part.png")
    figure.savefig(part, dpi=110)
    plt.close(figure)
    part.replace(file)
