"""Opens the files of this folder in Blender: blender --python open_in_blender.py

People of people.gltf walk; the mesh "water" shows the surface_*.ply or surface_*.obj of the current frame. Works in Debian's
Blender 3.4; its glTF import ends by default with "module 'numpy' has no attribute 'bool'" for any file. Blender saves the
people with a .blend; the water needs this script again, as its files stay where they are.
"""

import pathlib
import re

import bpy
import numpy

FOLDER = pathlib.Path(__file__).resolve().parent
RATE = 30  # frames a second


def read_mesh(path):
    """(vertices, triangles) of a file of wade export, z up."""
    data = path.read_bytes()
    if path.suffix == ".ply":
        head, _, body = data.partition(b"end_header\n")
        vertices, faces = (int(re.search(rb"element %s (\d+)" % kind, head)[1]) for kind in (b"vertex", b"face"))
        points = numpy.frombuffer(body, "<f4", 6 * vertices).reshape(-1, 6)[:, :3]
        corners = numpy.frombuffer(body, numpy.dtype([("n", "u1"), ("corners", "<i4", 3)]), faces, 24 * vertices)["corners"]
        return points, corners
    lines = data.decode("ascii").split("\n")
    points = numpy.array([line.split()[1:] for line in lines if line.startswith("v ")], float).reshape(-1, 3)
    corners = numpy.array([line.split()[1:] for line in lines if line.startswith("f ")], int).reshape(-1, 3)
    return points[:, [0, 2, 1]] * [1, -1, 1], corners - 1


def time_of(path):
    """The time of a mesh, s, which its head names."""
    with open(path, "rb") as file:
        return float(re.search(rb"time_s ([0-9.e+-]+)", file.read(200))[1])


def people_of_gltf():
    """Imports people.gltf where there is one."""
    file = FOLDER / "people.gltf"
    if file.exists():
        if "bool" not in vars(numpy):
            numpy.bool = bool  # which numpy 1.24 no longer has and the import of Blender 3.4 asks for
        bpy.ops.import_scene.gltf(filepath=str(file))


def water_of_meshes():
    """Makes the mesh that follows the current frame; returns the time of its last file, s."""
    files = sorted(FOLDER.glob("surface_*.ply")) or sorted(FOLDER.glob("surface_*.obj"))
    if not files:
        return 0
    times = [time_of(file) for file in files]
    water = bpy.data.objects.new("water", bpy.data.meshes.new("water"))
    bpy.context.scene.collection.objects.link(water)

    def show(scene, _depsgraph=None):
        number = max(0, int(numpy.searchsorted(times, scene.frame_current / RATE + 1e-6)) - 1)
        if water.get("file") == files[number].name:
            return
        points, corners = read_mesh(files[number])
        mesh = water.data
        mesh.clear_geometry()
        mesh.from_pydata(points.tolist(), [], corners.tolist())
        mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
        mesh.update()
        water["file"] = files[number].name

    bpy.app.handlers.frame_change_pre.append(show)
    show(bpy.context.scene)
    return times[-1]


def main():
    if "Cube" in bpy.data.objects:  # of Blender's first scene
        bpy.data.objects.remove(bpy.data.objects["Cube"])
    scene = bpy.context.scene
    scene.render.fps, scene.frame_start = RATE, 0
    people_of_gltf()
    ends = [action.frame_range[1] for action in bpy.data.actions]
    scene.frame_end = int(max([1, RATE * water_of_meshes(), *ends]))
    scene.frame_set(0)


if __name__ == "__main__":
    main()
