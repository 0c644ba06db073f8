"""Runs of DFSPH that tools/validate.sh has made: read from its validation.csv and the report beside it."""

import csv
import re

from outcomes import COMPLETED, FAILED, Outcome, level_of

SECTION = re.compile(r"^### (\S+)$")
COST_ROW = re.compile(r"^\| (coarse|medium|fine) \| \d+ \| \d+ \| ([0-9.e+-]+) s \|")
COMMIT = re.compile(r"commit ([0-9a-f]+(?:-dirty)?)")


def simulated_times(report):
    """{(case, level): simulated time, s} of the cost tables of report.md, and the commits it names; empty without a
    report."""
    times, commits, case = {}, [], None
    lines = report.read_text(encoding="utf-8").splitlines() if report.is_file() else []
    for line in lines:
        if section := SECTION.match(line):
            case = section[1]
        elif row := COST_ROW.match(line):
            times[case, row[1]] = float(row[2])
        elif line.startswith("* ") and (commit := COMMIT.search(line)):
            commits.append(commit[1])
    return times, list(dict.fromkeys(commits))


def read_recorded(file, cases, model="dfsph"):
    """{(case, level): Outcome} of a model in validation.csv, and the commits of the programs that made it."""
    times, commits = simulated_times(file.with_name("report.md"))
    by_name, found = {case.name: case for case in cases}, {}
    with open(file, newline="", encoding="utf-8") as lines:
        for row in csv.DictReader(lines):
            case = by_name.get(row["case"])
            if case is None or row["model"] != model or not row["spacing_m"]:
                continue
            spacing = float(row["spacing_m"])
            level = level_of(case.spacings, spacing)
            if level is None:
                continue
            key = case.name, level
            if key not in found:
                found[key] = Outcome(
                    case.name, level, model, spacing, COMPLETED, particles=int(row["particles"]),
                    cpu=float(row["cpu_s"]), simulated=times.get(key), source=file.name,
                    commit=" or ".join(commits) or "unknown",
                )
            if row["metric"] == "run_completed" and row["pass"] == "no":
                found[key].status, found[key].remark = FAILED, "did not complete"
            value = float(row["value"]) if row["value"] else None
            found[key].metrics.append({"name": row["metric"], "value": value, "unit": row["unit"]})
    return found, commits
