"""A flume, run with both programs: people stand in a stream that speeds up until they slip or topple."""

import json
import math
import subprocess

from wade import plain_file
from wade.paths import module_command
from wade.pictures.run_files import read_paths
from wade.run.processes import end_with_parent

RATE = 10  # Hz, of water and crowd
RISE = 0.02  # 1/s, relative rise of the speed: 1.2 % in the 0.6 s from failure to motion
MOVES = 0.004  # m/s, 1.5 % of the slowest stream that takes a person; a standing person does not move
PITCH = 1.25  # m, between people: more than twice the radius of the flow sampled at a person
LENGTH, SPACING = 4.0, 0.125  # m, of the channel, and of cells and particles
SLOWEST = 0.85  # start of the rise, over the least speed expected to make a person fail


def scene_of(people, depth, low, high):
    """Returns a scene: a stream of even depth that speeds up from low to high, m/s, and a row of people across it.

    people: (mu, lambda, height, mass) of each.
    """
    width = PITCH * (len(people) + 1)
    duration = math.log(high / low) / RISE
    history = [{"time_s": round(duration * k / 64, 6), "velocity_m_s": low * (high / low) ** (k / 64)} for k in range(65)]
    z = [PITCH * (k + 1) for k in range(len(people))]
    return {
        "description": f"People stand in water {depth:g} m deep that speeds up from {low:.3g} to {high:.3g} m/s.",
        "duration_s": duration, "frame_rate_hz": RATE, "seed": 1,
        "world": {"length_m": 4 * LENGTH, "width_m": width},
        "channel": {"x_min_m": 2 * LENGTH, "x_max_m": 3 * LENGTH, "z_min_m": 0, "z_max_m": width, "flow": "recirculating",
                    "initial_river": "filled", "depth_m": depth, "velocity_m_s": low, "velocity_history": history},
        "fluid": {"model": "shallow_water", "particle_spacing_m": SPACING, "max_particles": 1000000,
                  "shallow_water": {"cell_size_m": SPACING}},
        "crowd": {
            "response": "measured", "paths": {"rate_hz": RATE},
            "groups": [{"name": f"{k}", "ground_friction": mu, "bracing_arm": arm, "height_m": height, "mass_kg": mass, "desired_speed_m_s": 0,
                        "start": {"x_m": 2.5 * LENGTH, "z_m": z[k]}, "goal": {"x_m": 4 * LENGTH, "z_m": z[k]}}
                       for k, (mu, arm, height, mass) in enumerate(people)]},
    }


def first_motion(path):
    """Returns when a person begins to move, s, or None; path: rows of (time, x, z)."""
    for before, after in zip(path, path[1:]):
        if math.hypot(after[1] - before[1], after[2] - before[2]) > MOVES * (after[0] - before[0]):
            return after[0]
    return None


def failures(folder, people, depth, expected):
    """Returns the speed that makes each of the people (mu, lambda, height, mass) fail, m/s; None if one never moves."""
    low, high = SLOWEST * min(expected), 1.1 * max(expected)
    folder.mkdir(parents=True, exist_ok=True)
    scene = folder / "flume.json"
    scene.write_text(json.dumps(scene_of(people, depth, low, high), indent=1), encoding="utf-8")
    with plain_file.create(folder / "flume.log") as log:
        done = subprocess.run([*module_command("wade.run.pair"), scene, "--out", folder / "run", "--no-figure", "--threads", "1",
                               "--water-every-s", "0"], stdout=log, stderr=log, preexec_fn=end_with_parent)
    if done.returncode != 0:
        raise SystemExit(f"stability-of-people: the flume ended with {done.returncode}; see {log.name}")
    paths = read_paths(folder / "run" / "trajectories.sqlite")
    times = [first_motion(paths[k]) for k in range(len(people))]
    return [None if time is None else low * math.exp(RISE * time) for time in times]
