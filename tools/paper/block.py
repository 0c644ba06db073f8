"""Section of report.md on the obstacle: where it stands, and how fast the water is."""

import plan
from bands import LEE_AT_S, LEE_LENGTH_M, in_words, judge_lee, judge_obstacle
from pictures import lee_of
from words import SET_UPS, arrived_of, markdown_table, met_of

PLACES = sorted((*plan.OBSTACLE_PLACES, 60))  # x_min, m; 60 is that of the scenes


def rows_of(context, sets):
    """[(what it is, Result without the obstacle, {place: Result with it})] of the waters that have runs with it."""
    rows = []
    for scene_set in sets:
        if not plan.has_scene(scene_set, "obstacle"):
            continue
        pushes = (1, plan.EMITTER_PUSH) if plan.block_cases(scene_set) else (1,)
        for push in pushes:
            words = SET_UPS[scene_set] + ("" if push == 1 else f", emitter at {push:g} v_F")
            cases = {place: plan.block_case(scene_set, None if place == 60 else place, push) for place in PLACES}
            known = {place: result for place, case in cases.items() if (result := context.get(case)) is not None}
            without = context.get(plan.no_block_case(scene_set, push))
            if known and without is not None:
                rows.append((words, without, known))
    return rows


def saving_places(row):
    """The places at which the obstacle saves people by the band's own measure."""
    _, without, by_place = row
    return [place for place, result in by_place.items() if judge_obstacle(result, without).holds]


def long_lees(row):
    """The places at which the lee is as long as the band asks for."""
    return [place for place, result in row[2].items() if judge_lee(lee_of(result)).holds]


def elsewhere(context, scene_set, band):
    """Where the band of the obstacle or of its lee is met after all, as a sentence of the causes; "" if nowhere."""
    met_at = {"obstacle": saving_places, "lee": long_lees}.get(band)
    found = [] if met_at is None else [(row[0], met_at(row)) for row in rows_of(context, [scene_set])]
    words = [f"at x {', '.join(f'{place:g}' for place in places)} m ({water})" for water, places in found if places]
    return f" The band is met {', '.join(words)}: see The place of the obstacle." if words else ""


def lee_words(result):
    lee = None if result is None else lee_of(result)
    return "-" if lee is None else f"{lee[0]:.0f}; {lee[1]:.0f} m at {lee[2]} s"


def block_section(context):
    rows = rows_of(context, context.sets)
    if not rows:
        return ""
    head = ["water", "without it", *(f"x {place:g} m" for place in PLACES), "water met without it"]
    arrivals = [
        [words, arrived_of(without), *(arrived_of(known.get(place)) for place in PLACES), met_of(without)]
        for words, without, known in rows
    ]
    lees = [[words, *(lee_words(known.get(place)) for place in PLACES)] for words, _, known in rows]
    lees = [line for line in lees if any(cell != "-" for cell in line[1:])]
    text = (
        "## The place of the obstacle\n\nWhere the block of 7 x 7 m stood is not published; 60 m is assumed. The 52 people start"
        " from x 65 to 86 m and drift towards x 0 while they cross.\nArrivals, of 52 (paper: 26 with it, 8 without):\n\n"
    )
    text += markdown_table(head, arrivals) + "\n"
    for row in rows:
        saved = saving_places(row)
        most = max(row[2], key=lambda place: row[2][place].arrived[0])
        found = f"more arrive with it than without it, the intervals apart, at x {', '.join(f'{place:g}' for place in saved)} m"
        text += (
            f"* {row[0]}: {found if saved else 'at none of these places do more arrive with it, the intervals apart'}; the most,"
            f" {in_words(row[2][most].arrived)}, at x {most:g} m.\n"
        )
    if lees:
        text += (
            f"\nLength of the dry lee at {LEE_AT_S} s, m (the paper's picture has at least {LEE_LENGTH_M} m), and the longest of"
            " the first two minutes:\n\n"
        ) + markdown_table(["water", *head[2:-1]], lees)
    return text
