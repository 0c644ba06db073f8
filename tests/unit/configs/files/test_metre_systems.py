"""The table of projected systems in metres against the database of PROJ, where there is one."""

import pathlib
import re
import sys
import unittest

FILES = pathlib.Path(__file__).resolve().parents[4] / "configs" / "files"
sys.path.insert(0, str(FILES))

import write_metre_systems  # noqa: E402


def listed():
    text = (FILES / "metre_systems.inc").read_text(encoding="utf-8")
    version = re.search(r"EPSG (v[\d.]+)", text).group(1)
    runs = [(int(first), int(count)) for first, count in re.findall(r"\{(\d+), (\d+)\}", text)]
    return version, [number for first, count in runs for number in range(first, first + count)]


@unittest.skipUnless(write_metre_systems.DATABASE.exists(), "no database of PROJ")
class Table(unittest.TestCase):
    def test_the_table_is_that_of_the_database(self):
        version, numbers = write_metre_systems.metre_systems()
        table_version, table = listed()
        if version != table_version:
            self.skipTest(f"EPSG {version} here, {table_version} in the table")
        self.assertEqual(table, numbers)

    def test_no_number_of_the_table_is_another_kind_of_system_here(self):
        _, numbers = write_metre_systems.metre_systems()
        missing = set(listed()[1]) - set(numbers)
        self.assertLess(len(missing), 20, sorted(missing))  # EPSG deprecates, and PROJ drops, few


if __name__ == "__main__":
    unittest.main()
