"""Runs scenes with the program `impulse_scene` and keeps what it says: a run that is there already is not repeated."""

import csv
import hashlib
import json
import os
import re
import statistics
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = ROOT / "build" / "release" / "impulse_scene"
SERVER = ROOT / "build" / "release" / "fluid_server"


def write_whole(file, text):
    """A reader never meets half a file."""
    file = Path(file)
    file.parent.mkdir(parents=True, exist_ok=True)
    part = file.with_name(file.name + f".part{os.getpid()}")
    part.write_text(text)
    os.replace(part, file)


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
    name = re.sub(r"[^A-Za-z0-9_.=-]+", "-", Path(scene).stem + "".join(overrides))[:100]
    file = Path(folder) / f"{name}-{hashlib.sha256(inputs).hexdigest()[:12]}.json"
    if file.exists():
        return json.loads(file.read_text())
    if only_stored:
        return None
    file.parent.mkdir(parents=True, exist_ok=True)
    print("  " + " ".join(command[1:]), file=sys.stderr, flush=True)
    answer = subprocess.run(
        [PROGRAM, *command[1:], "--write", file], cwd=ROOT, env=dict(os.environ, OMP_NUM_THREADS="1"),
        stderr=subprocess.PIPE, text=True, timeout=time_limit, check=False,
    )
    if answer.returncode != 0:
        document = {"error": answer.stderr.strip()[-600:], "exit_code": answer.returncode}
        write_whole(file, json.dumps(document))
        return document
    return json.loads(file.read_text())


def choose(scene, demand):
    """What `fluid_server --check` chooses: a dictionary, or {"refused": why}."""
    command = [
        SERVER, scene, "--check", "--threads", "1", "--set", "/fluid/model=auto", "--set", f"/fluid/max_impulse_error={demand:g}",
    ]
    before = os.times()
    answer = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    after = os.times()
    if answer.returncode == 2:
        return {"refused": answer.stderr.strip()}
    if answer.returncode != 0:
        raise SystemExit(f"model_choice: {scene}: fluid_server ended with exit code {answer.returncode}: {answer.stderr}")
    found = re.search(r"^chosen: (.*); estimated error: median (\S+), 95 % (\S+), by the kind (\S+)$", answer.stdout, re.M)
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
    """The same of a table that `store_standing` or tools/speed_vs_error/impulse_reference.py has written."""
    lines = [line for line in Path(file).read_text().splitlines() if not line.startswith("#")]
    rows = csv.DictReader(lines)
    return {
        int(r["agent"]): (float(r["impulse_x_kg_m"]), float(r["impulse_z_kg_m"]), float(r["load_kg_m"])) for r in rows
    }


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


def quantile(values, q):
    """Of a sorted copy, linear between the values."""
    ordered = sorted(values)
    place = q * (len(ordered) - 1)
    k = int(place)
    return ordered[k] + (place - k) * (ordered[min(k + 1, len(ordered) - 1)] - ordered[k])


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
    return statistics.median(errors), quantile(errors, 0.95)
