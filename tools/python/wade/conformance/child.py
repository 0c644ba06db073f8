"""A consumer as a real process, so that it can be killed: child.py PATH KIND MODE NAME FRAMES

In lockstep it takes FRAMES frames (all: until the final one) and holds the next one; then it says so and sleeps.
"""

import math
import select
import signal
import subprocess
from contextlib import contextmanager
from pathlib import Path

from wade.conformance.expectation import expect
from wade.conformance.layout import FINAL, LOCKSTEP
from wade.conformance.participant import Consumer
from wade.paths import module_command


class Child:
    """at: the frame it holds or waits for; final: that is the final one."""

    def __init__(self, process, at, final):
        self.process, self.at, self.final = process, at, final

    def kill(self):
        self.process.send_signal(signal.SIGKILL)
        self.process.wait()


@contextmanager
def start_child(run, name, mode=LOCKSTEP, frames=3):
    """Starts a child that joins a run; returns when it has joined (latest) or holds its frame (lockstep)."""
    words = [*module_command(__name__), run.path, run.kind, mode, name, frames]
    process = subprocess.Popen(list(map(str, words)), stdout=subprocess.PIPE, stdin=subprocess.DEVNULL)
    try:
        ready = select.select([process.stdout], [], [], run.bench.patience_s)[0]
        line = process.stdout.readline().decode() if ready else ""
        expect(line.startswith("ready"), f"a consumer takes {frames} frames", lambda: f"it did not; {run.over()}")
        _, at, final = line.split()
        yield Child(process, int(at), final == "final")
    finally:
        process.kill()
        process.wait()
        process.stdout.close()


def main(arguments):
    path, kind, mode, name, frames = arguments
    consumer = Consumer(Path(path), int(kind), name, mode=int(mode))
    final = False
    if int(mode) == LOCKSTEP:
        limit = math.inf if frames == "all" else int(frames)
        taken = 0
        while not consumer.at_end():
            consumer.wait(lambda: consumer.available() or consumer.at_end(), "a frame or the end follows")
            final = consumer.available() and bool(consumer.take().flags & FINAL)
            if final or taken == limit or consumer.at_end():
                break
            consumer.release()
            taken += 1
    print(f"ready {consumer.next} {'final' if final else 'open'}", flush=True)
    while True:
        signal.pause()
