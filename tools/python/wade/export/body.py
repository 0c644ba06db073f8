"""A human figure one metre tall as closed, rounded parts, x forward, y up, z to the right: trunk with head, legs, arms.

Proportions after Drillis and Contini (1966). Neighbouring parts overlap, so that no gap opens where a joint turns.
"""

import functools

import numpy as np

HIP, SHOULDER = 0.53, 0.82  # heights
CLOTHS = ("skin", "shirt", "trousers", "shoes", "hair")
SKIN, SHIRT, TROUSERS, SHOES, HAIR = range(len(CLOTHS))
AROUND = 10  # corners of a ring
# Rings from below upwards: x, height above the part's joint, depth, width, cloth of the skin up to the next ring.
TRUNK = [(0, -0.055, 0.045, 0.06, TROUSERS), (0, -0.02, 0.066, 0.09, TROUSERS), (-0.002, 0.03, 0.062, 0.086, TROUSERS),
         (0, 0.07, 0.056, 0.076, SHIRT), (0.003, 0.125, 0.06, 0.082, SHIRT), (0.004, 0.19, 0.067, 0.096, SHIRT),
         (0, 0.245, 0.064, 0.11, SHIRT), (-0.003, 0.28, 0.05, 0.106, SHIRT), (-0.003, 0.302, 0.034, 0.06, SHIRT),
         (0, 0.312, 0.028, 0.032, SKIN), (0.006, 0.335, 0.028, 0.03, SKIN), (0.014, 0.345, 0.042, 0.034, SKIN),
         (0.007, 0.37, 0.054, 0.042, SKIN), (-0.002, 0.405, 0.06, 0.048, HAIR), (-0.004, 0.435, 0.056, 0.046, HAIR),
         (-0.004, 0.458, 0.042, 0.035, HAIR), (-0.006, 0.47, 0.018, 0.015, HAIR)]
LEG = [(0.03, -0.529, 0.07, 0.028, SHOES), (0.028, -0.51, 0.062, 0.029, SHOES), (0.012, -0.494, 0.042, 0.025, SHOES),
       (0, -0.475, 0.026, 0.022, TROUSERS), (-0.002, -0.38, 0.03, 0.027, TROUSERS), (-0.003, -0.295, 0.036, 0.032, TROUSERS),
       (0.003, -0.245, 0.036, 0.033, TROUSERS), (0.003, -0.11, 0.05, 0.044, TROUSERS), (0, -0.03, 0.056, 0.046, TROUSERS),
       (0, 0.02, 0.05, 0.04, TROUSERS), (0, 0.045, 0.02, 0.016, TROUSERS)]
ARM = [(0.006, -0.418, 0.01, 0.007, SKIN), (0.006, -0.38, 0.021, 0.012, SKIN), (0.004, -0.344, 0.02, 0.012, SKIN),
       (0, -0.32, 0.014, 0.014, SKIN), (0, -0.235, 0.021, 0.02, SKIN), (0, -0.12, 0.022, 0.02, SHIRT),
       (0, -0.045, 0.03, 0.027, SHIRT), (0, -0.008, 0.031, 0.028, SHIRT), (0, 0.012, 0.02, 0.018, SHIRT)]
PARTS = {"trunk": TRUNK, "leg": LEG, "arm": ARM}
# Part, joint, and whether it swings with the left leg (1), against it (-1) or not at all (0).
JOINTS = [("trunk", (0, HIP, 0), 0), ("leg", (0, HIP, -0.05), 1), ("leg", (0, HIP, 0.05), -1),
          ("arm", (0, SHOULDER, -0.118), -1), ("arm", (0, SHOULDER, 0.118), 1)]


@functools.cache
def mesh(part):
    """(vertices, normals, triangles, cloth of each triangle) of a part about its joint, triangles ordered by cloth."""
    rings, angle = PARTS[part], 2 * np.pi * np.arange(AROUND) / AROUND
    points = [(x + deep * np.cos(a), y, wide * np.sin(a)) for x, y, deep, wide, _ in rings for a in angle]
    triangles, cloths = [], []
    for n, ring in enumerate(rings[:-1]):
        for k in range(AROUND):
            a, b = n * AROUND + k, n * AROUND + (k + 1) % AROUND
            triangles += [(a, a + AROUND, b), (b, a + AROUND, b + AROUND)]
            cloths += [ring[4]] * 2
    for n, down in ((0, True), (len(rings) - 1, False)):  # lids
        points.append((rings[n][0], rings[n][1], 0))
        for k in range(AROUND):
            a, b = n * AROUND + k, n * AROUND + (k + 1) % AROUND
            triangles.append((len(points) - 1, a, b) if down else (len(points) - 1, b, a))
            cloths.append(rings[n][4])
    points, triangles, cloths = np.array(points), np.array(triangles), np.array(cloths)
    order = np.argsort(cloths, kind="stable")
    triangles, cloths = triangles[order], cloths[order]
    corners = points[triangles]
    faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])  # twice the area long
    normals = np.zeros_like(points)
    for corner in triangles.T:
        np.add.at(normals, corner, faces)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return points.astype("f4"), normals.astype("f4"), triangles.astype("u2"), cloths


def turned(turns, points):
    """Points, (people, corners, 3), turned by a quaternion x, y, z, w each."""
    axis, w = turns[:, None, :3], turns[:, None, 3:]
    twice = 2 * np.cross(axis, points)
    return points + w * twice + np.cross(axis, twice)


def posed(people, turns, swing):
    """(vertices, triangles, cloth of each triangle) of people as they stand, z up; swing: of the left leg, rad.

    turns: how each is turned, quaternions in axes x, y up, -z.
    """
    vertices, triangles, cloths, first = [], [], [], 0
    feet = np.stack([people["x"], people["y"], -people["z"]], axis=1)[:, None, :]
    for part, joint, side in JOINTS:
        points, _, corners, cloth = mesh(part)
        angle = side * swing / 2
        hinge = np.stack([0 * angle, 0 * angle, np.sin(angle), np.cos(angle)], axis=1)
        placed = turned(hinge, np.repeat(points[None].astype(float), len(people), axis=0)) + np.array(joint)
        vertices.append(turned(turns, people["height"][:, None, None] * placed) + feet)
        triangles.append(corners.astype(int) + first)
        cloths.append(cloth)
        first += len(points)
    points = np.concatenate(vertices, axis=1)
    corners = np.concatenate(triangles)[None] + first * np.arange(len(people))[:, None, None]
    x, y, z = points.reshape(-1, 3).T
    return np.stack([x, -z, y], axis=1), corners.reshape(-1, 3), np.tile(np.concatenate(cloths), len(people))
