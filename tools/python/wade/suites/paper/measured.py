"""Writes measured.md: the paper's crowds with the response `measured`; what was not run is left out."""

import statistics
from collections import Counter

from wade.statistics.shares import arrival_interval
from wade.reports.plots import error_bars, panels, save
from wade.reports.tables import document, listed, markdown, section
from wade.states import OFF_FEET
from wade.suites.paper import plan
from wade.suites.paper.bands import SET_UPS, in_words, shown
from wade.suites.paper.plane import level_words
from wade.suites.paper.report import made_by

PAGE, FIGURE = "measured.md", "measured.png"
HEAD = """# The paper's crowds, by their bodies

The crowds of the [report](report.md) with an endurance that follows from the water instead of being given: people of 1.70 m
and 65 kg with the response `measured` ([people in water](../../people_in_water.md)). S1 to S12 differ in tau and v_F; as tau
is computed here, they fall onto three waters."""
LEFT_OUT = (
    "`configs/paper` and `configs/observed` have gravity 0.98 m/s2, at which feet carry a tenth of their weight in water that "
    "pushes as before. Both are run at 9.81 m/s2: the kinematic water stays as it is, the emitter's is the reading `gravity "
    "9.81 m/s2` of the report.",
    "`configs/manning` is the river of `configs/river` at ten times the cost. The switch of tau has no meaning here.",
    "Two ways want a run of the water for each crowd: three seeds. They and their one-way runs are by the shallow-water "
    "equations, cells of 0.5 m, on which wakes that the water shows reach farther than on particles.",
    "Who can sit but not stand up where it is sits until the water lets it stand, or drowns it where its mouth is under (0.5 H): at "
    "400 s the rest is *in the water*. Who keeps the feet and does not arrive stands behind them on the bank.",
    "People are alike, 1.70 m and 65 kg, half of them women, who walk slower in water. The goal radius is that of S1.")
FATES_AT = (0.5, 0.75, 1.0, 1.5)  # m/s; in faster water all people lose their feet
FATES = ("kept their feet", "slid", "off their feet", "arrive", "over the fall", "drowned", "in the water")


def people_in(result, groups=None):
    """Returns, for each run, the records of its groups, some or all."""
    return [[of_group for name, of_group in run.outcome["people"].items() if groups is None or name in groups]
            for run in result.runs]


def fates(result, groups=None):
    """Mean numbers of a run, in the order of FATES."""
    worst, state = Counter(), Counter()
    for of_run in people_in(result, groups):
        for of_group in of_run:
            worst.update(of_group["worst"])
            state.update(of_group["state"])
    off, slid = sum(worst[name] for name in OFF_FEET), worst["sliding"]
    numbers = [sum(worst.values()) - off - slid, slid, off, state["arrived"], state["dead"], state["drowned"]]
    return [number / len(result.runs) for number in (*numbers, sum(state.values()) - sum(numbers[3:]))]


def off_feet(result, groups=None):
    """Returns (mean, low, high) of the number of people that lose their feet in a run."""
    numbers = [sum(of_group["worst"].get(name, 0) for of_group in of_run for name in OFF_FEET)
               for of_run in people_in(result, groups)]
    some = people_in(result, groups)[0]
    return arrival_interval(numbers, sum(sum(of_group["worst"].values()) for of_group in some))


def tau_of(result):
    """Returns the mean over people that met water of their mean tau in it; None without such people."""
    known = [of_group["tau"] for of_run in people_in(result) for of_group in of_run if of_group["tau"][0]]
    wet = sum(number for number, _ in known)
    return sum(number * tau for number, tau in known) / wet if wet else None


def fate_words(result, *groups):
    """Returns arrivals and people off their feet, of some groups or all: "41.2 (39.0 to 43.1); 3.1 (2.0 to 4.6)"."""
    if result is None:
        return "-"
    arrived = result.arrived_of(groups[0]) if groups else result.arrived
    people = sum(sum(of_group["worst"].values()) for of_group in people_in(result, groups or None)[0])
    return f"{number_words(arrived, people)}; {number_words(off_feet(result, groups or None), people)}"


def number_words(interval, people):
    """Returns mean and interval in words; the number alone for no people and for all people."""
    return f"{interval[0]:.0f}" if interval[0] in (0, people) else in_words(interval)


def results_of(context, scene_set):
    """{(v_F, skill): Result}."""
    found = {(velocity, skill): context.get(plan.measured_case(scene_set, velocity, skill))
             for velocity in plan.MEASURED_V_F.get(scene_set, ()) for skill in plan.SKILLS}
    return {key: result for key, result in found.items() if result}


def water_words(velocity):
    """In 1 m of water H v_F is v_F."""
    return f"{velocity:g} m2/s, {level_words(velocity)}"


def share(result):
    return result.arrived[0] / result.agents


def summary_section(context):
    lines = []
    river = results_of(context, "river")
    if river:
        speeds = sorted({velocity for velocity, _ in river})
        skills = [skill for skill in plan.SKILLS if any(of == skill for _, of in river)]
        up_to = {skill: max((v for v in speeds if (v, skill) in river and share(river[v, skill]) >= 0.5), default=None)
                 for skill in skills}
        words = [f"{skill} {f'{speed:g}' if speed else 'none'}" for skill, speed in up_to.items()]
        lines.append(f"* Skill decides. In 1 m of water at least half arrive up to v_F, m/s: {', '.join(words)}.")
        lines.append(f"* More than half lose their feet from v_F, m/s (its level by Table 2, Viseu): {falls_words(river)}.")
        for velocity in plan.V_F.values():
            of_water = {skill: river[velocity, skill] for skill in skills if (velocity, skill) in river}
            most = [skill for skill, result in of_water.items() if share(result) >= 0.5]
            taus = [tau for result in of_water.values() if (tau := tau_of(result)) is not None]
            if of_water and taus:
                lines.append(f"* v_F {velocity:g} m/s ({water_words(velocity)}): at least half arrive of {listed(most)}; tau "
                             f"computed {min(taus):.2f} to {max(taus):.2f}. In the paper, by tau: "
                             f"{paper_words(context.paper, velocity)}.")
        lines += topple_words(river)
    lines += two_way_words(context)
    return section("In short", "\n".join(lines) + "\n") if lines else ""


def falls_words(river):
    """Returns, for each skill, the slowest water that takes more than half of the people off their feet."""
    words = []
    for skill in plan.SKILLS:
        speeds = sorted(v for v, of in river if of == skill and off_feet(river[v, of])[0] > 0.5 * river[v, of].agents)
        words.append(f"{skill} {f'{speeds[0]:g} ({level_words(speeds[0])})' if speeds else 'none'}")
    return ", ".join(words)


def topple_words(river):
    """Returns where most people lose their feet although the feet do not slip."""
    firm = {key: off_feet(result)[0] for key, result in river.items() if (tau := tau_of(result)) is not None and tau < 0.01}
    velocity, skill = max(firm, key=firm.get, default=(None, None))
    if not firm or firm[velocity, skill] == 0:
        return []
    return [f"* Tau counts slipping alone, and people topple: at {velocity:g} m/s {skill} people have tau "
            f"{tau_of(river[velocity, skill]):.2f}, and {firm[velocity, skill]:.0f} of 50 lose their feet."]


def paper_words(paper, velocity):
    """Returns the paper's arrivals by the given tau, "0: 50, 0.2: 50"."""
    rows = [paper[name] for name in plan.SCENARIOS if plan.velocity_of(name) == velocity]
    return ", ".join(f"{float(row['tau']):g}: {shown(row['arrived'])}" for row in rows)


def waters_section(context):
    lines = []
    for scene_set in context.sets:
        results = results_of(context, scene_set)
        for velocity in plan.V_F.values():
            of_water = [results.get((velocity, skill)) for skill in plan.SKILLS]
            if any(of_water):
                cells = [f"{shown(tau_of(one), 2)}: {number_words(one.arrived, one.agents)}" if one else "-"
                         for one in of_water]
                lines.append([SET_UPS[scene_set], f"{velocity:g}", water_words(velocity),
                              paper_words(context.paper, velocity), *cells])
    text = (
        "Of 50, behind the tau. Given: the paper's, by its Table 1 and text. Computed: mean of max(0, 1 - 1/S) over the time "
        "of each in the water, then over people (carried: that of who stood there); 0 holds, 1 has no hold.")
    head = ["set", "v_F, m/s", "H v_F asked for, Table 2 (Viseu)", "paper: tau, who arrives", *plan.SKILLS]
    return section("Tau given, tau computed, and who arrives", text, markdown(head, lines)) if lines else ""


def speeds_section(context):
    """Returns the section on arrivals and lost feet over v_F, and draws its figure."""
    results = results_of(context, "river")
    if not results:
        return ""
    speeds = sorted({velocity for velocity, _ in results})
    draw(results, speeds, context.out / FIGURE)
    lines = [[f"{v:g}", level_words(v), *(fate_words(results.get((v, skill))) for skill in plan.SKILLS)] for v in speeds]
    text = ("River of 1 m. Of 50: who arrives; who loses its feet, topples, floats or is carried. Intervals of 95 % but of all "
            "or nobody.")
    text += " Dotted: where levels of Table 2 begin."
    return section("Who arrives over v_F", f"![Who arrives over v_F]({FIGURE})", text,
                   markdown(["v_F = H v_F", "Table 2 (Viseu)", *plan.SKILLS], lines))


def draw(results, speeds, file):
    figure, (arrive, topple) = panels(2, (4.9, 3.9), (("v_F in 1 m of water, m/s", "arrive, of 50"),
                                                      ("v_F in 1 m of water, m/s", "lose their feet, of 50")))
    for index, skill in enumerate(plan.SKILLS):
        of_skill = [results.get((velocity, skill)) for velocity in speeds]
        # A shift along v_F separates lines that coincide.
        places = [velocity + 0.012 * (index - 2) for velocity in speeds]
        error_bars(arrive, places, [one and one.arrived for one in of_skill], skill, index)
        error_bars(topple, places, [one and off_feet(one) for one in of_skill], skill, index)
    for axes in (arrive, topple):
        axes.set(ylim=(-2, 66), yticks=range(0, 51, 10))
        for bound, words in ((0.5, "moderate"), (0.75, "high"), (1.0, "very high")):
            axes.axvline(bound, color="#9a9aa2", linewidth=0.9, linestyle=":")
            axes.text(bound + 0.02, 65, words, rotation=90, fontsize=6.5, color="#5a5a60", va="top")
    figure.legend(*arrive.get_legend_handles_labels(), loc="upper center", bbox_to_anchor=(0.5, 1.0), ncol=5)
    save(figure, file)


def fates_section(context):
    results = results_of(context, "river")
    lines = [[f"{velocity:g}", level_words(velocity), skill, shown(tau_of(result), 2),
              *(f"{number:.1f}" for number in fates(result))]
             for velocity in FATES_AT for skill in plan.SKILLS if (result := results.get((velocity, skill)))]
    head = ["v_F", "Table 2 (Viseu)", "skill", "tau", *FATES]
    text = "River, of 50. The first three: the worst state on the way; the last four: how it ended."
    return section("What becomes of them", text, markdown(head, lines)) if lines else ""


def others_section(context):
    lines = []
    for name, velocity in plan.MEASURED_OTHERS:
        results = [context.get(plan.measured_other(name, velocity, skill)) for skill in plan.SKILLS]
        for group in ("walkers", "upstream") if name == "two_groups" else ("walkers",):
            if any(results):
                words = f"{name.replace('_', ' ')}: {group}" if name == "two_groups" else name.replace("_", " ")
                cells = [fate_words(one, group) for one in results]
                lines.append([words, f"{velocity:g}", *cells])
    text = (
        "River. Who arrives; who loses its feet. Two groups: of 50 each, of whom `upstream` walks against the stream; obstacle "
        "at x 60 m and without: of 52. Ten of `upstream` start at the fall and are over it at once. The paper, tau 0.6 and 1.5 m/s: 8 of 100; 26 with the obstacle and 8 without.")
    head = ["scenario", "v_F", *plan.SKILLS]
    return section("Two groups and the obstacle", text, markdown(head, lines)) if lines else ""


PUSHED = {"S5": "the 50 of Table 1", "no_obstacle": "52 without an obstacle",
          "obstacle_of_people": "52, a block of 64 people at x 67 m"}
WAY_WORDS = {(False, False): "one way", (False, True): "one way, shelter", (True, False): "two ways",
             (True, True): "two ways, shelter"}


def pushed(context):
    """Returns [(crowd, skill, v_F, {(two_way, shelter): Result or None})] of the cases that were run."""
    cases = [(name, skill, velocity, True) for name in plan.PUSHING for skill, velocity in plan.PUSHED_AT]
    cases += [(*case, False) for case in plan.ON_PARTICLES]
    for name, skill, velocity, cells in cases:
        found = {ways: context.get(plan.measured_pushing(name, velocity, skill, *ways, cells=cells)) for ways in plan.WAYS}
        if any(one for ways, one in found.items() if cells or any(ways)):  # one-way on particles is part of Table 1
            yield PUSHED[name] + ("" if cells else ", particles"), skill, velocity, found


def two_way_words(context):
    """Returns the case that two-way coupling and shelter change most, and the effect of a block of people."""
    changes = []
    for who, skill, velocity, found in pushed(context):
        if found[False, False] and found[True, True]:
            before, after = (found[ways].arrived_of("walkers")[0] for ways in ((False, False), (True, True)))
            words = f"{who}, {skill}, {velocity:g} m/s: {before:.1f} arrive one way, {after:.1f} with both"
            changes.append((abs(after - before), words))
    lines = [f"* Two ways and shelter change most for {max(changes)[1]}."] if changes else []
    both = {(who, skill): found[True, True] for who, skill, _, found in pushed(context) if found[True, True]}
    block, free = PUSHED["obstacle_of_people"], PUSHED["no_obstacle"]
    words = [f"{skill} {both[block, skill].arrived_of('walkers')[0]:.1f} with it, "
             f"{both[free, skill].arrived_of('walkers')[0]:.1f} without"
             for skill, _ in plan.PUSHED_AT if {(block, skill), (free, skill)} <= both.keys()]
    return lines + ([f"* A block of people in the way, with both, of 52 arrive: {'; '.join(words)}."] if words else [])


def staying_words(context):
    """Returns how many people stand before the block of people or among it at the end."""
    lines = []
    for who, skill, _, found in pushed(context):
        if who == PUSHED["obstacle_of_people"] and all(found.values()):
            numbers = [statistics.fmean(of_run[0]["state"].get("standing", 0) for of_run in people_in(one, ("walkers",)))
                       for one in found.values()]
            lines.append(f"{skill} {', '.join(f'{number:.1f}' for number in numbers)}")
    text = "Who reaches the block stays, as people are in the way. Of 52 stand so at the end, in the order of the columns"
    return f"{text}: {'; '.join(lines)}." if lines else ""


def two_way_section(context):
    lines = [[who, skill, f"{velocity:g}", *(fate_words(one, "walkers") for one in found.values())]
             for who, skill, velocity, found in pushed(context)]
    on_particles = "; *particles*: by `dfsph`, two ways one seed" if any("particles" in line[0] for line in lines) else ""
    text = (
        f"The river by the shallow-water equations{on_particles}. Who arrives; who loses its feet. *Shelter*: "
        "`/coupling/shelter` `wake`, people behind people feel slower water. *Two ways*: `/coupling/two_way`, people push "
        "the water. The block, `configs/river/obstacle_of_people.json`, stands fast, 8 x 8 people a metre apart, on the way "
        "of those who drift.")
    head = ["who", "skill", "v_F", *WAY_WORDS.values()]
    return section("What two ways change", text, markdown(head, lines), staying_words(context)) if lines else ""


def page(command, context):
    """The text of measured.md; "" without results."""
    runs = [run for result in context.results.values() for run in result.runs]
    if not runs:
        return ""
    seeds = sorted({run.seed for run in runs})
    head = (f"{HEAD}\n\nRegenerated by `tools/wade paper {command}`; {len(runs)} runs, seeds {seeds[0]} to "
            f"{seeds[-1]}, by programs: {made_by(runs)}.\n")
    sections = (summary_section, waters_section, speeds_section, fates_section, others_section, two_way_section)
    left_out = section("What is left out, and why", "".join(f"* {words}\n" for words in LEFT_OUT))
    return document(head, *(tell(context) for tell in sections), left_out)
