"""What the runs found: stability.csv, the sweeps, the summary."""

import csv
import io
import os

import runs
import settings

COLUMNS = (
    "case,setting,model,steps,max_density_error,energy_ratio,lost_particles,nonfinite,max_displacement_over_spacing,"
    "pass,remark"
).split(",")


def read_runs(folder, plan_of_runs):
    """Of the plan, in its order; a run without result is left out."""
    found = {}
    for case, name in plan_of_runs:
        run = runs.read_run(folder / f"{case.name}-{name}.json")
        if run is not None:
            found[case.name, name] = run
    return found


def number(value):
    return f"{value:.4g}" if isinstance(value, (int, float)) else str(value)


def percent(value):
    return f"{100 * value:.2g} %" if isinstance(value, (int, float)) else str(value)


def broken(run):
    return [check for check in run["checks"] if not check["pass"]]


def remark(run):
    parts = [
        f"{check['name']} {number(check['value'])} (must be {check['rule']}){' known' if check['known'] else ''}"
        for check in broken(run)
        if check["name"] != "given_up"
    ]
    if run["failure"]:
        parts.append("given up: " + run["failure"])
    if isinstance(run["max_density_error"], (int, float)) and run["max_density_error"] > 0.01:
        parts.append(f"single particles compressed by up to {percent(run['max_density_error'])}")
    return "; ".join(parts + run["remarks"])


def write_whole(file, data):
    """A reader never meets half a file."""
    part = file.with_name(file.name + f".part{os.getpid()}")
    part.write_bytes(data if isinstance(data, bytes) else data.encode())
    part.replace(file)


def write_csv(found, file):
    """max_density_error is that of the mean over the particles, which the rule is about; single ones are in the remark."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    for run in found.values():
        numbers = [run["mean_density_error"], run["energy_ratio"], run["lost_particles"], run["nonfinite"]]
        row = [run["case"], run["setting"], run["model"], run["steps"]] + [number(value) for value in numbers]
        row += [number(run["max_displacement_over_spacing"]), "yes" if run["pass"] else "no", remark(run)]
        writer.writerow(row)
    write_whole(file, text.getvalue())


# What any flow must keep. Rules of single cases measure quality, such as noise, and are not about stability.
STABILITY_RULES = ("given_up", "nonfinite", "lost_particles", "mean_density_error", "energy_ratio")


def is_stable(run):
    return all(check["pass"] for check in run["checks"] if check["name"] in STABILITY_RULES)


def largest_stable(found, case, sweep):
    """(largest value up to which all are stable, the value after it with its run) of the runs there are, or None."""
    _, values = settings.SWEEPS[sweep]
    largest = None
    for value in values:
        run = found.get((case, settings.sweep_name(sweep, value)))
        if run is None:
            return None
        if not is_stable(run):
            return largest, (value, run)
        largest = value
    return largest, None


def print_summary(plan_of_runs, found):
    """Prints what was broken; the exit code."""
    counts = {"pass": 0, "known": 0, "long_steps": 0, "fail": 0}
    bad = []
    for case, name in plan_of_runs:
        run = found.get((case.name, name))
        if run is None:
            bad.append(f"{case.name} {name}: no result, see its .log")
            continue
        counts[run["verdict"]] += 1
        if run["verdict"] == "fail" and name == "default":
            bad.append(f"{case.name}: {remark(run)}")
    print(
        f"{counts['pass']} runs keep all rules, {counts['known']} break one as known, {counts['long_steps']} only move "
        f"more than half a spacing in a step, {counts['fail']} fail"
    )
    for line in bad:
        print(f"  {line}")
    return 1 if bad else 0
