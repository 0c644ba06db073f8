"""The producer's end of the shared-memory contract (docs/protocol.md, version 1.2) in plain Python.

Standard library only; ctypes makes the two system calls that Python has no name for. Copy it, with
shared_memory_segment.py, as it is.

Python has no atomic operations. What replaces them here:

* Words of 4 and 8 bytes are read and written through memoryview.cast("I") and cast("Q"). CPython copies an item
  with one aligned move of the item's size; x86-64 and aarch64 do that in one piece. (struct.pack_into with "<Q" would
  store byte by byte: never for these words.)
* No word is counted up by two sides. The producer alone writes publish_sequence, so load, add, store is enough.
* Order: x86-64 keeps stores in program order and loads in program order. Where that is not enough, between a store and
  a later load, and on aarch64 everywhere, fence() asks the kernel for a full barrier (membarrier, Linux 4.16).
* The consumers are woken without a look at their `waiting` words: the kernel orders that call itself.

So this holds on x86-64 and aarch64, with CPython. Anywhere else it refuses to start: use libwade_shm.so.
"""

import ctypes
import itertools
import mmap
import os
import secrets
import struct
import time

from shared_memory_segment import (ATTACH_TIMEOUT, PEER_ABORTED, PEER_DEAD, SLICE_S, STEP_TIMEOUT, UNEXPECTED, USAGE,
                                   VIOLATION, Kernel, Segment, StreamError)

PAGE, MAX_CONSUMERS, DESCRIPTOR_BYTES = 4096, 16, 256
CONTROL, DOORBELL, CONSUMERS = PAGE, 2 * PAGE, 3 * PAGE
DESCRIPTORS = CONSUMERS + MAX_CONSUMERS * PAGE
FIELDS = ("mass", "vx", "vy", "vz", "px", "py", "pz")
READY, RUNNING, DRAINING, CLOSED, ABORTED = 1, 2, 3, 4, 5  # Control.state
JOINED, LEFT, GAVE_UP, REFUSED = 1, 2, 3, 4  # ConsumerEntry.state
LOCKSTEP, LATEST = 0, 1  # ConsumerEntry.mode
FOLLOWS = 1  # ConsumerEntry.flags
FINAL = 1  # SlotDescriptor.flags


def crc_of_byte(crc):
    for _ in range(8):
        crc = crc >> 1 ^ (0x82F63B78 if crc & 1 else 0)
    return crc


CRC_TABLE = [crc_of_byte(byte) for byte in range(256)]


def crc32c(data):
    crc = 0xFFFFFFFF
    for byte in data:
        crc = crc >> 8 ^ CRC_TABLE[(crc ^ byte) & 0xFF]
    return crc ^ 0xFFFFFFFF


def round_up(value, to):
    return (value + to - 1) // to * to


def printable(data):
    """Text up to the first zero byte; what is no text or would steer a terminal is replaced."""
    text = bytes(data).split(b"\0")[0].decode(errors="replace")
    return "".join(c if c.isprintable() else "?" for c in text)


class SharedMemoryStream:
    """Publishes frames of up to `capacity` particles under /<session>-fluid.

    with SharedMemoryStream(session, capacity, "my solver") as stream:
        stream.wait_for_consumers()
        while there is more and (arrays := stream.begin_frame()) is not None:
            fill the seven arrays (memoryviews of float32 over the slot: mass, vx, vy, vz, px, py, pz)
            stream.end_frame(count)
        stream.close()

    Leaving the block by an exception tells the consumers why. `interrupted` is polled and gives the number of a signal
    that asks to stop, or 0. Time-outs in seconds, 0: wait for ever. particle_radius: half of the spacing of a solver's
    particles, m. column_width: of depth-averaged water, along x and z, m (columns.py). Errors: StreamError.
    """

    def __init__(self, session, capacity, producer_name, depth=1, scene_hash=0, attach_timeout_s=10, step_timeout_s=60,
                 interrupted=lambda: 0, ticks_per_second=30, ticks_per_frame=1, particle_radius=0, column_width=(0, 0)):
        if not 1 <= capacity < 2**32 or not 1 <= depth <= 63:
            raise StreamError(USAGE, f"Capacity {capacity} must be 1 to 2^32 - 1 and depth {depth} 1 to 63.")
        if tuple(column_width) != (0, 0) and not all(0 < width <= 2 for width in column_width):
            raise StreamError(USAGE, f"column_width {column_width} must be 0, 0 or above 0 and at most 2 m; split wider cells.")
        self.session, self.interrupted = session, interrupted
        self.attach_timeout_s, self.step_timeout_s = attach_timeout_s, step_timeout_s
        self.depth, self.slots = depth, depth + 1  # a slot more, so that a free-running reader finds a stable frame
        self.ticks_per_frame = ticks_per_frame
        self.published = self.hash = 0
        self.admitted = [0] * MAX_CONSUMERS
        self.joined_as = [None] * MAX_CONSUMERS  # mode and flags of a consumer when it was admitted
        self.had_leader = self.ended = False
        self.kernel = Kernel()

        self.capacity, self.array_bytes = capacity, round_up(4 * capacity, 64)
        self.slots_offset = round_up(DESCRIPTORS + self.slots * DESCRIPTOR_BYTES, PAGE)
        self.slot_stride = round_up(len(FIELDS) * self.array_bytes, PAGE)
        total = self.slots_offset + self.slots * self.slot_stride
        self.segment = Segment(session, total)
        shared = mmap.mmap(self.segment.fd, total)
        self.bytes = memoryview(shared)
        self.u32, self.u64 = self.bytes.cast("I"), self.bytes.cast("Q")
        self.publish_word = ctypes.c_uint32.from_buffer(shared, CONTROL)
        self.doorbell_word = ctypes.c_uint32.from_buffer(shared, DOORBELL)

        self.u32[(CONTROL + 144) // 4] = os.getpid()
        with open("/proc/self/stat", encoding="utf-8", errors="replace") as stat:
            self.u64[(CONTROL + 136) // 8] = int(stat.read().rpartition(")")[2].split()[19])
        self.heartbeat()
        self.u32[(CONTROL + 4) // 4] = READY
        header = self.header(total, scene_hash, ticks_per_second, producer_name, particle_radius, column_width)
        self.bytes[8:PAGE] = header[8:]
        self.kernel.fence()
        self.u64[0] = int.from_bytes(header[:8], "little")  # the magic, last: from now on others read the page

    def header(self, total, scene_hash, ticks_per_second, producer_name, particle_radius, column_width):
        page = bytearray(PAGE)
        struct.pack_into("=8s6I", page, 0, b"WADESHM1", 1, 4, 0x01020304, PAGE, 0, 0)
        struct.pack_into("=3Q2I", page, 32, total, secrets.randbits(63) + 1, scene_hash, 1, 0)
        struct.pack_into("=Q2I", page, 64, self.capacity, self.slots, self.depth)
        struct.pack_into("=2Q", page, 80, ticks_per_second, self.ticks_per_frame)
        struct.pack_into("=4d3iI2d", page, 96, 1, 0, 0, 0, 1, 2, 3, len(FIELDS), particle_radius, 1000)
        struct.pack_into("=3Q2I", page, 160, CONTROL, DOORBELL, CONSUMERS, PAGE, MAX_CONSUMERS)
        struct.pack_into("=4Q", page, 192, DESCRIPTORS, DESCRIPTOR_BYTES, self.slots_offset, self.slot_stride)
        struct.pack_into("=63s", page, 224, producer_name.encode())
        struct.pack_into("=2d", page, 288, *column_width)
        for i, field in enumerate(FIELDS):
            struct.pack_into("=16sIIQ", page, 512 + 32 * i, field.encode(), 1, 0, i * self.array_bytes)
        struct.pack_into("=I", page, 24, crc32c(page))
        return page

    def heartbeat(self):
        self.u64[(CONTROL + 128) // 8] = time.monotonic_ns()

    def ring(self):
        """Increments the futex word and wakes all consumers that sleep on it."""
        self.kernel.fence()
        self.u32[CONTROL // 4] = (self.u32[CONTROL // 4] + 1) & 0xFFFFFFFF
        self.kernel.wake_all(self.publish_word)

    def enter(self, state):
        self.kernel.fence()
        self.u32[(CONTROL + 4) // 4] = state
        self.ring()

    def consumer(self, i):
        """Label of consumer i, for messages."""
        page = CONSUMERS + i * PAGE
        return f"Consumer '{printable(self.bytes[page + 128 : page + 192])}' (process {self.u32[(page + 80) // 4]})"

    def survey(self, admit_at, owed):
        """Reads all consumer pages and admits newcomers at frame admit_at (0: none).

        Returns how many lead (in lockstep and not merely following), the frame that all in lockstep have released, and
        whether one that has not released frame `owed` pauses on purpose.
        """
        leaders, slowest, paused, news = 0, float("inf"), False, False
        for i in range(MAX_CONSUMERS):
            page = CONSUMERS + i * PAGE
            state, now = self.u32[page // 4], (self.u32[page // 4 + 1], self.u32[page // 4 + 22])
            mode, flags = self.joined_as[i] if self.admitted[i] else now
            admit = state == JOINED and mode <= LATEST and self.admitted[i] == 0 and admit_at != 0
            # A goodbye counts once the lock is free, because any process may have written the state. The end of a
            # free-running reader is a goodbye, whatever its reason.
            goodbye = self.admitted[i] != 0 and (state == LEFT or (state == GAVE_UP and mode == LATEST))
            gone = goodbye and not self.segment.locked_by_other(1 + i)
            if admit or gone:
                self.joined_as[i] = now
                self.admitted[i] = admit_at if admit else 0  # 0: the page may be taken again
                self.u64[(CONTROL + 192) // 8 + i] = self.admitted[i]
                news = True
            if mode != LOCKSTEP or gone:
                continue
            if self.admitted[i] != 0 and (now != (mode, flags) or not JOINED <= state <= GAVE_UP):
                words = f"state {state}, mode {now[0]}, flags {now[1]}"
                raise StreamError(VIOLATION, f"The page of {self.consumer(i)} was overwritten: {words}.")
            before_start = self.published == 0 and not self.had_leader
            if (state == GAVE_UP and (self.admitted[i] != 0 or before_start)) or (state == REFUSED and before_start):
                reason = printable(self.bytes[page + 200 : page + 712])
                raise StreamError(PEER_ABORTED, f"{self.consumer(i)} gave up: {reason}")
            if self.admitted[i] == 0:
                continue
            acknowledged = self.u64[page // 8 + 1]
            if acknowledged > self.published:
                raise StreamError(VIOLATION,
                                  f"{self.consumer(i)} acknowledged frame {acknowledged}, only {self.published} exist.")
            released = max(acknowledged, self.admitted[i] - 1)
            leaders += not flags & FOLLOWS
            slowest = min(slowest, released)
            paused = paused or (released < owed and self.u32[(page + 84) // 4] != 0)
        self.had_leader = self.had_leader or leaders > 0
        if news:
            self.ring()
        return leaders, slowest, paused

    def check_alive(self, owed):
        """Raises if a consumer in lockstep has died: lock free, no goodbye, and frame `owed` not released."""
        for i in range(MAX_CONSUMERS):
            page = CONSUMERS + i * PAGE
            if self.admitted[i] == 0 or self.joined_as[i][0] != LOCKSTEP or self.segment.locked_by_other(1 + i):
                continue
            following = max(self.u64[page // 8 + 1] + 1, self.admitted[i])
            if self.u32[page // 4] == JOINED and following <= owed:  # a goodbye comes before the lock is dropped
                raise StreamError(PEER_DEAD, f"{self.consumer(i)} died at frame {following}.")

    def check_interrupted(self):
        if number := self.interrupted():
            raise StreamError(128 + number, f"Interrupted by signal {number} after frame {self.published}.")

    def wait(self, start, admit_at, owed):
        """Waits until all in lockstep have released frame `owed`; at the start until there is one that leads."""
        limit_s = self.attach_timeout_s if start else self.step_timeout_s
        spent_s = 0
        for attempt in itertools.count():
            if attempt == 1:  # flag, futex word, another look, sleep: this order loses no wake-up
                self.u32[(CONTROL + 64) // 4] = 1
                self.kernel.fence()
                last = time.monotonic()
            seen = self.u32[DOORBELL // 4]
            leaders, slowest, paused = self.survey(admit_at, owed)
            if leaders > 0 if start else slowest >= owed:
                break
            if attempt == 0:
                continue
            changed = self.kernel.sleep_while(self.doorbell_word, seen)
            passed = time.monotonic() - last
            self.check_interrupted()
            if changed and passed < SLICE_S:
                continue
            last += passed
            self.heartbeat()
            self.check_alive(admit_at if start else owed)
            if not paused:  # nor does time count while this process is stopped
                spent_s += SLICE_S if passed > 4 * SLICE_S else passed
            if 0 < limit_s <= spent_s:
                what = f"a consumer of session '{self.session}'" if start else f"the release of frame {owed}"
                raise StreamError(ATTACH_TIMEOUT if start else STEP_TIMEOUT,
                                  f"Waited {limit_s:g} s in vain for {what}.")
        self.u32[(CONTROL + 64) // 4] = 0
        return leaders

    def wait_for_consumers(self):
        """Waits for the first consumer."""
        self.wait(True, 1, 0)

    def begin_frame(self):
        """Arrays of the next frame, or None if only followers are left and the stream should end."""
        self.check_interrupted()
        frame = self.published + 1
        self.heartbeat()
        if frame == 1:
            self.enter(RUNNING)
        if self.wait(False, frame, max(frame - self.depth, 0)) == 0:
            return None
        slot = (frame - 1) % self.slots
        self.u64[(DESCRIPTORS + slot * DESCRIPTOR_BYTES) // 8] = 2 * frame - 1
        self.kernel.fence()  # a free-running reader that sees what follows sees this word, too
        first = self.slots_offset + slot * self.slot_stride
        places = (first + i * self.array_bytes for i in range(len(FIELDS)))
        return [self.bytes[at : at + 4 * self.capacity].cast("f") for at in places]

    def end_frame(self, count, frame_hash=0, final=False):
        """Publishes the frame that begin_frame began; frame_hash: the chain of the contract, 0 if not computed."""
        if not 0 <= count <= self.capacity:
            raise StreamError(USAGE, f"A frame of {count} particles exceeds the capacity of {self.capacity}.")
        frame = self.published + 1
        at = DESCRIPTORS + (frame - 1) % self.slots * DESCRIPTOR_BYTES
        tick, flags = frame * self.ticks_per_frame, FINAL if final else 0
        struct.pack_into("=2Q2I2Q", self.bytes, at + 8, frame, tick, count, flags, frame_hash, self.hash)
        nan = float("nan")  # diagnostics that are not given
        struct.pack_into("=3dQ5d", self.bytes, at + 80, nan, nan, nan, 0, nan, nan, nan, nan, nan)
        struct.pack_into("=4d", self.bytes, at + 176, nan, nan, nan, nan)
        struct.pack_into("=I", self.bytes, at + 48, 0)
        struct.pack_into("=I", self.bytes, at + 48, crc32c(self.bytes[at + 8 : at + DESCRIPTOR_BYTES]))
        self.kernel.fence()
        self.u64[at // 8] = 2 * frame
        self.kernel.fence()
        self.u64[(CONTROL + 8) // 8] = frame
        self.published, self.hash = frame, frame_hash
        self.heartbeat()
        if final:
            self.enter(DRAINING)
        else:
            self.ring()

    def close(self):
        """Waits until all is read, then ends the stream."""
        self.enter(DRAINING)
        self.wait(False, 0, self.published)
        self.ended = True
        self.enter(CLOSED)
        self.segment.unlink()

    def abort(self, code, text):
        """Ends the stream at once and tells the consumers why."""
        if self.ended:
            return
        self.ended = True
        struct.pack_into("=i", self.bytes, CONTROL + 512, code)
        text = text.encode()[:511]
        self.bytes[CONTROL + 520 : CONTROL + 520 + len(text)] = text
        self.enter(ABORTED)
        self.segment.unlink()

    def __enter__(self):
        return self

    def __exit__(self, kind, error, _):
        if error is not None:
            self.abort(error.code if kind is StreamError else UNEXPECTED, str(error) or kind.__name__)
        else:
            self.abort(UNEXPECTED, "It ended without closing the stream.")
