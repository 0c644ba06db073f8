"""Writes the people of a run folder, or the water or people of a recording, as files of other programs.

One frame at a time, so that a run of any length fits into memory. Axes: vtk, ply, usd and pedpy have x upstream, y
across, z up, right-handed; gltf and obj x, y up, -z; csv keeps Wade's own (docs/engines.md).

vtk: a .vtp a frame and a .pvd, for ParaView; of a run without --water also the depths of its snapshots, .vti. ply: a
binary .ply a frame, with velocities: points, and the mesh of the water's surface. obj: a mesh a frame, of the water's surface
and of people. --spacing M is the distance of the surface's vertices, around particles and over columns. usd: .usda with time samples, people as instances and as
skeletons. gltf: figures that walk, of people. csv: one table. geotiff: depth, speed, depth times speed and hazard class of
a run's water, a file a frame, and the maps of a site. pedpy: PedPy's text, of people.
"""

import argparse
import pathlib
import shutil

from wade import UsageError, progress
from wade.reports.files import whole_folder
from wade.terminal import Parser


def formats():
    """{word: (class of the writer, whether it takes water)}."""
    from wade.export import figures, meshes, tables  # with numpy, which --help does without

    return {"vtk": (tables.Vtk, True), "ply": (tables.Ply, True), "usd": (figures.Usd, True), "gltf": (figures.Gltf, False),
            "obj": (meshes.Obj, True), "csv": (tables.Csv, True), "pedpy": (tables.PedPy, False)}


OPENER = "open_in_blender.py"
WORDS = ("vtk", "ply", "obj", "usd", "gltf", "csv", "geotiff", "pedpy")


def region(text):
    """Borders x0,x1,z0,z1 of what is exported, m."""
    try:
        x0, x1, z0, z1 = map(float, text.split(","))
    except ValueError:
        x0, x1, z0, z1 = 0, 0, 0, 0
    if not (x0 < x1 and z0 < z1):
        raise argparse.ArgumentTypeError(f"{text} is not allowed; allowed: four numbers x0,x1,z0,z1, m, with x0 < x1 "
                                         "and z0 < z1")
    return x0, x1, z0, z1


def seconds(text):
    """A time of 0 or more, s."""
    try:
        value = float(text)
    except ValueError:
        value = -1.0
    if not 0 <= value < float("inf"):
        raise argparse.ArgumentTypeError(f"{text} is not allowed; allowed: a time of 0 or more, s")
    return value


def metres(text):
    """A length above 0, m."""
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"{text} is not allowed; allowed: a length above 0, m")
    return value


def parser():
    made = Parser("export", __doc__)
    made.add_argument("source", type=pathlib.Path, metavar="RUN|RECORDING", help="a run folder, or a recording (.wrec)")
    made.add_argument("--to", choices=WORDS, required=True, help="the format")
    made.add_argument("--out", type=pathlib.Path, metavar="DIR", required=True, help="folder of the files")
    made.add_argument("--water", type=pathlib.Path, metavar="RECORDING", help="the water of a run, beside its people")
    made.add_argument("--every", type=int, metavar="N", default=1, help="each n-th frame only [1]")
    made.add_argument("--interval-s", type=seconds, metavar="T", default=0.0, help="a frame each T seconds, not each n-th")
    made.add_argument("--from-s", type=seconds, metavar="T", default=0.0, help="from this time on, s [0]")
    made.add_argument("--until-s", type=seconds, metavar="T", default=float("inf"), help="up to this time, s [the end]")
    made.add_argument("--spacing", type=metres, metavar="M", help="distance of the vertices of ply's and obj's surfaces, m [0.7 of "
                      "the particles' distance, or the size of the cells]")
    made.add_argument("--region", type=region, metavar="X0,X1,Z0,Z1", help="only what lies in this rectangle, m")
    return made


def streams_of(options):
    """What is to be exported, and why something is left out."""
    from wade.export import sources

    takes_water = formats()[options.to][1]
    if options.source.is_dir():
        streams = [sources.of_run(options.source, says=options.to not in ("pedpy", "obj", "gltf"))]
    elif options.source.exists():
        streams = [sources.of_recording(options.source)]
    else:
        raise UsageError(f"{options.source}: there is no such run folder or recording")
    if options.water:
        streams.append(sources.of_recording(options.water))
    if options.to in ("ply", "obj"):
        from wade.export.meshes import SurfaceOf

        scene = sources.scene_of(options.source) if options.source.is_dir() else None
        for stream in streams:
            stream.surface = SurfaceOf(stream, scene, options.spacing) if stream.name == "water" else None
    if not takes_water:
        if all(stream.name == "water" for stream in streams):
            raise UsageError(f"--to {options.to} is for people; {options.source} holds water")
        streams = [stream for stream in streams if stream.name == "people"]
    if len({stream.name for stream in streams}) < len(streams):
        raise UsageError(f"{options.source} and --water {options.water} both hold {streams[0].name}")
    return streams


def export(stream, writer, thinning):
    """Writes one stream; returns how many frames. UsageError if there is none in this time."""
    count = 0
    for points in stream.points(thinning):
        progress.at(f"writes the frames of the {stream.name}", max(0, points.time_s - thinning.from_s),
                    min(thinning.until_s, stream.end_s) - thinning.from_s)
        writer.add(points)
        count += 1
    if count == 0 and (thinning.from_s > 0 or thinning.until_s < float("inf")):
        raise UsageError(f"--from-s, --until-s: there are no {stream.name} in this time")
    progress.at(f"puts {count} frames together")
    writer.finish()
    return count


def export_depths(options, thinning, folder):
    """For vtk without particles: the depths that a run folder has."""
    from wade.export.tables import Depths
    from wade.pictures.run_files import water_snapshots

    grid, records = water_snapshots(options.source / "water.bin")
    if records is not None:
        print(f"depth: {Depths(folder, grid, records).write(thinning)} frames")


def export_surfaces(options, thinning, folder):
    """For ply and obj without particles: the surface over the depths that a run folder of a channel has."""
    from wade.export import meshes, sources
    from wade.export.tables import Snapshot
    from wade.pictures.run_files import water_snapshots
    from wade.pictures.top_view import water_cells

    scene = sources.scene_of(options.source)
    if scene.get("site"):
        print("no surface: water.bin does not know the heights of a site; allowed: --water RECORDING (tools/wade run --record)")
        return
    grid, records = water_snapshots(options.source / "water.bin")
    count = 0
    for shown in thinning.chosen(map(Snapshot, records)) if records is not None else []:
        mesh = meshes.surface_of_snapshot(water_cells((shown.time_s, *grid, shown.depth), scene), scene)
        file = folder / f"surface_{shown.number:06d}.{options.to}"
        if options.to == "ply":
            meshes.write_ply(file, shown.time_s, mesh)
        else:
            meshes.write_obj(file, shown.time_s, mesh.vertices, {"water": mesh.triangles})
        count += 1
    print(f"surface: {count} frames")


def export_geotiff(options, thinning, folder):
    """The water of a run folder on its cells: of --water, else the depths of its snapshots; and the maps of a site."""
    from wade.export import sources, tables
    from wade.pictures.run_files import water_snapshots

    if not options.source.is_dir():
        raise UsageError("--to geotiff needs the run folder, which knows where the water lies: tools/wade export RUN --water "
                         f"{options.source}")
    maps = options.source / "maps"
    maps = maps if (maps / "max_depth_m.tif").exists() else None
    writer = tables.GeoTiff(folder, sources.scene_of(options.source), maps, options.region)
    thinning.region = None  # whole cells, which the writer chooses
    if options.water:
        print(f"water: {export(sources.of_recording(options.water), writer, thinning)} frames")
    else:
        grid, records = water_snapshots(options.source / "water.bin")
        chosen = thinning.chosen(map(tables.Snapshot, records)) if records is not None else []
        print(f"depth: {sum(writer.add_snapshot(one, grid) is None for one in chosen)} frames")
    if maps:
        print(f"maps: {', '.join(tables.copy_maps(maps, folder))}")


def main(arguments):
    """tools/wade export."""
    made = parser()
    options = made.parse_args(arguments)
    if options.every < 1:
        made.error(f"--every: {options.every} is not allowed; allowed: whole numbers from 1")
    if options.every > 1 and options.interval_s:
        made.error("--every and --interval-s exclude one another")
    if options.spacing and options.to not in ("ply", "obj"):
        made.error(f"--spacing is for --to ply and obj, not for {options.to}")
    if options.from_s > options.until_s:
        made.error(f"--from-s {options.from_s:g} is after --until-s {options.until_s:g}")
    from wade.export.sources import Thinning

    if options.from_s and options.source.is_dir():
        from wade.pictures.run_files import check_time

        check_time(options.source, options.from_s, "--from-s")
    thinning = Thinning(options.every, options.interval_s, options.from_s, options.until_s, options.region)
    streams = streams_of(options) if options.to != "geotiff" else []
    try:
        with whole_folder(options.out) as folder:
            if options.to == "geotiff":
                export_geotiff(options, thinning, folder)
            for stream in streams:
                count = export(stream, formats()[options.to][0](folder, stream), thinning)
                print(f"{stream.name}: {count} frames")
            if options.to in ("ply", "obj") and options.source.is_dir() and not options.water:
                export_surfaces(options, thinning, folder)
            if options.to in ("gltf", "ply", "obj"):
                shutil.copyfile(pathlib.Path(__file__).with_name(OPENER), folder / OPENER)
            if options.to == "vtk" and options.source.is_dir() and not options.water:
                export_depths(options, thinning, folder)
    except UsageError:  # of a file that is read
        raise
    except OSError as error:
        raise UsageError(f"--out: cannot write to {options.out}: {error.strerror}") from error
    print(f"{options.to}: {options.out}")
    return 0
