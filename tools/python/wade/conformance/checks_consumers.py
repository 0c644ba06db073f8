"""Checks with several consumers: joining, leaving, following, reading the latest."""

import random
import time

from wade.conformance import system
from wade.conformance.bench import FRAMES, follow
from wade.conformance.child import start_child
from wade.conformance.expectation import NotApplicable, expect
from wade.conformance.layout import FOLLOWS, LATEST, SLICE_S, ControlPage, chain
from wade.conformance.participant import LatestReader


def together(run, count):
    """Consumers in lockstep, all of them admitted; the frames that it took to admit them are done."""
    consumers = [run.join(f"conformance-{i}") for i in range(count)]
    expect_all_admitted(consumers)
    return consumers


def expect_all_admitted(consumers):
    """Takes frames with the admitted consumers until all are admitted."""
    waiting = list(consumers)
    while waiting:
        consumers[0].wait(lambda: any(c.available() for c in consumers) or all(c.admitted() for c in waiting),
                          "every consumer that joined is admitted at the beginning of a frame")
        waiting = [c for c in waiting if not c.admitted()]
        if waiting:
            for consumer in consumers:
                if consumer not in waiting and consumer.available():
                    consumer.take()
                    consumer.release()
    for consumer in consumers:
        consumer.wait_for_admission()


def expect_same(seen):
    """All consumers saw the same bits in the frames that they have in common."""
    common = set.intersection(*(set(digests) for digests in seen))
    expect(common, "the consumers take part in the same frames", "no frame in common")
    for frame in sorted(common):
        expect(len({digests[frame] for digests in seen}) == 1, f"all consumers see the same bits of frame {frame}",
               "different ones")
    return len(common)


def expect_waited_for(holder, others, bound):
    """The others go on as far as they can for some slices; nothing beyond frame `bound` may be published."""
    end = time.monotonic() + 4 * SLICE_S
    while time.monotonic() < end:
        for consumer in others:
            if consumer.available():
                consumer.take()
                consumer.release()
        expect(holder.published() <= bound, f"the producer waits for every consumer, here with frame {bound}",
               f"frame {holder.published()} was published")
        time.sleep(0.001)


def several(bench, count):
    """The body of the checks with many consumers: the first is slow, the others take what they can get."""
    run = bench.start()
    slow, *fast = consumers = together(run, count)
    seen = [{} for _ in consumers]
    numbers = random.Random(count)
    release_at = [None]
    lead = [0]

    def note(consumer):
        frame = consumer.take()
        seen[consumers.index(consumer)][frame.frame] = frame.digest()

    def go_on():
        """What can be done now; whether the slow one has seen enough."""
        for consumer in fast:
            if consumer.available():
                note(consumer)
                consumer.release()
        ahead = slow.published() - max(slow.acknowledged, slow.first - 1)
        lead[0] = max(lead[0], ahead)
        expect(ahead <= slow.header.depth, "the producer waits for the slowest consumer",
               f"{ahead} frames ahead of it with depth {slow.header.depth}")
        if release_at[0] is None and slow.available():
            note(slow)
            release_at[0] = time.monotonic() + numbers.choice((0, 0, 0.002, 0.06))
        elif release_at[0] is not None and time.monotonic() >= release_at[0]:
            slow.release()
            release_at[0] = None
        return len(seen[0]) >= FRAMES

    run.wait(go_on, f"{count} consumers take {FRAMES} frames", slow.situation)
    return f"{expect_same(seen)} frames the same for {count}, largest lead {lead[0]}"


def two_consumers(bench):
    """Two consumers, one slow and one fast, see the same frames."""
    return several(bench, 2)


def three_consumers(bench):
    """Three consumers, one slow and two fast, see the same frames."""
    return several(bench, 3)


def sixteen_consumers(bench):
    """Sixteen consumers take part at once."""
    consumers = together(bench.start(), 16)
    expect(len({c.index for c in consumers}) == 16, "every consumer has a page of its own", "a page taken twice")
    return f"{expect_same(follow(consumers, 5))} frames the same for 16"


def late_joiner(bench):
    """A consumer that joins later is admitted at the beginning of a frame and gets every frame from there on."""
    run = bench.start()
    first = run.join("early")
    follow([first], 5)
    late = run.join("late")
    expect_all_admitted([first, late])
    admitted = late.wait_for_admission()
    expect(admitted > late.published_at_join, f"a consumer that joined when frame {late.published_at_join} was "
           "complete is admitted at a later one", f"frame {admitted}")
    expect_waited_for(late, [first], admitted - 1 + late.header.depth)
    hashed = late.take()
    if hashed.hash and hashed.count < 20_000:
        expect(chain(hashed.previous_hash, admitted, hashed.fields) == hashed.hash,
               "previous_hash lets a late consumer check the chain", "the hash of its first frame does not follow")
    seen = follow([first, late], FRAMES)
    numbers = sorted(seen[1])
    expect(numbers == list(range(admitted, admitted + len(numbers))), f"it gets every frame from {admitted} on",
           f"{numbers}")
    return f"joined after frame {late.published_at_join}, admitted at {admitted}, {expect_same(seen)} frames the same"


def leaver(bench):
    """When a consumer leaves the others go on, and its page can be taken again."""
    run = bench.start()
    consumers = together(run, 2)
    follow(consumers, 4)
    stays, goes = consumers
    page = goes.index
    goes.take()  # leaves in the middle of a frame
    goes.leave()
    follow([stays], 5)
    stays.wait(lambda: stays.control64(ControlPage.ADMITTED_FRAME + 8 * page) == 0,
               f"the producer clears admitted_frame[{page}] of a consumer that left")
    again = run.join("again")
    expect(again.index == page, f"page {page} can be taken again", f"page {again.index} is the first free one")
    expect_all_admitted([stays, again])
    same = expect_same(follow([stays, again], 5))
    return f"left at frame {goes.next}, page {page} taken again, {same} frames the same"


def hasty_leaver(bench):
    """A consumer that leaves as soon as it has joined disturbs no other, and its page can be taken again."""
    run = bench.start()
    consumer = run.join()
    follow([consumer], 3)
    consumer.take()
    for _ in range(8):
        hasty = run.join("hasty")
        hasty.leave()
        expect(hasty.index < 15, "pages of those who left can be taken again", "all pages are used up")
    count = len(follow([consumer], FRAMES)[0])
    again = run.join("again")
    expect(again.index == 1, "page 1 can be taken again", f"page {again.index} is the first free one")
    expect_all_admitted([consumer, again])
    return f"{count} frames after 8 of them, {expect_same(follow([consumer, again], 5))} frames the same"


def latest(bench):
    """A reader in mode latest gets only whole frames and holds up no other participant."""
    run = bench.start()
    consumer = run.join()
    consumer.take()
    reader = run.join("reader", LatestReader)
    consumer.release()
    with system.apart_from(run.pid()):
        whole, races, hashed = read_along(consumer, reader)
    return f"{whole} frames read while held, {races} while written, {reader.torn} discarded, {hashed} hashes right"


def read_along(consumer, reader):
    """Reads while frames are held and while they are written; (copies of held, of others, hashes checked)."""
    whole, races, hashed = 0, 0, set()
    for number in range(FRAMES):
        frame = consumer.take()
        if number >= 2:
            copy = consumer.wait(reader.poll, "a frame that no one overwrites can be read")
            expect(copy.frame >= frame.frame, f"the latest frame is {frame.frame} or later", f"{copy.frame}")
            if copy.frame == frame.frame:
                expect(copy.digest() == frame.digest(), "both modes see the same bits", "different ones")
            expect_whole(copy, hashed)
            whole += 1
        consumer.release()
        for _ in range(3):  # while the producer writes
            copy = reader.poll()
            if copy:
                expect_whole(copy, hashed)
                races += 1
    return whole, races, len(hashed)


def expect_whole(copy, hashed):
    """A copy that was accepted has the hash of its descriptor."""
    if copy.hash == 0 or copy.count > 20_000 or copy.frame in hashed:
        return
    own = chain(copy.previous_hash, copy.frame, copy.fields)
    expect(copy.hash == own, f"a copy of frame {copy.frame} with an unchanged sequence is whole, hash {own:016x}",
           f"{copy.hash:016x}")
    hashed.add(copy.frame)


def latest_dies(bench):
    """A reader in mode latest that is killed or leaves disturbs no other participant."""
    run = bench.start()
    consumer = run.join()
    consumer.take()
    leaving = run.join("leaving", LatestReader)
    with start_child(run, "killed", mode=LATEST) as child:
        consumer.release()
        follow([consumer], 5)
        child.kill()
    leaving.leave()
    end = time.monotonic() + 0.15  # the producer looks at its consumers while it waits
    consumer.take()
    while time.monotonic() < end:
        time.sleep(0.01)
        expect(not run.over(), "a reader that dies disturbs nobody", run.over)
    count = len(follow([consumer], FRAMES)[0])
    consumer.leave()
    run.expect_end(0, "the producer drains when all consumers in lockstep have left")
    return f"{count} frames after its death"


def follower(bench):
    """A stream ends when only followers remain, and they get its last frames."""
    run = bench.start()
    consumer = run.join()
    if consumer.header.version_minor == 0:
        raise NotApplicable("the producer speaks 1.0, followers came with 1.1")
    consumer.take()
    recorder = run.join("recorder", flags=FOLLOWS)
    consumer.release()
    expect_all_admitted([consumer, recorder])
    seen = follow([consumer, recorder], 5)
    same = expect_same(seen)
    held = recorder.next
    recorder.take()
    expect_waited_for(recorder, [consumer], held - 1 + recorder.header.depth)
    consumer.leave()
    last = recorder.published() + 2  # one may be in progress, another begun
    while not recorder.at_end():
        recorder.wait(lambda: recorder.available() or recorder.at_end(),
                      "the producer drains when only followers remain")
        if recorder.available():
            frame = recorder.take().frame
            expect(frame <= last, f"the stream ends when only followers remain, at frame {last} at the latest",
                   f"{frame}")
            recorder.release()
    recorder.leave()
    run.expect_end(0, "the producer ends when the followers have acknowledged the last frame")
    return f"{same} frames the same, drained at frame {recorder.published()}"


ALL = (two_consumers, three_consumers, sixteen_consumers, late_joiner, leaver, hasty_leaver, latest, latest_dies,
       follower)
