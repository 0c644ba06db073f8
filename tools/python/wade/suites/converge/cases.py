"""The cases of `wade converge`: scenes, their reference values, numerical factors and physical choices that are varied."""

from dataclasses import dataclass, field


@dataclass(frozen=True)
class Factor:
    """What is varied: {value: what is set} by pointers that all get the value."""

    name: str
    reference: float
    values: tuple
    pointers: tuple

    def sets(self, value):
        return {pointer: value for pointer in self.pointers}

    @staticmethod
    def word(value):
        return f"{value:g}"


@dataclass(frozen=True)
class Choice:
    """A physical choice: {word: what is set}, the reference first. Its differences are reported and have no limit."""

    name: str
    options: dict

    @property
    def reference(self):
        return next(iter(self.options))

    @property
    def values(self):
        return tuple(self.options)[1:]

    def sets(self, value):
        return self.options[value]

    @staticmethod
    def word(value):
        return value


RATES = ("/frame_rate_hz", "/crowd/step_rate_hz")


def rates(reference, *values):
    """Frames of the water and steps of the crowd together, 1/s."""
    return Factor("rate, 1/s", reference, values, RATES)


def frames(reference, *values):
    """Frames of the water, 1/s."""
    return Factor("frames, 1/s", reference, values, RATES[:1])


def steps(reference, *values):
    """Steps of the crowd, 1/s."""
    return Factor("steps, 1/s", reference, values, RATES[1:])


def cells(reference, *values):
    return Factor("cell, m", reference, values, ("/fluid/shallow_water/cell_size_m",))


def spacings(reference, *values):
    return Factor("spacing, m", reference, values, ("/fluid/particle_spacing_m",))


def threads(*values):
    """An option of both programs, not a key: results must not change by a bit."""
    return Factor("threads", 1, values, ())


@dataclass(frozen=True)
class Case:
    """quick: single persons in steady water; their states are compared over numerical factors, for one seed."""

    name: str
    scene: str
    factors: tuple
    quick: bool = False
    choices: tuple = ()
    settings: dict = field(default_factory=dict)  # beside those of the factors

    @property
    def varied(self):
        return self.factors + self.choices

    @property
    def reference(self):
        own = {pointer: value for factor in self.varied for pointer, value in factor.sets(factor.reference).items()}
        return {**own, **self.settings}

    def factor(self, name):
        return next(factor for factor in self.varied if factor.name == name)


WALKING = Choice("walking law", {law: {"/crowd/walking_in_water": law} for law in ("relative", "bernardini")})
WAYS = Choice("ways", {"one": {"/coupling/two_way": False}, "two": {"/coupling/two_way": True}})
BODIES = Choice("bodies", {rule: {"/crowd/bodies": rule, "/crowd/markers": "redrawn"} for rule in ("human", "none")})

MODEL = Choice("model", {"shallow_water": {"/fluid/model": "shallow_water"},
                         "dfsph": {"/fluid/model": "dfsph", "/fluid/particle_spacing_m": 0.4}})

SINGLE = (rates(30, 120, 8, 4, 2, 1, 0.5), frames(30, 120, 8, 2), steps(30, 120, 8, 2))
CROWD = (rates(30, 120, 8, 4, 2), frames(30, 120, 8, 2), steps(30, 120, 8, 2))
SITE = (rates(15, 30, 8, 4, 2), frames(15, 4, 2), steps(15, 60, 4, 2))


def river(name, speed):
    return Case(name, "converge/river", (*CROWD, spacings(0.25, 0.2, 0.5, 1)), choices=(WALKING,),
                settings={"/channel/velocity_m_s": speed})


CASES = (
    Case("ford", "converge/ford", (*SINGLE, cells(0.5, 0.25, 1, 2), threads(4)), quick=True, choices=(WALKING,)),
    Case("fallen", "converge/fallen", (*SINGLE, spacings(0.4, 0.25, 1), threads(4)), quick=True),
    Case("strip", "converge/strip", (*SINGLE, cells(0.5, 0.25, 1, 2)), quick=True),
    Case("crossing", "converge/crossing", (*CROWD, cells(0.5, 0.25, 1, 2), threads(4)), choices=(WALKING, WAYS, MODEL)),
    river("river_075", 0.75),
    river("river_100", 1.0),
    Case("door", "converge/door", (*CROWD, cells(0.25, 0.125, 0.5)), choices=(WALKING,)),
    Case("street", "converge/street", (*SITE, cells(0.5, 0.35, 0.89, 1, 2, 4)), choices=(WALKING, BODIES)),
    Case("village", "sites/village/village", (*SITE, cells(1, 2, 4)), choices=(WALKING, WAYS, BODIES)),
    Case("hamlet", "sites/hamlet", (*SITE, cells(1, 2, 4)), choices=(WALKING,)),
)
