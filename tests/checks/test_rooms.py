"""The rooms of the product: a door sign in each, no circle, a compiler that keeps the direction."""

import collections
import json
import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

from sources import ROOT, tracked

PRODUCT = ("configs", "shm_protocol", "fluid_server", "crowd_client")
VIEWER = Path("tools", "viewer")  # a program of the product that stands with the tools
CODE = (".cpp", ".hpp", ".h")  # of the product


def is_product(path: Path) -> bool:
    return path.parts[0] in PRODUCT or VIEWER in path.parents


def product() -> list[Path]:
    """Sources and headers of the product, relative to the root."""
    return [path for path in (path.relative_to(ROOT) for path in tracked(*CODE)) if is_product(path)]


def includes(path: Path) -> list[Path]:
    """What a file of the product includes of the project."""
    names = re.findall(r'^#include "([^"]+)"', (ROOT / path).read_text(), re.M)
    return [path for path in map(Path, names) if is_product(path)]


def circle(arrows: dict[Path, set[Path]]) -> list[Path]:
    """Nodes of a circle; empty if there is none."""
    done, way = set(), []

    def visit(node):
        if node in way:
            return way[way.index(node):]
        if node in done:
            return []
        way.append(node)
        for other in sorted(arrows.get(node, ())):
            found = visit(other)
            if found:
                return found
        way.pop()
        done.add(node)
        return []

    for start in sorted(arrows):
        found = visit(start)
        if found:
            return found
    return []


def arrows_between(name_of) -> dict[Path, set[Path]]:
    """Returns the include graph: each name maps to the names that it includes. name_of names a file."""
    arrows = collections.defaultdict(set)
    for path in product():
        for other in includes(path):
            if name_of(other) != name_of(path):
                arrows[name_of(path)].add(name_of(other))
    return arrows


def room_of(path: Path) -> Path:
    """The room of a file, with what lies below it; of files beside the rooms of a program, the header and its source."""
    return Path(*path.parts[:2]) if len(path.parts) > 2 else path.with_suffix("")


def flags_of(source: str) -> list[str]:
    """Where the compiler looks for headers when it compiles a source of the product."""
    database = json.loads(Path(os.environ["WADE_PROGRAMS"], "compile_commands.json").read_text())
    command = next(entry["command"] for entry in database if entry["file"] == str(ROOT / source))
    words = command.split()
    flags = [word for word in words if word.startswith("-I")]
    return flags + [text for word, after in zip(words, words[1:]) if word == "-isystem" for text in (word, after)]


def compiles(text: str, flags: list[str]) -> bool:
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder, "source.cpp")
        source.write_text(text)
        command = ["c++", "-std=c++20", "-fsyntax-only", *flags, str(source)]
        return subprocess.run(command, capture_output=True, check=False).returncode == 0


class Rooms(unittest.TestCase):
    def test_each_has_a_door_sign(self):
        folders = {path.parent for path in product()}
        self.assertGreater(len(folders), 20)
        self.assertEqual([folder for folder in sorted(folders) if not (ROOT / folder / "README.md").is_file()], [])

    def test_no_circle_of_rooms(self):
        self.assertEqual(circle(arrows_between(room_of)), [])

    def test_no_circle_of_headers_with_their_sources(self):
        self.assertEqual(circle(arrows_between(lambda path: path.with_suffix(""))), [])

    def test_a_circle_is_seen(self):
        a, b, c = Path("a"), Path("b"), Path("c")
        self.assertEqual(circle({a: {b}, b: {c}, c: {b}}), [b, c])

    def test_programs_do_not_know_one_another(self):
        whole = arrows_between(lambda path: Path(path.parts[0]))
        self.assertNotIn(Path("crowd_client"), whole[Path("fluid_server")])
        self.assertNotIn(Path("fluid_server"), whole[Path("crowd_client")])
        self.assertEqual(whole[Path("shm_protocol")], set())
        self.assertEqual(whole[Path("configs")], set())

    def test_the_compiler_keeps_the_direction(self):
        flags = flags_of("crowd_client/markers/markers.cpp")
        self.assertTrue(compiles('#include "crowd_client/equations.hpp"\n', flags))
        self.assertFalse(compiles('#include "crowd_client/agents.hpp"\n', flags))
        self.assertFalse(compiles('#include "fluid_server/fluid_model.hpp"\n', flags))


class Bits(unittest.TestCase):
    def test_no_function_of_the_c_library_is_called_that_differs_between_processors(self):
        unequal = re.compile(r"\b(cbrt|erfc?|exp2|hypot|lgamma|tgamma)f?\(")
        own = Path("configs", "numbers", "portable.cpp")
        calls = [f"{path}:{number}: {line.strip()}" for path in product() if path != own and path.parts[0] in PRODUCT
                 for number, line in enumerate((ROOT / path).read_text().splitlines(), 1)
                 if unequal.search(line.partition("//")[0])]
        self.assertEqual(calls, [], "configs/numbers/portable.hpp says which ones")


if __name__ == "__main__":
    unittest.main()
