"""The scenes of the check, and their runs with the program `impulse_scene`: a run that is there already is not repeated."""

import hashlib
import json
import os
import re
import statistics
import subprocess

import numpy as np

from wade import plain_file
from wade.paths import BUILD, ROOT
from wade.reports.files import complain, write_whole
from wade.reports.tables import read_csv

DEMANDS = (0.05, 0.1, 0.3)
# Left out where the chosen run would take longer than the finest.
LEFT_OUT = {("block_small", 0.05), ("block_large", 0.05), ("block_large", 0.1)}
# Added after the last change of table and rules.
UNSEEN = ("river_brisk", "river_calm")
QUICK = ("river_shallow", "front_low", "block_front")

FINEST = {
    "river_shallow": 0.0625,
    "river_deep": 0.14,
    "river_fast": 0.125,
    "river_wide": 0.16,
    "slope": 0.125,
    "river_brisk": 0.09,
    "river_calm": 0.13,
    "front_low": 0.06,
    "front_high": 0.09,
    "front_wet": 0.1,
    "block_small": 0.08,
    "block_large": 0.125,
    "block_front": 0.09,
    "emitter_history": 0.1,
    "emitter_filled": 0.125,
}
ROOM = 100000  # max_particles of the finest runs


def demands(name):
    return [demand for demand in DEMANDS if (name, demand) not in LEFT_OUT]


def file_of(name):
    return f"configs/model_choice/{name}.json"


def finest_overrides(name):
    return ["/fluid/model=dfsph", f"/fluid/particle_spacing_m={FINEST[name]:g}", f"/fluid/max_particles={ROOM}"]


def command_of(scene, overrides):
    """The command that repeats a run, as words."""
    words = ["build/release/impulse_scene", str(scene), "--threads", "1"]
    for value in overrides:
        words += ["--set", value]
    return words


def run(scene, overrides, folder, time_limit=1800.0, only_stored=False):
    """The document of a run of the scene (a path relative to the root). One that failed has "error" instead of results.

    With only_stored None if it is not there.
    """
    command = command_of(scene, overrides)
    inputs = (ROOT / scene).read_bytes() + "\0".join(command).encode()
    name = re.sub(r"[^A-Za-z0-9_.=-]+", "-", (ROOT / scene).stem + "".join(overrides))[:100]
    file = folder / f"{name}-{hashlib.sha256(inputs).hexdigest()[:12]}.json"
    if file.exists():
        return plain_file.read_json(file)
    if only_stored:
        return None
    file.parent.mkdir(parents=True, exist_ok=True)
    complain("  " + " ".join(command[1:]))
    answer = subprocess.run(
        [BUILD / "impulse_scene", *command[1:], "--write", file], cwd=ROOT, env=dict(os.environ, OMP_NUM_THREADS="1"),
        stderr=subprocess.PIPE, text=True, timeout=time_limit, check=False,
    )
    if answer.returncode != 0:
        document = {"error": answer.stderr.strip()[-600:], "exit_code": answer.returncode}
        write_whole(file, json.dumps(document))
        return document
    return plain_file.read_json(file)


def choose(scene, demand):
    """What `fluid_server --check` chooses: a dictionary, or {"refused": why}."""
    command = [BUILD / "fluid_server", scene, "--check", "--threads", "1", "--set", "/fluid/model=auto", "--set",
               f"/fluid/max_impulse_error={demand:g}"]
    before = os.times()
    answer = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    after = os.times()
    if answer.returncode == 2:
        return {"refused": answer.stderr.strip()}
    if answer.returncode != 0:
        raise SystemExit(f"model_choice: {scene}: fluid_server ended with exit code {answer.returncode}: {answer.stderr}")
    found = re.search(r"^chosen: (.*); estimated error: median (\S+), 95 % (\S+), by the kind (\S+)$", answer.stdout,
                      re.M)
    same = re.search(r"^without a choice the same is:(.*)$", answer.stdout, re.M)
    pilot = re.search(r"impulses differ by (\S+) .* at most (\S+);", answer.stdout)
    return {
        "chosen": found[1],
        "estimated_median": float(found[2]),
        "estimated_p95": float(found[3]),
        "kind": found[4],
        "went_up": "contradicts the choice" in answer.stdout,
        "pilot": f"{pilot[1]} of {pilot[2]}" if pilot else "",
        "overrides": [word for word in same[1].split() if word != "--set"],
        "cpu_s": after.children_user + after.children_system - before.children_user - before.children_system,
        "lines": answer.stdout.splitlines(),
    }


def standing_of(document):
    """agent -> (impulse along x, across, load), kg m."""
    return {int(row[0]): tuple(row[1:4]) for row in document["standing"]}


def read_standing(file):
    """The same of a table that `store_standing` or `tools/wade speed-vs-error --reference` has written."""
    columns = ("impulse_x_kg_m", "impulse_z_kg_m", "load_kg_m")
    return {int(row["agent"]): tuple(float(row[column]) for column in columns) for row in read_csv(file)}


def store_standing(document, command, file):
    """Keeps the finest run of a scene as a table."""
    lines = [
        f"# A run of our own, {document['particles']} particles, {document['steps']} steps, "
        f"{document['solver_cpu_s']:.0f} s of CPU; not a measurement.",
        "# " + " ".join(command),
        ",".join(document["standing_columns"]),
    ]
    lines += [f"{int(row[0])}," + ",".join(f"{v:.9g}" for v in row[1:]) for row in document["standing"]]
    write_whole(file, "\n".join(lines) + "\n")


def errors_of(standing, truth):
    """|I - I_ref| / L_ref of each agent with L_ref > 0, as tests/validation/impulse.hpp defines it."""
    errors = []
    for agent, (x, z, load) in truth.items():
        if load > 0:
            dx, dz = standing[agent][0] - x, standing[agent][1] - z
            errors.append((dx * dx + dz * dz) ** 0.5 / load)
    return errors


def median_and_p95(standing, truth):
    errors = errors_of(standing, truth)
    return statistics.median(errors), float(np.quantile(errors, 0.95))
