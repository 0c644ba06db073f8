"""Cases that Wade and SPlisHSPlasH both run: a scene for each, and what it did against what is known, by one set of formulas.

volume: of a particle, its mass over the rest density, m3.
"""

import math
import re
from dataclasses import dataclass, field

import numpy as np

from wade.paths import ROOT


TOLERANCE, DIVERGENCE_TOLERANCE = 5e-4, 1e-3  # of both engines: those of the scenes that SPlisHSPlasH ships
LONGEST_STEP = 5e-3  # s of its model, as there
MODEL = 0.1  # units of its model in a metre of the paper's river, and seconds in one of ours, as its authors ran it


@dataclass
class Scene:
    """A tank with a block of water at its far end of x; m, s. Or a stream from x = length on a dry bed."""

    name: str
    kind: str  # selects the reference
    spacing: float
    duration: float
    every: float  # between frames
    tank: tuple  # length, height, width
    block: tuple = None  # length along x from the far end, height, width in the middle of the tank
    boxes: list = field(default_factory=list)  # (x0, x1, height, z0, z1) on the bed
    viscosity: float = 0.01  # m2/s
    gravity: float = 9.81
    velocity: float = 0.0  # of the stream; 0: there is none

    def scale(self):
        """Units of the peer's model in a metre: its particles are as large as in its own scenes in the river only."""
        return MODEL if self.velocity else 1.0


def dam_break(name, spacing, duration, every):
    return Scene(name, "dam_break", spacing, duration, every, (4, 3, 1.5), (1, 1, 1))


def collapse(spacing):
    return Scene(f"collapse_{spacing:g}", "collapse", spacing, 0.54, 0.005, (3, 2, 0.5), (0.5, 1, 0.5), viscosity=1e-6)


def spheric2(name, spacing):
    return Scene(name, "spheric2", spacing, 3.01, 0.005, (3.22, 2, 1), (1.228, 0.55, 1),
                 [(0.6635, 0.8245, 0.161, 0.2985, 0.7015)], 1e-6)


SCENES = (
    dam_break("dam_break_8k", 0.05, 3, 0.1), dam_break("dam_break_27k", 1 / 30, 0.6, 0.05),
    dam_break("dam_break_97k", 1 / 46, 0.3, 0.05),
    collapse(0.05), collapse(0.025),
    Scene("column_0.05", "column", 0.05, 4, 1 / 30, (1, 2, 1), (1, 1, 1)),
    spheric2("spheric2_4k", 0.055), spheric2("spheric2_11k", 0.04),
    Scene("river", "river", 0.5, 28, 1, (100, 3, 27), gravity=0.981, velocity=1.5),
)
QUICK = ("dam_break_27k", "collapse_0.05", "river")

# Of each kind: main error first; name -> words.
ERRORS = {
    "dam_break": {"mean_density_error": "mean density error", "max_density_error": "largest density error",
                  "compression": "compression"},
    "collapse": {"front": "RMS error of the front, Martin and Moyce", "mean_density_error": "mean density error",
                 "compression": "compression"},
    "column": {"rms_speed": "RMS speed at rest / sqrt(g H)", "pressure": "RMS error of the pressure / (rho g H)",
               "bed_pressure": "error of the pressure at the bed", "level": "error of the level",
               "mean_density_error": "mean density error", "compression": "compression"},
    "spheric2": {"height": "RMS error of the heights / 0.55 m", "pressure": "RMS error of the pressure / its peak",
                 "peak": "error of the pressure's peak", "mean_density_error": "mean density error",
                 "compression": "compression"},
    "river": {"depth": "error of the depth", "speed": "error of the speed", "mean_density_error": "mean density error"},
}


def wade_scene(scene, variant):
    """Our scene file."""
    length, _, width = scene.tank
    channel = {"x_min_m": 0, "x_max_m": length, "z_min_m": 0, "z_max_m": width, "flow": "closed"}
    if scene.velocity:
        channel.update(flow="emitter", depth_m=1, velocity_m_s=scene.velocity, initial_river="dry")
        most = 24000
    else:
        along, height, across = scene.block
        channel["water_blocks"] = [{"x_min_m": length - along, "x_max_m": length, "z_min_m": (width - across) / 2,
                                    "z_max_m": (width + across) / 2, "depth_m": height}]
        most = math.ceil(1.05 * along * height * across / scene.spacing**3)
    fluid = {"particle_spacing_m": scene.spacing, "max_particles": most, "viscosity_m2_s": scene.viscosity,
             "density_solve": {"tolerance": TOLERANCE}, "divergence_solve": {"tolerance": DIVERGENCE_TOLERANCE}}
    obstacles = [{"x_min_m": b[0], "x_max_m": b[1], "height_m": b[2], "z_min_m": b[3], "z_max_m": b[4]}
                 for b in scene.boxes]
    return {"description": f"{scene.name}, beside SPlisHSPlasH, no agents. Froude number of its kind.",
            "duration_s": scene.duration, "frame_rate_hz": 1 / scene.every,
            "world": {"length_m": length, "width_m": width, "gravity_m_s2": scene.gravity},
            "channel": channel, "obstacles": obstacles, "fluid": {**fluid, **variant}}


def their_block(scene):
    """The block as SPlisHSPlasH fills one: its outermost particles a spacing within, each 0.8 of its cube.

    Nearer to the edges of a wall its volume maps throw particles out. The dam break stands as SPlisHSPlasH ships it,
    5 cm from bed and wall. The collapse and SPHERIC 2 have its denser pattern, 8 % under density at first, which starts
    without a shock. In SPHERIC 2 the block is as high as its known volume of water requires.
    """
    length, _, width = scene.tank
    along, height, across = scene.block
    d = scene.spacing
    if scene.kind == "spheric2":
        # Of that pattern: round(side / d) - 2 particles along x and z, layers sqrt(3)/2 of a spacing apart.
        row = (round(along / d) - 2) * (round(across / d) - 2) * 0.8 * d**3
        height = (round(along * height * across / row) + 1) * math.sqrt(3) / 2 * d
    return {"denseMode": int(scene.kind in ("collapse", "spheric2")),
            "start": [length - along, 0.0, (width - across) / 2], "end": [length, height, (width + across) / 2],
            "translation": [-0.05, 0.05, 0] if scene.kind == "dam_break" else [0, 0, 0], "scale": [1, 1, 1]}


def splishsplash_scene(scene):
    """The same for SPlisHSPlasH, with the settings of the dam break that it ships; its x and y are ours."""
    unit = scene.scale()
    radius = scene.spacing / 2 * unit
    length, height, width = (side * unit for side in scene.tank)
    cell = 0.1 if scene.kind == "dam_break" else 4 * radius

    def box(x0, x1, top, z0, z1, **more):
        sides = [x1 - x0, top, z1 - z0]
        # Cells of the volume map as in that scene: two particles long, in the dam break 10 cm whatever the spacing.
        return {"geometryFile": "box.obj", "translation": [(x0 + x1) / 2, top / 2, (z0 + z1) / 2], "scale": sides,
                "isDynamic": False, "mapThickness": 0.0,
                "mapResolution": [max(5, round(side / cell)) for side in sides], **more}

    beyond = length / 10 if scene.velocity else 0  # a stream has no wall where we look
    bodies = [box(-beyond, length + beyond, height, 0, width, isWall=True, mapInvert=True)]
    bodies += [box(*(side * unit for side in b), isWall=False, mapInvert=False) for b in scene.boxes]
    document = {
        "Configuration": {
            "particleRadius": radius, "simulationMethod": 4, "gravitation": [0, -9.81, 0], "timeStepSize": LONGEST_STEP,
            "cflMethod": 1, "cflFactor": 1, "cflMaxTimeStepSize": LONGEST_STEP, "boundaryHandlingMethod": 2,
            "DFSPH": {"minIterations": 2, "maxIterations": 100, "maxError": 100 * TOLERANCE, "maxIterationsV": 100,
                      "maxErrorV": 100 * DIVERGENCE_TOLERANCE, "enableDivergenceSolver": True}},
        "Materials": [{"id": "Fluid", "density0": 1000, "viscosityMethod": 1,
                       "Standard viscosity": {"viscosity": scene.viscosity * unit, "viscosityBoundary": 0}}],
        "RigidBodies": bodies}
    if scene.velocity:
        document["Materials"][0]["maxEmitterParticles"] = 40000
        document["Emitters"] = [{"id": "Fluid", "type": 0, "width": round(scene.tank[2] / scene.spacing), "height": 2,
                                 "translation": [length, 2 * radius, width / 2], "rotationAxis": [0, 1, 0],
                                 "rotationAngle": math.pi, "velocity": scene.velocity}]
    else:
        document["FluidBlocks"] = [their_block(scene)]
    return document


def box_mesh():
    """A box of side 1 round the origin, its triangles seen from outside."""
    corners = [f"v {x - 0.5} {y - 0.5} {z - 0.5}" for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    faces = ((1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4))
    triangles = [t for a, b, c, d in faces for t in (f"f {a} {b} {c}", f"f {a} {c} {d}")]
    return "\n".join(corners + triangles) + "\n"


@dataclass
class Frame:
    """Positions, velocities and pressures of all particles at a time; m, m/s, Pa."""

    time: float
    x: np.ndarray  # (3, n)
    v: np.ndarray
    p: np.ndarray


def read_frames(file, length=1.0, time=1.0):
    """The frames of a file, one by one; length, time: of a unit of the model, m and s."""
    with open(file, "rb") as data:
        while head := data.read(16):
            seconds, (n,) = np.frombuffer(head[:8])[0], np.frombuffer(head[8:], np.uint64)
            body = np.frombuffer(data.read(28 * int(n)), np.float32).reshape(7, int(n)).astype(float)
            yield Frame(seconds * time, body[:3] * length, body[3:6] * length / time, body[6] * (length / time) ** 2)


def numbers_after(source, start, end):
    """The numbers between two marks of a file of tests/validation: the truth is written down once."""
    text = (ROOT / "tests" / "validation" / source).read_text(encoding="utf-8")
    body = text[text.index(start) + len(start):]
    return [float(word) for word in re.findall(r"-?\d+\.?\d*", body[: body.index(end)])]


def martin_and_moyce():
    """T = t sqrt(2 g / a) and Z = front / a up to T = 3.3."""
    values = numbers_after("cases_dam_break.cpp", "18> measured{", ";")
    return [(t, z) for t, z in zip(values[::2], values[1::2]) if t <= 3.3]


def kleefsman():
    """Heights at four gauges and pressures at two sensors every 0.25 s, and the peaks of the pressures; m, Pa."""
    heights = numbers_after("spheric2_reference.cpp", "table.height = {", ";")
    pressures = numbers_after("spheric2_reference.cpp", "table.pressure = {", ";")
    return (np.reshape(heights, (4, 13)), np.reshape(pressures, (2, 13)),
            numbers_after("spheric2_reference.cpp", "table.peak = {", "}"))


def spline(q):
    """The cubic spline of support 1, times its cube."""
    return 8 / np.pi * np.where(q <= 0.5, 6 * (q**3 - q**2) + 1, np.where(q < 1, 2 * (1 - np.minimum(q, 1)) ** 3, 0))


def wall_pressure(frame, point, volume, reach):
    """As probes.hpp of tests/validation: the mean of the particles nearer than two spacings, by the cubic spline."""
    q = np.linalg.norm(frame.x - np.reshape(point, (3, 1)), axis=0) / reach
    weights = volume * spline(q) / reach**3
    return float(np.sum(weights * frame.p) / max(np.sum(weights), 0.25))


def wet_length(frame, x, z, volume, reach):
    """As there: the volume round a wire over the area that it stands on."""
    along, across = 1 - np.abs(frame.x[0] - x) / reach, 1 - np.abs(frame.x[2] - z) / reach
    return float(np.sum(np.maximum(along, 0) * np.maximum(across, 0)) * volume / reach**2)


def measure_collapse(scene, frames, volume):
    """The farthest stretch of a spacing where the water is a quarter of a spacing deep, in units of the column's width.

    Single drops that fly ahead do not count.
    """
    a, d = scene.block[0], scene.spacing
    edges = np.arange(0, scene.tank[0] + d / 2, d)
    times, fronts = [0.0], [1.0]
    for frame in frames:
        times.append(frame.time * math.sqrt(2 * scene.gravity / a))
        reached = scene.tank[0] - frame.x[0]
        wet = np.nonzero(np.histogram(reached, edges)[0] * volume >= d / 4 * d * scene.tank[2])[0].max()
        fronts.append((reached[reached < edges[wet + 1]].max() + d / 2) / a)
    errors = [np.interp(t, times, fronts) / z - 1 for t, z in martin_and_moyce()]
    return {"front": float(np.sqrt(np.mean(np.square(errors)))), "front_lead": float(np.mean(errors))}


def measure_column(scene, frames, volume):
    """Of the second half of the run. The depth is that of the water's own volume; level: against it."""
    area = scene.tank[0] * scene.tank[2]
    speeds, pressures, heights = [], [], []
    layers = round(scene.block[1] / scene.spacing)
    for frame in frames:
        if frame.time <= scene.duration / 2:
            continue
        speeds.append(math.sqrt(np.mean(np.sum(frame.v**2, axis=0))))
        order = np.argsort(frame.x[1])
        pressures.append([np.mean(part) for part in np.array_split(frame.p[order], layers)])
        heights.append([np.mean(part) for part in np.array_split(frame.x[1][order], layers)])
        depth = volume * frame.x.shape[1] / area
    pressure, height = np.mean(pressures, axis=0), np.mean(heights, axis=0)
    whole = 1000 * scene.gravity * depth
    error = (pressure - 1000 * scene.gravity * (depth - height)) / whole
    return {"rms_speed": max(speeds) / math.sqrt(scene.gravity * depth),
            "pressure": float(np.sqrt(np.mean(error[1:-1] ** 2))), "bed_pressure": float(abs(error[0])),
            "level": float(abs(2 * np.mean(height) / depth - 1)), "depth_of_own_volume_m": depth,
            "level_asked": float(abs(2 * np.mean(height) / scene.block[1] - 1))}


def measure_spheric2(scene, frames, volume):
    """Heights at the times of the table; pressures as means of 20 ms round them."""
    reach = 2 * scene.spacing
    gauges, sensors = (0.496, 0.992, 1.488, 2.638), ((0.8245, 0.021, 0.5), (0.8245, 0.101, 0.5))
    times, heights, pressures = [], [], []
    for frame in frames:
        times.append(frame.time)
        heights.append([wet_length(frame, x, 0.5, volume, reach) for x in gauges])
        pressures.append([wall_pressure(frame, point, volume, reach) for point in sensors])
    times, heights, pressures = np.array(times), np.array(heights), np.array(pressures)
    table, measured, peaks = kleefsman()
    asked = 0.25 * np.arange(1, 13)
    depth = np.array([[np.interp(t, times, h) for t in asked] for h in heights.T])

    def windowed(t):
        return pressures[np.abs(times - t) <= 0.0101].mean(axis=0)

    pressure = np.array([windowed(t) for t in asked]).T
    tops = np.array([windowed(t) for t in np.arange(0.02, 3, 0.02)]).max(axis=0)
    return {"height": float(np.mean(np.sqrt(np.mean((depth - table[:, 1:]) ** 2, axis=1))) / scene.block[1]),
            "pressure": float(np.mean(np.sqrt(np.mean((pressure - measured[:, 1:]) ** 2, axis=1)) / peaks)),
            "peak": float(np.mean(np.abs(tops / peaks - 1)))}


def measure_river(scene, frames, volume):
    """The last frame by columns of 5 m, where the exact depth is above 0.15 m, against the exact shallow water.

    Water that comes in with u0 > c0 over a dry bed spreads from u0 - c0 to u0 + 2 c0; before that it is as it came in.
    """
    *_, last = frames
    start = math.sqrt(scene.gravity * 1.0)
    edges = np.arange(0, scene.tank[0] + 1e-9, 5)
    along = scene.tank[0] - last.x[0]
    volumes, _ = np.histogram(along, edges, weights=np.full(along.size, volume))
    speeds, _ = np.histogram(along, edges, weights=-volume * last.v[0])
    depth = volumes / (5 * scene.tank[2])
    pace = np.clip((edges[:-1] + edges[1:]) / 2 / last.time, scene.velocity - start, scene.velocity + 2 * start)
    wave = (scene.velocity + 2 * start - pace) / 3
    exact, speed = wave**2 / scene.gravity, pace + wave
    wet = exact > 0.15
    mean = speeds[wet] / np.maximum(volumes[wet], 1e-9)
    return {"depth": float(np.mean(np.abs(depth[wet] - exact[wet]))),
            "speed": float(np.mean(np.abs(mean - speed[wet])) / scene.velocity)}


def inner(scene, frame, reach):
    """The particles of a frame that see no wall, bed or box within the reach of the kernel."""
    x, y, z = frame.x
    away = (x > reach) & (x < scene.tank[0] - reach) & (y > reach) & (z > reach) & (z < scene.tank[2] - reach)
    for x0, x1, top, z0, z1 in scene.boxes:
        away &= ~((x > x0 - reach) & (x < x1 + reach) & (y < top + reach) & (z > z0 - reach) & (z < z1 + reach))
    return away


def compression(scene, frame, volume):
    """Mean of max(0, rho / rho_0 - 1) over the particles away from walls, rho by the cubic spline of two spacings.

    None where there are fewer than 50 of them, as in two layers of water.
    """
    reach = 2 * scene.spacing
    away = inner(scene, frame, reach)
    if np.count_nonzero(away) < 50:
        return None
    cells = np.floor(frame.x / reach).astype(np.int64)
    cells -= cells.min(axis=1, keepdims=True) - 1
    sizes = cells.max(axis=1) + 2
    key = (cells[0] * sizes[1] + cells[1]) * sizes[2] + cells[2]
    order = np.argsort(key, kind="stable")
    x, key, away = frame.x[:, order], key[order], away[order]
    places, keys = x[:, away], key[away]
    density = np.zeros(keys.size)
    for offset in np.ndindex(3, 3, 3):
        other = keys + ((offset[0] - 1) * sizes[1] + offset[1] - 1) * sizes[2] + offset[2] - 1
        first, last = np.searchsorted(key, other, "left"), np.searchsorted(key, other, "right")
        for k in range(int((last - first).max(initial=0))):
            there = first + k < last
            q = np.linalg.norm(places[:, there] - x[:, (first + k)[there]], axis=0) / reach
            density[there] += spline(q)
    return float(np.mean(np.maximum(density * volume / reach**3 - 1, 0)))


MEASURES = {"dam_break": lambda *_: {}, "collapse": measure_collapse, "column": measure_column,
            "spheric2": measure_spheric2, "river": measure_river}


def measured(scene, frames, volume):
    """All errors of a run; the compression is the mean of ten frames, or of all if there are fewer."""
    every = max(1, round(scene.duration / scene.every / 10))
    found = []

    def watched():
        for k, frame in enumerate(frames, 1):
            if k % every == 0:
                found.append(compression(scene, frame, volume))
            yield frame

    passed = watched()
    errors = MEASURES[scene.kind](scene, passed, volume)
    for _ in passed:  # a measure need not look at any frame
        pass
    known = [value for value in found if value is not None]
    return {**errors, "compression": float(np.mean(known)) if known else None}
