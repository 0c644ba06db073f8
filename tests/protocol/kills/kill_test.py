#!/usr/bin/env python3
"""Kills one side of a stream at a random moment, again and again, and looks at what the others say and have logged.

    kill_test.py --peer build/release/tests/protocol/kills/kill_peer [--runs 500] [--seed 1]

Each run has a producer and one or two consumers, depth 1 to 3, on one processor or on all, and one victim that a timer
kills somewhere between its first instruction and its last. Then must hold:

  * Every survivor ends by itself; none hangs, none is given a torn, a skipped or a repeated frame.
  * A survivor that took part with the victim ends with exit code 4 and names the victim and the frame of its death,
    unless the stream was over for this survivor when the victim died (0). In a pair that never met, the survivor ends
    with 3. A consumer ends with 5 if the producer ended because the other consumer died.
  * What a consumer has acknowledged, as the segment says, is in that consumer's log.
  * The kills did hit: half of the victims at least were killed, and a survivor said "peer dead"; from 300 runs on each
    state that a participant passes through was hit, too.
"""

import argparse
import collections
import os
import random
import re
import secrets
import signal
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

SAFETY_NET_S = 60  # far beyond every time-out of the peers; only a hang takes so long
FRAMES = 1500
# docs/protocol.md
CONTROL, CONSUMERS, PAGE = 4096, 3 * 4096, 4096
PRODUCER_STATES = ["init", "ready", "running", "draining", "closed", "aborted"]
CONSUMER_STATES = ["free", "joined", "left", "aborted", "refused"]
FIRST_CPU = {min(os.sched_getaffinity(0))}
MUST_BE_HIT = {
    *(f"producer {state}" for state in ("init", "ready", "running", "draining")),
    "consumer absent", "consumer joined, stream running", "consumer joined, stream draining",
}
RUNS_TO_HIT_ALL = 300
DIED = re.compile(r"died at frame (\d+)")


class Wrong(Exception):
    """What must hold does not."""


def word(segment, offset, form):
    return struct.unpack_from(form, segment, offset)[0]


class Segment:
    """Keeps a segment that its producer unlinks readable: opened as soon as it is there."""

    def __init__(self, session):
        self.path = Path(f"/dev/shm/{session}-fluid")
        self.file = None

    def look(self):
        if self.file is None:
            try:
                self.file = open(self.path, "rb")
            except FileNotFoundError:
                pass

    def read(self):
        """All bytes, empty if there never was a segment."""
        self.look()
        if self.file is None:
            return b""
        self.file.seek(0)
        return self.file.read(CONSUMERS + 16 * PAGE)

    def close(self):
        if self.file:
            self.file.close()
        self.path.unlink(missing_ok=True)


def state_of_producer(segment):
    if len(segment) < CONSUMERS:
        return "absent"
    if word(segment, 0, "<Q") == 0:
        return "init"
    return PRODUCER_STATES[word(segment, CONTROL + 4, "<I")]


def consumer_entries(segment):
    """{pid: (state, acknowledged frame)} of the consumer pages with a process id."""
    entries = {}
    for offset in range(CONSUMERS, len(segment), PAGE):
        pid = word(segment, offset + 80, "<I")
        if pid:
            entries[pid] = (CONSUMER_STATES[word(segment, offset, "<I")], word(segment, offset + 8, "<Q"))
    return entries


class Peer:
    def __init__(self, run, role, *arguments, death=()):
        self.role = role
        self.log = run.folder / f"{role}-{len(run.peers)}.log"
        self.errors = open(run.folder / f"{role}-{len(run.peers)}.err", "w+")
        self.victim = bool(death)
        self.process = subprocess.Popen(
            [run.binary, role, run.session, "--log", self.log, *map(str, arguments), *map(str, death)],
            stdin=subprocess.DEVNULL, stderr=self.errors,
            preexec_fn=(lambda: os.sched_setaffinity(0, FIRST_CPU)) if run.one_cpu else None,
        )
        run.peers.append(self)

    def wait(self):
        try:
            self.code = self.process.wait(SAFETY_NET_S)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
            raise Wrong(f"the {self.role} hangs")
        self.errors.seek(0)
        self.message = self.errors.read().strip()
        self.errors.close()
        self.lines = self.log.read_text().splitlines() if self.log.exists() else []

    def took_part(self):
        return "joined" in self.lines or (self.role == "produce" and "created" in self.lines)

    def frames_logged(self):
        return [int(line) for line in self.lines if line.isdigit()]


class Run:
    """One run with one victim."""

    def __init__(self, binary, folder, random_numbers):
        self.binary, self.folder, self.peers = binary, folder, []
        self.session = f"wade-kill-{os.getpid()}-{secrets.token_hex(4)}"
        self.one_cpu = random_numbers.random() < 0.5
        self.depth = random_numbers.randint(1, 3)
        self.consumers = random_numbers.randint(1, 2)
        roles = ["produce"] + ["consume"] * self.consumers
        victim = random_numbers.choice([0, 0, *range(1, len(roles))])
        death = self.way_to_die(random_numbers, roles[victim])
        order = list(range(len(roles)))
        random_numbers.shuffle(order)
        segment = Segment(self.session)
        try:
            for k in order:
                arguments = ["--frames", FRAMES, "--depth", self.depth, "--consumers", self.consumers] if k == 0 else []
                Peer(self, roles[k], *arguments, death=death if k == victim else ())
            self.victim = next(peer for peer in self.peers if peer.victim)
            while any(peer.process.poll() is None for peer in self.peers) and segment.file is None:
                segment.look()
            for peer in [self.victim, *self.peers]:
                if peer is self.victim and not hasattr(peer, "code"):
                    peer.wait()
                    at_death = segment.read()
                elif peer is not self.victim:
                    peer.wait()
            self.bytes = segment.read()
        finally:
            for peer in self.peers:
                if peer.process.poll() is None:
                    peer.process.kill()
                    peer.process.wait()
            segment.close()
        self.state = (f"producer {state_of_producer(at_death)}" if self.victim.role == "produce"
                      else f"consumer {self.consumer_state(at_death)}")

    @staticmethod
    def way_to_die(random_numbers, role):
        """Returns options: a timer, or a point that a timer would rarely hit, in the first, the last or some frame."""
        if random_numbers.random() < 0.7:
            # Short delays hit creation and attachment, long ones the frames and the end.
            return "--kill-after-us", int(10 ** random_numbers.uniform(2.6, 4.9))
        places = ("writing", "published") if role == "produce" else ("reading", "released")
        frame = random_numbers.choice([1, random_numbers.randint(2, FRAMES - 1), FRAMES])
        return "--kill-when", random_numbers.choice(places), "--kill-at-frame", frame

    def consumer_state(self, segment):
        state = consumer_entries(segment).get(self.victim.process.pid, ("absent", 0))[0]
        return f"{state}, stream {state_of_producer(segment)}" if state == "joined" else state

    def describe(self):
        return (f"depth {self.depth}, {self.consumers} consumers, {'one CPU' if self.one_cpu else 'all CPUs'}; "
                f"victim: {self.state}; " + "; ".join(f"{p.role} {p.code} \"{p.message}\"" for p in self.peers))

    def check(self):
        """Raises Wrong unless all survivors did right; returns what they ended with."""
        for peer in self.peers:
            if any(line.startswith("torn") for line in peer.lines):
                raise Wrong("a frame was torn, skipped or repeated")
            frames = peer.frames_logged()
            if frames != list(range(1, len(frames) + 1)):
                raise Wrong(f"the frames of a log are not 1, 2, 3, ...: {frames[:20]}")
        self.check_acknowledged()
        if self.victim.code == 0:
            self.expect_all_well()
            return "ended before its time"
        if self.victim.code != -signal.SIGKILL:
            return self.check_echo()
        return ", ".join(sorted(self.check_survivor(peer) for peer in self.peers if peer is not self.victim))

    def check_acknowledged(self):
        for pid, (_, acknowledged) in consumer_entries(self.bytes).items():
            consumer = next((peer for peer in self.peers if peer.process.pid == pid), None)
            if consumer is None:
                raise Wrong(f"the segment names process {pid}, which is none of the consumers")
            if acknowledged > len(consumer.frames_logged()):
                raise Wrong(f"frame {acknowledged} was acknowledged, the log ends at {len(consumer.frames_logged())}")

    def expect_all_well(self):
        for peer in self.peers:
            if peer.code != 0:
                raise Wrong(f"nobody was killed, and a {peer.role} ended with {peer.code}")

    def check_echo(self):
        """The victim ended with an error of its own before the timer: only time-outs of a pair that never met can."""
        if self.victim.code != 3:
            raise Wrong(f"the victim was not killed and ended with {self.victim.code}")
        return "never met"

    def check_survivor(self, peer):
        if peer.code == 4:
            if not DIED.search(peer.message):
                raise Wrong("a dead peer is reported without the frame at which it died")
            if str(self.victim.process.pid) not in peer.message:
                raise Wrong("the message names another process than the victim")
            return "peer dead"
        if peer.code == 0:
            if not self.was_over_for(peer):
                raise Wrong(f"a {peer.role} ended as if all were well")
            return "all was over"
        if peer.code == 3:
            if self.victim.role == "produce" and "joined" in peer.lines:
                raise Wrong("a consumer that had joined waited for somebody to show up")
            if self.victim.role == "consume" and peer.role == "produce" and self.all_had_joined():
                raise Wrong("the producer waited for consumers although all had joined")
            return "never met"
        if peer.code == 5 and peer.role == "consume" and self.victim.role == "consume":
            reasons = ("died at frame", "consumers to join ")  # of the victim, or before it could join
            if not any(reason in peer.message for reason in reasons):
                raise Wrong("the producer's reason does not say what happened")
            return "told by the producer"
        raise Wrong(f"a {peer.role} ended with {peer.code}")

    def all_had_joined(self):
        return all("joined" in peer.lines for peer in self.peers if peer.role == "consume")

    def was_over_for(self, peer):
        """A consumer has used the last frame; a producer's consumers have acknowledged it."""
        if peer.role == "consume":
            return len(peer.frames_logged()) == FRAMES
        return all(acknowledged == FRAMES or state == "left"
                   for state, acknowledged in consumer_entries(self.bytes).values())


def missed(runs, states, ends):
    """What the kills did not hit although they should have, as sentences."""
    killed = sum(states.values())
    if 2 * killed < runs:
        yield f"only {killed} of {runs} victims were killed"
    if not any("peer dead" in end for end in ends):
        yield "no survivor said that its peer is dead"
    if runs >= RUNS_TO_HIT_ALL:
        for state in sorted(MUST_BE_HIT - states.keys()):
            yield f"no kill hit the state \"{state}\""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--peer", type=Path, required=True, help="the program kill_peer")
    parser.add_argument("--runs", type=int, default=500)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    random_numbers = random.Random(options.seed)
    states, ends, wrong = collections.Counter(), collections.Counter(), 0
    for number in range(1, options.runs + 1):
        with tempfile.TemporaryDirectory(prefix="wade-kill-") as folder:
            try:
                run = Run(options.peer, Path(folder), random_numbers)
                end = run.check()
            except Wrong as error:
                wrong += 1
                print(f"run {number}: {error}: {run.describe() if 'run' in locals() else ''}", flush=True)
                continue
        if run.victim.code == -signal.SIGKILL:
            states[run.state] += 1
        ends[end] += 1
    print(f"{options.runs} runs, seed {options.seed}: {wrong} wrong")
    print("the victim was, when it died:")
    for state, count in sorted(states.items()):
        print(f"  {count:5}  {state}")
    print(f"  {options.runs - wrong - states.total():5}  not killed: ended before")
    print("the survivors said:")
    for end, count in sorted(ends.items()):
        print(f"  {count:5}  {end}")
    gaps = list(missed(options.runs, states, ends))
    for gap in gaps:
        print(f"not good enough: {gap}")
    return 1 if wrong or gaps else 0


if __name__ == "__main__":
    sys.exit(main())
