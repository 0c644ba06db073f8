"""Checks whether the particles can be the water of a channel: the first mistakes of whoever brings a solver."""

import json
import subprocess
from dataclasses import dataclass

from wade.conformance.bench import FRAMES
from wade.conformance.expectation import NotApplicable, expect
from wade.conformance.layout import KINDS
from wade.paths import BUILD

WATER = 1000  # kg/m3, where the header gives no rest density
FAR = 1e5  # m, beyond it float32 does not tell centimetres apart
FILLED = (1e-5, 4)  # volume of the particles over the volume of their box: spray .. overlapping columns
INSIDE = 0.9  # share of the particles that lie in the channel, half as wide again on each side
AXES = "xyz"


@dataclass
class Box:
    """Bounds along the world axes x, y (up) and z, in metres."""

    low: list
    high: list

    def extent(self, axis):
        return self.high[axis] - self.low[axis]

    def __str__(self):
        return ", ".join(f"{AXES[i]} {self.low[i]:.4g} .. {self.high[i]:.4g}" for i in range(3)) + " m"


def plausible(bench):
    """Masses are above 0, and the particles fill a box in metres, y up, that fits the channel of the scene."""
    consumer = bench.start().join()
    if consumer.kind != KINDS["fluid"]:
        raise NotApplicable("a stream of agents fills no channel")
    channel, box, most = channel_of(bench), None, 0
    for _ in range(2 * FRAMES):
        if consumer.at_end():
            break
        frame = consumer.take()
        if frame.count:
            box = look_at(consumer.header, frame, channel)
            most = max(most, frame.count)
        consumer.release()
    expect(most, "some frame holds particles", "all are empty")
    compared = f"the channel: {channel}" if channel else "give --scene to compare"
    return f"{most} particles, last in {box}; {compared}"


def scene_of(bench):
    """The resolved scene: of --scene, or of the first scene file in the command; None: not known."""
    scene = bench.scene or next((word for word in bench.command if word.endswith(".json")), None)
    server = BUILD / "fluid_server"
    if not scene or not server.exists():
        return None
    answer = subprocess.run([server, scene, "--print-config"], capture_output=True, text=True, check=False)
    if answer.returncode:
        raise NotApplicable(f"fluid_server does not read {scene}: {answer.stderr.strip()}")
    return json.loads(answer.stdout)


def channel_of(bench):
    """The box of the scene's channel; None: not known."""
    scene = scene_of(bench)
    if scene is None:
        return None
    channel = scene["channel"]
    bed = [point["y_m"] if isinstance(point, dict) else point[1] for point in channel["bed_points"]] or [0.0]
    top = max(channel["height_m"], channel["depth_m"], max(bed))
    return Box([channel["x_min_m"], min(bed), channel["z_min_m"]], [channel["x_max_m"], top, channel["z_max_m"]])


def look_at(header, frame, channel):
    """The box of a frame's particles, which has to be plausible."""
    mass = memoryview(frame.fields[0]).cast("f")
    lightest = min(mass)
    expect(lightest > 0, "a mass is above 0 kg", f"frame {frame.frame} has one of {lightest:g} kg")
    places = [world_axis(header, frame, axis) for axis in range(3)]
    box = Box(list(map(min, places)), list(map(max, places)))
    expect(max(map(abs, box.low + box.high)) <= FAR,
           f"positions lie within {FAR:g} m of the origin (Header.origin moves it)", f"frame {frame.frame}: {box}")
    expect_filled(header, frame, sum(mass), box)
    if channel:
        expect_inside(frame, places, box, channel)
    else:
        expect(box.extent(1) <= box.extent(2) or box.low[1] <= box.extent(1) / 4,
               "y is up, from the bed at 0 on", f"frame {frame.frame} hangs in the air, higher than wide: {box}")
    return box


def world_axis(header, frame, axis):
    stored = abs(header.axes[axis]) - 1
    factor = header.metres_per_unit * (1 if header.axes[axis] > 0 else -1)
    return [header.origin[axis] + factor * value for value in memoryview(frame.fields[4 + stored]).cast("f")]


def expect_filled(header, frame, kilograms, box):
    volume = kilograms / (header.rest_density or WATER)
    spacing = (volume / frame.count) ** (1 / 3)  # a particle has a size of its own
    room = 1.0
    for axis in range(3):
        room *= box.extent(axis) + spacing
    filled = volume / room
    expect(FILLED[0] <= filled <= FILLED[1],
           f"particles of {kilograms:.4g} kg in all take {FILLED[0]:g} to {FILLED[1]:g} of their box, in metres",
           f"{filled:.2g} of it in frame {frame.frame}: {box}")


def expect_inside(frame, places, box, channel):
    """Most particles lie in the channel or not far from it."""
    margins = [max(channel.extent(axis), 1.0) / 2 for axis in range(3)]
    inside = sum(all(channel.low[a] - margins[a] <= place[a] <= channel.high[a] + margins[a] for a in range(3))
                 for place in zip(*places))
    expect(inside >= INSIDE * frame.count, f"the particles lie in the channel ({channel})",
           f"{inside} of {frame.count} in frame {frame.frame} do: {box}")


ALL = (plausible,)
