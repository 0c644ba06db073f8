"""What is kept of a single run: all that the tables and curves of the report need of it, and what identifies it."""

import csv
import hashlib
import json
import re
import statistics
import sys
from itertools import accumulate
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[1] / "validation"))  # for run_folder
from run_folder import COMMIT, program_bytes  # noqa: E402

OUTCOME = (
    "agents,arrived,dead,active,last_arrival_s,frames,step_rate_hz,sim_time_s,wall_time_s,frame_hash"
).split(",")
FLUID = (
    "particles_max,particle_steps,solver_wall_s,mean_depth_m,mean_speed_m_s,max_density_error,position_clamps,"
    "resident_bytes"
).split(",")


class Version:
    """The two programs in a folder: the commit that they name, and a fingerprint of all their other bytes."""

    def __init__(self, folder):
        files = [folder / name for name in ("fluid_server", "crowd_client")]
        self.commit = COMMIT.search(files[1].read_bytes())[0].partition(b"=")[2].rstrip(b"\0").decode()
        self.fingerprint = hashlib.sha256(b"".join(map(program_bytes, files))).hexdigest()[:16]

    def made(self, record):
        """Whether it is these programs that made a run. One that was read from a folder of old has no fingerprint; its
        commit tells, unless it had changes."""
        if record["program"]:
            return record["program"] == self.fingerprint
        return record["commit"] == self.commit and not self.commit.endswith("-dirty")


def record_of(folder, program=""):
    """(record, resolved scene) of a complete run folder. program: fingerprint of the programs that ran it, if known."""
    outcome = json.loads((folder / "outcome.json").read_text())
    manifest = json.loads((folder / "manifest.json").read_text())
    with open(folder / "agents.csv", newline="", encoding="utf-8") as file:
        agents = list(csv.DictReader(file))
    record = {"commit": manifest["git_hash"], "program": program}
    record.update({key: outcome.get(key) for key in OUTCOME})
    record["fluid"] = {key: (outcome.get("fluid") or {}).get(key) for key in FLUID}
    record["groups"] = groups_of(agents, outcome["step_rate_hz"])
    record["water_met"] = water_met(agents)
    return record, manifest["resolved_scene"]


def groups_of(agents, step_rate):
    """Of each group how many there are and died, and when the others arrived: the step of the first, then how many steps
    later each of the next."""
    groups = {}
    for agent in agents:
        group = groups.setdefault(agent["group"], {"agents": 0, "dead": 0, "arrival_steps": []})
        group["agents"] += 1
        group["dead"] += agent["outcome"] == "dead"
        if agent["outcome"] == "arrived":
            group["arrival_steps"].append(round(float(agent["time_s"]) * step_rate))
    for group in groups.values():
        steps = sorted(group["arrival_steps"])
        group["arrival_steps"] = [step - before for before, step in zip([0, *steps], steps)]
    return groups


def arrival_times(record, group=None):
    """Sorted times at which agents of a group, or all, arrived, s."""
    chosen = record["groups"].values() if group is None else [record["groups"][group]]
    steps = sorted(step for of_group in chosen for step in accumulate(of_group["arrival_steps"]))
    return [step / record["step_rate_hz"] for step in steps]


def water_met(agents):
    """[number of the agents that met water, mean over them of the mean depth in which each stood, m, and of its depth
    times speed over that depth, m/s], the means None if none did."""
    met = [(float(agent["mean_depth_m"]), float(agent["mean_dv_m2_s"])) for agent in agents]
    wet = [(depth, dv) for depth, dv in met if depth > 0]
    if not wet:
        return [0, None, None]
    return [len(wet), statistics.fmean(depth for depth, _ in wet), statistics.fmean(dv / depth for depth, dv in wet)]


def natural(text):
    """Key by which s2 comes before s10."""
    return [(int(part), "") if part.isdigit() else (0, part) for part in re.split(r"(\d+)", text)]
