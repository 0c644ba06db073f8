"""Shell scripts pass shellcheck."""

import tempfile
import unittest
from pathlib import Path

from sources import ROOT, complaints, git, tracked


def scripts() -> list[Path]:
    """Returns files named *.sh or *.bash, and executable files with a shell in their first line."""
    found = set(tracked(".sh", ".bash"))
    for line in git("ls-files", "--stage"):
        path = ROOT / line.split("\t")[1]
        if line.startswith("100755") and path.is_file():
            with path.open("rb") as file:
                first = file.readline()
            if first.startswith(b"#!") and first.rstrip().endswith((b"bash", b"/sh")):
                found.add(path)
    return sorted(found)


class Shell(unittest.TestCase):
    def test_scripts_pass(self):
        found = scripts()
        self.assertIn(ROOT / ".ci" / "run", found)
        self.assertEqual(complaints("shellcheck", "--external-sources", *found), "")

    def test_a_fault_is_seen(self):
        with tempfile.TemporaryDirectory() as folder:
            script = Path(folder, "script.sh")
            script.write_text("#!/bin/sh\nrm $1\n")
            self.assertIn("SC2086", complaints("shellcheck", script))


if __name__ == "__main__":
    unittest.main()
