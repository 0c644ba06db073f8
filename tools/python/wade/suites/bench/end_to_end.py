"""Whole runs: both programs on a scene of the paper, or on a town made for it, as tools/run.sh starts them."""

import json
import math
import os
import random
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from statistics import median

from wade import plain_file, progress
from wade.paths import ROOT, module_command
from wade.reports.files import complain

# The river lies where people start, so that all of them are in it, and push it, from the first step on; about 100,000 particles.
PEOPLE_5000 = ("--set", "/crowd/response=measured", "--set", "/coupling/two_way=true",
               "--set", "/channel/z_min_m=0", "--set", "/channel/z_max_m=51",
               "--set", "/fluid/particle_spacing_m=0.37", "--set", "/fluid/max_particles=125000")
# Name, scene, end of the run in simulated s (None: the scene's), rounds, options; --quick runs those of QUICK only.
RUNS = (
    ("end_to_end/s05", "configs/paper/s05.json", None, 3, ()),
    ("end_to_end/s05_depth_1", "configs/paper/s05.json", None, 3, ("--set", "/lockstep_depth=1")),
    ("end_to_end/river_s05", "configs/river/s05.json", 60, 3, ()),
    ("end_to_end/fine", "configs/river/fine.json", 4, 3, ()),
    ("end_to_end/people_5000", "configs/river/agents_5000.json", 16, 3, PEOPLE_5000),
    ("end_to_end/town", None, 180, 1, ()),  # its scene is written when it is wanted
)
SAME_FRAMES = {"end_to_end/s05", "end_to_end/s05_depth_1"}  # how far the water is ahead changes no bit
QUICK = {"end_to_end/s05": 20}
# Speed of all threads over that of one thread while others use the processors, too: (name, number of pairs at once,
# number of busy programs beside them). Both run the river of S5 up to SHARED_UNTIL simulated seconds.
SHARED = (("end_to_end/beside_busy_programs", 1, os.cpu_count()), ("end_to_end/pairs_at_once", os.cpu_count(), 0))
SHARED_SCENE, SHARED_UNTIL, SHARED_ROUNDS = "configs/river/s05.json", 8, 5
# The town: 1,000,000 cells, 10,000 people in 840 houses below a dam that breaks.
LENGTH, WIDTH, CELL, GROUND_CELL = 2000, 2000, 2, 10  # m
DAM = 1750  # its x, m
LANES = tuple(side * (60 + 45 * lane) for lane in range(12) for side in (-1, 1))  # from the valley's middle, m
PEOPLE = 10_000


def town_middle(x):
    """z of the valley's middle, m."""
    return 1000 + 90 * math.sin(x / 260)


def town_ground(x, z):
    """Height of the ground, m: it falls by 0.5 % along the valley, with a floor 700 m wide and slopes beside it."""
    off = abs(z - town_middle(x))
    return 100 + 0.005 * x + 0.004 * min(off, 350) + 0.06 * max(0.0, off - 350) - 2.5 * math.exp(-((off / 15) ** 2))


def town_house(rng, x, lane):
    """Corners of a house beside a lane, turned with it."""
    z = town_middle(x) + lane
    turn = math.atan2(town_middle(x + 1) - town_middle(x - 1), 2) + rng.uniform(-0.15, 0.15)
    wide, deep = rng.uniform(5, 9), rng.uniform(4, 6)
    return [[round(x + a * math.cos(turn) - b * math.sin(turn), 2), round(z + a * math.sin(turn) + b * math.cos(turn), 2)]
            for a, b in ((-wide, -deep), (wide, -deep), (wide, deep), (-wide, deep))]  # fmt: skip


def town_houses():
    rng = random.Random(840)
    features = []
    for lane in LANES:
        for x in range(450, 1500, 30):
            corners = town_house(rng, x + rng.uniform(-4, 4), lane)
            features.append({"type": "Feature", "geometry": {"type": "Polygon", "coordinates": [[*corners, corners[0]]]}})
    for number, feature in enumerate(features):  # as many in each as in the others, or one more
        share = PEOPLE * (number + 1) // len(features) - PEOPLE * number // len(features)
        feature["properties"] = {"name": f"house_{number + 1:03d}", "residents": share}
    return {"type": "FeatureCollection", "features": features}


def town_scene():
    shelters = [{"name": f"hill_{k + 1}", "polygon": [[x, z], [x + 120, z], [x + 120, z + 60], [x, z + 60]]}
                for k, (x, z) in enumerate((x, z) for x in (500, 950, 1350) for z in (200, 1740))]  # fmt: skip
    return {
        "duration_s": 300,
        "frame_rate_hz": 10,
        "site": {
            "epsg": 0,
            "ground": {"file": "ground.asc"},
            "houses": [{"file": "houses.geojson"}],
            "manning": {"n": 0.035},
            "water": [{"level_m": 118, "polygon": [[DAM, 0], [LENGTH, 0], [LENGTH, WIDTH], [DAM, WIDTH]]}],
            "gates": [{"name": "dam", "line": [[DAM, 0], [DAM, WIDTH]], "opens_at_s": 30}],
            "outlets": [{"name": "down the valley", "line": [[0, 300], [0, 1700]]}],
            "shelters": shelters,
        },
        "fluid": {"model": "shallow_water", "publish": "near_agents", "shallow_water": {"cell_size_m": CELL}},
        "coupling": {"agents_stream": "parallel"},
        "crowd": {
            "response": "measured",
            "bodies": "human",
            "markers": "redrawn",
            "navigation": {"every_s": 5, "slope": "tobler", "enters_up_to_m": 0.61},
            "groups": [{
                "name": "residents",
                "start": {"from": "houses"},
                "goal": {"to": "shelters"},
                "leaves": {"rule": "weibull", "after_s": 5, "scale_s": 60, "shape": 1.5},
            }],
        },
    }  # fmt: skip


def write_town(folder):
    """Writes the town's files; returns the path of its scene."""
    columns, rows = LENGTH // GROUND_CELL, WIDTH // GROUND_CELL
    lines = [f"ncols {columns}", f"nrows {rows}", "xllcorner 0", "yllcorner 0", f"cellsize {GROUND_CELL}"]
    for row in reversed(range(rows)):
        lines.append(" ".join(f"{town_ground((c + 0.5) * GROUND_CELL, (row + 0.5) * GROUND_CELL):.2f}" for c in range(columns)))
    (folder / "ground.asc").write_text("\n".join(lines) + "\n", encoding="utf-8")
    (folder / "houses.geojson").write_text(json.dumps(town_houses()), encoding="utf-8")
    path = folder / "scene.json"
    path.write_text(json.dumps(town_scene(), indent=1), encoding="utf-8")
    return path


def one_run(scene, until, threads, options):
    """outcome.json of a run."""
    with tempfile.TemporaryDirectory(prefix="wade-bench-") as folder:
        path = ROOT / scene if scene else write_town(Path(folder))
        command = [*module_command("wade.run.pair"), path]
        command += ["--no-figure", "--out", Path(folder) / "run", "--threads", str(threads), *options]
        if until is not None:
            command += ["--until-s", str(until)]
        done = subprocess.run([str(word) for word in command], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                              text=True)
        if done.returncode != 0:
            raise RuntimeError(f"{path.name} ended with exit code {done.returncode}: {done.stderr.strip()}")
        return plain_file.read_json(Path(folder) / "run" / "outcome.json")


def result_of(name, threads, outcomes):
    rates = sorted(o["sim_time_s"] / o["wall_time_s"] for o in outcomes)
    last = outcomes[-1]
    fluid = last["fluid"]
    steps = max(1, fluid["steps"])
    return {
        "name": name, "size": fluid["particles_max"], "threads": threads, "median": rates[len(rates) // 2],
        "min": rates[0], "max": rates[-1], "unit": "sim_s_per_wall_s", "rounds": len(rates), "agents": last["agents"],
        "sim_time_s": last["sim_time_s"], "wall_time_s": last["wall_time_s"], "solver_wall_s": fluid["solver_wall_s"],
        "solver_percent_of_wall": 100 * fluid["solver_wall_s"] / last["wall_time_s"],
        "steps": steps, "particle_steps": fluid["particle_steps"],
        "solver_particle_steps_per_s": fluid["particle_steps"] / fluid["solver_wall_s"],
        "mean_density_error_percent": 100 * (fluid["mean_density_error"] or 0),
        "max_density_error_percent": 100 * (fluid["max_density_error"] or 0),
    }


@contextmanager
def busy_programs(number):
    programs = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(number)]
    try:
        yield
    finally:
        for program in programs:
            program.kill()
            program.wait()


def shared_rate(pairs, until, threads):
    """Simulated seconds a second of the slowest of some pairs at once."""
    with ThreadPoolExecutor(pairs) as pool:
        outcomes = list(pool.map(lambda _: one_run(SHARED_SCENE, until, threads, ()), range(pairs)))
    return min(o["sim_time_s"] / o["wall_time_s"] for o in outcomes)


def shared_result(name, pairs, programs):
    with busy_programs(programs):
        ratios = sorted(shared_rate(pairs, SHARED_UNTIL, os.cpu_count()) / shared_rate(pairs, SHARED_UNTIL, 1)
                        for _ in range(SHARED_ROUNDS))
    return {"name": name, "size": pairs, "threads": os.cpu_count(), "median": median(ratios), "min": ratios[0],
            "max": ratios[-1], "unit": "of_one_thread", "rounds": SHARED_ROUNDS}


def measure(only, quick, threads):
    """Returns the results of the runs with names that begin with `only`, and whether all went well."""
    results, well, hashes = [], True, set()
    for name, pairs, programs in SHARED:
        if name.startswith(only) and threads is None and not quick:
            results.append(shared_result(name, pairs, programs))
    chosen = [one for one in RUNS if one[0].startswith(only) and not (quick and one[0] not in QUICK)]
    for name, scene, until, rounds, options in progress.over(chosen, "measures whole runs"):
        counts = [threads] if threads else [os.cpu_count()] if quick else sorted({1, os.cpu_count()})
        for count in counts:
            try:
                until_now = QUICK[name] if quick else until
                outcomes = [one_run(scene, until_now, count, options) for _ in range(1 if quick else rounds)]
            except (RuntimeError, OSError, KeyError) as error:
                complain(f"bench: {name}: {error}")
                well = False
                continue
            results.append(result_of(name, count, outcomes))
            hashes.update(o["frame_hash"] for o in outcomes if name in SAME_FRAMES)
    if len(hashes) > 1:
        complain(f"bench: {', '.join(sorted(SAME_FRAMES))}: the frames differ: {sorted(hashes)}")
        well = False
    return results, well
