"""A page for who decides: what was run, who survives and how sure that is, where to search, what was assumed.

Reads what `tools/wade many` wrote, or any folder with run folders in it; writes one HTML file with its pictures inside, which
can be sent, printed, read in any browser. It explains its words; nothing in it needs this program.
"""

import base64
import html
import re
import tempfile
from pathlib import Path

import numpy as np

from wade import UsageError, plain_file
from wade.reports.files import complain, say, write_whole
from wade.reports.tables import count_of, listed
from wade.scenes import resolved_scene
from wade.statistics import drifts, losses
from wade.statistics.ensemble import (FLOODED, LOST, NO_END, SWEPT_AWAY, classes, fates_of, has_feet, having, open_kinds,
                                      read_ensemble)
from wade.statistics.figures import draw_values
from wade.statistics.last_positions import SQUARE_M, density_of, search_order
from wade.statistics.shares import share_of
from wade.statistics.table import (FIRST_AND_SECOND, HAZARD_NOTE, LEAST, MOST, MOST_SECTIONS, SAFE, adrift_warning, compare,
                                   comparisons_of, drifts_rows, hazard_rows, interval_words, label_of, limit_words, named, of_runs,
                                   open_text, percent, refusal_words, stop_text, told_apart_by, verdict, what_decides)
from wade.statistics.times import curves_of
from wade.states import MISSING
from wade.terminal import Parser

COLOURS = {"arrived": "#009e73", "sheltered": "#117733", "walking": "#56b4e9", "standing": "#88ccee", "recovering": "#ddcc77",
           "holding": "#e69f00", "pinned": "#f0e442", "carried": "#d55e00", "indoors": "#cc79a7", FLOODED: "#882255",
           "upstairs": "#aa4499", "drowned": "#16161a", SWEPT_AWAY: "#5a5a60"}
# Where the water of a site comes from, by the keys of a scene.
WATER_OF_A_SITE = {"water": "stands there at the start", "water_depth_file": "lies there at the start",
                    "gates": "waits behind gates until they open", "sources": "flows in", "rain": "falls as rain"}
OTHERS = ("#332288", "#999933", "#44aa99")  # of fates that only some scenes have
WORDS = {
    "arrived": "reached the goal",
    "sheltered": "reached a shelter that had room",
    LOST: "are dead: drowned or swept away",
    NO_END: "are neither safe nor lost when the simulated time ends",
    "walking": "are on their feet and on their way",
    "standing": "have stood in one place for half a minute, for example at the edge of deep water",
    "recovering": "have fallen, and sit, kneel or squat in water",
    "holding": "lie in the water and hold on to a rope, a line or another person",
    "carried": "have lost their feet and are carried by the water",
    "pinned": "are pressed against something by the water",
    "indoors": "are in their houses; whether these hold is not computed",
    FLOODED: "are in houses with more than 0.5 m of water at the door; whether these hold, and whether water comes in, is not computed",
    "upstairs": "are on the upper floor of their houses; whether these hold is not computed",
    "drowned": "drowned adrift, or were held under water for longer than their air lasted",
    SWEPT_AWAY: "were carried over the downstream end, where the simulation loses sight of them; counted as dead",
}
BY = {"group": "By group", "age": "By age", "skill": "By how well they brace themselves against the water"}
ENOUGH = 20  # runs
STYLE = """
body{font:16px/1.5 system-ui,sans-serif;color:#2a2a2e;max-width:60rem;margin:2rem auto;padding:0 1rem}
h1{font-size:1.7rem;line-height:1.2;margin-bottom:.3rem}
h2{font-size:1.2rem;margin-top:2.2rem;border-bottom:1px solid #d8d8dc}
h3{font-size:1rem;margin:1.4rem 0 .3rem}
.small{font-size:.85rem;color:#5a5a60}
img{max-width:100%}
.tiles{display:flex;flex-wrap:wrap;gap:.8rem;margin:1rem 0}
.tile{flex:1 1 11rem;border:1px solid #d8d8dc;border-radius:.4rem;padding:.7rem}
.tile b{display:block;font-size:1.6rem;line-height:1.2}
table{border-collapse:collapse;font-size:.9rem;margin:.6rem 0}
td,th{padding:.25rem .6rem;border-bottom:1px solid #e4e4e8;text-align:right;vertical-align:top}
td:first-child,th:first-child,td.l,th.l{text-align:left}
.bar{display:flex;height:1.3rem;width:100%;min-width:14rem}
.bar i{display:block;height:100%}
.key{display:inline-block;width:.8rem;height:.8rem;margin:0 .3rem 0 .8rem;vertical-align:-.1rem}
.warn{background:#fdf3e1;padding:.6rem 1rem;border-left:4px solid #e69f00}
@media print{h2{break-after:avoid}img,table{break-inside:avoid}}
"""


def text(words):
    return html.escape(str(words))


def picture(file, words):
    """An image with its bytes inside."""
    data = base64.b64encode(plain_file.read_bytes(file)).decode()
    return f'<figure style="margin:0"><img alt="{text(words)}" src="data:image/png;base64,{data}"></figure>'


def table(head, rows, left=(0,)):
    """An HTML table; cells are HTML."""

    def row(cells, tag):
        marked = (f'<{tag}{" class=l" if k in left else ""}>{cell}</{tag}>' for k, cell in enumerate(cells))
        return f"<tr>{''.join(marked)}</tr>"

    return f"<table>{row(head, 'th')}{''.join(row(cells, 'td') for cells in rows)}</table>"


def colour_of(fate, fates):
    others = [one for one in fates if one not in COLOURS]
    return COLOURS.get(fate) or OTHERS[others.index(fate) % len(OTHERS)]


def in_hundred(share):
    """"16.6 of 100 (14.6 to 18.9)", or why there is no interval."""
    if share.people == 0:
        return "nobody"
    if share.limit is not None:
        return f"{percent(share.mean)} of 100 ({limit_words(share).removesuffix(' %')})"
    if share.low is None:
        return f"{percent(share.mean)} of 100"
    return f"{percent(share.mean)} of 100 ({percent(share.low)} to {percent(share.high)})"


def share_where(case, chosen, here=None):
    here = np.ones(len(chosen), bool) if here is None else here
    return share_of(case.counts(here & chosen).tolist(), case.counts(here).tolist())


def is_missing(case):
    return np.isin(case.people["fate"].astype(str), MISSING)


def hazard_note(case):
    """The lost at a low and a high hazard of drowning, as a line of a tile."""
    lost = {name: share for name, _, (share, _, _) in drifts.lost_by_rules(case)}
    if not {"low", "high"} <= set(lost):
        return ""
    return (f'<br><span class="small">{percent(lost["low"])} to {percent(lost["high"])} at a low and a high hazard of drowning, which '
            "is assumed</span>")


def tiles(case):
    """The three numbers that matter."""
    people, size = case.people, np.bincount(case.people["run"])
    dead = case.counts(people["dead"])
    cells = []
    for words, chosen in (("arrive in safety", people["safe"]), ("die", people["dead"]),
                          ("have no end yet when the time ends", having(people, NO_END))):
        share = share_where(case, chosen)
        has_range = share.low is not None or share.limit is not None
        note = "" if has_range else f'<br><span class="small">No range: {text(refusal_words(share))}.</span>'
        head, _, more = in_hundred(share).partition(" (")
        note += hazard_note(case) if words == "die" else ""
        cells.append(f'<div class="tile"><b>{head}</b>{words}{f"<br>likely {text(more[:-1])}" if more else ""}{note}</div>')
    with_any = int((dead > 0).sum())
    most = "" if dead.min() == dead.max() else f" to {dead.max()}"
    of_all = (f'<br><span class="small">{with_any} of {len(dead)} runs have any (likely {of_runs(with_any, len(dead))} of all runs of '
              "this flood)</span>") if len(dead) > 1 else ""
    cells.append(f'<div class="tile"><b>{dead.min()}{most}</b>dead of {size.max()} people'
                 f'{", from run to run" if most else " in each run" if len(dead) > 1 else ""}{of_all}</div>')
    return f'<div class="tiles">{"".join(cells)}</div>'


def about(share):
    """So many of 100 in words."""
    return "none" if share == 0 else "less than 1" if share < 1 else f"about {share:.0f}"


def first_words(case):
    """The answer in two sentences."""
    people = case.people
    shares = {words: 100 * share_where(case, chosen).mean
              for words, chosen in (("arrive in safety", people["safe"]), ("die", people["dead"]))}
    told = [f"{about(share)} {words}" for words, share in shares.items()]
    none = 100 * share_where(case, having(people, NO_END)).mean
    told += [f"{about(none)} have no end yet"] if none else []
    end = max(run.outcome["sim_time_s"] for run in case.runs)
    runs = (f"This is the mean of {len(case.runs)} simulated runs of one flood, which differ only by chance: in the people and in the "
            "way in which each of them steps." if len(case.runs) > 1 else "This is one simulated run, which tells nothing of chance.")
    warn = f'<p class="warn">{text(open_text(case))}</p>' if none else ""
    return f"<p>Of 100 people {listed(told)}, after {end:.0f} seconds at most. {runs}</p>{warn}"


def bars(case):
    """Returns stacked bars of the fates of people, by classes, with their numbers."""
    fates, parts = fates_of(case), []
    seen = [fate for fate in fates if (case.people["fate"] == fate).any()]
    key = "".join(f'<span class="key" style="background:{colour_of(fate, fates)}"></span>{text(fate)}' for fate in seen)
    for by, title in BY.items():
        kinds = classes(case, by)
        if len(kinds) < 2:
            continue
        rows = []
        for name, here in kinds:
            widths = {fate: 100 * share_where(case, case.people["fate"] == fate, here).mean for fate in seen}
            strip = "".join(f'<i style="width:{width:.2f}%;background:{colour_of(fate, fates)}"></i>'
                            for fate, width in widths.items())
            numbers = [in_hundred(share_where(case, chosen, here))
                       for chosen in (case.people["safe"], case.people["dead"])]
            rows.append([text(name), f'<div class="bar">{strip}</div>', *numbers, int(here.sum())])
        parts.append(f"<h3>{title}</h3>" + table(["", "how they end", "arrive in safety", "die", "people, all runs"], rows, (0, 1)))
    if not parts:
        rows = [[text(fate), in_hundred(share_where(case, case.people["fate"] == fate))] for fate in seen]
        return table(["", "share"], rows)
    return f'<p class="small">{key}</p>' + "".join(parts)


def glossary(*cases):
    there = {fate for case in cases for fate in case.people["fate"].tolist()}
    rows = [[text(fate), text(WORDS[fate]) + "."] for fate in fates_of(*cases)
            if fate in there or fate in (LOST, NO_END)]
    return table(["word", "they ..."], rows, (0, 1))


def ran(case, column, unit, form="g"):
    """The range and the median of a column of agents.csv, over the people of all runs."""
    values = case.people[column][np.isfinite(case.people[column])]
    if len(values) == 0:
        return "not known"
    low, middle, high = (f"{value:{form}}" for value in np.quantile(values, [0, 0.5, 1]))
    return f"{low}{unit}" if low == high else f"{low} to {high}{unit}, median {middle}"


def parts_of(case, column):
    """The texts of a column of agents.csv with their shares of the people."""
    words, counts = np.unique(case.people[column].astype(str), return_counts=True)
    return ", ".join(f"{word} ({percent(count / counts.sum())} %)" for word, count in zip(words, counts) if word)


def assumed(*cases, keys=()):
    """What was put in, as a table; of several cases each row that differs has a line for each value, with its settings."""
    rows = {}
    for case in cases:
        for name, value in assumed_of(case):
            rows.setdefault(name, {}).setdefault(value, []).append(label_of(case, keys))
    cells = [[text(name), text(next(iter(values))) if len(values) == 1 and sum(map(len, values.values())) == len(cases) else "<br>".join(
        f"{text(', '.join(labels))}: {text(value)}" for value, labels in values.items())] for name, values in rows.items()]
    return table(["", f"by {text(', '.join(keys))}" if len(cases) > 1 else ""], cells, (0, 1))


def assumed_of(case):
    """[(what, value)] of what was put in, in words."""
    manifest = case.manifest()
    scene, run = resolved_scene(manifest), case.runs[0]
    world, crowd = scene["world"], scene["crowd"]
    boxes = len(scene.get("obstacles") or [])
    rows = [["ground", f"{world['length_m']:g} x {world['width_m']:g} m" + (f", {boxes} obstacles" if boxes else "")]]
    channel = scene.get("channel")
    if scene.get("site"):
        from wade.pictures.top_view import polygons_of
        houses = len(polygons_of(scene, "houses"))
        rows[0][1] += f", a map with {houses} house{'s' if houses != 1 else ''}"
        came = [words for key, words in WATER_OF_A_SITE.items() if scene["site"].get(key)]
        rows.append(["water", ", ".join(came) or "none"])
    elif channel:
        depth = f"{channel['depth_m']:g} m deep, " if "depth_m" in channel else ""
        rows.append(["water", f"{depth}{channel['velocity_m_s']:g} m/s asked for"])
    fluid = run.outcome.get("fluid") or {}
    met = case.people.get("max_depth_m")
    if met is not None and np.isfinite(met).any():
        rows.append(["water that people met", f"up to {np.nanmax(met):.1f} m deep"])
    rows.append(["how the water is computed", fluid.get("model", "-")])
    people = case.people
    by_body = people["worst_state"] != ""
    answers = (["by their bodies, as measured in flumes"] if by_body.any() else []) + (
        ["by a given endurance tau of the paper, 0 not moved to 1 carried, which is not measured"] if not by_body.all() else [])
    rows.append(["how people answer the water", "; ".join(answers)])
    if not by_body.all():
        rows.append(["tau", ran(case, "tau", "")])
    groups = len(set(people["group"].tolist()))
    rows += [["people", f"{listed(map(str, sorted(set(np.bincount(people['run']).tolist()))))} a run, "
              f"{groups} group{'s' if groups != 1 else ''}"],
             ["age", ran(case, "age", " years", ".0f")], ["height", ran(case, "height_m", " m", ".2f")],
             ["mass", ran(case, "mass_kg", " kg", ".0f")]]
    if by_body.any():
        rows += [["bracing", parts_of(case, "skill")], ["walking in water", str(crowd.get("walking_in_water", "-"))]]
    end = max(one.outcome["sim_time_s"] for one in case.runs)
    rows += [["simulated time", f"up to {end:.0f} s"],
             ["runs", f"{len(case.runs)}, seeds {min(case.seeds)} to {max(case.seeds)}" if len(case.runs) > 1 else
              f"1, seed {case.seeds[0]}"],
             ["program", f"Wade {manifest.get('version', '')}, commit {manifest.get('git_hash', '-')}"]]
    return rows


def beyond(*cases):
    """What lies outside of what was measured, as a list."""
    outcomes, people = [run.outcome for case in cases for run in case.runs], sum(len(case.people["run"]) for case in cases)
    by_body = any((case.people["worst_state"] != "").any() for case in cases)
    lines = []
    counted = [outcome["beyond_measured"] for outcome in outcomes if outcome.get("beyond_measured")]
    if counted:
        number, time = sum(one["people"] for one in counted), sum(one["time_s"] for one in counted)
        long = f"{time / number:.1f} s" if time > 0.1 * number else "less than 0.1 s"
        lines.append(
            f"{100 * number / people:.0f} % of the people ({number} of {people}) strained against water shallower than 0.2 m or "
            f"deeper than 1.2 m while on their feet, for {long} each on average. People were measured between these depths; "
            "beyond them the same equations are continued.")
    else:
        lines.append("People answer the water by a given endurance, which is a number of a paper and no measurement.")
    warnings = {}
    for outcome in outcomes:
        for kind, warning in {re.sub(r"[\d.]+", "0", warning): warning for warning in outcome.get("warnings", [])}.items():
            warnings.setdefault(kind, []).append(warning)
    lines += [f"The program warned in {len(of_kind)} of {len(outcomes)} runs, for example: {of_kind[0]}"
              for of_kind in warnings.values()]
    lines += [
        "Chance is in who the people are and how they walk. That the flood itself could be other than assumed is not in the "
        "ranges on this page; a sensitivity study tells that.",
        ("Children are computed as small adults. " if by_body else "") + "Panic, debris, vehicles, clothes and help from outside are "
        "not in it unless the scene has them.",
        ("How soon people drown adrift is assumed: no source gives deaths against time adrift. " if by_body else "People with a given "
         "endurance do not drown: they die where the water carries them off the map. ") + "Injuries and cold afterwards are not counted."]
    return "<ul>" + "".join(f"<li>{text(line)}</li>" for line in lines) + "</ul>"


def stays_in_words(case):
    if len(case.runs) < ENOUGH:
        there = "is only 1 run" if len(case.runs) == 1 else f"are only {len(case.runs)} runs"
        return (f'<p class="warn">There {there}. Ranges need 10 at least, and a decision should rest on '
                f"{ENOUGH} or more.</p>")
    lines = [line[2:] for line in stop_text(case, 0.1).splitlines() if "more runs" in line]
    return f'<p class="warn">For ranges at most 10 of 100 wide: {text("; ".join(lines))}.</p>' if lines else ""


def draw_all(case, folder):
    """The pictures of a case, {name: file or None}."""
    from wade.pictures.figure import draw as draw_run
    from wade.statistics.figures import draw_curves
    from wade.statistics.victims import draw as draw_map
    from wade.statistics.victims import sought

    files = {"curves": folder / "curves.png", "run": None, "search": None, "losses": folder / "losses.png"}
    draw_curves(case, curves_of(case), files["curves"])
    if case.people["dead"].any():
        losses.draw(case, files["losses"])
    with_paths = next((run for run in case.runs if (run.folder / "trajectories.sqlite").exists()), None)
    if with_paths:
        try:
            draw_run(with_paths.folder, None, folder / "run.png", 1200)
            files["run"] = folder / "run.png", with_paths.seed
        except (OSError, KeyError) as error:
            complain(f"wade report: no picture of a run: {error}")
    scene = resolved_scene(case.manifest())
    x, z, _, _, over = sought(case)
    if len(x):
        density = density_of(x, z, scene["world"]["length_m"], scene["world"]["width_m"])
        draw_map(scene, density, x, z, f"{len(x)} people of {count_of(len(case.runs))}", folder / "search.png")
        files["search"] = folder / "search.png", [density.area(held) for held in (0.5, 0.9)], over, search_order(density)
    return files


def flows(case):
    """A sentence on the direction of a channel's water; "" of a map."""
    scene = resolved_scene(case.manifest())
    channel = scene.get("channel") or {"flow": "closed"}
    return "" if scene.get("site") or channel["flow"] == "closed" else " The water flows to the left."


def losses_html(case, file, of=""):
    """Where and when people are lost: a map and two tables. of: words behind the title."""
    squares, minutes = losses.by_square(case), losses.by_minute(case)
    if not squares:
        return f"<h2>Where people are lost{text(of)}</h2><p>No person is lost in these runs.</p>"
    shown = squares[: losses.MOST_ROWS]
    rest = f'<p class="small">{len(squares) - len(shown)} more squares hold the rest.</p>' if len(squares) > len(shown) else ""
    side = losses.SQUARE_M
    return (f"<h2>Where people are lost{text(of)}</h2>" + picture(file, "map of losses") + table(
        ["x, m", "z, m", "lost a run", "of 100 lost", "runs with any"],
        [[f"{x:g} to {x + side:g}", f"{z:g} to {z + side:g}", f"{number:.2g}", percent(share), runs]
         for x, z, number, share, runs in shown], ()) + rest + "<h3>By time</h3>" + table(
        ["minutes", "lost a run", "of 100 lost", "so far"],
        [[f"{start} to {end}", f"{number:.2g}", percent(share), percent(so_far)]
         for start, end, number, share, so_far in minutes], ()))


def drifts_html(case, of=""):
    """People adrift, and the lost at other hazards of drowning."""
    rows = drifts_rows(case)
    if not rows:
        return ""
    warning, lost = adrift_warning(case), hazard_rows(case)
    parts = [f'<p class="warn">{text(warning)}</p>' if warning else "", table(["", ""], [[text(a), text(b)] for a, b in rows], (0, 1))]
    if lost:
        parts += ["<h3>Lost at other hazards of drowning</h3>",
                  table(["", "hazard", "of all people"], [[text(cell) for cell in row] for row in lost], (0, 1)),
                  f'<p class="small">{text(HAZARD_NOTE)}</p>']
    return f"<h2>People adrift{text(of)}</h2>" + "".join(parts)


def case_html(case, level_title, changes):
    """All of a case; changes: what a second one changes, as HTML."""
    with tempfile.TemporaryDirectory(prefix="wade-report-") as name:
        files = draw_all(case, Path(name))
        parts = [f"<h2>{text(level_title)}</h2>" if level_title else "", first_words(case), tiles(case), stays_in_words(case)]
        parts += ["<h2>What the change brings</h2>", changes] if changes else []
        if files["run"]:
            parts += [f"<h2>{'One of the runs' if len(case.runs) > 1 else 'The run'}</h2>", picture(files["run"][0], "map of one run"),
                      f'<p class="small">Seen from above, the run with seed {files["run"][1]}.{flows(case)}'
                      f'{" The other runs look alike but not the same." if len(case.runs) > 1 else ""}</p>']
        parts += ["<h2>Who</h2>", bars(case), "<h2>When</h2>", picture(files["curves"], "curves over time"),
                  '<p class="small">Left: how many have arrived and died by each time.'
                  + (" Middle: how many have been taken off their feet, and have arrived without that; green, of those still "
                     "under way, who has never been." if has_feet(case) else "")
                  + " Right: in how many of the runs a number N of people or more die. Shaded, and bars: the range in which the "
                  "true value lies with 95 %, at each point by itself.</p>"]
        parts += [losses_html(case, files["losses"]), drifts_html(case)]
        if files["search"]:
            file, areas, over, rows = files["search"]
            squares = table(["", "x, m", "z, m", "expected there", "so far"], [
                [k, f"{x:g} to {x + SQUARE_M:g}", f"{z:g} to {z + SQUARE_M:g}", f"{percent(share)} of 100",
                 f"{percent(so_far)} of 100"]
                for k, (x, z, share, so_far, _) in enumerate(rows[:5], 1)], ())
            lost = f" {over} people, of all runs, went over the downstream end and are not on it." if over else ""
            parts += ["<h2>Where to search</h2>", picture(file, "map of last places"),
                      f"<p>Half of those who are dead or missing are expected within {areas[0]:,.0f} m², nine of ten within "
                      f"{areas[1]:,.0f} m² (the inner and the outer line).{lost} Search first, in this order:</p>", squares]
        parts += ["<h2>What was assumed</h2>", assumed(case), "<h2>What lies outside of what is known</h2>", beyond(case),
                  "<h2>What the words mean</h2>", glossary(case)]
    return "".join(parts)


ROWS = {SAFE: "safe: arrived or in a shelter", LOST: "lost: dead", LEAST: "lost, if all without an end were lost in the first",
        MOST: "lost, if all without an end were lost in the second", NO_END: "no end yet"}


def comparison_html(first, second):
    """What the second changes, of all people."""
    rows = []
    for _, fate, result in compare(first, second, "all"):
        if result.first == result.second == 0 and fate not in (SAFE, LOST):
            continue
        interval = f"no range: {result.refused}"
        if result.low is not None:
            interval = f"{100 * result.low:+.1f} to {100 * result.high:+.1f}"
        rows.append([text(ROWS.get(fate, fate)), f"{percent(result.first)} of 100", f"{percent(result.second)} of 100",
                     f"{100 * result.difference:+.1f}", text(interval)])
    return (f"<p>First: {text(first.name)}, {text(first.runs[0].folder.parent)}. Second: {text(second.name)}, "
            f"{text(second.runs[0].folder.parent)}. Both with the same people, seed by seed.</p>"
            + table(["", "first", "second", "change, of 100", "likely"], rows)
            + (f'<p class="warn">{text(told)}</p>' if (told := verdict(first, second)) else ""))


def open_range(cases):
    """The people without an end yet by kind, from the least to the most of all settings, and what would tell; "" if all have one."""
    shares = []
    for kind in open_kinds(*cases):
        of_cases = [open_kinds(case).get(kind, 0) for case in cases]
        most = "" if min(of_cases) == max(of_cases) else f" to {percent(max(of_cases))}"
        shares.append(f"{percent(min(of_cases))}{most} % {kind}")
    return f"Without an end yet at the end of the runs, by setting: {', '.join(shares)}. {what_decides(*cases)}" if shares else ""


def values_html(cases, comparisons):
    """All of three cases and more: one figure, one table, what each changes, losses of the first, and what was assumed."""
    keys, fates = told_apart_by(cases), fates_of(*cases)
    head, name_of_first = ", ".join(keys), named(cases[0], keys)
    rows = [[text(label_of(case, keys)), len(case.runs),
             *(in_hundred(share_where(case, having(case.people, fate))) for fate in fates)] for case in cases]
    with tempfile.TemporaryDirectory(prefix="wade-report-") as name:
        draw_values(cases, keys, Path(name) / "values.png")
        if cases[0].people["dead"].any():
            losses.draw(cases[0], Path(name) / "losses.png")
        of = f" with the first setting, {name_of_first}"
        of_first = losses_html(cases[0], Path(name) / "losses.png", of) + drifts_html(cases[0], of)
        parts = [picture(Path(name) / "values.png", "shares over the values"), table([text(head), "runs", *fates], rows)]
    changes = []
    for first, second in comparisons:
        of_fate = {fate: result for _, fate, result in compare(first, second, "all")}
        cells = [f"{100 * of_fate[fate].difference:+.1f}{interval_words(of_fate[fate])}" for fate in (SAFE, LOST, LEAST, MOST)]
        lost = of_fate[LOST]
        needed = lost.refused if lost.per_low is None else f"{lost.per:.3g} ({lost.per_low:.3g} to {lost.per_high:.3g})"
        changes.append([text(label_of(second, keys)), *cells, text(needed)])
    if changes:
        parts += [f"<h2>What each changes against {text(name_of_first)}, of 100</h2>",
                  f"<p>{text(FIRST_AND_SECOND.format(name_of_first).replace('*', ''))}</p>",
                  table([text(head), *(ROWS[fate] for fate in (SAFE, LOST, LEAST, MOST)), "people for one more"], changes, (0, 5))]
    warn = open_range(cases)
    return "".join([f'<p class="warn">{text(warn)}</p>' if warn else "", *parts,
                    stays_in_words(min(cases, key=lambda case: len(case.runs))), of_first,
                    "<h2>What was assumed</h2>", assumed(*cases, keys=keys),
                    "<h2>What lies outside of what is known</h2>", beyond(*cases),
                    "<h2>What the words mean</h2>", glossary(*cases)])


def page(ensemble, comparisons, title):
    """The page."""
    cases = ensemble.cases
    left = ensemble.left_out_words()
    warn = f'<p class="warn">Runs that are not counted: {text(left)}.</p>' if left else ""
    runs = sum(len(case.runs) for case in cases)
    if len(cases) > MOST_SECTIONS:
        body = values_html(cases, comparisons)
    else:
        changes = "".join(comparison_html(*pair) for pair in comparisons)
        body = "".join(case_html(case, case.name if len(cases) > 1 else "", changes if case is cases[0] else "") for case in cases)
    how = ("<p>Each run is a simulation of the whole flood with all people. <b>Likely</b> ranges hold the true mean of this "
           "model with 95 %; they come from the differences between runs, since the people of one run share its water. No range "
           "is given where it would not hold. Numbers are of the model: how near it is to people and floods is the matter of "
           "the sections on what was assumed and what is not known.</p>")
    return (f'<!doctype html><html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">'
            f"<title>{text(title)}</title><style>{STYLE}</style></head><body><h1>{text(title)}</h1>"
            f'<p class="small">{runs} simulated run{"s" if runs != 1 else ""}</p>{warn}{body}'
            f"<h2>How to read the numbers</h2>{how}</body></html>\n")


def parse(arguments):
    parser = Parser("report", __doc__, "Exit code: 0, or 2 for bad usage or a folder without complete runs.")
    parser.add_argument("folder", type=Path, metavar="DIR", help="folder of an ensemble")
    parser.add_argument("--against", type=Path, metavar="DIR2", help="a second ensemble, of the same seeds: what it changes")
    parser.add_argument("--title", metavar="TEXT", help="of the page [Who survives: the scene]")
    parser.add_argument("--out", type=Path, metavar="FILE", help="the page [DIR/report.html]")
    return parser.parse_args(arguments)


def main(arguments):
    """tools/wade report."""
    options = parse(arguments)
    ensemble = read_ensemble(options.folder)
    against = read_ensemble(options.against) if options.against else None
    title = options.title or f"Who survives: {', '.join(dict.fromkeys(case.scene for case in ensemble.cases))}"
    out = options.out or options.folder / "report.html"
    try:
        write_whole(out, page(ensemble, comparisons_of(ensemble, against), title))
    except UsageError:  # of a file that is read
        raise
    except OSError as error:
        raise UsageError(f"--out: cannot write {out}: {error.strerror}") from error
    say(out)
    return 0
