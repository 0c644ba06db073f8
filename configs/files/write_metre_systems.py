#!/usr/bin/env python3
"""Writes metre_systems.inc, the numbers of EPSG's projected systems with axes east and north in metres, from the database of PROJ.

Systems of the whole world (Mercator, cylindrical, Equal Earth) are left out, as their lengths change with latitude, and so are grids
that count zones.
"""

import contextlib
import pathlib
import sqlite3
import sys

DATABASE = pathlib.Path("/usr/share/proj/proj.db")
WORLD_METHODS = ("1024", "1028", "1029", "1078", "9823", "9824", "9834", "9835", "9842")
WORLD_MERCATOR = (3349, 3395, 3752, 3832)
METRE = ("EPSG", "9001")


def metre_systems(database=DATABASE):
    """Returns the version of EPSG's register and the sorted numbers."""
    axes = """select orientation, uom_auth_name, cast(uom_code as text) from axis
              where coordinate_system_auth_name = ? and coordinate_system_code = ?"""
    systems = """select p.code, p.coordinate_system_auth_name, p.coordinate_system_code, cast(v.method_code as text)
                 from projected_crs p join conversion v
                 on v.auth_name = p.conversion_auth_name and v.code = p.conversion_code where p.auth_name = 'EPSG'"""
    with contextlib.closing(sqlite3.connect(f"file:{database}?mode=ro", uri=True)) as connection:
        version = connection.execute("select value from metadata where key = 'EPSG.VERSION'").fetchone()[0]
        numbers = []
        for code, authority, of_axes, method in connection.execute(systems).fetchall():
            its_axes = connection.execute(axes, (authority, of_axes)).fetchall()
            plain = all(axis[1:] == METRE and axis[0] not in ("south", "west") for axis in its_axes)
            if plain and its_axes and method not in WORLD_METHODS and int(code) not in WORLD_MERCATOR:
                numbers.append(int(code))
    return version, sorted(numbers)


def runs_of(numbers):
    """Returns the runs of consecutive numbers as (first, count)."""
    runs = []
    for number in numbers:
        if runs and number == runs[-1][0] + runs[-1][1]:
            runs[-1] = (runs[-1][0], runs[-1][1] + 1)
        else:
            runs.append((number, 1))
    return runs


def text_of(version, numbers):
    """Returns the text of metre_systems.inc."""
    lines = [f"// Projected systems with axes east and north in metres, EPSG {version}, as {{first number, count}}.",
             "// Written by write_metre_systems.py."]
    line = ""
    for first, count in runs_of(numbers):
        word = f"{{{first}, {count}}},"
        if len(line) + 1 + len(word) > 118:
            lines.append(line)
            line = ""
        line += (" " if line else "") + word
    return "\n".join([*lines, line]) + "\n"


if __name__ == "__main__":
    pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).with_name("metre_systems.inc")).write_text(
        text_of(*metre_systems()), encoding="utf-8")
