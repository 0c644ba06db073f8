"""Who arrives, is sheltered, lost, or has no end yet: a table of an ensemble with intervals over its runs.

Reads DIR as `tools/wade many` wrote it, or any folder with run folders in it. Writes table.csv, table.md and figures there
or into --out. Every number has its runs and people, and an interval or the reason why there is none.
"""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np

from wade import UsageError, progress
from wade.reports.files import say, write_whole
from wade.reports.options import above_0, some_of
from wade.reports.tables import count_of, document, listed, markdown, section, write_csv
from wade.statistics import drifts, losses
from wade.statistics.ensemble import (BY, FLOODED, IN_A_HOUSE, LOST, NO_END, SQUARE_M, classes, fates_of, having, open_kinds,
                                      read_ensemble)
from wade.statistics.shares import FIRST_LOOK, compared, runs_needed, share_of, share_of_runs
from wade.statistics.times import curves_of, fn_curve
from wade.terminal import Parser

COLUMNS = ("case,by,class,fate,runs,people,number,share,low,high,why_no_interval,runs_with_any,runs_with_any_low,"
           "runs_with_any_high,runs_needed").split(",")
COMPARED = ("first,second,by,class,fate,pairs,people,share_first,share_second,difference,low,high,people_for_one_more,"
            "people_low,people_high,why_no_interval").split(",")
HOW = """Intervals are of 95 %, over runs and never over people: Wilson's, with the design effect of the runs and Student's t of
their number. The people of a run share its water, so that a thousand people in one run are one case. Where something happens in no
run, or to all people of all runs, the interval is one-sided: *below* or *above*. Why a cell has no interval stands below the table;
the share of runs is exact (Clopper and Pearson)."""
CURVES = ("case", "curve", "time_s", "share", "low", "high", "runs", "people")
MOST_SECTIONS = 2  # of cases with a section and a figure each; more stand in one table and one figure
EPILOG = """Exit code: 0, or 2 for bad usage or a folder without complete runs."""


def percent(value):
    """A share as "8.3", of few more digits near 0 and 100, which stand for none and all but for errors of sums."""
    value = round(value, 9)
    if 0.001 <= value <= 0.999 or value in (0, 1):
        return f"{100 * value:.1f}"
    near = float(f"{100 * min(value, 1 - value):.2g}")
    return f"{near:g}" if value < 0.5 else f"{100 - near:.10g}"


def in_words(share, notes):
    """"82.0 % (75.1 to 87.4)", or with the mark of the note that says why there is no interval."""
    if share.low is not None:
        return f"{percent(share.mean)} % ({percent(share.low)} to {percent(share.high)})"
    if share.limit is not None:
        return f"{percent(share.mean)} % ({limit_words(share)})"
    return f"{percent(share.mean)} % ({notes.mark(share)})" if share.people else "-"


def limit_words(share):
    """"below 1.5 %" where it happens in no run, "above 98.5 %" where to all people of all runs."""
    return f"{'above' if share.runs_with_any else 'below'} {percent(share.limit)} %"


def of_runs(successes, runs):
    """"10.2 to 40.0 %" of a share of runs, "below 63.2 %" of none, "above 36.8 %" of all."""
    low, high = share_of_runs(successes, runs)
    return f"below {percent(high)} %" if successes == 0 else f"above {percent(low)} %" if successes == runs else \
        f"{percent(low)} to {percent(high)} %"


def spread_words(counts, size):
    """"3 to 8 of 20 a run"; one number where all runs have it."""
    most = "" if counts.min() == counts.max() else f" to {counts.max()}"
    return f"{counts.min()}{most} of {size.mean():g}" + (" a run" if len(counts) > 1 else "")


def refusal_words(share):
    """Why there is no interval, and what is known of runs instead."""
    if share.refused == "nobody" or share.runs == 1:
        return share.refused
    rare = share.runs_with_any <= share.runs_with_other
    of_any = of_runs(share.runs_with_any if rare else share.runs_with_other, share.runs)
    known = "it happens to somebody" if rare else "somebody is left out"
    return f"{share.refused}; in {of_any} of runs {known} (95 %)"


class Notes:
    """Reasons under a table, each once, marked a, b, c."""

    def __init__(self):
        self.lines = {}

    def mark(self, share):
        number = self.lines.setdefault(refusal_words(share), len(self.lines))
        return chr(ord("a") + number) if number < 26 else f"a{number}"

    def text(self):
        marks = (chr(ord("a") + k) if k < 26 else f"a{k}" for k in range(len(self.lines)))
        return "".join(f"* ({mark}) no interval: {words}\n" for mark, words in zip(marks, self.lines))


def shares_of(case, by):
    """[(class, {fate: (counts, people, Share)})], counts and people a number a run."""
    rows = []
    for name, here in classes(case, by):
        people = case.counts(here)
        of_fate = {}
        for fate in fates_of(case):
            counts = case.counts(here & having(case.people, fate))
            of_fate[fate] = counts, people, share_of(counts.tolist(), people.tolist())
        rows.append((name, of_fate))
    return rows


def rows_of(case, bys, width):
    """The lines of table.csv."""
    for by in bys:
        for name, of_fate in shares_of(case, by):
            for fate, (counts, people, share) in of_fate.items():
                needed = runs_needed(counts.tolist(), people.tolist(), width)
                low, high, why_not = share.low, share.high, share.refused
                if share.limit is not None:
                    low, high = (share.limit, 1.0) if share.runs_with_any else (0.0, share.limit)
                    why_not = f"one-sided: {share.refused}"
                yield (case.name, by, name, fate, share.runs, share.people, int(counts.sum()), share.mean, low, high,
                       why_not, share.runs_with_any, *share_of_runs(share.runs_with_any, share.runs), needed)


def why_no_class(case, by):
    """Why people are in no class, and the remedy, in words."""
    column = {"start": "start_x_m"}.get(by, by)
    if any(column not in run.columns for run in case.runs):
        return f"agents.csv has no column {column}; run them again with this version."
    if by == "skill":
        measured = case.manifest()["resolved_scene"]["crowd"].get("response") == "measured"
        return "they have a given endurance tau and no skill; allowed: " + (
            "groups without tau." if measured else "runs with --set /crowd/response=measured and groups without tau.")
    return f"{column} is empty in agents.csv."


def class_table(case, by):
    """Returns the Markdown table of the classes `by`, with the number of people in no class and the reason."""
    rows = shares_of(case, by)
    outside = int((~np.logical_or.reduce([here for _, here in classes(case, by)] or [np.zeros(len(case.people["run"]), bool)])).sum())
    why = f"By {by}: {outside} of {len(case.people['run'])} people are in no class: {why_no_class(case, by)}\n" if outside else ""
    if not rows:
        return why
    notes, lines, fates = Notes(), [], fates_of(case)
    for name, of_fate in rows:
        first = of_fate[fates[0]][2]
        lines.append([name, first.runs, first.people, *(in_words(of_fate[fate][2], notes) for fate in fates)])
    title = "" if by == "all" else by
    below = notes.text() + (f"\n{why}" if why else "")
    return markdown([title, "runs", "people", *fates], lines) + ("\n" + below if below else "")


def stop_text(case, width):
    """How many runs are needed, in words."""
    rows = shares_of(case, "all")[0][1]
    runs = len(case.runs)
    if runs < FIRST_LOOK:
        return f"How many runs are needed can be told from {FIRST_LOOK} runs on; there {'is' if runs == 1 else 'are'} {runs}.\n"
    lines = []
    for fate, (counts, people, share) in rows.items():
        needed = runs_needed(counts.tolist(), people.tolist(), width)
        wide = f"{100 * width:g} points wide"
        if needed is None:
            lines.append(f"* {fate}: cannot be told, {share.refused or 'nobody'}")
        elif needed <= runs:
            lines.append(f"* {fate}: enough, the interval is at most {wide}")
        else:
            lines.append(f"* {fate}: {needed - runs} more runs, {needed} in all, for an interval {wide}")
    return "\n".join(lines) + "\n"


def fn_text(case):
    """The FN curve as a table."""
    deaths = case.counts(case.people["dead"])
    rows = fn_curve(deaths)
    kept = rows if len(rows) <= 12 else [rows[k] for k in np.unique(np.linspace(0, len(rows) - 1, 12).round().astype(int))]
    lines = [[number, f"{percent(share)} %", of_runs(round(share * len(deaths)), len(deaths))] for number, share, _, _ in kept]
    return (f"Share of {count_of(len(deaths))} in which N people or more die, exact interval of each N by itself.\n\n"
            + markdown(["N", "runs with N dead or more", "95 %"], lines))


def pairs_of(first, second):
    """Indices of runs of the same seed in two cases; UsageError where there are none or people do not match."""
    common = sorted(set(first.seeds) & set(second.seeds))
    if not common:
        raise UsageError(f"{first.name} and {second.name} have no seed in common; run both with the same --seeds")
    chosen = [np.array([case.seeds.index(seed) for seed in common]) for case in (first, second)]
    everybody = [np.bincount(case.people["run"], minlength=len(case.runs))[index]
                 for case, index in zip((first, second), chosen)]
    if (everybody[0] != everybody[1]).any():
        raise UsageError(f"{first.name} and {second.name} differ in the number of people of a run; they cannot be paired")
    return chosen


FIRST_AND_SECOND = ("First: {}. Second: the setting of the row. Runs of the same seed are pairs. *Lost, at least* and *at most*: if of "
                    "those without an end yet all were lost in the first and none in the second, and the reverse.")
SAFE = "safe"
# Changes if all people without an end yet are lost in the first ensemble and none in the second, and the reverse.
LEAST, MOST = "lost, at least", "lost, at most"
SUMS = {
    SAFE: (lambda people: people["safe"],) * 2,
    LOST: (lambda people: people["dead"],) * 2,
    LEAST: (lambda people: ~people["safe"], lambda people: people["dead"]),
    MOST: (lambda people: people["dead"], lambda people: ~people["safe"]),
    NO_END: (lambda people: having(people, NO_END),) * 2,
}
UNDECIDED = "people without an end yet decide"


def needed(results):
    """The comparisons of a class, {fate: Comparison}, with the number needed of "lost" alone.

    It is given where the intervals of both bounds of the change of "lost" have one sign; its interval spans both.
    """
    bounds = [end for bound in (results[LEAST], results[MOST]) for end in (bound.low, bound.high)]
    decided = None not in bounds and (min(bounds) > 0 or max(bounds) < 0)
    for fate, result in results.items():
        numbers = dict.fromkeys(("per", "per_low", "per_high"))
        if fate == LOST and decided and result.difference:
            low, high = sorted((1 / abs(min(bounds)), 1 / abs(max(bounds))))
            numbers = {"per": 1 / abs(result.difference), "per_low": low, "per_high": high}
        refused = result.refused
        if fate == LOST and not decided and results[NO_END].first + results[NO_END].second > 0:
            refused = results[LEAST].refused or results[MOST].refused if None in bounds else UNDECIDED
        yield fate, replace(result, **numbers, refused=refused)


def compare(first, second, by):
    """[(class, fate, Comparison)] of SUMS and all fates."""
    chosen = pairs_of(first, second)
    others = dict(classes(second, by))
    for name, here in classes(first, by):
        if name not in others:
            continue
        people, results = first.counts(here)[chosen[0]].tolist(), {}
        for fate in dict.fromkeys([*SUMS, *fates_of(first, second)]):
            of_fate = SUMS.get(fate, (lambda all_people, fate=fate: having(all_people, fate),) * 2)
            counts = [case.counts(of_class & chosen_of(case.people))[index].tolist()
                      for case, index, of_class, chosen_of in zip((first, second), chosen, (here, others[name]), of_fate)]
            results[fate] = compared(*counts, people)
        for fate, result in needed(results):
            yield name, fate, result


def what_decides(*cases):
    """Returns sentences on what would decide for people without an end yet, by kind; "" if all have an end."""
    kinds = open_kinds(*cases)
    houses = [kind for kind in kinds if kind in IN_A_HOUSE]
    others = [kind for kind in kinds if kind not in IN_A_HOUSE]
    text = f"Longer runs decide for those who are {listed(others)}." if others else ""
    if houses:
        text += f" No longer run decides for those who are {listed(houses)}, as houses are not modelled."
    return text.strip()


def open_text(case):
    """The people without an end yet by kind, and what would tell their end; "" if all have one."""
    kinds = open_kinds(case)
    if not kinds:
        return ""
    shares = ", ".join(f"{percent(share)} % {kind}" for kind, share in kinds.items())
    flooded = case.people["fate"] == FLOODED
    deep = f" People {FLOODED} have up to {case.people['door_depth_m'][flooded].max():.1f} m of water at their door, and count as " \
           "neither safe nor lost." if flooded.any() else ""
    return f"Without an end yet at the end of the runs: {shares}. {what_decides(case)}{deep}\n"


def verdict(first, second):
    """What the comparison says of the lost, in words."""
    result = next(result for _, fate, result in compare(first, second, "all") if fate == LOST)
    if result.per is not None:
        less = "fewer" if result.difference < 0 else "more"
        return (f"One {less} is lost for {result.per:.3g} people who are warned or protected so ({result.per_low:.3g} to "
                f"{result.per_high:.3g}), whatever becomes of those without an end yet.")
    if not open_kinds(first, second):
        return ""
    ends = (", ".join(f"{percent(share)} {kind}" for kind, share in open_kinds(case).items()) or "none" for case in (first, second))
    words = " of 100; ".join(f"{name} {kinds}" for name, kinds in zip(("first", "second"), ends))
    if result.refused == UNDECIDED:
        return (f"Whether fewer are lost depends on those without an end yet ({words} of 100). {what_decides(first, second)} Until "
                "then this does not say which is better.")
    return f"Whether fewer are lost is not told: {result.refused}. Without an end yet: {words} of 100. {what_decides(first, second)}"


def comparison_text(first, second, bys):
    """A comparison as a section."""
    lines = []
    for by in bys:
        for name, fate, result in compare(first, second, by):
            if result.first == result.second == 0 and fate not in (SAFE, LOST):
                continue
            interval = "-" if result.low is None else f"{100 * result.low:+.1f} to {100 * result.high:+.1f}"
            per = "-" if result.per is None else f"{result.per:.3g}"
            if result.per_low is not None:
                per += f" ({result.per_low:.3g} to {result.per_high:.3g})"
            lines.append([name, fate, result.pairs, result.people, f"{percent(result.first)} %", f"{percent(result.second)} %",
                          f"{100 * result.difference:+.1f}", interval, per, result.refused or ""])
    folders = [case.runs[0].folder.parent for case in (first, second)]
    text = (f"First: {first.name} ({folders[0]}). Second: {second.name} ({folders[1]}). Runs of the same seed are pairs; t "
            "interval of the differences, in points of per cent. *Lost, at least* and *at most*: if of those without an end yet all "
            "were lost in the first and none in the second, and the reverse. *People for one more*: the number needed to warn (or to "
            "treat otherwise) so that one more or one less is lost, 1 over the difference; given where both bounds say so.\n")
    told = verdict(first, second)
    head = ["", "", "pairs", "people", "first", "second", "difference", "95 %", "people for one more", "why no interval"]
    return text + (f"\n{told}\n" if told else "") + "\n" + markdown(head, lines)


def compared_rows(first, second, bys):
    for by in bys:
        for name, fate, r in compare(first, second, by):
            yield (first.name, second.name, by, name, fate, r.pairs, r.people, r.first, r.second, r.difference, r.low, r.high,
                   r.per, r.per_low, r.per_high, r.refused)


def comparisons_of(ensemble, against):
    """[(first, second)]: each case with its like in another folder, or the first of the folder with each other one."""
    if against is None:
        pairs = [(ensemble.cases[0], other) for other in ensemble.cases[1:]]
        return [pair for pair in pairs if set(pair[0].seeds) & set(pair[1].seeds)]
    if len(ensemble.cases) == len(against.cases) == 1:
        return [(ensemble.cases[0], against.cases[0])]
    others = {case.name: case for case in against.cases}
    pairs = [(case, others[case.name]) for case in ensemble.cases if case.name in others]
    if not pairs:
        raise UsageError(f"--against {against.folder}: no case has the name of one in {ensemble.folder}")
    return pairs


def curve_rows(curves):
    """The lines of curves.csv, at most 500 a curve."""
    for case, of_case in curves.items():
        for name, curve in of_case.items():
            for k in np.unique(np.linspace(0, len(curve.times) - 1, 500).round().astype(int)):
                low, high = (None if end is None else float(end[k]) for end in (curve.low, curve.high))
                yield case, name, float(curve.times[k]), float(curve.share[k]), low, high, curve.runs, curve.people


def left_out_text(ensemble):
    return f"Left out: {ensemble.left_out_words()}.\n" if ensemble.left_out else ""


def deaths_line(case):
    """How many die, in a line."""
    counts, size = case.counts(case.people["dead"]), np.bincount(case.people["run"])
    share = share_of(counts.tolist(), size.tolist())
    why = f" No interval: {refusal_words(share)}." if share.low is None and share.limit is None else ""
    interval = f" ({percent(share.low)} to {percent(share.high)})" if share.low is not None else (
        f" ({limit_words(share)})" if share.limit is not None else "")
    return (f"{count_of(len(case.runs))} with {share.people} people in all: {percent(share.mean)} %{interval} die, "
            f"{spread_words(counts, size)}.{why}\n")


def losses_text(case):
    """Where and when people are lost, as tables."""
    squares, minutes = losses.by_square(case), losses.by_minute(case)
    if not squares:
        return ""
    shown = squares[: losses.MOST_ROWS]
    rest = f"\n{len(squares) - len(shown)} more squares hold the rest.\n" if len(squares) > len(shown) else ""
    of_place = markdown(["x, m", "z, m", "lost a run", "of all lost", "runs with any"], [
        [f"{x:g} to {x + SQUARE_M:g}", f"{z:g} to {z + SQUARE_M:g}", f"{number:.3g}", f"{percent(share)} %", runs]
        for x, z, number, share, runs in shown])
    of_time = markdown(["minutes", "lost a run", "of all lost", "so far"], [
        [f"{start} to {end}", f"{number:.3g}", f"{percent(share)} %", f"{percent(so_far)} %"]
        for start, end, number, share, so_far in minutes])
    return f"{of_place}{rest}\n{of_time}"


def drifts_rows(case):
    """[(what, number)] of people adrift; [] where none drifted."""
    of = drifts.drifts_of(case)
    if of is None:
        return []
    runs, (middle, most) = len(case.runs), of.times
    low, high = drifts.SWEPT_DEAD
    rows = [["off their feet, a run", f"{of.off_feet / runs:.3g}"], ["adrift, a run", f"{of.drifted / runs:.3g}"],
            ["time adrift", f"{middle:.0f} s in the median, 90 % at most {most:.0f} s"]]
    rows += [[f"drifts that ended: {words}", f"{percent(of.ends[how] / of.drifted)} %"] for how, words in drifts.ENDS.items()
             if of.ends[how]]
    rows += [["drowned adrift; held under, a run", f"{of.drowned_adrift / runs:.3g}; {of.held_under / runs:.3g}"],
             ["dead of those adrift", f"{percent(of.dead / of.drifted)} %; reports of floods: {100 * low:.0f} to {100 * high:.0f} %"]]
    return rows


def hazard_rows(case):
    """[(rule, hazard, share lost)] of lost_by_rules(), in words."""
    rows = []
    for name, rule, (share, low, high) in drifts.lost_by_rules(case):
        hazard = f"air for {drifts.air_of(case):.0f} s, swimmers never" if rule == "under" else f"{rule:g} 1/s [A]"
        most = "at most " if rule == "under" else ""
        rows.append([name, hazard, f"{most}{percent(share)} %" + ("" if low is None else f" ({percent(low)} to {percent(high)})")])
    return rows


HAZARD_NOTE = ("The hazard of drowning adrift is assumed [A]; the other rows are estimated from the exposures of these runs, where no "
               "person reacts to the dead. Runs of the same seeds with another /crowd/drift_hazard_per_s tell them exactly.")


def adrift_warning(case):
    """A sentence where many are still adrift; "" elsewhere."""
    of = drifts.drifts_of(case)
    if of is None or of.still <= drifts.STILL_ADRIFT:
        return ""
    return (f"{percent(of.still)} % of those who drifted are still adrift at the end of the runs and count as without an end: longer "
            "runs lose more.")


def drifts_text(case):
    """People adrift as a section's text."""
    rows = drifts_rows(case)
    if not rows:
        return ""
    warning, lost = adrift_warning(case), hazard_rows(case)
    text = markdown(["people adrift", ""], rows) + (f"\n{warning}\n" if warning else "")
    return text + (f"\n{markdown(['lost', 'hazard of drowning', 'of all people'], lost)}\n{HAZARD_NOTE}\n" if lost else "")


def case_section(case, bys, width, pictures):
    figures = "".join(f"![{words}]({name})\n\n" for name, words in pictures)
    return section(case.name, deaths_line(case), open_text(case), *(class_table(case, by) for by in bys),
                   section("Where and when people are lost", losses_text(case), level=3),
                   section("People adrift", drifts_text(case), level=3),
                   section("Are there enough runs?", stop_text(case, width), level=3),
                   section("Many at once", fn_text(case), level=3), figures)


def varied_keys(cases):
    """Returns the scene keys with values that differ between cases."""
    keys = dict.fromkeys(key for case in cases for key in case.settings)
    return [key for key in keys if len({json.dumps(case.settings.get(key)) for case in cases}) > 1]


def named(case, keys):
    """What tells a case from others in a sentence or heading: "/fluid/cfl 0.2", or its name."""
    return ", ".join(f"{key} {label_of(case, [key])}" for key in keys) or case.name


def label_of(case, keys):
    """What tells a case from others: the values of these keys, or its name."""
    values = [case.settings.get(key) for key in keys]
    return ", ".join(value if isinstance(value, str) else json.dumps(value) for value in values) if keys else case.name


def told_apart_by(cases):
    """Returns the scene keys with values that distinguish all cases; [] if only names do."""
    keys = varied_keys(cases)
    return keys if len({label_of(case, keys) for case in cases}) == len(cases) else []


def bounds_of(share):
    """(mean, low, high) of a share, one-sided where it must be; ends None where there is none."""
    if share.limit is not None:
        return (share.mean, share.limit, 1.0) if share.runs_with_any else (share.mean, 0.0, share.limit)
    return share.mean, share.low, share.high


def interval_words(result):
    """" (-3.1 to +0.2)" of a comparison; "" without an interval."""
    return "" if result.low is None else f" ({100 * result.low:+.1f} to {100 * result.high:+.1f})"


def cases_section(cases, comparisons, picture):
    """A line a case, and a line a comparison with the first, of plans with many settings."""
    fates, notes, keys = fates_of(*cases), Notes(), told_apart_by(cases)
    lines = []
    for case in progress.over(cases, "computes the cases"):
        of_fate = shares_of(case, "all")[0][1]
        cells = [in_words(of_fate[fate][2], notes) if fate in of_fate else "-" for fate in fates]
        lines.append([label_of(case, keys), len(case.runs), len(case.people["run"]), *cells])
    head = ", ".join(keys)
    changes = []
    for first, second in comparisons:
        of_fate = {fate: result for _, fate, result in compare(first, second, "all") if fate in SUMS}
        cells = [f"{100 * result.difference:+.1f}{interval_words(result)}" for result in of_fate.values()]
        lost = of_fate[LOST]
        changes.append([label_of(second, keys), *cells, lost.refused if lost.per_low is None else f"{lost.per:.3g}"])
    against = [f"{FIRST_AND_SECOND.format(named(cases[0], keys))} Changes in points of per cent, with t intervals of 95 %.",
               markdown([head, *SUMS, "people for one more"], changes)] if changes else []
    return "\n".join([section("All settings", markdown([head, "runs", "people", *fates], lines), notes.text(), picture),
                      section("What each changes", *against)])


def parse(arguments):
    parser = Parser("table", __doc__, EPILOG)
    parser.add_argument("folder", type=Path, metavar="DIR", help="folder of an ensemble")
    parser.add_argument("--by", type=some_of(tuple(BY)), default=["all", "group"], metavar="A,B",
                        help="how to tell people apart: all, group, age, skill, start (squares of 20 m) [all,group]")
    parser.add_argument("--against", type=Path, metavar="DIR2", help="a second ensemble, of the same seeds: what it changes")
    parser.add_argument("--width", type=above_0, default=0.1, metavar="W",
                        help="interval for which to tell how many runs it needs [0.1]")
    parser.add_argument("--out", type=Path, metavar="DIR", help="folder of table.csv, table.md and figures [DIR]")
    parser.add_argument("--no-figures", action="store_true", help="tables only")
    options = parser.parse_args(arguments)
    options.by = ["all", *(by for by in options.by if by != "all")]
    options.out = options.out or options.folder
    return options


def main(arguments):
    """tools/wade table."""
    options = parse(arguments)
    ensemble = read_ensemble(options.folder)
    against = read_ensemble(options.against) if options.against else None
    comparisons = comparisons_of(ensemble, against)
    pictures, values = {}, ""
    apart = len(ensemble.cases) <= MOST_SECTIONS
    curves = {case.name: curves_of(case) for case in ensemble.cases}
    if not options.no_figures:
        from wade.statistics.figures import draw_curves, draw_values  # needs matplotlib

        for number, case in enumerate(ensemble.cases if apart else [], 1):
            ending = "" if len(ensemble.cases) == 1 else f"_{number}"
            draw_curves(case, curves[case.name], options.out / f"curves{ending}.png")
            pictures[case.name] = [(f"curves{ending}.png", f"When it happens: {case.name}")]
            if case.people["dead"].any():
                losses.draw(case, options.out / f"losses{ending}.png")
                pictures[case.name].append((f"losses{ending}.png", f"Where people are lost: {case.name}"))
        if not apart:
            draw_values(ensemble.cases, told_apart_by(ensemble.cases), options.out / "values.png")
            values = "![Shares over the values](values.png)"
    text = document(
        f"# Who survives\n\n{HOW}\n\n{left_out_text(ensemble)}",
        *(case_section(case, options.by, options.width, pictures.get(case.name, ())) for case in ensemble.cases if apart),
        "" if apart else cases_section(ensemble.cases, comparisons, values),
        section("What the second changes", *(comparison_text(*pair, options.by) for pair in comparisons if apart)))
    try:
        write_csv(options.out / "table.csv", COLUMNS,
                  [row for case in ensemble.cases for row in rows_of(case, options.by, options.width)])
        write_csv(options.out / "curves.csv", CURVES, curve_rows(curves))
        if comparisons:
            write_csv(options.out / "compared.csv", COMPARED,
                      [row for pair in comparisons for row in compared_rows(*pair, options.by)])
        write_csv(options.out / "losses.csv", ("case", "x_m", "z_m", "lost_a_run", "share", "runs_with_any"),
                  [(case.name, *row) for case in ensemble.cases for row in losses.by_square(case)])
        write_whole(options.out / "table.md", text)
    except UsageError:  # of a file that is read
        raise
    except OSError as error:
        raise UsageError(f"--out: cannot write to {options.out}: {error.strerror}") from error
    say(text)
    say(f"{options.out / 'table.csv'}, {options.out / 'table.md'}")
    return 0
