"""What does not agree with the paper, and why as far as it is known."""

from wade.reports.tables import section
from wade.suites.paper import bands, plan
from wade.suites.paper.bands import in_words
from wade.suites.paper.block import met_elsewhere
from wade.suites.paper.report import judgements_of
from wade.suites.paper.words import SET_UPS

SCATTER = (
    "S8 lies at 2.82 times the limit of v_F, just where an agent that heads straight across drifts as far as the fall,"
    " so that small things decide: Eq. 9 is concave in the contact mass, so that the stream carries an agent less far"
    " the more that mass scatters (see the drift above, and under Readings the particles at random, in a lattice without"
    " disorder, and smaller). So does the time on dry ground before the front comes: in a river that is there from the start"
    " nobody arrives (filled, under Readings)."
)
THIN = (
    "The front of the emitter's water is slower than the 2.6 v_F of the authors' logs, so that more people are across"
    " before it comes (the set as observed does the same if its water is transported at v_F, see Readings), and the"
    " water thins as it accelerates (see the depth met and the mean depth of the fluid), so that an agent touches less"
    " of it."
)
ESTABLISHED = (
    "The river is there from the start, so that the agents are in it on their whole way; in a dry start, as in the"
    " paper's figures, they walk part of it on dry ground (see the start filled with water under Readings)."
)
# By set and band; a band without words of its own set takes those of "".
CAUSES = {
    ("observed", "S8"): SCATTER,
    **{("paper", name): THIN for name in ("S4", "S5", "S6", "S7", "S8", "S9", "S10", "S11")},
    **{(s, name): ESTABLISHED for s in ("river", "manning") for name in ("S4", "S5", "S6", "S7", "S10")},
    ("paper", "obstacle"): "Without the block nearly all arrive in this set, so that it has nobody to save.",
    ("paper", "lee"): (
        "The front reaches the block after 17 s; in the authors' runs it moved at 2.6 v_F. The lee comes as much later."
    ),
    ("river", "obstacle"): (
        "There the block stands downstream of where people start, so that only those who have drifted already come into its"
        " lee, and the stream beside it, which it narrows, is faster (see the water met)."
    ),
    ("river", "lee"): "The river is filled from the start: there is no dry ground, water closes behind the block.",
    ("", "ten times the particles"): (
        "Eq. 9 is not linear in the contact mass, whose scatter falls with the mass of a particle: finer water pushes"
        " harder."
    ),
}


def beside_bands(context):
    """What is within its band and still not the paper's result, in each set."""
    text = ""
    for scene_set in context.sets:
        s6, groups = context.scenario(scene_set, "S6"), context.other(scene_set, "two_groups")
        if s6 is not None and groups is not None:
            text += (
                f"* {SET_UPS[scene_set]}, within their bands and yet different: S6, {in_words(s6.arrived)} arrive and 35 in the"
                f" paper; two groups, {in_words(groups.arrived_of('walkers'))} cross and 8 arrive in all in the paper.\n"
            )
    return text


def words_of_push(context, cases):
    """Bands and times of S4 to S10, and the numbers that the paper gives, of scenarios in faster water; "" if not run."""
    *table, groups = [context.get(case) for case in cases]
    results = dict(zip(plan.PUSHED, table))
    error = bands.time_error(context.paper, results.get)
    if error is None or groups is None or results["S6"] is None:
        return ""
    met = bands.count_in_words(map(bands.judge_scenario, plan.PUSHED, table))
    return (
        f"{met} bands of S4 to S10, times of S4 to S7 and S10 wrong by a factor of {error:.2f}, S6 {in_words(results['S6'].arrived)}"
        f" arrive, two groups {in_words(groups.arrived_of('walkers'))} cross"
    )


def faster_water(context):
    """What the open question, the speed of the water, could explain."""
    found = []
    for factor in plan.PUSHES:
        cases = [plan.push_case(name, factor) for name in (*plan.PUSHED, "two_groups")]
        found.append((f"as observed, {factor:g} v_F", words_of_push(context, cases)))
    for factor in plan.EMITTER_PUSHES:
        cases = plan.emitter_cases("paper", factor)
        found.append((f"as run, emitter at {factor:g} v_F", words_of_push(context, cases)))
    lines = [f"  * {water}: {words}\n" for water, words in found if words]
    if not lines:
        return ""
    return (
        "* What the water of the paper's runs did is not published, and decides most of this. The authors' logs have 1.9 to 2.6"
        " v_F at the agents\n  near the front. In water that is faster than v_F, the factors chosen afterwards and in no scene"
        " (paper: S6 35 arrive, two groups 8):\n"
    ) + "".join(lines)


def contact_rule(context):
    """What the paper's text says of the contact, held against its own table."""
    lines = []
    for scene_set in context.sets:
        results = [context.get(case) for case in plan.contact_cases(scene_set)[: len(plan.PUSHED)]]
        if all(results):
            met = bands.count_in_words(map(bands.judge_scenario, plan.PUSHED, results))
            s5 = results[plan.PUSHED.index("S5")]
            lines.append(f"{SET_UPS[scene_set]} {in_words(s5.arrived)} arrive in S5, {met} bands of S4 to S10")
    if not lines:
        return ""
    return (
        "* The contact rule of the paper's text, `sum`, does not give the paper's own table, in which all arrive in S5:"
        f" {'; '.join(lines)}. The rule of its authors' program, `difference`, is the one used here.\n"
    )


def disagreement_section(context):
    text = ""
    for scene_set in context.sets:
        missed = {}  # {cause: bands, in words}
        for judgement in judgements_of(context, scene_set):
            if judgement.holds is False:
                general = CAUSES.get(("", judgement.name), "No cause is known.")
                cause = CAUSES.get((scene_set, judgement.name), general) + met_elsewhere(context, scene_set, judgement.name)
                words = f"{judgement.name}: {judgement.found}; asked for: {judgement.asked}."
                missed.setdefault(cause, []).append(words)
        for cause, words in missed.items():
            if len(words) == 1:
                text += f"* {SET_UPS[scene_set]}, {words[0]} {cause}\n"
            else:
                text += f"* {SET_UPS[scene_set]}: {cause}\n" + "".join(f"  * {one}\n" for one in words)
    text += beside_bands(context) + contact_rule(context) + faster_water(context)
    return section("What does not agree, and why", text)
