"""One ninja at a time in a build folder, and the programs of a run before everything else.

Two files of the build folder are locked with flock. `.lock` belongs to the process that runs CMake or ninja. `.first`
belongs to a run that waits for `.lock`. A build of the tests makes the programs of a run first, in a ninja call of its
own. During the other calls it looks at `.first`: if a run waits, it ends ninja like Ctrl-C does, hands `.lock`
over, and calls ninja again afterwards. ninja keeps all finished files, so that only the files in progress are lost.

A run takes no lock if its programs are up to date: see building.steps_left and processes.start.
"""

import fcntl
import signal
import subprocess
import sys
from contextlib import contextmanager

LOOKS_EVERY_S = 0.2  # at `.first`


def open_lock(folder, name):
    """Opens a file to be locked. PermissionError where nothing can be written."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        return open(folder / name, "ab")
    except OSError as error:  # of another user, or on a medium that is only read
        raise PermissionError from error


def take_now(lock):
    """Takes a lock unless another process has it; returns whether it was taken."""
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True


def take_in_turn(lock, folder, hurries):
    """Waits for `.lock`. A run (hurries) holds `.first` until it has it; others let the runs that wait pass."""
    with open_lock(folder, ".first") as first:
        fcntl.flock(first, fcntl.LOCK_EX)
        if hurries:
            fcntl.flock(lock, fcntl.LOCK_EX)
    if not hurries:
        fcntl.flock(lock, fcntl.LOCK_EX)


def is_locked(folder):
    """Whether CMake or ninja works in a build folder."""
    try:
        with open(folder / ".lock", "rb") as lock:
            fcntl.flock(lock, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    except OSError:
        pass
    return False


def run_waits(folder):
    """Whether a run waits for `.lock`."""
    with open_lock(folder, ".first") as first:
        return not take_now(first)


@contextmanager
def locked(folder, hurries=False, is_ready=lambda: False):
    """Locks a build folder for CMake and ninja. PermissionError where nothing can be written.

    hurries: a run waits, and goes before a build of the tests. Yields the lock; or None, without a lock, if another
    process has it and is_ready() says that nothing needs to be built.
    """
    with open_lock(folder, ".lock") as lock:
        if not take_now(lock):
            if is_ready():
                yield None
                return
            print(f"waiting for another build in {folder}", file=sys.stderr)
            take_in_turn(lock, folder, hurries)
        yield lock


def hand_over(lock, folder):
    """Lets a run that waits build first, and takes the lock again."""
    fcntl.flock(lock, fcntl.LOCK_UN)
    take_in_turn(lock, folder, hurries=False)


def call_and_give_way(command, lock, folder, **options):
    """Calls ninja until it has ended by itself, and hands the lock over whenever a run waits; returns the exit code."""
    while True:
        with subprocess.Popen(command, **options) as ninja:
            given_way = False
            while ninja.poll() is None:
                try:
                    ninja.wait(LOOKS_EVERY_S)
                except subprocess.TimeoutExpired:
                    if not given_way and run_waits(folder):
                        given_way = True
                        ninja.send_signal(signal.SIGTERM)
        if not given_way or ninja.returncode == 0:
            return ninja.returncode
        print("A run builds its programs first; then this build goes on", file=sys.stderr)
        hand_over(lock, folder)
