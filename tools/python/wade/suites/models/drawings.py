"""The picture of the report: error over cost."""

import math

from matplotlib.lines import Line2D
from matplotlib.ticker import NullFormatter

from wade.reports.plots import COLOURS, INK, pyplot, save
from wade.suites.models.outcomes import COMPLETED, missed, worst

# One colour a model in all pictures, by its index here; a model of another name comes after them.
ORDER = ("dfsph", "shallow_water", "steering", "kinematic", "mixed")
MARKS = {"coarse": "o", "medium": "s", "fine": "D"}
ACROSS = 4
COST = "CPU s a simulated s"
LEAST_RATIO, MOST_RATIO = 1e-3, 30  # beyond, a point is drawn at the edge; the table has the number
IMPULSE_ERRORS = {"impulse_median": "impulse, median error", "impulse_p95": "impulse, 95 % of people"}


def colour(model, models):
    places = ordered(models)
    return COLOURS[places.index(model) % len(COLOURS)]


def ordered(models):
    return [*ORDER, *(model for model in models if model not in ORDER)]


def model_words(model):
    return {"dfsph": "DFSPH"}.get(model, model.replace("_", " "))


def compared_cases(outcomes, limits):
    """Returns the cases with an error to compare from at least two models, in their order."""
    by_case = {}
    for o in outcomes:
        if o.status == COMPLETED and o.cost is not None and worst(o, limits) is not None:
            by_case.setdefault(o.case, set()).add(o.model)
    return [case for case, models in by_case.items() if len(models) > 1]


def draw_points(axes, points, model, models):
    """points: [(cost, error, level, whether all limits are kept)], coarse to fine."""
    points = [(max(cost, 1e-6), error, level, kept) for cost, error, level, kept in points]
    shade = colour(model, models)
    axes.plot([p[0] for p in points], [p[1] for p in points], color=shade, linewidth=1)
    for cost, error, level, kept in points:
        axes.plot(cost, error, MARKS[level], color=shade, markersize=6, markerfacecolor=shade if kept else "white",
                  markeredgewidth=1.4)


def grid_of(count):
    across = min(ACROSS, count)
    down = math.ceil(count / across)
    size = 2.6 * across + 0.4, 2.3 * down + 0.3
    figure, axes = pyplot.subplots(down, across, figsize=size, squeeze=False, sharex=True, sharey=True)
    for panel in list(axes.flat)[count:]:
        panel.set_axis_off()
    for column in range(across):  # the lowest panel of each column has the numbers of the axis
        lowest = axes[(count - 1 - column) // across][column]
        lowest.tick_params(labelbottom=True)
        lowest.set_xlabel(COST, fontsize=8)
    return figure, axes


def prepare(panel, title):
    panel.set_xscale("log")
    panel.set_yscale("log")
    panel.yaxis.set_minor_formatter(NullFormatter())
    panel.set_title(title, fontsize=9)
    panel.tick_params(labelsize=7)
    panel.margins(0.1)


def legend(figure, models, levels, signs=()):
    """Models above, what the marks mean below them. signs: further handles."""
    handles = [Line2D([], [], color=colour(m, models), linewidth=3, label=model_words(m)) for m in models]
    marks = [Line2D([], [], color=INK, marker=MARKS[level], linestyle="none", label=level) for level in levels]
    for height, row in ((1.035, handles), (1.0, marks + list(signs))):
        figure.legend(handles=row, loc="lower center", bbox_to_anchor=(0.5, height), ncol=len(row), fontsize=8)


def levels_of(outcomes):
    return [level for level in MARKS if any(o.level == level and o.status == COMPLETED for o in outcomes)]


def error_over_cost(file, outcomes, models, limits):
    """A panel a case: the worst error over its limit against the cost. False if there is nothing to compare."""
    cases = compared_cases(outcomes, limits)
    if not cases:
        return False
    figure, axes = grid_of(len(cases))
    for panel, case in zip(axes.flat, cases):
        for model in models:
            points = []
            for o in outcomes:
                its = worst(o, limits) if (o.case, o.model) == (case, model) else None
                if its is not None and o.cost is not None:
                    ratio = min(max(its.ratio, LEAST_RATIO), MOST_RATIO)
                    points.append((o.cost, ratio, o.level, not missed(o, limits)))
            if points:
                draw_points(panel, points, model, models)
        panel.axhline(1, color=INK, linestyle="--", linewidth=1)
        prepare(panel, case)
    for row in axes:
        row[0].set_ylabel("worst error / limit", fontsize=8)
    figure.tight_layout()
    signs = [Line2D([], [], color=INK, linestyle="--", linewidth=1, label="limit"),
             Line2D([], [], linestyle="none", label="filled: all limits kept, open: one missed")]
    legend(figure, models, levels_of(outcomes), signs)
    save(figure, file)
    return True


WORDS = (
    "A panel a case that at least two models can run. Up: of all errors that have a limit, the one that is largest "
    "against its limit, over that limit (below 0.001 drawn at 0.001, above 30 or not measured at 30); the dashed line "
    "is the limit. Left is cheap, below is exact.")
