"""Pictures in the paper's style at its times, and the lee behind the obstacle, from the runs with the first seed; curves and
diagrams of the report.
"""

import subprocess

import numpy as np
from PIL import Image

from wade.paths import module_command
from wade.pictures.run_files import read_water
from wade.reports.files import write_whole
from wade.reports.plots import error_bars, pyplot, save, shrink as smaller
from wade.suites.paper import plan
from wade.suites.paper.bands import LEE_AT_S
from wade.suites.paper.verdict import DRY, path_hash
from wade.sweeps.limits import contact_mass, limit_velocity, loss_velocity, middle, walking_speed

# File of the picture: (case of a set, time in s or None for the whole run, what it shows). Which scenarios the paper's
# figure 6 shows is not known to us; it is one of S1 to S12 at some time.
FIGURES = {
    "figure2_switch_29s": ("tau_switch", 29, "Figure 2: frame 870 (29 s), tau becomes 0"),
    "figure6_s8": ("S8", 45, "Figure 6: S8, carried, 45 s"),
    "figure7_two_groups_60s": ("two_groups", 60, "Figure 7: two groups, 60 s"),
    "figure8_obstacle_30s": ("obstacle", 30, "Figure 8: the lee at 30 s"),
}
PICTURE_WIDTH = 1100
DRY_M = 0.05  # on average less water than this is the front's spray
LEE_PIECE_M, LEE_SHARE = 2, 0.25  # pieces of 2 m, as one particle fills a cell to 0.4 m


def case_of(scene_set, name):
    if name in plan.SCENARIOS:
        return plan.scenario_case(scene_set, name)
    return plan.other_case(scene_set, name) if plan.has_scene(scene_set, name) else None


def first_run(results, case):
    """The run with the first seed if it still holds what pictures need."""
    result = results.get(case.key) if case is not None else None
    runs = [run for run in result.runs if run.folder and has_paths(run.folder)] if result else []
    return runs[0] if runs else None


def has_paths(folder):
    return (folder / "trajectories.sqlite").exists()


def note_what_is_seen(run):
    """Adds the path hash and the lee to the record of a run, as its paths and its water are too large to keep."""
    if run.scenario in DRY and has_paths(run.folder):
        run.outcome["path_hash"] = path_hash(run.folder)
    length = lee_length(run) if run.scene["obstacles"] and (run.folder / "water.bin").exists() else None
    if length is not None:
        run.outcome["lee"] = [length, *longest_lee(run)]


def lee_of(result):
    """(length of the lee at 15 s, m; greatest length, m; when, s) of the first run that had its water kept, or None."""
    lees = [run.outcome["lee"] for run in result.runs if run.outcome.get("lee")] if result else []
    return lees[0] if lees else None


def draw(run, file, time, pair):
    at = [] if time is None else ["--time", str(time)]
    command = [*module_command("wade.pictures.figure"), run.folder, "--output", file, *at]
    return pair.start(command, stdout=subprocess.DEVNULL).wait() == 0


def shrink(file):
    """Fewer pixels and colours, so that a report with its pictures stays small."""
    picture = Image.open(file).convert("RGB")
    high = round(picture.height * PICTURE_WIDTH / picture.width)
    picture = picture.resize((PICTURE_WIDTH, high), Image.LANCZOS)
    write_whole(file, smaller(picture, 128))


def draw_figures(results, sets, out, pair):
    """Draws each picture from the first set that has its run; returns [(set, file's name, words)].

    Where that run is kept without its paths, a picture that is there stays, and its words say so; without one the file's
    name is None.
    """
    drawn = []
    for stem, (name, time, words) in FIGURES.items():
        file = out / "figures" / f"{stem}.png"
        for scene_set in sets:
            case = case_of(scene_set, name)
            run = first_run(results, case)
            if run is not None:
                file.parent.mkdir(exist_ok=True)
                if draw(run, file, time, pair):
                    shrink(file)
                    drawn.append((scene_set, f"figures/{file.name}", words))
                break
            if case is not None and case.key in results:
                before = file.exists()
                words += ", drawn before" if before else ""
                drawn.append((scene_set, f"figures/{file.name}" if before else None, words))
                break
    return drawn


def lee_length(run, time=LEE_AT_S):
    """Returns the length of the lee (wake) behind the first obstacle, m; None without water or obstacle.

    The lee is made of 2 m pieces of the river downstream of the obstacle. A piece counts if its mean depth, over the
    middle half of the obstacle's width, is less than a quarter of that beside the obstacle.
    """
    water = read_water(run.folder / "water.bin", time)
    if water is None or not run.scene["obstacles"]:
        return None
    _, x0, z0, cell, depth = water
    box = run.scene["obstacles"][0]
    middle, half = (box["z_min_m"] + box["z_max_m"]) / 2, (box["z_max_m"] - box["z_min_m"]) / 2
    away = np.abs(z0 + (np.arange(depth.shape[0]) + 0.5) * cell - middle)
    inside, outside = away < half / 2, (away > half + cell) & (away < half + 4)
    window, end = max(1, round(LEE_PIECE_M / cell)), int((box["x_min_m"] - x0) / cell)
    length = 0.0
    for last in range(end, window - 1, -window):
        behind, beside = (depth[part, last - window : last].mean() for part in (inside, outside))
        if beside > DRY_M and behind < LEE_SHARE * beside:
            length += window * cell
    return length


def longest_lee(run):
    """(length, m; time, s) of the longest lee in the first two minutes."""
    times = range(LEE_AT_S, 121, 5)  # the water is kept every 5 s
    lengths = [(lee_length(run, time) or 0.0, -time) for time in times]
    length, time = max(lengths)
    return length, -time


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


def percent_in_words(interval, people):
    """Mean and interval in per cent, on two lines; the mean alone where there is no interval."""
    mean, low, high = (None if value is None else f"{100 * value / people:.0f}" for value in interval)
    return mean if low is None else f"{mean}\n({low}\u2013{high})"


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
        bright = shares[i, j] > 0.55
        axes.text(j, i, percent_in_words(result.arrived, result.agents), ha="center", va="center", fontsize=7, zorder=5,
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
    with_intervals = any(result.arrived[1] is not None for result in results.values())
    numbers = "numbers: %, with 95 % interval" if with_intervals else "numbers: %"
    figure.colorbar(image, label=f"share that arrives within 400 s ({numbers})")
    save(figure, file)
