"""Writes particles as Points and people as a PointInstancer into one .usda, with time samples."""

import shutil

import numpy as np

from wade.export.figures import JOINTS, mesh, turns
from wade.export.sources import STATES

RATE = 30  # time codes a second
HEAD = """#usda 1.0
(
    defaultPrim = "wade"
    metersPerUnit = 1
    upAxis = "Z"
    timeCodesPerSecond = {rate}
    framesPerSecond = {rate}
    startTimeCode = {first:.9g}
    endTimeCode = {last:.9g}
)

def Xform "wade"
{{
"""


def numbers(array):
    """Rows as USD writes them: (1, 2, 3), (4, 5, 6)."""
    if len(array) == 0:
        return ""
    form = "%d" if array.dtype.kind == "i" else "%.7g"
    row = form if array.ndim == 1 else "(" + ", ".join([form] * array.shape[1]) + ")"
    return ", ".join([row] * len(array)) % tuple(array.ravel().tolist())


def rotated(points):
    """Vertices with y up as those with z up."""
    x, y, z = points.T
    return np.stack([x, -z, y], axis=1)


def figure_text():
    """The figure as a mesh, one metre tall, z up; it looks along x."""
    vertices, corners, first = [], [], 0
    for part, joint, _ in JOINTS:
        points, _, triangles = mesh(part)
        vertices.append(points + np.array(joint, "f4"))
        corners.append(triangles.astype(int) + first)
        first += len(points)
    points, corners = rotated(np.concatenate(vertices)), np.concatenate(corners)
    return f"""        def Xform "Figures"
        {{
            def Mesh "figure"
            {{
                int[] faceVertexCounts = [{numbers(np.full(len(corners), 3))}]
                int[] faceVertexIndices = [{numbers(corners.ravel())}]
                point3f[] points = [{numbers(points)}]
                uniform token subdivisionScheme = "none"
            }}
        }}
"""


class Usd:
    """One .usda. Each attribute grows in a file of its own, and all are put together at the end."""

    def __init__(self, folder, stream):
        self.folder, self.name, self.radius = folder, stream.name, stream.radius
        self.parts, self.first, self.last = {}, None, 0.0

    def sample(self, kind, name, code, array):
        if (kind, name) not in self.parts:
            self.parts[kind, name] = open(self.folder / f".{self.name}-{len(self.parts)}.part", "w+", encoding="utf-8")
        self.parts[kind, name].write(f"            {code:.9g}: [{numbers(array)}],\n")

    def add(self, points):
        code = points.time_s * RATE
        self.first, self.last = code if self.first is None else self.first, code
        turned = turns(points) if self.name == "people" else None
        points = points.z_up()
        places, velocities = points.stacked("x", "y", "z"), points.stacked("vx", "vy", "vz")
        if self.name == "water":
            self.sample("point3f[]", "points", code, places)
            self.sample("vector3f[]", "velocities", code, velocities)
            self.sample("float[]", "primvars:mass", code, points["mass"])
            return
        self.sample("point3f[]", "positions", code, places)
        self.sample("vector3f[]", "velocities", code, velocities)
        x, y, z, w = turned.T  # of axes x, y up, -z
        self.sample("quath[]", "orientations", code, np.stack([w, x, -z, y], axis=1))
        self.sample("float3[]", "scales", code, np.repeat(points["height"][:, None], 3, axis=1))
        self.sample("int64[]", "ids", code, points["id"])
        self.sample("int[]", "protoIndices", code, np.zeros(len(points), "i4"))
        self.sample("int[]", "primvars:state", code, points["state"])

    def finish(self):
        kind = "Points" if self.name == "water" else "PointInstancer"
        with open(self.folder / f"{self.name}.usda", "w", encoding="utf-8") as out:
            out.write(HEAD.format(rate=RATE, first=self.first or 0, last=self.last))
            out.write(f'    def {kind} "{self.name}"\n    {{\n')
            if self.name == "water":
                out.write(f"        float[] widths = [{2 * self.radius:.6g}] (\n"
                          '            interpolation = "constant"\n        )\n')
            else:
                words = ", ".join(f'"{word}"' for word in STATES)
                out.write(f"        custom uniform token[] states = [{words}]\n"
                          "        rel prototypes = [</wade/people/Figures/figure>]\n")
            for (kind, name), part in self.parts.items():
                out.write(f"        {kind} {name}.timeSamples = {{\n")
                part.seek(0)
                shutil.copyfileobj(part, out)
                out.write("        }\n")
                part.close()
            out.write(("" if self.name == "water" else figure_text()) + "    }\n}\n")
        for part in self.folder.glob(f".{self.name}-*.part"):
            part.unlink()
