"""The tools that merge, compare and report benchmarks, with made-up figures, and a look at each program. No times are judged."""

import json
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools" / "bench"))

import features  # noqa: E402
import kernels  # noqa: E402
import results  # noqa: E402
from machine import machine, machine_text  # noqa: E402

PROGRAMS = Path(os.environ.get("WADE_PROGRAMS", ROOT / "build" / "release"))
FIELDS = {"name", "size", "threads", "median", "min", "max", "unit"}


def result(median, unit="particle_steps_per_s", name="fluid/river", threads=1, **extra):
    return {"name": name, "size": 10, "threads": threads, "median": median, "min": median, "max": median, "unit": unit, **extra}


class Comparison(unittest.TestCase):
    def test_a_rate_that_doubles_and_a_time_that_halves_are_twice_as_fast(self):
        self.assertEqual(results.speed_up(result(1), result(2)), 2)
        self.assertEqual(results.speed_up(result(2, "us"), result(1, "us")), 2)
        self.assertIsNone(results.speed_up(result(0), result(1)))

    def test_only_what_both_have_is_compared_and_the_error_stands_beside(self):
        before = [result(100, mean_density_error_percent=0.04), result(7, threads=2), result(1, name="gone")]
        lines = results.comparison(before, [result(150, mean_density_error_percent=0.05), result(1, name="new")])
        self.assertEqual(len(lines), 3)
        self.assertIn("1.500", lines[1])
        self.assertIn("0.04 -> 0.05", lines[1])
        self.assertIn("fluid/river, gone", lines[2])


class Files(unittest.TestCase):
    def test_results_are_written_whole_and_read_again(self):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "new" / "bench.json"
            results.write(file, {"model": "m"}, [result(3)])
            self.assertEqual(results.read(file), {"machine": {"model": "m"}, "results": [result(3)]})
            self.assertEqual([p.name for p in file.parent.iterdir()], ["bench.json"])

    def test_the_machine_has_a_line(self):
        self.assertIn("processors", machine_text(machine()))

    def test_repetitions_of_a_kernel_become_a_median(self):
        runs = [
            {"name": "kernels/sort/100", "run_name": "kernels/sort/100", "run_type": kind, "threads": 1,
             "ns_per_item": value, "cpu_time": 1}  # fmt: skip
            for kind, value in (("iteration", 9.0), ("iteration", 5.0), ("iteration", 6.0), ("aggregate", 99.0))
        ]
        (found,) = kernels.results_of({"benchmarks": runs})
        self.assertEqual((found["name"], found["size"], found["unit"]), ("kernels/sort", 100, "ns_per_particle"))
        self.assertEqual((found["median"], found["min"], found["max"]), (6.0, 5.0, 9.0))

    def test_the_interval_of_nine_pairs_leaves_out_the_outermost(self):
        self.assertEqual(features.interval_of_median([9, 1, 8, 2, 7, 3, 6, 4, 5]), (5, 2, 8))
        self.assertEqual(features.interval_of_median([3, 1, 2]), (2, 1, 3))


class Programs(unittest.TestCase):
    def refused(self, program, *arguments):
        done = subprocess.run([PROGRAMS / "tests" / "bench" / program, *arguments], capture_output=True, text=True)
        self.assertEqual(done.returncode, 2)
        return done.stderr

    def test_mistakes_in_options_are_refused(self):
        self.assertIn("--fast; allowed: --quick", self.refused("bench_fluid", "--fast"))
        self.assertIn("--threads 0, allowed: 1 to 1024", self.refused("bench_coupling", "--threads", "0"))

    def test_a_kernel_is_measured_and_reported_with_its_page(self):
        with tempfile.TemporaryDirectory() as folder:
            command = ["/usr/bin/python3", ROOT / "tools" / "bench" / "bench.py", "--programs", PROGRAMS, "--quick"]
            for only, threads in (("machine/fma_peak", [1, 2]), ("kernels/contacts", [1])):
                done = subprocess.run([*command, "--only", only, "--json", f"{folder}/a.json", "--out", f"{folder}/page"],
                                      capture_output=True, text=True)  # fmt: skip
                self.assertEqual(done.returncode, 0, done.stderr)
                measured = json.loads(Path(folder, "a.json").read_text())["results"]
                self.assertEqual([found["threads"] for found in measured], threads)
                for found in measured:
                    self.assertLessEqual(FIELDS, set(found))
                    self.assertEqual(found["name"], only)
                    self.assertLessEqual(found["min"], found["median"])
                self.assertIn(only, Path(folder, "page", "bench.md").read_text())
            done = subprocess.run([*command, "--only", "kernels/pressure_sweep", "--json", f"{folder}/b.json"],
                                  capture_output=True, text=True)  # fmt: skip
            self.assertEqual(done.returncode, 0, done.stderr)
            found = json.loads(Path(folder, "b.json").read_text())["results"][0]
            # A ball of two spacings holds (4 pi / 3) 2^3 = 33 places of a lattice; the surface cuts some off.
            self.assertTrue(20 < found["pairs_per_particle"] < 34, found["pairs_per_particle"])
            self.assertTrue(10 < found["lanes_in_use_percent"] <= 100, found["lanes_in_use_percent"])
            done = subprocess.run([*command, "--only", "nothing"], capture_output=True, text=True)
            self.assertEqual(done.returncode, 2)


if __name__ == "__main__":
    unittest.main()
