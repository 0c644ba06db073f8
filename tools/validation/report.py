"""report.md: a table of verdicts, and a section a case."""

import math

import convergence
import plots
from results import exact
from run_folder import write_whole

WORDS = {"yes": "pass", "no": "**FAIL**", "known": "**FAIL** (known)", "": ""}


def short(value):
    return "-" if value is None else f"{value:.3g}"


def by_case(runs, cases):
    for case in cases:
        of_case = [run for run in runs if run["case"] == case.name]
        if of_case:
            yield case, of_case


def spacing(run):
    return f"{run['spacing_m']:g} m" if run["spacing_m"] else "-"


def verdict_table(runs, cases, judge, fingerprint_of):
    yield "| case | resolution | spacing | particles | thresholds kept | missed |"
    yield "|---|---|---|---|---|---|"
    for case, of_case in by_case(runs, cases):
        for run in of_case:
            verdicts = [(metric, judge.verdict(run, metric)) for metric in run["metrics"]]
            kept = sum(verdict == "yes" for _, verdict in verdicts)
            judged = sum(verdict != "" for _, verdict in verdicts)
            missed = []
            for metric, verdict in verdicts:
                if verdict in ("no", "known"):
                    limit = short(judge.threshold(run, metric))
                    known = ", known" if verdict == "known" else ""
                    missed.append(f"**{metric['name']}** {short(metric['value'])} (limit {limit}{known})")
            if run["status"] != "completed":
                missed = [f"**did not complete**: {run['error']}"]
            mark = "" if run["fingerprint"] == fingerprint_of(run["case"]) else " \\*"
            yield (
                f"| [{case.name}](#{case.name}) | {run['level']}{mark} | {spacing(run)} | {run['particles']} | "
                f"{kept} of {judged} | {'; '.join(missed)} |"
            )


def metric_table(runs, judge):
    """A row a metric, a column a resolution."""
    names = list(dict.fromkeys(metric["name"] for run in runs for metric in run["metrics"]))
    yield "| | unit | " + " | ".join(f"{run['level']}, {spacing(run)}" for run in runs) + " | order | limit |"
    yield "|---|---|" + "---|" * len(runs) + "---|---|"
    for name in names:
        cells, values, unit, limits = [], [], "", []
        for run in runs:
            metric = next((m for m in run["metrics"] if m["name"] == name), None)
            if metric is None:
                cells.append("")
                values.append(None)
                continue
            unit = "" if metric["unit"] == "1" else metric["unit"]
            word = WORDS[judge.verdict(run, metric)]
            cells.append(f"{short(metric['value'])} {word}".strip())
            values.append(metric["value"])
            limits.append(judge.threshold(run, metric))
        judged = any(limit is not None for limit in limits)
        slope = convergence.order([run["spacing_m"] for run in runs], values) if judged else None
        order = f"{slope:.1f}" if slope is not None else "-" if judged else ""
        limit = " / ".join(dict.fromkeys(short(limit) for limit in limits)) if judged else "reported"
        yield f"| {name} | {unit} | " + " | ".join(cells) + f" | {order} | {limit} |"


def cost_table(runs):
    yield "| resolution | particles | steps | simulated | CPU s for 1 s | particle steps per CPU s |"
    yield "|---|---|---|---|---|---|"
    for run in runs:
        time, cpu = run["simulated_s"], run["solver_cpu_s"]
        rate = short(cpu / time) if time else "-"
        work = f"{run['particle_steps'] / cpu:,.0f}" if cpu and run["particle_steps"] else "-"
        yield f"| {run['level']} | {run['particles']} | {run['steps']} | {time:g} s | {rate} | {work} |"


def case_section(case, runs, judge, fingerprint_of, picture):
    yield f"### {case.name}"
    yield ""
    yield runs[-1]["truth"]
    yield ""
    for run in runs:
        if run["status"] != "completed":
            yield f"**{run['level']} did not complete**: {run['error']}"
            yield ""
    yield from metric_table(runs, judge)
    yield ""
    reasons = [(name, reason) for (owner, name), reason in judge.reasons.items() if owner == case.name]
    if reasons:
        yield "Limits: " + "; ".join(f"{name}: {reason}" for name, reason in reasons) + "."
        yield ""
    for (owner, metric, level), (guard, reason) in judge.guards.items():
        if owner == case.name:
            yield f"Known to be missed: {metric} at {level}, up to {exact(guard)}: {reason}."
            yield ""
    yield from cost_table(runs)
    yield ""
    old = [run for run in runs if run["fingerprint"] != fingerprint_of(run["case"])]
    if old:
        yield "\\* by another version of the program: " + ", ".join(f"{run['level']} {run['git']}" for run in old) + "."
        yield ""
    if picture:
        yield f"![{case.name}](figures/{case.name}.png)"
        yield ""


def seconds_expected(runs, spacing):
    """CPU time at a spacing that was not run, s: by the power law of the two finest runs, or with the particles of a volume,
    d^-3, and the steps, 1/d. None without a run."""
    done = sorted((run["spacing_m"], run["solver_cpu_s"]) for run in runs if run["status"] == "completed" and run["spacing_m"])
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
    """Rows of the runs that there are none of."""
    for case in cases:
        of_case = [run for run in runs if run["case"] == case.name]
        done = {run["level"] for run in of_case}
        for level, d in zip(case.levels, case.spacings):
            if level not in done:
                yield f"| {case.name} | {level} | {d:g} m | {time_text(seconds_expected(of_case, d))} |"


HEAD = """# Validation

Each case is a simulation whose truth is known. Its error is measured at up to three resolutions and judged by thresholds that
were written down before the results (`tests/validation/thresholds.csv`, with their reasons). A threshold that is missed is
a failure, also if it is known (`tests/validation/known_failures.csv`). Errors are ratios unless a unit is given. The order is
the slope of the straight line through log(error) over log(spacing) of three resolutions; "-" where the errors do not
fall with the spacing or are at the level of noise.

`tools/validate.sh` writes this file; `validation.csv` holds the same numbers.
"""


NOT_RUN = """Runs that this report has no result of, and the CPU time they would take by what the others took. `tools/validate.sh
--cases NAME --levels LEVEL` makes one; those that take hours need `--long`."""


def several_threads(runs):
    for run in runs:
        if run["threads"] > 1:
            yield f", but {run['threads']} in {run['case']} {run['level']}"


def machine_lines(runs):
    seen = dict.fromkeys((run["processor"], run["processors"], run["compiler"], run["version"], run["git"]) for run in runs)
    for processor, count, compiler, version, git in seen:
        yield f"* {processor}, {count} processors; compiler {compiler}; version {version}, commit {git}."
    yield ""
    yield "CPU times are of the solver, without set-up and measurement; runs beside one another slow each other down."
    yield f"Each run had one thread{''.join(several_threads(runs))}."


def write(runs, cases, judge, fingerprint_of, folder, settings=(), held_against=()):
    """settings: of all runs, as --set has them; held_against: lines about another folder of runs, or none."""
    figures = folder / "figures"
    figures.mkdir(exist_ok=True)
    lines = [HEAD]
    if settings:
        lines += [f"All runs have {', '.join(f'`{setting}`' for setting in settings)}, whatever their scene says.", ""]
    if held_against:
        lines += ["## Beside the other settings", "", *held_against]
    lines += ["## Verdicts", ""]
    lines += verdict_table(runs, cases, judge, fingerprint_of)
    if any(run["fingerprint"] != fingerprint_of(run["case"]) for run in runs):
        lines += ["", "\\* by another version of the program."]
    now_pass = [f"* {line}" for line in judge.now_pass(runs)]
    lines += ["", *now_pass] if now_pass else []
    missing = list(missing_runs(runs, cases))
    if missing:
        lines += ["", "## Not run", "", NOT_RUN, "", "| case | resolution | spacing | CPU time, about |", "|---|---|---|---|"]
        lines += missing
    lines += ["", "## Cases", ""]
    for case, of_case in by_case(runs, cases):
        png, picture = plots.draw(of_case), figures / f"{case.name}.png"
        if png:
            write_whole(picture, png)
        lines += case_section(case, of_case, judge, fingerprint_of, picture.exists())
    lines += ["## Machine", ""]
    lines += machine_lines(runs)
    write_whole(folder / "report.md", "\n".join(lines) + "\n")
