"""report.md: a table of verdicts, and a section a case."""

import math

from wade.reports.files import write_whole
from wade.reports.tables import document, markdown, number, section
from wade.suites.validate import curves
from wade.suites.validate.results import NOISE, exact, observed_order, read_runs

MISSED = {"yes": "", "known": "!", "no": "!"}


def stamp(fingerprint, starts):
    """What a run of so many starts keeps as its fingerprint."""
    return fingerprint if starts == 1 else f"{fingerprint}-{starts}"


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


def rows_beside(found, judge):
    for run, other in found:
        there = {name: (value, verdict) for name, value, verdict in judged(other, judge)}
        cells = []
        for name, value, verdict in judged(run, judge):
            if name not in there or (value == 0 and there[name][0] == 0):
                continue
            before, verdict_before = there[name]
            cells.append(f"{name} {before:.3g}{MISSED[verdict_before]} -> {value:.3g}{MISSED[verdict]}")
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


def beside_text(runs, folder, cases, judge):
    """folder: that of the other report."""
    found = [(run, other) for run, other in pairs(runs, read_runs(folder / "runs", cases)) if run["particle_steps"]]
    if not found:
        return "No case of water is complete in both.\n"
    here, there = (sum(missed(pair[k], judge) for pair in found) for k in (0, 1))
    limits = sum(len(list(judged(run, judge))) for run, _ in found)
    ratios = list(error_ratios(found, judge, NOISE))
    costs = [step_cost(run) / step_cost(other) for run, other in found]
    head = ("case", "resolution", "errors with a limit, there -> here", "CPU time, times", "of a particle and step")
    return (
        f"Of {limits} limits in {len(found)} runs of water {here} are missed here and {there} there; `!`: missed. "
        f"Errors are {middle(ratios)} times those there and a particle's step costs {middle(costs)} times as much "
        f"(geometric means; of {len(ratios)} errors with a limit that are above {NOISE:g} in both).\n\n"
    ) + markdown(head, rows_beside(found, judge))


WORDS = {"yes": "pass", "no": "**FAIL**", "known": "**FAIL** (known)", "": ""}
HEAD = """# Validation

Each case is a simulation whose truth is known. Its error is measured at up to three resolutions and judged by thresholds that
were written down before the results (`tests/validation/thresholds.csv`, with their reasons). A threshold that is missed is
a failure, also if it is known (`tests/validation/known_failures.csv`). Errors are ratios unless a unit is given. The order is
the slope of the straight line through log(error) over log(spacing) of three resolutions; "-" where the errors do not
fall with the spacing or are at the level of noise. Where chance decides, the numbers are medians of five runs whose gravity
differs by up to 0.02 %, with the least and the largest one in brackets.

`tools/wade validate` writes this file; `validation.csv` holds the same numbers.
"""
NOT_RUN = """Runs that this report has no result of, and the CPU time they would take by what the others took. `--cases NAME --levels
LEVEL` makes one; those that take hours need `--long`."""
OLD = "\\* by another version of the program"


def spacing(run):
    return f"{run['spacing_m']:g} m" if run["spacing_m"] else "-"


def missed_words(run, judge):
    """What a run misses of its thresholds, and how many it keeps of how many."""
    if run["status"] != "completed":
        return f"**did not complete**: {run['error']}", ""
    verdicts = [(metric, judge.verdict(run, metric)) for metric in run["metrics"]]
    missed = [f"**{metric['name']}** {value_words(metric)} (limit {number(judge.threshold(run, metric))}"
              f"{', known' if verdict == 'known' else ''})" for metric, verdict in verdicts
              if verdict in ("no", "known")]
    kept = sum(verdict == "yes" for _, verdict in verdicts)
    return "; ".join(missed), f"{kept} of {sum(verdict != '' for _, verdict in verdicts)}"


def verdict_table(runs, judge, is_old):
    rows = []
    for run in runs:
        missed, kept = missed_words(run, judge)
        mark = " \\*" if is_old(run) else ""
        rows.append((f"[{run['case']}](#{run['case']})", run["level"] + mark, spacing(run), run["particles"],
                     kept or "0 of 0", missed))
    return markdown(("case", "resolution", "spacing", "particles", "thresholds kept", "missed"), rows)


def value_words(metric):
    """The value, and of several starts the least and the largest one."""
    if metric.get("low") is None or metric["low"] == metric["high"]:
        return number(metric["value"])
    return f"{number(metric['value'])} ({number(metric['low'])} to {number(metric['high'])})"


def metric_table(runs, judge):
    """A row a metric, a column a resolution."""
    rows = []
    for name in dict.fromkeys(metric["name"] for run in runs for metric in run["metrics"]):
        cells, values, unit, limits = [], [], "", []
        for run in runs:
            metric = next((m for m in run["metrics"] if m["name"] == name), None)
            values.append(metric and metric["value"])
            cells.append(f"{value_words(metric)} {WORDS[judge.verdict(run, metric)]}".strip() if metric else "")
            if metric:
                unit = "" if metric["unit"] == "1" else metric["unit"]
                limits.append(judge.threshold(run, metric))
        judged = any(limit is not None for limit in limits)
        slope = observed_order([run["spacing_m"] for run in runs], values) if judged else None
        order = f"{slope:.1f}" if slope is not None else "-" if judged else ""
        limit = " / ".join(dict.fromkeys(map(number, limits))) if judged else "reported"
        rows.append((name, unit, *cells, order, limit))
    return markdown(("", "unit", *(f"{run['level']}, {spacing(run)}" for run in runs), "order", "limit"), rows)


def cost_table(runs):
    rows = []
    for run in runs:
        time, cpu = run["simulated_s"], run["solver_cpu_s"]
        work = f"{run['particle_steps'] / cpu:,.0f}" if cpu and run["particle_steps"] else "-"
        rows.append((run["level"], run["particles"], run["steps"], f"{time:g} s", number(cpu / time) if time else "-",
                     work))
    return markdown(("resolution", "particles", "steps", "simulated", "CPU s for 1 s", "particle steps per CPU s"),
                    rows)


def case_section(case, runs, judge, is_old, picture):
    lost = [f"**{run['level']} did not complete**: {run['error']}" for run in runs if run["status"] != "completed"]
    reasons = "; ".join(f"{name}: {reason}" for (owner, name), reason in judge.reasons.items() if owner == case.name)
    known = [f"Known to be missed: {metric} at {level}, up to {exact(guard)}: {reason}."
             for (owner, metric, level), (guard, reason) in judge.guards.items() if owner == case.name]
    old = ", ".join(f"{run['level']} {run['git']}" for run in runs if is_old(run))
    return section(case.name, runs[-1]["truth"], *lost, metric_table(runs, judge), f"Limits: {reasons}." if reasons
                   else "",
                   *known, cost_table(runs), f"{OLD}: {old}." if old else "",
                   f"![{case.name}](figures/{case.name}.png)" if picture else "", level=3)


def seconds_expected(runs, spacing):
    """CPU time of one start at a spacing that was not run, s: by the power law of the two finest runs, or with the particles
    of a volume, d^-3, and the steps, 1/d. None without a run."""
    done = sorted((run["spacing_m"], run["solver_cpu_s"] / run.get("starts", 1)) for run in runs
                  if run["status"] == "completed" and run["spacing_m"])
    if not done or done[0][1] <= 0:
        return None
    (finest, cpu), power = done[0], 4
    if len(done) > 1:
        power = math.log(done[1][1] / cpu) / math.log(finest / done[1][0])
    return cpu * (finest / spacing) ** power


def time_text(seconds):
    if seconds is None:
        return "-"
    unit, name = next(((u, n) for u, n in ((3600, "h"), (60, "min")) if seconds >= u), (1, "s"))
    return f"{seconds / unit:.2g} {name}"


def missing_runs(runs, cases):
    """Yields a row for each run that is missing."""
    for case in cases:
        of_case = [run for run in runs if run["case"] == case.name]
        done = {run["level"] for run in of_case}
        for level, d in zip(case.levels, case.spacings):
            if level not in done:
                one_start = seconds_expected(of_case, d)
                seconds = one_start and case.starts_at(level) * one_start
                yield case.name, level, f"{d:g} m" if d else "-", time_text(seconds)


def machine_section(runs):
    seen = dict.fromkeys((run["processor"], run["processors"], run["compiler"], run["version"], run["git"])
                         for run in runs)
    lines = [f"* {processor}, {count} processors; compiler {compiler}; version {version}, commit {git}."
             for processor, count, compiler, version, git in seen]
    several = "".join(f", but {run['threads']} in {run['case']} {run['level']}" for run in runs if run["threads"] > 1)
    return section("Machine", "\n".join(lines),
                   "CPU times are of the solver, without set-up and measurement; runs beside one "
                   f"another slow each other down.\nEach run had one thread{several}.")


def write(runs, cases, judge, fingerprint_of, folder, settings=(), held_against="", head=HEAD, front=""):
    """settings: of all runs, as --set has them; held_against: text about another folder of runs, or none; head: title and
    what the report is; front: a section before the verdicts, or none."""

    def is_old(run):
        return run["fingerprint"] != stamp(fingerprint_of(run["case"]), run.get("starts", 1))

    by_case = {case: of_case for case in cases if (of_case := [run for run in runs if run["case"] == case.name])}
    with_settings = f"All runs have {', '.join(f'`{setting}`' for setting in settings)}, whatever their scene says.\n"
    ordered = [run for of_case in by_case.values() for run in of_case]
    missing = list(missing_runs(runs, cases))
    sections = []
    for case, of_case in by_case.items():
        picture = folder / "figures" / f"{case.name}.png"
        curves.draw(of_case, picture)
        sections.append(case_section(case, of_case, judge, is_old, picture.exists()))
    write_whole(folder / "report.md", document(
        head, with_settings if settings else "", front, section("Beside the other settings", held_against),
        section("Verdicts", verdict_table(ordered, judge, is_old), f"{OLD}." if any(map(is_old, runs)) else "",
                "\n".join(f"* {line}" for line in judge.now_pass(runs))),
        section("Not run", NOT_RUN, markdown(("case", "resolution", "spacing", "CPU time, about"), missing))
        if missing else "",
        "## Cases\n", *sections, machine_section(runs)))
