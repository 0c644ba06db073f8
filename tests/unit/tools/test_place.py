"""tools/wade place import, where GDAL's programs are installed: what it writes is what went in, in metres."""

import contextlib
import io
import json
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

from wade import UsageError, place
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
        found = place.shutil.which
        self.addCleanup(setattr, place.shutil, "which", found)
        place.shutil.which = lambda _: None
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "a.asc").write_text(GRID)
            with self.assertRaisesRegex(UsageError, "apt-get install gdal-bin"):
                place.main(["import", str(Path(folder) / "a.asc"), "--out", str(Path(folder) / "out")])

    def test_the_scene_has_frames_often_enough_for_people(self):
        rate = re.search(r'"frame_rate_hz": ([0-9.]+)', place.scene_text("village", True, 1))
        self.assertGreaterEqual(float(rate[1]), 2)  # below, both programs warn

    def test_another_word_than_import_is_refused(self):
        with contextlib.redirect_stderr(io.StringIO()) as told:
            self.assertEqual(place.main(["export"]), 2)
        self.assertIn("allowed: import", told.getvalue())


class Maps(unittest.TestCase):
    def test_the_bar_has_a_round_length(self):
        from wade.pictures import place_maps

        self.assertEqual([place_maps.round_length(x) for x in (0.7, 9.9, 49.9, 50, 1234)], [0.5, 5, 20, 50, 1000])

    def test_a_house_with_a_hole_is_drawn_by_its_outer_ring(self):
        from wade.pictures import top_view

        square, hole = [[0, 0], [9, 0], [9, 9], [0, 0]], [[1, 1], [2, 1], [2, 2], [1, 1]]
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "houses.geojson"
            file.write_text(json.dumps({"type": "MultiPolygon", "coordinates": [[square, hole], [square]]}))
            scene = {"place": {"origin_easting_m": 5, "houses": [{"polygon": [[1, 2], [3, 4], [5, 6]]}, {"file": str(file)}]}}
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
            self.assertEqual(place.main(["import", *map(str, arguments), "--out", str(self.out)]), 0)
        return told.getvalue()

    def test_a_grid_in_the_system_that_is_asked_for_keeps_its_heights(self):
        told = self.imported(self.folder / "ground.asc", self.folder / "houses.geojson", "--epsg", 32632)
        self.assertIn("12 x 12 cells of 2 m, EPSG:32632, west 500000.00 south 5500000.00", told)
        heights = place.heights_of(self.out / "ground.tif")
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
        subprocess.run(["gdal_translate", "-q", "-a_srs", "EPSG:32632", *map(str, words), self.folder / "ground.asc", made], check=True)
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
            self.assertAlmostEqual(place.heights_of(self.out / "ground.tif")[-1, -1], height, places=4)
        feet = self.made("feet.tif", "-a_srs", "EPSG:2263", "-a_ullr", 980000, 190024, 980024, 190000)
        with self.assertRaisesRegex(UsageError, "US survey foot along the map and does not say.*--heights-in"):
            self.imported(feet)
        told = self.imported(feet, "--heights-in", "us-ft")
        self.assertRegex(told, "reprojected from EPSG:2263(.|\n)*heights in us-ft times 0.3048006096")
        heights = place.heights_of(self.out / "ground.tif")
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
        heights = place.heights_of(self.out / "ground.tif")
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

    def test_degrees_become_metres_of_the_utm_zone_in_square_cells(self):
        degrees = self.folder / "degrees.tif"
        subprocess.run(["gdalwarp", "-q", "-s_srs", "EPSG:32632", "-t_srs", "EPSG:4326", self.folder / "ground.asc", degrees],
                       check=True)
        told = self.imported(degrees, "--cell", 1)
        self.assertIn("cells of 1 m, EPSG:32632", told)
        heights = place.heights_of(self.out / "ground.tif")
        # Two bilinear resamplings of a plane: off by no more than its rise over a cell of the first raster, 0.5 m.
        there = heights[heights == heights]
        self.assertGreater(there.size, 400)
        self.assertLess(abs(there.mean() - (50 + 0.375 * (CELLS - 1))), 0.5)

    def test_holes_are_counted_and_filled_from_round_them(self):
        holes = GRID.replace(f"{50 + 0.25 * 6 + 0.5 * 5} ", "-9999 ", 1)
        (self.folder / "holes.asc").write_text(holes)
        self.assertIn("1 of 144 cells have no height", self.imported(self.folder / "holes.asc", "--epsg", 32632))
        self.assertNotIn("no height", self.imported(self.folder / "holes.asc", "--epsg", 32632, "--fill"))

    def test_a_crop_keeps_its_part_and_one_beside_the_ground_is_refused(self):
        self.imported(self.folder / "ground.asc", "--epsg", 32632, "--crop", 500004, 5500006, 500014, 5500012)
        self.assertEqual(place.heights_of(self.out / "ground.tif").shape, (3, 5))
        with self.assertRaisesRegex(UsageError, "does --crop lie on it"):
            self.imported(self.folder / "ground.asc", "--epsg", 32632, "--crop", 0, 0, 10, 10)

    def test_a_raster_without_system_and_files_without_raster_are_refused(self):
        with self.assertRaisesRegex(UsageError, "names no coordinate system"):
            self.imported(self.folder / "ground.asc")
        with self.assertRaisesRegex(UsageError, "no raster of heights"):
            self.imported(self.folder / "houses.geojson")
        (self.folder / "text.txt").write_text("hello")
        with self.assertRaisesRegex(UsageError, "ogrinfo failed"):
            self.imported(self.folder / "ground.asc", self.folder / "text.txt", "--epsg", 32632)


if __name__ == "__main__":
    unittest.main()
