"""Scenes by short name: which file is meant, what is suggested, and the list of all."""

import contextlib
import io
import os
import re
import tempfile
import unittest
from pathlib import Path

from wade import scenes
from wade import UsageError
from wade.paths import CONFIGS, ROOT


class Found(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="wade-test-")
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(self.folder)

    def test_every_scene_is_found_by_its_short_name_with_and_without_its_ending(self):
        self.assertGreater(len(scenes.short_names()), 100)
        for short, file in scenes.short_names().items():
            self.assertEqual(scenes.find_scene(short), file)
            self.assertEqual(scenes.find_scene(f"{short}.json"), file)
            self.assertEqual(scenes.find_scene(str(file.relative_to(ROOT))), file)

    def test_a_bare_name_is_that_of_the_paper_or_the_only_one(self):
        self.assertEqual(scenes.find_scene(None), CONFIGS / "paper" / "s05.json")
        for name in ("s05", "s06", "village", "obstacle"):
            self.assertEqual(scenes.find_scene(name), CONFIGS / "paper" / f"{name}.json")
        self.assertEqual(scenes.find_scene("thin_sheet"), CONFIGS / "stability" / "thin_sheet.json")

    def test_a_bare_name_of_several_names_them(self):
        several = [short for short in scenes.short_names() if short.endswith("/dam_break")]
        self.assertGreater(len(several), 1)
        with self.assertRaises(UsageError) as refused:
            scenes.find_scene("dam_break")
        for short in several:
            self.assertIn(short, str(refused.exception))

    def test_a_file_from_here_comes_first_and_a_folder_is_none(self):
        Path("s05").mkdir()
        self.assertEqual(scenes.find_scene("s05"), CONFIGS / "paper" / "s05.json")
        for name in ("s06.json", "my scene.json", "Größe [neu] (x).json"):
            Path(name).write_text("{}")
            self.assertEqual(scenes.find_scene(name), Path(name))

    def test_unknown_names_come_with_the_nearest(self):
        for name, near in (("s6", "s06"), ("s5.json", "s05"), ("river/s5", "river/s05"), ("obstacel", "obstacle"),
                           (f"{CONFIGS}/paper/s5.json".removeprefix(f"{ROOT}/"), "paper/s05"), ("villag", "village")):
            with self.subTest(name), self.assertRaises(UsageError) as refused:
                scenes.find_scene(name)
            self.assertIn(f'"{name}"', str(refused.exception))
            self.assertRegex(str(refused.exception), rf"did you mean .*\b{near}\b")
        with self.assertRaises(UsageError) as refused:
            scenes.find_scene("xyzzy")
        self.assertNotIn("did you mean", str(refused.exception))


class Listed(unittest.TestCase):
    def of(self, *arguments):
        said = io.StringIO()
        with contextlib.redirect_stdout(said):
            self.assertEqual(scenes.main(list(arguments)), 0)
        return said.getvalue().splitlines()

    def test_each_scene_has_a_line_that_says_something(self):
        lines = self.of()
        self.assertEqual([line.split()[0] for line in lines], list(scenes.short_names()))
        for line in lines:
            self.assertLessEqual(len(line), 100)
            self.assertGreater(len(line.split()), 4, line)

    def test_words_choose(self):
        self.assertEqual([line.split()[0] for line in self.of("river/s05")], ["river/s05"])
        blocks = re.split(r"\n(?! )", "\n".join(self.of("MANNING", "--long")))  # a name, and its description indented
        self.assertGreater(len(blocks), 10)
        self.assertEqual([block for block in blocks if "manning" not in block.lower()], [])


if __name__ == "__main__":
    unittest.main()
