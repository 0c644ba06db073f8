"""Mutated files of sites: each is refused with exit code 2, or read back equal to what GDAL and Python read.

`SITE_FILES` is the number of files (2,000 of the long test, 120 of the quick one), `SITE_FILES_FIRST` the number of the first.
"""

import csv
import json
import math
import os
import pathlib
import random
import re
import resource
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib

from wade.outside import works

READER, SERVER, CROWD = (pathlib.Path(word) for word in sys.argv[1:4])
COUNT = int(os.environ.get("SITE_FILES", "120"))
FIRST = int(os.environ.get("SITE_FILES_FIRST", "0"))
MOST_CPU_S, MOST_KB = 2, 200_000  # of reading and checks of a file under 10 MB
COLUMNS, ROWS = 12, 9
HAS_GDAL = works("gdalinfo", "gdal_translate", "ogr2ogr")


def tiff(packed):
    """A GeoTIFF as the importer writes it: one band of float32, rows from the north."""
    values = struct.pack(f"<{COLUMNS * ROWS}f", *(10 + 0.125 * k for k in range(COLUMNS * ROWS)))
    data = zlib.compress(values) if packed else values
    tags = [(256, "I", [COLUMNS]), (257, "I", [ROWS]), (258, "H", [32]), (259, "H", [8 if packed else 1]), (262, "H", [1]),
            (273, "I", [8]), (277, "H", [1]), (278, "I", [ROWS]), (279, "I", [len(data)]), (339, "H", [3]), (33550, "d", [2, 2, 0]),
            (33922, "d", [0, 0, 0, 500000, 5200018, 0]),
            (34735, "H", [1, 1, 0, 4, 1024, 0, 1, 1, 1025, 0, 1, 1, 3072, 0, 1, 32632, 3076, 0, 1, 9001]), (42113, "s", b"-9999\0")]
    start = 8 + len(data)
    beyond, entries = b"", b""
    for number, kind, content in tags:
        raw = content if kind == "s" else struct.pack(f"<{len(content)}{kind}", *content)
        place = start + 2 + 12 * len(tags) + 4 + len(beyond)
        entries += struct.pack("<HHI", number, {"H": 3, "I": 4, "d": 12, "s": 2}[kind], len(content))
        entries += raw.ljust(4, b"\0") if len(raw) <= 4 else struct.pack("<I", place)
        beyond += raw if len(raw) > 4 else b""
    return b"II*\0" + struct.pack("<I", start) + data + struct.pack("<H", len(tags)) + entries + b"\0\0\0\0" + beyond


def grid():
    rows = "\n".join(" ".join(str(10 + 0.125 * (row * COLUMNS + column)) for column in range(COLUMNS)) for row in range(ROWS))
    return f"ncols {COLUMNS}\nnrows {ROWS}\nxllcorner 500000\nyllcorner 5200000\ncellsize 2\nNODATA_value -9999\n{rows}\n".encode()


def houses():
    def square(x, y, size=3):
        return [[500000 + x + a, 5200000 + y + b] for a, b in ((0, 0), (size, 0), (size, size), (0, size), (0, 0))]
    shapes = [{"type": "Polygon", "coordinates": [square(2, 2), square(3, 3, 1)]}, {"type": "Polygon", "coordinates": [square(8, 2)]},
              {"type": "MultiPolygon", "coordinates": [[square(14, 8)], [square(18, 12)]]}]
    features = [{"type": "Feature", "properties": {"name": f"h{k}", "residents": k, "height_m": 6.5}, "geometry": shape}
                for k, shape in enumerate(shapes)]
    crs = {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::32632"}}
    return json.dumps({"type": "FeatureCollection", "crs": crs, "features": features}).encode()


def series():
    return ("# gauge\ntime_s,\"other, of the gauge\",level_m\n" + "".join(f"{60 * k},\"x,{k}\",{11 + 0.25 * k}\n" for k in range(8))).encode()


KINDS = {"raster": ("packed.tif", "plain.tif", "ground.asc"), "map": ("houses.geojson",), "series": ("stage.csv",)}
SOURCES = {"packed.tif": tiff(True), "plain.tif": tiff(False), "ground.asc": grid(), "houses.geojson": houses(), "stage.csv": series()}
WORDS = [b"-9999", b"1e300", b"nan", b"0", b"-1", b"99999999", b"1e-9", b"null", b"true", b"\"3\"", b"[]", b"{}", b",", b";", b"\"", b"\0",
         b"-999", b"4326", b"2263", b"1,5", b"\xef\xbb\xbf", b"\r", b"700000000"]


def mutated(source, chance):
    """One to four changes: bytes, words in place of words or numbers, parts twice or missing, a cut."""
    text = bytearray(source)
    for _ in range(chance.choice((1, 1, 1, 2, 2, 4))):
        at = chance.randrange(max(1, len(text)))
        way = chance.randrange(10)
        digits = list(re.finditer(rb"[0-9]", bytes(text))) if way > 5 else []
        if digits:
            text[chance.choice(digits).start()] = chance.choice(b"0123456789")
        elif way == 0:
            text[at:at + 1] = bytes([chance.randrange(256)])
        elif way == 1:
            found = list(re.finditer(rb"[-0-9.]+|[A-Za-z_]+", bytes(text)))
            word = chance.choice(found) if found else None
            if word:
                text[word.start():word.end()] = chance.choice(WORDS)
        elif way == 2:
            text[at:at] = chance.choice(WORDS)
        elif way == 3:
            end = min(len(text), at + chance.randrange(1, 40))
            text[at:at] = text[at:end]
        elif way == 4:
            del text[at:at + chance.randrange(1, 20)]
        elif chance.random() < 0.3:
            del text[at:]
        else:  # a field of a directory of TIFF, or a byte
            at = max(0, len(text) - chance.randrange(1, 320))
            text[at:at + 2] = struct.pack("<H", chance.choice((0, 1, 2, 3, 4, 8, 32, 64, 255, 9001, 9002, 32632, 32767, 65535)))
    return bytes(text)


def run(*words):
    """Exit code, output, and what it cost, of a program that may take no more than it should."""
    def limit():
        resource.setrlimit(resource.RLIMIT_CPU, (60, 60))
        resource.setrlimit(resource.RLIMIT_AS, (8 << 30, 8 << 30))
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as errors:
        process = subprocess.Popen([str(word) for word in words], stdout=out, stderr=errors, preexec_fn=limit)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        for stream in (out, errors):
            stream.seek(0)
        said = out.read().decode(errors="replace")
        return process.returncode, said, errors.read().decode(errors="replace"), usage


def of_gdal(*words):
    done = subprocess.run([str(word) for word in words], capture_output=True)
    return done.stdout if done.returncode == 0 else None


class SiteFiles(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="wade-site-")
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        for name in ("plain.tif",):
            (self.folder / f"whole_{name}").write_bytes(SOURCES[name])

    def scene(self, kind, name):
        site = {"epsg": 32632, "ground": {"file": name if kind == "raster" else "whole_plain.tif"}}
        if kind == "map":
            site["houses"] = [{"file": name}]
        if kind == "series":
            site["outlets"] = [{"line": [[0, 0], [0, 18]], "kind": "stage", "stage_csv": name}]
        file = self.folder / "scene.json"
        file.write_text(json.dumps({"duration_s": 10, "frame_rate_hz": 2, "site": site, "fluid": {"shallow_water": {"cell_size_m": 2}}}))
        return file

    def assert_cheap(self, usage, what):
        self.assertLess(usage.ru_utime + usage.ru_stime, MOST_CPU_S, what)
        self.assertLess(usage.ru_maxrss, MOST_KB, what)

    def test_each_is_refused_or_read_as_others_read_it(self):
        read = refused = 0
        for number in range(FIRST, FIRST + COUNT):
            chance = random.Random(number)
            kind = chance.choice(("raster", "raster", "raster", "map", "map", "series"))
            name = chance.choice(KINDS[kind])
            file = self.folder / name
            file.write_bytes(mutated(SOURCES[name], chance))
            what = f"file {number}, {name}"
            code, said, error, usage = run(READER, kind, file)
            self.assertIn(code, (0, 2), f"{what}: {error}")
            self.assert_cheap(usage, what)
            scene = self.scene(kind, name)
            codes = []
            for program in (CROWD, SERVER):
                its_code, _, its_error, its_usage = run(program, scene, "--check")
                self.assertIn(its_code, (0, 2), f"{what}, {program.name}: {its_error}")
                self.assert_cheap(its_usage, f"{what}, {program.name}")
                codes.append((its_code, re.sub(r"\s+", " ", its_error).replace(program.name, "") if its_code else ""))
            self.assertEqual(codes[0], codes[1], what)
            refused += code == 2
            if code == 0:
                read += 1
                {"raster": self.compare_raster, "map": self.compare_map, "series": self.compare_series}[kind](file, said, what)
        print(f"{read} files read, {refused} refused")
        self.assertGreater(min(read, refused), COUNT // 20)

    def compare_raster(self, file, said, what):
        if not HAS_GDAL:
            return
        head, *values = said.split("\n")
        columns, rows, x, z, cell = (float(word) for word in head.split()[:5])
        values = [float(word) for word in values if word]
        info = of_gdal("gdalinfo", "-json", file)
        self.assertIsNotNone(info, f"{what}: GDAL does not read it")
        info = json.loads(info)
        self.assertEqual(info["size"], [columns, rows], what)
        step = info["geoTransform"]
        for ours, theirs in ((x, step[0]), (z + rows * cell, step[3]), (cell, step[1]), (-cell, step[5])):
            self.assertLessEqual(abs(ours - theirs), 1e-6 * cell + 1e-9 * abs(theirs), what)
        out = self.folder / "values.bin"
        self.assertIsNotNone(of_gdal("gdal_translate", "-q", "-ot", "Float64", "-of", "ENVI", file, out), what)
        theirs = struct.unpack(f"<{int(columns * rows)}d", out.read_bytes())
        none = info["bands"][0].get("noDataValue")
        none = math.nan if none is None or none == "NaN" else float(none)
        rounded = (lambda v: struct.unpack("<f", struct.pack("<f", v))[0]) if file.suffix == ".asc" else (lambda v: v)
        for k, theirs_k in enumerate(theirs):
            row, column = divmod(k, int(columns))
            ours = values[(int(rows) - 1 - row) * int(columns) + column]
            if math.isnan(ours):
                self.assertTrue(math.isnan(theirs_k) or theirs_k == none, f"{what}: {theirs_k} is no value here")
            else:
                self.assertEqual(rounded(ours), theirs_k, what)

    def compare_map(self, file, said, what):
        if not HAS_GDAL:
            return
        text = of_gdal("ogr2ogr", "-f", "GeoJSON", "-lco", "COORDINATE_PRECISION=15", "/vsistdout/", file)
        self.assertIsNotNone(text, f"{what}: GDAL does not read it")
        theirs = []
        for feature in json.loads(text)["features"]:
            geometry = feature["geometry"] or {"type": "none"}
            rings = {"Polygon": lambda c: c, "MultiPolygon": lambda c: [ring for part in c for ring in part],
                     "LineString": lambda c: [c], "Point": lambda c: [[c]]}.get(geometry["type"], lambda c: [])
            for ring in rings(geometry.get("coordinates")):
                points = [point[:2] for k, point in enumerate(ring) if k == 0 or point[:2] != ring[k - 1][:2]]
                closed = "Polygon" in geometry["type"] and len(points) > 1 and points[0] == points[-1]
                theirs.append([float(v) for point in (points[:-1] if closed else points) for v in point])
        ours = [[float(word) for word in line.split()] for line in said.split("\n") if line]
        self.assertEqual(len(ours), len(theirs), what)
        for a, b in zip(ours, theirs):
            self.assertEqual(len(a), len(b), what)
            self.assertTrue(all(abs(v - w) <= 1e-9 * max(1, abs(w)) for v, w in zip(a, b)), what)

    def compare_series(self, file, said, what):
        lines = file.read_text(encoding="utf-8-sig", errors="replace").splitlines()
        rows = [row for row in csv.reader(line for line in lines if line.strip() and not line.lstrip().startswith("#"))]
        names = [name.strip() for name in rows[0]]
        time = names.index("time_s")
        value = names.index("level_m") if "level_m" in names else 1 - time
        theirs = [[float(row[time]), float(row[value])] for row in rows[1:]]
        self.assertEqual([[float(word) for word in line.split()] for line in said.split("\n") if line], theirs, what)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
