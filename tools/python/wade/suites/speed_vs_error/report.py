"""report.md: what to choose for a given error, where the default lies, and what the numbers are made of; and its plots
of error over cost, with the front drawn and labelled.
"""

import math
import re
import shutil

from wade.reports.files import PUBLISHED, write_whole
from wade.reports.machine import machine_line
from wade.reports.plots import pyplot, save
from wade.reports.tables import document, markdown, section
from wade.suites.speed_vs_error.settings import default_setting
from wade.suites.speed_vs_error.table import ERRORS, cheapest_below, distance_to_front, front, is_default

TITLE, PICTURE = "Beside SPlisHSPlasH", "beside_splishsplash.png"  # of a section that other runs make

MARKERS = {"dfsph": "o", "kinematic": "D", "shallow_water": "s", "steering": "^", "mixed": "P"}
COLOURS = ("#1b6ca8", "#d1701f", "#3a8a4d", "#8a4d9e", "#777777")

WORDS = {
    "impulse_median": "impulse on standing agents: median relative error",
    "impulse_p95": "impulse on standing agents: 95th percentile of the relative error",
    "outcome_changed": "share of walking agents with another outcome",
    "end_place_median": "last place of walking agents: median distance from the true one, m",
    "depth_l1": "L1 error of depth / H",
    "speed_l1": "L1 error of speed / sqrt(g H)",
    "height_rms_*": "RMS error of the heights at the gauges / 0.55 m, mean of the gauges",
    "pressure_rms_*": "RMS error of the pressure, mean of P1 and P3",
    "pressure_peak_p*": "relative error of the pressure's peak, mean of P1 and P3",
    "depth_l2": "L2 error of the depth",
    "depth": "relative error of the depth",
    "period": "relative error of the period",
    "pressure_rms": "RMS error of the pressure / rho g H",
    "rms_speed": "RMS speed of water at rest / sqrt(g H)",
    "closure": "momentum budget of the block: what is missing of the force",
}


def words(metric):
    return WORDS.get(metric, metric.rstrip("_*").replace("_", " "))


def plot_name(group):
    return f"{group.case}-{group.metric.rstrip('_*')}.png"


PLOTTED = ("impulse_front",)


def has_plot(group):
    """The main error of some cases has one; a logarithmic axis needs two errors above 0."""
    main = group.case in PLOTTED and group.metric == ERRORS[group.case][0]
    return main and sum(e is not None and e > 0 for e in group.errors) >= 2


def plot(group, file):
    """Draws one group. Errors of 0 do not fit on a logarithmic axis and are left out; the table has them."""
    figure, axes = pyplot.subplots(figsize=(8.8, 4.4))
    shown = [(p, e, f) for p, e, f in zip(group.points, group.errors, group.flags) if e is not None and e > 0]
    spacings = sorted({p.setting.spacing for p in group.points}, reverse=True)
    for k, spacing in enumerate(spacings):
        here = [(p, e) for p, e, _ in shown if p.setting.spacing == spacing]
        colour = COLOURS[k % len(COLOURS)]
        for model, marker in MARKERS.items():
            some = [(p, e) for p, e in here if p.setting.model == model]
            if some:
                label = f"d = {spacing:g} m" + ("" if model == "dfsph" else f", {model.replace('_', ' ')}")
                axes.scatter([p.cpu for p, _ in some], [e for _, e in some], s=26 if model == "dfsph" else 34,
                             marker=marker, color=colour, alpha=0.75, linewidths=0, label=label)
        for p, e in here:
            if is_default(p.setting):
                lo, hi = group.spread.get(spacing, (e, e))
                axes.plot([p.cpu, p.cpu], [max(lo, 1e-3 * hi), hi], color=colour, linewidth=1.2)
                axes.scatter([p.cpu], [e], s=110, marker="o", facecolors="none", edgecolors=colour, linewidths=1.4)
    for p, bounds in zip(group.points, group.ranges):
        if bounds and bounds[0] > 0:
            colour = COLOURS[spacings.index(p.setting.spacing) % len(COLOURS)]
            axes.plot([p.cpu, p.cpu], bounds, color=colour, linewidth=0.8)
    best = sorted(((p.cpu, e, p) for p, e, f in shown if f), key=lambda b: b[:2])
    if best:
        axes.plot([c for c, _, _ in best], [e for _, e, _ in best], color="black", linewidth=1, zorder=0, label="front")
    axes.set_xscale("log")
    axes.set_yscale("log")
    names = []
    for k, (cost, error, p) in enumerate(best, start=1):
        name = p.setting.label(default_setting(p.setting.case, p.setting.spacing))
        names.append(f"{k}: d {p.setting.spacing:g}, {name}")
        axes.annotate(str(k), (cost, error), textcoords="offset points", xytext=(-9, -9), fontsize=8, weight="bold")
    axes.text(1.02, 0.0, "\n".join(names), transform=axes.transAxes, fontsize=7, va="bottom", ha="left")
    axes.set_xlabel("CPU seconds per simulated second")
    axes.set_ylabel(words(group.metric), fontsize=8)
    axes.set_title(f"{group.case}: error over cost (ring: default; bars: chance)", fontsize=10)
    axes.grid(True, which="both")
    axes.margins(x=0.15, y=0.12)
    axes.legend(fontsize=7, bbox_to_anchor=(1.01, 1), loc="upper left")
    save(figure, file, dpi=90)


LIMITS = (0.5, 0.3, 0.2, 0.1, 0.05, 0.03, 0.02, 0.01)


def cost_text(cost):
    return f"{cost:.3g} s"


def name_of(point):
    s = point.setting
    return f"d = {s.spacing:g} m, {s.label(default_setting(s.case, s.spacing))}"


def choice_table(group):
    """For an error below x choose this: a row where the choice changes, with the strictest limit that it keeps."""
    rows = []
    choices = [(limit, cheapest_below(group.pairs(), limit)) for limit in LIMITS]
    for k, (limit, best) in enumerate(choices):
        if best is None:
            smallest = min((e for e in group.errors if e is not None), default=None)
            if smallest is not None:
                rows.append((f"{limit:g}", f"nothing measured here; the smallest error is {smallest:.3g}", "", "", ""))
            break
        if k + 1 < len(choices) and choices[k + 1][1] == best:
            continue
        p = group.points[best]
        error = f"{group.errors[best]:.3g}"
        if group.ranges[best] and group.ranges[best][0] < group.ranges[best][1]:
            error += " ({:.3g} to {:.3g} by seed)".format(*group.ranges[best])
        rows.append((f"{limit:g}", name_of(p), error, cost_text(p.cpu), p.particles))
    return markdown(("for an error below", "choose", "error", "CPU s per simulated s", "particles"), rows)


def default_lines(group):
    """Where the default lies relative to the front of DFSPH, at each spacing, and which other model beats it."""
    lines = []
    solved = [(p.cpu, e if p.setting.model == "dfsph" else None) for p, e in zip(group.points, group.errors)]
    flags = front(solved)
    for i, point in enumerate(group.points):
        if not is_default(point.setting) or group.errors[i] is None:
            continue
        d = point.setting.spacing
        at = f"* d = {d:g} m: the default (error {group.errors[i]:.3g}, {cost_text(point.cpu)} per simulated second) "
        if flags[i]:
            lines.append(at + "lies on the front of DFSPH" + other_model(group, i) + ".")
            continue
        cost, error = distance_to_front(solved, i)
        text = at + "is off the front of DFSPH"
        if cost > 1.05:
            cheaper = group.points[cheapest_below(solved, group.errors[i])]
            text += f"; {name_of(cheaper)} is at most as wrong and {cost:.2g} times cheaper"
        best = group.errors[i] / error
        if error > 1.05 and best < group.spread.get(d, (float("inf"), 0))[0]:
            text += f"; at no more than its cost there is an error {error:.2g} times smaller"
        elif error > 1.05:
            text += "; at no more than its cost no error is smaller by more than chance"
        if cost <= 1.05 and error <= 1.05:
            text += ", by less than 5 % in cost and error"
        lines.append(text + other_model(group, i) + ".")
    for d, (lo, hi) in group.spread.items():
        lines.append(f"* d = {d:g} m, chance: the default with gravity changed by 0.01 % has errors from {lo:.3g} to "
                     f"{hi:.3g}; smaller differences between settings say nothing.")
    return lines


def other_model(group, index):
    """The cheapest point of another model that is at most as wrong as a point, in words; empty if there is none cheaper."""
    others = [(p.cpu, e if p.setting.model != "dfsph" else None) for p, e in zip(group.points, group.errors)]
    best = cheapest_below(others, group.errors[index])
    if best is None or group.points[best].cpu >= group.points[index].cpu:
        return ""
    times = group.points[index].cpu / group.points[best].cpu
    return f"; of the other models {name_of(group.points[best])} is at most as wrong and {times:.2g} times cheaper"


def thread_lines(group):
    """What a second thread does to wall time and to CPU time."""
    by_setting = {p.setting: p for p in group.points if not p.failure}
    lines = []
    for setting, point in by_setting.items():
        one = next((p for s, p in by_setting.items() if setting.threads > 1 and s.threads == 1
                    and s.overrides() == setting.overrides() and s.spacing == setting.spacing), None)
        if one:
            lines.append(f"* d = {setting.spacing:g} m ({point.particles} particles), {setting.threads} threads: "
                         f"{one.wall / point.wall:.2f} times as fast on the wall clock for {point.cpu / one.cpu:.2f} "
                         "times the CPU time.")
    return lines


def layer_table(group):
    """What each spacing costs and gives with the default settings, beside the coarsest."""
    points = [(p, e) for p, e in zip(group.points, group.errors) if is_default(p.setting) and e is not None]
    points.sort(key=lambda pair: -pair[0].setting.spacing)
    if len(points) < 2:
        return ""
    rows = [(f"{p.setting.spacing:g} m", p.particles, cost_text(p.cpu), f"{p.cpu / points[0][0].cpu:.3g}", f"{e:.3g}")
            for p, e in points]
    return markdown(("spacing", "particles", "CPU s per simulated s", "times the coarsest", "error"), rows)


HEAD = """\
Cost is CPU time of the solver per simulated second, median of the repeats, so that it depends little on what else the machine
does. A point is on the front if no other point of its case is at most as dear and at most as wrong, and better in one of both.
One factor at a time was varied around the default of the scene schema, then those changes were joined that lie within 10 % of
the front alone; a finer spacing takes the settings on the front of the coarser one. In the plots a ring marks the default, its
bar what chance does to it. The point of another model than DFSPH is the median of five seeds, its bar their range; of people
who walk it is that of the scene's seed, which moves their markers too. `tol` and `it` are the tolerance of the density solve
and its fewest iterations, `div` the tolerance of the divergence solve, `cfl` the CFL number.

The impulse on an agent is the time integral of the momentum of the particles that touch it (Eq. 5), kg m; its error is the
distance from that of our own finest run, relative to the time integral of the momentum's magnitude there. The finest run is no
truth, and its spacing is not far from the fine one here: errors at the fine spacing are lower bounds."""


def titled(title, text):
    return f"{title[0].upper()}{title[1:]}:\n\n{text}" if text else ""


def case_sections(groups):
    """A section a case, with a part an error."""
    for case in dict.fromkeys(group.case for group in groups):
        of_case = [group for group in groups if group.case == case]
        failed = [f"* {name_of(p)}: {p.failure}" for p in of_case[0].points if p.failure]
        yield section(case, titled("spacing with the default settings", layer_table(of_case[0])),
                      titled("threads", "\n".join(thread_lines(of_case[0]))),
                      titled("settings that failed", "\n".join(failed)),
                      *(section(words(group.metric), *parts_of(group), level=3) for group in of_case))


def parts_of(group):
    picture = f"![{group.case}, {group.metric.rstrip('_*')}]({plot_name(group)})" if has_plot(group) else ""
    return picture, choice_table(group), titled("the default", "\n".join(default_lines(group)))


def write(out, groups, remarks, quick):
    """report.md and its pictures."""
    for group in filter(has_plot, groups):
        plot(group, out / plot_name(group))
    command = f"`tools/wade speed-vs-error{' --quick' if quick else ''}`"
    if quick:
        remarks = ["What chance does to the errors was not measured (--quick).", *remarks]
    write_whole(out / "report.md", document(
        section("Speed against error", f"Written by {command}. Machine: {machine_line()}", HEAD, level=1),
        overall_section(groups), *case_sections(groups),
        section("Remarks", "\n".join(f"* {remark}" for remark in remarks))))


RATIO_LIMIT = 10  # a ratio of errors counts no more than this, so that an error near zero does not decide a mean


def beyond_chance(error, lo, hi):
    """Returns an error over that of the default, which chance varies from lo to hi: 1 within that range."""
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
                found.setdefault(label, []).append((group.case, group.metric.rstrip("_*"), spacing,
                                                    point.cpu / base.cpu, beyond_chance(error, lo, hi)))
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
    """Returns the section on settings that were measured in every case of the default; "" without such a case."""
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


def with_section(text, part):
    """Returns a report with its section replaced by `part`, or with `part` at its end."""
    found = re.search(rf"^## {TITLE}\n.*?(?=^## |\Z)", text, re.M | re.S)
    if found:
        return text[: found.start()] + part.rstrip("\n") + "\n\n" * bool(text[found.end():]) + text[found.end():]
    return text.rstrip("\n") + "\n\n" + part


def carry_over(out):
    """Copies the published section, which other runs made, into a new report of the sweep."""
    home = PUBLISHED / "speed_vs_error"
    found = re.search(rf"^## {TITLE}\n.*?(?=^## |\Z)", (home / "report.md").read_text(encoding="utf-8"), re.M | re.S)
    if found:
        write_whole(out / "report.md", with_section((out / "report.md").read_text(encoding="utf-8"), found[0]))
        shutil.copyfile(home / PICTURE, out / PICTURE)
