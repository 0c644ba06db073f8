"""Where and when people are lost: counts by square and by minute over the runs of an ensemble, and a map.

The position and the time of a loss are those of agents.csv: where a person drowned, or left the map.
"""

import numpy as np

from wade.reports.tables import count_of
from wade.scenes import resolved_scene
from wade.statistics.ensemble import SQUARE_M, SWEPT_AWAY

MOST_ROWS = 12  # of each table
STEPS_MIN = (1, 2, 5, 10, 15, 30, 60, 120, 240, 480, 1440)  # lengths of the intervals of time, minutes


def lost_people(case):
    """(x, z, time, run, swept away) of all lost people, arrays."""
    people = case.people
    lost = people["dead"]
    return (people["x_m"][lost], people["z_m"][lost], people["time_s"][lost], people["run"][lost],
            people["fate"][lost] == SWEPT_AWAY)


def by_square(case):
    """[(x, z of the lower corner, m; lost in it a run; share of all lost; runs with any)], the most lost first."""
    x, z, _, run, _ = lost_people(case)
    rows = []
    corners = np.stack([x // SQUARE_M * SQUARE_M, z // SQUARE_M * SQUARE_M], axis=1)
    for corner in np.unique(corners, axis=0):
        here = (corners == corner).all(axis=1)
        rows.append((float(corner[0]), float(corner[1]), here.sum() / len(case.runs), here.mean(), len(set(run[here].tolist()))))
    return sorted(rows, key=lambda row: (-row[2], row[0], row[1]))


def by_minute(case):
    """[(from, to, min; lost in it a run; share of all lost; share so far)] of intervals of one length that begin at 0."""
    time = lost_people(case)[2] / 60
    if len(time) == 0:
        return []
    step = next((step for step in STEPS_MIN if time.max() < MOST_ROWS * step), STEPS_MIN[-1])
    rows, so_far = [], 0.0
    for k in range(int(time.min() // step), int(time.max() // step) + 1):
        here = (time >= k * step) & (time < (k + 1) * step)
        so_far += here.mean()
        rows.append((k * step, (k + 1) * step, here.sum() / len(case.runs), here.mean(), so_far))
    return rows


def draw(case, file):
    """A map of the losses: squares by the number lost a run, and each loss as a cross, those swept away as a ring."""
    import matplotlib.pyplot as plt

    from wade.pictures import top_view
    from wade.pictures.run_files import save_picture
    from wade.pictures.texts import draw_title

    scene = resolved_scene(case.manifest())
    x, z, _, _, swept = lost_people(case)
    length, width = scene["world"]["length_m"], scene["world"]["width_m"]
    lines = [np.arange(0, size + SQUARE_M, SQUARE_M) for size in (length, width)]
    counts = np.histogram2d(np.clip(z, 0, width), np.clip(x, 0, length), lines[::-1])[0] / len(case.runs)
    figure, axes = top_view.new_map(scene, right=0.85, above=0.75, below=0.55)
    mesh = axes.pcolormesh(*lines, np.ma.masked_equal(counts, 0), cmap="YlOrRd", vmin=0,
                           vmax=top_view.rounded_up(counts.max()), zorder=3, alpha=0.8, rasterized=True)
    top_view.draw_obstacles(axes, scene)
    top_view.draw_goals(axes, scene)
    for chosen, marker in ((~swept, "x"), (swept, "o")):
        axes.plot(np.clip(x[chosen], 0, length), np.clip(z[chosen], 0, width), marker, color="#16161a", markersize=3, fillstyle="none",
                  markeredgewidth=0.6, alpha=0.6, zorder=9, clip_on=False)
    top_view.draw_depth_bar(figure, axes, mesh, f"lost a run in a square of {SQUARE_M} m")
    draw_title(figure, "Where people are lost", f"{case.name}: {len(x)} people of {count_of(len(case.runs))}; "
               f"crosses: drowned, rings: swept away")
    save_picture(figure, file)
    plt.close(figure)
