"""What does not agree with the paper, and why as far as it is known."""

from report import judgements_of
from words import SET_UPS

# By set and band; a band without words of its own set takes those of "".
CAUSES = {}


def disagreement_section(context):
    lines = []
    for scene_set in context.sets:
        for judgement in judgements_of(context, scene_set):
            if judgement.holds is False:
                general = CAUSES.get(("", judgement.name), "No cause is known.")
                cause = CAUSES.get((scene_set, judgement.name), general)
                words = f"* {SET_UPS[scene_set]}, {judgement.name}: {judgement.found}; asked for: {judgement.asked}."
                lines.append(f"{words} {cause}")
    if not lines:
        return ""
    return "## What does not agree, and why\n\n" + "\n".join(lines) + "\n"
