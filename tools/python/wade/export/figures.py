"""A human figure of boxes, one metre tall, and how a person of a frame holds it; for glTF and USD."""

import numpy as np

from wade.export.sources import CODES

LYING = [CODES["dead"], CODES["drowned"]]
HIP, SHOULDER = 0.53, 0.82  # heights, of the body's (Drillis and Contini 1966)
# (x forward, y up, z to the right hand's side: lower ends, upper ends) of the boxes of each part, about its joint.
PARTS = {
    "trunk": [((-0.06, -0.02, -0.1), (0.06, 0.3, 0.1)), ((-0.05, 0.33, -0.045), (0.06, 0.47, 0.045))],
    "leg": [((-0.05, -0.53, -0.04), (0.05, 0.0, 0.04)), ((0.05, -0.53, -0.04), (0.1, -0.49, 0.04))],
    "arm": [((-0.03, -0.4, -0.025), (0.03, 0.0, 0.025))],
}
# Part, joint, and whether it swings with the left leg (1), against it (-1) or not at all (0).
JOINTS = [("trunk", (0, HIP, 0), 0), ("leg", (0, HIP, -0.05), 1), ("leg", (0, HIP, 0.05), -1),
          ("arm", (0, SHOULDER, -0.13), -1), ("arm", (0, SHOULDER, 0.13), 1)]
CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])


def faces():
    """(normal, four corners, anticlockwise as seen from outside) of a box."""
    for axis in range(3):
        for side in (0, 1):
            normal = np.zeros(3)
            normal[axis] = 2 * side - 1
            u, v = (axis + 1) % 3, (axis + 2) % 3
            square = []
            for a, b in ((0, 0), (1, 0), (1, 1), (0, 1)) if side else ((0, 0), (0, 1), (1, 1), (1, 0)):
                corner = [0, 0, 0]
                corner[axis], corner[u], corner[v] = side, a, b
                square.append(corner)
            yield normal, square


def mesh(part):
    """(vertices, normals, triangles) of a part, right-handed with y up."""
    points, normals, triangles = [], [], []
    for low, high in PARTS[part]:
        low, high = np.array(low), np.array(high)
        for normal, square in faces():
            first = len(points)
            points += [low + (high - low) * corner for corner in np.array(square)]
            normals += [normal] * 4
            triangles += [(first, first + 1, first + 2), (first, first + 2, first + 3)]
    return np.array(points, "f4"), np.array(normals, "f4"), np.array(triangles, "u2")


def multiplied(p, q):
    """Products of quaternions, rows of x, y, z, w: first the turn q, then p."""
    px, py, pz, pw = p.T
    qx, qy, qz, qw = q.T
    return np.stack([pw * qx + px * qw + py * qz - pz * qy, pw * qy - px * qz + py * qw + pz * qx,
                     pw * qz + px * qy - py * qx + pz * qw, pw * qw - px * qx - py * qy - pz * qz], axis=1)


def turns(people):
    """How each person is turned, quaternions x, y, z, w in axes x, y up, -z: by its heading, then by its lean.

    Who is dead lies, downstream of its feet, where the run says nothing of leans (no poses.csv).
    """
    lean_x, lean_z, half = people["lean_x"].astype(float), people["lean_z"], people["heading"].astype(float) / 2
    lean_x = np.where((lean_x == 0) & (lean_z == 0) & np.isin(people["state"], LYING), -np.pi / 2, lean_x)
    still = np.zeros(len(people))
    lean = np.hypot(lean_x, lean_z)
    share = np.where(lean > 0, np.sin(lean / 2) / np.where(lean > 0, lean, 1), 0.5)
    tilt = np.stack([-lean_z * share, still, -lean_x * share, np.cos(lean / 2)], axis=1)  # about y x lean
    turn = multiplied(tilt, np.stack([still, np.sin(half), still, np.cos(half)], axis=1))
    return turn / np.linalg.norm(turn, axis=1, keepdims=True)


def step_length(height, speed):
    """Of who walks, m: Inman et al. (1981), as in poses.csv."""
    return np.sqrt(0.24 * height * speed)


class Gait:
    """Keys of the legs' swing, rad: the left leg ahead or behind at each step's end, none while somebody stands."""

    def __init__(self):
        self.phase, self.time_s = np.empty(0), None

    def keys(self, people):
        """(ids, times, angles) of the keys since the frame before, in order of time for each person."""
        ids, now, before = people["id"], people.time_s, self.time_s
        room = (ids.max() + 1 if len(ids) else 0) - len(self.phase)
        self.phase, self.time_s = np.concatenate([self.phase, np.zeros(max(0, room))]), now
        if before is None:
            return ids, np.full(len(ids), now), np.zeros(len(ids))
        speed = np.hypot(people["vx"], people["vz"])
        step = step_length(people["height"], speed)
        walks = (speed > 0.05) & ~np.isin(people["state"], LYING)
        steps = np.where(walks, speed * (now - before) / np.where(walks, step, 1), 0)  # counted in steps
        angle = np.arcsin(np.minimum(0.6, step / 2 / (HIP * people["height"])))
        found = [(ids[~walks], np.full(np.sum(~walks), now), np.zeros(np.sum(~walks)))]
        old = self.phase[ids]
        for n in range(1, int(np.max(steps, initial=0)) + 2):
            mark = np.floor(old) + n
            made = walks & (mark <= old + steps)
            when = before + (mark - old)[made] / steps[made] * (now - before)
            found.append((ids[made], when, np.where(mark[made] % 2 == 0, 1, -1) * angle[made]))
        self.phase[ids] = old + steps
        return tuple(np.concatenate(parts) for parts in zip(*found))
