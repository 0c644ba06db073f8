"""All cases in one table: what a setting of DFSPH costs and how wrong it is beside the default."""

import math

from wade.reports.tables import markdown, section
from wade.suites.speed_vs_error.settings import default_setting
from wade.suites.speed_vs_error.table import is_default

RATIO_LIMIT = 10  # a ratio of errors counts no more than this, so that an error near zero does not decide a mean


def beyond_chance(error, lo, hi):
    """An error over that of the default, whose error is lo to hi by chance: 1 within that range."""
    if error > hi:
        return min(error / hi, RATIO_LIMIT) if hi > 0 else RATIO_LIMIT
    if error < lo:
        return max(error / lo, 1 / RATIO_LIMIT)
    return 1.0


def comparisons(groups):
    """label -> list of (case, metric, spacing, cost over default, error over default); only where chance was measured."""
    found = {}
    for group in groups:
        for base, base_error in zip(group.points, group.errors):
            spacing = base.setting.spacing
            if not is_default(base.setting) or base_error is None or spacing not in group.spread:
                continue
            lo, hi = group.spread[spacing]
            for point, error in zip(group.points, group.errors):
                s = point.setting
                if s.model != "dfsph" or s.threads != 1 or s.spacing != spacing or error is None or is_default(s):
                    continue
                label = s.label(default_setting(s.case, s.spacing))
                found.setdefault(label, []).append(
                    (group.case, group.metric.rstrip("_*"), spacing, point.cpu / base.cpu,
                     beyond_chance(error, lo, hi)))
    return found


def geometric_mean(values):
    return math.exp(sum(math.log(v) for v in values) / len(values))


def mean_by_case(rows, column):
    """Each case counts once, however many errors and spacings it has."""
    by_case = {}
    for row in rows:
        by_case.setdefault(row[0], []).append(row[column])
    return geometric_mean([geometric_mean(values) for values in by_case.values()])


def overall_section(groups):
    """Settings that were measured in all cases in which the default was; empty if there is no such case."""
    found = comparisons(groups)
    cases = {row[0] for rows in found.values() for row in rows}
    complete = {label: rows for label, rows in found.items() if {row[0] for row in rows} == cases}
    if not complete:
        return ""
    rows = [(1.0, "default", "1.00", "1.00", "", "")]
    for label, measured in complete.items():
        case, metric, spacing, _, ratio = max(measured, key=lambda row: row[4])
        worse = sum(row[4] > 1 for row in measured)
        worst = f"{ratio:.2g} times in {case}, {metric}, d = {spacing:g} m" if ratio > 1 else ""
        cost, error = mean_by_case(measured, 3), mean_by_case(measured, 4)
        rows.append((cost, label, f"{cost:.2f}", f"{error:.2f}", f"{worse} of {len(measured)}", worst))
    note = (
        f"Geometric means over {len(cases)} cases ({', '.join(sorted(cases))}), each counted once, of all its errors "
        "and spacings. An error within what chance does to the default's counts as no difference; a ratio counts as "
        f"{RATIO_LIMIT} at most. `worse`: in how many errors the setting is worse than the default by more than "
        "chance.")
    head = ("setting", "CPU time, of the default's", "error, of the default's", "worse", "worst")
    ordered = [row[1:] for row in sorted(rows, key=lambda row: row[0])]
    return section("DFSPH: settings beside the default, over all cases", note, markdown(head, ordered))
