"""Renders a moment of a run with Blender, without a screen: the water as a surface, people as figures, the sun and the sky.

Water of the snapshots in water.bin, which come every 5 s by default, or of a recording (--water); a picture at the time of
a snapshot shows both at the same time. Needs Blender 3.4 or later. The ground is level where the scene has it level.
"""

import argparse
import pathlib
import re
import subprocess
import sys
import tempfile

import numpy as np

SHIRTS = ((0.62, 0.06, 0.04), (0.75, 0.42, 0.02), (0.05, 0.2, 0.5), (0.6, 0.6, 0.58), (0.05, 0.32, 0.16), (0.35, 0.05, 0.3))
BODY = ((0.55, 0.3, 0.2), (0.03, 0.035, 0.05), (0.015, 0.015, 0.015), (0.06, 0.035, 0.02))  # skin, trousers, shoes, hair
GROUND, BED, STONE, GOAL = (0.3, 0.27, 0.16), (0.2, 0.17, 0.12), (0.3, 0.3, 0.31), (0.9, 0.55, 0.02)
QUADS = np.array([(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)])  # of a box's corners
CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])


def boxes(ends):
    """(vertices, quads) of boxes, rows of low x, y, z and high x, y, z."""
    ends = np.asarray(ends, float).reshape(-1, 6)
    points = ends[:, None, :3] + (ends[:, None, 3:] - ends[:, None, :3]) * CORNERS
    return points.reshape(-1, 3), (QUADS[None] + 8 * np.arange(len(ends))[:, None, None]).reshape(-1, 4)


def figures(people, swing):
    """(vertices, triangles, colour of each triangle) of people, z up; swing: of the left leg, rad."""
    from wade.export import body
    from wade.export.figures import turns

    points, triangles, cloths = body.posed(people, turns(people), swing)
    shirts = np.repeat(people["id"] % len(SHIRTS), len(cloths) // max(1, len(people)))
    others = {body.SKIN: 0, body.TROUSERS: 1, body.SHOES: 2, body.HAIR: 3}
    colours = np.array([len(SHIRTS) + others.get(cloth, 0) for cloth in range(len(body.CLOTHS))])[cloths]
    return points, triangles, np.where(cloths == body.SHIRT, shirts, colours)


def surface(options, scene):
    """The mesh of the water's surface at the time: around the particles of a recording, else over the cells of a snapshot."""
    from wade.export import sources, surfaces
    from wade.export.meshes import SurfaceOf, surface_of_snapshot
    from wade.pictures import top_view
    from wade.pictures.film import Snapshots

    if options.water:
        stream, newest = sources.of_recording(options.water), None
        for frame in stream.frames():
            if frame.time_s > options.time + 1e-9:
                break
            newest = frame
        return SurfaceOf(stream, scene)(newest.points()) if newest else surfaces.empty()
    _, snapshot = Snapshots(options.run / "water.bin").at(options.time)
    return surface_of_snapshot(top_view.water_cells(snapshot, scene), scene) if snapshot else surfaces.empty()


def people_at(run, time_s):
    """The frame of people nearest before a time, and the swing of their left legs, rad."""
    from wade import UsageError
    from wade.export.figures import Gait
    from wade.export.sources import Thinning, of_run

    gait, people, swing = Gait(), None, None
    for people in of_run(run).points(Thinning(until_s=time_s)):
        gait.keys(people)
        swing = gait.swing(people)
    if people is None:
        raise UsageError(f"{run} holds nobody at {time_s:g} s")
    return people, swing


def job(options):
    """All that Blender draws, as arrays by name."""
    from wade.export.meshes import bed_of
    from wade.export.sources import scene_of

    scene = scene_of(options.run)
    people, swing = people_at(options.run, options.time)
    parts = {}

    def add(name, points, quads, colours, colour_of=0):
        parts[f"{name} points"], parts[f"{name} quads"] = np.asarray(points, "f4"), np.asarray(quads, "i4")
        parts[f"{name} colours"] = np.asarray(colours, "f4").reshape(-1, 3)
        parts[f"{name} colour of"] = np.broadcast_to(np.asarray(colour_of, "i4"), len(quads))

    points, triangles, colours = figures(people, swing)
    add("people", points, triangles, (*SHIRTS, *BODY), colours)
    world, channel, bed = scene["world"], scene["channel"], bed_of(scene)
    far = 6 * max(world["length_m"], world["width_m"])
    x = np.unique([-far, *(point["x_m"] for point in channel["bed_points"]), world["length_m"] + far])
    sides = (-far, world["width_m"] + far)
    ground = np.concatenate([np.column_stack([x, np.full(len(x), z), bed(x) - 0.01]) for z in sides])
    n = np.arange(len(x) - 1)
    add("ground", ground, np.stack([n, n + 1, n + 1 + len(x), n + len(x)], 1), GROUND)
    ends = (channel["x_min_m"], channel["z_min_m"], -0.4, channel["x_max_m"], channel["z_max_m"], -0.005)
    if channel["flow"] != "closed" and not channel["bed_points"]:
        add("bed", *boxes(ends), BED)
    stones = [(box["x_min_m"], box["z_min_m"], 0, box["x_max_m"], box["z_max_m"], box.get("height_m", 0) or 4)
              for box in scene.get("obstacles", [])]
    if stones:
        add("obstacles", *boxes(stones), STONE)
    goals = {(group["goal"]["x_m"], group["goal"]["z_m"]) for group in scene["crowd"]["groups"]
             if group["goal"].get("to") != "shelters"}
    poles = [(gx - 0.08, gz - 0.08, 0, gx + 0.08, gz + 0.08, 4) for gx, gz in goals if 0 <= gx <= world["length_m"]]
    if poles:
        add("goals", *boxes(poles), GOAL)
    water = surface(options, scene)
    if len(water.triangles):
        add("water", water.vertices + [0, 0, 0.005], water.triangles, (0, 0, 0))  # above the bed
    look, eye = camera(people, options)
    return parts | {"look": look, "eye": eye}


def camera(people, options):
    """Where the camera looks and where it is, z up: at the people, from the side where they started, unless told."""
    x, z = people["x"], people["z"]
    on_way = np.isin(people["state"], (1, 2), invert=True)
    on_way = on_way if on_way.any() else np.ones(len(people), bool)
    middle = np.array([x[on_way].mean(), z[on_way].mean(), 0.6])
    reach = max(9.0, 1.1 * np.hypot(x[on_way].std(), z[on_way].std()) + 8)
    look = np.array(options.look)[[0, 2, 1]] if options.look else middle
    eye = np.array(options.eye)[[0, 2, 1]] if options.eye else middle + reach * np.array([-0.75, -1, 0.5])
    return look, eye


def draw_in_blender(arrays, picture, width, height, samples):
    """Called by Blender's own Python: builds the scene and renders it with Cycles."""
    import bpy
    from mathutils import Vector

    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene, data = bpy.context.scene, bpy.data

    def shader(name):
        material = data.materials.new(name)
        material.use_nodes = True
        return material, material.node_tree, material.node_tree.nodes["Principled BSDF"]

    for name in sorted({key.rsplit(" ", 1)[0] for key in arrays if key.endswith(" points")}):
        shape = data.meshes.new(name)
        shape.from_pydata(arrays[f"{name} points"].tolist(), [], arrays[f"{name} quads"].tolist())
        thing = data.objects.new(name, shape)
        scene.collection.objects.link(thing)
        for colour in arrays[f"{name} colours"].tolist():
            material, tree, surface_node = shader(name)
            shape.materials.append(material)
            surface_node.inputs["Base Color"].default_value = (*colour, 1)
            surface_node.inputs["Roughness"].default_value = 0.85
            if name == "water":
                tree.nodes.remove(surface_node)
                # Light goes straight through, so that what is below is lit; the surface mirrors the sky by Fresnel's law.
                kinds = ("BsdfTransparent", "BsdfDiffuse", "MixShader", "BsdfGlossy", "MixShader", "Fresnel",
                         "VolumeAbsorption", "Bump", "TexNoise", "TexCoord")
                clear, mud, inner, mirror, mixed, fresnel, body, bump, noise, place = (
                    tree.nodes.new(f"ShaderNode{kind}") for kind in kinds)
                mud.inputs["Color"].default_value, inner.inputs[0].default_value = (0.05, 0.2, 0.24, 1), 0.45
                fresnel.inputs["IOR"].default_value, mirror.inputs["Roughness"].default_value = 1.333, 0.06
                body.inputs["Color"].default_value, body.inputs["Density"].default_value = (0.3, 0.6, 0.6, 1), 0.7
                noise.inputs["Scale"].default_value, noise.inputs["Detail"].default_value = 1.4, 5
                bump.inputs["Strength"].default_value, bump.inputs["Distance"].default_value = 0.3, 0.1
                out = tree.nodes["Material Output"]
                for a, b in (
                    (place.outputs["Object"], noise.inputs["Vector"]), (noise.outputs["Fac"], bump.inputs["Height"]),
                    (bump.outputs["Normal"], mirror.inputs["Normal"]), (bump.outputs["Normal"], fresnel.inputs["Normal"]),
                    (clear.outputs["BSDF"], inner.inputs[1]), (mud.outputs["BSDF"], inner.inputs[2]),
                    (fresnel.outputs["Fac"], mixed.inputs[0]), (inner.outputs["Shader"], mixed.inputs[1]),
                    (mirror.outputs["BSDF"], mixed.inputs[2]), (mixed.outputs["Shader"], out.inputs["Surface"]),
                    (body.outputs["Volume"], out.inputs["Volume"]),
                ):
                    tree.links.new(a, b)
        shape.polygons.foreach_set("material_index", arrays[f"{name} colour of"])
        if name in ("people", "water"):
            shape.polygons.foreach_set("use_smooth", [True] * len(shape.polygons))
        shape.update()
    world = data.worlds.new("sky")
    scene.world, world.use_nodes = world, True
    sky = world.node_tree.nodes.new("ShaderNodeTexSky")
    sky.sun_elevation, sky.sun_rotation, sky.sun_disc = 0.6, 2.4, False  # the sun is a lamp, which makes no noise
    sun = data.objects.new("sun", data.lights.new("sun", "SUN"))
    sun.data.energy, sun.data.angle, sun.rotation_euler = 3.0, 0.02, (0.85, 0.1, 0.6)
    scene.collection.objects.link(sun)
    background = world.node_tree.nodes["Background"]
    background.inputs["Strength"].default_value = 0.12
    world.node_tree.links.new(sky.outputs["Color"], background.inputs["Color"])
    eye, look = Vector(arrays["eye"].tolist()), Vector(arrays["look"].tolist())
    scene.camera = data.objects.new("camera", data.cameras.new("camera"))
    scene.camera.location, scene.camera.data.clip_end = eye, 10000
    scene.camera.rotation_euler = (look - eye).to_track_quat("-Z", "Y").to_euler()
    scene.collection.objects.link(scene.camera)
    scene.render.engine, scene.cycles.samples, scene.cycles.seed = "CYCLES", samples, 1
    scene.cycles.use_denoising = bool(getattr(bpy.app.build_options, "openimagedenoise", False))
    scene.cycles.caustics_reflective = scene.cycles.caustics_refractive = False
    scene.cycles.sample_clamp_indirect, scene.cycles.transparent_max_bounces = 3, 16
    scene.render.resolution_x, scene.render.resolution_y = width, height
    scene.view_settings.view_transform, scene.render.filepath = "Filmic", picture
    bpy.ops.render.render(write_still=True)


def triple(text):
    """Three numbers x,y,z, m."""
    try:
        x, y, z = map(float, text.split(","))
    except ValueError as error:
        raise argparse.ArgumentTypeError(f"{text} is not allowed; allowed: three numbers x,y,z, m") from error
    return x, y, z


def main(arguments):
    """tools/wade render."""
    from wade import UsageError, progress
    from wade.export.sources import scene_of
    from wade.outside import require
    from wade.pictures.run_files import check_time
    from wade.reports.files import write_whole
    from wade.terminal import Parser, say_error

    parser = Parser("render", __doc__)
    parser.add_argument("run", type=pathlib.Path, metavar="RUN_DIR", help="run folder of crowd_client")
    parser.add_argument("--time", type=float, required=True, metavar="S", help="simulated time to render, s")
    parser.add_argument("--out", type=pathlib.Path, metavar="PNG", help="picture to write [RUN_DIR/render.png]")
    parser.add_argument("--water", type=pathlib.Path, metavar="RECORDING", help="recording of the run's water")
    parser.add_argument("--width-px", type=int, default=1280, metavar="W", help="width, 64 to 7680 pixels [1280]")
    parser.add_argument("--samples", type=int, default=48, metavar="N", help="light paths a pixel, 1 to 4096 [48]")
    parser.add_argument("--eye", type=triple, metavar="X,Y,Z", help="place of the camera, m [beside the people]")
    parser.add_argument("--look", type=triple, metavar="X,Y,Z", help="place that it looks at, m [the middle of the people]")
    options = parser.parse_args(arguments)
    for name, value, low, high in (("--time", options.time, 0, 1e9), ("--width-px", options.width_px, 64, 7680),
                                   ("--samples", options.samples, 1, 4096)):
        if not low <= value <= high:
            parser.error(f"{name}: {value:g}, allowed is {low:g} to {high:g}")
    output = (options.out or options.run / "render.png").absolute()
    if output.suffix.lower() != ".png":
        parser.error(f"--out: {output}, allowed are names that end in .png")
    scene_of(options.run)
    progress.at("reads the run and makes the water's surface")
    check_time(options.run, options.time)
    require("blender", "renderings need Blender; Debian: apt-get install blender")
    with tempfile.TemporaryDirectory(prefix="wade-render-") as folder:
        arrays, picture = pathlib.Path(folder, "job.npz"), pathlib.Path(folder, "picture.png")
        np.savez(arrays, **job(options))
        size = map(str, (options.width_px, 2 * round(options.width_px * 9 / 32), options.samples))
        command = ["blender", "--background", "--factory-startup", "--python", __file__, "--", arrays, picture, *size]
        progress.at("Blender starts")
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                              errors="backslashreplace") as blender:
            said = []
            for line in blender.stdout:
                said = [*said, line.rstrip()][-8:]
                if found := re.search(r"Sample (\d+)/(\d+)", line):
                    progress.at("Blender renders", int(found[1]), int(found[2]))
        if blender.returncode != 0 or not picture.exists():
            say_error("wade render: Blender made no picture; it said:\n" + "\n".join(said))
            return 1
        try:
            write_whole(output, picture.read_bytes())
        except OSError as error:
            raise UsageError(f"--out: cannot write {output}: {error.strerror}") from error
    print(output)
    return 0


if __name__ == "__main__":  # run by Blender
    words = sys.argv[sys.argv.index("--") + 1 :]
    draw_in_blender(np.load(words[0]), words[1], *map(int, words[2:]))
