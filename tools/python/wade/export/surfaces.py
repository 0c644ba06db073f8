"""The surface of water as a closed mesh of triangles: around particles, or above and below columns."""

import numpy as np

from wade import UsageError

WET_M = 0.01  # thinner columns are dry, as in the maps of a site
MOST_NODES = 30_000_000  # of a grid round the particles, which take about 1 GB
HALF = 0.5  # fraction of the rest density at the surface


class Mesh:
    """Vertices (m) and velocities (m/s), rows of x, y across, z up, right-handed; triangles, anticlockwise from outside."""

    def __init__(self, vertices, triangles, velocities):
        self.vertices, self.triangles, self.velocities = vertices, triangles, velocities


def empty():
    return Mesh(np.empty((0, 3)), np.empty((0, 3), int), np.empty((0, 3)))


def are_columns(points):
    """Whether most particles lie above or below another one, as columns of a depth-averaged model."""
    ground = np.stack([points["x"], points["z"]], axis=1)
    return len(ground) > 0 and len(np.unique(ground, axis=0)) <= len(ground) / 2


def spacing_of(points, density):
    """The distance of particles of this mass, m."""
    return float(np.cbrt(np.median(points["mass"]) / density))


def deposited(places, weights, shape):
    """Weights of points shared by the eight nodes round each (linear); places: in cells, from the first node."""
    first = np.floor(places).astype(int)
    far = places - first
    total = np.zeros(int(np.prod(shape)))
    for corner in np.ndindex(2, 2, 2):
        part = np.prod(np.where(corner, far, 1 - far), axis=1) * weights
        total += np.bincount(np.ravel_multi_index((first + corner).T, shape), part, len(total))
    return total.reshape(shape)


def around_particles(points, spacing, density, bed=None):
    """The surface where the density, smoothed over the distance of particles, is half of that at rest.

    Particles near the bed, a function of x, are mirrored in it, so that the water reaches down to it. Needs scikit-image.
    """
    try:
        from scipy.ndimage import gaussian_filter, map_coordinates
        from skimage.measure import marching_cubes
    except ImportError as error:
        raise UsageError(f"surfaces of particles need scikit-image ({error}); Debian: apt-get install python3-skimage") from error

    if len(points) == 0:
        return empty()
    width = 0.75 * max(spacing, spacing_of(points, density))  # of the smoothing, sharing by nodes included
    rest = np.sqrt(width**2 - spacing**2 / 6) / spacing
    raised = points.z_up()
    places = raised.stacked("x", "y", "z").astype(float)
    velocities, mass = raised.stacked("vx", "vy", "vz"), points["mass"].astype(float)
    if bed is not None:
        depth = places[:, 2] - bed(places[:, 0])
        near = depth < 4 * width
        below = places[near] - 2 * depth[near, None] * [0, 0, 1]
        places, mass = np.concatenate([places, below]), np.concatenate([mass, mass[near]])
        velocities = np.concatenate([velocities, velocities[near] * [1, 1, -1]])
    low = places.min(axis=0) - 5 * width
    shape = tuple(np.ceil((places.max(axis=0) + 5 * width - low) / spacing).astype(int) + 2)
    if np.prod(shape, dtype=float) > MOST_NODES:
        allowed = spacing * np.cbrt(np.prod(shape, dtype=float) / MOST_NODES)
        raise UsageError(f"--spacing: {spacing:g} m makes {np.prod(shape, dtype=float):.2g} nodes; allowed here: {allowed:.2g} m and more")

    def smooth(weights):
        return gaussian_filter(deposited((places - low) / spacing, weights, shape), rest, mode="constant")

    filled = smooth(mass)
    fraction = filled / (density * spacing**3)
    if bed is not None:
        x = low[0] + spacing * np.arange(shape[0])
        z = low[2] + spacing * np.arange(shape[2])
        # What lies below the bed is cut off: the level HALF is at the bed itself.
        fraction = np.minimum(fraction, (HALF + (z[None, :] - bed(x)[:, None]) / spacing)[:, None, :])
    if fraction.max() <= HALF:
        return empty()
    nodes, triangles, _, _ = marching_cubes(fraction, HALF, gradient_direction="ascent")
    velocity = [map_coordinates(np.divide(smooth(mass * v), filled, out=np.zeros(shape), where=filled > 0), nodes.T, order=1)
                for v in velocities.T]
    return Mesh(low + spacing * nodes, triangles, np.stack(velocity, axis=1))


def over_cells(edges_x, edges_z, depth, bottom, velocities):
    """The closed surface of columns: depth, height of their bottom and velocities (rows of vx, vy, vz) of cells by z and x."""
    wet = np.pad(depth >= WET_M, 1)
    if not wet.any():
        return empty()
    rows, columns = len(edges_z), len(edges_x)

    def at_corners(values):
        """Means over the wet cells round each corner."""
        padded = np.pad(np.where(wet[1:-1, 1:-1], values, 0), 1)
        around = [padded[i : i + rows, j : j + columns] for i in (0, 1) for j in (0, 1)]
        return sum(around) / np.maximum(1, sum(wet[i : i + rows, j : j + columns].astype(int) for i in (0, 1) for j in (0, 1)))

    x, y = np.meshgrid(edges_x, edges_z)
    low, flow = at_corners(bottom), np.stack([at_corners(v) for v in velocities], axis=-1).reshape(-1, 3)
    points = [np.stack([x, y, level], axis=-1).reshape(-1, 3) for level in (low + at_corners(depth), low)]
    n = np.arange(x.size).reshape(x.shape)
    a, b, c, d = n[:-1, :-1], n[:-1, 1:], n[1:, 1:], n[1:, :-1]  # corners of a cell, anticlockwise from above
    inner, below = wet[1:-1, 1:-1], x.size
    quads = [np.stack([a, b, c, d], -1)[inner], np.stack([a, d, c, b], -1)[inner] + below]
    for p, q, beyond in ((a, b, wet[:-2, 1:-1]), (b, c, wet[1:-1, 2:]), (c, d, wet[2:, 1:-1]), (d, a, wet[1:-1, :-2])):
        quads.append(np.stack([p, p + below, q + below, q], -1)[inner & ~beyond])
    quads = np.concatenate(quads)
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    used, triangles = np.unique(triangles, return_inverse=True)
    return Mesh(np.concatenate(points)[used], triangles.reshape(-1, 3), np.concatenate([flow, flow])[used])


def over_columns(points, spacing, density):
    """The surface of columns in square cells of this size: depth by their mass, height by their mean height."""
    if len(points) == 0:
        return empty()
    ground = np.stack([points["z"], points["x"]], axis=1).astype(float)
    edges = [spacing * np.arange(np.floor(low / spacing), np.floor(high / spacing) + 2)
             for low, high in zip(ground.min(axis=0), ground.max(axis=0))]

    def summed(weights):
        return np.histogram2d(*ground.T, edges, weights=weights)[0]

    mass = points["mass"].astype(float)
    total = summed(mass)
    depth = total / (density * spacing**2)
    per_mass = np.divide(1, total, out=np.zeros_like(total), where=total > 0)
    middle, *velocities = (summed(mass * points[name]) * per_mass for name in ("y", "vx", "vz", "vy"))
    return over_cells(edges[1], edges[0], depth, middle - depth / 2, velocities)
