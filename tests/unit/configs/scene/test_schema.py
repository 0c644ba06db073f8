"""The scene files as an editor sees them: each, as it stands, keeps the schema that it names."""

import json
import re
import sys
import unittest
from pathlib import Path

import jsonschema

CONFIGS = Path(__file__).resolve().parents[4] / "configs"
SCHEMA = json.loads((CONFIGS / "scene.schema.json").read_text(encoding="utf-8"))
VALIDATOR = jsonschema.Draft202012Validator(SCHEMA)


def parsed(text):
    """JSON with comments on lines of their own."""
    return json.loads(re.sub(r"^\s*//.*$", "", text, flags=re.M))


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
        self.assertTrue(VALIDATOR.is_valid({"place": {"ground": {"file": "ground.asc"}}}))
        self.assertFalse(VALIDATOR.is_valid({"extends": "other.json", "no_such_key": 1}))


if __name__ == "__main__":
    sys.exit(unittest.main())
