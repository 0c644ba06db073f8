"""Holds the numbers of documents against runs of shipped scenes.

A document states them once more in a comment behind the text, <!-- measured: SCENE {"what": number, ...} -->; what is an outcome
or a state of agents.csv. Each number also stands in the paragraph above. The scene runs once, as a reader would run it.
"""

import csv
import json
import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
STATED = re.compile(r"<!-- measured: (\S+) (\{.*?\}) -->")


def stated():
    """(document, scene, numbers, text before the comment) of all comments."""
    for file in [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]:
        text = file.read_text(encoding="utf-8")
        for found in STATED.finditer(text):
            yield file.name, found[1], json.loads(found[2]), text[: found.start()].rstrip().rsplit("\n\n", 1)[-1]


def counts_of(scene):
    """{outcome or state: people} of a run of the scene."""
    with tempfile.TemporaryDirectory() as folder:
        words = [ROOT / "tools" / "wade", "run", scene, "--out", Path(folder) / "run", "--no-trajectories", "--water-every-s", "0",
                 "--attach-timeout-s", "300", "--step-timeout-s", "300"]
        environment = {**os.environ, "WADE_BUILD": os.environ.get("WADE_PROGRAMS", "")}
        answer = subprocess.run(words, capture_output=True, text=True, check=False, env=environment)
        if answer.returncode:
            raise AssertionError(f"{scene}: {answer.stderr[-2000:]}")
        counts = {}
        with open(Path(folder) / "run" / "agents.csv", encoding="utf-8", newline="") as table:
            for row in csv.DictReader(table):
                for what in {row["outcome"], row["state"]}:
                    counts[what] = counts.get(what, 0) + 1
        return counts


class Numbers(unittest.TestCase):
    def test_of_shipped_scenes_are_those_of_a_run(self):
        found = list(stated())
        self.assertTrue(found, "no document states a number of a scene")
        runs = {scene: counts_of(scene) for scene in {scene for _, scene, _, _ in found}}
        for document, scene, numbers, text in found:
            for what, number in numbers.items():
                with self.subTest(document=document, scene=scene, what=what):
                    self.assertEqual(runs[scene].get(what, 0), number)
                    self.assertRegex(text, rf"\b{number}\b", "the text says another number")


if __name__ == "__main__":
    unittest.main()
