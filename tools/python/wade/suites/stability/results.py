"""The cases, the solver settings that a user may choose and the sweeps, which runs there are to do; and what the runs found:
stability.csv, the sweeps, the summary.
"""

from dataclasses import dataclass

from wade import plain_file
from wade.reports.files import say
from wade.reports.options import patterns_of
from wade.reports.tables import write_csv

CFL = "/fluid/cfl"
TOLERANCE = "/fluid/density_solve/tolerance"

# Name, what it sets, whether it is part of the quick form.
SETTINGS = {
    "default": ([], True),
    "cfl_0.25": ([f"{CFL}=0.25"], False),
    "cfl_1": ([f"{CFL}=1"], True),  # twice the default
    "cfl_2": ([f"{CFL}=2"], False),
    "tolerance_1e-2": ([f"{TOLERANCE}=1e-2"], False),
    "tolerance_1e-4": ([f"{TOLERANCE}=1e-4"], False),
    "no_divergence_solve": (["/fluid/divergence_solve/max_iterations=0"], False),
    "quartic_spline": (["/fluid/kernel=quartic_spline"], True),
    "wendland_c2": (["/fluid/kernel=wendland_c2"], False),
    "support_2.05": (["/fluid/support_in_spacings=2.05"], False),
    "support_2.2": (["/fluid/support_in_spacings=2.2"], False),
    "no_viscosity": (["/fluid/viscosity_m2_s=0"], False),
}

# Cases of the sweeps: a deep one, a violent one, a stream.
SWEPT_CASES = ("deep_column", "tank_3.6", "recirculating_quiet")
SWEEP_FRAMES = "/frame_rate_hz=5"  # a step ends with its frame at the latest: long frames leave it to the factor
SWEEPS = {
    "cfl": (CFL, ("0.1", "0.25", "0.5", "0.75", "1", "1.25", "1.5", "1.75", "2")),
    "tolerance": (TOLERANCE, ("1e-5", "1e-4", "5e-4", "1e-3", "2e-3", "5e-3", "1e-2", "2e-2", "5e-2", "1e-1")),
}


def sweep_name(sweep, value):
    return f"sweep_{sweep}_{value}"


def overrides_of(name):
    if name in SETTINGS:
        return SETTINGS[name][0]
    for sweep, (pointer, values) in SWEEPS.items():
        for value in values:
            if name == sweep_name(sweep, value):
                return [SWEEP_FRAMES, f"{pointer}={value}"]
    raise ValueError(f"--settings {name}: no such setting; allowed: {', '.join(SETTINGS)}")


class Case:
    """A line of `stability --list`: name, whether the solver settings matter, the trouble that it stands for."""

    def __init__(self, line):
        self.name, varied, self.trouble = line.split("\t")
        self.varied = varied == "varied"


def plan(cases, names, quick):
    """List of (case, setting): all of one setting, then of the next, so that the defaults come first."""
    chosen = patterns_of(names) or [name for name, (_, short) in SETTINGS.items() if short or not quick]
    for name in chosen:
        overrides_of(name)
    runs = [(case, name) for name in chosen for case in cases if case.varied or name == "default"]
    if quick or names:
        return runs
    swept = [case for case in cases if case.name in SWEPT_CASES]
    return runs + [(case, sweep_name(sweep, value)) for sweep, (_, values) in SWEEPS.items() for value in values
                   for case in swept]


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
    lines = plain_file.read_text(file).splitlines()[1:]
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
        checks = [check for run in found.values() if not run["failure"] for check in run["checks"]
                  if row.is_about(run, check)]
        if checks and all(check["pass"] for check in checks):
            values = ", ".join(number(check["value"]) for check in checks)
            form = next(iter(found.values()))["form"]  # a rule may be broken in another form only
            yield (f"known failure that now passes: {row.case} {row.setting}: {row.rule} = {values}, "
                   f"rule {checks[0]['rule']}, {form} form")


def number(value):
    return f"{value:.4g}" if isinstance(value, (int, float)) else str(value)


def percent(value):
    if not isinstance(value, (int, float)):
        return str(value)
    return f"{100 * value:.2g} %" if value < 0.995 else f"{100 * value:.0f} %"


def broken(run):
    return [check for check in run["checks"] if not check["pass"]]


def remark(run):
    parts = [f"{check['name']} {number(check['value'])} (must be {check['rule']}){' known' if check['known'] else ''}"
             for check in broken(run) if check["name"] != "given_up"]
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
    """Returns (largest value with stable runs up to it, next value with its run or None); None if a run is missing."""
    _, values = SWEEPS[sweep]
    largest = None
    for value in values:
        run = found.get((case, sweep_name(sweep, value)))
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
        if run["verdict"] == "fail" and name in SETTINGS:
            bad.append(f"{case.name} {name}: {remark(run)}")
    say(f"{counts['pass']} runs keep all rules, {counts['known']} break one as known, {counts['fail']} fail")
    for line in bad:
        say(f"  {line}")
    for line in now_pass(found, known):
        say(line)
    return 1 if bad else 0
