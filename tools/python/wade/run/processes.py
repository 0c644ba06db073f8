"""The processes of a run: started together, signalled together, waited for together; and a look at their segment."""

import ctypes
import errno
import json
import os
import select
import signal
import struct
import subprocess
import sys
import time
from pathlib import Path

from wade import UsageError
from wade.build_lock import is_locked
from wade.paths import BUILD

# Exit codes that are only the echo of what happened to the other side: attach time-out, peer dead, peer aborted,
# step time-out. The other side's own code says more.
ECHOES = (3, 4, 5, 7)
PEER_NOTICES_WITHIN_S = 3  # a dead peer is noticed after 50 ms; what waits longer waits for a peer that never came
PR_SET_PDEATHSIG = 1
# shm_protocol/layout.hpp
PRODUCER_PID_AT = 4096 + 144
CONSUMERS_AT, CONSUMERS, CONSUMER_BYTES = 3 * 4096, 16, 4096
CONSUMER_STATE_AT, CONSUMER_PID_AT, JOINED = 0, 80, 1


LIBC = ctypes.CDLL(None)  # once, not in each child


def end_with_parent():
    """Runs in the child: it gets SIGTERM when this process dies, so that no orphan keeps simulating."""
    LIBC.prctl(PR_SET_PDEATHSIG, signal.SIGTERM)


def start(command, **options):
    """Starts a program, a whole one also while another process builds it anew.

    While it is being linked, it is absent, not yet executable or open for writing, and the system starts none of these.
    """
    while True:
        is_built = Path(command[0]).parent == BUILD and is_locked(BUILD)
        try:
            return subprocess.Popen(command, **options)
        except OSError as error:
            if not is_built or error.errno not in (errno.ENOENT, errno.EACCES, errno.ETXTBSY):
                raise
        time.sleep(0.05)


def answer_of(command):
    """(exit code, what it prints) of a program that answers and ends."""
    with start(command, stdout=subprocess.PIPE, text=True) as program:
        text, _ = program.communicate()
    return program.returncode, text


def answers_of(commands):
    """The answers of programs that run side by side, in order, up to the first that fails; what others say on stderr is left out."""
    programs = [start(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, errors="backslashreplace")
                for command in commands]
    answers, failed = [], False
    for program in programs:
        text, said = program.communicate()
        if not failed:
            sys.stderr.write(said)
            answers.append((program.returncode, text))
            failed = program.returncode != 0
    return answers


class Pair:
    """The processes of a run; signals that this process receives are passed on to all of them.

    SIGUSR1 and SIGUSR2 (pause, single step) go to the `controlled` one alone, as soon as it is ready for them.
    """

    def __init__(self):
        self.processes = []
        self.signal = 0
        self.controlled = None
        self.requests = []
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            signal.signal(number, self.pass_on)
        for number in (signal.SIGUSR1, signal.SIGUSR2):
            signal.signal(number, lambda request, _frame: self.requests.append(request))

    def pass_on(self, number, _frame):
        self.signal = number
        self.send(signal.SIGINT if number == signal.SIGINT else signal.SIGTERM)

    def send(self, number):
        for process in self.processes:
            if process.poll() is None:
                process.send_signal(number)

    def start(self, command, stdin=subprocess.DEVNULL, **streams):
        process = start(command, stdin=stdin, preexec_fn=end_with_parent, **streams)
        self.processes.append(process)
        if self.signal:
            self.send(signal.SIGTERM)
        return process

    def pass_requests_on(self):
        process = self.controlled
        while self.requests and process is not None and process.poll() is None and catches(process, self.requests[0]):
            process.send_signal(self.requests.pop(0))

    def wait(self):
        """Waits for all; returns their exit codes in the order of start, None for one that had to be told to end."""
        given_up_at, told = None, set()
        while any(process.poll() is None for process in self.processes):
            self.pass_requests_on()
            if given_up_at is None and any(process.poll() for process in self.processes):
                given_up_at = time.monotonic() + PEER_NOTICES_WITHIN_S
            if given_up_at is not None and time.monotonic() > given_up_at:
                told.update(process.pid for process in self.processes if process.poll() is None)
                self.send(signal.SIGTERM)
                given_up_at = time.monotonic() + PEER_NOTICES_WITHIN_S
            wait_for_an_end(self.processes, 0.02)
        return [None if process.pid in told else exit_code(process) for process in self.processes]


def wait_for_an_end(processes, seconds):
    """Waits until one of the running processes has ended, but no longer than so many seconds."""
    ends, watched = select.poll(), []
    try:
        for process in processes:
            if process.returncode is None:
                watched.append(os.pidfd_open(process.pid))
                ends.register(watched[-1], select.POLLIN)
        ends.poll(1000 * seconds)
    except OSError:  # a kernel without them
        time.sleep(seconds)
    finally:
        for number in watched:
            os.close(number)


def catches(process, number):
    """Whether a process has a handler for a signal by now; without one SIGUSR1 would end it."""
    try:
        status = Path(f"/proc/{process.pid}/status").read_text()
    except OSError:
        return False
    caught = next(line.split()[1] for line in status.splitlines() if line.startswith("SigCgt"))
    return bool(int(caught, 16) >> (number - 1) & 1)


def descends_from(pid, ancestor):
    """Whether a process is another one or was started by it, directly or not."""
    while pid > 1 and pid != ancestor:
        try:
            pid = int(Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[1])
        except (OSError, IndexError):
            return False
    return pid == ancestor


def words_of_segment(session, at, form):
    """Returns values at an offset of the session's water segment, None while there are none."""
    try:
        with open(f"/dev/shm/{session}-fluid", "rb") as segment:
            segment.seek(at)
            return struct.unpack(form, segment.read(struct.calcsize(form)))
    except (OSError, struct.error):
        return None


def wait_for_own_segment(producer, session):
    """Waits until the session is that of this producer or the producer has ended.

    A crowd that starts earlier could join another producer that lives under the same name, and disturb it.
    """
    while producer.poll() is None:
        pid = words_of_segment(session, PRODUCER_PID_AT, "<I")
        if pid and descends_from(pid[0], producer.pid):
            return
        time.sleep(0.01)


def wait_until_joined(consumer, producer, session):
    """Waits until a consumer has joined the session; false if one of the two has ended before."""
    while consumer.poll() is None and producer.poll() is None:
        for i in range(CONSUMERS):
            page = CONSUMERS_AT + i * CONSUMER_BYTES
            state = words_of_segment(session, page + CONSUMER_STATE_AT, "<I")
            pid = words_of_segment(session, page + CONSUMER_PID_AT, "<I")
            if state == (JOINED,) and pid == (consumer.pid,):
                return True
        time.sleep(0.01)
    return False


def resolved(scene, *options):
    """Returns a scene as crowd_client reads it with these options. UsageError if refused; the program prints why."""
    code, text = answer_of([BUILD / "crowd_client", scene, *options, "--print-config"])
    if code != 0:
        raise UsageError(f"the scene {scene} cannot be used")
    return json.loads(text)


def exit_code(process):
    """As a shell shows it: 128 + number of the signal that ended it."""
    return process.returncode if process.returncode >= 0 else 128 - process.returncode


def meaning(codes):
    """The exit code of the whole run: the cause rather than its echo on the other side."""
    bad = [code for code in codes if code]
    causes = [code for code in bad if code not in ECHOES]
    return (causes + bad + [0])[0]
