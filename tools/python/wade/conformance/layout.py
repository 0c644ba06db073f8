"""The bytes of a segment, CRC-32C of header and descriptor, and the hash chain of the frames, as docs/protocol.md states them,
written down a second time.
"""

import struct
from dataclasses import dataclass
from operator import mul

PAGE = 4096
MAGIC = 0x314D485345444157
ENDIAN_TAG = 0x01020304
MAX_CONSUMERS = 16
MAX_SLOTS = 64
MAX_FIELDS = 16
SLICE_S = 0.05
CHECKED_MINOR = 2  # from this minor version on a descriptor has a check, and words that others overwrite are an error

KINDS = {"fluid": 1, "agents": 2}
FIELDS = {1: ("mass", "vx", "vy", "vz", "px", "py", "pz")}
FIELDS[2] = FIELDS[1] + ("radius", "height", "state")
IMPULSES = ("jx", "jz", "submerged", "spread")  # of agents, all four or none

INIT, READY, RUNNING, DRAINING, CLOSED, ABORTED = range(6)
PRODUCER_STATES = ("init", "ready", "running", "draining", "closed", "aborted")
FREE, JOINED, LEFT, GAVE_UP, REFUSED = range(5)
LOCKSTEP, LATEST = range(2)
FOLLOWS = 1  # ConsumerEntry.flags
FINAL, NONFINITE = 1, 2  # SlotDescriptor.flags


class ControlPage:
    """Offsets from control_offset."""

    PUBLISH_SEQUENCE, STATE, PUBLISHED_FRAME, PRODUCER_WAITING = 0, 4, 8, 64
    HEARTBEAT_NS, START_TIME, PID, PAUSED, ADMITTED_FRAME = 128, 136, 144, 148, 192
    REASON_CODE, REASON_TEXT, REASON_BYTES = 512, 520, 512


class ConsumerPage:
    """Offsets from the start of a consumer's page."""

    STATE, MODE, ACKNOWLEDGED_FRAME, WAITING, STRIDE, DROPPED_FRAMES = 0, 4, 8, 16, 20, 24
    HEARTBEAT_NS, START_TIME, PID, PAUSED, FLAGS, LEFT_AT_FRAME, NAME, NAME_BYTES = 64, 72, 80, 84, 88, 96, 128, 64
    REASON_CODE, REASON_TEXT, REASON_BYTES = 192, 200, 512


class Descriptor:
    """Offsets from the start of a slot's descriptor."""

    SEQUENCE, FRAME, TICK, COUNT, FLAGS, HASH, PREVIOUS_HASH, CRC32C = 0, 8, 16, 24, 28, 32, 40, 48
    FURTHER_HASH, DIAGNOSTICS = 56, 64
    BYTES = 256


HEADER_WORDS = {
    "magic": (0, "Q"), "version_major": (8, "I"), "version_minor": (12, "I"), "endian_tag": (16, "I"),
    "header_bytes": (20, "I"), "crc32c": (24, "I"), "required_features": (28, "I"), "total_bytes": (32, "Q"),
    "session_id": (40, "Q"), "scene_hash": (48, "Q"), "stream_kind": (56, "I"), "coupling_lag": (60, "I"),
    "capacity": (64, "Q"), "slot_count": (72, "I"), "depth": (76, "I"), "ticks_per_second": (80, "Q"),
    "ticks_per_frame": (88, "Q"), "metres_per_unit": (96, "d"), "origin": (104, "3d"), "axes": (128, "3i"),
    "field_count": (140, "I"), "particle_radius": (144, "d"), "rest_density": (152, "d"),
    "control_offset": (160, "Q"), "doorbell_offset": (168, "Q"), "consumers_offset": (176, "Q"),
    "consumer_stride": (184, "I"), "consumer_count": (188, "I"), "descriptors_offset": (192, "Q"),
    "descriptor_stride": (200, "Q"), "slots_offset": (208, "Q"), "slot_stride": (216, "Q"),
    "producer_name": (224, "64s"), "column_width": (288, "2d"),
}
RESERVED_IN_HEADER = ((304, 512), (1024, 4096))
FIELD_ENTRY = (512, 32)  # the first one, bytes of each


@dataclass
class Field:
    name: str
    type: int
    reserved: int
    offset: int


class Header:
    """A private copy of the header page; its words are attributes."""

    def __init__(self, page):
        self.page = bytes(page)
        for name, (offset, form) in HEADER_WORDS.items():
            values = struct.unpack_from("=" + form, self.page, offset)
            setattr(self, name, values if len(values) > 1 else values[0])
        self.fields = []
        for i in range(min(self.field_count, MAX_FIELDS)):
            name, kind, reserved, offset = struct.unpack_from("=16sIIQ", self.page, FIELD_ENTRY[0] + i * FIELD_ENTRY[1])
            self.fields.append(Field(text_of(name), kind, reserved, offset))

    def descriptor(self, frame):
        """Offset of the descriptor of a frame."""
        return self.descriptors_offset + (frame - 1) % self.slot_count * self.descriptor_stride

    def slot(self, frame):
        """Offset of the slot of a frame."""
        return self.slots_offset + (frame - 1) % self.slot_count * self.slot_stride

    def consumer(self, i):
        """Offset of the page of consumer i."""
        return self.consumers_offset + i * self.consumer_stride

    def required_fields(self):
        """The fields that the hash chain covers, in its order."""
        return self.named(FIELDS[self.stream_kind])

    def impulse_fields(self):
        """What people do to the water; empty in a stream without."""
        has = self.stream_kind == KINDS["agents"] and any(field.name in IMPULSES for field in self.fields)
        return self.named(IMPULSES) if has else []

    def named(self, names):
        """The fields of these names."""
        entries = {field.name: field for field in self.fields}
        return [entries[name] for name in names]


def text_of(raw):
    """The text before the terminating zero."""
    return bytes(raw).split(b"\0", 1)[0].decode("utf-8", "replace")


M32, M64 = 2**32 - 1, 2**64 - 1


def _crc_table():
    table = []
    for value in range(256):
        for _ in range(8):
            value = value >> 1 ^ (0x82F63B78 if value & 1 else 0)
        table.append(value)
    return table


_TABLE = _crc_table()


def crc32c(data):
    """CRC-32C (Castagnoli, reflected) of bytes."""
    value = M32
    for byte in data:
        value = value >> 8 ^ _TABLE[(value ^ byte) & 0xFF]
    return value ^ M32


def header_crc(page):
    """CRC-32C of a header page, its own word taken as zero and the magic as stored."""
    return crc32c(page[:24] + bytes(4) + page[28:])


def descriptor_crc(descriptor):
    """CRC-32C of a descriptor without its sequence, its own word taken as zero."""
    data = bytes(descriptor)
    return crc32c(data[8:48] + bytes(4) + data[52:])


def mix(z):
    """The finaliser of splitmix64."""
    z ^= z >> 30
    z = z * 0xBF58476D1CE4E5B9 & M64
    z ^= z >> 27
    z = z * 0x94D049BB133111EB & M64
    return z ^ z >> 31


def chain(previous, frame, fields):
    """The chain of a frame from the one before; fields: bytes of float32 arrays of one length."""
    count = len(fields[0]) // 4
    h = mix((previous + 0x9E3779B97F4A7C15) & M64)
    h = mix(h ^ frame)
    h = mix(h ^ count)
    first = [n * 0x9E3779B1 & M32 for n in range(1, count + 1)]
    second = [n * 0x85EBCA77 & M32 for n in range(1, count + 1)]
    for field in fields:
        words = memoryview(field).cast("I")
        x = [w + n & M32 for w, n in zip(words, first)]
        y = [(w << 16 & M32 | w >> 16) ^ n for w, n in zip(words, second)]
        h = mix(h ^ sum(map(mul, x, y)) & M64)
    return h or 1
