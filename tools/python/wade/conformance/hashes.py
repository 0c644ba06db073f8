"""CRC-32C of the header and the hash chain of the frames, as docs/protocol.md defines them."""

from operator import mul

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
