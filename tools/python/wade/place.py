"""Makes a place that scenes can use of any terrain, houses and roads that GDAL reads.

IN are rasters of heights, of which the later ones lie over the earlier ones, and files with polygons of houses. Writes into
DIR:

  ground.tif       heights in metres, square cells, north up, one projected system in metres
  houses.geojson   polygons that meet the ground, each once, with height_m of heights or levels
  scene.json       a scene to go on with: tools/wade run DIR/scene.json --check

It applies scale, offset, masks and units of heights, and reads the tags of OpenStreetMap (height, building:levels, building=no). A table
says what it did.

Needs the programs of GDAL (Debian, Ubuntu: apt-get install gdal-bin), which nothing else of Wade does.
"""

import json
import math
import pathlib
import re
import shutil
import subprocess
import tempfile

from wade import UsageError, plain_file, progress
from wade.outside import require
from wade.reports.files import write_whole
from wade.run.folders import file_name
from wade.terminal import Parser, say_error

LEVEL_M = 3.0  # height of a storey, where a file tells only their number [A]
GDAL = "this command needs GDAL's programs: apt-get install gdal-bin (Fedora: gdal, Homebrew: gdal)"
HEIGHTS = ("height_m", "height", "building:height", "building_height", "hoehe")  # in lower case, as tags_of gives them
LEVELS = ("building:levels", "levels", "building_levels")
FOOT = 0.3048
UNITS = {"": 1, "m": 1, "metre": 1, "meter": 1, "metres": 1, "meters": 1, "ft": FOOT, "foot": FOOT, "feet": FOOT,
         "us-ft": 1200 / 3937, "us survey foot": 1200 / 3937, "us survey feet": 1200 / 3937, "ftus": 1200 / 3937,
         "cm": 0.01, "mm": 0.001, "dm": 0.1, "km": 1000}
LOWEST, HIGHEST = -500, 9000  # m, what the programs take for heights of ground


def call(program, *words):
    """What a program of GDAL prints; UsageError with its words if it fails."""
    if shutil.which(program) is None:
        raise UsageError(f"{program} is not installed; {GDAL}")
    progress.at(f"{program} works")
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


def horizontal_wkt(info):
    """WKT of the system along the map, without that of heights."""
    wkt = info.get("coordinateSystem", {}).get("wkt", "")
    return wkt[wkt.find("PROJCRS"):wkt.find("VERTCRS")] if wkt.startswith("COMPOUNDCRS") else wkt


def is_in_metres(wkt):
    """Whether a projected system, as WKT 2, counts metres to the east and north along the ground."""
    axes = re.findall(r'AXIS\["[^"]*",(\w+).*?LENGTHUNIT\["[^"]*",([0-9.e-]+)', wkt, re.S)
    of_the_world = re.search(r'METHOD\["[^"]*(Mercator|Cylindrical|Equal Earth)', wkt) and not re.search(
        r'METHOD\["[^"]*(Transverse|Oblique)', wkt)
    return bool(axes) and not of_the_world and all(float(unit) == 1 and way not in ("south", "west") for way, unit in axes)


def system_for(rasters, wanted):
    """The EPSG number of the place."""
    path, info = rasters[0]
    if wanted:
        wkt = call("gdalsrsinfo", "-o", "wkt2", "--single-line", f"EPSG:{wanted}")
        if not is_in_metres(wkt):
            raise UsageError(f"--epsg {wanted} is no projected system in metres; allowed: one, for example that of the UTM zone")
        return wanted
    wkt = horizontal_wkt(info)
    numbers = re.findall(r'ID\["EPSG",(\d+)\]\]', wkt.strip().rstrip(","))
    if is_projected(info) and is_in_metres(wkt):
        own = int(numbers[-1]) if numbers and wkt.rstrip(", \n").endswith(f'ID["EPSG",{numbers[-1]}]]') else epsg_of(path)
        if own:
            return own
    zone = utm_zone(info)
    if zone is None:
        raise UsageError(f"{path} names no coordinate system; state that of the file with gdal_edit.py -a_srs EPSG:N, or "
                         "its name with --epsg N, if it is in that")
    return zone


def unit_of_heights(path, info, wanted):
    """Metres of one unit of the heights of a raster, and its name; UsageError if the file leaves it open."""
    if wanted:
        return UNITS[wanted], wanted
    named = info["bands"][0].get("unit", "").strip()
    if named:
        if named.lower() not in UNITS:
            raise UsageError(f'{path} has heights in "{named}"; allowed: m, ft, us-ft. Remedy: --heights-in says which')
        return UNITS[named.lower()], named
    wkt = info.get("coordinateSystem", {}).get("wkt", "")
    vertical = re.search(r'VERTCRS.*?LENGTHUNIT\["([^"]*)",([0-9.e-]+)', wkt, re.S)
    if vertical:
        return float(vertical[2]), vertical[1]
    along = re.search(r'AXIS\["[^"]*",\w+.*?LENGTHUNIT\["([^"]*)",([0-9.e-]+)', horizontal_wkt(info), re.S)
    if along and float(along[2]) != 1:
        raise UsageError(f"{path} counts in {along[1]} along the map and does not say in what its heights are. Remedy: "
                         "--heights-in m, ft or us-ft")
    return 1, "m"


def in_metres(number, path, info, options, folder, told):
    """The raster with scale, offset and unit of its heights applied: itself, or a file in the folder."""
    band = info["bands"][0]
    source = path
    if len(info["bands"]) > 1:
        told.append(("bands", f"{path}: the first of {len(info['bands'])}"))
    if band.get("scale", 1) != 1 or band.get("offset", 0) != 0:
        told.append(("scale, offset", f"{path}: heights times {band.get('scale', 1):g} plus {band.get('offset', 0):g}"))
        source, last = folder / f"{number}_unscaled.vrt", source
        call("gdal_translate", "-q", "-b", 1, "-unscale", "-ot", "Float64", "-of", "VRT", last.resolve(), source)
    factor, unit = unit_of_heights(path, info, options.heights_in)
    if factor != 1:
        told.append(("unit", f"{path}: heights in {unit} times {factor:.10g}"))
        source, last = folder / f"{number}_metres.vrt", source
        call("gdal_translate", "-q", "-b", 1, "-scale", 0, 1, 0, factor, "-ot", "Float64", "-of", "VRT", last.resolve(), source)
    if "PER_DATASET" in band.get("mask", {}).get("flags", []) and "ALPHA" not in band["mask"]["flags"]:
        told.append(("mask", f"{path}: masked cells have no height"))
    steps = info.get("geoTransform", [0, 1, 0, 0, 0, -1])
    if steps[5] > 0:
        told.append(("rows", f"{path}: turned north up"))
    if "VERTCRS" in info.get("coordinateSystem", {}).get("wkt", ""):
        told.append(("vertical system", f"{path}: its zero is kept, and not named"))
    return source


def import_ground(rasters, epsg, options, target, told):
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
    for path, info in rasters:
        own = epsg_of(path) if info.get("coordinateSystem", {}).get("wkt") else epsg
        if own != epsg:
            told.append(("system", f"{path}: reprojected from {f'EPSG:{own}' if own else 'a system without number'}"))
    with tempfile.TemporaryDirectory() as folder:
        sources = [in_metres(k, path, info, options, pathlib.Path(folder), told) for k, (path, info) in enumerate(rasters)]
        call("gdalwarp", *words, *sources, target)
    if options.fill:
        whole = target.with_suffix(".filled.tif")
        call("gdal_fillnodata.py", target, whole, "-q", "-md", options.fill_cells, "-co", "COMPRESS=DEFLATE")
        whole.replace(target)
    return raster_info(target)


def tags_of(properties):
    """Properties of a feature, with the tags that GDAL puts into other_tags, by names in lower case."""
    pairs = re.findall(r'"((?:[^"\\]|\\.)*)"=>"((?:[^"\\]|\\.)*)"', properties.get("other_tags") or "")
    tags = {name.replace('\\"', '"'): value.replace('\\"', '"') for name, value in pairs}
    return {name.lower(): value for name, value in {**tags, **properties}.items() if value is not None}


def metres_of(text):
    """A height such as 12, "12.5", "12,5", "12 m", "39 ft", "39'" or 7'4" in metres; None if it is none."""
    if isinstance(text, bool):
        return None
    words = str(text).strip().lower()
    feet = re.fullmatch(r"""(\d+(?:\.\d+)?)\s*'\s*(?:(\d+(?:\.\d+)?)\s*(?:"|''))?""", words)
    if feet:
        return FOOT * (float(feet[1]) + float(feet[2] or 0) / 12)
    found = re.fullmatch(r"(\d+(?:[.,]\d+)?(?:e[+-]?\d+)?)\s*([a-z -]*)", words)
    unit = UNITS.get(found[2].strip()) if found else None
    return float(found[1].replace(",", ".")) * unit if unit else None


def height_of(tags):
    """Height of a house of what its file tells, m, None if it tells nothing; and the tag that is not understood, or None."""
    unknown = None
    for name, factor in (*((name, 1.0) for name in HEIGHTS), *((name, LEVEL_M) for name in LEVELS)):
        if name not in tags:
            continue
        value = metres_of(tags[name])
        if value is not None and 0 < value * factor <= 1000:
            return round(value * factor, 2), None
        unknown = unknown or f"{name}={tags[name]}"
    return None, unknown


def count_of(value):
    """A number of people, None if it is none."""
    try:
        count = float(value) if not isinstance(value, bool) else -1
    except (TypeError, ValueError):
        return None
    return int(count) if count >= 0 and count == int(count) and count <= 100000 else None


def area_of(ring):
    """Area of a ring, from its first corner, so that large coordinates lose no digits, m2."""
    x, y = ring[0]
    return abs(sum((a[0] - x) * (b[1] - y) - (b[0] - x) * (a[1] - y) for a, b in zip(ring, ring[1:]))) / 2


def parts_of(geometry):
    """Polygons of a geometry, without rings that enclose less than the programs take."""
    kind = geometry.get("type")
    if kind == "GeometryCollection":
        return [part for inner in geometry["geometries"] for part in parts_of(inner)]
    polygons = {"Polygon": [geometry.get("coordinates")], "MultiPolygon": geometry.get("coordinates")}.get(kind) or []
    least = 0.01  # m2
    return [[ring for ring in polygon if area_of(ring) >= least] for polygon in polygons if polygon and area_of(polygon[0]) >= least]


def place_of(parts):
    """Where a house stands, to find another one there: the rectangle round it and its area, to 0.1 m."""
    points = [point for part in parts for ring in part for point in ring]
    x, y = zip(*points)
    area = sum(area_of(ring) for part in parts for ring in part)
    return tuple(round(v * 10) for v in (min(x), max(x), min(y), max(y), area))


class Houses:
    """Features of files as houses, and what became of each."""

    def __init__(self):
        self.kept, self.places, self.told = [], set(), {}

    def note(self, what, how):
        count, first = self.told.get((what, how.split(";")[0]), (0, how))
        self.told[what, how.split(";")[0]] = (count + 1, first)

    def add(self, feature):
        properties = feature.get("properties") or {}
        parts = parts_of(feature.get("geometry") or {})
        if not parts:
            return self.note("no polygon", "left out")
        if "building" in properties and not properties["building"]:
            return self.note("no building", "left out: areas of another kind")
        tags = tags_of(properties)
        if str(tags.get("building", "")).lower() == "no":
            return self.note("building=no", "left out")
        where = place_of(parts)
        if where in self.places:
            return self.note("stands twice", "left out, with its residents")
        self.places.add(where)
        own = {"name": str(tags["name"]) if tags.get("name") not in (None, "") else None}
        own["height_m"], unknown = height_of(tags)
        label = f", the first of {own['name']}" if own["name"] else ""
        if unknown:
            self.note("height not understood", f"the scene's height_m; {unknown}{label}")
        if isinstance(tags.get("height"), str) and "," in tags["height"] and not unknown:
            self.note("decimal comma", "read as a point")
        for key, read in (("residents", count_of), ("upper_floor_m", metres_of)):
            if key in tags:
                own[key] = read(tags[key])
                if own[key] is None:
                    self.note(f"{key} not understood", f"left out; {key}={tags[key]}{label}")
        if len(parts) > 1:
            self.note("of several parts", "kept as one house")
        geometry = {"type": "Polygon", "coordinates": parts[0]} if len(parts) == 1 else {"type": "MultiPolygon", "coordinates": parts}
        self.kept.append({"type": "Feature", "properties": {k: v for k, v in own.items() if v is not None}, "geometry": geometry})
        return None

    def rows(self):
        """What became of the features, as rows of the table."""
        for (what, how), (count, first) in self.told.items():
            detail = first.split("; ", 1)[1] if "; " in first else ""
            yield what, f"{count}: {how}" + (f" ({detail})" if detail else "")


def import_houses(files, epsg, box, target):
    """Writes the polygons that meet the box; returns the houses."""
    houses = Houses()
    for file in files:
        with tempfile.TemporaryDirectory() as folder:
            part = pathlib.Path(folder) / "part.geojson"
            call("ogr2ogr", "-f", "GeoJSON", "-lco", "COORDINATE_PRECISION=3", "-t_srs", f"EPSG:{epsg}", "-dim", "XY",
                 "-makevalid", "-spat_srs", f"EPSG:{epsg}", "-spat", *box, part, file,
                 *(["multipolygons"] if file.suffix in (".osm", ".pbf") else []))
            for feature in json.loads(part.read_text(encoding="utf-8"))["features"]:
                houses.add(feature)
    system = {"type": "name", "properties": {"name": f"urn:ogc:def:crs:EPSG::{epsg}"}}
    text = ",\n".join(json.dumps(feature, ensure_ascii=False) for feature in houses.kept)
    write_whole(target, f'{{"type": "FeatureCollection", "crs": {json.dumps(system)}, "features": [\n{text}\n]}}\n')
    return houses


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
        if not path.is_dir():  # which some formats of GDAL are
            plain_file.open_plain(path).close()
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
    table = []
    info = import_ground(rasters, epsg, options, ground, table)
    heights = heights_of(ground)
    there = heights[heights == heights]
    if there.size == 0:
        raise UsageError(f"no cell of the ground has a height; does --crop lie on it? It is in metres of EPSG:{epsg}, and "
                         f"the place is {box_words(info)}")
    for extreme in (there.min(), there.max()):
        if not LOWEST <= extreme <= HIGHEST:
            ground.unlink()
            raise UsageError(f"a height is {extreme:.17g} m; allowed: {LOWEST} to {HIGHEST} m. Remedy: if it stands for no data, "
                             f"gdal_translate -a_nodata {extreme:.17g} FILE OUT.tif, and import OUT.tif")
    width, height = info["size"]
    cell = info["geoTransform"][1]
    table.insert(0, (str(ground), f"{width} x {height} cells of {cell:.6g} m, EPSG:{epsg}, {box_words(info)}, heights "
                                  f"{there.min():.2f} to {there.max():.2f} m"))
    if holes := heights.size - there.size:
        table.append(("no height", f"{holes} of {heights.size} cells have no height; those at the edge are outside, those "
                                   "inside need --fill"))
    lower_left, upper_right = info["cornerCoordinates"]["lowerLeft"], info["cornerCoordinates"]["upperRight"]
    count = 0
    if vectors:
        houses = import_houses(vectors, epsg, (*lower_left, *upper_right), options.out / "houses.geojson")
        count = len(houses.kept)
        table += [(str(options.out / "houses.geojson"), f"{count} houses"), *houses.rows()]
    write_whole(options.out / "scene.json", scene_text(file_name(options.out.resolve().name), count, cell))
    table.append((str(options.out / "scene.json"), f"tools/wade run {options.out / 'scene.json'} --check"))
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
    """tools/wade place import."""
    parser = Parser("place import", __doc__)
    parser.add_argument("files", nargs="+", type=pathlib.Path, metavar="IN", help="a raster of heights, or polygons of houses")
    parser.add_argument("--out", type=pathlib.Path, required=True, metavar="DIR", help="folder to write into")
    parser.add_argument("--epsg", type=int, metavar="N", help="coordinate system of the place, in metres [that of the first "
                        "raster if it is projected, else its UTM zone]")
    parser.add_argument("--crop", type=float, nargs=4, metavar=("WEST", "SOUTH", "EAST", "NORTH"),
                        help="what to keep, metres of that system [all]")
    parser.add_argument("--cell", type=positive, metavar="M", help="size of the cells [that of the raster]")
    parser.add_argument("--heights-in", choices=("m", "ft", "us-ft"), help="unit of the heights [as the rasters say]")
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
