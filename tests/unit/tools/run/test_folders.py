"""Folders of runs: their names, and the first writable location."""

import os
import tempfile
import unittest
from pathlib import Path
from unittest import mock

from wade import paths
from wade import UsageError
from wade.run import folders


class Names(unittest.TestCase):
    def test_a_folder_has_letters_and_no_character_that_a_shell_reads(self):
        for name, expected in (("paper_s05", "paper_s05"), ("my scene", "my_scene"), ("Größe [neu] (x)", "Größe_neu_x"),
                               ("../../etc/x", "etc_x"), ("", "scene"), ("...", "scene"), ("a\n\x1b$b", "a_b")):
            self.assertEqual(folders.file_name(name), expected)
        self.assertLessEqual(len(folders.file_name("n" * 500)), 80)


class Places(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="wade-test-")
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)
        for name in ("project", "here", "home", "tmp"):
            (self.folder / name).mkdir()
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(self.folder / "here")
        for patch in (mock.patch.object(folders, "RUNS", self.folder / "project" / "runs"),
                      mock.patch.dict(os.environ, {"HOME": str(self.folder / "home")}),
                      mock.patch.object(tempfile, "tempdir", str(self.folder / "tmp"))):
            patch.start()
            self.addCleanup(patch.stop)

    def block(self, *names):
        """Puts a file where a folder would have to be made, which stops root, too."""
        for name in names:
            (self.folder / name).write_text("")

    def test_the_first_place_that_can_be_written_is_taken(self):
        self.assertEqual(folders.runs_folder(), self.folder / "project" / "runs")
        (self.folder / "project" / "runs").rmdir()
        self.block("project/runs")
        self.assertEqual(folders.runs_folder(), self.folder / "here" / "runs")
        (self.folder / "here" / "runs").rmdir()
        self.block("here/runs")
        self.assertEqual(folders.runs_folder(), self.folder / "home" / "wade-runs")
        (self.folder / "home" / "wade-runs").rmdir()
        self.block("home/wade-runs")
        with self.assertRaisesRegex(UsageError, "--out"):
            folders.runs_folder()

    def test_who_has_no_home_has_a_folder_of_his_own(self):
        for home in ("/nonexistent", "relative", ""):
            with self.subTest(home), mock.patch.dict(os.environ, {"HOME": home}), \
                    mock.patch.object(paths.os.path, "expanduser", return_value=home or "~"):
                self.assertEqual(paths.home_folder(), self.folder / "tmp" / f"wade-{os.getuid()}")

    def test_two_runs_of_a_second_have_folders_of_their_own(self):
        first = folders.new_folder("s05")
        first.mkdir()
        self.assertNotEqual(folders.new_folder("s05"), first)


if __name__ == "__main__":
    unittest.main()
