"""Curves of an ensemble: when people arrive, lose their feet and die, with bands over runs, and the FN curve."""

import numpy as np

from wade.reports.plots import COLOURS, panels, save
from wade.statistics.ensemble import has_feet
from wade.statistics.times import Lives, fn_curve, incidences, staying

MOST_POINTS = 2000  # of a drawn curve


def lives_until(case, cause):
    """Lives that end with arrival (cause 1), death (2), and with `cause` "feet" also where feet are lost (3)."""
    people = case.people
    time, kind = people["time_s"].copy(), np.where(people["outcome"] == "arrived", 1, np.where(people["dead"], 2, 0))
    if cause == "feet":
        lost = ~np.isnan(people["off_feet_s"])
        time, kind = np.where(lost, people["off_feet_s"], time), np.where(lost, 3, kind)
    return Lives(people["run"], time, kind)


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


def draw_curves(case, file):
    """curves.png: cumulative incidences, who is still on the feet, FN curve; each with n."""
    end = max(run.outcome["sim_time_s"] for run in case.runs)
    with_feet = has_feet(case)
    figure, axes = panels(3 if with_feet else 2, (4.6, 3.7))
    ends = incidences(lives_until(case, "end"), (1, 2))
    for index, (cause, words) in enumerate(((1, "arrived"), (2, "died"))):
        draw_curve(axes[0], ends[cause], end, words, index)
    axes[0].set(title="How it ends: share by time", xlabel="time, s", ylabel="of all people, %", ylim=(-2, 102))
    axes[0].legend()
    if with_feet:
        lives = lives_until(case, "feet")
        first = incidences(lives, (1, 3))
        draw_curve(axes[1], first[3], end, "lost their feet", 1)
        draw_curve(axes[1], first[1], end, "arrived without", 0)
        feet = Lives(lives.run, lives.time, np.where(lives.cause >= 2, 1, 0))
        draw_curve(axes[1], staying(feet), end, "on their feet, of who is under way", 2)
        axes[1].set(title="On their feet (Aalen-Johansen, Kaplan-Meier)", xlabel="time, s", ylim=(-2, 102))
        axes[1].legend(fontsize=7.5)
    draw_fn(axes[-1], case)
    figure.subplots_adjust(wspace=0.28)
    band = "band: 95 %, runs resampled" if ends[1].low is not None else "no bands: fewer than 10 runs"
    figure.text(0.5, -0.03, f"{case.name}: {len(case.runs)} runs, {len(case.people['run'])} people; {band}", ha="center", fontsize=8)
    save(figure, file)


def draw_fn(axes, case):
    """Share of runs with N dead or more over N, with exact intervals."""
    rows = np.array(fn_curve(case.counts(case.people["dead"])))
    axes.errorbar(rows[:, 0], 100 * rows[:, 1], yerr=100 * np.abs(rows[:, 2:].T - rows[:, 1]), color=COLOURS[1], marker="o",
                  markersize=3.5, linewidth=1, capsize=2)
    axes.set(title="FN: runs with N dead or more", xlabel="N", ylabel="of all runs, %", ylim=(-2, 102))
    axes.xaxis.get_major_locator().set_params(integer=True)
