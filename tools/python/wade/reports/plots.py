"""One style for all plots. Colours of Okabe and Ito (2008), which the colour-blind can tell apart; each with a mark."""

import io

import matplotlib

matplotlib.use("Agg")
import numpy as np  # noqa: E402
from matplotlib import pyplot  # noqa: E402
from PIL import Image  # noqa: E402

from wade.reports.files import write_whole  # noqa: E402

INK = "#2a2a2e"
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#7f7f7f", "#8c564b", "#332288")
MARKS = "osD^vPX*<>"
PALETTE = 64  # colours of a picture
pyplot.rcParams.update({"font.size": 9, "axes.edgecolor": INK, "axes.labelcolor": INK, "axes.grid": True,
                        "grid.color": "#e4e4e8", "axes.axisbelow": True, "legend.frameon": False})


def panels(count, size=(4.9, 3.9), labels=()):
    """A figure with panels side by side, and these; labels: (x, y) of each."""
    figure, axes = pyplot.subplots(1, count, figsize=(size[0] * count, size[1]), squeeze=False)
    for panel, (x, y) in zip(axes[0], labels):
        panel.set(xlabel=x, ylabel=y)
    return figure, axes[0]


def shrink(picture, colours=PALETTE):
    """PNG of a picture with few colours. An octree keeps the colours of small marks, which a median cut gives up."""
    few = picture.convert("RGB").quantize(colours, method=Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE)
    small = io.BytesIO()
    few.save(small, format="png", optimize=True)
    return small.getvalue()


def save(figure, file, dpi=100):
    """Without date or version, so that the same numbers give the same bytes."""
    raw = io.BytesIO()
    figure.savefig(raw, dpi=dpi, format="png", metadata={"Software": None}, bbox_inches="tight")
    pyplot.close(figure)
    write_whole(file, shrink(Image.open(raw)))


def error_bars(axes, xs, intervals, label, index, line="-"):
    """Points with their intervals (mean, low, high); what is None is left out."""
    known = [(x, interval) for x, interval in zip(xs, intervals) if interval is not None]
    if not known:
        return
    means = np.array([interval[0] for _, interval in known])
    ends = np.array([[interval[0] if end is None else end for end in interval[1:]] for _, interval in known])
    axes.errorbar([x for x, _ in known], means, yerr=np.clip([means - ends[:, 0], ends[:, 1] - means], 0, None),
                  label=label, color=COLOURS[index % len(COLOURS)], marker=MARKS[index % len(MARKS)], markersize=4.5,
                  linewidth=1.2, capsize=2.5, linestyle=line)
