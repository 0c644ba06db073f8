"""The section of a report that holds its runs against those of another folder, made with other settings."""

import math

from wade.reports.tables import markdown
from wade.suites.validate import convergence
from wade.suites.validate.results import read_runs

WORDS = {"yes": "", "known": "!", "no": "!"}


def pairs(runs, others):
    """(run, other) of each case and resolution that both folders have complete."""
    there = {(run["case"], run["level"]): run for run in others if run["status"] == "completed"}
    for run in runs:
        other = there.get((run["case"], run["level"]))
        if other and run["status"] == "completed":
            yield run, other


def judged(run, judge):
    """(name, value, verdict) of each metric with a limit."""
    for metric in run["metrics"]:
        verdict = judge.verdict(run, metric)
        if verdict:
            yield metric["name"], metric["value"], verdict


def missed(run, judge):
    return sum(verdict != "yes" for _, _, verdict in judged(run, judge))


def step_cost(run):
    """CPU time of a particle and step, s; None of a run without water."""
    return run["solver_cpu_s"] / run["particle_steps"] if run["particle_steps"] else None


def ratio_words(value, other):
    return f"{value / other:.2f}" if value and other else "-"


def middle(ratios):
    """Their geometric mean, in words."""
    return f"{math.exp(sum(map(math.log, ratios)) / len(ratios)):.2f}" if ratios else "-"


def rows(found, judge):
    for run, other in found:
        there = {name: (value, verdict) for name, value, verdict in judged(other, judge)}
        cells = []
        for name, value, verdict in judged(run, judge):
            if name not in there or (value == 0 and there[name][0] == 0):
                continue
            before, verdict_before = there[name]
            cells.append(f"{name} {before:.3g}{WORDS[verdict_before]} -> {value:.3g}{WORDS[verdict]}")
        steps = ratio_words(step_cost(run), step_cost(other))
        cost = ratio_words(run["solver_cpu_s"], other["solver_cpu_s"])
        yield f"[{run['case']}](#{run['case']})", run["level"], "; ".join(cells), cost, steps


def error_ratios(found, judge, chance):
    """Ratios of all errors with a limit that are above noise in both."""
    for run, other in found:
        there = {name: value for name, value, _ in judged(other, judge)}
        for name, value, _ in judged(run, judge):
            if value and there.get(name) and min(value, there[name]) > chance:
                yield value / there[name]


def text(runs, folder, cases, judge):
    """folder: that of the other report."""
    found = [(run, other) for run, other in pairs(runs, read_runs(folder / "runs", cases)) if run["particle_steps"]]
    if not found:
        return "No case of water is complete in both.\n"
    here, there = (sum(missed(pair[k], judge) for pair in found) for k in (0, 1))
    limits = sum(len(list(judged(run, judge))) for run, _ in found)
    ratios = list(error_ratios(found, judge, convergence.NOISE))
    costs = [step_cost(run) / step_cost(other) for run, other in found]
    head = ("case", "resolution", "errors with a limit, there -> here", "CPU time, times", "of a particle and step")
    return (
        f"Of {limits} limits in {len(found)} runs of water {here} are missed here and {there} there; `!`: missed. "
        f"Errors are {middle(ratios)} times those there and a particle's step costs {middle(costs)} times as much "
        f"(geometric means; of {len(ratios)} errors with a limit that are above {convergence.NOISE:g} in both).\n\n"
    ) + markdown(head, rows(found, judge))
