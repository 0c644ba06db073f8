"""Builds that differ only in the commit that they name count as one program; resumed suites rely on it."""

import subprocess
import sys
import unittest
from pathlib import Path

from wade.reports.jobs import program_bytes

CLEAN, DIRTY, OTHER_CODE = (Path(name) for name in sys.argv[1:4])


class ProgramIdentity(unittest.TestCase):
    def test_each_names_its_commit(self):
        said = [subprocess.run([p], capture_output=True, text=True, check=True).stdout for p in (CLEAN, DIRTY)]
        self.assertEqual(said, ["at 0123456789ab\n", "at ba9876543210-dirty\n"])

    def test_the_commit_and_whether_it_is_dirty_change_nothing(self):
        self.assertNotEqual(CLEAN.read_bytes(), DIRTY.read_bytes())
        self.assertEqual(program_bytes(CLEAN), program_bytes(DIRTY))

    def test_other_code_does(self):
        self.assertNotEqual(program_bytes(CLEAN), program_bytes(OTHER_CODE))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
