"""Writes people as figures that walk, into people.gltf and people.bin (glTF 2.0; right-handed, y up)."""

import json

import numpy as np

from wade.export.figures import JOINTS, PARTS, Gait, mesh, turns

FLOAT, SHORT = 5126, 5123  # component types
VERTICES, INDICES = 34962, 34963  # targets
CHUNK = 1 << 18  # rows that are in memory at once


class Spool:
    """Rows of people, written as they come and sorted by person at the end, within files."""

    def __init__(self, file, width):
        self.file, self.kind = file, np.dtype([("who", "<i4"), ("time", "<f4"), ("values", "<f4", (width,))])
        self.out, self.counts = open(file, "w+b"), np.zeros(0, dtype=int)

    def add(self, ids, times, values):
        rows = np.empty(len(ids), self.kind)
        rows["who"], rows["time"], rows["values"] = ids, times, values
        self.out.write(rows.tobytes())
        counts = np.bincount(ids, minlength=len(self.counts))
        counts[: len(self.counts)] += self.counts
        self.counts = counts

    def by_person(self):
        """(times, values, first row of each person) as arrays that lie in files."""
        total = int(self.counts.sum())
        starts = np.concatenate([[0], np.cumsum(self.counts)])
        times = np.memmap(f"{self.file}.times", "<f4", "w+", shape=(max(1, total),))
        values = np.memmap(f"{self.file}.values", "<f4", "w+", shape=(max(1, total), self.kind["values"].shape[0]))
        cursor = starts[:-1].copy()
        self.out.seek(0)
        while len(data := self.out.read(CHUNK * self.kind.itemsize)):
            rows = np.frombuffer(data, self.kind)
            rows = rows[np.argsort(rows["who"], kind="stable")]
            who, first, count = np.unique(rows["who"], return_index=True, return_counts=True)
            place = np.arange(len(rows)) - np.repeat(first, count) + np.repeat(cursor[who], count)
            times[place], values[place] = rows["time"], rows["values"]
            cursor[who] += count
        self.out.close()
        return times, values, starts


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
            points, normals, triangles = mesh(part)
            made.append({"name": part, "primitives": [{
                "attributes": {"POSITION": self.stored(out, points, VERTICES, "VEC3", True),
                               "NORMAL": self.stored(out, normals, VERTICES, "VEC3")},
                "indices": self.stored(out, triangles.ravel(), INDICES), "material": 0}]})
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
            "meshes": meshes, "materials": [{"name": "clothes", "pbrMetallicRoughness": {
                "baseColorFactor": [0.7, 0.25, 0.1, 1], "metallicFactor": 0, "roughnessFactor": 0.8}}],
            "animations": [{"name": "run", "samplers": samplers, "channels": channels}], "accessors": self.accessors,
            "bufferViews": self.views, "buffers": [{"uri": "people.bin", "byteLength": self.bytes}],
        }
        if not roots:
            document = {"asset": document["asset"]}
        with open(self.folder / "people.gltf", "w", encoding="utf-8") as out:
            json.dump(document, out)
        for part in self.folder.glob(".*.part*"):
            part.unlink()
