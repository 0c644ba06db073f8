"""What a scene must say for each model of the water."""

FOLLOWS_PEOPLE = ("mixed",)  # its particles are where the people of one crowd are, who tell it in every frame


def model_changes(model):
    """(JSON pointer, value) that make a scene's water that of a model."""
    follows = (("/coupling/agents_stream", "serial"),) if model in FOLLOWS_PEOPLE else ()
    return (("/fluid/model", model), *follows)


def model_overrides(model):
    """The same as values of --set."""
    return [f"{pointer}={value}" for pointer, value in model_changes(model)]
