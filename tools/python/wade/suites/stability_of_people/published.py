"""At what speed people in flumes lost their footing, as published formulas of height H (m), mass m (kg) and depth h (m).

Each with the bodies and the depths that it was measured or stated for; outside they are extrapolations (Abt's gives 6 m/s at
0.2 m). Karvonen's slopes and the coefficients of Xia's real people are as other authors quote them.
"""

import math


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
DEPTH_TIMES_SPEED = (  # m2/s
    ("AR&R 2016, H3: not for children and the elderly", 0.6), ("Viseu 2006, high", 0.75),
    ("AR&R 2016, H4: for nobody; Viseu, very high", 1.0))
DEFRA = ("Defra FD2320: danger for most", 1.5)  # h (u + 0.5)
