"""The goals of speed beside what was measured, and what the water would reach if its solves ran at the bound of the processor.

The goals were set for two cores of 2.5 GHz before anything was built.
"""

from wade.reports.tables import count

# Name, size, threads, goal, whether it is a least ("at least") or a most.
GOALS = (
    ("fluid/dam_break", 8_000, 1, 1.5e6, "at least"),
    ("fluid/dam_break", 8_000, 2, 3e6, "at least"),
    ("fluid/river", 21_600, 2, 4e6, "at least"),
    ("fluid/river", 100_000, 2, 3e6, "at least"),
    ("fluid/river", 1_000_000, 2, 2e6, "at least"),
    ("kernels/list_build", 100_000, 1, 100, "at most"),
    ("kernels/pressure_sweep", 100_000, 1, 45, "at most"),
    ("crowd/open_plane", 1_000, 1, 4e6, "at least"),
    ("crowd/open_plane", 100_000, 1, 4e6, "at least"),
    ("crowd/open_plane bodies fast", 1_000, 1, 2.5e6, "at least"),
    ("crowd/open_plane bodies human", 1_000, 1, 2.5e6, "at least"),
    ("shallow_water/river", 10_800, 1, 30e6, "at least"),
    ("end_to_end/s05", None, 2, 5, "at least"),
    ("end_to_end/fine", None, 2, 0.4, "at least"),
)
STAGE = "_ns_per_particle_step"
SOLVES = ("divergence_solve", "density_solve")
OTHER_SWEEPS = 2  # of a step beside those of the solves: kernel and viscosity


def one_of(results, name, size, threads):
    """The result of this name, size and number of threads, or None; any size where size is None."""
    for r in results:
        if (r["name"], r["threads"]) == (name, threads) and size in (None, r["size"]):
            return r
    return None


def with_solves_at_bound(results, r, operations_of_a_pair):
    """Particle-steps/s of a river if its solves took what their lanes cost in multiply-adds and no more, or None."""
    sweep, peak = one_of(results, "kernels/rate_sweep", r["size"], 1), one_of(results, "machine/fma_peak", None, r["threads"])
    if sweep is None or peak is None or not r["name"].startswith("fluid/") or "sweeps_per_step" not in r:
        return None
    lanes = r["pairs_per_particle"] / (sweep["lanes_in_use_percent"] / 100)
    at_bound = (r["sweeps_per_step"] - OTHER_SWEEPS) * lanes * operations_of_a_pair / (peak["median"] / 2)
    stages = {name[: -len(STAGE)]: value for name, value in r.items() if name.endswith(STAGE)}
    return 1e9 / (sum(stages.values()) - sum(stages[name] for name in SOLVES) + at_bound)


def rows_of(results, operations_of_a_pair):
    rows = []
    for name, size, threads, goal, side in GOALS:
        r = one_of(results, name, size, threads)
        if r is None:
            continue
        best = r["max"] if side == "at least" else r["min"]
        reached = [value >= goal if side == "at least" else value <= goal for value in (r["median"], best)]
        words = "yes" if reached[0] else "in the best round" if reached[1] else f"no, {r['median'] / goal:.2f} of it"
        bound = with_solves_at_bound(results, r, operations_of_a_pair)
        rows.append((name, count(r["size"]), threads, f"{side} {count(goal)}", count(r["median"]), count(best), r["unit"], words,
                     count(bound) if bound else ""))  # fmt: skip
    return rows
