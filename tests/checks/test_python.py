"""Python sources pass pyflakes: no name that is unknown, imported for nothing or defined twice."""

import tempfile
import unittest
from pathlib import Path

from sources import complaints, tracked

CHECK = ["/usr/bin/python3", "-m", "pyflakes"]


class Python(unittest.TestCase):
    def test_sources_pass(self):
        sources = tracked(".py")
        self.assertGreater(len(sources), 50)
        self.assertEqual(complaints(*CHECK, *sources), "")

    def test_a_fault_is_seen(self):
        with tempfile.TemporaryDirectory() as folder:
            source = Path(folder, "source.py")
            source.write_text("import os\nprint(unknown)\n")
            said = complaints(*CHECK, source)
            self.assertIn("'os' imported but unused", said)
            self.assertIn("undefined name 'unknown'", said)


if __name__ == "__main__":
    unittest.main()
