"""A sound producer in plain Python, small enough to be broken on purpose: see broken_producer.py."""

import os
import signal
import struct
import sys
import time
from array import array
from pathlib import Path

from wade.conformance import system
from wade.conformance.layout import chain, descriptor_crc, header_crc
from wade.conformance.layout import (
    ABORTED, CLOSED, DRAINING, FIELD_ENTRY, FIELDS, FINAL, FOLLOWS, GAVE_UP, HEADER_WORDS, IMPULSES, JOINED, KINDS, LATEST, LEFT,
    LOCKSTEP, MAGIC, MAX_CONSUMERS, PAGE, READY, REFUSED, RUNNING, SLICE_S, ConsumerPage, ControlPage, Descriptor,
    text_of,
)

CONTROL, DOORBELL, CONSUMERS, DESCRIPTORS = PAGE, 2 * PAGE, 3 * PAGE, 19 * PAGE
SLOTS = 20 * PAGE


class Failure(Exception):
    def __init__(self, code, text):
        super().__init__(text)
        self.code = code


class Publisher:
    """The producer's side of the contract; each method is one rule, so that a defect overrides one."""

    permissions = 0o600
    column_width = (0.0, 0.0)

    def __init__(self, options):
        self.plan(options)
        self.published = self.chain = self.signal = 0
        self.admitted = [0] * MAX_CONSUMERS
        self.joined_as = [(0, 0)] * MAX_CONSUMERS
        self.had_lockstep = False
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, self.remember)
        self.fd = self.create()
        self.words = system.Words(self.fd, 0, self.total_bytes, True)
        self.fill_control()
        self.store_header()

    def plan(self, options):
        """Names and sizes."""
        self.options = options
        self.path = Path("/dev/shm") / f"{options.session}-{options.kind}"
        self.required = len(FIELDS[KINDS[options.kind]])
        self.names = FIELDS[KINDS[options.kind]] + (IMPULSES if options.kind == "agents" else ())
        self.field_bytes = -(-4 * options.particles // 64) * 64
        self.slot_stride = -(-self.field_bytes * len(self.names) // PAGE) * PAGE
        self.slots = options.depth + 1
        self.total_bytes = SLOTS + self.slots * self.slot_stride

    def remember(self, number, _frame):
        self.signal = number

    # Creation.

    def create(self):
        """Creates the object exclusively, locks it, sizes it; replaces that of a dead producer."""
        while True:
            try:
                fd = os.open(self.path, os.O_CREAT | os.O_EXCL | os.O_RDWR | os.O_CLOEXEC, self.permissions)
            except FileExistsError:
                self.remove_stale()
                continue
            if self.take_lock(fd) and self.leads_to(fd):
                os.posix_fallocate(fd, 0, self.total_bytes)
                return fd
            os.close(fd)

    def take_lock(self, fd):
        return system.lock_byte(fd, 0)

    def remove_stale(self):
        try:
            fd = os.open(self.path, os.O_RDWR | os.O_CLOEXEC)
        except FileNotFoundError:
            return
        try:
            if not self.take_lock(fd):
                raise Failure(8, f"{self.path.name} has a living producer.")
            if self.leads_to(fd):
                self.path.unlink()
        finally:
            os.close(fd)

    def leads_to(self, fd):
        try:
            return self.path.stat().st_ino == os.fstat(fd).st_ino
        except FileNotFoundError:
            return False

    def fill_control(self):
        self.words.set_u32(CONTROL + ControlPage.PID, os.getpid())
        self.words.set_u64(CONTROL + ControlPage.START_TIME, system.start_time(os.getpid()))
        self.beat()
        self.words.set_u32(CONTROL + ControlPage.STATE, READY)

    def header(self):
        """The header page with its magic and checksum."""
        page = bytearray(PAGE)
        values = {
            "magic": MAGIC, "version_major": 1, "version_minor": 4, "endian_tag": 0x01020304, "header_bytes": PAGE,
            "total_bytes": self.total_bytes, "session_id": int.from_bytes(os.urandom(8), "little") | 1,
            "stream_kind": KINDS[self.options.kind], "capacity": self.options.particles, "slot_count": self.slots,
            "depth": self.options.depth, "ticks_per_second": 32, "ticks_per_frame": 1, "metres_per_unit": 1.0,
            "field_count": len(self.names), "control_offset": CONTROL, "doorbell_offset": DOORBELL,
            "consumers_offset": CONSUMERS, "consumer_stride": PAGE, "consumer_count": MAX_CONSUMERS,
            "descriptors_offset": DESCRIPTORS, "descriptor_stride": 256, "slots_offset": SLOTS,
            "slot_stride": self.slot_stride, "producer_name": b"python",
        }
        for name, value in values.items():
            offset, form = HEADER_WORDS[name]
            struct.pack_into("=" + form, page, offset, value)
        struct.pack_into("=3i", page, HEADER_WORDS["axes"][0], 1, 2, 3)
        struct.pack_into("=2d", page, HEADER_WORDS["column_width"][0], *self.column_width)
        for i, name in enumerate(self.names):
            at = FIELD_ENTRY[0] + i * FIELD_ENTRY[1]
            struct.pack_into("=16sIIQ", page, at, name.encode(), 1, 0, i * self.field_bytes)
        struct.pack_into("=I", page, HEADER_WORDS["crc32c"][0], header_crc(bytes(page)))
        return bytes(page)

    def store_header(self):
        self.words.bytes[8:PAGE] = self.header()[8:]
        self.words.set_u64(0, MAGIC)

    # Consumers.

    def page(self, i):
        return CONSUMERS + i * PAGE

    def consumer(self, i, offset):
        return self.words.u32(self.page(i) + offset)

    def acknowledged(self, i):
        """Of a consumer that is waited for; what lay before its first frame does not concern it."""
        return max(self.words.u64(self.page(i) + ConsumerPage.ACKNOWLEDGED_FRAME), self.admitted[i] - 1)

    def admit(self, i, frame):
        self.admitted[i] = frame
        self.joined_as[i] = self.mode_and_flags(i)
        self.words.set_u64(CONTROL + ControlPage.ADMITTED_FRAME + 8 * i, frame)
        self.ring()

    def forget(self, i):
        self.admitted[i] = 0
        self.words.set_u64(CONTROL + ControlPage.ADMITTED_FRAME + 8 * i, 0)

    def takes_part(self, i):
        """Whether the producer waits for consumer i."""
        state, mode = self.consumer(i, ConsumerPage.STATE), self.joined_as[i][0]
        return self.admitted[i] and mode == LOCKSTEP and (state == JOINED or state == LEFT and not self.has_gone(i))

    def mode_and_flags(self, i):
        return self.consumer(i, ConsumerPage.MODE), self.consumer(i, ConsumerPage.FLAGS)

    def has_gone(self, i):
        """A goodbye counts once the lock is free."""
        return not system.is_locked_by_other(self.fd, 1 + i)

    def check_words(self, i, state):
        """What a consumer in lockstep wrote when it joined stays."""
        if self.admitted[i] and self.joined_as[i][0] == LOCKSTEP:
            if self.mode_and_flags(i) != self.joined_as[i] or state not in (JOINED, LEFT, GAVE_UP):
                raise Failure(6, f"The page of consumer {i} was overwritten.")

    def survey(self, frame):
        """Admits at this frame (0: none), notices goodbyes and failures; returns the consumers to wait for."""
        for i in range(MAX_CONSUMERS):
            state = self.consumer(i, ConsumerPage.STATE)
            self.check_words(i, state)
            known_mode = self.consumer(i, ConsumerPage.MODE) in (LOCKSTEP, LATEST)
            if state == JOINED and not self.admitted[i] and frame and known_mode:
                self.admit(i, frame)
            elif state == LEFT and self.admitted[i] and self.has_gone(i):
                self.forget(i)
            elif state == GAVE_UP and self.admitted[i] or state == REFUSED and not self.published:
                self.gave_up(i)
        active = [i for i in range(MAX_CONSUMERS) if self.takes_part(i)]
        for i in active:
            self.check_acknowledgement(i)
        self.had_lockstep |= bool(active)
        return active

    def gave_up(self, i):
        at = self.page(i) + ConsumerPage.REASON_TEXT
        text = text_of(self.words.bytes[at : at + ConsumerPage.REASON_BYTES])
        raise Failure(5, f"Consumer {i} gave up: {self.printable(text)}")

    def printable(self, text):
        return "".join(c if c.isprintable() else "?" for c in text)

    def check_acknowledgement(self, i):
        if self.acknowledged(i) > self.published and self.acknowledged(i) >= self.admitted[i]:
            raise Failure(6, f"Consumer {i} acknowledged frame {self.acknowledged(i)} of {self.published}.")

    def check_alive(self, owed):
        for i in range(MAX_CONSUMERS):
            if not self.takes_part(i) or system.is_locked_by_other(self.fd, 1 + i):
                continue
            if self.takes_part(i) and self.acknowledged(i) < owed:
                self.died(i)

    def died(self, i):
        raise Failure(4, f"Consumer {i} died at frame {self.acknowledged(i) + 1}.")

    def goes_on(self, active):
        """Whether the stream has a reason to go on with these consumers."""
        return any(not self.joined_as[i][1] & FOLLOWS for i in active) or not self.had_lockstep

    def someone_pauses(self):
        return any(self.takes_part(i) and self.consumer(i, ConsumerPage.PAUSED) for i in range(MAX_CONSUMERS))

    # Waiting and waking.

    def beat(self):
        self.words.set_u64(CONTROL + ControlPage.HEARTBEAT_NS, system.monotonic_ns())

    def ring(self):
        at = CONTROL + ControlPage.PUBLISH_SEQUENCE
        self.words.set_u32(at, self.words.u32(at) + 1)
        system.fence()
        if any(self.consumer(i, ConsumerPage.WAITING) for i in range(MAX_CONSUMERS)):
            system.futex_wake_all(self.words.address(at))

    def enter(self, state):
        self.words.set_u32(CONTROL + ControlPage.STATE, state)
        self.ring()

    def wait(self, ready, owed, timeout_s, failure):
        """Sleeps in slices until ready(); looks at signals, locks and the time after each."""
        spent, last = 0.0, time.monotonic()
        self.words.set_u32(CONTROL + ControlPage.PRODUCER_WAITING, 1)
        while True:
            system.fence()
            seen = self.words.u32(DOORBELL)
            value = ready()
            if value is not None:
                self.words.set_u32(CONTROL + ControlPage.PRODUCER_WAITING, 0)
                return value
            system.futex_wait(self.words.address(DOORBELL), seen, SLICE_S)
            self.beat()
            if self.signal:
                raise Failure(128 + self.signal, f"Interrupted by signal {self.signal}.")
            self.check_alive(owed)
            now = time.monotonic()
            if not self.someone_pauses():
                spent += min(now - last, 2 * SLICE_S)  # more than that: this process was stopped
            last = now
            if 0 < timeout_s < spent:
                raise Failure(failure, f"Waited {timeout_s:g} s in vain.")

    def wait_for_consumers(self):
        self.wait(lambda: self.survey(1) or None, 0, self.options.attach_timeout_s, 3)

    def wait_for_acknowledgements(self, owed, frame):
        """Returns the consumers to wait for, once all have acknowledged frame `owed`."""

        def ready():
            active = self.survey(frame)
            return active if all(self.acknowledged(i) >= owed for i in active) else None

        return self.wait(ready, owed, self.options.step_timeout_s, 7)

    # Frames.

    def begin_frame(self, frame):
        """Returns False if no consumer is left."""
        self.beat()
        if frame == 1:
            self.enter(RUNNING)
        return self.goes_on(self.wait_for_acknowledgements(max(0, frame - self.options.depth), frame))

    def descriptor(self, frame):
        return DESCRIPTORS + (frame - 1) % self.slots * 256

    def mark(self, frame, complete):
        self.words.set_u64(self.descriptor(frame) + Descriptor.SEQUENCE, 2 * frame - (not complete))

    def values(self, frame):
        """The arrays of a frame: a row of particles that moves with -1.5 m/s."""
        n = self.options.particles
        still = array("f", bytes(4 * n))
        px = array("f", (100 - k * 0.5 - 1.5 * frame / 32 for k in range(n)))
        fluid = [array("f", [100.0]) * n, array("f", [-1.5]) * n, still, still, px, array("f", [0.25]) * n, still]
        person = [array("f", [0.25]) * n, array("f", [1.75]) * n, array("f", [frame % 3]) * n]
        push = [array("f", [2.5]) * n, still, array("f", [0.5]) * n, array("f", [0.75]) * n]
        return (fluid + person + push)[: len(self.names)]

    def count(self, _frame):
        return self.options.particles

    def tick(self, frame):
        return frame - (self.options.kind == "agents")

    def write_arrays(self, frame):
        slot = SLOTS + (frame - 1) % self.slots * self.slot_stride
        fields = [values.tobytes() for values in self.values(frame)]
        for i, data in enumerate(fields):
            self.words.bytes[slot + i * self.field_bytes : slot + i * self.field_bytes + len(data)] = data
        return fields

    def write_descriptor(self, frame, fields, flags):
        at = self.descriptor(frame)
        previous, self.chain = self.chain, self.next_chain(frame, fields[: self.required])
        self.words.set_u64(at + Descriptor.FRAME, frame)
        self.words.set_u64(at + Descriptor.TICK, self.tick(frame))
        self.words.set_u32(at + Descriptor.COUNT, self.count(frame))
        self.words.set_u32(at + Descriptor.FLAGS, flags)
        self.words.set_u64(at + Descriptor.HASH, self.chain)
        self.words.set_u64(at + Descriptor.PREVIOUS_HASH, previous)
        if fields[self.required :]:
            self.words.set_u64(at + Descriptor.FURTHER_HASH, self.further_hash(frame, fields[self.required :]))
        self.words.set_u32(at + Descriptor.CRC32C, self.descriptor_check(frame))

    def descriptor_check(self, frame):
        at = self.descriptor(frame)
        return descriptor_crc(self.words.bytes[at : at + Descriptor.BYTES])

    def further_hash(self, frame, fields):
        return chain(self.chain, frame, fields)

    def next_chain(self, frame, fields):
        return chain(self.chain, frame, fields)

    def publish(self, frame):
        self.words.set_u64(CONTROL + ControlPage.PUBLISHED_FRAME, frame)
        self.published = frame
        self.ring()

    def send(self, frame, final):
        self.mark(frame, False)
        fields = self.write_arrays(frame)
        self.write_descriptor(frame, fields, FINAL if final else 0)
        self.mark(frame, True)
        self.publish(frame)

    # The end.

    def close(self):
        self.enter(DRAINING)
        self.wait_for_acknowledgements(self.published, 0)
        self.end(CLOSED)

    def abort(self, code, text):
        self.words.set_i32(CONTROL + ControlPage.REASON_CODE, code)
        self.words.set_text(CONTROL + ControlPage.REASON_TEXT, 512, text)
        self.end(ABORTED)

    def end(self, state):
        self.enter(state)
        self.unlink()

    def unlink(self):
        if self.leads_to(self.fd):
            self.path.unlink()

    def exit_code(self, failure):
        return failure.code

    def play(self):
        """Plays the stream; the exit code."""
        try:
            self.wait_for_consumers()
            for frame in range(1, self.options.frames + 1):
                if not self.begin_frame(frame):
                    break
                self.send(frame, frame == self.options.frames)
            self.close()
            return 0
        except Failure as failure:
            self.abort(self.exit_code(failure), str(failure))
            print(failure, file=sys.stderr)
            return self.exit_code(failure)
