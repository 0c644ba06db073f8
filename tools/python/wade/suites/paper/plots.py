"""Curves and diagrams of the report on the paper."""

import numpy as np

from wade.reports.plots import error_bars, pyplot, save
from wade.sweeps.limits import contact_mass, limit_velocity, loss_velocity, middle, walking_speed


def table1_plot(file, paper, results, names):
    """Times and arrivals of S1 to S12 beside the paper. results: {set: {scenario: Result}}, names: {set: its name}."""
    figure, (above, below) = pyplot.subplots(2, 1, figsize=(9, 6), sharex=True)
    scenarios = list(paper)
    places = np.arange(len(scenarios))
    for axes, column in ((above, "time_s"), (below, "arrived")):
        known = [(i, float(paper[name][column])) for i, name in enumerate(scenarios) if paper[name][column] != ""]
        bar = {"linestyle": "none", "marker": "_", "markersize": 24, "markeredgewidth": 2.2, "color": "black"}
        axes.plot(*zip(*known), label="paper", **bar)
    for index, (scene_set, of_set) in enumerate(results.items()):
        at = [place + 0.16 * (index - (len(results) - 1) / 2) for place in places]
        for axes, what in ((above, "time"), (below, "arrived")):
            values = [getattr(of_set[name], what) if name in of_set else None for name in scenarios]
            error_bars(axes, at, values, names[scene_set], index, line="none")
    above.set_ylabel("last arrival, s")
    below.set_ylabel("arrived, of 50")
    below.set_ylim(-2, 53)
    words = [f"{name}\n\u03c4 {float(row['tau']):g}\n{row['v_f_m_s']} m/s" for name, row in paper.items()]
    below.set_xticks(places, words)
    figure.legend(*above.get_legend_handles_labels(), loc="upper center", bbox_to_anchor=(0.5, 0.95), ncol=6)
    save(figure, file)


def phase_plot(file, results, scenarios, scene):
    """Share that arrives over tau and v_F. results: {(tau, v_F): Result}; scenarios: {name: (tau, v_F)}."""
    figure, axes = pyplot.subplots(figsize=(7.6, 5.6))
    taus = sorted({tau for tau, _ in results})
    velocities = sorted({velocity for _, velocity in results})
    shares = np.full((len(taus), len(velocities)), np.nan)
    for (tau, velocity), result in results.items():
        shares[taus.index(tau), velocities.index(velocity)] = result.arrived[0] / result.agents
    image = axes.imshow(shares, origin="lower", cmap="cividis", vmin=0, vmax=1, aspect="auto")
    for (tau, velocity), result in results.items():
        i, j = taus.index(tau), velocities.index(velocity)
        mean, low, high = (100 * value / result.agents for value in result.arrived)
        bright = shares[i, j] > 0.55
        axes.text(j, i, f"{mean:.0f}\n({low:.0f}\u2013{high:.0f})", ha="center", va="center", fontsize=7, zorder=5,
                  color="black" if bright else "white")
    mass = middle(scene["crowd"]["groups"][0]["mass_kg"])
    fine = np.linspace(taus[0], taus[-1], 400)
    held = [limit_velocity(mass, walking_speed(scene), tau, contact_mass(scene)) for tau in fine]
    lost = [loss_velocity(scene, tau) for tau in fine]
    heights = np.interp(fine, taus, np.arange(len(taus)))
    for speeds, style, words in (
        (held, "-", "holds against the stream: v_F = v_B m_a / (\u03c4 m_c)"),
        (lost, "--", "heading straight across, drifts as far as the fall"),
    ):
        places = np.interp(speeds, velocities, np.arange(len(velocities)), left=np.nan, right=np.nan)
        axes.plot(places, heights, color="#e8825a", linestyle=style, linewidth=2, alpha=0.8, label=words)
    for name, (tau, velocity) in scenarios.items():
        if tau in taus and velocity in velocities:
            axes.text(velocities.index(velocity) + 0.47, taus.index(tau) + 0.45, name, ha="right", va="top", fontsize=7,
                      color="#d55e00", fontweight="bold")
    axes.set_xticks(range(len(velocities)), [f"{v:g}" for v in velocities])
    axes.set_yticks(range(len(taus)), [f"{t:g}" for t in taus])
    axes.grid(False)
    axes.set_xlabel("v_F, m/s")
    axes.set_ylabel("endurance \u03c4")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, 1.14))
    figure.colorbar(image, label="share that arrives within 400 s (numbers: %, with 95 % interval)")
    save(figure, file)
