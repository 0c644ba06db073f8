"""What a run of either engine did, measured against what is known: one set of formulas for both.

A scene here is one of beside_splishsplash.py; volume: of a particle, its mass over the rest density, m3.
"""

import math
import re
from dataclasses import dataclass

import numpy as np

from wade.paths import ROOT


@dataclass
class Frame:
    """Places, velocities and pressures of all particles at a time; m, m/s, Pa."""

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
