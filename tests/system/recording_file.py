"""Reads and spoils recordings, written from tools/shm/README.md and not from the programs' code."""

import struct

HEAD_BYTES, PAGE_BYTES, RECORD_HEAD_BYTES, DESCRIPTOR_BYTES = 64, 4096, 24, 256
FRAME, END = b"FRAM", b"END "


def crc32c(data):
    crc = 0xFFFFFFFF
    for byte in data:
        crc = TABLE[(crc ^ byte) & 0xFF] ^ crc >> 8
    return crc ^ 0xFFFFFFFF


def table_entry(value):
    for _ in range(8):
        value = value >> 1 ^ (0x82F63B78 if value & 1 else 0)
    return value


TABLE = [table_entry(value) for value in range(256)]


class Record:
    """One record: where it lies in the file and what its head says."""

    def __init__(self, data, at):
        self.at = at
        head = struct.unpack_from("<4sIQII", data, at)
        self.kind, self.encoding, self.body_bytes, self.body_crc, self.head_crc = head
        self.body_at = at + RECORD_HEAD_BYTES
        self.end = self.body_at + self.body_bytes

    def descriptor(self, data):
        """sequence, frame, tick, count, flags, hash, previous hash."""
        return struct.unpack_from("<QQQIIQQ", data, self.body_at)

    def payload(self, data):
        return data[self.body_at + DESCRIPTOR_BYTES : self.end]


def records(data):
    """All records of a whole recording."""
    found, at = [], HEAD_BYTES + PAGE_BYTES
    while at < len(data):
        found.append(Record(data, at))
        at = found[-1].end
    return found


def with_right_checksums(data, record):
    """The file with the checksums of one record made to fit its bytes."""
    spoilt = bytearray(data)
    struct.pack_into("<I", spoilt, record.at + 16, crc32c(spoilt[record.body_at : record.end]))
    struct.pack_into("<I", spoilt, record.at + 20, crc32c(spoilt[record.at : record.at + 20]))
    return bytes(spoilt)
