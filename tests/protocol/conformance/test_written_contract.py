"""The suite's own table of the bytes and its hashes are those of docs/protocol.md."""

import re
import struct
import unittest
from pathlib import Path

from wade.conformance import layout

ROOT = Path(__file__).resolve().parents[3]
CONTRACT = (ROOT / "docs" / "protocol.md").read_text(encoding="utf-8")
ROW = re.compile(r"^\| (\d+) \| `(\w+)\.(\w+)` \| (\w+)", re.MULTILINE)
FORMS = {"u32": "I", "i32": "i", "u64": "Q", "f64": "d", "char": "s"}


def written(page):
    """{member: (offset, type)} of a table of the contract."""
    return {member: (int(offset), kind) for offset, owner, member, kind in ROW.findall(CONTRACT) if owner == page}


class Tables(unittest.TestCase):
    def test_header_words_are_those_of_the_contract(self):
        rows = written("Header")
        self.assertEqual(rows.pop("fields")[0], layout.FIELD_ENTRY[0])
        own = {name: (offset, form[-1]) for name, (offset, form) in layout.HEADER_WORDS.items()}
        self.assertEqual(own, {name: (offset, FORMS.get(kind, "?")) for name, (offset, kind) in rows.items()})

    def test_offsets_in_the_other_pages_are_those_of_the_contract(self):
        for page, own in (
            ("Control", layout.ControlPage), ("ConsumerEntry", layout.ConsumerPage),
            ("SlotDescriptor", layout.Descriptor),
        ):
            for member, (offset, _) in written(page).items():
                with self.subTest(member=f"{page}.{member}"):
                    self.assertEqual(getattr(own, member.upper()), offset)

    def test_tables_were_found(self):
        counts = {page: len(written(page)) for page in ("Header", "Control", "ConsumerEntry", "SlotDescriptor")}
        self.assertGreater(counts["Header"], 30, counts)
        for page, least in (("Control", 9), ("ConsumerEntry", 11), ("SlotDescriptor", 8)):
            self.assertGreaterEqual(counts[page], least, counts)


class Hashes(unittest.TestCase):
    def test_chain_is_the_one_of_the_contract(self):
        """Runs the Python of the contract's section on the hash chain."""
        try:
            import numpy as np
        except ImportError:
            self.skipTest("numpy is not there")
        listing = re.search(r"## Hash chain.*?```python\n(.*?)```", CONTRACT, re.DOTALL)[1]
        names = {}
        exec(listing, names)  # the project's own text
        previous = 0
        for frame, count in ((1, 1), (2, 5), (3, 1000)):
            fields = [struct.pack(f"{count}f", *(0.37 * k - 1.5 * f for k in range(count))) for f in range(7)]
            arrays = [np.frombuffer(field, dtype=np.float32) for field in fields]
            expected = names["chain"](previous, frame, arrays)
            previous = layout.chain(previous, frame, fields)
            self.assertEqual(previous, expected)

    def test_checksum_has_the_value_of_the_standard(self):
        """RFC 3720, appendix B.4."""
        self.assertEqual(layout.crc32c(bytes(32)), 0x8A9136AA)
        self.assertEqual(layout.crc32c(b"\xff" * 32), 0x62A8AB43)
        self.assertEqual(layout.crc32c(bytes(range(32))), 0x46DD794E)


if __name__ == "__main__":
    unittest.main()
