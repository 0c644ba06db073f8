"""Files that appear whole or not at all, and what is published of a report."""

import resource
import tempfile
import unittest
from pathlib import Path
from unittest import mock

from wade.reports import files


class Whole(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="wade-test-")
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)
        (self.folder / "a.csv").write_text("older")

    def there(self):
        return {file.name: file.read_text() for file in self.folder.iterdir()}

    def test_an_interrupt_leaves_no_file_of_a_folder_and_the_older_ones(self):
        with self.assertRaises(KeyboardInterrupt), files.whole_folder(self.folder) as part:
            (part / "a.csv").write_text("half")
            (part / "b.csv").write_text("whole")
            raise KeyboardInterrupt
        self.assertEqual(self.there(), {"a.csv": "older"})
        with files.whole_folder(self.folder) as part:
            (part / "a.csv").write_text("whole")
        self.assertEqual(self.there(), {"a.csv": "whole"})

    def test_a_full_disk_leaves_the_older_file(self):
        limits = resource.getrlimit(resource.RLIMIT_FSIZE)
        self.addCleanup(resource.setrlimit, resource.RLIMIT_FSIZE, limits)
        resource.setrlimit(resource.RLIMIT_FSIZE, (10, limits[1]))
        with self.assertRaises(OSError):
            files.write_whole(self.folder / "a.csv", "more than ten bytes")
        self.assertEqual(self.there(), {"a.csv": "older"})


class Publishing(unittest.TestCase):
    def test_only_the_report_its_table_and_the_pictures_that_it_shows(self):
        with tempfile.TemporaryDirectory() as folder:
            out, home = Path(folder) / "out", Path(folder) / "docs" / "suite"
            for name in ("report.md", "t.csv", "figures/a.png", "b.png", "runs/c.json"):
                files.write_whole(out / name, "![a](figures/a.png)" if name == "report.md" else name)
            files.write_whole(home / "old.png", "old")
            files.write_whole(home / "read.png", "old")
            files.write_whole(home / "README.md", "how to read it: ![b](read.png)")
            with mock.patch.object(files, "PUBLISHED", home.parent), mock.patch.object(files, "ROOT", Path(folder)):
                files.publish(out, "suite", "t.csv")
            there = sorted(str(file.relative_to(home)) for file in home.rglob("*") if file.is_file())
            self.assertEqual(there, ["README.md", "figures/a.png", "read.png", "report.md", "t.csv"])


if __name__ == "__main__":
    unittest.main()
