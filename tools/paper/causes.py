"""What does not agree with the paper, and why as far as it is known."""

from report import judgements_of
from words import SET_UPS

SCATTER = (
    "The particles of the kinematic stream lie at random in their cells, so that the contact mass scatters more than"
    " in a"
    " solved river; Eq. 9 is concave in it, and the stream carries an agent less far while it crosses (see the"
    " section on"
    " drift, and the smaller particles under Readings)."
)
THIN = (
    "The water of the emitter accelerates and thins (see the depth that the agents met and the mean depth of the"
    " fluid), so"
    " that an agent touches less of it than in 1 m."
)
ESTABLISHED = (
    "The river is there from the start, so that the agents are in it on their whole way; in a dry start, as in the"
    " paper's"
    " figures, they walk part of it on dry ground (see the start filled with water under Readings)."
)
# By set and band; a band without words of its own set takes those of "".
CAUSES = {
    ("observed", "S8"): SCATTER,
    **{("paper", name): THIN for name in ("S4", "S5", "S6", "S7", "S8", "S10", "S11")},
    **{("river", name): ESTABLISHED for name in ("S4", "S5", "S6", "S7", "S10")},
    ("", "ten times the particles"): (
        "Eq. 9 is not linear in the contact mass, whose scatter falls with the mass of a particle: finer water"
        " pushes harder."
    ),
}
# What is within its band and still not the paper's result.
BESIDE_BANDS = (
    "* S6: the paper loses 15 of 50. At v_F 2.5 m/s and tau 0.2 a stream of 1 m carries those who cross about 30 m,"
    " and the"
    " fall is at least 65 m away: in no set-up\n  is anybody lost. It takes about twice the depth or twice the speed"
    " (see What it"
    " would take).\n* Two groups: the paper has 8 arrivals in all; here most of those who cross arrive, with the"
    " other group and"
    " without it. The same water that loses\n  them would slow S5 to the paper's time: at v_F 1.5 m/s the paper's"
    " agents met"
    " stronger water than 1 m at v_F, as its authors' logs say (2.9 to 3.9 m/s\n  near the front).\n"
)


def disagreement_section(context):
    lines = []
    for scene_set in context.sets:
        for judgement in judgements_of(context, scene_set):
            if judgement.holds is False:
                general = CAUSES.get(("", judgement.name), "No cause is known.")
                cause = CAUSES.get((scene_set, judgement.name), general)
                words = f"* {SET_UPS[scene_set]}, {judgement.name}: {judgement.found}; asked for: {judgement.asked}."
                lines.append(f"{words} {cause}\n")
    return "## What does not agree, and why\n\n" + "".join(lines) + BESIDE_BANDS
