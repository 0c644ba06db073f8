"""What the runs found, judged by the thresholds, and the observed order of convergence: validation.csv and the summary."""

import math

from wade import plain_file
from wade.reports.files import say
from wade.reports.jobs import read_result
from wade.reports.tables import write_csv
from wade.suites.cases import LEVELS

COLUMNS = "case,model,spacing_m,particles,metric,value,unit,threshold,pass,wall_s,cpu_s,reference".split(",")


def split_table(file):
    """Returns the rows of a table; its last field may hold commas."""
    lines = plain_file.read_text(file).splitlines()
    names = lines[0].split(",")
    return [dict(zip(names, line.split(",", len(names) - 1))) for line in lines[1:] if line]


class Judge:
    """The thresholds of each case, metric and level, and which of them are known to be missed."""

    def __init__(self, thresholds, known_failures):
        self.thresholds, self.reasons, self.guards = {}, {}, {}
        for row in split_table(thresholds):
            value = None
            for level in LEVELS:
                text = row[level]
                value = value if text == "" else None if text == "-" else float(text)
                self.thresholds[row["case"], row["metric"], level] = value
            self.reasons[row["case"], row["metric"]] = row["reason"]
        for row in split_table(known_failures):
            self.guards[row["case"], row["metric"], row["level"]] = (float(row["guard"]), row["reason"])

    def threshold(self, run, metric):
        return self.thresholds.get((run["case"], metric["name"], run["level"]))

    def verdict(self, run, metric):
        """"yes", "no", "known" (missed, as known failures say) or "" (not judged)."""
        limit = self.threshold(run, metric)
        if limit is None:
            return ""
        value = metric["value"]
        if value is not None and value <= limit:
            return "yes"
        guard = self.guards.get((run["case"], metric["name"], run["level"]))
        return "known" if guard and value is not None and value <= guard[0] else "no"

    def now_pass(self, runs):
        """A line for each known failure that the runs do not show any more: it can be struck out."""
        for run in runs:
            for metric in run["metrics"]:
                known = (run["case"], metric["name"], run["level"]) in self.guards
                if known and run["status"] == "completed" and self.verdict(run, metric) == "yes":
                    numbers = f"{exact(metric['value'])}, threshold {exact(self.threshold(run, metric))}"
                    yield f"known failure that now passes: {run['case']} {run['level']}: {metric['name']} = {numbers}"


def read_runs(folder, cases):
    """All complete runs in the order of the cases, coarse to fine."""
    there = [read_result(folder / f"{case.name}-{level}.json") for case in cases for level in case.levels]
    return [{**run, "folder": folder} for run in there if run]


def exact(value):
    return "" if value is None else f"{value:.8g}"


def csv_rows(runs, judge):
    for run in runs:
        start = [run["case"], run["model"], f"{run['spacing_m']:g}" if run["spacing_m"] else "", run["particles"]]
        end = [f"{run['solver_wall_s']:.3f}", f"{run['solver_cpu_s']:.3f}", run["reference"]]
        if run["status"] != "completed":
            yield start + ["run_completed", 0, "1", 1, "no"] + end
        for metric in run["metrics"]:
            passed = {"known": "no"}.get(judge.verdict(run, metric), judge.verdict(run, metric))
            numbers = [exact(metric["value"]), metric["unit"], exact(judge.threshold(run, metric)), passed]
            yield start + [metric["name"]] + numbers + end


def write_table(runs, judge, file):
    write_csv(file, COLUMNS, csv_rows(runs, judge))


def print_summary(plan, runs, judge):
    """Prints what was missed of the runs asked for; the exit code."""
    found = {(run["case"], run["level"]): run for run in runs}
    passed = known = 0
    bad = []
    for case, level in plan:
        run = found.get((case.name, level))
        if run is None or run["status"] != "completed":
            bad.append(f"{case.name} {level}: {run['error'] if run else 'no result, see runs/*.log'}")
            continue
        for metric in run["metrics"]:
            verdict = judge.verdict(run, metric)
            passed += verdict == "yes"
            known += verdict == "known"
            if verdict == "no":
                limit = exact(judge.threshold(run, metric))
                bad.append(f"{case.name} {level}: {metric['name']} = {exact(metric['value'])}, threshold {limit}")
    say(f"{passed} thresholds kept, {known} missed as known, {len(bad)} missed or not measured")
    for line in bad:
        say(f"  {line}")
    asked = {(case.name, level) for case, level in plan}
    for line in judge.now_pass(run for run in runs if (run["case"], run["level"]) in asked):
        say(line)
    return 1 if bad else 0


NOISE = 1e-5  # errors below it are rounding of single precision, not of the method
GOODNESS = 0.8  # part of the variance of log(error) that the straight line must explain


def observed_order(spacings, errors):
    """Slope of log(error) over log(spacing) by least squares; None where the errors do not fall with the spacing, that is
    where another part of the error, or chance, is larger than that of the spacing."""
    points = [(d, e) for d, e in zip(spacings, errors) if e is not None and d > 0]
    if len(points) < 3 or any(not math.isfinite(e) or e < NOISE for _, e in points):
        return None
    x = [math.log(d) for d, _ in points]
    y = [math.log(e) for _, e in points]
    mean_x, mean_y = sum(x) / len(x), sum(y) / len(y)
    xx = sum((a - mean_x) ** 2 for a in x)
    yy = sum((b - mean_y) ** 2 for b in y)
    xy = sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y))
    if xx == 0 or yy == 0 or xy * xy < GOODNESS * xx * yy or xy < 0:
        return None
    return xy / xx
