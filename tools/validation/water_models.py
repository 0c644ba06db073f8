"""What a scene must say for each model of the water."""

FOLLOWS_PEOPLE = ("mixed",)  # its particles are where the people of one crowd are, who tell it in every frame


def model_overrides(model):
    """Options --set of `validate` that make a case's water that of a model."""
    overrides = [f"/fluid/model={model}"]
    if model in FOLLOWS_PEOPLE:
        overrides.append('/coupling/agents_stream="serial"')
    return overrides
