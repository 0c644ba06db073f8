"""Polygons of houses of any file: which are houses, where each stands once, and what its tags tell."""

import json
import re
import tempfile
from pathlib import Path

from wade import UsageError
from wade.imports.gdal import call, stated
from wade.imports.ground import FOOT, UNITS
from wade.imports.notes import Notes
from wade.reports.files import write_whole

LEVEL_M = 3.0  # height of a storey, where a file tells only their number [A]
HEIGHTS = ("height_m", "height", "building:height", "building_height", "hoehe")  # in lower case, as tags_of gives them
LEVELS = ("building:levels", "levels", "building_levels")
OF_OSM = ("osm_id", "osm_way_id", "@id", "full_id")  # columns of exports of OpenStreetMap
NO_WALLS = ("roof", "carport", "canopy", "pergola")
NOT_THERE = ("demolished", "razed", "removed", "proposed", "planned")
# Two outlines of one house, from two surveys, differ by a wall or a shift of some 0.3 m: 6 % of 10 m [A].
SAME = 0.9
MAX_OUTSIDE = 1000  # m, what the programs allow between a corner and the ground
GRID = 128  # points on each side of the rectangle for comparing outlines: an error of about 1/64 of its area


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


def number_of(value):
    """Returns the number of a tag, 0 if it is none."""
    try:
        return float(value)
    except (TypeError, ValueError):
        return metres_of(value) or 0


def fault_of(tags, is_osm):
    """Returns why an area is no house with walls on the ground, as a row of the table; None if it is one."""
    kind = tags.get("building")
    if tags.get("fclass") == "building":  # Geofabrik's shapefiles
        kind = kind or "yes"
    if not kind and (is_osm or "building" in tags or any(name in tags for name in OF_OSM)):
        return "no building", "left out: areas of another kind"
    kind = str(kind or "yes").strip().lower()
    if kind in ("no", "false", "0"):
        return "building=no", "left out"
    if kind in NO_WALLS or str(tags.get("wall", "")).lower() == "no":
        return "without walls", f"left out: {', '.join(NO_WALLS)}, wall=no"
    if kind in NOT_THERE:
        return "not there", f"left out: {', '.join(NOT_THERE)}"
    if str(tags.get("location", "")).lower() in ("underground", "underwater") or number_of(tags.get("layer")) < 0:
        return "under the ground", "left out: location=underground, layer below 0"
    if number_of(tags.get("min_height")) > 0 or number_of(tags.get("building:min_level")) > 0:
        return "above the ground", "left out: min_height or building:min_level above 0"
    return None


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


class Outline:
    """Area and rectangle of a house, to compare it with others."""

    def __init__(self, parts):
        self.parts = parts
        x, y = zip(*(point for part in parts for point in part[0]))
        self.west, self.east, self.south, self.north = min(x), max(x), min(y), max(y)
        self.area = sum(area_of(part[0]) - sum(map(area_of, part[1:])) for part in parts)

    def reach_beyond(self, box):
        """Returns the largest distance of a corner beyond a box, m."""
        west, south, east, north = box
        return max(west - self.west, south - self.south, self.east - east, self.north - north)

    def overlap_of_rectangles(self, other):
        """Returns the common area of the rectangles round both, an upper limit for the outlines, m2."""
        width = min(self.east, other.east) - max(self.west, other.west)
        depth = min(self.north, other.north) - max(self.south, other.south)
        return max(0, width) * max(0, depth)

    def painted(self, of):
        """Draws the outline on a grid of points over the rectangle of another one."""
        from PIL import Image, ImageDraw

        image = Image.new("1", (GRID, GRID))
        draw = ImageDraw.Draw(image)
        across, up = (GRID - 1) / (of.east - of.west), (GRID - 1) / (of.north - of.south)
        for part in self.parts:
            for k, ring in enumerate(part):
                draw.polygon([((x - of.west) * across, (y - of.south) * up) for x, y in ring], fill=255 * (k == 0))
        return image

    def fraction_in(self, other):
        """Returns the fraction of the area that lies in another outline, to about 1/64."""
        from PIL import ImageChops

        own = self.painted(self)
        both = ImageChops.logical_and(own, other.painted(self))
        return both.histogram()[-1] / max(1, own.histogram()[-1])


def repeated(outlines):
    """Returns houses that another one covers, as {index: both are the same}. The later of two equal ones goes, else the smaller."""
    gone, near = {}, []
    for k in sorted(range(len(outlines)), key=lambda k: outlines[k].west):
        one = outlines[k]
        near = [other for other in near if outlines[other].east > one.west]
        for other in near:
            if k in gone:
                break
            second = outlines[other]
            small, large = (one, second) if one.area <= second.area else (second, one)
            if other in gone or small.overlap_of_rectangles(large) < SAME * small.area:
                continue
            common = small.area * small.fraction_in(large)
            if common >= SAME * (one.area + second.area - common):
                gone[max(k, other)] = True
            elif common >= SAME * small.area:
                gone[k if small is one else other] = False
        near.append(k)
    return gone


class Houses:
    """Features of files as houses, and what became of each. The box is that of the ground: west, south, east, north."""

    def __init__(self, box):
        self.box, self.kept, self.outlines, self.notes = box, [], [], Notes()

    def add(self, feature, is_osm=False):
        properties = feature.get("properties") or {}
        parts = parts_of(feature.get("geometry") or {})
        if not parts:
            return self.notes.add("no polygon", "left out")
        tags = tags_of(properties)
        if "building" in properties:
            tags.setdefault("building", None)
        if fault := fault_of(tags, is_osm):
            return self.notes.add(*fault, residents=count_of(tags.get("residents")) or 0)
        outline = Outline(parts)
        if outline.reach_beyond(self.box) > MAX_OUTSIDE:
            return self.notes.add("beyond the ground", f"left out: a corner is more than {MAX_OUTSIDE} m off",
                                  residents=count_of(tags.get("residents")) or 0)
        own = {"name": str(tags["name"]) if tags.get("name") not in (None, "") else None}
        own["height_m"], unknown = height_of(tags)
        label = f", the first of {own['name']}" if own["name"] else ""
        if unknown:
            self.notes.add("height not understood", "the scene's height_m", f"{unknown}{label}")
        if isinstance(tags.get("height"), str) and "," in tags["height"] and not unknown:
            self.notes.add("decimal comma", "read as a point")
        for key, read in (("residents", count_of), ("upper_floor_m", metres_of)):
            if key in tags:
                own[key] = read(tags[key])
                if own[key] is None:
                    self.notes.add(f"{key} not understood", "left out", f"{key}={tags[key]}{label}")
        geometry = {"type": "Polygon", "coordinates": parts[0]} if len(parts) == 1 else {"type": "MultiPolygon", "coordinates": parts}
        self.kept.append({"type": "Feature", "properties": {k: v for k, v in own.items() if v is not None}, "geometry": geometry})
        self.outlines.append(outline)
        return None

    def drop_repeated(self):
        """Leaves each house standing once."""
        gone = repeated(self.outlines)
        for k, is_same in sorted(gone.items()):
            own = self.kept[k]["properties"]
            self.notes.add("stands twice" if is_same else "within another house", "left out",
                           f"the first of {own['name']}" if "name" in own else "", residents=own.get("residents", 0))
        self.kept = [house for k, house in enumerate(self.kept) if k not in gone]
        if several := sum(house["geometry"]["type"] == "MultiPolygon" for house in self.kept):
            self.notes.add("of several parts", "kept as one house", count=several)


def features_on(layer, epsg, box):
    """Returns the features of a layer that meet the box, in that system."""
    with tempfile.TemporaryDirectory() as folder:
        part = Path(folder) / "part.geojson"
        call("ogr2ogr", "-f", "GeoJSON", "-lco", "COORDINATE_PRECISION=3", "-t_srs", f"EPSG:{epsg}", "-dim", "XY",
             "-makevalid", "-spat_srs", f"EPSG:{epsg}", "-spat", *box, part, layer.path, layer.name)
        try:
            return json.loads(part.read_text(encoding="utf-8"))["features"]
        except (OSError, ValueError, KeyError) as error:
            raise UsageError(f"ogr2ogr wrote no GeoJSON of {layer.path} that can be read: {error}") from error


def import_houses(layers, epsg, box, target):
    """Writes the polygons that meet the box; returns the houses."""
    houses = Houses(box)
    for layer in layers:
        file = layer.path
        if layer.others and not layer.is_osm:
            houses.notes.add("layers", f"{layer.name} is read", f"{file}; not {', '.join(layer.others)}")
        system = layer.system()
        if system is None and layer.count():
            raise UsageError(f"{file} names no coordinate system. {stated(file)}")
        features, total = features_on(layer, epsg, box), layer.count()
        if total and not features:
            raise UsageError(f"none of {total} shapes of {file} lies on the ground; they lie{layer.extent()} in {system.name}, "
                             f"the ground at {', '.join(f'{x:.2f}' for x in box)} in EPSG:{epsg}. {stated(file)}, "
                             "if it is not in the first one")
        if total > len(features):
            houses.notes.add("outside", "left out: shapes that do not meet the ground", count=total - len(features))
        for feature in features:
            houses.add(feature, layer.is_osm)
    houses.drop_repeated()
    system = {"type": "name", "properties": {"name": f"urn:ogc:def:crs:EPSG::{epsg}"}}
    text = ",\n".join(json.dumps(feature, ensure_ascii=False) for feature in houses.kept)
    write_whole(target, f'{{"type": "FeatureCollection", "crs": {json.dumps(system)}, "features": [\n{text}\n]}}\n')
    return houses
