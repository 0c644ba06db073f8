"""The keys of scenes: shipped files keep the schema that they name, and what a key fills is read."""

import json
import re
import sys
import unittest
from pathlib import Path

import jsonschema

ROOT = Path(__file__).resolve().parents[4]
CONFIGS = ROOT / "configs"
SCHEMA = json.loads((CONFIGS / "scene.schema.json").read_text(encoding="utf-8"))
VALIDATOR = jsonschema.Draft202012Validator(SCHEMA)

DECLARED = re.compile(r"f\.(?:number|whole|flag|text|choice|spread)\(\s*\"([^\"]+)\",\s*([A-Za-z_]\w*(?:(?:\.\w+)|\[\d\])*)")
READERS = ("fluid_server/**/*.?pp", "crowd_client/**/*.?pp", "configs/checks/*.cpp", "configs/scene/scene_[cf]*.?pp",
           "configs/loading/site_reader.cpp")
# Filled by the lists themselves into members that others declare, and words for people.
ELSEWHERE = {"time": "frame"}
FOR_PEOPLE = {"description"}


def parsed(text):
    """JSON with comments on lines of their own."""
    return json.loads(re.sub(r"^\s*//.*$", "", text, flags=re.M))


def declared():
    """(key, member) of every declaration, the member as in `crowd.navigation.rule`."""
    for file in sorted((ROOT / "configs/scene/fields").glob("*.cpp")):
        yield from DECLARED.findall(file.read_text(encoding="utf-8"))


class Schema(unittest.TestCase):
    def test_it_is_a_schema(self):
        jsonschema.Draft202012Validator.check_schema(SCHEMA)

    def test_shipped_scenes_keep_it(self):
        scenes = sorted(CONFIGS.glob("*/*.json"))
        self.assertGreater(len(scenes), 100)
        for scene in scenes:
            with self.subTest(scene=scene.relative_to(CONFIGS)):
                errors = [error.message for error in VALIDATOR.iter_errors(parsed(scene.read_text(encoding="utf-8")))]
                self.assertEqual(errors, [])

    def test_only_a_scene_that_extends_another_may_leave_out_its_channel(self):
        self.assertTrue(VALIDATOR.is_valid({"extends": "other.json", "channel": {"depth_m": 1}}))
        self.assertFalse(VALIDATOR.is_valid({"seed": 1}))
        self.assertFalse(VALIDATOR.is_valid({"channel": {"depth_m": 1}}))
        self.assertTrue(VALIDATOR.is_valid({"site": {"ground": {"file": "ground.asc"}}}))
        self.assertFalse(VALIDATOR.is_valid({"extends": "other.json", "no_such_key": 1}))


class Keys(unittest.TestCase):
    def test_every_member_is_read_outside_the_lists(self):
        code = "\n".join(file.read_text(encoding="utf-8") for place in READERS for file in ROOT.glob(place))
        read = set(re.findall(r"(?:\.|->)(\w+)", code))
        found = list(declared())
        self.assertGreater(len(found), 100)
        for key, member in found:
            name = re.sub(r"\[\d\]", "", member).split(".")[-1]
            with self.subTest(key=key, member=member):
                self.assertTrue(name in FOR_PEOPLE or ELSEWHERE.get(name, name) in read)


if __name__ == "__main__":
    sys.exit(unittest.main())
