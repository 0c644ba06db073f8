"""What the runs found: stability.csv, the sweeps, the summary."""

from dataclasses import dataclass

from wade.reports.files import say
from wade.reports.tables import write_csv
from wade.suites.stability import settings

COLUMNS = (
    "case,setting,model,steps,max_density_error,energy_ratio,lost_particles,nonfinite,max_displacement_over_spacing,"
    "pass,remark,mean_density_error"
).split(",")
NUMBERS = COLUMNS[4:9]


@dataclass(frozen=True)
class KnownFailure:
    case: str
    setting: str  # * = all
    rule: str  # name of the check
    guard: float  # the value may not be worse

    def is_about(self, run, check):
        return self.case == run["case"] and self.setting in ("*", run["setting"]) and self.rule == check["name"]


def read_known_failures(file):
    lines = file.read_text(encoding="utf-8").splitlines()[1:]
    rows = [line.split(",", 4) for line in lines if line]
    return [KnownFailure(row[0], row[1], row[2], float(row[3])) for row in rows]


def holds(check, bound):
    """Whether the value keeps the check's rule with another bound; a NaN keeps none."""
    value, sign = float(check["value"]), check["rule"].split(" ")[0]
    return {"<=": value <= bound, "<": value < bound, ">=": value >= bound}[sign]


def judge(run, known):
    """Sets what is a known failure and the verdict as the program does, by the table as it is now."""
    for check in run["checks"]:
        missed = not check["pass"]
        check["known"] = missed and any(k.is_about(run, check) and holds(check, k.guard) for k in known)
    if run["pass"]:
        run["verdict"] = "pass"
    elif all(check["pass"] or check["known"] for check in run["checks"]):
        run["verdict"] = "known"
    else:
        run["verdict"] = "fail"


def now_pass(found, known):
    """A line for each known failure that no run shows any more. Runs that were given up say nothing."""
    for row in known:
        checks = [
            check for run in found.values() if not run["failure"] for check in run["checks"] if row.is_about(run, check)
        ]
        if checks and all(check["pass"] for check in checks):
            values = ", ".join(number(check["value"]) for check in checks)
            form = next(iter(found.values()))["form"]  # a rule may be broken in another form only
            yield (
                f"known failure that now passes: {row.case} {row.setting}: {row.rule} = {values}, "
                f"rule {checks[0]['rule']}, {form} form"
            )


def number(value):
    return f"{value:.4g}" if isinstance(value, (int, float)) else str(value)


def percent(value):
    if not isinstance(value, (int, float)):
        return str(value)
    return f"{100 * value:.2g} %" if value < 0.995 else f"{100 * value:.0f} %"


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
    if run["max_density_error"]:
        mean, single = percent(run["mean_density_error"]), percent(run["max_density_error"])
        parts.append(f"compression {mean} as mean over the particles, {single} of single ones")
    return "; ".join(parts + run["remarks"])


def write_table(found, file):
    """Both density errors are max(0, rho / rho_0 - 1), the largest of all steps: max_density_error that of the worst single
    particle, mean_density_error the mean over the particles, which the rule is about."""
    rows = []
    for run in found.values():
        numbers = [run[key] for key in NUMBERS]
        rows.append([run["case"], run["setting"], run["model"], run["steps"], *map(number, numbers),
                     "yes" if run["pass"] else "no", remark(run), number(run["mean_density_error"])])
    write_csv(file, COLUMNS, rows)


# What any flow must keep. Rules of single cases measure quality, such as noise, and are not about stability.
STABILITY_RULES = ("given_up", "nonfinite", "lost_particles", "mean_density_error", "energy_ratio", "displacement")


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


def print_summary(plan_of_runs, found, known):
    """Prints what was broken; the exit code. The sweeps look for what breaks, so that nothing of theirs counts."""
    counts = {"pass": 0, "known": 0, "fail": 0}
    bad = []
    for case, name in plan_of_runs:
        run = found.get((case.name, name))
        if run is None:
            bad.append(f"{case.name} {name}: no result, see its .log")
            continue
        counts[run["verdict"]] += 1
        if run["verdict"] == "fail" and name in settings.SETTINGS:
            bad.append(f"{case.name} {name}: {remark(run)}")
    say(f"{counts['pass']} runs keep all rules, {counts['known']} break one as known, {counts['fail']} fail")
    for line in bad:
        say(f"  {line}")
    for line in now_pass(found, known):
        say(line)
    return 1 if bad else 0
