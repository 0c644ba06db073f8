#!/usr/bin/env python3
"""How much the outcome depends on the frame rate, with each coupling rule. tools/frame_rates.sh calls it.

For each scene and rate one server sends the water to all crowds: both rules and the walk without water (tau 0), each
with N seeds of the markers. The water is the same at all rates, sampled more or less often.
"""

import argparse
import csv
import json
import subprocess
import sys
from pathlib import Path

import numpy as np

from pair_arguments import ROOT, find_scene

RATES = (15, 30, 60, 120)  # Hz
RULES = {
    "per_frame": {"/coupling/rule": "per_frame"},
    "continuous": {"/coupling/rule": "continuous"},
    "no water": {"/crowd/tau": 0},
}
MEASURES = ("arrived", "time_s", "agent_time_s")
COLUMNS = ("scene", "rule", "frame_rate_hz", "seeds", "agents") + tuple(
    f"{measure}_{end}" for measure in MEASURES for end in ("mean", "lo", "hi")
)
RESAMPLES = 10000


def label(scene):
    """Folder and name of a scene file, "observed-s05"."""
    path = Path(scene).resolve()
    return f"{path.parent.name}-{path.stem}"


def interval(values):
    """(mean, lower, upper) of the mean with 95 %, bootstrap with a fixed start."""
    values = np.asarray([v for v in values if v is not None], dtype=float)
    if values.size == 0:
        return (None, None, None)
    draws = np.random.default_rng(1).choice(values, (RESAMPLES, values.size)).mean(axis=1)
    return (values.mean(), *np.percentile(draws, (2.5, 97.5)))


def run(scene, rate, options):
    """Runs all crowds of a scene at one rate; returns {(rule, seed): run folder}, or None if the run failed."""
    out = options.out / "runs" / f"{label(scene)}-{rate}hz"
    out.mkdir(parents=True, exist_ok=True)
    seeds = range(1, options.seeds + 1)
    crowds = {(rule, seed): f"{rule.replace(' ', '_')}-seed{seed}" for rule in RULES for seed in seeds}
    crowd_list = [{"name": name, "set": {"/seed": seed, **RULES[rule]}} for (rule, seed), name in crowds.items()]
    (out / "crowds.json").write_text(json.dumps(crowd_list, indent=1))
    command = ["/usr/bin/python3", ROOT / "tools" / "run_pair.py", "--programs", options.programs, scene, "--out", out,
               "--crowds", out / "crowds.json", "--set", f"/frame_rate_hz={rate}", "--no-trajectories",
               "--water-every-s", "0", "--reproducible", "--threads", str(options.threads)]
    with open(out / "run.log", "w", encoding="utf-8") as log:
        if subprocess.run(command, stdout=log, stderr=log).returncode != 0:
            print(f"frame_rates.sh: {scene} at {rate} Hz failed, see {out / 'run.log'}", file=sys.stderr)
            return None
    return {key: out / name for key, name in crowds.items()}


def figures_of(folder):
    """(arrived, time of the last arrival, mean time of the arrivals) of a crowd; times None if nobody arrived."""
    outcome = json.loads((folder / "outcome.json").read_text())
    with open(folder / "agents.csv", newline="", encoding="utf-8") as file:
        times = [float(row["time_s"]) for row in csv.DictReader(file) if row["outcome"] == "arrived"]
    return outcome["arrived"], outcome["last_arrival_s"], float(np.mean(times)) if times else None


def rows_of(scene, rate, folders, seeds):
    for rule in RULES:
        figures = [figures_of(folders[rule, seed]) for seed in range(1, seeds + 1)]
        with open(folders[rule, 1] / "agents.csv", encoding="utf-8") as file:
            agents = len(file.readlines()) - 1
        row = [label(scene), rule, rate, seeds, agents]
        for values in zip(*figures):
            row += interval(values)
        yield dict(zip(COLUMNS, row))


def verdict(rows, key):
    """(spread of the means over the rates, whether all intervals share a value); None if somewhere nobody arrived."""
    if any(row[f"{key}_mean"] is None for row in rows):
        return None
    means = [row[f"{key}_mean"] for row in rows]
    return max(means) - min(means), max(row[f"{key}_lo"] for row in rows) <= min(row[f"{key}_hi"] for row in rows)


def shown(row, key, digits=1):
    if row[f"{key}_mean"] is None:
        return "-"
    return "{:.{d}f} ({:.{d}f} .. {:.{d}f})".format(*(row[f"{key}{end}"] for end in ("_mean", "_lo", "_hi")), d=digits)


HEADER = """# Outcomes at several frame rates

`{command}`: frames of the water and steps of the crowd at {rates} Hz, {seeds} seeds of the markers in one water;
means with 95 % intervals (bootstrap over the seeds). A rule passes where the intervals of all rates share a value.
"no water" is the walk alone (tau 0): what varies there is due to the walking rule and the markers. Time: of the last
arrival; agents' time: mean over all who arrive.
"""


def report(rows, options):
    rates = sorted({row["frame_rate_hz"] for row in rows})
    lines = [HEADER.format(command=options.command, rates=", ".join(map(str, rates)), seeds=options.seeds)]
    for scene in dict.fromkeys(row["scene"] for row in rows):
        of_scene = [row for row in rows if row["scene"] == scene]
        lines += [f"## {scene}", "", "| rule | rate | arrived | time, s | agents' time, s |", "|---|---|---|---|---|"]
        for row in of_scene:
            cells = shown(row, "arrived"), shown(row, "time_s"), shown(row, "agent_time_s", 2)
            lines.append(f"| {row['rule']} | {row['frame_rate_hz']} | {' | '.join(cells)} |")
        lines += ["", "| rule | arrived: range of the means | time, s | agents' time, s |", "|---|---|---|---|"]
        for rule in RULES:
            answers = [verdict([row for row in of_scene if row["rule"] == rule], key) for key in MEASURES]
            cells = ["-" if a is None else f"{a[0]:.2f}, {'pass' if a[1] else 'FAIL'}" for a in answers]
            lines.append(f"| {rule} | {' | '.join(cells)} |")
        lines.append("")
    return "\n".join(lines).rstrip("\n") + "\n"


def main():
    parser = argparse.ArgumentParser(prog="frame_rates.sh", allow_abbrev=False)
    parser.add_argument("scenes", nargs="*")
    parser.add_argument("--programs", type=Path, required=True)
    parser.add_argument("--out", type=Path, default=ROOT / "runs" / "frame_rates")
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--threads", type=int, default=0)
    parser.add_argument("--rates", default=",".join(map(str, RATES)))
    options = parser.parse_args()
    if not 1 <= options.seeds <= 1000:
        parser.error(f"--seeds: {options.seeds} is not allowed; allowed: 1 to 1000")
    rates = [float(rate) if "." in rate else int(rate) for rate in options.rates.split(",")]
    scenes = options.scenes or [f"configs/observed/s{n:02}.json" for n in (5, 7, 10)]
    options.command = " ".join(["tools/frame_rates.sh", *options.scenes, "--seeds", str(options.seeds)])
    rows, failed = [], False
    for name in scenes:
        for rate in rates:
            scene = find_scene(name)
            folders = run(scene, rate, options)
            failed = failed or folders is None
            rows += rows_of(scene, rate, folders, options.seeds) if folders else []
    order = [label(find_scene(name)) for name in scenes]
    rows.sort(key=lambda row: (order.index(row["scene"]), list(RULES).index(row["rule"]), row["frame_rate_hz"]))
    with open(options.out / "frame_rates.csv", "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    text = report(rows, options)
    (options.out / "report.md").write_text(text)
    print(text, end="")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
