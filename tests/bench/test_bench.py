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
            # A ball of two spacings holds (4 pi / 3) 2^3 = 33 lattice points; the surface cuts some off.
            self.assertTrue(20 < found["pairs_per_particle"] < 34, found["pairs_per_particle"])
            self.assertTrue(10 < found["lanes_in_use_percent"] <= 100, found["lanes_in_use_percent"])
            done = subprocess.run([*command, "--only", "nothing"], capture_output=True, text=True)
            self.assertEqual(done.returncode, 2)

    def test_rvo2_is_measured_beside_the_crowd_by_a_program_from_outside(self):
        with tempfile.TemporaryDirectory() as folder:
            program = Path(folder, "stand-in")
            for text, code in (("read people goals rest; cat >/dev/null; echo 3 0.5 $people 7 $goals", 0), ("exit 3", 1)):
                program.write_text(f"#!/bin/sh\n{text}\n")
                program.chmod(0o755)
                done = subprocess.run([*module_command("wade.suites.bench"), "--quick", "--rvo2", program, "--json",
                                       f"{folder}/c.json"], capture_output=True, text=True)  # fmt: skip
                self.assertEqual(done.returncode, code, done.stderr)
                if code:
                    self.assertIn("tools/rvo2/crossing.cpp", done.stderr)
                    continue
                found = {each["name"]: each for each in json.loads(Path(folder, "c.json").read_text())["results"]}
                theirs = found["crowd/crossing RVO2 10 Hz"]
                self.assertEqual((theirs["median"], theirs["size"]), (0.1, 1000))  # 3 s of 30
                self.assertEqual((theirs["goals_per_agent_and_minute"], theirs["deepest_overlap_m"]), (2, 64))
                self.assertEqual(found["crowd/crossing human 30 Hz"]["overlapping_pair_steps"], 0)


if __name__ == "__main__":
    unittest.main()
