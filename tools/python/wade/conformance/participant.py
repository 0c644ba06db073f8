"""A participant that reads: an object of its own, and a consumer page if it joins."""

import hashlib
import os
from dataclasses import dataclass

from wade.conformance import system
from wade.conformance.expectation import PATIENCE_S, expect, wait_until
from wade.conformance.header_rules import read_header
from wade.conformance.layout import (FREE, GAVE_UP, JOINED, LATEST, LEFT, LOCKSTEP, PAGE, PRODUCER_STATES, ConsumerPage,
                                     ControlPage, Descriptor, text_of)


@dataclass
class Frame:
    """A private copy of a frame; fields: bytes of the required fields in the order of the hash chain."""

    sequence: int
    frame: int
    tick: int
    count: int
    flags: int
    hash: int
    previous_hash: int
    fields: list

    def digest(self):
        """Equal for frames with equal bits; has nothing to do with the hash chain."""
        return hashlib.blake2b(b"".join(self.fields), digest_size=12).hexdigest()


class Segment:
    """An open object of a living producer, its header checked, all of it mapped read-only."""

    def __init__(self, path, kind):
        self.path, self.kind = path, kind
        self.fd = os.open(path, os.O_RDWR | os.O_CLOEXEC)
        try:
            about = os.fstat(self.fd)
            self.inode = about.st_ino
            self.header = read_header(os.pread(self.fd, PAGE, 0), about.st_size, kind)
        except BaseException:
            os.close(self.fd)
            raise
        self.words = system.Words(self.fd, 0, self.header.total_bytes, False)

    def close(self):
        if self.fd >= 0:
            os.close(self.fd)
            self.fd = -1

    def control(self, offset):
        """A 32-bit word of the control page."""
        return self.words.u32(self.header.control_offset + offset)

    def control64(self, offset):
        return self.words.u64(self.header.control_offset + offset)

    def state(self):
        return self.control(ControlPage.STATE)

    def published(self):
        return self.control64(ControlPage.PUBLISHED_FRAME)

    def reason_bytes(self):
        """The room of the reason text in the control page."""
        at = self.header.control_offset + ControlPage.REASON_TEXT
        return bytes(self.words.bytes[at : at + ControlPage.REASON_BYTES])

    def reason(self):
        """Reason code and text of the control page."""
        return self.words.i32(self.header.control_offset + ControlPage.REASON_CODE), text_of(self.reason_bytes())

    def sequence(self, frame):
        return self.words.u64(self.header.descriptor(frame) + Descriptor.SEQUENCE)

    def raw(self, frame):
        """All bytes of the slot and the descriptor of a frame."""
        slot, descriptor = self.header.slot(frame), self.header.descriptor(frame)
        return (bytes(self.words.bytes[slot : slot + self.header.slot_stride]) +
                bytes(self.words.bytes[descriptor : descriptor + self.header.descriptor_stride]))

    def copy(self, frame):
        """A copy of what lies in the slot of a frame now."""
        at = self.header.descriptor(frame)
        sequence = self.words.u64(at + Descriptor.SEQUENCE)
        number, tick = self.words.u64(at + Descriptor.FRAME), self.words.u64(at + Descriptor.TICK)
        count, flags = self.words.u32(at + Descriptor.COUNT), self.words.u32(at + Descriptor.FLAGS)
        hashes = self.words.u64(at + Descriptor.HASH), self.words.u64(at + Descriptor.PREVIOUS_HASH)
        fields = self.arrays(frame, count, self.header.required_fields())
        return Frame(sequence, number, tick, count, flags, *hashes, fields)

    def arrays(self, frame, count, entries):
        """Copies of these fields of a frame, as bytes."""
        slot, size = self.header.slot(frame), 4 * min(count, self.header.capacity)
        return [bytes(self.words.bytes[slot + entry.offset : slot + entry.offset + size]) for entry in entries]

    def producer_lives(self):
        return system.is_locked_by_other(self.fd, 0)

    def situation(self):
        """Where the producer stands, for messages."""
        state = self.state()
        name = PRODUCER_STATES[state] if state < len(PRODUCER_STATES) else str(state)
        code, text = self.reason()
        return f"the producer is {name} at published_frame {self.published()}" + (f" ({code}: {text})" if text else "")


class Consumer(Segment):
    """A consumer in any mode; takes frames one by one, in order."""

    def __init__(self, path, kind, name="conformance", mode=LOCKSTEP, flags=0, paused=False, patience_s=PATIENCE_S,
                 over=None):
        super().__init__(path, kind)
        self.patience_s, self.over = patience_s, over
        self.index = wait_until(self._claim, "a free consumer page can be taken", self.situation, patience_s, over) - 1
        self.page = system.Words(self.fd, self.header.consumer(self.index), PAGE, True)
        self.doorbell = system.Words(self.fd, self.header.doorbell_offset, PAGE, True)
        self.control_page = system.Words(self.fd, self.header.control_offset, PAGE, True)  # its addresses alone
        self.next, self.first, self.acknowledged = 0, 0, 0
        self._fill(name, mode, flags, paused)
        self.published_at_join = self.published()
        self.page.set_u32(ConsumerPage.STATE, JOINED)
        self.ring()

    def _claim(self):
        """Takes the lock of a page that is free; its number from 1 on, or 0."""
        for i in range(self.header.consumer_count):
            if self._is_free(i) and system.lock_byte(self.fd, 1 + i):
                if self._is_free(i):
                    return i + 1
                system.unlock_byte(self.fd, 1 + i)
        return 0

    def _is_free(self, i):
        page = self.header.consumer(i)
        state = self.words.u32(page + ConsumerPage.STATE)
        rested = state == FREE or self.published() > self.words.u64(page + ConsumerPage.LEFT_AT_FRAME)
        return state != JOINED and rested and self.control64(ControlPage.ADMITTED_FRAME + 8 * i) == 0

    def _fill(self, name, mode, flags, paused):
        page = self.page
        page.set_u64(ConsumerPage.ACKNOWLEDGED_FRAME, 0)
        page.set_u32(ConsumerPage.WAITING, 0)
        page.set_u32(ConsumerPage.MODE, mode)
        page.set_u32(ConsumerPage.STRIDE, 1)
        page.set_u64(ConsumerPage.DROPPED_FRAMES, 0)
        page.set_u64(ConsumerPage.START_TIME, system.start_time(os.getpid()))
        page.set_u32(ConsumerPage.PID, os.getpid())
        page.set_u32(ConsumerPage.PAUSED, int(paused))
        page.set_u32(ConsumerPage.FLAGS, flags)
        page.set_u64(ConsumerPage.LEFT_AT_FRAME, 2**64 - 1)
        page.set_text(ConsumerPage.NAME, ConsumerPage.NAME_BYTES, name)
        page.set_i32(ConsumerPage.REASON_CODE, 0)
        page.set_text(ConsumerPage.REASON_TEXT, ConsumerPage.REASON_BYTES, "")
        self.beat()

    def beat(self):
        self.page.set_u64(ConsumerPage.HEARTBEAT_NS, system.monotonic_ns())

    def ring(self):
        self.doorbell.set_u32(0, self.doorbell.u32(0) + 1)
        system.fence()
        if self.control(ControlPage.PRODUCER_WAITING):
            system.futex_wake_all(self.doorbell.address(0))

    def admitted(self):
        return self.control64(ControlPage.ADMITTED_FRAME + 8 * self.index)

    def wait(self, condition, contract):
        return wait_until(condition, contract, self.situation, self.patience_s, self.over)

    def wait_for_admission(self):
        """The first frame of this consumer."""
        if not self.next:
            self.next = self.first = self.wait(self.admitted,
                                               "the producer answers a consumer that joined with its admitted_frame")
        return self.first

    def available(self):
        """Whether the next frame is complete."""
        if not self.next and self.admitted():
            self.wait_for_admission()
        return bool(self.next) and self.published() >= self.next

    def take(self):
        """Waits for the next frame and returns a copy of it; it is held until release()."""
        self.wait_for_admission()
        self.wait(self.available, f"frame {self.next} follows when all frames before it are acknowledged")
        frame = self.copy(self.next)
        expect(frame.sequence == 2 * self.next and frame.frame == self.next,
               f"published frame {self.next} lies in its slot with sequence {2 * self.next}",
               f"frame {frame.frame} with sequence {frame.sequence}")
        expect(frame.count <= self.header.capacity, f"a frame has at most capacity = {self.header.capacity} particles",
               f"frame {frame.frame} has {frame.count}")
        return frame

    def release(self):
        """Acknowledges the frame that take() gave."""
        now = self.sequence(self.next)
        expect(now == 2 * self.next, f"frame {self.next} is not touched while it is held", f"its sequence is {now}")
        self.acknowledge(self.next)
        self.next += 1

    def acknowledge(self, frame):
        self.beat()
        self.acknowledged = frame
        self.page.set_u64(ConsumerPage.ACKNOWLEDGED_FRAME, frame)
        self.ring()

    def at_end(self):
        """Whether all frames were acknowledged and no other will come."""
        return self.state() >= 3 and bool(self.next) and self.next > self.published()

    def leave(self):
        self._part(LEFT)

    def abort(self, code, text):
        self.page.set_i32(ConsumerPage.REASON_CODE, code)
        self.page.set_text(ConsumerPage.REASON_TEXT, ConsumerPage.REASON_BYTES, text)
        self._part(GAVE_UP)

    def _part(self, state):
        if self.page.u32(ConsumerPage.STATE) == JOINED:
            self.page.set_u32(ConsumerPage.STATE, state)
            self.ring()
            self.page.set_u64(ConsumerPage.LEFT_AT_FRAME, self.published())
            system.unlock_byte(self.fd, 1 + self.index)
            self.ring()  # the goodbye counts once the lock is free


class LatestReader(Consumer):
    """A free-running reader: takes the newest complete frame, never holds one."""

    def __init__(self, path, kind, **options):
        super().__init__(path, kind, mode=LATEST, **options)
        self.torn = 0

    def poll(self):
        """A copy of the newest complete frame, or None if it was overwritten meanwhile or there is none yet."""
        newest = self.published()
        if not newest:
            return None
        frame = self.copy(newest)
        if frame.sequence != 2 * newest or self.sequence(newest) != 2 * newest:
            self.torn += 1
            return None
        return frame
