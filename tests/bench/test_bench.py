"""A look at each program of the benchmarks. No times are judged."""

import json
import subprocess
import tempfile
import unittest
from pathlib import Path

from wade.paths import BUILD, module_command

FIELDS = {"name", "size", "threads", "median", "min", "max", "unit"}


class Programs(unittest.TestCase):
    def refused(self, program, *arguments):
        done = subprocess.run([BUILD / "tests" / "bench" / program, *arguments], capture_output=True, text=True)
        self.assertEqual(done.returncode, 2)
        return done.stderr

    def test_mistakes_in_options_are_refused(self):
        self.assertIn("--fast; allowed: --quick", self.refused("bench_fluid", "--fast"))
        self.assertIn("--threads 0, allowed: 1 to 1024", self.refused("bench_coupling", "--threads", "0"))

    def test_a_kernel_is_measured_and_reported_with_its_page(self):
        with tempfile.TemporaryDirectory() as folder:
            command = [*module_command("wade.suites.bench"), "--quick"]
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
                self.assertIn(only, Path(folder, "page", "report.md").read_text())
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
