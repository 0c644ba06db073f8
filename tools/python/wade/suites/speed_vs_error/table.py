"""speed_vs_error.csv, a line a point and error metric, and the front of undominated points: no other one is at most as
expensive and at most as wrong, and better in one of both.
"""

from dataclasses import dataclass

from wade.reports.tables import number, write_csv
from wade.suites.speed_vs_error.settings import default_setting

def front(points):
    """Flags, one a point: whether it lies on the front.

    points: list of (cost, error); a point with an error of None is not compared and never on the front. Points that are
    equal in both do not exclude each other.
    """
    known = [(c, e) for c, e in points if e is not None]
    flags = []
    for cost, error in points:
        if error is None:
            flags.append(False)
            continue
        flags.append(not any(c <= cost and e <= error and (c < cost or e < error) for c, e in known))
    return flags


def cheapest_below(points, limit):
    """Index of the cheapest point with an error of at most `limit`, or None.

    points: as above.
    """
    fitting = [(cost, error, i) for i, (cost, error) in enumerate(points) if error is not None and error <= limit]
    return min(fitting)[2] if fitting else None


def distance_to_front(points, index):
    """How far a point lies from the front, as two factors of at least 1.

    (cost of the point / cost of the cheapest point that is at most as wrong,
     error of the point / smallest error of the points that are at most as expensive)
    """
    cost, error = points[index]
    cheapest = cheapest_below(points, error)
    best = min(e for c, e in points if e is not None and c <= cost)
    return cost / points[cheapest][0], (error / best if best > 0 else 1.0)


HEADER = (
    "case,model,spacing_m,tolerance,cfl,threads,particles,cpu_s_per_sim_s,wall_s_per_sim_s,particle_steps_per_s,"
    "error_metric,error,on_front,min_iterations,divergence_tolerance,kernel,repeats,is_default,failure"
).split(",")

IMPULSE_ERRORS = ("impulse_median", "impulse_p95", "outcome_changed", "end_place_median")

# The errors of each case, the main one first. A name that ends in '*' is the mean over all metrics that begin so.
ERRORS = {
    "impulse_river": IMPULSE_ERRORS,
    "impulse_front": IMPULSE_ERRORS,
    "impulse_lee": IMPULSE_ERRORS,
    "dam_break": ("depth_l1", "speed_l1"),
    "spheric2": ("height_rms_*", "pressure_rms_*", "pressure_peak_p*"),
    "bump_subcritical": ("depth_l2",),
    "bump_transcritical": ("depth_l2",),
    "bump_jump": ("depth_l2",),
    "block": ("closure",),
    "sloshing": ("period",),
    "uniform_river": ("depth",),
    "column": ("pressure_rms", "rms_speed"),
}


@dataclass
class Group:
    """The points of one case and one error metric, in one order; all lists have an entry a point."""

    case: str
    metric: str
    points: list  # Measured
    errors: list  # None where there is none
    flags: list  # on the front
    spread: dict  # spacing -> smallest and largest error of the default and its probes
    ranges: list  # smallest and largest error over the seeds; None of a point that has no seeds

    def pairs(self):
        return [(p.cpu, e) for p, e in zip(self.points, self.errors)]


def error_of(metrics, name):
    """The value of an error, None where it was not measured."""
    if not name.endswith("*"):
        return metrics.get(name)
    values = [value for key, value in metrics.items() if key.startswith(name[:-1])]
    return sum(values) / len(values) if values and None not in values else None


def error_names(case, metrics):
    """The errors of a case that its runs report; none for a case that ERRORS does not know."""
    return [name for name in ERRORS.get(case, ()) if error_of(metrics, name) is not None]


def groups_of(measured):
    """Groups by case and metric, with the front of each."""
    groups = []
    for case in dict.fromkeys(p.setting.case for p in measured):
        all_points = [p for p in measured if p.setting.case == case]
        points = [p for p in all_points if not p.setting.gravity_change]
        names = error_names(case, next((p.metrics for p in points if p.metrics), {}))
        for name in names:
            errors = [error_of(p.metrics or {}, name) for p in points]
            flags = front([(p.cpu, e) for p, e in zip(points, errors)])
            ranges = [(p.ranges or {}).get(name) for p in points]
            groups.append(Group(case, name, points, errors, flags, spread_of(all_points, name), ranges))
    return groups


def spread_of(points, name):
    """What chance does to the error of the default; empty where no probes were run."""
    spread = {}
    for probe in (p for p in points if p.setting.gravity_change):
        d = probe.setting.spacing
        same = [p for p in points if p.setting.spacing == d and (p.setting.gravity_change or is_default(p.setting))]
        errors = [error_of(p.metrics or {}, name) for p in same]
        if None not in errors:
            spread[d] = (min(errors), max(errors))
    return spread


def is_default(setting):
    return setting.model == "dfsph" and setting == default_setting(setting.case, setting.spacing)


def exact(value):
    return number(value, 6, none="")


def row(point, metric, error, on_front):
    s = point.setting
    divergence = s.divergence_tolerance if s.divergence_tolerance == "off" else exact(s.divergence_tolerance)
    tolerance, cfl, solver = "", "", ["", "", ""]
    if s.model == "dfsph":
        tolerance, cfl, solver = exact(s.tolerance), exact(s.cfl), [s.min_iterations, divergence, s.kernel]
    costs = ["", ""] if point.failure else [exact(point.cpu), exact(point.wall)]
    return [
        s.case, s.model, f"{s.spacing:g}", tolerance, cfl, s.threads, point.particles, *costs,
        exact(point.rate) if point.rate > 0 else "", metric, exact(error), "yes" if on_front else "no",
        *solver, point.repeats, "yes" if is_default(s) else "no", point.failure,
    ]


def write_table(file, groups):
    rows = [row(point, group.metric.rstrip("_*"), error, flag) for group in groups
            for point, error, flag in zip(group.points, group.errors, group.flags)]
    write_csv(file, HEADER, rows)
