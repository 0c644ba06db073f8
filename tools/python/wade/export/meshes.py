"""Writers of meshes, a file a frame: the water's surface as PLY with velocities, surface and people as OBJ."""

import numpy as np

from wade.export import body, surfaces
from wade.export.figures import COLOURS, Gait, turns

MATERIALS = "materials.mtl"
FILES = {"water": "surface", "people": "people"}


def bed_of(scene):
    """Height of the bed of a channel along x."""
    points = scene["channel"]["bed_points"]
    if not points:
        return lambda x: np.zeros(len(x))
    x, y = zip(*sorted((point["x_m"], point["y_m"]) for point in points))
    return lambda at: np.interp(at, x, y)


class SurfaceOf:
    """The surface of each frame of a stream of water. scene: of the run, or None; spacing: of the mesh, m, or None."""

    def __init__(self, stream, scene, spacing=None):
        fluid = scene["fluid"] if scene else {}
        self.spacing, self.density = spacing, fluid.get("rest_density_kg_m3", 1000)
        self.bed = bed_of(scene) if scene and not scene.get("site") else None
        self.columns = None if stream.producer != "shallow_water" and fluid.get("model") != "shallow_water" else True
        self.cell = fluid["shallow_water"]["cell_size_m"] if fluid.get("shallow_water") else max(0.5, 2 * stream.radius)

    def __call__(self, points):
        if self.columns is None and len(points):  # water of an unknown producer
            self.columns = surfaces.are_columns(points)
        if self.columns:
            return surfaces.over_columns(points, self.spacing or self.cell, self.density)
        # Coarser grids than this one lose up to a tenth of the volume, where the smoothing rounds edges off.
        spacing = self.spacing or (0.7 * surfaces.spacing_of(points, self.density) if len(points) else 1)
        return surfaces.around_particles(points, spacing, self.density, self.bed)


def surface_of_snapshot(cells, scene):
    """The surface over the cells of a snapshot of water.bin in a channel; cells: as top_view.water_cells gives them."""
    x, z, depth = cells
    bottom = np.broadcast_to(bed_of(scene)((x[1:] + x[:-1]) / 2), depth.shape)
    return surfaces.over_cells(x, z, depth, bottom, [np.zeros_like(depth)] * 3)


def write_ply(path, time_s, mesh):
    """A binary little-endian PLY of a surface in Blender's axes; vertices have velocities."""
    vertices = np.concatenate([mesh.vertices, mesh.velocities], axis=1).astype("<f4")
    faces = np.empty(len(mesh.triangles), np.dtype([("count", "u1"), ("corners", "<i4", 3)]))
    faces["count"], faces["corners"] = 3, mesh.triangles
    properties = "".join(f"property float {name}\n" for name in ("x", "y", "z", "vx", "vy", "vz"))
    with open(path, "wb") as out:
        out.write(f"ply\nformat binary_little_endian 1.0\ncomment time_s {time_s:.9g}\n"
                  "comment m, m/s; x upstream, y across, z up, right-handed\n"
                  f"element vertex {len(vertices)}\n{properties}element face {len(faces)}\n"
                  "property list uchar int vertex_indices\nend_header\n".encode())
        out.write(vertices.tobytes())
        out.write(faces.tobytes())


def write_obj(path, time_s, vertices, groups):
    """An OBJ, y up, of vertices with z up; groups: {name of a group and its material: triangles}."""
    x, y, z = np.asarray(vertices).T
    with open(path, "w", encoding="ascii") as out:
        out.write(f"# time_s {time_s:.9g}; m; x upstream, y up, right-handed\nmtllib {MATERIALS}\no {path.name.partition('_')[0]}\n")
        np.savetxt(out, np.stack([x, z, -y], axis=1), "v %.6g %.6g %.6g")
        for name, triangles in groups.items():
            out.write(f"g {name}\nusemtl {name}\n")
            np.savetxt(out, np.asarray(triangles) + 1, "f %d %d %d")


class Obj:
    """surface_NNNNNN.obj of water, people_NNNNNN.obj of people as they stand."""

    def __init__(self, folder, stream):
        self.folder, self.stream, self.gait = folder, stream, Gait()

    def add(self, points):
        file = self.folder / f"{FILES[self.stream.name]}_{points.number:06d}.obj"
        if self.stream.name == "water":
            mesh = self.stream.surface(points)
            write_obj(file, points.time_s, mesh.vertices, {"water": mesh.triangles})
            return
        self.gait.keys(points)
        vertices, triangles, cloths = body.posed(points, turns(points), self.gait.swing(points))
        write_obj(file, points.time_s, vertices, {name: triangles[cloths == cloth] for cloth, name in enumerate(body.CLOTHS)})

    def finish(self):
        colours = {"water": (0.1, 0.3, 0.4), **dict(zip(body.CLOTHS, COLOURS))}
        text = "".join(f"newmtl {name}\nKd {r} {g} {b}\n" for name, (r, g, b) in colours.items())
        (self.folder / MATERIALS).write_text(text, encoding="ascii")
