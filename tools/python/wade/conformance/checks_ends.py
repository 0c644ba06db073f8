"""Checks of how a stream ends, well and badly."""

import signal
import time

from wade.conformance import system
from wade.conformance.bench import FRAMES, follow, holding
from wade.conformance.checks_consumers import together
from wade.conformance.checks_object import expect_aborted
from wade.conformance.child import start_child
from wade.conformance.expectation import NotApplicable, expect
from wade.conformance.layout import (CHECKED_MINOR, CLOSED, DRAINING, FINAL, FOLLOWS, FREE, GAVE_UP, LATEST, LEFT,
                                     RUNNING, SLICE_S, ConsumerPage)

STEP_TIMEOUT_S = 1.0


def end(bench):
    """The last frame is final or followed by draining; then come acknowledgement, closed, unlinked, exit code 0."""
    run = bench.start()
    consumer = run.join()
    final = False
    while not consumer.at_end():
        consumer.wait(lambda: consumer.available() or consumer.at_end(), "a frame or the end of the stream follows")
        if not consumer.available():
            break
        frame = consumer.take()
        expect(not final, "no frame follows the final one", f"frame {frame.frame}")
        final = bool(frame.flags & FINAL)
        if final:
            hold_last(run, consumer)
        consumer.release()
    consumer.leave()
    run.expect_end(0, "a producer whose last frame is acknowledged closes")
    expect(consumer.state() == CLOSED, "the state is closed (4) at last", consumer.situation)
    return f"{consumer.published()} frames, the last one {'final' if final else 'not marked'}"


def hold_last(run, consumer):
    """Whoever holds the final frame keeps the producer from closing."""
    consumer.wait(lambda: consumer.state() >= DRAINING, "the state is draining (3) after the final frame")
    expect_meanwhile(
        4 * SLICE_S, lambda: consumer.state() == DRAINING and run.code() is None and run.has_name(),
        "the producer drains until the final frame is acknowledged",
        lambda: run.over() or f"{consumer.situation()}, the name {'is there' if run.has_name() else 'is gone'}")


def all_leave(bench):
    """When all consumers have left, the producer closes, unlinks its object and ends with 0."""
    run = bench.start()
    first, second = together(run, 2)
    follow([first, second], 5)
    first.leave()
    second.take()  # leaves in the middle of a frame
    second.leave()
    run.expect_end(0, "a producer drains when all consumers in lockstep have left")
    expect(second.state() == CLOSED, "the state is closed (4) at last", second.situation)
    return f"left at frame {second.next}"


def consumer_aborts(bench):
    """When a consumer gives up, the producer stops with exit code 5 and tells the others why."""
    run = bench.start()
    stays, quits = together(run, 2)
    follow([stays, quits], 3)
    quits.take()
    quits.abort(1, "The conformance suite gives up on purpose.")
    run.expect_end(5, "a producer stops when a consumer in lockstep gives up")
    expect_aborted(stays, 5)
    return f"'{stays.reason()[1]}'"


def hostile_texts(bench):
    """Texts of a consumer without an end and with control characters do not spoil the producer's own."""
    run, consumer = holding(bench, 3)
    page, control_characters = consumer.page, bytes(range(1, 32)) + b"\x7f"
    for at, room in (ConsumerPage.NAME, ConsumerPage.NAME_BYTES), (ConsumerPage.REASON_TEXT, ConsumerPage.REASON_BYTES):
        page.bytes[at : at + room] = (control_characters + b"x" * room)[:room]
    page.set_u32(ConsumerPage.STATE, GAVE_UP)
    consumer.ring()
    run.expect_end(5, "a producer stops when a consumer in lockstep gives up")
    expect_aborted(consumer, 5)
    room = consumer.reason_bytes()
    expect(0 in room, "Control.reason_text ends with a zero within its 512 bytes", "it has no end")
    for where, text in ("Control.reason_text", room.split(b"\0")[0]), ("its messages", run.message_bytes()):
        bad = sorted(set(text) & set(control_characters) - set(b"\r\n\t"))
        expect(not bad, f"control characters of a consumer's texts are replaced in {where}", f"{bytes(bad)}")
    return f"reason of {len(consumer.reason()[1])} characters"


def consumer_killed(bench):
    """When a consumer that holds a frame is killed, the producer stops with exit code 4."""
    return killed(bench, 3)


def consumer_killed_at_end(bench):
    """When a consumer that holds the final frame is killed, the producer stops with exit code 4."""
    return killed(bench, "all")


def killed(bench, frames):
    run = bench.start()
    segment = run.look()
    with start_child(run, "to-be-killed", frames=frames) as child:
        if frames == "all" and not child.final:
            raise NotApplicable("the producer does not mark its last frame as final")
        time.sleep(2 * SLICE_S)
        expect(not run.over(), "the producer waits for a consumer that lives", run.over)
        child.kill()
        run.expect_end(4, "a consumer whose lock is free without a goodbye is dead")
        expect_aborted(segment, 4)
        return f"killed at frame {child.at}: '{segment.reason()[1]}'"


def false_acknowledgement(bench):
    """An acknowledgement of a frame that was not published ends the producer with exit code 6."""
    run, consumer = holding(bench, 2)
    consumer.acknowledge(consumer.published() + 1_000_000)
    run.expect_end(6, "no acknowledgement goes beyond what was published")
    expect_aborted(consumer, 6)
    return f"'{consumer.reason()[1]}'"


def overwritten_words(bench):
    """The producer ends with exit code 6 if the mode, flags or state of a consumer was overwritten."""
    for name, offset, value in (
        ("mode", ConsumerPage.MODE, LATEST), ("flags", ConsumerPage.FLAGS, FOLLOWS),
        ("state", ConsumerPage.STATE, FREE),
    ):
        run = bench.start()
        consumer = run.join()
        demand_checked(consumer)
        follow([consumer], 2)
        consumer.page.set_u32(offset, value)
        consumer.ring()
        run.expect_end(6, f"the {name} of a consumer in lockstep stays what it was at its admission")
        expect_aborted(consumer, 6)
    return "mode, flags, state"


def false_goodbye(bench):
    """A goodbye counts once the lock is free: another process may have written the state alone."""
    run, consumer = holding(bench, 2)
    demand_checked(consumer)
    consumer.page.set_u32(ConsumerPage.STATE, LEFT)
    consumer.ring()
    bound = consumer.published() + consumer.header.depth
    expect_meanwhile(
        4 * SLICE_S, lambda: run.code() is None and consumer.state() == RUNNING and consumer.published() <= bound,
        "a consumer that holds its lock is waited for", lambda: run.over() or consumer.situation())
    system.unlock_byte(consumer.fd, 1 + consumer.index)
    consumer.ring()
    run.expect_end(0, "a producer drains when all consumers have left")
    return f"held at frame {consumer.next}"


def demand_checked(consumer):
    if consumer.header.version_minor < CHECKED_MINOR:
        raise NotApplicable("the producer speaks 1.1 or 1.0, this rule came with 1.2")


def expect_meanwhile(seconds, holds, contract, seen):
    """Something holds for all of a while."""
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline:
        expect(holds(), contract, seen)
        time.sleep(0.01)


def sigterm(bench):
    """SIGTERM ends the producer with 143; its consumers learn that it gave up, and why."""
    return signalled(bench, signal.SIGTERM, 143)


def sigint(bench):
    """SIGINT ends the producer with 130; its consumers learn that it gave up, and why."""
    return signalled(bench, signal.SIGINT, 130)


def signalled(bench, number, code):
    run, consumer = holding(bench, 3)
    run.send(number)
    run.expect_end(code, f"a producer that gets {number.name} stops")
    expect_aborted(consumer, code, 130)  # 130 stands for every request to stop
    return f"'{consumer.reason()[1]}'"


def signal_before(bench):
    """SIGTERM ends a producer that still waits for its first consumer with 143."""
    run = bench.start()
    segment = run.look()
    time.sleep(2 * SLICE_S)
    run.send(signal.SIGTERM)
    run.expect_end(143, "a producer that gets SIGTERM stops")
    expect_aborted(segment, 143, 130)
    return f"'{segment.reason()[1]}'"


def step_timeout(bench):
    """A consumer that lives but does not go on is given up with exit code 7."""
    run = bench.with_step_timeout(STEP_TIMEOUT_S)
    consumer = run.join()  # and acknowledges nothing
    run.expect_end(7, "the step time-out of a living consumer ends the producer")
    expect_aborted(consumer, 7)
    return f"'{consumer.reason()[1]}'"


def paused_consumer(bench):
    """While a consumer pauses on purpose, the producer does not count its step time-out."""
    run = bench.with_step_timeout(STEP_TIMEOUT_S)
    consumer = run.join(paused=True)
    if consumer.header.version_minor == 0:
        raise NotApplicable("the producer speaks 1.0, the paused word came with 1.1")
    consumer.take()
    deadline = time.monotonic() + 2.5 * STEP_TIMEOUT_S
    while time.monotonic() < deadline:
        consumer.beat()
        expect(not run.over(), "a consumer whose paused word is 1 does not use up the step time-out", run.over)
        time.sleep(0.02)
    count = len(follow([consumer], FRAMES)[0])
    consumer.page.set_u32(ConsumerPage.PAUSED, 0)
    consumer.leave()
    run.expect_end(0, "a producer drains when all consumers have left")
    return f"{count} frames after a pause of 2.5 time-outs"


ALL = (end, all_leave, consumer_aborts, hostile_texts, consumer_killed, consumer_killed_at_end, false_acknowledgement,
       overwritten_words, false_goodbye, sigterm, sigint, signal_before, step_timeout, paused_consumer)
