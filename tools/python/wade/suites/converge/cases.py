"""The cases of `wade converge`: scenes, their reference values, numerical factors and physical choices that are varied."""

from dataclasses import dataclass


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


def rates(reference, *values):
    """Frames of the water and steps of the crowd, 1/s."""
    return Factor("rate, 1/s", reference, values, ("/frame_rate_hz", "/crowd/step_rate_hz"))


def cells(reference, *values):
    return Factor("cell, m", reference, values, ("/fluid/shallow_water/cell_size_m",))


def spacings(reference, *values):
    return Factor("spacing, m", reference, values, ("/fluid/particle_spacing_m",))


@dataclass(frozen=True)
class Case:
    """quick: single persons in steady water; their states are compared over numerical factors, for one seed."""

    name: str
    scene: str
    factors: tuple
    quick: bool = False
    choices: tuple = ()

    @property
    def varied(self):
        return self.factors + self.choices

    @property
    def reference(self):
        return {pointer: value for factor in self.varied for pointer, value in factor.sets(factor.reference).items()}

    def factor(self, name):
        return next(factor for factor in self.varied if factor.name == name)


WALKING = Choice("walking law", {law: {"/crowd/walking_in_water": law} for law in ("relative", "bernardini")})
WAYS = Choice("ways", {"one": {"/coupling/two_way": False}, "two": {"/coupling/two_way": True}})
BODIES = Choice("bodies", {rule: {"/crowd/bodies": rule, "/crowd/markers": "redrawn"} for rule in ("human", "none")})

CASES = (
    Case("ford", "converge/ford", (rates(30, 120, 8, 4, 2, 1, 0.5), cells(0.5, 0.25, 1, 2)), quick=True, choices=(WALKING,)),
    Case("fallen", "converge/fallen", (rates(30, 120, 8, 4, 2, 1, 0.5), spacings(0.4, 0.25, 1)), quick=True),
    Case("crossing", "converge/crossing", (rates(30, 120, 8, 4, 2), cells(0.5, 0.25, 1, 2)), choices=(WALKING, WAYS)),
    Case("village", "places/village/village", (rates(15, 30, 8, 4, 2), cells(1, 2, 4)), choices=(WALKING, WAYS, BODIES)),
    Case("hamlet", "places/hamlet", (rates(15, 30, 8, 4, 2), cells(1, 2, 4)), choices=(WALKING,)),
)
