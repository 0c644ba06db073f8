"""Curves of an ensemble: when people arrive, lose their feet and die, with bands over runs, and the FN curve."""

import numpy as np

from wade.reports.plots import COLOURS, error_bars, panels, save
from wade.reports.tables import count_of
from wade.statistics.times import fn_curve

MOST_POINTS = 2000  # of a drawn curve


def draw_curve(axes, curve, end, label, index):
    """A step curve up to the time `end`, s, with its band."""
    step = max(1, len(curve.times) // MOST_POINTS)
    chosen = np.unique(np.append(np.arange(0, len(curve.times), step), len(curve.times) - 1))
    times = np.append(curve.times[chosen], max(end, curve.times[-1]))

    def held(values):
        return np.append(values[chosen], values[-1]) * 100

    axes.step(times, held(curve.share), where="post", color=COLOURS[index], label=label, linewidth=1.4)
    if curve.low is not None:
        axes.fill_between(times, held(curve.low), held(curve.high), step="post", color=COLOURS[index], alpha=0.18, linewidth=0)


def draw_curves(case, curves, file):
    """Draws curves.png: cumulative incidences, the share still on their feet, FN curve; each with n."""
    end = max(run.outcome["sim_time_s"] for run in case.runs)
    with_feet = len(curves) > 2
    figure, axes = panels(3 if with_feet else 2, (4.6, 3.7))
    for index, (name, curve) in enumerate(curves.items()):
        draw_curve(axes[0 if index < 2 else 1], curve, end, name, (0, 1, 1, 0, 2)[index])
    axes[0].set(title="How it ends: share by time", xlabel="time, s", ylabel="of all people, %", ylim=(-2, 102))
    axes[0].legend()
    if with_feet:
        axes[1].set(title="On their feet (Aalen-Johansen, Kaplan-Meier)", xlabel="time, s", ylim=(-2, 102))
        axes[1].legend(fontsize=7.5)
    draw_fn(axes[-1], case)
    figure.subplots_adjust(wspace=0.28)
    band = "no bands: fewer than 10 runs" if curves["died"].low is None else "band: 95 %, runs resampled"
    words = f"{case.name}: {count_of(len(case.runs))}, {len(case.people['run'])} people; {band}"
    figure.text(0.5, -0.03, words, ha="center", fontsize=8)
    save(figure, file)


def draw_fn(axes, case):
    """Share of runs with N dead or more over N, with exact intervals."""
    rows = np.array(fn_curve(case.counts(case.people["dead"])))
    axes.errorbar(rows[:, 0], 100 * rows[:, 1], yerr=100 * np.abs(rows[:, 2:].T - rows[:, 1]), color=COLOURS[1], marker="o",
                  markersize=3.5, linewidth=1, capsize=2)
    axes.set(title="FN: runs with N dead or more", xlabel="N", ylabel="of all runs, %", ylim=(-2, 102))
    axes.set_xlim(0, max(2, 1.05 * rows[-1, 0]))
    axes.xaxis.get_major_locator().set_params(integer=True)


def draw_values(cases, keys, file):
    """values.png: the shares safe, lost and without an end yet over the values that tell cases apart."""
    from wade.statistics.ensemble import LOST, NO_END, having
    from wade.statistics.shares import share_of
    from wade.statistics.table import SAFE, bounds_of, label_of

    labels = [label_of(case, keys) for case in cases]
    numbers = len(keys) == 1 and all(isinstance(case.settings.get(keys[0]), (int, float)) for case in cases)
    xs = [case.settings[keys[0]] for case in cases] if numbers else range(len(cases))
    order = np.argsort(xs, kind="stable")
    figure, (axes,) = panels(1, (6.4, 4.2))
    for index, fate in enumerate((SAFE, LOST, NO_END)):
        intervals = []
        for case in cases:
            chosen = case.people["safe"] if fate == SAFE else having(case.people, fate)
            ends = bounds_of(share_of(case.counts(chosen).tolist(), np.bincount(case.people["run"]).tolist()))
            intervals.append([None if end is None else 100 * end for end in ends])
        error_bars(axes, [xs[k] for k in order], [intervals[k] for k in order], fate, (2, 1, 7)[index], "-" if numbers else "none")
    if not numbers:
        axes.set_xticks(list(xs), labels, rotation=30, ha="right")
    axes.set(xlabel=", ".join(key.removeprefix("/") for key in keys), ylabel="of all people, %", ylim=(-2, 102))
    axes.legend()
    few, many = (edge(len(case.runs) for case in cases) for edge in (min, max))
    axes.set_title(f"{cases[0].scene}: {'' if few == many else f'{few} to '}{count_of(many)} each; bars: 95 % over runs",
                   fontsize=9)
    save(figure, file)
