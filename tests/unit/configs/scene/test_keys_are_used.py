"""Every member that a key fills is read by the programs: its name is used as a member outside the lists of keys."""

import re
import sys
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[4]
DECLARED = re.compile(r"f\.(?:number|whole|flag|text|choice|spread)\(\s*\"([^\"]+)\",\s*([A-Za-z_]\w*(?:(?:\.\w+)|\[\d\])*)")
READERS = ("fluid_server/**/*.?pp", "crowd_client/**/*.?pp", "configs/checks/*.cpp", "configs/scene/scene_[cf]*.?pp",
           "configs/loading/place_reader.cpp")
# Filled by the lists themselves into members that others declare, and words for people.
ELSEWHERE = {"time": "frame"}
FOR_PEOPLE = {"description"}


def declared():
    """(key, member) of every declaration, the member as in `crowd.navigation.rule`."""
    for file in sorted((ROOT / "configs/scene/fields").glob("*.cpp")):
        yield from DECLARED.findall(file.read_text(encoding="utf-8"))


class Keys(unittest.TestCase):
    def test_every_member_is_read_outside_the_lists(self):
        code = "\n".join(file.read_text(encoding="utf-8") for place in READERS for file in ROOT.glob(place))
        read = set(re.findall(r"(?:\.|->)(\w+)", code))
        found = list(declared())
        self.assertGreater(len(found), 100)
        for key, member in found:
            name = re.sub(r"\[\d\]", "", member).split(".")[-1]
            with self.subTest(key=key, member=member):
                self.assertTrue(name in FOR_PEOPLE or ELSEWHERE.get(name, name) in read)


if __name__ == "__main__":
    sys.exit(unittest.main())
