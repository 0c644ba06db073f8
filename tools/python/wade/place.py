"""Makes a place that scenes can use of any terrain, houses and roads that GDAL reads.

IN are rasters of heights, of which the later ones lie over the earlier ones, and files with polygons of houses. Writes into
DIR:

  ground.tif       heights in metres, square cells, one projected coordinate system
  houses.geojson   the polygons that meet the ground, with height_m of heights or levels
  scene.json       a scene to go on with: tools/wade run DIR/scene.json --check

Needs the programs of GDAL (Debian, Ubuntu: apt-get install gdal-bin), which nothing else of Wade does.
"""

import json
import math
import pathlib
import shutil
import subprocess
import tempfile

from wade import UsageError
from wade.outside import require
from wade.reports.files import write_whole
from wade.run.folders import file_name
from wade.terminal import Parser, say_error

LEVEL_M = 3.0  # height of a storey, where a file tells only their number [A]
GDAL = "this command needs GDAL's programs: apt-get install gdal-bin (Fedora: gdal, Homebrew: gdal)"
HEIGHTS = ("height_m", "height", "building:height", "building_height", "HEIGHT", "hoehe")
LEVELS = ("building:levels", "levels", "building_levels", "LEVELS")


def call(program, *words):
    """What a program of GDAL prints; UsageError with its words if it fails."""
    if shutil.which(program) is None:
        raise UsageError(f"{program} is not installed; {GDAL}")
    done = subprocess.run([program, *map(str, words)], capture_output=True, text=True, errors="backslashreplace")
    if done.returncode != 0:
        reasons = [line for line in done.stderr.splitlines() if line.startswith("ERROR")] or done.stderr.splitlines()[-1:]
        raise UsageError(f"{program} failed: {'; '.join(reasons) or 'it does not say why'}")
    return done.stdout


def raster_info(path):
    """What gdalinfo says of a raster, or None if the file is none."""
    require("gdalinfo", GDAL)
    try:
        info = json.loads(call("gdalinfo", "-json", path))
    except UsageError:
        return None
    return info if info.get("bands") else None


def epsg_of(path):
    """Number of the coordinate system of a file, None if it names none."""
    words = call("gdalsrsinfo", "-o", "epsg", path).split()
    numbers = [word.removeprefix("EPSG:") for word in words if word.startswith("EPSG:")]
    return int(numbers[0]) if numbers and numbers[0].isdigit() else None


def is_projected(info):
    return info.get("coordinateSystem", {}).get("wkt", "").startswith(("PROJCRS", "PROJCS", "COMPD"))


def utm_zone(info):
    """The UTM zone in which the middle of a raster lies, as an EPSG number; UsageError if nobody knows where that is."""
    ring = info.get("wgs84Extent", {}).get("coordinates", [[]])[0]
    if not ring:
        return None
    east = sum(point[0] for point in ring[:4]) / 4
    north = sum(point[1] for point in ring[:4]) / 4
    return (32600 if north >= 0 else 32700) + min(60, int((east + 180) // 6) + 1)


def system_for(rasters, wanted):
    """The EPSG number of the place."""
    path, info = rasters[0]
    if wanted:
        return wanted
    own = epsg_of(path) if info.get("coordinateSystem", {}).get("wkt") else None
    if is_projected(info):
        if own in (3857, 3395):
            own = None
        if own:
            return own
    zone = utm_zone(info)
    if zone is None:
        raise UsageError(f"{path} names no coordinate system; state that of the file with gdal_edit.py -a_srs EPSG:N, or "
                         "its name with --epsg N, if it is in that")
    return zone


def import_ground(rasters, epsg, options, target):
    """Writes the raster of heights; returns what gdalinfo says of it."""
    named = [bool(info.get("coordinateSystem", {}).get("wkt")) for _, info in rasters]
    words = ["-q", "-overwrite", "-t_srs", f"EPSG:{epsg}", "-r", "bilinear", "-ot", "Float32", "-dstnodata", "nan",
             "-co", "COMPRESS=DEFLATE", "-of", "GTiff"]
    if not any(named):
        words += ["-s_srs", f"EPSG:{epsg}"]
    cell = options.cell
    if cell is None and len(rasters) == 1 and named[0] and epsg_of(rasters[0][0]) == epsg:
        steps = rasters[0][1]["geoTransform"]
        if abs(abs(steps[1]) - abs(steps[5])) > 1e-6 * abs(steps[1]):
            cell = min(abs(steps[1]), abs(steps[5]))
    if cell is not None:
        words += ["-tr", cell, cell]
    if options.crop:
        words += ["-te", *options.crop]
    call("gdalwarp", *words, *(path for path, _ in rasters), target)
    if options.fill:
        whole = target.with_suffix(".filled.tif")
        call("gdal_fillnodata.py", target, whole, "-q", "-md", options.fill_cells, "-co", "COMPRESS=DEFLATE")
        whole.replace(target)
    return raster_info(target)


def height_of(properties):
    """Height of a house of what its file tells, m; None if it tells nothing."""
    for name, factor in (*((name, 1.0) for name in HEIGHTS), *((name, LEVEL_M) for name in LEVELS)):
        try:
            value = float(str(properties.get(name)).split()[0]) * factor
        except (ValueError, IndexError):
            continue
        if 0 < value <= 1000:
            return round(value, 2)
    return None


def import_houses(files, epsg, box, target):
    """Writes the polygons that meet the box; returns how many there are."""
    features = []
    for file in files:
        with tempfile.TemporaryDirectory() as folder:
            part = pathlib.Path(folder) / "part.geojson"
            call("ogr2ogr", "-f", "GeoJSON", "-lco", "COORDINATE_PRECISION=3", "-t_srs", f"EPSG:{epsg}", "-dim", "XY",
                 "-makevalid", "-explodecollections", "-spat_srs", f"EPSG:{epsg}", "-spat", *box, part, file,
                 *(["multipolygons"] if file.suffix in (".osm", ".pbf") else []))
            features += json.loads(part.read_text(encoding="utf-8"))["features"]
    kept = []
    for feature in features:
        geometry, properties = feature.get("geometry") or {}, feature.get("properties") or {}
        if geometry.get("type") not in ("Polygon", "MultiPolygon"):
            continue
        if "building" in properties and not properties["building"]:
            continue  # of OpenStreetMap: an area of another kind
        own = {"name": properties.get("name") or None, "height_m": height_of(properties)}
        own |= {key: properties[key] for key in ("residents", "upper_floor_m") if key in properties}
        kept.append({"type": "Feature", "properties": {k: v for k, v in own.items() if v is not None}, "geometry": geometry})
    system = {"type": "name", "properties": {"name": f"urn:ogc:def:crs:EPSG::{epsg}"}}
    text = ",\n".join(json.dumps(feature, ensure_ascii=False) for feature in kept)
    write_whole(target, f'{{"type": "FeatureCollection", "crs": {json.dumps(system)}, "features": [\n{text}\n]}}\n')
    return len(kept)


def scene_text(name, houses, cell):
    """A scene to go on with."""
    lines = [
        "{",
        f'  "name": {json.dumps(name)},',
        '  "description": "",',
        '  "duration_s": 600,',
        '  "frame_rate_hz": 10,',
        '  "place": {',
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


def heights_of(path):
    """The values of a raster that this command has written, NaN where there is none."""
    import numpy as np  # only here, so that the help needs neither
    from PIL import Image

    Image.MAX_IMAGE_PIXELS = None
    with Image.open(path) as image:
        return np.asarray(image, dtype=float)


def import_place(options):
    """tools/wade place import."""
    rasters, vectors = [], []
    for path in options.files:
        if not path.exists():
            raise UsageError(f"{path} does not exist")
        info = raster_info(path)
        if info:
            rasters.append((path, info))
        else:
            call("ogrinfo", "-q", path)  # says what is wrong if it is no vector file either
            vectors.append(path)
    if not rasters:
        raise UsageError("there is no raster of heights among the files; one has to be")
    epsg = system_for(rasters, options.epsg)
    options.out.mkdir(parents=True, exist_ok=True)
    ground = options.out / "ground.tif"
    info = import_ground(rasters, epsg, options, ground)
    heights = heights_of(ground)
    there = heights[heights == heights]
    if there.size == 0:
        raise UsageError(f"no cell of the ground has a height; does --crop lie on it? It is in metres of EPSG:{epsg}, and "
                         f"the place is {box_words(info)}")
    lower_left, upper_right = info["cornerCoordinates"]["lowerLeft"], info["cornerCoordinates"]["upperRight"]
    houses = import_houses(vectors, epsg, (*lower_left, *upper_right), options.out / "houses.geojson") if vectors else 0
    cell = info["geoTransform"][1]
    write_whole(options.out / "scene.json", scene_text(file_name(options.out.resolve().name), houses, cell))
    width, height = info["size"]
    holes = heights.size - there.size
    print(f"{ground}: {width} x {height} cells of {cell:.6g} m, EPSG:{epsg}, {box_words(info)}, heights "
          f"{there.min():.2f} to {there.max():.2f} m")
    if holes:
        print(f"  {holes} of {heights.size} cells have no height; those at the edge are outside, those inside need --fill")
    if vectors:
        print(f"{options.out / 'houses.geojson'}: {houses} houses")
    print(f"{options.out / 'scene.json'}: tools/wade run {options.out / 'scene.json'} --check")
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
    """tools/wade place import."""
    parser = Parser("place import", __doc__)
    parser.add_argument("files", nargs="+", type=pathlib.Path, metavar="IN", help="a raster of heights, or polygons of houses")
    parser.add_argument("--out", type=pathlib.Path, required=True, metavar="DIR", help="folder to write into")
    parser.add_argument("--epsg", type=int, metavar="N", help="coordinate system of the place, in metres [that of the first "
                        "raster if it is projected, else its UTM zone]")
    parser.add_argument("--crop", type=float, nargs=4, metavar=("WEST", "SOUTH", "EAST", "NORTH"),
                        help="what to keep, metres of that system [all]")
    parser.add_argument("--cell", type=positive, metavar="M", help="size of the cells [that of the raster]")
    parser.add_argument("--fill", action="store_true", help="fill what has no height from the heights round it, "
                        "at the edge, too")
    parser.add_argument("--fill-cells", type=int, default=100, metavar="N", help="as far as this many cells [100]")
    if arguments[:1] != ["import"]:
        if arguments[:1] in (["-h"], ["--help"], []):
            parser.print_help()
            return 0 if arguments else 2
        say_error(f'place: there is no "{arguments[0]}"; allowed: import')
        return 2
    options = parser.parse_args(arguments[1:])
    if options.crop and not (options.crop[0] < options.crop[2] and options.crop[1] < options.crop[3]):
        parser.error("--crop WEST SOUTH EAST NORTH: west has to be less than east, south less than north")
    return import_place(options)
