"""The suite accepts a sound header and refuses each word that is out of its range, by name."""

import struct
import unittest
from argparse import Namespace

from python_producer import Publisher

from wade.conformance.expectation import Violation
from wade.conformance.layout import header_crc
from wade.conformance.header_rules import read_header
from wade.conformance.layout import HEADER_WORDS

OPTIONS = Namespace(session="none", kind="fluid", particles=50, depth=2)
WRONG = {
    "magic": (1,), "version_major": (0, 2), "endian_tag": (0x04030201,), "header_bytes": (0, 8192),
    "required_features": (1,), "total_bytes": (0, 2**63), "session_id": (0,), "stream_kind": (0, 2, 3),
    "coupling_lag": (2,), "capacity": (0, 2**32, 2**63), "slot_count": (0, 65), "depth": (0, 4),
    "ticks_per_second": (0,), "ticks_per_frame": (0,), "metres_per_unit": (0.0, -1.0, float("inf"), float("nan")),
    "field_count": (0, 17), "particle_radius": (-1.0, float("nan")), "rest_density": (-1.0, float("inf")),
    "consumer_stride": (0, 64), "consumer_count": (0, 15), "descriptor_stride": (64,), "slot_stride": (100,),
    "producer_name": (b"x" * 64,),
}
# Words that are wrong together with others, so that the message names the region.
MISPLACED = {
    "control_offset": (0, 4095, 8192, 2**63), "doorbell_offset": (4096, 2**64 - 4096), "consumers_offset": (8192, 4097),
    "descriptors_offset": (12288,), "slots_offset": (77824, 4096, 2**63), "slot_stride": (0, 2**40),
}


class HeaderRules(unittest.TestCase):
    def setUp(self):
        publisher = Publisher.__new__(Publisher)  # its pages without its object
        publisher.plan(OPTIONS)
        self.page, self.file_bytes = publisher.header(), publisher.total_bytes

    def changed(self, offset, form, *values):
        page = bytearray(self.page)
        struct.pack_into("=" + form, page, offset, *values)
        page[24:28] = struct.pack("=I", header_crc(bytes(page)))
        return bytes(page)

    def refused(self, page, text):
        with self.assertRaisesRegex(Violation, text):
            read_header(page, self.file_bytes, 1)

    def test_sound_header_is_accepted(self):
        self.assertEqual(read_header(self.page, self.file_bytes, 1).capacity, 50)

    def test_each_wrong_word_is_refused_by_name(self):
        for name, values in WRONG.items():
            for value in values:
                with self.subTest(word=name, value=value):
                    self.refused(self.changed(*HEADER_WORDS[name], value), rf"Header\.{name} ")

    def test_axes_and_origin_are_checked(self):
        for axes in ((1, 2, 2), (0, 1, 2), (1, 2, 4)):
            self.refused(self.changed(*HEADER_WORDS["axes"], *axes), "axes")
        self.refused(self.changed(*HEADER_WORDS["origin"], 0.0, float("nan"), 0.0), "origin")

    def test_misplaced_regions_are_refused(self):
        for name, values in MISPLACED.items():
            for value in values:
                with self.subTest(word=name, value=value):
                    self.refused(self.changed(*HEADER_WORDS[name], value), "multiple of|lies behind|ends inside")

    def test_wrong_fields_are_refused(self):
        for text, offset, form, value in (
            ("field", 512, "16s", b"weight"), ("type 1", 512 + 16, "I", 2), ("reserved", 512 + 20, "I", 1),
            ("multiple of 64", 512 + 24, "Q", 4), ("lies behind|ends inside", 512 + 24, "Q", 64),
            ("names of their own", 544, "16s", b"mass"), ("ends inside", 512 + 6 * 32 + 24, "Q", 2**63),
        ):
            with self.subTest(offset=offset, value=value):
                self.refused(self.changed(offset, form, value), text)

    def test_reserved_bytes_and_checksum_are_checked(self):
        for offset in (304, 511, 1024, 4095, 512 + 7 * 32):
            self.refused(self.changed(offset, "B", 1), "reserved")
        self.refused(self.page[:300] + b"x" + self.page[301:], "crc32c")


if __name__ == "__main__":
    unittest.main()
