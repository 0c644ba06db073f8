"""What is kept of a single run, what all runs of a case come to, and the rows of table1.csv."""

import statistics
from collections import Counter
from itertools import accumulate

from wade import plain_file
from wade.statistics.shares import arrival_interval, bootstrap_mean
from wade.reports.tables import read_csv
from wade.sweeps.limits import in_words

COLUMNS = (
    "set,scenario,tau,v_f_m_s,contact_rule,initial_river,frame_rate_hz,gravity_m_s2,spacing_m,particle_mass_kg,"
    "paper_time_s,paper_diff_percent,paper_arrived,seeds,time_s_mean,time_s_lo,time_s_hi,arrived_mean,arrived_lo,"
    "arrived_hi,dead_mean,diff_percent,agent_depth_m,agent_speed_m_s,in_band"
).split(",")


class Run:
    """One complete run: what is kept of it, its scene, and its folder, None if that is not there any more."""

    def __init__(self, case, scenario, seed, record, scene, folder=None):
        self.set, self.water, self.scenario, self.seed = case.water.set, case.water.key, scenario, seed
        self.outcome, self.scene, self.folder = record, scene, folder

    def in_words(self):
        last = self.outcome["last_arrival_s"]
        after = f", the last after {last:.1f} s" if last is not None else ""
        return f"{self.outcome['arrived']} of {self.outcome['agents']} arrived{after}; {self.outcome['dead']} dead"

    def arrival_times(self, group=None):
        """Returns the sorted arrival times of the agents of a group, or of all, s."""
        return arrival_times(self.outcome, group)


class Result:
    """All runs of a case. Intervals are of 95 %; None where they cannot be told."""

    def __init__(self, runs):
        self.runs = runs
        self.agents = runs[0].outcome["agents"]
        self.scene = runs[0].scene
        self.arrived = arrival_interval([run.outcome["arrived"] for run in runs], self.agents)
        self.dead = statistics.fmean(run.outcome["dead"] for run in runs)
        last = [run.outcome["last_arrival_s"] for run in runs if run.outcome["last_arrival_s"] is not None]
        self.time = bootstrap_mean(last) if last else None
        self.depth, self.speed = mean_water_met(runs)
        self.commits = sorted({run.outcome["commit"] for run in runs})

    def arrived_of(self, group):
        """(mean, low, high) of the arrivals of one group."""
        size = self.runs[0].outcome["groups"][group]["agents"]
        return arrival_interval([len(run.arrival_times(group)) for run in self.runs], size)


def mean_water_met(runs):
    """Returns (depth, m; speed, m/s), means over agents that met water; (None, None) without such agents. The speed of
    an agent is its mean depth times speed over its mean depth."""
    met = [run.outcome["water_met"] for run in runs if run.outcome["water_met"][0]]
    wet = sum(agents for agents, _, _ in met)
    if not wet:
        return None, None
    return sum(agents * depth for agents, depth, _ in met) / wet, sum(agents * speed for agents, _, speed in met) / wet


def read_paper(file):
    """Table 1 of the paper by scenario, "" for what it does not give."""
    return {row["scenario"]: {key: "" if value == "NA" else value for key, value in row.items()}
            for row in read_csv(file)}


def table_row(scene_set, scenario, result, paper, base=None, in_band=None):
    """One row of table1.csv. base: mean time of S1 in the same set, s; in_band: whether the bands hold."""
    scene = result.scene
    fluid = scene["fluid"]
    row = dict.fromkeys(COLUMNS, "")
    row.update(set=scene_set, scenario=scenario, tau=in_words(scene["crowd"]["groups"][0]["tau"]),
               v_f_m_s=scene["channel"]["velocity_m_s"], contact_rule=scene["coupling"]["contact_rule"],
               initial_river=scene["channel"]["initial_river"], frame_rate_hz=scene["frame_rate_hz"],
               gravity_m_s2=scene["world"]["gravity_m_s2"], spacing_m=fluid["particle_spacing_m"],
               particle_mass_kg=fluid["rest_density_kg_m3"] * fluid["particle_spacing_m"] ** 3,
               paper_time_s=paper["time_s"], paper_diff_percent=paper["diff_percent"], paper_arrived=paper["arrived"],
               seeds=len(result.runs), dead_mean=result.dead, agent_depth_m=result.depth, agent_speed_m_s=result.speed,
               in_band="" if in_band is None else "yes" if in_band else "no")
    row.update(zip(("arrived_mean", "arrived_lo", "arrived_hi"), result.arrived))
    if result.time:
        row.update(zip(("time_s_mean", "time_s_lo", "time_s_hi"), result.time))
        if base:
            row["diff_percent"] = 100 * (result.time[0] - base) / base
    return row


OUTCOME = "agents,arrived,dead,active,last_arrival_s,frames,step_rate_hz,sim_time_s,wall_time_s,frame_hash".split(",")
FLUID = ("particles_max,particle_steps,solver_wall_s,mean_depth_m,mean_speed_m_s,max_density_error,position_clamps,"
         "resident_bytes").split(",")


def record_of(folder):
    """(record, resolved scene) of a complete run folder."""
    outcome = plain_file.read_json(folder / "outcome.json")
    manifest = plain_file.read_json(folder / "manifest.json")
    agents = read_csv(folder / "agents.csv")
    record = {"commit": manifest["git_hash"]}
    record.update({key: outcome.get(key) for key in OUTCOME})
    record["fluid"] = {key: (outcome.get("fluid") or {}).get(key) for key in FLUID}
    record["groups"] = groups_of(agents, outcome["step_rate_hz"])
    record["water_met"] = water_met(agents)
    if answers_by_body(manifest["resolved_scene"]):
        record["people"] = people_of(agents)
    return record, manifest["resolved_scene"]


def answers_by_body(scene):
    return scene["crowd"].get("response") == "measured"


def people_of(agents):
    """Returns, for each group with the response `measured`, the counts of worst states and of final states, and [number
    of people that met water, mean of their mean tau or None]."""
    groups = {}
    for agent in agents:
        if agent["worst_state"]:
            groups.setdefault(agent["group"], []).append(agent)
    return {name: {"worst": dict(Counter(agent["worst_state"] for agent in group)),
                   "state": dict(Counter(agent["state"] for agent in group)),
                   "tau": mean_of([float(agent["mean_tau"]) for agent in group if float(agent["mean_depth_m"]) > 0])}
            for name, group in groups.items()}


def mean_of(values):
    return [len(values), statistics.fmean(values) if values else None]


def groups_of(agents, step_rate):
    """Returns, for each group, the numbers of agents and of dead, and the steps of arrival: that of the first, then the
    differences."""
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
    """Returns the sorted arrival times of the agents of a group, or of all, s."""
    chosen = record["groups"].values() if group is None else [record["groups"][group]]
    steps = sorted(step for of_group in chosen for step in accumulate(of_group["arrival_steps"]))
    return [step / record["step_rate_hz"] for step in steps]


def water_met(agents):
    """Returns [number of agents that met water, their mean depth, m, their mean speed, m/s]; means None without
    such agents. The speed of an agent is its mean depth times speed over its mean depth."""
    met = [(float(agent["mean_depth_m"]), float(agent["mean_dv_m2_s"])) for agent in agents]
    wet = [(depth, dv) for depth, dv in met if depth > 0]
    if not wet:
        return [0, None, None]
    return [len(wet), statistics.fmean(depth for depth, _ in wet), statistics.fmean(dv / depth for depth, dv in wet)]
