"""Checks whether the water is published densely enough for what people sample of it.

A person samples means over a cone of radius R, w = max(0, 1 - r / R) in the ground plane. A column counts with the mean of w over
its rectangle, a point with w at its position. Blocks of 2 m inside the water are sampled at 13 x 13 positions, which fall on all
phases of a grid. The error of a block is the largest of its positions, the verdict is the median of the blocks: a front or a bank
spoils some blocks, a sampling that is too coarse all of them.
"""

import math
from collections import defaultdict
from dataclasses import dataclass
from statistics import median

from wade.conformance.bench import FRAMES
from wade.conformance.checks_plausible import WATER, scene_of, world_axis
from wade.conformance.expectation import NotApplicable, expect
from wade.conformance.layout import KINDS

LEAST_RADIUS = 0.5  # m, that of a body; people sample the particles of a solver within 1.5 spacings
LARGEST_RADIUS = 2  # m
BLOCK, STEPS, BLOCKS = 2.0, 13, 9  # m, positions along a side, number of blocks
SHALLOW = 0.1  # of the deepest block: blocks with less hold spray
REMEDY = ("depth-averaged water: one column a cell with Header.column_width, as wade_columns of the C library writes them; "
          "particles of a solver: Header.particle_radius = half of their spacing (docs/people_in_water.md, "
          "\"How densely water is sampled\")")


@dataclass
class Limit:
    """Allowed error of the sampled depth, and why it is that large."""

    error: float
    reason: str


# Chosen from the error of the cone on square grids of points, the largest at any position and any spacing up to the one named:
# 3.6 % at 0.53 R, 11 % at 2/3 R, 15 % at 1.06 R, 38 % at 1.2 R, 115 % at 1.5 R. Solvers may have one layer of particles anywhere in
# their cells, 2/3 R apart: the median of nine blocks then is 44 %, and in one of a thousand frames more than 56 %.
OF_COLUMNS = Limit(0.03, "columns are integrated exactly, so that rounding and gaps alone are left")
OF_POINTS = Limit(0.05, "points up to 0.53 R apart err by less")
OF_PARTICLES = Limit(0.60, "a layer of particles anywhere in their cells, 2/3 R wide, errs by less")


@dataclass
class Sample:
    depth: float
    speed: float
    lowest: float  # depth of the columns in reach
    highest: float


class Water:
    """A frame seen from above, in world metres, sorted into square cells.

    spacing: of the scene, m; a crowd chooses R by it; without a scene twice the radius of the header.
    """

    def __init__(self, header, frame, spacing=None):
        x, z = world_axis(header, frame, 0), world_axis(header, frame, 2)
        self.width = header.column_width if header.column_width[0] > 0 else None
        self.density = header.rest_density or WATER
        particles = min(max(LEAST_RADIUS, 1.5 * (spacing or 2 * header.particle_radius)), LARGEST_RADIUS)
        self.radius = LEAST_RADIUS if self.width else particles
        if self.width:
            self.limit = OF_COLUMNS
        else:
            self.limit = OF_PARTICLES if header.particle_radius > 0 else OF_POINTS
        self.x, self.z = x, z
        self.mass = memoryview(frame.fields[0]).cast("f")
        self.u, self.v = ground_velocity(header, frame, 0), ground_velocity(header, frame, 2)
        half = (self.width[0] / 2, self.width[1] / 2) if self.width else (0, 0)
        self.reach = self.radius + half[0], self.radius + half[1]
        self.cell = max(self.reach)
        self.bins = defaultdict(list)
        for k in range(frame.count):
            self.bins[math.floor(x[k] / self.cell), math.floor(z[k] / self.cell)].append(k)

    def interior(self):
        """Returns the bounds along x and z of positions with a cone in the water's box, half a cell from its edge."""
        return [(min(axis) + self.radius, max(axis) - self.radius) for axis in (self.x, self.z)]

    def near(self, x, z):
        column, row = math.floor(x / self.cell), math.floor(z / self.cell)
        for i in (column - 1, column, column + 1):
            for j in (row - 1, row, row + 1):
                for k in self.bins.get((i, j), ()):
                    if abs(self.x[k] - x) < self.reach[0] and abs(self.z[k] - z) < self.reach[1]:
                        yield k

    def weight(self, dx, dz):
        """Returns the cone at a particle dx, dz away, or its mean over the column there."""
        if not self.width:
            return max(0.0, 1 - math.hypot(dx, dz) / self.radius)
        return mean_of_cone(dx / self.radius, dz / self.radius, self.width[0] / self.radius, self.width[1] / self.radius)

    def sample(self, x, z):
        total = along = across = 0.0
        lowest, highest = math.inf, 0.0
        for k in self.near(x, z):
            mass = self.mass[k]
            weighed = mass * self.weight(self.x[k] - x, self.z[k] - z)
            if weighed <= 0:
                continue
            total += weighed
            along += weighed * self.u[k]
            across += weighed * self.v[k]
            if self.width:
                depth = mass / (self.density * self.width[0] * self.width[1])
                lowest, highest = min(lowest, depth), max(highest, depth)
        if total == 0:
            return Sample(0, 0, 0, 0)
        cone = math.pi * self.radius**2 / 3
        return Sample(total / (self.density * cone), math.hypot(along, across) / total, lowest, highest)


def ground_velocity(header, frame, axis):
    """Returns the world velocity of each particle along an axis, m/s."""
    stored = abs(header.axes[axis]) - 1
    factor = header.metres_per_unit * (1 if header.axes[axis] > 0 else -1)
    return [factor * value for value in memoryview(frame.fields[1 + stored]).cast("f")]


def cone_up_to(x, z):
    """Returns the integral over 0 .. x of max(0, 1 - sqrt(x^2 + z^2)); z in [0, 1)."""
    chord = math.sqrt(1 - z * z)
    to = min(abs(x), chord)
    curved = z * z * math.asinh(to / z) if z > 0 else 0
    return math.copysign(to - (to * math.hypot(to, z) + curved) / 2, x)


# Gauss's rule of four points on [-1, 1].
NODES = (0.339981043584856, 0.652145154862546), (0.861136311594053, 0.347854845137454)


def mean_of_cone(x, z, width_x, width_z):
    """Returns the mean of the cone of radius 1 over a rectangle round (x, z): exact along x, by quadrature across.

    The quadrature runs over t, z = sin(t), between the kinks: the axis, the rim, and the lines where the sides of the
    rectangle leave the disc.
    """
    if math.hypot(max(abs(x) - width_x / 2, 0), max(abs(z) - width_z / 2, 0)) >= 1:
        return 0.0
    low, high = max(-1.0, z - width_z / 2), min(1.0, z + width_z / 2)
    sides = [side for side in (x - width_x / 2, x + width_x / 2) if abs(side) < 1]
    kinks = [0.0] + [sign * math.sqrt(1 - side * side) for side in sides for sign in (-1, 1)]
    edges = sorted({low, high, *(kink for kink in kinks if low < kink < high)})
    total = 0.0
    for start, end in zip(edges, edges[1:]):
        start, end = math.asin(start), math.asin(end)
        middle, half = (start + end) / 2, (end - start) / 2
        for node, share in NODES:
            for t in (middle - half * node, middle + half * node):
                line = cone_up_to(x + width_x / 2, abs(math.sin(t))) - cone_up_to(x - width_x / 2, abs(math.sin(t)))
                total += half * share * math.cos(t) * line
    return total / (width_x * width_z)


class Block:
    """Samples of a square of 2 m."""

    def __init__(self, water, x, z):
        steps = [BLOCK * (k + 0.5) / STEPS for k in range(STEPS)]
        self.offsets = [(a - BLOCK / 2, b - BLOCK / 2) for a in steps for b in steps]
        self.samples = [water.sample(x + a, z + b) for a in steps for b in steps]
        self.depth = sum(s.depth for s in self.samples) / len(self.samples)
        self.has_columns = water.width is not None

    def error(self):
        return max(self.off_columns() if self.has_columns else self.off_plane())

    def off_columns(self):
        """Returns how far each depth lies outside the depths of the columns in reach, relative to the largest."""
        return [max(s.depth - s.highest, s.lowest - s.depth, 0) / s.highest if s.highest else 1 for s in self.samples]

    def off_plane(self):
        """Returns the distance of each depth from the plane through all, over their mean: a sloping surface is no error."""
        squares = sum(a * a for a, _ in self.offsets)
        along = sum(a * s.depth for (a, _), s in zip(self.offsets, self.samples)) / squares
        across = sum(b * s.depth for (_, b), s in zip(self.offsets, self.samples)) / squares
        return [abs(s.depth - self.depth - along * a - across * b) / self.depth
                for (a, b), s in zip(self.offsets, self.samples)]


def blocks_of(water):
    """Returns blocks that hold water, chosen evenly; only blocks between other wet blocks, if there are any."""
    (x_lo, x_hi), (z_lo, z_hi) = water.interior()
    if min(x_hi - x_lo, z_hi - z_lo) < BLOCK:
        raise NotApplicable(f"the water is too narrow to tell: it has to be {BLOCK + 2 * water.radius:g} m wide")
    columns, rows = (int((high - low + 1e-9) / BLOCK) for low, high in ((x_lo, x_hi), (z_lo, z_hi)))
    wet = {(math.floor((x - x_lo) / BLOCK), math.floor((z - z_lo) / BLOCK)) for x, z in zip(water.x, water.z)}
    inner = {(i, j) for i, j in wet if 0 <= i < columns and 0 <= j < rows}
    amid = [(i, j) for i, j in inner if all((i + a, j + b) in wet for a in (-1, 0, 1) for b in (-1, 0, 1))]
    found = sorted(amid or inner)
    chosen = sorted({round(k * (len(found) - 1) / (BLOCKS - 1)) for k in range(BLOCKS)}) if found else []
    blocks = [Block(water, x_lo + BLOCK * found[k][0], z_lo + BLOCK * found[k][1]) for k in chosen]
    least = SHALLOW * max((block.depth for block in blocks), default=0)
    return [block for block in blocks if block.depth > least]


def sampling(bench):
    """People sample the same depth wherever they stand between the published positions of the water."""
    consumer = bench.start().join()
    if consumer.kind != KINDS["fluid"]:
        raise NotApplicable("people sample no stream of agents")
    last = None
    for _ in range(FRAMES):
        if consumer.at_end():
            break
        frame = consumer.take()
        if frame.count:
            last = frame
        consumer.release()
    if last is None:
        raise NotApplicable("there is no water to sample")
    scene = scene_of(bench)
    return judge(Water(consumer.header, last, scene and scene["fluid"]["particle_spacing_m"]))


def judge(water):
    """Returns what the blocks show; raises Violation where their error is above the limit."""
    blocks = blocks_of(water)
    if not blocks:
        raise NotApplicable("people sample no water in any block of 2 m")
    errors = [block.error() for block in blocks]
    samples = [sample for block in blocks for sample in block.samples]
    depths, speeds = [s.depth for s in samples], [s.speed for s in samples]
    kind = f"columns of {water.width[0]:.3g} x {water.width[1]:.3g} m" if water.width else "points"
    dry = 100 * depths.count(0) / len(depths)
    shown = (f"{kind}, R = {water.radius:.3g} m: depth {min(depths):.3g} .. {max(depths):.3g} m, none at {dry:.0f} % of the positions; "
             f"speed {min(speeds):.3g} .. {max(speeds):.3g} m/s; error {100 * median(errors):.1f} %, worst {100 * max(errors):.1f} %")
    limit = water.limit
    expect(median(errors) <= limit.error,
           f"the depth that people sample differs by at most {100 * limit.error:g} % from that of the water ({limit.reason})",
           f"{shown}. Remedy: {REMEDY}")
    return f"{shown}; allowed {100 * limit.error:g} %"


ALL = (sampling,)
