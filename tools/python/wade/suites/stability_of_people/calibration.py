"""Two constants for each data set, and what they foretell. Velocities are those of crowd_client/people/person.hpp."""

import subprocess

import numpy as np

from wade.paths import BUILD

POINTS = 10  # depths of each body, evenly
DEEPEST = 0.85  # of the height; deeper, people float


def demands(rows, skill="-"):
    """(slip, topple) at 1 m/s for (height, mass, depth), by the program person_demands, as an array.

    Without a skill with a friction mu and an arm lambda of 1.
    """
    lines = "".join(f"{height} {mass} {depth} {skill}\n" for height, mass, depth in rows)
    said = subprocess.run([BUILD / "person_demands"], input=lines, stdout=subprocess.PIPE, text=True, check=True).stdout
    return np.array([[float(word) for word in line.split()] for line in said.splitlines()])


def critical(at_1_m_s, constants):
    """The speed at which people slip or topple, whichever comes first; constants: (mu, lambda)."""
    return np.sqrt(np.min(np.asarray(constants) / at_1_m_s, axis=-1))


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
