"""tools/wade site import, where GDAL's programs are installed: what it writes is what went in, in metres."""

import contextlib
import io
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

from wade import UsageError, site
from wade.imports import gdal, houses
from wade.outside import works

CELLS = 12
LEVEL = "".join("".join(f"{50 + 0.25 * (CELLS - 1 - row) + 0.5 * column} " for column in range(CELLS)) + "\n" for row in range(CELLS))
GRID = f"ncols {CELLS}\nnrows {CELLS}\nxllcorner 500000\nyllcorner 5500000\ncellsize 2\nnodata_value -9999\n{LEVEL}"
HOUSES = {
    "type": "FeatureCollection",
    "crs": {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::32632"}},
    "features": [
        {"type": "Feature", "properties": {"building": "yes", "building:levels": "2", "name": "mill"},
         "geometry": {"type": "Polygon", "coordinates": [[[500004, 5500004], [500010, 5500004], [500010, 5500012], [500004, 5500004]]]}},
        {"type": "Feature", "properties": {"height": "4.5 m"},
         "geometry": {"type": "Polygon", "coordinates": [[[510004, 5500004], [510010, 5500004], [510010, 5500012], [510004, 5500004]]]}},
        {"type": "Feature", "properties": {},
         "geometry": {"type": "LineString", "coordinates": [[500004, 5500004], [500010, 5500004]]}},
    ],
}


class Help(unittest.TestCase):
    def test_it_says_what_is_missing_where_gdal_is(self):
        found = shutil.which
        self.addCleanup(setattr, shutil, "which", found)
        shutil.which = lambda _: None
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "a.asc").write_text(GRID)
            with self.assertRaisesRegex(UsageError, "apt-get install gdal-bin"):
                site.main(["import", str(Path(folder) / "a.asc"), "--out", str(Path(folder) / "out")])

    def test_the_scene_has_frames_often_enough_for_people(self):
        rate = re.search(r'"frame_rate_hz": ([0-9.]+)', site.scene_text("village", True, 1))
        self.assertGreaterEqual(float(rate[1]), 2)  # below, both programs warn

    def test_another_word_than_import_is_refused(self):
        with contextlib.redirect_stderr(io.StringIO()) as told:
            self.assertEqual(site.main(["export"]), 2)
        self.assertIn("allowed: import", told.getvalue())


class Maps(unittest.TestCase):
    def test_the_bar_has_a_round_length(self):
        from wade.pictures import site_maps

        self.assertEqual([site_maps.round_length(x) for x in (0.7, 9.9, 49.9, 50, 1234)], [0.5, 5, 20, 50, 1000])

    def test_a_house_with_a_hole_is_drawn_by_its_outer_ring(self):
        from wade.pictures import top_view

        square, hole = [[0, 0], [9, 0], [9, 9], [0, 0]], [[1, 1], [2, 1], [2, 2], [1, 1]]
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "houses.geojson"
            file.write_text(json.dumps({"type": "MultiPolygon", "coordinates": [[square, hole], [square]]}))
            scene = {"site": {"origin_easting_m": 5, "houses": [{"polygon": [[1, 2], [3, 4], [5, 6]]}, {"file": str(file)}]}}
            houses = top_view.polygons_of(scene, "houses")
        self.assertEqual([len(house) for house in houses], [3, 4, 4])
        self.assertEqual(houses[1][1].tolist(), [4, 0])


@unittest.skipUnless(works("gdalwarp", "ogr2ogr"), "GDAL's programs are not installed")
class Import(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="wade-test-")
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)
        (self.folder / "ground.asc").write_text(GRID)
        (self.folder / "houses.geojson").write_text(json.dumps(HOUSES))
        self.out = self.folder / "out"

    def imported(self, *arguments):
        with contextlib.redirect_stdout(io.StringIO()) as told:
            self.assertEqual(site.main(["import", *map(str, arguments), "--out", str(self.out)]), 0)
        return told.getvalue()

    def test_a_grid_in_the_system_that_is_asked_for_keeps_its_heights(self):
        told = self.imported(self.folder / "ground.asc", self.folder / "houses.geojson", "--epsg", 32632)
        self.assertIn("12 x 12 cells of 2 m, EPSG:32632, west 500000.00 south 5500000.00", told)
        heights = site.heights_of(self.out / "ground.tif")
        for row in range(CELLS):  # multiples of 1/4, which float32 holds
            for column in range(CELLS):
                self.assertEqual(heights[row, column], 50 + 0.25 * (CELLS - 1 - row) + 0.5 * column)

    def test_houses_that_meet_the_ground_are_kept_with_their_heights(self):
        self.imported(self.folder / "ground.asc", self.folder / "houses.geojson", "--epsg", 32632)
        houses = json.loads((self.out / "houses.geojson").read_text())
        self.assertEqual([house["properties"] for house in houses["features"]], [{"name": "mill", "height_m": 6.0}])
        self.assertEqual(houses["features"][0]["geometry"]["coordinates"][0][0][0], 500004)
        self.assertIn("32632", houses["crs"]["properties"]["name"])

    def made(self, name, *words):
        """A raster that GDAL makes of the grid, in EPSG:32632."""
        made = self.folder / name
        subprocess.run(["gdal_translate", "-q", "-a_srs", "EPSG:32632", *map(str, words), self.folder / "ground.asc", made], check=True,
                       stderr=subprocess.DEVNULL)
        return made

    def test_scale_offset_unit_mask_and_rows_from_the_south_give_the_heights_that_they_mean(self):
        plain = 50 + 0.5 * (CELLS - 1)  # of the last column of the southern row
        of = {
            "scaled.tif": (["-a_scale", 0.01, "-a_offset", 100], 100 + 0.01 * plain, "times 0.01 plus 100"),
            "south_up.tif": (["-a_ullr", 500000, 5500000, 500024, 5500024], 50 + 0.25 * (CELLS - 1) + 0.5 * (CELLS - 1), "turned north up"),
        }
        for name, (words, height, word) in of.items():
            told = self.imported(self.made(name, *words))
            self.assertIn(word, told)
            self.assertAlmostEqual(site.heights_of(self.out / "ground.tif")[-1, -1], height, places=4)
        feet = self.made("feet.tif", "-a_srs", "EPSG:2263", "-a_ullr", 980000, 190024, 980024, 190000)
        with self.assertRaisesRegex(UsageError, "US survey foot along the map and does not say.*--heights-in"):
            self.imported(feet)
        told = self.imported(feet, "--heights-in", "us-ft")
        self.assertRegex(told, "reprojected from EPSG:2263(.|\n)*heights in us-ft times 0.3048006096")
        heights = site.heights_of(self.out / "ground.tif")
        self.assertAlmostEqual(heights[heights == heights].max(), 0.3048 * (50 + 0.75 * (CELLS - 1)), delta=0.3048)
        with self.assertRaisesRegex(UsageError, "--epsg 2263 is no projected system in metres"):
            self.imported(self.folder / "ground.asc", "--epsg", 2263)

    def test_masked_cells_have_no_height(self):
        (self.folder / "mask.asc").write_text(re.sub(r"\n5[0-9.]+ ", "\n0 ", GRID))  # the western column
        masked = self.folder / "masked.tif"
        subprocess.run(["gdalbuildvrt", "-q", "-separate", self.folder / "two.vrt", self.folder / "ground.asc",
                        self.folder / "mask.asc"], check=True)
        subprocess.run(["gdal_translate", "-q", "-a_srs", "EPSG:32632", "-a_nodata", "none", "-b", "1", "-mask", "2", "--config",
                        "GDAL_TIFF_INTERNAL_MASK", "YES", self.folder / "two.vrt", masked], check=True)
        told = self.imported(masked)
        self.assertIn("masked cells have no height", told)
        heights = site.heights_of(self.out / "ground.tif")
        self.assertTrue((heights[:, 0] != heights[:, 0]).all() and (heights[:, 1:] == heights[:, 1:]).all())

    def test_an_untagged_number_for_no_data_is_refused_with_a_remedy_that_works(self):
        (self.folder / "ground.asc").write_text(GRID.replace("-9999", "-1").replace("50.0 ", "3.4028234e38 "))
        with self.assertRaisesRegex(UsageError, "gdal_translate -a_nodata ([0-9.e+]+) FILE") as refused:
            self.imported(self.made("void.tif"))
        number = re.search("-a_nodata (\\S+)", str(refused.exception))[1]
        self.assertIn("1 of 144 cells have no height", self.imported(self.made("tagged.tif", "-a_nodata", number)))

    def test_houses_stand_once_with_the_heights_that_their_tags_mean(self):
        def feature(k, properties, parts=1):
            squares = [[[[x, 5500002], [x + 0.5, 5500002], [x + 0.5, 5500004], [x, 5500004], [x, 5500002]]]
                       for x in (500001 + 1.5 * k + 0.6 * part for part in range(parts))]
            return {"type": "Feature", "properties": properties, "geometry": {"type": "MultiPolygon", "coordinates": squares}}
        heights = {"39'": 11.89, "39 ft": 11.89, "12,5": 12.5, "12m": 12, "12 m": 12, "7'4\"": 2.24, "tall": None, "-5": None}
        features = [feature(k, {"Height": text}) for k, text in enumerate(heights)]
        features += [feature(8, {"residents": "10"}, 2), feature(8, {"residents": 10}, 2), feature(10, {"building": "no"}),
                     feature(11, {"other_tags": '"building:levels"=>"5","name:de"=>"x \\"y\\""'}), feature(12, {"residents": 3.5})]
        file = self.folder / "tags.geojson"
        file.write_text(json.dumps({**HOUSES, "features": features}))
        told = self.imported(self.folder / "ground.asc", file, "--epsg", 32632)
        kept = [house["properties"] for house in json.loads((self.out / "houses.geojson").read_text())["features"]]
        self.assertEqual([house.get("height_m") for house in kept[:8]], list(heights.values()))
        self.assertEqual(kept[8:], [{"residents": 10}, {"height_m": 15.0}, {}])
        for row in ("building=no +1: left out", "stands twice +1: left out", "height not understood +2: the scene's height_m .height=tall",
                    "residents not understood +1", "decimal comma +1", "of several parts +1: kept as one house"):
            self.assertRegex(told, row)

    def house(self, west, south, size, **properties):
        """A square house, metres from the corner of the ground."""
        ring = [[500000 + west + x * size, 5500000 + south + y * size] for x, y in ((0, 0), (1, 0), (1, 1), (0, 1), (0, 0))]
        return {"type": "Feature", "properties": properties, "geometry": {"type": "Polygon", "coordinates": [ring]}}

    def imported_houses(self, *features, **changes):
        file = self.folder / "some.geojson"
        file.write_text(json.dumps({**HOUSES, "features": features, **changes}))
        told = self.imported(self.folder / "ground.asc", file, "--epsg", 32632)
        return told, json.loads((self.out / "houses.geojson").read_text())["features"]

    def osm(self, *ways):
        """A file of OpenStreetMap with a square of 2 m per way, from west to east."""
        places = [(500001 + 3 * k + x, 5500001 + y) for k in range(len(ways)) for x, y in ((0, 0), (2, 0), (2, 2), (0, 2))]
        done = subprocess.run(["gdaltransform", "-s_srs", "EPSG:32632", "-t_srs", "EPSG:4326", "-output_xy"], check=True, text=True,
                              capture_output=True, input="".join(f"{x} {y}\n" for x, y in places))
        lines = [f'<node id="{k + 1}" version="1" lat="{line.split()[1]}" lon="{line.split()[0]}"/>'
                 for k, line in enumerate(done.stdout.splitlines())]
        for k, tags in enumerate(ways):
            nodes = "".join(f'<nd ref="{4 * k + corner}"/>' for corner in (1, 2, 3, 4, 1))
            nodes += "".join(f'<tag k="{name}" v="{value}"/>' for name, value in tags.items())
            lines.append(f'<way id="{k + 1}" version="1">{nodes}</way>')
        text = "\n".join(lines)
        return f'<?xml version="1.0"?><osm version="0.6" generator="x">{text}</osm>'

    def test_areas_of_openstreetmap_are_houses_only_with_walls_on_the_ground(self):
        of = [{"landuse": "residential"}, {"amenity": "parking"}, {"building": "yes", "name": "mill"}]
        lost = [{"building": "roof"}, {"building": "Carport"}, {"building": "yes", "wall": "no"},
                {"building": "yes", "location": "underground"}, {"building": "yes", "layer": "-1"}, {"building": "yes", "min_height": "5 m"}]
        for name, tags in (("a.osm", of), ("B.OSM", of), ("c.osm", [*lost, {"building": "yes", "layer": "1", "name": "mill"}])):
            file = self.folder / name
            file.write_text(self.osm(*tags))
            told = self.imported(self.folder / "ground.asc", file, "--epsg", 32632)
            kept = json.loads((self.out / "houses.geojson").read_text())["features"]
            self.assertEqual([house["properties"] for house in kept], [{"name": "mill"}])
            for row in (["no building +2"] if tags is of else ["without walls +3", "under the ground +2", "above the ground +1"]):
                self.assertRegex(told, row)

    def test_exports_of_openstreetmap_need_the_tag_building_and_other_files_do_not(self):
        told, kept = self.imported_houses(
            self.house(1, 1, 2, osm_id="1", landuse="meadow"), self.house(4, 1, 2, osm_id="2", fclass="building"), self.house(
                7, 1, 2, building=None), self.house(10, 1, 2), self.house(13, 1, 2, **{"@id": "way/3", "amenity": "parking"}))
        self.assertRegex(told, "no building +3: left out")
        self.assertEqual(len(kept), 2)

    def test_a_house_stands_once_though_its_copies_differ_a_little_or_lie_within_it(self):
        told, kept = self.imported_houses(
            self.house(2, 2, 10, residents=4), self.house(2.06, 2, 10.2, residents=3), self.house(3, 3, 8, residents=2),
            self.house(12.3, 2, 4), self.house(12.3, 6, 4, residents=7))
        self.assertEqual([house["properties"] for house in kept], [{"residents": 4}, {}, {"residents": 7}])
        self.assertRegex(told, "stands twice +1: left out, with 3 residents")
        self.assertRegex(told, "within another house +1: left out, with 2 residents")

    def test_outlines_are_compared_by_their_common_area(self):
        def outline(*rings):
            return houses.Outline([[[*ring, ring[0]] for ring in rings]])

        def square(west, size):
            return [[west, 0], [west + size, 0], [west + size, size], [west, size]]
        whole, court, turned = outline(square(0, 10)), outline(square(-5, 20), [[-1, -1], [11, -1], [11, 11], [-1, 11]]), outline(
            [[5, -2], [12, 5], [5, 12], [-2, 5]])
        self.assertAlmostEqual(whole.fraction_in(outline(square(2, 10))), 0.8, delta=1 / 64)
        self.assertAlmostEqual(whole.fraction_in(outline(square(10, 10))), 0, delta=1 / 64)
        self.assertEqual(whole.fraction_in(court), 0)
        self.assertAlmostEqual(whole.fraction_in(turned), 1 - 4 * 9 / 2 / 100, delta=1 / 64)  # four corners of 3 m are cut off
        self.assertEqual(houses.repeated([outline(square(0, 8)), outline(square(20, 5)), whole]), {0: False})

    def test_shapes_beside_the_ground_are_counted_and_all_of_them_are_an_error(self):
        inside, far = self.house(2, 2, 4), self.house(2000, 2, 4)
        self.assertRegex(self.imported_houses(inside, far, far)[0], "outside +2: left out")
        told, kept = self.imported_houses(inside, self.house(2, 2, 5000, residents=3))
        self.assertRegex(told, "beyond the ground +1: left out: a corner is more than 1000 m off, with 3 residents")
        self.assertEqual(len(kept), 1)
        self.assertIn("0 houses", self.imported_houses()[0])
        with self.assertRaisesRegex(UsageError, r"none of 2 shapes of .* lies on the ground(.|\n)*ogr2ogr -a_srs EPSG:N"):
            self.imported_houses(far, far)
        with self.assertRaisesRegex(UsageError, r"none of 1 shapes of .* in EPSG:4326(.|\n)*ogr2ogr -a_srs EPSG:N"):
            self.imported_houses(inside, crs=None)
        with self.assertRaisesRegex(UsageError, "names a coordinate system that GDAL does not know.*ogr2ogr -a_srs"):
            self.imported_houses(inside, crs={"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::99999"}})
        subprocess.run(["ogr2ogr", "-f", "ESRI Shapefile", "-where", "name='mill'", self.folder / "bare.shp", self.folder / "houses.geojson"],
                       check=True, stderr=subprocess.DEVNULL)
        (self.folder / "bare.prj").unlink()
        with self.assertRaisesRegex(UsageError, "names no coordinate system. Remedy: ogr2ogr"):
            self.imported(self.folder / "ground.asc", self.folder / "bare.shp", "--epsg", 32632)

    def test_the_layer_of_houses_is_the_one_of_polygons_or_the_one_that_is_named(self):
        file = self.folder / "two.gpkg"
        lines = {**HOUSES, "features": HOUSES["features"][2:]}
        (self.folder / "lines.geojson").write_text(json.dumps(lines))
        areas = {**HOUSES, "features": HOUSES["features"][:2]}
        (self.folder / "areas.geojson").write_text(json.dumps(areas))
        for name, more in (("areas", []), ("lines", ["-update"])):
            subprocess.run(["ogr2ogr", "-f", "GPKG", *more, file, self.folder / f"{name}.geojson", "-nln", name], check=True)
        told = self.imported(self.folder / "ground.asc", file, "--epsg", 32632)
        self.assertRegex(told, "1 house\n(.|\n)*layers +1: areas is read .*not lines")
        subprocess.run(["ogr2ogr", "-f", "GPKG", "-update", file, self.folder / "areas.geojson", "-nln", "plots"], check=True)
        with self.assertRaisesRegex(UsageError, "holds 3 layers: areas, lines, plots. Remedy: --layer NAME"):
            self.imported(self.folder / "ground.asc", file, "--epsg", 32632)
        self.assertIn("plots is read", self.imported(self.folder / "ground.asc", file, "--epsg", 32632, "--layer", "plots"))

    def files_of(self, folder):
        return {file.name: file.read_bytes() for file in folder.iterdir()}

    def test_an_import_replaces_what_it_wrote_and_nothing_else(self):
        ground = self.folder / "ground.asc"
        self.imported(ground, self.folder / "houses.geojson", "--epsg", 32632)
        self.imported(ground, "--epsg", 32632)
        self.assertEqual(sorted(self.files_of(self.out)), ["ground.tif", "scene.json"])
        self.imported(ground, self.folder / "houses.geojson", "--epsg", 32632)
        for name in ("houses.geojson", "scene.json", "ground.tif"):
            before = self.files_of(self.out)
            (self.out / name).write_bytes(before[name] + b" ")
            with self.assertRaisesRegex(UsageError, f"{name}.*of other origin or changed.*Remedy"):
                self.imported(ground, "--epsg", 32632)
            self.assertEqual(self.files_of(self.out), {**before, name: before[name] + b" "})
            (self.out / name).write_bytes(before[name])

    def test_an_input_with_the_name_of_an_output_is_refused(self):
        self.out.mkdir()
        shutil.copy(self.made("own.tif", "-a_scale", 0.5), self.out / "ground.tif")
        before = self.files_of(self.out)
        subprocess.run(["gdal_translate", "-q", "-of", "VRT", self.out / "ground.tif", self.folder / "of.vrt"], check=True)
        for name in (self.out / "ground.tif", self.folder / "of.vrt"):
            with self.assertRaisesRegex(UsageError, "ground.tif is read, and would be written"):
                self.imported(name)
        with self.assertRaisesRegex(UsageError, "of other origin"):
            self.imported(self.folder / "ground.asc", "--epsg", 32632)
        self.assertEqual(self.files_of(self.out), before)

    def test_an_import_that_fails_or_is_interrupted_leaves_the_folder_as_it_was(self):
        with self.assertRaisesRegex(UsageError, "does --crop lie on it"):
            self.imported(self.folder / "ground.asc", "--epsg", 32632, "--crop", 0, 0, 10, 10)
        self.assertFalse(self.out.exists())
        self.imported(self.folder / "ground.asc", "--epsg", 32632)
        before = self.files_of(self.out)
        (self.folder / "high.asc").write_text(GRID.replace("50.0 ", "1e30 "))
        with self.assertRaisesRegex(UsageError, "allowed: -500 to 9000 m"):
            self.imported(self.folder / "high.asc", "--epsg", 32632)
        self.assertEqual(self.files_of(self.out), before)
        tools = self.folder / "tools"
        tools.mkdir()
        slow = tools / "gdalwarp"
        slow.write_text(f"#!/bin/sh\nfor last; do :; done\n: > $last\n: > {self.folder}/started\nexec sleep 100\n")
        slow.chmod(0o755)
        code = "import sys; from wade import site; site.main(sys.argv[1:])"
        running = subprocess.Popen([sys.executable, "-c", code, "import", self.folder / "ground.asc", "--epsg", "32632", "--out", self.out],
                                   env={**os.environ, "PATH": f"{tools}:{os.environ['PATH']}", "PYTHONPATH": os.pathsep.join(sys.path)},
                                   stderr=subprocess.DEVNULL, start_new_session=True)
        while not (self.folder / "started").exists() and running.poll() is None:
            time.sleep(0.05)
        os.killpg(running.pid, signal.SIGINT)
        running.wait()
        self.assertEqual(self.files_of(self.out), before)

    def test_programs_of_gdal_that_are_broken_are_told_in_one_line(self):
        tools = self.folder / "tools"
        tools.mkdir()
        path = os.environ["PATH"]
        self.addCleanup(os.environ.__setitem__, "PATH", path)
        os.environ["PATH"] = f"{tools}:{path}"
        for program, script, word in (("gdalinfo", "echo '{broken'", "gdalinfo does not describe"), ("gdalwarp", "exit 0", "without a raster"),
                                      ("gdalwarp", "kill -SEGV $$", "ended by SIGSEGV"), ("gdalwarp", "exit 3", "exit code 3 without a reason")):
            (tools / program).write_text(f"#!/bin/bash\n[ $1 = --version ] && exit\n{script}\n")
            (tools / program).chmod(0o755)
            with self.assertRaisesRegex(UsageError, word) as told:
                self.imported(self.folder / "ground.asc", "--epsg", 32632)
            self.assertNotIn("\n", str(told.exception))
            (tools / program).unlink()

    def test_only_plain_files_are_opened(self):
        os.mkfifo(self.folder / "fifo.tif")
        for file, word in ((self.folder / "fifo.tif", "FIFO"), (Path("/dev/zero"), "device"), (self.folder, "folder")):
            with self.assertRaisesRegex(UsageError, word):
                self.imported(file)
        (self.folder / "a.osm.gz").write_bytes(b"\x1f\x8b")
        with self.assertRaisesRegex(UsageError, "Remedy: unpack"):
            self.imported(self.folder / "ground.asc", self.folder / "a.osm.gz")

    def test_the_first_band_is_read_and_pictures_are_refused(self):
        bands = ["-b", 1, "-b", 1, "-b", 1]
        told = self.imported(self.made("three.tif", *bands))
        self.assertRegex(told, "bands +1 of 1 raster: the first band is read.*3 bands")
        plain = site.heights_of(self.out / "ground.tif")
        told = self.imported(self.made("alpha.tif", *bands[:4], "-colorinterp_2", "alpha", "-scale_2", 52, 53, 0, 255, "-ot", "Float32"))
        self.assertRegex(told, "mask +1 of 1 raster(.|\n)*no height")
        heights = site.heights_of(self.out / "ground.tif")
        there = heights == heights
        self.assertTrue(0 < there.sum() < there.size and (heights[there] == plain[there]).all())
        with self.assertRaisesRegex(UsageError, r"rgb.tif is a picture.*\(Red\)"):
            self.imported(self.made("rgb.tif", *bands, "-ot", "Byte", "-colorinterp", "red,green,blue"))
        subprocess.run(["gdaldem", "color-relief", "-q", "-of", "VRT", self.made("low.tif"), self.colours(), self.folder / "relief.vrt"],
                       check=True)
        subprocess.run(["gdal_translate", "-q", "-of", "GIF", "-b", "1", self.made("byte.tif", "-ot", "Byte"), self.folder / "palette.gif"],
                       check=True)
        for name in ("relief.vrt", "palette.gif"):
            with self.assertRaisesRegex(UsageError, f"{name} is a picture"):
                self.imported(self.folder / name)
        with self.assertRaisesRegex(UsageError, "counts depths, downwards.*EPSG:5715"):
            self.imported(self.made("depths.tif", "-a_srs", "EPSG:32632+5715"))
        grid = self.folder / "zero.asc"
        grid.write_bytes(b"ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2\n3 \0004\n")
        with self.assertRaisesRegex(UsageError, "zero.asc is no text, as it holds bytes of value 0"):
            self.imported(grid)
        with self.assertRaisesRegex(UsageError, "complex numbers"):
            self.imported(self.made("complex.tif", "-ot", "CFloat32"))

    def colours(self):
        (self.folder / "colours.txt").write_text("50 0 0 255\n60 255 0 0\n")
        return self.folder / "colours.txt"

    def test_systems_with_heights_keep_their_cells_and_number_along_the_map(self):
        for system, epsg, west, south in (("EPSG:2056+5728", 2056, 2600000, 1200000), ("EPSG:25832+7837", 25832, 500000, 5700000),
                                          ("EPSG:3812+5710", 3812, 650000, 670000), ("EPSG:7415", 28992, 155000, 463000)):
            told = self.imported(self.made("compound.tif", "-a_srs", system, "-co", "GEOTIFF_VERSION=1.1", "-a_ullr", west, south + 24,
                                           west + 24, south))
            self.assertIn(f"12 x 12 cells of 2 m, EPSG:{epsg}, west {west}.00 south {south}.00", told)
            self.assertRegex(told, "vertical system +1 of 1 raster: left out")
            self.assertNotIn("reprojected", told)
            self.assertEqual(site.heights_of(self.out / "ground.tif")[-1, 0], 50)
        bound = gdal.System('BOUNDCRS[SOURCECRS[PROJCRS["a ] b",ID["EPSG",31467]]],TARGETCRS[GEOGCRS["WGS 84",ID["EPSG",4326]]]]')
        self.assertEqual((bound.epsg, bound.name, bound.heights), (31467, "EPSG:31467", ""))

    def test_systems_of_esri_are_reprojected(self):
        told = self.imported(self.made("esri.tif", "-a_srs", "ESRI:102033"))
        self.assertRegex(told, "system +1 of 1 raster: reprojected from ESRI:102033 to EPSG:32")

    def test_degrees_become_metres_of_the_utm_zone_in_square_cells(self):
        degrees = self.folder / "degrees.tif"
        subprocess.run(["gdalwarp", "-q", "-s_srs", "EPSG:32632", "-t_srs", "EPSG:4326", self.folder / "ground.asc", degrees],
                       check=True)
        told = self.imported(degrees, "--cell", 1)
        self.assertIn("cells of 1 m, EPSG:32632", told)
        heights = site.heights_of(self.out / "ground.tif")
        # Two bilinear resamplings of a plane: off by no more than its rise over a cell of the first raster, 0.5 m.
        there = heights[heights == heights]
        self.assertGreater(there.size, 400)
        self.assertLess(abs(there.mean() - (50 + 0.375 * (CELLS - 1))), 0.5)

    def test_holes_are_counted_and_filled_from_round_them(self):
        holes = GRID.replace(f"{50 + 0.25 * 6 + 0.5 * 5} ", "-9999 ", 1)
        (self.folder / "holes.asc").write_text(holes)
        self.assertIn("1 of 144 cells have no height", self.imported(self.folder / "holes.asc", "--epsg", 32632))
        self.assertNotIn("no height", self.imported(self.folder / "holes.asc", "--epsg", 32632, "--fill"))

    def test_a_crop_beside_the_cells_is_resampled_and_told(self):
        arguments = [self.folder / "ground.asc", "--epsg", 32632, "--crop"]
        self.assertNotIn("resampled", self.imported(*arguments, 500004, 5500006, 500014, 5500012))
        self.assertIn("1 of 1 raster: resampled", self.imported(*arguments, 500005, 5500006, 500015, 5500012))

    def test_a_crop_keeps_its_part_and_one_beside_the_ground_is_refused(self):
        self.imported(self.folder / "ground.asc", "--epsg", 32632, "--crop", 500004, 5500006, 500014, 5500012)
        self.assertEqual(site.heights_of(self.out / "ground.tif").shape, (3, 5))
        with self.assertRaisesRegex(UsageError, "does --crop lie on it"):
            self.imported(self.folder / "ground.asc", "--epsg", 32632, "--crop", 0, 0, 10, 10)

    def test_a_raster_without_system_and_files_without_raster_are_refused(self):
        with self.assertRaisesRegex(UsageError, "names no coordinate system"):
            self.imported(self.folder / "ground.asc")
        with self.assertRaisesRegex(UsageError, "no raster of heights"):
            self.imported(self.folder / "houses.geojson")
        (self.folder / "text.txt").write_text("hello")
        with self.assertRaisesRegex(UsageError, "text.txt neither as a raster .* nor as polygons .ogrinfo failed"):
            self.imported(self.folder / "ground.asc", self.folder / "text.txt", "--epsg", 32632)


if __name__ == "__main__":
    unittest.main()
