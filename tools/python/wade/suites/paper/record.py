"""What is kept of a single run: all that the tables and curves of the report need of it, and what identifies it."""

import json
import statistics
from itertools import accumulate

from wade.reports.tables import read_csv

OUTCOME = (
    "agents,arrived,dead,active,last_arrival_s,frames,step_rate_hz,sim_time_s,wall_time_s,frame_hash"
).split(",")
FLUID = (
    "particles_max,particle_steps,solver_wall_s,mean_depth_m,mean_speed_m_s,max_density_error,position_clamps,"
    "resident_bytes"
).split(",")


def record_of(folder):
    """(record, resolved scene) of a complete run folder."""
    outcome = json.loads((folder / "outcome.json").read_text())
    manifest = json.loads((folder / "manifest.json").read_text())
    agents = read_csv(folder / "agents.csv")
    record = {"commit": manifest["git_hash"]}
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
