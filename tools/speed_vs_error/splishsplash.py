"""The front of the impulse case with SPlisHSPlasH as the water, through the bridge of tools/splishsplash.

The bridge publishes to a crowd, so what can be compared is what the crowd does: outcome and last place of the agents
that walk. The impulse on those who stand is not in the crowd's outputs.
"""

import csv
import json
import math
import os
import statistics
import subprocess
import sys
import time
from pathlib import Path

from measure import Measured
from settings import ROOT, Setting
from run_folder import say

CASE = "impulse_front"
REMARK = (
    "SPlisHSPlasH: only the front of the impulse case was run, with its DFSPH at the tolerances of the default here "
    "(0.05 and 0.1 %), a fixed time step, boundary particles for bed and walls, one thread and no friction at the walls. "
    "Its blocks weigh 0.8 of their volume of water. Compared are outcome and last place of the walking agents; the "
    "bridge hands the water to a crowd, which keeps no impulse of those who stand. Cost is CPU time of its whole process."
)


def channel_mesh(channel, radius):
    """Bed and four walls as a Wavefront mesh, one particle radius outside of the water's edge."""
    x = (channel["x_min_m"] - radius, channel["x_max_m"] + radius)
    z = (channel["z_min_m"] - radius, channel["z_max_m"] + radius)
    corners = [(x[0], z[0]), (x[1], z[0]), (x[1], z[1]), (x[0], z[1])]
    lines = [f"v {a} {y} {b}" for y in (-radius, 3.0) for a, b in corners]
    lines += ["f 1 2 3", "f 1 3 4"]
    for a in range(4):
        b = (a + 1) % 4
        lines += [f"f {a + 1} {b + 1} {b + 5}", f"f {a + 1} {b + 5} {a + 5}"]
    return "\n".join(lines) + "\n"


def filled_block(block, spacing):
    """A block of one particle in each cell of the lattice that fills the water.

    SPlisHSPlasH puts round(length / diameter) - 1 particles along an axis, the first one diameter from the start.
    """
    start, end = [], []
    for lo, hi in ((block["x_min_m"], block["x_max_m"]), (0, block["depth_m"]), (block["z_min_m"], block["z_max_m"])):
        count = round((hi - lo) / spacing)
        start.append(lo - spacing / 2)
        end.append(lo - spacing / 2 + (count + 1) * spacing)
    return {"id": "Fluid", "denseMode": 0, "start": start, "end": end}


def scene_of(spacing, mesh, session):
    """The scene of the case in the words of SPlisHSPlasH: metres, seconds, the same axes."""
    text = (ROOT / "configs" / "validation" / f"{CASE}.json").read_text()
    scene = json.loads("\n".join(line for line in text.splitlines() if not line.lstrip().startswith("//")))
    channel = scene["channel"]
    block = channel["water_blocks"][0]
    gravity = scene["world"]["gravity_m_s2"]
    rate = scene.get("frame_rate_hz", 30)
    # Half a spacing in a step at sqrt(g H) plus the speed of Ritter's tip, 2 sqrt(g H): the rule of this water.
    fastest = 3 * math.sqrt(gravity * block["depth_m"])
    steps = math.ceil(fastest / rate / (0.5 * spacing))
    document = {
        "Configuration": {
            "particleRadius": spacing / 2, "simulationMethod": 4, "gravitation": [0, -gravity, 0],
            "timeStepSize": 1 / (rate * steps), "cflMethod": 0, "boundaryHandlingMethod": 0, "dataExportFPS": rate,
            "enableWadeExport": True,
            "DFSPH": {"minIterations": 2, "maxIterations": 100, "maxError": 0.05, "maxIterationsV": 100,
                      "maxErrorV": 0.1, "enableDivergenceSolver": True},
        },
        "Wade": {"session": session, "metres_per_unit": 1, "time_scale": 1, "axes": [1, 2, 3]},
        "Materials": [{"id": "Fluid", "density0": 1000, "viscosityMethod": 1,
                       "Standard viscosity": {"viscosity": 0.01, "viscosityBoundary": 0}}],
        "RigidBodies": [{"geometryFile": mesh.name, "translation": [0, 0, 0], "scale": [1, 1, 1], "isDynamic": False,
                         "isWall": True, "samplingMode": 1}],
        "FluidBlocks": [filled_block(block, spacing)],
    }
    # A frame is exported after its first time step, so the last step of the crowd needs one frame more.
    return document, channel, round(scene["duration_s"] * rate) + 1


def reference():
    """id -> (outcome, x, z)"""
    names = {0: "active", 1: "arrived", 2: "dead"}
    lines = (ROOT / "tests" / "validation" / "data" / f"{CASE}_walking.csv").read_text().splitlines()
    rows = list(csv.reader(line for line in lines if not line.startswith("#")))[1:]
    return {int(r[0]): (names[int(float(r[1]))], float(r[3]), float(r[4])) for r in rows}


def compare(agents):
    """The errors of the walking agents, as `validate` computes them."""
    truth = reference()
    changed, places = 0, []
    for row in agents:
        if int(row["id"]) not in truth:
            continue
        outcome, x, z = truth[int(row["id"])]
        changed += row["outcome"] != outcome
        places.append(math.hypot(float(row["x_m"]) - x, float(row["z_m"]) - z))
    return {"outcome_changed": changed / len(truth), "end_place_median": statistics.median(places)}


def measure(producer, crowd_client, spacing, folder):
    """Runs the pair once; raises RuntimeError with the words of the program that failed."""
    folder.mkdir(parents=True, exist_ok=True)
    session = f"speed-vs-error-{os.getpid()}-{spacing:g}"
    mesh = folder / "channel.obj"
    document, channel, frames = scene_of(spacing, mesh, session)
    mesh.write_text(channel_mesh(channel, spacing / 2))
    scene = folder / "scene.json"
    scene.write_text(json.dumps(document, indent=1))
    environment = dict(os.environ, OMP_NUM_THREADS="1")
    start = time.monotonic()
    with open(folder / "producer.log", "wb") as log, open(folder / "crowd.log", "wb") as crowd_log:
        water = subprocess.Popen(
            [producer, scene, "--frames", str(frames), "--session", session, "--log-dir", folder / "log"],
            stdout=log, stderr=subprocess.STDOUT, env=environment,
        )
        try:
            crowd = subprocess.run(
                [crowd_client, ROOT / "configs" / "validation" / f"{CASE}.json", "--session", session, "--threads", "1",
                 "--attach-timeout-s", "60", "--out", folder / "run"],
                stdout=crowd_log, stderr=subprocess.STDOUT, check=False,
            )
        except BaseException:
            water.terminate()
            raise
        if crowd.returncode != 0:
            water.terminate()
        _, status, usage = os.wait4(water.pid, 0)
        water.returncode = os.waitstatus_to_exitcode(status)
    wall = time.monotonic() - start
    if water.returncode != 0 or crowd.returncode != 0:
        name, code = ("producer", water.returncode) if crowd.returncode == 0 else ("crowd", crowd.returncode)
        raise RuntimeError(f"{name}: exit code {code}, see {folder / name}.log")
    outcome = json.loads((folder / "run" / "outcome.json").read_text())
    if not outcome["fluid"]["particles_max"]:
        raise RuntimeError(f"its block of water is empty, see {folder / 'log'}")
    with open(folder / "run" / "agents.csv", newline="", encoding="utf-8") as agents:
        errors = compare(csv.DictReader(agents))
    simulated = outcome["sim_time_s"]
    fluid = outcome["fluid"]
    cpu = usage.ru_utime + usage.ru_stime
    return Measured(
        Setting(case=CASE, spacing=spacing, model="splishsplash"),
        particles=fluid.get("particles_max") or 0,
        cpu=cpu / simulated, wall=wall / simulated, rate=0.0,  # it does not tell its steps
        repeats=1, metrics=errors,
    )


def measure_all(producer, crowd_client, spacings, repeats, folder):
    """Points and remarks. A run that fails is a remark, not the end of the sweep."""
    points, remarks = [], [REMARK]
    for spacing in spacings:
        try:
            runs = []
            for k in range(1, repeats + 1):
                say(f"  {CASE}_d{spacing:g}_splishsplash ({k} of {repeats})", sys.stderr)
                place = folder / f"{spacing:g}" / f"repeat-{k}"
                runs.append(measure(Path(producer), Path(crowd_client), spacing, place))
        except (RuntimeError, OSError, KeyError, ValueError) as error:
            remarks.append(f"SPlisHSPlasH at {spacing:g} m: {error}")
            continue
        point = runs[0]
        point.repeats = repeats
        for name in ("cpu", "wall", "rate"):
            setattr(point, name, statistics.median(getattr(run, name) for run in runs))
        # Its boundary sampling may differ from run to run: the errors are those of the median run.
        for name in point.metrics:
            point.metrics[name] = statistics.median(run.metrics[name] for run in runs)
        points.append(point)
    return points, remarks
