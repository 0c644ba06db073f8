"""What is published of a report."""

import tempfile
import unittest
from pathlib import Path
from unittest import mock

from wade.reports import files


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
