"""Makes a site that scenes can use of any terrain, houses and roads that GDAL reads.

IN are rasters of heights, later ones over earlier ones, and files with polygons of houses. Writes into
DIR:

  ground.tif       heights in metres, square cells, north up, one projected system in metres
  houses.geojson   polygons that meet the ground, each once, with height_m of heights or levels
  scene.json       a scene to go on with: tools/wade run DIR/scene.json --check

It applies scale, offset, masks and units of heights, and reads the tags of OpenStreetMap (height, building:levels, location, layer). Areas
without the tag building, roofs without walls, and a second outline of a house are left out. A table counts what it did.

A failing import leaves DIR as it was. A further one replaces only files that are as the last one wrote them.

Needs the programs of GDAL (Debian, Ubuntu: apt-get install gdal-bin), which nothing else of Wade does.
"""

import hashlib
import json
import math
import pathlib

from wade import UsageError
from wade.imports.gdal import GDAL, PACKED, Layer, called, demand_plain_files
from wade.imports.ground import HIGHEST, LOWEST, Raster, heights_of, import_ground, system_for
from wade.imports.houses import import_houses
from wade.imports.notes import Notes
from wade.outside import require
from wade.reports.files import whole_folder, write_whole
from wade.run.folders import file_name
from wade.terminal import Parser, say_error

NAMES = ("ground.tif", "houses.geojson", "scene.json")
MARK = "  // Imported files as they were written: "


def scene_text(name, houses, cell):
    """A scene to go on with."""
    lines = [
        "{",
        f'  "name": {json.dumps(name)},',
        '  "description": "",',
        '  "duration_s": 600,',
        '  "frame_rate_hz": 10,',
        '  "site": {',
        '    "ground": {"file": "ground.tif"},',
        *(['    // Walls of this height where the file tells none.', '    "houses": [{"file": "houses.geojson", "height_m": 6}],']
          if houses else []),
        '    // Points are metres from the lower left corner of the ground. Water comes in and leaves like this:',
        '    // "sources": [{"name": "creek", "line": [[0, 10], [0, 20]], "discharge_m3_s": 5}],',
        '    // "outlets": [{"line": [[100, 0], [120, 0]]}],',
        '    // "shelters": [{"name": "school", "polygon": [[50, 50], [60, 50], [60, 60]], "capacity": 200}],',
        '    "manning": {"n": 0.04}',
        "  },",
        f'  "fluid": {{"shallow_water": {{"cell_size_m": {cell:g}}}}}',
        "}",
    ]
    return "\n".join(lines) + "\n"


def digest_of(folder):
    """Returns a checksum of the files that an import writes, without the line of the scene that holds it."""
    digest = hashlib.sha256()
    for file in (folder / name for name in NAMES if (folder / name).exists()):
        data = file.read_bytes()
        if file.suffix == ".json":
            data = b"\n".join(line for line in data.split(b"\n") if not line.startswith(MARK.encode()))
        digest.update(hashlib.sha256(data).digest())
    return digest.hexdigest()[:16]


def demand_replaceable(out, inputs):
    """Raises an error if a file in the folder would be lost: an input, one of other origin, or one changed after its import."""
    there = [out / name for name in NAMES if (out / name).exists()]
    for file in there:
        if any(other.exists() and file.samefile(other) for other in inputs):
            raise UsageError(f"{file} is read, and would be written; allowed: another folder after --out")
    if not there:
        return
    for file in there:
        demand_plain_files(file)
    scene = out / "scene.json"
    if scene not in there or f"{MARK}{digest_of(out)}" not in scene.read_text("utf-8", "replace").split("\n"):
        raise UsageError(f"{out} holds {', '.join(file.name for file in there)}, of other origin or changed after the import. Remedy: "
                         "another folder after --out, or remove them")


def read_inputs(files, wanted_layer):
    """Returns the rasters of heights among the files, and the layers of houses of the others."""
    require("gdalinfo", GDAL)
    rasters, layers = [], []
    for path in files:
        if not path.exists():
            raise UsageError(f"{path} does not exist")
        demand_plain_files(path)
        try:
            rasters.append(Raster(path))
        except UsageError as no_raster:
            try:
                told = called("ogrinfo", "-ro", path)
            except UsageError as no_vector:
                remedy = f". Remedy: unpack {path}, and import the file in it" if path.suffix.lower() in PACKED else ""
                raise UsageError(f"GDAL reads {path} neither as a raster ({no_raster}) nor as polygons ({no_vector}){remedy}") from None
            layers.append(Layer(path, told, wanted_layer))
            continue
        rasters[-1].demand_heights()
    if not rasters:
        raise UsageError("there is no raster of heights among the files; one has to be")
    return rasters, layers


def import_site(options):
    """tools/wade site import."""
    try:
        return write_site(options)
    except OSError as error:
        if isinstance(error, UsageError):
            raise
        raise UsageError(f"{error.filename}: {error.strerror}") from error


def write_site(options):
    """Reads the inputs, writes the files beside the folder's own, and moves them there when all are whole."""
    out = options.out
    rasters, layers = read_inputs(options.files, options.layer)
    epsg = system_for(rasters, options.epsg)
    parts = [pathlib.Path(file) for raster in rasters for file in raster.info.get("files", [])]
    demand_replaceable(out, [*parts, *(layer.path for layer in layers)])
    notes = Notes()
    with whole_folder(out) as part:
        info = import_ground(rasters, epsg, options, part / "ground.tif", notes)
        heights = heights_of(part / "ground.tif")
        there = heights[heights == heights]
        if there.size == 0:
            raise UsageError(f"no cell of the ground has a height; does --crop lie on it? It is in metres of EPSG:{epsg}, and "
                             f"the site is {box_words(info)}")
        for extreme in (there.min(), there.max()):
            if not LOWEST <= extreme <= HIGHEST:
                raise UsageError(f"a height is {extreme:.17g} m; allowed: {LOWEST} to {HIGHEST} m. Remedy: if it stands for no data, "
                                 f"gdal_translate -a_nodata {extreme:.17g} FILE OUT.tif, and import OUT.tif")
        width, height = info["size"]
        cell = info["geoTransform"][1]
        table = [(str(out / "ground.tif"), f"{width} x {height} cells of {cell:.6g} m, EPSG:{epsg}, {box_words(info)}, heights "
                                           f"{there.min():.2f} to {there.max():.2f} m"),
                 *notes.rows(f" of {len(rasters)} raster{'s' if len(rasters) > 1 else ''}")]
        if options.fill:
            table.append(("filled", f"{notes.filled} cells from the heights round them"))
        if holes := heights.size - there.size:
            table.append(("no height", f"{holes} of {heights.size} cells have no height; those at the edge are outside, those "
                                       "inside need --fill"))
        count = 0
        if layers:
            lower_left, upper_right = info["cornerCoordinates"]["lowerLeft"], info["cornerCoordinates"]["upperRight"]
            houses = import_houses(layers, epsg, (*lower_left, *upper_right), part / "houses.geojson")
            count = len(houses.kept)
            table += [(str(out / "houses.geojson"), f"{count} house{'s' if count != 1 else ''}"), *houses.notes.rows()]
        text = scene_text(file_name(out.resolve().name), count, cell)
        write_whole(part / "scene.json", text)
        write_whole(part / "scene.json", text.replace("{\n", f"{{\n{MARK}{digest_of(part)}\n", 1))
        if not layers:
            (out / "houses.geojson").unlink(missing_ok=True)
    table.append((str(out / "scene.json"), f"tools/wade run {out / 'scene.json'} --check"))
    for what, how in table:
        print(f"{what}: {how}" if "/" in what or what.endswith((".tif", ".json", ".geojson")) else f"  {what:22} {how}")
    return 0


def box_words(info):
    west, south = info["cornerCoordinates"]["lowerLeft"]
    east, north = info["cornerCoordinates"]["upperRight"]
    return f"west {west:.2f} south {south:.2f} east {east:.2f} north {north:.2f}"


def positive(text):
    value = float(text)
    if not (value > 0 and math.isfinite(value)):
        raise ValueError
    return value


def main(arguments):
    """tools/wade site import."""
    parser = Parser("site import", __doc__)
    parser.add_argument("files", nargs="+", type=pathlib.Path, metavar="IN", help="a raster of heights, or polygons of houses")
    parser.add_argument("--out", type=pathlib.Path, required=True, metavar="DIR", help="folder to write into")
    parser.add_argument("--epsg", type=int, metavar="N", help="coordinate system of the site, in metres [that of the first "
                        "raster if it is projected, else its UTM zone]")
    parser.add_argument("--crop", type=float, nargs=4, metavar=("WEST", "SOUTH", "EAST", "NORTH"),
                        help="what to keep, metres of that system [all]")
    parser.add_argument("--cell", type=positive, metavar="M", help="size of the cells [that of the raster]")
    parser.add_argument("--heights-in", choices=("m", "ft", "us-ft"), help="unit of the heights [as the rasters say]")
    parser.add_argument("--layer", metavar="NAME", help="layer of the houses in files with several [the one of polygons]")
    parser.add_argument("--fill", action="store_true", help="fill what has no height from the heights round it, "
                        "at the edge, too")
    parser.add_argument("--fill-cells", type=int, default=100, metavar="N", help="as far as this many cells [100]")
    if arguments[:1] != ["import"]:
        if arguments[:1] in (["-h"], ["--help"], []):
            parser.print_help()
            return 0 if arguments else 2
        say_error(f'site: there is no "{arguments[0]}"; allowed: import')
        return 2
    options = parser.parse_args(arguments[1:])
    if options.crop and not (options.crop[0] < options.crop[2] and options.crop[1] < options.crop[3]):
        parser.error("--crop WEST SOUTH EAST NORTH: west has to be less than east, south less than north")
    return import_site(options)
