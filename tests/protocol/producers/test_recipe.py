"""The recipe "A producer" of CONTRIBUTING.md: its program is sound, and a crowd walks in its water."""

import json
import os
import secrets
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
PROGRAMS = Path(os.environ["WADE_PROGRAMS"])
SCENE = ROOT / "tests" / "system" / "scenes" / "small.json"


def done(*words, **options):
    """What a command says; AssertionError with that if it fails."""
    run = subprocess.run(list(map(str, words)), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                         check=False, **options)
    assert run.returncode == 0, f"{words}: {run.returncode}\n{run.stdout}"
    return run.stdout


class Recipe(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="wade-recipe-")
        cls.addClassCleanup(folder.cleanup)
        cls.folder = Path(folder.name)
        done(sys.executable, "-B", ROOT / "tests" / "recipes" / "apply_recipe.py", ROOT, "A producer", cls.folder,
             "my_water.cpp")
        cls.program = cls.folder / "my_water"
        done("g++", cls.folder / "my_water.cpp", "-o", cls.program, f"-I{ROOT / 'shm_protocol' / 'c_api'}",
             f"-L{PROGRAMS}", "-lwade_shm", f"-Wl,-rpath,{PROGRAMS}")

    def test_conforms_to_the_contract(self):
        """nobody_comes lasts as long as the library's attach time-out."""
        said = done(ROOT / "tools" / "conformance.sh", "--keep-going", "--skip=nobody_comes", f"--scene={SCENE}", "--",
                    self.program)
        self.assertIn("the channel: x 0 .. 20", " ".join(said.split()))

    def test_a_crowd_walks_in_its_water(self):
        session = f"recipe-{os.getpid()}-{secrets.token_hex(4)}"
        water = subprocess.Popen([self.program, "--session", session])
        try:
            done(PROGRAMS / "crowd_client", SCENE, "--session", session, "--until-s", "2", "--out", self.folder / "run")
            self.assertEqual(water.wait(60), 0)
        finally:
            water.kill()
            water.wait()
        outcome = json.loads((self.folder / "run" / "outcome.json").read_text())
        self.assertEqual((outcome["status"], outcome["frames"]), ("completed", 60))


if __name__ == "__main__":
    unittest.main()
