"""Starts the producer under test as a process of its own and watches it."""

import os
import secrets
import shutil
import signal
import subprocess
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

from wade.conformance import system
from wade.conformance.expectation import PATIENCE_S, NotApplicable, Violation, expect, wait_until
from wade.conformance.layout import KINDS, MAGIC, PAGE, ControlPage
from wade.conformance.participant import Consumer, Segment

FRAMES = 20
HOLD = ["sh", "-c", 'kill -STOP $$; exec "$@"', "sh"]


class CannotStart(Exception):
    """The command is no program."""


@dataclass
class Bench:
    """What is tested and how."""

    command: list
    kind: str = "fluid"
    patience_s: float = PATIENCE_S
    attach_timeout_option: str = ""
    step_timeout_option: str = ""
    nondeterministic: bool = False
    scene: str = None
    runs: list = field(default_factory=list)

    def start(self, session=None, extra=(), held=False):
        """A run of the producer under a fresh session name or a given one; tidied up by close().

        held: it stands still before its first instruction, until SIGCONT.
        """
        run = Run(self, session or f"conformance-{os.getpid()}-{secrets.token_hex(4)}", extra, HOLD if held else [])
        self.runs.append(run)
        return run

    def with_step_timeout(self, seconds):
        if not self.step_timeout_option:
            raise NotApplicable("needs --step-timeout-option, the producer's option for its step time-out in seconds")
        return self.start(extra=(self.step_timeout_option, f"{seconds:g}"))

    def demand_repeatable(self):
        if self.nondeterministic:
            raise NotApplicable("--nondeterministic")

    def close(self):
        for run in self.runs:
            run.close()
        self.runs.clear()


class Run:
    """A running producer and the participants that have joined it."""

    def __init__(self, bench, session, extra=(), before=()):
        self.bench, self.session = bench, session
        self.path = Path("/dev/shm") / f"{session}-{bench.kind}"
        self.kind = KINDS[bench.kind]
        self.participants = []
        words = [word.replace("{session}", session) for word in bench.command]
        if words == bench.command:
            words += ["--session", session]
        if not shutil.which(words[0]):
            raise CannotStart(f"there is no program '{words[0]}'")
        self.messages = tempfile.TemporaryFile()
        # In a session of its own, so that a ^C of the suite's terminal does not reach it and a wrapper ends with it.
        self.process = subprocess.Popen([*before, *words, *extra], stdin=subprocess.DEVNULL, stdout=self.messages,
                                        stderr=self.messages, start_new_session=True)

    # What is the case.

    def code(self):
        """The exit code; None while it runs, a negative signal number if a signal ended it."""
        return self.process.poll()

    def over(self):
        """A text once the process has ended, for wait_until."""
        code = self.code()
        if code is None:
            return ""
        how = f"signal {-code} ended the producer" if code < 0 else f"the producer ended with code {code}"
        return how + (f" ('{self.last_message()}')" if self.last_message() else "")

    def message_bytes(self):
        """What the producer has written to its standard output and error."""
        self.messages.seek(0)
        return self.messages.read()

    def last_message(self):
        lines = self.message_bytes().decode("utf-8", "backslashreplace").strip().splitlines()
        return lines[-1][:200] if lines else ""

    def has_name(self):
        return self.path.exists()

    # Waiting.

    def wait(self, condition, contract, seen=lambda: "it did not happen"):
        return wait_until(condition, contract, seen, self.bench.patience_s, self.over)

    def wait_for_magic(self):
        """Waits until the producer's object can be used."""

        def ready():
            try:
                with open(self.path, "rb") as file:
                    return file.read(8) == MAGIC.to_bytes(8, "little")
            except FileNotFoundError:
                return False

        self.wait(ready, f"the producer creates {self.path} and stores its magic")

    def look(self):
        """The object of this run without joining it."""
        self.wait_for_magic()
        segment = Segment(self.path, self.kind)
        self.participants.append(segment)
        return segment

    def join(self, name="conformance", reader=Consumer, **options):
        self.wait_for_magic()
        consumer = reader(self.path, self.kind, name=name, patience_s=self.bench.patience_s, over=self.over, **options)
        self.participants.append(consumer)
        return consumer

    def expect_end(self, code, contract):
        """The producer ends with this exit code and its name is gone."""
        contract = f"{contract}: exit code {code}"
        wait_until(lambda: self.code() is not None, contract, lambda: "it still runs; " + self.situation(),
                   self.bench.patience_s)
        expect(self.code() == code, contract, self.over)
        expect(not self.has_name(), f"a producer that ends unlinks {self.path.name}", "it is still there")

    def situation(self):
        return self.participants[-1].situation() if self.participants else "nobody has looked at its object"

    # Signals go to the process that the control page names: the command may be a script around it.

    def pid(self):
        pid = self.participants[0].control(ControlPage.PID)
        try:
            own = os.getsid(pid) == self.process.pid if pid else False
        except ProcessLookupError:
            own = False
        if not own:
            raise Violation("Control.pid is the process id of the producer", f"{pid}, not started by this command")
        return pid

    def send(self, number):
        os.kill(self.pid(), number)

    def stop(self):
        """Stops the producer's process; returns when it stands still."""
        pid = self.pid()
        os.kill(pid, signal.SIGSTOP)
        self.wait(lambda: system.is_stopped(pid), "a stopped process stands still")

    def go_on(self):
        self.send(signal.SIGCONT)

    def close(self):
        """Ends whatever is left of this run."""
        for participant in self.participants:
            participant.close()
        self.participants.clear()
        try:
            os.killpg(self.process.pid, signal.SIGKILL)
        except ProcessLookupError:
            pass
        self.process.wait()
        self.messages.close()
        self.path.unlink(missing_ok=True)


def lock_holder_lives(path):
    """Whether some process holds the producer's lock of an object."""
    fd = os.open(path, os.O_RDWR | os.O_CLOEXEC)
    try:
        return system.is_locked_by_other(fd, 0)
    finally:
        os.close(fd)


def page_of(path):
    """The header page of an object as it is now."""
    with open(path, "rb") as file:
        return file.read(PAGE)


def holding(bench, frames):
    """A run and its one consumer, which has had so many frames and holds the next one."""
    run = bench.start()
    consumer = run.join()
    follow([consumer], frames)
    consumer.take()
    return run, consumer


def follow(consumers, frames=FRAMES, between=None):
    """Takes frames with several consumers, each at its own pace, until the stream ends or each has had `frames`.

    All stop at the same frame, so that none holds up the others. between(consumer, frame): called while a frame is
    held. Returns for each consumer {frame number: digest}.
    """
    seen = [{} for _ in consumers]
    for consumer in consumers:
        consumer.wait_for_admission()
    last = max(consumer.next for consumer in consumers) + frames - 1
    while True:
        busy = [c for c in consumers if c.next <= last and not c.at_end()]
        if not busy:
            return seen
        busy[0].wait(lambda: any(c.available() or c.at_end() for c in busy),
                     "the next frame follows, or the end of the stream")
        for consumer, digests in zip(consumers, seen):
            if consumer in busy and consumer.available():
                frame = consumer.take()
                digests[frame.frame] = frame.digest()
                if between:
                    between(consumer, frame)
                consumer.release()
