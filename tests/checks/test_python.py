"""Python sources pass pyflakes: no name that is unknown, imported for nothing or defined twice."""

import tempfile
import unittest
from pathlib import Path

from sources import ROOT, complaints, tracked

CHECK = ["/usr/bin/python3", "-m", "pyflakes"]


class Python(unittest.TestCase):
    def test_sources_pass(self):
        sources = tracked(".py")
        self.assertGreater(len(sources), 50)
        self.assertEqual(complaints(*CHECK, *sources), "")

    def test_lines_of_tools_fit(self):
        long = [f"{path}:{number}" for path in tracked(".py") if ROOT / "tools" in path.parents
                for number, line in enumerate(path.read_text().splitlines(), 1) if len(line) > 120]
        self.assertEqual(long, [])

    def test_a_fault_is_seen(self):
        with tempfile.TemporaryDirectory() as folder:
            source = Path(folder, "source.py")
            source.write_text("import os\nprint(unknown)\n")
            said = complaints(*CHECK, source)
            self.assertIn("'os' imported but unused", said)
            self.assertIn("undefined name 'unknown'", said)


if __name__ == "__main__":
    unittest.main()
