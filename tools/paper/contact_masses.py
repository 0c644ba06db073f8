#!/usr/bin/env python3
"""The water that touches an agent, measured in recordings: mean and scatter of the contact mass.

    tools/paper/contact_masses.py [--from-s T] [--box X0,X1,Z0,Z1] RECORDING ...

Puts agents at random into a box of the stream in every tenth frame and sums the particles within 0.25 m of each. What
is compared is the scatter over the mean, as water of another depth has another mean, and the mean share k by which an
agent of Eq. 9 moves with the water, beside that of the mean mass. Records are those of tools/shm/README.md and must not be
compressed: crowd_client SCENE --session a & fluid_server SCENE --session a --consumers 2 &
shm_record a FILE --compression 0.
"""

import argparse
import struct
import sys
from pathlib import Path

import numpy as np

HEAD_BYTES, RECORD_HEAD_BYTES, DESCRIPTOR_BYTES = 64 + 4096, 24, 256
FIELDS = 7  # mass, vx, vy, vz, px, py, pz
CONTACT_M, AGENT_KG, RHO = 0.25, 65, 1000
TAUS = (0.2, 0.8)
PLACES = 2000  # agents in a frame
FRAME_RATE_HZ = 30
EVERY = 10  # frames


def frames(file, first):
    """Particles of every tenth frame from a frame on, arrays [7, count]."""
    with open(file, "rb") as data:
        data.seek(HEAD_BYTES)
        while len(head := data.read(RECORD_HEAD_BYTES)) == RECORD_HEAD_BYTES:
            kind, encoding, size = struct.unpack_from("<4sIQ", head)
            if kind != b"FRAM":
                return
            if encoding != 0:
                sys.exit(f"contact_masses.py: {file}: encoding {encoding}; allowed: 0 (shm_record --compression 0)")
            body = data.read(size)
            _, frame, _, count = struct.unpack_from("<QQQI", body)
            if frame >= first and frame % EVERY == 0 and count > 0:
                yield np.frombuffer(body, "<f4", FIELDS * count, DESCRIPTOR_BYTES).reshape(FIELDS, count)


def masses_in_contact(particles, places):
    """Mass within the contact distance of each place [n, 2] (x, z), kg, of particles [7, count]."""
    cell = CONTACT_M
    points = np.stack((particles[4], particles[6]), axis=1).astype(float)
    corner = np.minimum(points.min(axis=0), places.min(axis=0)) - cell
    size = np.floor((np.maximum(points.max(axis=0), places.max(axis=0)) - corner) / cell).astype(int) + 2
    of_point = ((points - corner) / cell).astype(int) @ (size[1], 1)
    order = np.argsort(of_point, kind="stable")
    start = np.searchsorted(of_point[order], np.arange(size[0] * size[1] + 1))
    touching = np.zeros(len(places))
    for k, (place, (i, j)) in enumerate(zip(places, ((places - corner) / cell).astype(int))):
        for row in (i - 1, i, i + 1):
            near = order[start[row * size[1] + j - 1] : start[row * size[1] + j + 2]]
            inside = ((points[near] - place) ** 2).sum(axis=1) < CONTACT_M**2
            touching[k] += particles[0][near[inside]].sum()
    return touching


def measure(file, first, box):
    """Contact masses, kg; mean depth in the box, m; mean speed there, m/s."""
    random = np.random.default_rng(1)
    x0, x1, z0, z1 = box
    masses, depths, speeds = [], [], []
    for particles in frames(file, first):
        inside = (particles[4] > x0) & (particles[4] < x1) & (particles[6] > z0) & (particles[6] < z1)
        if not inside.any():
            continue
        depths.append(float(particles[0][inside].sum()) / (RHO * (x1 - x0) * (z1 - z0)))
        speeds.append(float(-particles[1][inside].mean()))
        places = random.uniform((x0, z0), (x1, z1), (PLACES, 2))
        masses.append(masses_in_contact(particles, places))
    if not masses:
        sys.exit(f"contact_masses.py: {file}: no water in the box from frame {first} on")
    return np.concatenate(masses), float(np.mean(depths)), float(np.mean(speeds))


def row_of(file, first, box):
    mass, depth, speed = measure(file, first, box)
    mean = mass.mean()
    cells = [Path(file).stem, f"{depth:.3f}", f"{speed:.2f}", f"{mean:.1f}", f"{mass.std():.1f}"]
    cells += [f"{mass.std() / mean:.3f}", f"{100 * np.mean(mass == 0):.1f}"]
    for tau in TAUS:
        k = tau * mass / (AGENT_KG + tau * mass)
        cells += [f"{k.mean():.4f}", f"{k.mean() / (tau * mean / (AGENT_KG + tau * mean)):.4f}"]
    return cells


def numbers(text):
    values = [float(word) for word in text.split(",")]
    if len(values) != 4 or values[0] >= values[1] or values[2] >= values[3]:
        raise argparse.ArgumentTypeError(f'"{text}" is not allowed; allowed: X0,X1,Z0,Z1 with X0 < X1, Z0 < Z1')
    return values


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("recordings", nargs="+", metavar="RECORDING")
    parser.add_argument("--from-s", type=float, default=15, metavar="T", help="time from which frames count, s [15]")
    parser.add_argument("--box", type=numbers, default=[70, 95, 13, 37], help="where agents stand, m [70,95,13,37]")
    options = parser.parse_args()
    head = ["water", "depth m", "speed m/s", "mean kg", "scatter kg", "scatter/mean", "untouched %"]
    for tau in TAUS:
        head += [f"k, tau {tau:g}", "over that of the mean"]
    print("| " + " | ".join(head) + " |\n|" + "---|" * len(head))
    for file in options.recordings:
        print("| " + " | ".join(row_of(file, round(options.from_s * FRAME_RATE_HZ), options.box)) + " |", flush=True)


if __name__ == "__main__":
    main()
