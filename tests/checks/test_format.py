"""C and C++ sources have the format of .clang-format."""

import tempfile
import unittest
from pathlib import Path

from sources import ROOT, complaints, tracked

CHECK = ["clang-format", "--dry-run", "--Werror", f"--style=file:{ROOT / '.clang-format'}"]


class Format(unittest.TestCase):
    def test_sources_have_the_format(self):
        sources = tracked(".cpp", ".hpp", ".c", ".h")
        self.assertGreater(len(sources), 300)
        self.assertEqual(complaints(*CHECK, *sources), "")

    def test_another_format_is_seen(self):
        with tempfile.TemporaryDirectory() as folder:
            source = Path(folder, "source.cpp")
            source.write_text("int  main( ) {return 0;}\n")
            self.assertIn("source.cpp", complaints(*CHECK, source))


if __name__ == "__main__":
    unittest.main()
