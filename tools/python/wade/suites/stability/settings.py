"""The cases, the solver settings that a user may choose, and the sweeps: which runs there are to do."""

from wade.reports.options import patterns_of

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
