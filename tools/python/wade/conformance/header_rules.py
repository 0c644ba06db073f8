"""The rules for a header page: what a consumer demands before it touches anything else."""

import math

from wade.conformance.expectation import expect
from wade.conformance.layout import (ENDIAN_TAG, FIELDS, FIELD_ENTRY, HEADER_WORDS, IMPULSES, KINDS, MAGIC,
                                     MAX_CONSUMERS, MAX_FIELDS, MAX_SLOTS, PAGE, RESERVED_IN_HEADER, Header, header_crc)


def read_header(page, file_bytes, kind):
    """Returns a checked copy of a header page with its magic stored; kind: the stream kind of the object's name."""
    header = Header(page)
    identify(header, kind)
    check_values(header)
    check_regions(header, file_bytes)
    check_fields(header)
    check_reserved(header)
    return header


def demand(header, name, allowed, text):
    """A word of the header satisfies a condition."""
    value = getattr(header, name)
    expect(allowed(value), f"Header.{name} (offset {HEADER_WORDS[name][0]}) is {text}", f"{value}")


def identify(header, kind):
    demand(header, "magic", lambda v: v == MAGIC, f"{MAGIC:#x}")
    demand(header, "endian_tag", lambda v: v == ENDIAN_TAG, f"{ENDIAN_TAG:#x}")
    demand(header, "version_major", lambda v: v == 1, "1")
    demand(header, "header_bytes", lambda v: v == PAGE, "4096")
    own = header_crc(header.page)
    demand(header, "crc32c", lambda v: v == own, f"the CRC-32C of the page, {own}, once the magic is visible")
    demand(header, "required_features", lambda v: v == 0, "0, no feature is known that a reader must understand")
    demand(header, "stream_kind", lambda v: v == kind, f"{kind} for an object of this name")


def check_values(header):
    demand(header, "session_id", lambda v: v != 0, "random")
    demand(header, "coupling_lag", lambda v: v in (0, 1), "0 or 1")
    demand(header, "capacity", lambda v: 1 <= v < 2**32, "1 .. 2^32 - 1")
    demand(header, "slot_count", lambda v: 1 <= v <= MAX_SLOTS, "1 .. 64")
    demand(header, "depth", lambda v: 1 <= v <= header.slot_count, f"1 .. slot_count = {header.slot_count}")
    demand(header, "ticks_per_second", lambda v: v >= 1, "at least 1")
    demand(header, "ticks_per_frame", lambda v: v >= 1, "at least 1")
    demand(header, "metres_per_unit", lambda v: math.isfinite(v) and v > 0, "above 0")
    demand(header, "origin", lambda v: all(map(math.isfinite, v)), "finite")
    demand(header, "axes", lambda v: sorted(map(abs, v)) == [1, 2, 3], "a permutation of 1 2 3 with signs")
    for name in "particle_radius", "rest_density":
        demand(header, name, lambda v: math.isfinite(v) and v >= 0, "0 or above")
    demand(header, "column_width", lambda v: v == (0, 0) or all(0 < width <= 2 for width in v),
           "0, 0 for points, or the width of columns, above 0 and at most 2 m")
    demand(header, "field_count", lambda v: 1 <= v <= MAX_FIELDS, "1 .. 16")
    demand(header, "producer_name", lambda v: 0 in v, "a zero-terminated text")


def check_regions(header, file_bytes):
    demand(header, "total_bytes", lambda v: v == file_bytes, f"the size of the file, {file_bytes}")
    demand(header, "consumer_stride", lambda v: v == PAGE, "4096")
    demand(header, "consumer_count", lambda v: v == MAX_CONSUMERS, "16")
    demand(header, "descriptor_stride", lambda v: v == 256, "256")
    demand(header, "slot_stride", lambda v: v % PAGE == 0, "a multiple of 4096")
    regions = {
        "header": (0, PAGE),
        "control": (header.control_offset, PAGE),
        "doorbell": (header.doorbell_offset, PAGE),
        "consumers": (header.consumers_offset, header.consumer_count * header.consumer_stride),
        "descriptors": (header.descriptors_offset, header.slot_count * header.descriptor_stride),
        "slots": (header.slots_offset, header.slot_count * header.slot_stride),
    }
    for name, (start, _) in regions.items():
        expect(start % PAGE == 0, f"{name}_offset is a multiple of 4096", f"{start}")
    check_apart(regions, file_bytes, "the file")


def check_fields(header):
    names = [field.name for field in header.fields]
    expect(len(set(names)) == len(names) and all(names), "fields have names of their own", f"{names}")
    missing = [name for name in FIELDS[header.stream_kind] if name not in names]
    expect(not missing, f"a stream of kind {header.stream_kind} has the field {missing[:1]}", f"{names}")
    impulses = [name for name in IMPULSES if name in names]
    expect(header.stream_kind != KINDS["agents"] or len(impulses) in (0, len(IMPULSES)),
           f"a stream of agents has all of {', '.join(IMPULSES)} or none", f"{impulses}")
    for field in header.fields:
        expect(field.type == 1, f"field {field.name} has type 1 (float32)", f"{field.type}")
        expect(field.offset % 64 == 0, f"field {field.name} has an offset that is a multiple of 64", f"{field.offset}")
    arrays = {f"field {field.name}": (field.offset, 4 * header.capacity) for field in header.fields}
    check_apart(arrays, header.slot_stride, "a slot")


def check_apart(regions, room, whole):
    """Regions (name: start, bytes) lie inside the room and do not overlap."""
    end, before = 0, "the start"
    for name, (start, size) in sorted(regions.items(), key=lambda item: item[1]):
        expect(start >= end, f"{name} lies behind {before}, which ends at {end}", f"it starts at {start}")
        end, before = start + size, name
    expect(end <= room, f"{before} ends inside {whole} of {room} bytes", f"it ends at {end}")


def check_reserved(header):
    """Reserved bytes are zero as far as this minor version is known."""
    if header.version_minor > 4:
        return
    entries = FIELD_ENTRY[0] + header.field_count * FIELD_ENTRY[1]
    for start, end in RESERVED_IN_HEADER + ((entries, 1024),):
        expect(not any(header.page[start:end]), f"reserved bytes {start} .. {end - 1} of the header are zero", "others")
    for field in header.fields:
        expect(field.reserved == 0, f"the reserved word of field {field.name} is zero", f"{field.reserved}")
