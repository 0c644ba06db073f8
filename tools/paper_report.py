"""The results of reproduce_paper.py as table1.csv and as a report beside the paper's Table 1."""

import csv
import json
import statistics

COLUMNS = (
    "set,scenario,tau,v_f_m_s,contact_rule,initial_river,frame_rate_hz,gravity_m_s2,spacing_m,particle_mass_kg,"
    "paper_time_s,paper_diff_percent,paper_arrived,seeds,time_s_mean,time_s_lo,time_s_hi,arrived_mean,arrived_lo,"
    "arrived_hi,dead_mean,diff_percent,agent_depth_m,agent_speed_m_s,in_band"
).split(",")
SET_UPS = {"paper": "as run", "river": "as described", "observed": "as observed"}  # the set-up that each set of scenes stands for


class Run:
    """What one complete run folder says."""

    def __init__(self, scene_set, scenario, seed, folder):
        self.set, self.scenario, self.seed, self.folder = scene_set, scenario, seed, folder
        self.outcome = json.loads((folder / "outcome.json").read_text())
        self.manifest = json.loads((folder / "manifest.json").read_text())
        self.scene = self.manifest["resolved_scene"]
        with open(folder / "agents.csv", newline="", encoding="utf-8") as file:
            self.agents = list(csv.DictReader(file))

    def in_words(self):
        last = self.outcome["last_arrival_s"]
        after = f", the last after {last:.1f} s" if last is not None else ""
        return f"{self.outcome['arrived']} of {self.outcome['agents']} arrived{after}; {self.outcome['dead']} dead"

    def speed(self):
        """Simulated seconds in a second of wall time; None if the run kept no times."""
        wall = self.outcome["wall_time_s"]
        return self.outcome["sim_time_s"] / wall if wall else None


def read_paper(file):
    """Table 1 of the paper by scenario, "" for what it does not give."""
    with open(file, newline="", encoding="utf-8") as lines:
        rows = csv.DictReader(line for line in lines if not line.startswith("#"))
        return {row["scenario"]: {key: "" if value == "NA" else value for key, value in row.items()} for row in rows}


def spread(name, values):
    """Mean, least and greatest of the values of all seeds; empty if there are none."""
    if not values:
        return {f"{name}_mean": "", f"{name}_lo": "", f"{name}_hi": ""}
    return {f"{name}_mean": statistics.fmean(values), f"{name}_lo": min(values), f"{name}_hi": max(values)}


def depth_met(runs):
    """Mean over all agents that met water of the greatest depth each of them met, m; empty if none did."""
    depths = [float(agent["max_depth_m"]) for run in runs for agent in run.agents]
    wet = [depth for depth in depths if depth > 0]
    return statistics.fmean(wet) if wet else ""


def table_row(runs, paper):
    """One row of table1.csv from the runs of one scenario with all seeds."""
    run = runs[0]
    scene, crowd = run.scene, run.scene["crowd"]
    fluid = scene["fluid"]
    row = dict.fromkeys(COLUMNS, "")
    row.update(
        set=run.set,
        scenario=run.scenario,
        tau=crowd["groups"][0]["tau"],
        v_f_m_s=scene["channel"]["velocity_m_s"],
        contact_rule=scene["coupling"]["contact_rule"],
        initial_river=scene["channel"]["initial_river"],
        frame_rate_hz=scene["frame_rate_hz"],
        gravity_m_s2=scene["world"]["gravity_m_s2"],
        spacing_m=fluid["particle_spacing_m"],
        particle_mass_kg=fluid["rest_density_kg_m3"] * fluid["particle_spacing_m"] ** 3,
        paper_time_s=paper["time_s"],
        paper_diff_percent=paper["diff_percent"],
        paper_arrived=paper["arrived"],
        seeds=len(runs),
        dead_mean=statistics.fmean(r.outcome["dead"] for r in runs),
        agent_depth_m=depth_met(runs),
    )
    row.update(spread("time_s", [r.outcome["last_arrival_s"] for r in runs if r.outcome["last_arrival_s"] is not None]))
    row.update(spread("arrived", [r.outcome["arrived"] for r in runs]))
    return row


def table_rows(runs, paper):
    """The rows of table1.csv, in the order of the runs."""
    groups = {}
    for run in runs:
        groups.setdefault((run.set, run.scenario), []).append(run)
    rows = {key: table_row(group, paper[key[1]]) for key, group in groups.items()}
    for (scene_set, _), row in rows.items():
        base = rows.get((scene_set, "S1"), {}).get("time_s_mean")
        if base and row["time_s_mean"] != "":
            row["diff_percent"] = 100 * (row["time_s_mean"] - base) / base
    return list(rows.values())


def write_table(file, rows):
    with open(file, "w", newline="", encoding="utf-8") as out:
        writer = csv.DictWriter(out, COLUMNS, lineterminator="\n")
        writer.writeheader()
        for row in rows:
            writer.writerow({key: f"{value:.6g}" if isinstance(value, float) else value for key, value in row.items()})


def shown(value, digits=0):
    return "-" if value == "" else f"{float(value):.{digits}f}"


def results(row):
    """The cells of one set in the report: time, difference to S1, arrived, dead."""
    if row is None:
        return ["", "", "", ""]
    time, arrived = shown(row["time_s_mean"], 1), shown(row["arrived_mean"], 1 if row["seeds"] > 1 else 0)
    if row["seeds"] > 1 and row["time_s_mean"] != "":
        time += f" ({row['time_s_lo']:.1f} to {row['time_s_hi']:.1f})"
    return [time, shown(row["diff_percent"]), arrived, shown(row["dead_mean"], 1 if row["seeds"] > 1 else 0)]


def markdown_table(head, lines):
    rows = [head, *lines]
    widths = [max(len(row[i]) for row in rows) for i in range(len(head))]
    text = ["| " + " | ".join(cell.ljust(width) for cell, width in zip(row, widths)) + " |" for row in rows]
    text.insert(1, "|" + "|".join("-" * (width + 2) for width in widths) + "|")
    return "\n".join(text) + "\n"


def report_text(rows, runs, out, failures, verdict):
    """report.md: the sets side by side with the paper, the verdict's section, and how each run went."""
    by_key = {(row["set"], row["scenario"]): row for row in rows}
    sets = list(dict.fromkeys(row["set"] for row in rows))
    head = ["", "tau", "v_F", "paper: time", "diff %", "arrived"]
    for scene_set in sets:
        head += [f"{SET_UPS[scene_set]}: time", "diff %", "arrived", "dead"]
    lines = []
    for scenario in dict.fromkeys(row["scenario"] for row in rows):
        row = next(row for row in rows if row["scenario"] == scenario)
        cells = [scenario, shown(row["tau"], 1), shown(row["v_f_m_s"], 1), shown(row["paper_time_s"])]
        cells += [shown(row["paper_diff_percent"]), shown(row["paper_arrived"])]
        for scene_set in sets:
            cells += results(by_key.get((scene_set, scenario)))
        lines.append(cells)
    text = "# The scenarios of the paper\n\n"
    text += (
        "Paper: Schaffer et al., MIG 2020, Table 1. As run: configs/paper, as its authors ran it (emitter, dry start, "
        "gravity 0.98 m/s2).\nAs described: configs/river, as the paper describes it (a river 1 m deep that flows at "
        "v_F, gravity 9.81 m/s2).\nTime: arrival of the last agent that arrives, s; `-`: nobody arrives. diff: to the "
        "time of S1 in the same columns.\nWith several seeds: mean, and least to greatest.\n\n"
    )
    text += markdown_table(head, lines)
    if failures:
        text += "\nFailed, and not in the table: " + ", ".join(failures) + ".\n"
    commits = sorted({run.manifest["git_hash"] for run in runs})
    text += f"\nPrograms of commit {', '.join(commits)}."
    if len(commits) > 1:
        text += " The runs come from different states of the programs: start again in an empty folder to compare them."
    text += f"\n\n{verdict}\n## The runs\n\n"
    run_lines = []
    for run in runs:
        speed, fluid = run.speed(), run.outcome["fluid"]
        memory = fluid.get("resident_bytes")
        run_lines.append(
            [
                f"[{run.set} {run.scenario}, seed {run.seed}]({run.folder.relative_to(out)}/figure.png)",
                f"{run.outcome['sim_time_s']:.1f}",
                f"{speed:.1f}" if speed else "-",
                str(fluid["particles_max"]),
                f"{memory / 1e6:.0f}" if memory else "-",
                "-" if fluid["max_density_error"] is None else f"{100 * fluid['max_density_error']:.2f}",
                str(fluid.get("position_clamps")),
            ]
        )
    run_head = ["run and picture", "simulated s", "simulated s per s", "particles", "server MB"]
    return text + markdown_table([*run_head, "density error max %", "clamps"], run_lines)
