"""models.csv, a line a metric of a run; models_table1.csv, a line a scenario of Table 1."""

import csv
import io

import paths  # noqa: F401  it says where the modules of the other suites are

import bands
from outcomes import COMPLETED, Judged
from table1 import COLUMNS as TABLE1_COLUMNS
from table1 import table_row
from run_folder import write_whole

COLUMNS = (
    "case,model,level,spacing_m,status,particles,metric,value,unit,limit,met,cpu_s,simulated_s,cpu_s_per_sim_s,source,"
    "commit,remark"
).split(",")


def number(value, digits=8):
    return "" if value is None else f"{value:.{digits}g}"


def rows_of(outcome, limits):
    start = [outcome.case, outcome.model, outcome.level, f"{outcome.spacing:g}", outcome.status]
    if outcome.status != COMPLETED:
        yield start + [""] * 8 + ["", outcome.source, outcome.commit, outcome.remark]
        return
    end = [number(outcome.cpu, 6), number(outcome.simulated, 6), number(outcome.cost, 6), outcome.source or "run"]
    for metric in outcome.metrics:
        limit = limits.get((outcome.case, metric["name"], outcome.level))
        met = "" if limit is None else "yes" if Judged(metric["name"], metric["value"], limit).ratio <= 1 else "no"
        middle = [outcome.particles, metric["name"], number(metric["value"]), metric["unit"], number(limit), met]
        yield start + middle + end + [outcome.commit, ""]


def write_rows(file, columns, rows):
    """Whole or not at all."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(rows)
    write_whole(file, text.getvalue())


def write_models(file, outcomes, limits):
    write_rows(file, COLUMNS, [row for outcome in outcomes for row in rows_of(outcome, limits)])


def write_table1(file, all_runs, paper):
    columns = ["model", *TABLE1_COLUMNS, "server_cpu_s_per_sim_s", "solver_wall_s_per_sim_s", "commits", "source"]
    rows = []
    for runs in all_runs:
        base = runs.results.get("S1")
        time = base.time[0] if base and base.time else None
        for name, result in runs.results.items():
            row = table_row(runs.set, name, result, paper[name], time, bands.judge_scenario(name, result).holds)
            cost = runs.costs[result.runs[0].water]
            cells = [f"{v:.6g}" if isinstance(v, float) else v for v in (row[column] for column in TABLE1_COLUMNS)]
            rows.append([runs.model, *cells, number(cost.cpu, 4), number(cost.solver_wall, 4), " ".join(runs.commits),
                         runs.source or "run"])
    write_rows(file, columns, rows)
