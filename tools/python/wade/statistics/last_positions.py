"""Where to search for the dead and the missing: density of last positions over the runs of an ensemble, and drift.

Density by a Gaussian kernel of 5 m, mirrored at the edges of the map; contours that hold 50 and 90 % of it; squares by
their probability, the highest first. Bodies may drift on after the end of a run: steady water, and a random walk.
"""

from dataclasses import dataclass

import numpy as np

BANDWIDTH_M = 5.0
CELL_M = 1.0
SQUARE_M = 10.0  # that a party searches as one


@dataclass(frozen=True)
class Density:
    """Probability by cell of the map, rows along z, which sums up to 1; edges, m."""

    x: np.ndarray
    z: np.ndarray
    share: np.ndarray

    def level(self, held):
        """The density of a cell above which cells hold a share of all: the contour of `held`."""
        ordered = np.sort(self.share.ravel())[::-1]
        return ordered[min(int(np.searchsorted(np.cumsum(ordered), held)), len(ordered) - 1)]

    def area(self, held):
        """Area within that contour, m2."""
        return float((self.share >= self.level(held)).sum() * np.diff(self.x)[0] * np.diff(self.z)[0])


def edges(length, cell=CELL_M):
    return np.linspace(0, length, max(1, round(length / cell)) + 1)


def _kernel(count, cell, bandwidth):
    """Weights from cell to cell along a line, with what would leave it mirrored at its ends."""
    middle = (np.arange(count) + 0.5) * cell
    reach = range(-2, 3) if count * cell > 2 * bandwidth else range(-int(8 * bandwidth / (count * cell)) - 1,
                                                                    int(8 * bandwidth / (count * cell)) + 2)
    length, weights = count * cell, np.zeros((count, count))
    for lap in reach:
        images = 2 * lap * length + middle, 2 * lap * length - middle
        weights += sum(np.exp(-0.5 * ((middle[:, None] - image[None]) / bandwidth) ** 2) for image in images)
    return weights / weights.sum(axis=0)


def density_of(xs, zs, length, width, weights=None, bandwidth=BANDWIDTH_M):
    """Returns the density of last positions in a world of length x width, m; None without positions."""
    if len(xs) == 0:
        return None
    x, z = edges(length), edges(width)
    counts = np.histogram2d(np.clip(zs, 0, width), np.clip(xs, 0, length), [z, x], weights=weights)[0]
    along_z, along_x = (_kernel(len(line) - 1, line[1] - line[0], bandwidth) for line in (z, x))
    share = along_z @ counts @ along_x.T
    return Density(x, z, share / share.sum())


def search_order(density, square=SQUARE_M):
    """[(x, z of the lower corner, m; share in the square, share so far, area so far, m2)], the best square first."""
    x_of = (density.x[:-1] + 1e-9) // square
    z_of = (density.z[:-1] + 1e-9) // square
    shares = np.zeros((int(z_of[-1]) + 1, int(x_of[-1]) + 1))
    np.add.at(shares, (z_of.astype(int)[:, None], x_of.astype(int)[None]), density.share)
    order = np.argsort(-shares.ravel(), kind="stable")
    rows, so_far, area = [], 0.0, 0.0
    for place in order:
        row, column = divmod(int(place), shares.shape[1])
        wide = min(square, density.x[-1] - column * square)
        high = min(square, density.z[-1] - row * square)
        so_far, area = so_far + shares[row, column], area + wide * high
        rows.append((column * square, row * square, float(shares[row, column]), float(so_far), float(area)))
    return rows


# Drift: carried bodies as tracers of the water.

MIXING = 0.1          # K = 0.1 h u*: 0.1 to 0.2 in straight channels (Fischer et al. 1979)
STRAND_SHARE = 0.25   # of the height of a person: in shallower water a lying body touches the ground
STRAND_S = 10.0       # for so long
GRAVITY = 9.81


def mixing_of(depth, speed, manning=0.03):
    """K, m2/s, of water of a depth, m, and speed, m/s: K = 0.1 h u*, u* = u sqrt(g) n h^(-1/6)."""
    depth = np.maximum(depth, 1e-3)
    return MIXING * depth * speed * np.sqrt(GRAVITY) * manning * depth ** (-1 / 6)


@dataclass
class Drift:
    """Bodies that drift: positions, m, time in shallow water, s, and whether each is stranded or off the map."""

    x: np.ndarray
    z: np.ndarray
    height: np.ndarray
    shallow: np.ndarray
    stranded: np.ndarray
    gone: np.ndarray


def start_drift(x, z, height):
    count = len(x)
    return Drift(np.array(x, float), np.array(z, float), np.broadcast_to(np.asarray(height, float), (count,)).copy(),
                 np.zeros(count), np.zeros(count, bool), np.zeros(count, bool))


def drift(bodies, water, duration, dt, seed, manning=0.03, inside=None):
    """Carries bodies for a time: dx = (u + grad K) dt + sqrt(2 K dt) xi. Without grad K they would gather where water mixes
    little (Visser 1997); it is taken over 1 m.

    water(x, z): (depth, m; velocity along x and z, m/s) there. inside(x, z): true for positions on the map.
    A number of the random walk depends on the seed, the step and the body alone.
    """
    random = np.random.default_rng(seed)
    steps = max(1, round(duration / dt))
    for _ in range(steps):
        noise = random.standard_normal((2, len(bodies.x)))
        moving = ~(bodies.stranded | bodies.gone)
        if not moving.any():
            break
        depth, u, w = water(bodies.x, bodies.z)
        k = mixing_of(depth, np.hypot(u, w), manning)
        slopes = [(_mixing_at(water, bodies.x + dx, bodies.z + dz, manning)
                   - _mixing_at(water, bodies.x - dx, bodies.z - dz, manning)) / 1.0 for dx, dz in ((0.5, 0), (0, 0.5))]
        shallow = depth < STRAND_SHARE * bodies.height
        bodies.shallow = np.where(shallow, bodies.shallow + dt, 0)
        bodies.stranded |= moving & (bodies.shallow >= STRAND_S - dt / 2)
        moving &= ~bodies.stranded
        spread = np.sqrt(2 * k * dt)
        bodies.x = np.where(moving, bodies.x + (u + slopes[0]) * dt + spread * noise[0], bodies.x)
        bodies.z = np.where(moving, bodies.z + (w + slopes[1]) * dt + spread * noise[1], bodies.z)
        if inside is not None:
            bodies.gone |= moving & ~inside(bodies.x, bodies.z)
    return bodies


def _mixing_at(water, x, z, manning):
    depth, u, w = water(x, z)
    return mixing_of(depth, np.hypot(u, w), manning)
