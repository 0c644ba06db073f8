"""Columns of depth-averaged water: Python and Node make of each grid of columns.txt what the table says, as C does."""

import csv
import json
import os
import secrets
import subprocess
import sys
import unittest
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[2]
sys.path[:0] = map(str, (ROOT / "tools" / "producers" / "python", ROOT / "tests" / "system"))
from columns import Grid  # noqa: E402
from harness import SystemTest  # noqa: E402
from shared_memory_stream import SharedMemoryStream, StreamError  # noqa: E402


def cases():
    """Of the table: title, grid, cells, and what is expected: the words of a refusal or (stream, particles)."""
    lines = [line for line in (HERE / "columns.txt").read_text().splitlines() if line and line[0] != "#"]
    found = []
    for line in lines:
        word, rest = line.split(" ", 1)
        if word == "case":
            found.append({"title": rest, "cells": [], "particles": []})
        elif word == "refused":
            found[-1]["refused"] = rest
        else:
            numbers = list(map(float, rest.split()))
            if word in ("cell", "particle"):
                found[-1][word + "s"].append(numbers)
            else:
                found[-1][word] = numbers
    return found


CASES = cases()


class Columns(unittest.TestCase):
    def check(self, case, stream, particles):
        *expected, count = case["columns"]
        self.assertEqual([*stream], expected)
        self.assertEqual(len(particles), count)
        self.assertEqual(particles, case["particles"])

    def test_numpy_makes_the_columns_of_the_table(self):
        for case in CASES:
            with self.subTest(case["title"]):
                try:
                    *sizes, nx, nz = case["grid"]
                    grid = Grid(*sizes, int(nx), int(nz))
                    arrays = [np.zeros(max(1, grid.capacity), np.float32) for _ in range(7)]
                    count = grid.fill(arrays, *np.array(case["cells"]).T)
                except StreamError as error:
                    self.assertIn(case.get("refused", "nothing"), str(error))
                    self.assertEqual(error.code, 2)
                    continue
                particles = np.array(arrays)[:, :count].T.tolist()
                self.check(case, (*grid.column_width, grid.capacity), particles)

    @unittest.skipUnless("node" in os.environ.get("WADE_PRODUCERS", "node"), "the addon for Node is not built")
    def test_node_makes_the_columns_of_the_table(self):
        grids = []
        for case in CASES:
            cells = map(list, zip(*([*map(repr, cell)] for cell in case["cells"])))
            grid = dict(zip(("xMin", "zMin", "cellX", "cellZ", "nx", "nz"), map(repr, case["grid"])))
            grids.append(grid | dict(zip(("depth", "u", "v", "bed"), cells)))
        text = json.dumps(grids).replace('"inf"', '"Infinity"')
        session = f"columns-{os.getpid()}-{secrets.token_hex(4)}"
        words = [os.environ["WADE_NODE"], HERE / "columns.mjs", os.environ["WADE_NODE_ADDON"], session]
        done = subprocess.run(words, input=text, capture_output=True, text=True, check=True)
        for case, answer in zip(CASES, json.loads(done.stdout), strict=True):
            with self.subTest(case["title"]):
                if "refused" in case:
                    self.assertIn(case["refused"], answer["refused"])
                    self.assertEqual(answer["exitCode"], 2)
                    continue
                self.check(case, answer["stream"], answer["particles"])
                self.assertIn("an argument is NULL", answer["late"])

    def test_cells_may_have_any_width(self):
        """Sizes that are computed stay whole; all columns together have the area of the grid."""
        for cell, parts in ((0.25, 1), (0.1 * 20, 1), (20 / 9.999999999999, 1), (2.001, 2), (5, 3), (100, 50)):
            grid = Grid(0, 0, cell, cell, 3, 2)
            self.assertEqual(grid.parts, [parts, parts], cell)
            self.assertAlmostEqual(grid.capacity * grid.column_width[0] * grid.column_width[1], 6 * cell * cell, 6)
            self.assertLessEqual(max(grid.column_width), 2)

    def test_a_stream_refuses_columns_wider_than_2_m(self):
        for width in ((2.5, 2.5), (1, 0), (-1, 1), (float("nan"), 1)):
            with self.assertRaisesRegex(StreamError, "column_width .* at most 2 m"):
                SharedMemoryStream("any", 1, "wide", column_width=width)


def about_points(run):
    return [text for text in run.outcome()["warnings"] if "points" in text]


class Crowd(SystemTest):
    """People of `measured` in the stream of producer_columns.py, 10 s."""

    def walk(self, *options):
        """The run of the crowd."""
        scene = ROOT / "configs" / "paper" / "s05.json"
        producer = self.start("/usr/bin/python3", "-B", ROOT / "tools" / "producers" / "python" / "producer_columns.py",
                              "--session", self.session, "--frames", 300, *options)
        client = self.client("--until-s", 10, "--set", '/crowd/response="measured"', scene=scene)
        self.assert_ended_well(client, producer)
        return client.run

    def test_people_are_the_same_in_columns_of_any_width_and_warned_of_points(self):
        """Which are whole in the channel; the sums over other cells differ by rounding, 1e-14 m."""
        ends = {}
        for cell in ("0.25", "0.5", "1", "3"):
            run = self.walk("--cell-m", cell)
            people = list(csv.DictReader(run.bytes_of("agents.csv").decode().splitlines()))
            ends[cell] = [(float(person["x_m"]), float(person["z_m"])) for person in people]
            self.assertEqual(about_points(run), [])
            self.assertGreater(run.outcome()["states"]["carried"], 10)
        for cell, places in ends.items():
            with self.subTest(cell=cell):
                np.testing.assert_allclose(places, ends["1"], atol=1e-9)
        warnings = about_points(self.walk("--cell-m", "1", "--points"))
        self.assertEqual(len(warnings), 1)
        self.assertIn("points lie 1 m apart", warnings[0])


if __name__ == "__main__":
    unittest.main()
