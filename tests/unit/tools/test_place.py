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
