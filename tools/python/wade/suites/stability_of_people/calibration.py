"""At what speed people in flumes lost their footing, as published, and the two constants of our equations for each data set.

Formulas of height H (m), mass m (kg) and depth h (m), each with the bodies and the depths that it was measured or stated for;
outside they are extrapolations (Abt's gives 6 m/s at 0.2 m). Karvonen's slopes and the coefficients of Xia's real people are as
other authors quote them. Our velocities are those of crowd_client/people/person.hpp.
"""

import math
import subprocess

import numpy as np

from wade.paths import BUILD

POINTS = 10  # depths of each body, evenly
DEEPEST = 0.85  # of the height; deeper, people float


def abt(height, mass, depth):
    """Abt et al. 1989, 20 adults and a monolith: h u = 0.0929 exp(0.001906 H m + 1.09)^2, m2/s."""
    return 0.0929 * math.exp(0.001906 * height * mass + 1.09) ** 2 / depth


def karvonen(slope, offset):
    """Karvonen et al. 2000 (RESCDAM), 7 adults: h u = slope H m + offset, m2/s."""
    return lambda height, mass, depth: (slope * height * mass + offset) / depth


def xia(slide, topple):
    """Xia et al. 2014: the smaller of the velocities of sliding and toppling, each with its alpha, m^0.5/s, and beta.

    a1, b1: share of the volume under water over h / H; a2, b2: volume in m3 over the mass.
    """
    a1, b1, a2, b2 = 0.633, 0.367, 1.015e-3, -4.927e-3

    def critical(height, mass, depth):
        x, volume = depth / height, a2 * mass + b2
        slides = mass / (1000 * height * depth) - (a1 * x + b1) * volume / height**2
        topples = mass / (1000 * depth**2) - (a1 / height**2 + b1 / (depth * height)) * volume
        return min(alpha * x**beta * math.sqrt(max(resists, 0))
                   for (alpha, beta), resists in ((slide, slides), (topple, topples)))

    return critical


class Data:
    """A data set. goal: the largest RMS of ln u of two constants fitted to it; skill: its preset in scenes, or None."""

    def __init__(self, name, title, critical, bodies, depths, goal, skill, children=False):
        self.name, self.title, self.critical, self.bodies, self.depths = name, title, critical, bodies, depths
        self.goal, self.skill, self.children = goal, skill, children


ABT = ((1.52, 41), (1.60, 50), (1.68, 60), (1.75, 70), (1.83, 80), (1.88, 91))
KARVONEN = ((1.60, 48), (1.65, 57), (1.70, 65), (1.78, 75), (1.85, 85), (1.95, 100))
XIA = ((1.50, 50), (1.60, 57), (1.70, 65), (1.80, 80), (1.90, 95))
CHILDREN = ((1.15, 20), (1.38, 32))  # of 6 and 10 years
DUMMY, PEOPLE = ((7.975, 0.018), (3.472, 0.188)), ((10.253, 0.139), (7.867, 0.462))

SETS = (
    Data("abt", "Abt 1989", abt, ABT, (0.42, 1.2), 0.09, "braced"),
    Data("karvonen_good", "Karvonen 2000, good", karvonen(0.006, 0.3), KARVONEN, (0.4, 1.1), 0.12, "good"),
    Data("karvonen_normal", "Karvonen 2000, normal", karvonen(0.004, 0.2), KARVONEN, (0.4, 1.1), 0.12, None),
    Data("karvonen_poor", "Karvonen 2000, poor", karvonen(0.002, 0.1), KARVONEN, (0.4, 1.1), 0.12, "poor"),
    Data("xia_dummy", "Xia 2014, dummy", xia(*DUMMY), XIA, (0.2, 1.1), 0.07, "unaware", True),
    Data("xia_people", "Xia 2014, people", xia(*PEOPLE), XIA, (0.2, 1.1), 0.04, None, True),
)

# Limits that do not know the body, drawn beside the curves and not scored.
DEPTH_TIMES_SPEED = (  # m2/s; guidelines but for the first
    ("Cox 2004: children of H m < 20 m kg fail", 0.4),
    ("AR&R 2016, H3: not for children and the elderly", 0.6), ("Viseu 2006, high", 0.75),
    ("AR&R 2016, H4: for nobody; Viseu, very high", 1.0))
DEFRA = ("Defra FD2320: danger for most", 1.5)  # h (u + 0.5)


def demands(rows, skill="-"):
    """(slip, topple, rush) at 1 m/s for (height, mass, depth), by the program person_demands, as an array.

    Without a skill with a friction mu and an arm lambda of 1.
    """
    lines = "".join(f"{height} {mass} {depth} {skill}\n" for height, mass, depth in rows)
    said = subprocess.run([BUILD / "person_demands"], input=lines, stdout=subprocess.PIPE, text=True, check=True).stdout
    return np.array([[float(word) for word in line.split()] for line in said.splitlines()])


def critical(at_1_m_s, constants):
    """Returns the speed that makes people slip or topple, whichever comes first, m/s; constants: (mu, lambda)."""
    constants = np.asarray(constants)
    return np.sqrt(np.min(np.concatenate([constants, np.ones_like(constants[..., :1])], axis=-1) / at_1_m_s, axis=-1))


def points_of(data, bodies):
    return [(height, mass, depth) for height, mass in bodies for depth in np.linspace(*data.depths, POINTS)
            if depth <= DEEPEST * height]


def errors(data, bodies, constants):
    """ln of our speed over the published one, of bodies at all their depths."""
    rows = points_of(data, bodies)
    return np.log(critical(demands(rows), constants) / [data.critical(*row) for row in rows])


def rms(values):
    return float(np.sqrt(np.mean(np.square(values))))


def fitted(data):
    """(mu, lambda) of the least RMS of ln u, on ever finer grids of ratios."""
    rows = points_of(data, data.bodies)
    at_1_m_s, truth = demands(rows), np.array([data.critical(*row) for row in rows])
    middle, half = np.log([0.3, 0.06]), 2.5
    while half > 1e-3:
        axes = [np.linspace(m - half, m + half, 41) for m in middle]
        grid = np.exp(np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1))[:, :, None, :]
        cost = np.mean(np.log(critical(at_1_m_s, grid) / truth) ** 2, axis=-1)
        best = np.unravel_index(np.argmin(cost), cost.shape)
        middle, half = [axis[k] for axis, k in zip(axes, best)], half / 4
    return tuple(float(np.exp(m)) for m in middle)
