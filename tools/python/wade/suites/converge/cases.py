"""The cases of `wade converge`: scenes, their reference values, and the numerical factors that are varied."""

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


def rates(reference, *values):
    """Frames of the water and steps of the crowd, 1/s."""
    return Factor("rate, 1/s", reference, values, ("/frame_rate_hz", "/crowd/step_rate_hz"))


def cells(reference, *values):
    return Factor("cell, m", reference, values, ("/fluid/shallow_water/cell_size_m",))


def spacings(reference, *values):
    return Factor("spacing, m", reference, values, ("/fluid/particle_spacing_m",))


@dataclass(frozen=True)
class Case:
    """quick: single persons in steady water; their states are compared, for one seed."""

    name: str
    scene: str
    factors: tuple
    quick: bool = False

    @property
    def reference(self):
        return {pointer: value for factor in self.factors for pointer, value in factor.sets(factor.reference).items()}

    def factor(self, name):
        return next(factor for factor in self.factors if factor.name == name)


CASES = (
    Case("ford", "converge/ford", (rates(30, 120, 8, 4, 2, 1, 0.5), cells(0.5, 0.25, 1, 2)), quick=True),
    Case("fallen", "converge/fallen", (rates(30, 120, 8, 4, 2, 1, 0.5), spacings(0.4, 0.25, 1)), quick=True),
    Case("crossing", "converge/crossing", (rates(30, 120, 8, 4, 2), cells(0.5, 0.25, 1, 2))),
    Case("village", "places/village/village", (rates(15, 30, 8, 4, 2), cells(1, 2, 4))),
    Case("hamlet", "places/hamlet", (rates(15, 30, 8, 4, 2), cells(1, 2, 4))),
)
