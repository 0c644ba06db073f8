"""Checks of the frames that a single consumer in lockstep sees."""

import math
import threading
import time

from wade.conformance import system
from wade.conformance.bench import FRAMES, follow
from wade.conformance.expectation import NotApplicable, expect
from wade.conformance.layout import (CHECKED_MINOR, FINAL, KINDS, NONFINITE, READY, RUNNING, SLICE_S, ConsumerPage,
                                     ControlPage, Descriptor, chain, descriptor_crc)

LONG_HOLD_S = 5 * SLICE_S


def frames(bench):
    """Frames 1 .. n come in order, with rising ticks, sound counts and flags, and finite values."""
    consumer = bench.start().join()
    expect(consumer.wait_for_admission() == 1, "who joins before frame 1 gets it", f"admitted at {consumer.first}")
    last_tick = 0 if consumer.header.version_minor == 0 else -1
    counts, seen = set(), 0
    if consumer.kind == KINDS["fluid"]:
        shortest, longest = consumer.header.ticks_per_frame / 1000, 8 * consumer.header.ticks_per_frame
    else:
        shortest, longest = 0, 2**64  # agents have the ticks of their water
    while seen < 2 * FRAMES and not consumer.at_end():
        frame = consumer.take()
        expect(frame.tick > last_tick, f"the tick of frame {frame.frame} is above the one before, {last_tick}",
               f"{frame.tick}")
        if seen and consumer.header.version_minor >= CHECKED_MINOR:
            lasted = frame.tick - last_tick
            expect(lasted <= longest and (lasted >= shortest or frame.flags & FINAL),
                   f"a frame lasts 1/1000 to 8 times ticks_per_frame = {consumer.header.ticks_per_frame}",
                   f"frame {frame.frame} lasts {lasted} ticks")
        expect(frame.flags & ~(FINAL | NONFINITE) == 0, "flags are final (1) and non-finite (2)", f"{frame.flags}")
        expect_finite(consumer, frame)
        if consumer.kind == KINDS["agents"]:
            expect_agents(consumer, frame, counts)
        last_tick = frame.tick
        counts.add(frame.count)
        seen += 1
        consumer.release()
    expect(seen == 2 * FRAMES, f"the suite needs a stream of {2 * FRAMES} frames", f"it ended after {seen}")
    return f"{seen} frames, {min(counts)} .. {max(counts)} particles, last tick {last_tick}"


def expect_agents(consumer, frame, counts):
    """What holds for streams of agents alone."""
    time_of_frame = (frame.frame - 1) * consumer.header.ticks_per_frame
    expect(frame.tick == time_of_frame, f"agents frame {frame.frame} has tick {time_of_frame}", f"{frame.tick}")
    expect(counts <= {frame.count}, f"all {counts} agents are in every frame", f"{frame.count}")
    states_seen = set(memoryview(frame.fields[-1]).cast("f"))
    expect(states_seen <= {0, 1, 2}, "the field state is 0 (walking), 1 (arrived) or 2 (dead)", f"{states_seen}")


def expect_finite(consumer, frame):
    """All values are finite, and none is marked as not."""
    expect(not frame.flags & NONFINITE, f"frame {frame.frame} holds finite values", "its flag says otherwise")
    for entry, data in zip(consumer.header.required_fields(), frame.fields):
        values = memoryview(data).cast("f")
        if not all(map(math.isfinite, values)):
            bad = next(k for k, value in enumerate(values) if not math.isfinite(value))
            expect(False, f"frame {frame.frame} holds finite values", f"{entry.name}[{bad}] = {values[bad]}")


def descriptor_check(bench):
    """Each descriptor has the CRC-32C of its bytes."""
    consumer = bench.start().join()
    if consumer.header.version_minor < CHECKED_MINOR:
        raise NotApplicable("the producer speaks 1.1 or 1.0, the check of a descriptor came with 1.2")
    count = 0
    while count < 2 * FRAMES and not consumer.at_end():
        frame = consumer.take()
        at = consumer.header.descriptor(frame.frame)
        own = descriptor_crc(consumer.words.bytes[at : at + Descriptor.BYTES])
        given = consumer.words.u32(at + Descriptor.CRC32C)
        expect(given == own, f"crc32c (offset 48) of frame {frame.frame} is that of bytes 8 .. 255, {own}", f"{given}")
        count += 1
        consumer.release()
    return f"{count} descriptors"


def impulses(bench):
    """What people do to the water: finite, nothing in the dry, a spread above 0 in the water, further_hash that of the fields."""
    consumer = bench.start().join()
    entries = consumer.header.impulse_fields()
    if not entries:
        raise NotApplicable("the stream has no impulses")
    count, pushed = 0, 0
    while count < 2 * FRAMES and not consumer.at_end():
        frame = consumer.take()
        fields = consumer.arrays(frame.frame, frame.count, entries)
        own = chain(frame.hash, frame.frame, fields)
        given = consumer.words.u64(consumer.header.descriptor(frame.frame) + Descriptor.FURTHER_HASH)
        expect(given in (0, own), f"further_hash (offset 56) of frame {frame.frame} is {own:016x}, or 0", f"{given:016x}")
        for k, (jx, jz, submerged, spread) in enumerate(zip(*(memoryview(field).cast("f") for field in fields))):
            values = f"jx {jx}, jz {jz}, submerged {submerged}, spread {spread}"
            who = f"agent {k} of frame {frame.frame}"
            expect(all(map(math.isfinite, (jx, jz, submerged, spread))), f"{who} has finite values", values)
            expect(submerged >= 0 and spread >= 0, f"{who} has no negative depth or spread", values)
            expect(submerged > 0 or jx == jz == 0, f"{who} gives the water nothing where it stands in none", values)
            expect(jx == jz == 0 or spread > 0, f"{who} spreads its impulse", values)
            pushed += jx != 0 or jz != 0
        count += 1
        consumer.release()
    return f"{pushed} impulses in {count} frames"


def hash_chain(bench):
    """The hash of each frame is the chain over all frames so far, previous_hash the one before."""
    consumer = bench.start().join()
    own, values, count = 0, 0, 0
    while count < 2 * FRAMES and values < 3_000_000 and not consumer.at_end():
        frame = consumer.take()
        if frame.hash == 0:
            raise NotApplicable("the producer gives no hash")
        expect(frame.previous_hash == own, f"previous_hash of frame {frame.frame} is {own:016x}",
               f"{frame.previous_hash:016x}")
        own = chain(own, frame.frame, frame.fields)
        expect(frame.hash == own, f"the hash of frame {frame.frame} is {own:016x}", f"{frame.hash:016x}")
        values += len(frame.fields) * frame.count
        count += 1
        consumer.release()
    return f"{own:016x} at frame {count}"


def states(bench):
    """The producer goes from ready to running, and counts publish_sequence up at every event."""
    run = bench.start()
    segment = run.look()
    expect(segment.state() == READY, "a producer whose magic is stored is ready (1)", segment.situation)
    before = segment.control(ControlPage.PUBLISH_SEQUENCE)
    consumer = run.join()
    consumer.take()
    expect(segment.state() >= RUNNING, "the state is running (2) once frame 1 was begun", segment.situation)
    consumer.wait(lambda: segment.control(ControlPage.PUBLISH_SEQUENCE) - before & 0xFFFFFFFF >= 3,
                  "publish_sequence counts the admission, the change to running and frame 1: at least 3 more")
    consumer.release()
    for _ in range(FRAMES):
        taken = consumer.next
        consumer.take()
        # The lead is over: the producer has done all it may do and waits.
        before = segment.control(ControlPage.PUBLISH_SEQUENCE)
        published = segment.published()
        consumer.release()
        consumer.wait(lambda: segment.published() > max(published, taken), "the next frame follows")
        after = segment.control(ControlPage.PUBLISH_SEQUENCE)
        if after == before:  # published_frame is stored a moment before the word
            consumer.wait(lambda: segment.control(ControlPage.PUBLISH_SEQUENCE) != before,
                          "publish_sequence counts every publication")
    return f"publish_sequence {segment.control(ControlPage.PUBLISH_SEQUENCE)} at frame {segment.published()}"


def lockstep(bench):
    """While a consumer holds frame k, nothing beyond k - 1 + depth is published and no byte of frame k changes."""
    consumer = bench.start().join()
    depth, holds = consumer.header.depth, 0
    for number in range(1, FRAMES + 1):
        frame = consumer.take()
        before = consumer.raw(frame.frame)
        end = time.monotonic() + (LONG_HOLD_S if number in (1, 2, depth + 2) else 0.002)
        while True:
            published = consumer.published()
            expect(published <= frame.frame - 1 + depth,
                   f"with frame {frame.frame} held, published_frame stays up to {frame.frame - 1 + depth}",
                   f"{published}")
            expect(consumer.raw(frame.frame) == before, f"frame {frame.frame} does not change while it is held",
                   "bytes of its slot or descriptor changed")
            holds += 1
            if time.monotonic() > end:
                break
            time.sleep(0.001)
        consumer.release()
    return f"{FRAMES} frames held, {holds} looks, three holds of {LONG_HOLD_S / SLICE_S:g} slices"


def depth(bench):
    """The producer is never further ahead of the slowest acknowledgement than the depth of the header."""
    consumer = bench.start().join()
    lead, allowed = 0, consumer.header.depth
    for number in range(1, FRAMES + 1):
        consumer.take()
        end = time.monotonic() + (3 * SLICE_S if number % 4 == 0 else 0)  # time to run ahead
        while True:
            ahead = consumer.published() - consumer.acknowledged
            expect(ahead <= allowed, f"at most depth = {allowed} frames are published beyond the acknowledged one",
                   f"{ahead} beyond frame {consumer.acknowledged}")
            lead = max(lead, ahead)
            if time.monotonic() > end:
                break
            time.sleep(0.001)
        consumer.release()
    return f"depth {allowed}, largest lead {lead}"


def write_mark(bench):
    """A slot changes only while its sequence is odd, so that a reader detects a torn copy by a second look."""
    run = bench.start()
    consumer = run.join()
    with system.apart_from(run.pid()):
        number, looks, caught = watch_slots(consumer)
    return f"{number} frames, {looks} looks, {caught} of them at a slot in the middle of a change"


def watch_slots(consumer):
    """Looks at slots while they are written; (frames, looks, looks that fell into a change)."""
    looks = caught = number = 0
    while number < 2 * FRAMES and caught < FRAMES and not consumer.at_end():
        consumer.take()
        number += 1
        let_run_ahead(consumer, SLICE_S)
        coming = consumer.published() + 1  # what it writes once this frame is released
        before, sequence = beginnings(consumer, coming), consumer.sequence(coming)
        consumer.release()
        while consumer.published() < coming and not consumer.at_end():
            looks += 1
            changed = beginnings(consumer, coming) != before
            now = consumer.sequence(coming)  # after the look at the bytes
            caught += changed and now == 2 * coming - 1
            expect(not changed or now != sequence or sequence == 2 * coming - 1,
                   f"sequence is {2 * coming - 1} before the first byte of frame {coming} is written",
                   f"the slot changed under sequence {now}")
            expect(now in (sequence, 2 * coming - 1, 2 * coming),
                   f"sequence goes {sequence}, {2 * coming - 1}, {2 * coming}", f"{now}")
            if looks % 100 == 0 and consumer.over():
                consumer.wait(lambda: False, "the next frame follows")
    return number, looks, caught


def beginnings(consumer, frame):
    """The first values of each array in the slot of a frame: enough to see that it is written, and quick to read."""
    slot, raw = consumer.header.slot(frame), consumer.words.bytes
    return [raw[slot + e.offset : slot + e.offset + 64].tobytes() for e in consumer.header.required_fields()]


def let_run_ahead(consumer, patience_s):
    """Gives the producer time to publish all that it may."""
    end = time.monotonic() + patience_s
    while consumer.published() - consumer.acknowledged < consumer.header.depth and time.monotonic() < end:
        time.sleep(0.001)


def wake_up(bench):
    """A consumer that sleeps on publish_sequence is woken when its frame is published."""
    run = bench.start()
    consumer = run.join()
    outcomes = {"woken": 0, "changed": 0, "timeout": 0}
    consumer.take()
    for number in range(1, 9):
        run.stop()  # the producer stands still until the consumer is surely asleep
        consumer.release()
        while consumer.available():
            consumer.take()
            consumer.release()
        asleep = threading.Event()

        def go_on(asleep=asleep):
            asleep.wait()
            time.sleep(0.02)
            run.go_on()

        helper = threading.Thread(target=go_on)
        helper.start()
        sleep_until_available(consumer, outcomes, asleep)
        helper.join()
        consumer.take()
        if outcomes["timeout"] >= 3 and not outcomes["woken"]:
            break
    expect(outcomes["woken"] > outcomes["timeout"],
           "who has set its waiting word is woken by futex (without the PRIVATE flag) on publish_sequence",
           f"{sum(outcomes.values())} waits: {outcomes}")
    return f"{number} frames, {outcomes['woken']} waits woken, {outcomes['timeout']} by time-out"


def sleep_until_available(consumer, outcomes, asleep):
    """Waits for the next frame as the contract says, with long slices; counts how the waits end, tells the first."""
    word = ControlPage.PUBLISH_SEQUENCE
    address = consumer.control_page.address(word)
    consumer.page.set_u32(ConsumerPage.WAITING, 1)
    while not consumer.over():
        system.fence()
        seen = consumer.control(word)
        if consumer.available():
            break
        asleep.set()
        outcomes[system.futex_wait(address, seen, 1.0)] += 1
    asleep.set()
    consumer.page.set_u32(ConsumerPage.WAITING, 0)


def heartbeat(bench):
    """The heartbeat is a time of CLOCK_MONOTONIC and goes on while the producer waits for a consumer."""
    consumer = bench.start().join()
    follow([consumer], 3)
    consumer.take()
    time.sleep(LONG_HOLD_S)  # by now it has published all that it may
    beats = []
    for _ in range(3):
        beat = consumer.control64(ControlPage.HEARTBEAT_NS)
        expect(0 < beat <= system.monotonic_ns(), "heartbeat_ns is a time of CLOCK_MONOTONIC that has been", f"{beat}")
        beats.append(beat)
        consumer.wait(lambda beat=beat: consumer.control64(ControlPage.HEARTBEAT_NS) > beat,
                      "the heartbeat goes on while the producer waits")
    return f"{(beats[-1] - beats[0]) / 2e6:.0f} ms between beats"


ALL = (frames, descriptor_check, impulses, hash_chain, states, lockstep, depth, write_mark, wake_up, heartbeat)
