"""Reads recordings (.wrec, tools/shm/README.md) frame by frame, up to the last whole one, in the world's axes and metres."""

import ctypes
import functools
import struct

import numpy as np

from wade import UsageError, plain_file

HEAD, PAGE, RECORD, DESCRIPTOR = 64, 4096, 24, 256
FLUID, AGENTS = 1, 2
FIELDS = ("mass", "vx", "vy", "vz", "px", "py", "pz")
OF_AGENTS = ("radius", "height", "state")
MOST_PARTICLES = 100_000_000  # of a frame, the limit of /fluid/max_particles
LARGEST_PAYLOAD = 41 * MOST_PARTICLES  # bytes: ten fields and what Zstandard may add
PLAIN, SHUFFLED, QUANTISED = 0, 1, 2  # encodings of a payload


class Frame:
    """A frame. number, time_s; values(): {field: array of float32}, in m, m/s, kg, with x upstream, y up, z across."""

    def __init__(self, recording, number, time_s, hashes, count, encoding, payload):
        self.recording, self.number, self.time_s, self.hashes = recording, number, time_s, hashes
        self.count, self.encoding, self.payload = count, encoding, payload

    def values(self):
        return self.recording.in_the_world(self.recording.decoded(self))


@functools.cache
def zstd():
    """The library of Zstandard that the programs use."""
    try:
        library = ctypes.CDLL("libzstd.so.1")
    except OSError as error:
        raise UsageError("compressed recordings need libzstd.so.1; Debian: apt-get install libzstd1") from error
    library.ZSTD_getFrameContentSize.restype = ctypes.c_ulonglong
    library.ZSTD_getFrameContentSize.argtypes = [ctypes.c_char_p, ctypes.c_size_t]
    library.ZSTD_decompress.restype = ctypes.c_size_t
    library.ZSTD_decompress.argtypes = [ctypes.c_void_p, ctypes.c_size_t, ctypes.c_char_p, ctypes.c_size_t]
    return library


def unpacked(payload, size):
    """`size` bytes out of a Zstandard frame; None if it holds something else."""
    if zstd().ZSTD_getFrameContentSize(payload, len(payload)) != size:
        return None
    into = np.empty(size, dtype=np.uint8)
    return into if zstd().ZSTD_decompress(into.ctypes.data, size, payload, len(payload)) == size else None


def unshuffled(data, values, kind):
    """Returns values from bytes that are stored apart: first all lowest bytes, then all second ones and so on."""
    return np.ascontiguousarray(data.reshape(-1, values).T).view(kind)[:, 0]


class Recording:
    """A recording that is read from its begin to its end, one frame at a time."""

    def __init__(self, path):
        self.path = path
        self.file = plain_file.open_plain(path)
        start = self.file.read(HEAD + PAGE)
        if len(start) < HEAD + PAGE or start[:8] != b"WADEREC1":
            raise UsageError(f"{path} is no recording: it does not begin with WADEREC1 and a header page")
        version, endian = struct.unpack_from("<II", start, 8)
        if version not in (1, 2):
            raise UsageError(f"{path} is a recording of version {version}; this program reads versions 1 and 2")
        if endian != 0x01020304:
            raise UsageError(f"{path} was recorded on a machine of another byte order")
        # Of version 2, else 0: s between frames, ends of the box, step of rounded velocities, error of rounded places.
        self.interval_s, *box, self.velocity_step, self.position_error_m = struct.unpack_from("<9f", start, 20)
        self.low, self.high = np.array(box[:3]), np.array(box[3:])
        page = start[HEAD:]
        self.kind, = struct.unpack_from("<I", page, 56)
        self.ticks_per_second, self.ticks_per_frame, self.metres = struct.unpack_from("<QQd", page, 80)
        self.origin = struct.unpack_from("<3d", page, 104)
        self.axes = struct.unpack_from("<3i", page, 128)
        self.radius, = struct.unpack_from("<d", page, 144)  # of a particle, m; 0: not given
        if not (0 < self.ticks_per_frame and 0 < self.ticks_per_second and all(1 <= abs(axis) <= 3 for axis in self.axes)):
            raise UsageError(f"{path} is damaged: its header page is that of no stream")
        self.producer = page[224:288].split(b"\0")[0].decode("utf-8", "replace")
        self.fields = FIELDS + OF_AGENTS * (self.kind == AGENTS)
        self.rest = 0  # bytes after the last whole frame, known once all have been read

    @property
    def rate_hz(self):
        return self.ticks_per_second / self.ticks_per_frame

    def frames(self):
        """All whole frames; what follows a frame that was cut off is left out, and its bytes are counted in `rest`."""
        at, end = HEAD + PAGE, self.file.seek(0, 2)
        while end - at >= RECORD:
            self.file.seek(at)
            kind, encoding, size = struct.unpack_from("<4sIQ", self.file.read(RECORD))
            if kind not in (b"FRAM", b"END ") or size > end - at - RECORD:
                break
            if kind == b"FRAM":
                descriptor = self.file.read(DESCRIPTOR)
                if size < DESCRIPTOR or len(descriptor) < DESCRIPTOR:
                    break
                if size - DESCRIPTOR > LARGEST_PAYLOAD or struct.unpack_from("<I", descriptor, 24)[0] > MOST_PARTICLES:
                    raise UsageError(f"{self.path} is damaged: the frame at byte {at} is larger than a frame can be")
                _, number, tick, count, _, own, before = struct.unpack_from("<QQQIIQQ", descriptor)
                place = at + RECORD + DESCRIPTOR, size - DESCRIPTOR
                yield Frame(self, number, tick / self.ticks_per_second, (before, own), count, encoding, place)
            at += RECORD + size
        self.rest = end - at

    def likely_end_s(self):
        """The time of the last whole frame, s; 0 without one. Reads no particles."""
        last = None
        for last in self.frames():
            pass
        return last.time_s if last else 0.0

    def decoded(self, frame):
        """The arrays as they were stored. UsageError if they are damaged."""
        self.file.seek(frame.payload[0])
        payload, count = self.file.read(frame.payload[1]), frame.count
        data, size = np.frombuffer(payload, np.uint8), 4 * count * len(self.fields)
        if frame.encoding == QUANTISED:
            size = 16 * count
        if frame.encoding != PLAIN:
            data = unpacked(payload, size)
        if data is None or frame.encoding > QUANTISED or len(data) != size:
            raise UsageError(f"{self.path} is damaged: the payload of frame {frame.number} does not hold its particles")
        if frame.encoding == QUANTISED:
            arrays = self.unrounded(data, count)
        else:
            parts = np.split(data, len(self.fields))
            arrays = [unshuffled(part, count, "<f4") if frame.encoding == SHUFFLED else part.view("<f4") for part in parts]
        if chain(frame.hashes[0], frame.number, arrays) != frame.hashes[1]:
            raise UsageError(f"{self.path} is damaged: the particles of frame {frame.number} do not match their hash")
        return dict(zip(self.fields, arrays))

    def unrounded(self, data, count):
        """The fields of a quantised payload: mass as float32, velocities as int16, positions as uint16."""
        arrays = [unshuffled(data[: 4 * count], count, "<f4")]
        for part in np.split(data[4 * count : 10 * count], 3):
            arrays.append(unshuffled(part, count, "<i2").astype("f4") * np.float32(self.velocity_step))
        for part, low, high in zip(np.split(data[10 * count :], 3), self.low, self.high):
            step = float(np.float32((high - low) / 65535))
            arrays.append((low + unshuffled(part, count, "<u2") * step).astype("f4"))
        return arrays

    def in_the_world(self, stored):
        """Arrays of a frame, in metres along the axes of the world; those of axes as stored stay as they are."""
        if self.metres == 1 and self.axes == (1, 2, 3) and self.origin == (0, 0, 0):
            return stored
        world = dict(stored)
        for name, axis, origin in zip("xyz", self.axes, self.origin):
            scale, source = self.metres * (1 if axis > 0 else -1), "xyz"[abs(axis) - 1]
            world["p" + name] = (origin + scale * stored["p" + source].astype(float)).astype("f4")
            world["v" + name] = (scale * stored["v" + source]).astype("f4")
        for name in {"radius", "height"} & set(stored):
            world[name] = (self.metres * stored[name]).astype("f4")
        return world


def mix(z):
    z ^= z >> 30
    z = z * 0xBF58476D1CE4E5B9 % 2**64
    z ^= z >> 27
    z = z * 0x94D049BB133111EB % 2**64
    return z ^ z >> 31


def chain(previous, frame, fields):
    """The hash chain of docs/protocol.md over the required fields of a frame."""
    n = np.arange(1, len(fields[0]) + 1, dtype=np.uint32)
    h = mix(mix(mix((previous + 0x9E3779B97F4A7C15) % 2**64) ^ frame) ^ len(n))
    for field in fields:
        w = np.ascontiguousarray(field).view(np.uint32)
        x = w + n * np.uint32(0x9E3779B1)
        y = (w << np.uint32(16) | w >> np.uint32(16)) ^ (n * np.uint32(0x85EBCA77))
        h = mix(h ^ int(np.sum(x.astype(np.uint64) * y, dtype=np.uint64)))
    return h or 1
