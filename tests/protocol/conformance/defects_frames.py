"""Defects of the frames and of their order in time; of the object: its creation, its header, its locks, its name."""

import os
import random
import time
from array import array

from python_producer import CONTROL, SLOTS, Failure, Publisher

from wade.conformance import system
from wade.conformance.layout import FINAL, HEADER_WORDS, PAGE, ControlPage, Descriptor, chain


class MagicFirst(Publisher):
    caught_by = "header"

    def store_header(self):
        page = self.header()
        self.words.bytes[0:8] = page[0:8]
        time.sleep(0.5)
        self.words.bytes[8:PAGE] = page[8:]


class WrongChecksum(Publisher):
    caught_by = "header"

    def header(self):
        page = bytearray(super().header())
        page[HEADER_WORDS["crc32c"][0]] ^= 1
        return bytes(page)


class FieldsOverlap(Publisher):
    caught_by = "header"

    def header(self):
        self.field_bytes -= 64
        page = super().header()
        self.field_bytes += 64
        return page


class SlotsBeyondTheFile(Publisher):
    caught_by = "header"

    def header(self):
        self.slots += 1
        page = super().header()
        self.slots -= 1
        return page


class OnlySized(Publisher):
    """Reserves no memory, so that a full /dev/shm would be a SIGBUS later."""

    caught_by = "header"

    def create(self):
        fd = super().create()
        os.ftruncate(fd, 0)
        os.ftruncate(fd, self.total_bytes)
        return fd


class ReadableByAll(Publisher):
    caught_by = "mode"
    permissions = 0o644


class NoLock(Publisher):
    caught_by = "lock"

    def take_lock(self, fd):
        if system.lock_byte(fd, 0):
            system.unlock_byte(fd, 0)
            return True
        return False


class PidOfAnother(Publisher):
    caught_by = "lock"

    def fill_control(self):
        super().fill_control()
        self.words.set_u32(CONTROL + ControlPage.PID, os.getppid())


class TakesALivingName(Publisher):
    caught_by = "exclusive"

    def remove_stale(self):
        self.path.unlink(missing_ok=True)


class RefusesAStaleName(Publisher):
    caught_by = "stale"

    def remove_stale(self):
        raise Failure(8, "There is an object of this name.")


class SkipsAFrame(Publisher):
    caught_by = "frames"

    def send(self, frame, final):
        if frame < 7:
            super().send(frame, final)
            return
        self.mark(frame, False)
        self.write_descriptor(frame, self.write_arrays(frame), FINAL if final else 0)
        self.words.set_u64(self.descriptor(frame) + Descriptor.FRAME, frame + 1)
        self.mark(frame, True)
        self.publish(frame)


class TickStandsStill(Publisher):
    caught_by = "frames"

    def tick(self, frame):
        return min(frame, 9)


class CountAboveCapacity(Publisher):
    caught_by = "frames"

    def count(self, frame):
        return self.options.particles + (frame == 5)


class AgentsComeAndGo(Publisher):
    """Leaves out agents; caught in streams of agents alone."""

    caught_by, kind = "frames", "agents"

    def count(self, frame):
        return self.options.particles - (frame > 3)


class NotANumber(Publisher):
    caught_by = "frames"

    def values(self, frame):
        values = super().values(frame)
        if frame == 6:
            values[5][3] = float("nan")
        return values


class CountsInMilliseconds(Publisher):
    """Its header says 32 ticks a second."""

    caught_by = "frames"

    def tick(self, frame):
        return frame * 1000 // 32


class NoCheckOfDescriptors(Publisher):
    caught_by = "descriptor_check"

    def descriptor_check(self, frame):
        return 0


class Massless(Publisher):
    caught_by = "plausible"
    mass = 0.0

    def values(self, frame):
        values = super().values(frame)
        values[0][7] = self.mass
        return values


class NegativeMass(Massless):
    caught_by = "plausible"
    mass = -100.0


class HugeMass(Massless):
    caught_by = "plausible"
    mass = 3e38


class NeverAnyWater(Publisher):
    caught_by = "plausible"

    def count(self, frame):
        return 0

    def write_arrays(self, frame):
        return [b""] * len(self.names)


class SwapsYAndZ(Publisher):
    """A wall of particles beside the bed, as high as the river is wide."""

    caught_by = "plausible"

    def values(self, frame):
        values = super().values(frame)
        for k in range(self.options.particles):
            values[5][k], values[6][k] = 20 + 0.4 * (k % 10), 0.25
        return values


class SendsMillimetres(Publisher):
    caught_by = "plausible"

    def values(self, frame):
        values = super().values(frame)
        for axis in (4, 5, 6):
            values[axis] = array("f", (1000 * v + k for k, v in enumerate(values[axis])))
        return values


class FarAway(Publisher):
    caught_by = "plausible"

    def values(self, frame):
        values = super().values(frame)
        values[4] = array("f", [1e6]) * self.options.particles
        return values


class OnePointACell(Publisher):
    """What owners of a depth-averaged code write first: cells of 1 m, 0.8 m deep, each a particle without width."""

    caught_by = "sampling"

    def values(self, frame):
        values = super().values(frame)
        for k in range(self.options.particles):
            values[0][k], values[4][k], values[6][k] = 800, k // 5, k % 5
        return values


class ColumnsNarrowerThanCells(OnePointACell):
    """Its columns do not meet."""

    caught_by = "sampling"
    column_width = (0.5, 0.5)


class ColumnsWiderThanCells(OnePointACell):
    """Its columns overlap, so that each has a fraction of the depth."""

    caught_by = "sampling"
    column_width = (1.5, 1.5)


class HashOfImpulsesAlone(Publisher):
    """Leaves the hash of the required fields out of that of the optional ones."""

    caught_by, kind = "impulses", "agents"

    def further_hash(self, frame, fields):
        return chain(0, frame, fields)


class PushesInTheDry(Publisher):
    caught_by, kind = "impulses", "agents"

    def values(self, frame):
        values = super().values(frame)
        values[self.required + 2][5] = 0.0
        return values


class SpreadsOverNothing(Publisher):
    caught_by, kind = "impulses", "agents"

    def values(self, frame):
        values = super().values(frame)
        values[self.required + 3][5] = 0.0
        return values


class HashOfThisFrameAlone(Publisher):
    caught_by = "hash_chain"

    def next_chain(self, frame, fields):
        self.chain = 0
        return super().next_chain(frame, fields)


class DoesNotCountUp(Publisher):
    """Wakes without counting publish_sequence up."""

    caught_by = "states"

    def ring(self):
        system.futex_wake_all(self.words.address(CONTROL + ControlPage.PUBLISH_SEQUENCE))


class PublishesBeforeWriting(Publisher):
    caught_by = "lockstep"

    def send(self, frame, final):
        self.write_descriptor(frame, [v.tobytes() for v in self.values(frame)], FINAL if final else 0)
        self.mark(frame, True)
        self.publish(frame)
        time.sleep(0.005)
        self.write_arrays(frame)


class IgnoresAcknowledgements(Publisher):
    caught_by = "depth"

    def wait_for_acknowledgements(self, owed, frame):
        time.sleep(0.01)
        return super().wait_for_acknowledgements(0 if frame else owed, frame)


class OneFrameTooFar(Publisher):
    """Runs one frame further ahead than the depth says."""

    caught_by = "lockstep"

    def wait_for_acknowledgements(self, owed, frame):
        return super().wait_for_acknowledgements(max(0, owed - 1) if frame else owed, frame)


class OverwritesAHeldFrame(Publisher):
    caught_by = "lockstep"

    def begin_frame(self, frame):
        if frame == 4:
            time.sleep(0.05)
            self.words.bytes[SLOTS + (frame - 2) % self.slots * self.slot_stride] ^= 1
        return super().begin_frame(frame)


class NeverMarksASlot(Publisher):
    caught_by = "write_mark"

    def mark(self, frame, complete):
        if complete:
            super().mark(frame, complete)

    def write_arrays(self, frame):
        fields = super().write_arrays(frame)
        time.sleep(0.003)
        return fields


class NeverWakes(Publisher):
    caught_by = "wake_up"

    def ring(self):
        at = CONTROL + ControlPage.PUBLISH_SEQUENCE
        self.words.set_u32(at, self.words.u32(at) + 1)


class NoHeartbeat(Publisher):
    caught_by = "heartbeat"

    def beat(self):
        if not self.published:
            super().beat()


class RandomValues(Publisher):
    caught_by = "repeat"

    def values(self, frame):
        values = super().values(frame)
        values[4][0] = random.random()
        return values


class ValuesFollowTheClock(Publisher):
    """Frames depend on how long the consumer took."""

    caught_by = "stalls"
    begun = 0.0

    def begin_frame(self, frame):
        begun = time.monotonic()
        goes_on = super().begin_frame(frame)
        self.slow = time.monotonic() - begun > 0.04
        return goes_on

    def values(self, frame):
        values = super().values(frame)
        values[4][0] += self.slow
        return values


class ValuesFollowStops(Publisher):
    """Frames depend on how long their computation took."""

    caught_by = "stops"

    def values(self, frame):
        begun = time.monotonic()
        time.sleep(0.002)
        values = super().values(frame)
        values[4][0] += time.monotonic() - begun > 0.04
        return values
