"""Rasters of heights as one raster in metres: system, bands, scale, unit, masks, holes."""

import re
import tempfile
from pathlib import Path

from wade import UsageError
from wade.imports.gdal import System, call, raster_info

FOOT = 0.3048
UNITS = {"": 1, "m": 1, "metre": 1, "meter": 1, "metres": 1, "meters": 1, "ft": FOOT, "foot": FOOT, "feet": FOOT,
         "us-ft": 1200 / 3937, "us survey foot": 1200 / 3937, "us survey feet": 1200 / 3937, "ftus": 1200 / 3937,
         "cm": 0.01, "mm": 0.001, "dm": 0.1, "km": 1000}
TEXT_GRIDS = ("AAIGrid", "GRASSASCIIGrid", "ISG", "XYZ", "USGSDEM")
LOWEST, HIGHEST = -500, 9000  # m, what the programs take for heights of ground


def holds_zeros(path):
    """Whether a file holds a byte of value 0."""
    with path.open("rb") as file:
        return any(b"\0" in piece for piece in iter(lambda: file.read(1 << 20), b""))


class Raster:
    """A raster of heights as its file has it."""

    def __init__(self, path):
        self.path, self.info = path, raster_info(path)
        self.system = System(self.info.get("coordinateSystem", {}).get("wkt", ""))
        self.bands = self.info["bands"]
        self.steps = self.info.get("geoTransform", [0, 1, 0, 0, 0, -1])

    def demand_heights(self):
        """Raises an error if the first band holds colours or complex numbers."""
        band = self.bands[0]
        colour = band.get("colorInterpretation", "Gray")
        if colour not in ("Gray", "Undefined") or "colorTable" in band:
            raise UsageError(f"{self.path} is a picture: its first band is of colours ({colour}); allowed: a raster of heights")
        if re.search(r'AXIS\["[^"]*",down\b', self.system.heights):
            raise UsageError(f"{self.path} counts depths, downwards ({self.system.vertical_name}); allowed: heights. Remedy: "
                             f"gdal_calc.py -A {self.path} --outfile OUT.tif --calc=-A, and gdal_edit.py -a_srs EPSG:N OUT.tif")
        if self.info.get("driverShortName") in TEXT_GRIDS and holds_zeros(self.path):
            raise UsageError(f"{self.path} is no text, as it holds bytes of value 0: it is damaged")
        if band.get("type", "").startswith("C"):
            raise UsageError(f"{self.path} holds complex numbers ({band['type']}); allowed: heights")

    def has_square_cells(self):
        return abs(abs(self.steps[1]) - abs(self.steps[5])) <= 1e-6 * abs(self.steps[1])

    def has_cells(self, origin, size):
        """Returns true if the cells are squares of that size and their corners meet the grid from the origin."""
        shifts = [(self.steps[k] - origin[k // 3]) / size for k in (0, 3)]
        return all(abs(abs(self.steps[k]) - size) <= 1e-6 * size for k in (1, 5)) and all(
            abs(shift - round(shift)) <= 1e-3 for shift in shifts)

    def unit(self, wanted):
        """Returns metres of one unit of the heights, and its name. Raises UsageError if the file leaves it open."""
        if wanted:
            return UNITS[wanted], wanted
        named = self.bands[0].get("unit", "").strip()
        if named:
            if named.lower() not in UNITS:
                raise UsageError(f'{self.path} has heights in "{named}"; allowed: m, ft, us-ft. Remedy: --heights-in says which')
            return UNITS[named.lower()], named
        along, upward = self.system.units()
        if upward:
            return upward[1], upward[0]
        if along and along[1] != 1:
            raise UsageError(f"{self.path} counts in {along[0]} along the map and does not say in what its heights are. Remedy: "
                             "--heights-in m, ft or us-ft")
        return 1, "m"

    def utm_zone(self):
        """Returns the EPSG number of the UTM zone round the middle, None if the file does not tell its position."""
        ring = self.info.get("wgs84Extent", {}).get("coordinates", [[]])[0]
        if not ring:
            return None
        east = sum(point[0] for point in ring[:4]) / 4
        north = sum(point[1] for point in ring[:4]) / 4
        return (32600 if north >= 0 else 32700) + min(60, int((east + 180) // 6) + 1)

    def in_metres(self, number, epsg, wanted, folder, notes):
        """Makes a file in the folder: the first band, its mask, scale and unit applied, with the system along the map."""
        band, masks = self.bands[0], []
        if len(self.bands) > 1:
            notes.add("bands", "the first band is read, further ones are not", f"{self.path}: {len(self.bands)} bands")
        alpha = next((b["band"] for b in self.bands if b.get("colorInterpretation") == "Alpha"), None)
        if alpha is not None:
            masks = ["-mask", alpha]
        if alpha is not None or "PER_DATASET" in band.get("mask", {}).get("flags", []):
            notes.add("mask", "masked cells have no height", self.path)
        if self.steps[5] > 0:
            notes.add("rows", "turned north up", self.path)
        system = []
        if self.system.heights:
            notes.add("vertical system", "left out: heights count from its zero", f"{self.path}: {self.system.vertical_name}")
            system = ["-a_srs", self.system.wkt]
        if self.system.wkt and self.system.epsg == epsg:
            system = ["-a_srs", f"EPSG:{epsg}"]  # no shift of datum, which BOUNDCRS would bring
        elif self.system.wkt:
            notes.add("system", f"reprojected from {self.system.name} to EPSG:{epsg}", self.path)
        source = folder / f"{number}.vrt"
        call("gdal_translate", "-q", "-b", 1, *masks, *system, "-of", "VRT", self.path.resolve(), source)
        if band.get("scale", 1) != 1 or band.get("offset", 0) != 0:
            notes.add("scale, offset", f"heights times {band.get('scale', 1):g} plus {band.get('offset', 0):g}", self.path)
            source, last = folder / f"{number}_unscaled.vrt", source
            call("gdal_translate", "-q", "-unscale", "-ot", "Float64", "-of", "VRT", last, source)
        factor, unit = self.unit(wanted)
        if factor != 1:
            notes.add("unit", f"heights in {unit} times {factor:.10g}", self.path)
            source, last = folder / f"{number}_metres.vrt", source
            call("gdal_translate", "-q", "-scale", 0, 1, 0, factor, "-ot", "Float64", "-of", "VRT", last, source)
        return source


def system_for(rasters, wanted):
    """Returns the EPSG number of the site."""
    if wanted:
        system = System.of_number(wanted)
        if not (system.is_in_metres() and system.epsg):
            raise UsageError(f"--epsg {wanted} is no projected system in metres; allowed: one, for example that of the UTM zone")
        return system.epsg
    first = rasters[0]
    if first.system.is_in_metres() and first.system.epsg:
        return first.system.epsg
    zone = first.utm_zone()
    if zone is None:
        raise UsageError(f"{first.path} names no coordinate system; state that of the file with gdal_edit.py -a_srs EPSG:N, or "
                         "its name with --epsg N, if it is in that")
    return zone


def import_ground(rasters, epsg, options, target, notes):
    """Writes the raster of heights; returns what gdalinfo tells of it."""
    words = ["-q", "-overwrite", "-novshift", "-t_srs", f"EPSG:{epsg}", "-r", "bilinear", "-ot", "Float32", "-dstnodata", "nan",
             "-co", "COMPRESS=DEFLATE", "-of", "GTiff"]
    if not any(raster.system.wkt for raster in rasters):
        words += ["-s_srs", f"EPSG:{epsg}"]
    cell, first = options.cell, rasters[0]
    if cell is None and len(rasters) == 1 and first.system.epsg == epsg and not first.has_square_cells():
        cell = min(abs(first.steps[1]), abs(first.steps[5]))
    if cell is not None:
        words += ["-tr", cell, cell]
    if options.crop:
        words += ["-te", *options.crop]
    with tempfile.TemporaryDirectory(dir=target.parent) as name:
        folder = Path(name)
        sources = [raster.in_metres(k, epsg, options.heights_in, folder, notes) for k, raster in enumerate(rasters)]
        warped = folder / "warped.tif"
        call("gdalwarp", *words, *sources, warped)
        demand_raster(warped, "gdalwarp")
        if options.fill:
            filled, holes = folder / "filled.tif", missing(warped)
            call("gdal_fillnodata.py", warped, filled, "-q", "-md", options.fill_cells, "-co", "COMPRESS=DEFLATE")
            demand_raster(filled, "gdal_fillnodata.py")
            notes.filled = holes - missing(filled)
            warped = filled
        warped.replace(target)
    info = raster_info(target)
    origin, size = info["geoTransform"][0::3], info["geoTransform"][1]
    for raster in rasters:
        if (raster.system.epsg == epsg or not raster.system.wkt) and not raster.has_cells(origin, size):
            notes.add("cells", f"resampled to squares of {size:g} m from the west and south that are stated",
                      f"{raster.path}: {abs(raster.steps[1]):g} x {abs(raster.steps[5]):g}")
    return info


def demand_raster(file, program):
    if not file.is_file():
        raise UsageError(f"{program} ended without an error and without a raster; does it work? {program} --version")


def heights_of(path):
    """Returns the values of a raster that this command has written, NaN where there is none."""
    import numpy as np  # only here, so that the help needs neither
    from PIL import Image

    Image.MAX_IMAGE_PIXELS = None
    with Image.open(path) as image:
        return np.asarray(image, dtype=float)


def missing(path):
    """Returns the number of cells without a height."""
    heights = heights_of(path)
    return int((heights != heights).sum())
