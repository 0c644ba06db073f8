"""How a person holds the figure of body.py, and the writers of scenes: glTF 2.0 of people, USD of people and water."""

import json
import shutil

import numpy as np

from wade.export.body import CLOTHS, HIP, JOINTS, PARTS, mesh
from wade.export.sources import Spool
from wade.states import CODES, LOST, code_lists

FLOAT, SHORT = 5126, 5123  # component types
VERTICES, INDICES = 34962, 34963  # targets

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

LYING = code_lists(LOST)
COLOURS = ((0.55, 0.3, 0.2), (0.7, 0.25, 0.1), (0.05, 0.06, 0.1), (0.03, 0.03, 0.03), (0.1, 0.06, 0.035))  # of body.CLOTHS


def multiplied(p, q):
    """Products of quaternions, rows of x, y, z, w: first the turn q, then p."""
    px, py, pz, pw = p.T
    qx, qy, qz, qw = q.T
    return np.stack([pw * qx + px * qw + py * qz - pz * qy, pw * qy - px * qz + py * qw + pz * qx,
                     pw * qz + px * qy - py * qx + pz * qw, pw * qw - px * qx - py * qy - pz * qz], axis=1)


def turns(people):
    """Returns rotations of people, quaternions x, y, z, w in axes x, y up, -z: by the heading, then by the lean.

    A dead person lies downstream of its feet if the run holds no leans (no poses.csv).
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
    """Returns the step length of a walking person, m: Inman et al. (1981), as in poses.csv."""
    return np.sqrt(0.24 * height * speed)


class Gait:
    """Keys of the legs' swing, rad: the left leg ahead or behind at each step's end, 0 while the person stands."""

    def __init__(self):
        self.phase, self.time_s = np.empty(0), None

    def keys(self, people):
        """(ids, times, angles) of the keys since the frame before, in order of time for each person."""
        ids, now, before = people["id"], people.time_s, self.time_s
        room = (ids.max() + 1 if len(ids) else 0) - len(self.phase)
        self.phase, self.time_s = np.concatenate([self.phase, np.zeros(max(0, room))]), now
        if before is None:
            self.amplitude = np.zeros(len(ids))
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
        self.amplitude = np.where(walks, angle, 0.0)
        return tuple(np.concatenate(parts) for parts in zip(*found))

    def swing(self, people):
        """The left leg's swing at the last frame, rad, between its keys."""
        return self.amplitude * np.cos(np.pi * self.phase[people["id"]])


class Gltf:
    """people.gltf: a node a person, with hinged legs and arms, and one animation."""

    def __init__(self, folder, stream):
        self.folder, self.gait = folder, Gait()
        self.places, self.swings = Spool(folder / ".places.part", 7), Spool(folder / ".swings.part", 1)
        self.heights, self.ends = {}, {}
        self.bytes, self.views, self.accessors = 0, [], []

    def add(self, people):
        places = np.stack([people["x"], people["y"], -people["z"]], axis=1)
        times = np.full(len(people), people.time_s)
        self.places.add(people["id"], times, np.concatenate([places, turns(people)], axis=1))
        ids, times, angles = self.gait.keys(people)
        self.swings.add(ids, times, angles[:, None])
        self.heights.update(zip(people["id"].tolist(), people["height"].tolist()))

    def stored(self, out, array, target=None, kind="SCALAR", range_of=False):
        """Puts an array into the binary file; the number of its accessor."""
        array = np.ascontiguousarray(array)
        data = array.tobytes()
        view = {"buffer": 0, "byteOffset": self.bytes, "byteLength": len(data)}
        self.views.append(view | ({"target": target} if target else {}))
        accessor = {"bufferView": len(self.views) - 1, "componentType": SHORT if array.dtype == np.uint16 else FLOAT,
                    "count": len(array), "type": kind}
        if range_of:
            rows = array.reshape(len(array), -1)
            accessor |= {"min": rows.min(axis=0).tolist(), "max": rows.max(axis=0).tolist()}
        self.accessors.append(accessor)
        padding = -len(data) % 4
        out.write(data + bytes(padding))
        self.bytes += len(data) + padding
        return len(self.accessors) - 1

    def meshes(self, out):
        made = []
        for part in PARTS:
            points, normals, triangles, cloths = mesh(part)
            attributes = {"POSITION": self.stored(out, points, VERTICES, "VEC3", True),
                          "NORMAL": self.stored(out, normals, VERTICES, "VEC3")}
            made.append({"name": part, "primitives": [
                {"attributes": attributes, "indices": self.stored(out, triangles[cloths == cloth].ravel(), INDICES),
                 "material": int(cloth)} for cloth in np.unique(cloths)]})
        return made

    def person(self, out, who, tracks, nodes, samplers, channels):
        """Nodes and animation of one person; the number of its node."""
        (times, values, starts), (swing_times, swings, swing_starts) = tracks
        rows = slice(starts[who], starts[who + 1])
        node, height = len(nodes), self.heights[who]
        nodes.append({"name": f"person {who}", "extras": {"id": who}, "scale": [height] * 3,
                      "translation": values[rows.start, :3].tolist(), "rotation": values[rows.start, 3:].tolist(),
                      "children": [node + 1 + i for i in range(len(JOINTS))]})
        parts = list(PARTS)
        nodes += [{"mesh": parts.index(part), "translation": list(joint)} for part, joint, _ in JOINTS]

        def animate(keys, output, kind, path, targets):
            samplers.append({"input": keys, "output": self.stored(out, output, kind=kind)})
            channels.extend({"sampler": len(samplers) - 1, "target": {"node": n, "path": path}} for n in targets)

        keys = self.stored(out, times[rows], range_of=True)
        animate(keys, values[rows, :3], "VEC3", "translation", [node])
        animate(keys, values[rows, 3:], "VEC4", "rotation", [node])
        rows = slice(swing_starts[who], swing_starts[who + 1])
        half = swings[rows, 0] / 2
        keys = self.stored(out, swing_times[rows], range_of=True)
        still = np.zeros_like(half)
        for side in (1, -1):  # a leg that is ahead has turned about z, which points to the right
            turn = np.stack([still, still, np.sin(side * half), np.cos(half)], axis=1)
            animate(keys, turn, "VEC4", "rotation", [node + 1 + i for i, (_, _, s) in enumerate(JOINTS) if s == side])
        return node

    def finish(self):
        nodes, samplers, channels = [], [], []
        with open(self.folder / "people.bin", "wb") as out:
            meshes = self.meshes(out)
            tracks = self.places.by_person(), self.swings.by_person()
            roots = [self.person(out, who, tracks, nodes, samplers, channels) for who in sorted(self.heights)]
        document = {
            "asset": {"version": "2.0", "generator": "Wade"}, "scene": 0, "scenes": [{"nodes": roots}], "nodes": nodes,
            "meshes": meshes, "materials": [{"name": name, "pbrMetallicRoughness": {
                "baseColorFactor": [*colour, 1], "metallicFactor": 0, "roughnessFactor": 0.8}}
                for name, colour in zip(CLOTHS, COLOURS)],
            "animations": [{"name": "run", "samplers": samplers, "channels": channels}], "accessors": self.accessors,
            "bufferViews": self.views, "buffers": [{"uri": "people.bin", "byteLength": self.bytes}],
        }
        if not roots:
            document = {"asset": document["asset"]}
        with open(self.folder / "people.gltf", "w", encoding="utf-8") as out:
            json.dump(document, out)
        for part in self.folder.glob(".*.part*"):
            part.unlink()


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
        points, _, triangles, _ = mesh(part)
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


BONES = ("trunk", "trunk/leg_left", "trunk/leg_right", "trunk/arm_left", "trunk/arm_right")  # of JOINTS
BINDS = ' (\n                prepend apiSchemas = ["SkelBindingAPI"]\n            )'


def skeleton_texts():
    """What all skeletons have alike: names of joints, transforms, their part of an animation, the skin of the mesh."""
    joints = rotated(np.array([joint for _, joint, _ in JOINTS], "f4"))
    local = joints - joints[:1] * (np.arange(len(joints)) > 0)[:, None]
    of_vertices = np.concatenate([np.full(len(mesh(part)[0]), k) for k, (part, _, _) in enumerate(JOINTS)])

    def transforms(places):
        return ", ".join(f"((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), ({numbers(row)}, 1))" for row in places)

    def skin(kind, name, values):
        return (f"                {kind}[] primvars:skel:{name} = [{numbers(values)}] (\n                    elementSize = 1\n"
                '                    interpolation = "vertex"\n                )\n')

    names = ", ".join(f'"{name}"' for name in BONES)
    return (f"                uniform token[] joints = [{names}]\n",
            f"                uniform matrix4d[] bindTransforms = [{transforms(joints)}]\n"
            f"                uniform matrix4d[] restTransforms = [{transforms(local)}]\n",
            f"                float3[] translations = [{numbers(local)}]\n"
            f"                half3[] scales = [{numbers(np.ones((len(joints), 3)))}]\n",
            skin("int", "jointIndices", of_vertices) + skin("float", "jointWeights", np.ones(len(of_vertices))))


class Skeletons:
    """figures.usda: a SkelRoot per person, moved as a whole, with a Skeleton of swinging limbs and a skinned Mesh."""

    def __init__(self, folder):
        self.folder, self.gait, self.rows, self.heights = folder, Gait(), Spool(folder / ".figures.part", 8), {}

    def add(self, people, places, turn):
        self.gait.keys(people)
        rows = np.concatenate([places, turn, self.gait.swing(people)[:, None]], axis=1)
        self.rows.add(people["id"], np.full(len(people), people.time_s * RATE), rows)
        self.heights.update(zip(people["id"].tolist(), people["height"].tolist()))

    def finish(self, head):
        (times, values, starts), sides = self.rows.by_person(), np.array([side for _, _, side in JOINTS])
        joints, transforms, rest, skin = skeleton_texts()
        with open(self.folder / "figures.usda", "w", encoding="utf-8") as out:
            out.write(head + figure_text().replace('def Xform "Figures"', 'class "Figures"'))
            for who, height in sorted(self.heights.items()):
                rows = slice(starts[who], starts[who + 1])

                def samples(name, texts, rows=rows):
                    out.write(f"{name}.timeSamples = {{\n")
                    out.writelines(f"                {code:.9g}: {text},\n" for code, text in zip(times[rows], texts))
                    out.write("            }\n")

                out.write(f'        def SkelRoot "person_{who}"\n        {{\n            custom int id = {who}\n')
                samples("            double3 xformOp:translate", map(numbers, values[rows, None, :3]))
                samples("            quatf xformOp:orient", map(numbers, values[rows, None, 3:7]))
                out.write(f"            float3 xformOp:scale = ({height:.4g}, {height:.4g}, {height:.4g})\n            uniform token[] "
                          'xformOpOrder = ["xformOp:translate", "xformOp:orient", "xformOp:scale"]\n')
                path = f"/wade/person_{who}"
                out.write(f'            def Skeleton "skeleton"{BINDS}\n            {{\n{joints}{transforms}'
                          f"                rel skel:animationSource = <{path}/walk>\n            }}\n"
                          f'            def SkelAnimation "walk"\n            {{\n{joints}{rest}')
                half = values[rows, 7:] * sides / 2  # about the axis to the right, which is -y
                turns_of = np.stack([np.cos(half), 0 * half, -np.sin(half), 0 * half], axis=2)
                samples("                quatf[] rotations", (f"[{numbers(turn)}]" for turn in turns_of))
                out.write('            }\n            def Mesh "figure" (\n                prepend apiSchemas = ["SkelBindingAPI"]\n'
                          "                prepend references = </wade/Figures/figure>\n            )\n            {\n"
                          f"{skin}                rel skel:skeleton = <{path}/skeleton>\n            }}\n        }}\n")
            out.write("}\n")
        for part in self.folder.glob(".figures.part*"):
            part.unlink()


class Usd:
    """One .usda, of people figures.usda, too. Each attribute grows in a file of its own, and all are put together at the end."""

    def __init__(self, folder, stream):
        self.folder, self.name, self.radius = folder, stream.name, stream.radius
        self.parts, self.first, self.last = {}, None, 0.0
        self.skeletons = Skeletons(folder) if stream.name == "people" else None

    def sample(self, kind, name, code, array):
        if (kind, name) not in self.parts:
            self.parts[kind, name] = open(self.folder / f".{self.name}-{len(self.parts)}.part", "w+", encoding="utf-8")
        self.parts[kind, name].write(f"            {code:.9g}: [{numbers(array)}],\n")

    def add(self, points):
        code = points.time_s * RATE
        self.first, self.last = code if self.first is None else self.first, code
        turned, people = turns(points) if self.name == "people" else None, points
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
        self.skeletons.add(people, places, np.stack([w, x, -z, y], axis=1))
        self.sample("float3[]", "scales", code, np.repeat(points["height"][:, None], 3, axis=1))
        self.sample("int64[]", "ids", code, points["id"])
        self.sample("int[]", "protoIndices", code, np.zeros(len(points), "i4"))
        self.sample("int[]", "primvars:state", code, points["state"])

    def finish(self):
        kind = "Points" if self.name == "water" else "PointInstancer"
        with open(self.folder / f"{self.name}.usda", "w", encoding="utf-8") as out:
            head = HEAD.format(rate=RATE, first=self.first or 0, last=self.last)
            out.write(head)
            out.write(f'    def {kind} "{self.name}"\n    {{\n')
            if self.name == "water":
                out.write(f"        float[] widths = [{2 * self.radius:.6g}] (\n"
                          '            interpolation = "constant"\n        )\n')
            else:
                words = ", ".join(f'"{word}"' for word in CODES)
                out.write(f"        custom uniform token[] states = [{words}]\n"
                          "        rel prototypes = [</wade/people/Figures/figure>]\n")
            for (kind, name), part in self.parts.items():
                out.write(f"        {kind} {name}.timeSamples = {{\n")
                part.seek(0)
                shutil.copyfileobj(part, out)
                out.write("        }\n")
                part.close()
            out.write(("" if self.name == "water" else figure_text()) + "    }\n}\n")
        if self.skeletons and self.first is not None:
            self.skeletons.finish(head)
        for part in self.folder.glob(f".{self.name}-*.part"):
            part.unlink()
