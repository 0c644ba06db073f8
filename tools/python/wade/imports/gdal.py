"""Calls of GDAL's programs, and what they tell of rasters, layers and coordinate systems."""

import functools
import json
import re
import shutil
import signal
import subprocess

from wade import UsageError, plain_file, progress

GDAL = "this command needs GDAL's programs: apt-get install gdal-bin (Fedora: gdal, Homebrew: gdal)"
PACKED = (".gz", ".zip", ".bz2", ".xz", ".zst", ".7z", ".rar", ".tar", ".tgz")
SYSTEM = re.compile(r"\b(?:DERIVEDPROJCRS|PROJCRS|GEOGCRS|GEODCRS|ENGCRS)\[")
LAYER = re.compile(r"^\d+: (.+?)(?: \(title: .*\))?(?: \(([^()]+(?:\([^()]*\))?)\))?$")


def called(program, *words):
    """Runs a program of GDAL and returns the ended process. Raises UsageError with its reason if it fails."""
    if shutil.which(program) is None:
        raise UsageError(f"{program} is not installed; {GDAL}")
    progress.at(f"{program} works")
    try:
        done = subprocess.run([program, *map(str, words)], stdin=subprocess.DEVNULL, capture_output=True, text=True,
                              errors="backslashreplace")
    except OSError as error:
        raise UsageError(f"{program} does not start: {error.strerror}; {GDAL}") from error
    if done.returncode < 0:
        raise UsageError(f"{program} was ended by {signal.Signals(-done.returncode).name}")
    if done.returncode > 0:
        said = [line.strip() for line in (done.stderr or done.stdout).splitlines() if line.strip()]
        lists = next((k for k, line in enumerate(said) if line.startswith("->")), len(said))  # of all drivers
        reasons = [line for line in said if line.startswith("ERROR")] or [
            line.removesuffix(" with the following drivers.") for line in said[:lists][-1:]]
        raise UsageError(f"{program} failed: {'; '.join(reasons) or f'exit code {done.returncode} without a reason'}")
    return done


def call(program, *words):
    """Returns what a program of GDAL prints."""
    return called(program, *words).stdout


def demand_plain_files(path):
    """Raises an error if an input is no plain file; GDAL would wait for the writer of a FIFO. A geodatabase is a folder of them."""
    is_database = path.suffix.lower() == ".gdb" and path.is_dir()
    for file in path.iterdir() if is_database else [path]:
        plain_file.open_plain(file).close()


def raster_info(path):
    """Returns what gdalinfo tells of a raster. Raises UsageError if the file is none."""
    text = call("gdalinfo", "-json", path)
    try:
        info = json.loads(text)
        bands, sets = info.get("bands"), info.get("metadata", {}).get("SUBDATASETS", {})
    except (ValueError, RecursionError, AttributeError) as error:
        raise UsageError(f"gdalinfo does not describe {path} in JSON that can be read: {error}") from error
    if not bands and sets:
        raise UsageError(f"{path} holds several rasters: {', '.join(v for k, v in sets.items() if k.endswith('_NAME'))}. Remedy: "
                         "gdal_translate NAME OUT.tif, and import OUT.tif")
    if not bands:
        raise UsageError(f"gdalinfo finds no raster in {path}")
    return info


class Layer:
    """A layer of polygons of a file, and whether its tags are those of OpenStreetMap."""

    def __init__(self, path, done, wanted):
        """Chooses the layer of a file of what ogrinfo told of it."""
        if fault := re.search(r"ERROR \d+: (.*(?:PROJ|SRS|CRS|crs).*)", done.stderr):
            raise UsageError(f"{path} names a coordinate system that GDAL does not know ({fault[1]}). {stated(path)}")
        self.is_osm = re.search(r"using driver `OSM'", done.stdout) is not None
        layers = [found.groups() for line in done.stdout.splitlines() if (found := LAYER.match(line))]
        names = [name for name, _ in layers]
        areas = [name for name, kind in layers if re.search("Polygon|Surface|Collection|Unknown", kind or "Unknown")]
        areas = ["multipolygons"] if self.is_osm else areas or names
        if wanted in names:
            areas = [wanted]
        if len(areas) != 1:
            raise UsageError(f"{path} holds {len(names)} layers: {', '.join(names)}. Remedy: --layer NAME says which has the houses"
                             if names else f"{path} holds no layer")
        self.path, self.name, self.others = path, areas[0], [name for name in names if name != areas[0]]
        self.summary = call("ogrinfo", "-ro", "-so", path, self.name)

    def count(self):
        """Returns the number of features."""
        found = re.search(r"^Feature Count: (\d+)", self.summary, re.M)
        if found:
            return int(found[1])
        table = self.name.replace('"', '""')  # OpenStreetMap's files have to be read for it
        found = re.search(r"= (\d+)", call("ogrinfo", "-ro", "-q", "-sql", f'SELECT COUNT(*) FROM "{table}"', self.path))
        return int(found[1]) if found else 0

    def extent(self):
        """Returns the rectangle round the features, in words; empty if the file does not tell."""
        found = re.search(r"^Extent: (.*)", self.summary, re.M)
        return f" at {found[1]}" if found else ""

    def system(self):
        """Returns the coordinate system of the layer, None if the file names none."""
        found = re.search(r"^Layer SRS WKT:\n(.*?)^(?:Data axis|[\w ]+:|Geometry)", self.summary, re.M | re.S)
        return System(found[1]) if found and SYSTEM.search(found[1]) else None


def stated(path):
    """Returns the remedy for polygons without a coordinate system that fits."""
    return f"Remedy: ogr2ogr -a_srs EPSG:N OUT.gpkg {path}, with the number N of its system, and import OUT.gpkg"


def element(wkt, start):
    """Returns the element of WKT that starts there, to its closing bracket."""
    depth, is_quoted = 0, False
    for k in range(start, len(wkt)):
        if wkt[k] == '"':
            is_quoted = not is_quoted
        elif not is_quoted and wkt[k] in "[]":
            depth += 1 if wkt[k] == "[" else -1
            if depth == 0:
                return wkt[start:k + 1]
    return wkt[start:]


class System:
    """A coordinate system: along the map, without its system of heights and without a shift to another datum."""

    def __init__(self, wkt):
        self.whole = wkt
        found = SYSTEM.search(wkt)
        self.wkt = element(wkt, found.start()) if found else ""
        found = re.search(r"\bVERTCRS\[", wkt)
        self.heights = element(wkt, found.start()) if found else ""

    @classmethod
    def of_number(cls, epsg):
        return cls(call("gdalsrsinfo", "-o", "wkt2", f"EPSG:{epsg}"))

    @functools.cached_property
    def code(self):
        """Returns authority and number as a pair, (None, None) if there is none."""
        own = re.search(r'\bID\["(\w+)",(\d+)\]\s*\]$', self.wkt)
        if own:
            return own[1], int(own[2])
        if not self.wkt:
            return None, None
        text = call("gdalsrsinfo", "-o", "epsg", self.wkt)  # prints EPSG also before numbers of ESRI
        found = re.search(r"EPSG:(\d+)", text)
        for authority in ("EPSG", "ESRI") if found and "Confidence" not in text else ():
            try:
                call("gdalsrsinfo", "-o", "wkt2", f"{authority}:{found[1]}")
                return authority, int(found[1])
            except UsageError:
                continue
        return None, None

    @property
    def epsg(self):
        """Returns the EPSG number, None if there is none."""
        return self.code[1] if self.code[0] == "EPSG" else None

    @property
    def name(self):
        return f"{self.code[0]}:{self.code[1]}" if self.code[0] else f"the system {title_of(self.wkt)} without number"

    @property
    def vertical_name(self):
        own = re.search(r'\bID\["(\w+)",(\d+)\]\s*\]$', self.heights)
        return title_of(self.heights) + (f", {own[1]}:{own[2]}" if own else "")

    def units(self):
        """Returns (unit, its metres) of the axes along the map and of the axis of heights; None where an axis has none."""
        axis = r'AXIS\["[^"]*",\w+.*?LENGTHUNIT\["([^"]*)",([0-9.e-]+)'
        return [(found[1], float(found[2])) if found else None
                for found in (re.search(axis, self.wkt, re.S), re.search(axis, self.heights, re.S))]

    def is_in_metres(self):
        """Returns true if the system is projected and counts metres to the east and north along the ground."""
        axes = re.findall(r'AXIS\["[^"]*",(\w+).*?LENGTHUNIT\["[^"]*",([0-9.e-]+)', self.wkt, re.S)
        of_the_world = re.search(r'METHOD\["[^"]*(Mercator|Cylindrical|Equal Earth)', self.wkt) and not re.search(
            r'METHOD\["[^"]*(Transverse|Oblique)', self.wkt)
        return self.wkt.startswith("PROJCRS") and bool(axes) and not of_the_world and all(
            float(unit) == 1 and direction not in ("south", "west") for direction, unit in axes)


def title_of(wkt):
    """Returns the name of an element of WKT, in quotes."""
    found = re.match(r'\w+\[("(?:[^"]|"")*")', wkt)
    return found[1] if found else '""'
