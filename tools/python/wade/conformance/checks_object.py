"""Checks of the object: its creation, its header, its locks, its name."""

import os
import signal
import stat
import time

from wade.conformance import system
from wade.conformance.bench import follow, lock_holder_lives, page_of
from wade.conformance.expectation import expect, wait_until
from wade.conformance.header_rules import read_header
from wade.conformance.layout import MAGIC, PAGE, READY, ControlPage


def header(bench):
    """Header and control page are complete and true at the moment the magic becomes visible."""
    run = bench.start(held=True)
    pid = run.process.pid
    run.wait(lambda: system.is_stopped(pid), "the suite needs a shell that stops itself")
    with system.apart_from(pid):
        os.kill(pid, signal.SIGCONT)
        page, size, looks = first_header(run, time.monotonic() + bench.patience_s)
    found = read_header(page[:PAGE], size, run.kind)
    segment = run.look()
    expect(segment.state() == READY, "the state is ready (1) once the magic is stored and nobody joined",
           segment.situation)
    expect(segment.published() == 0, "no frame is published before a consumer joined", segment.situation)
    time.sleep(0.05)
    expect(page_of(run.path) == page[:PAGE], "the header never changes once its magic is stored", "it changed")
    name = found.producer_name.split(b"\0", 1)[0].decode("utf-8", "replace")
    return (f"'{name}', version {found.version_major}.{found.version_minor}, capacity {found.capacity}, "
            f"{found.slot_count} slots, depth {found.depth}, {looks} looks")


def first_header(run, deadline):
    """Looks without a pause until a magic is visible; (header and control page, size of the object, looks)."""
    looks, page = 0, b""
    while not any(page[:8]):
        looks += 1
        try:
            about = os.stat(run.path)
            allocated = about.st_blocks * 512
            expect(allocated >= about.st_size, "the object is allocated (posix_fallocate), not only sized",
                   f"{allocated} of {about.st_size} bytes")
            with open(run.path, "rb") as file:
                page = file.read(2 * PAGE)
                size = os.fstat(file.fileno()).st_size
        except FileNotFoundError:
            expect(not run.over(), f"the producer creates {run.path}", run.over)
        expect(time.monotonic() < deadline, f"the producer creates {run.path} and stores its magic", "it does not")
    return page, size, looks


def mode(bench):
    """The object has mode 0600 and belongs to the user."""
    run = bench.start()
    run.wait(run.has_name, f"the producer creates {run.path}")
    about = run.path.stat()
    expect(stat.S_IMODE(about.st_mode) == 0o600, "the object has mode 0600", f"{stat.S_IMODE(about.st_mode):04o}")
    expect(about.st_uid == os.geteuid(), f"it belongs to user {os.geteuid()}", f"{about.st_uid}")
    return f"uid {about.st_uid}"


def lock(bench):
    """The producer locks byte 0 before the object has a size and keeps it; pid and start time are its own."""
    run = bench.start()

    def sized():
        try:
            return run.path.stat().st_size > 0
        except FileNotFoundError:
            return False

    run.wait(sized, f"the producer creates {run.path}")
    expect(lock_holder_lives(run.path), "byte 0 is locked before the object has a size", "its lock is free")
    consumer = run.join()
    follow([consumer], 3)
    expect(consumer.producer_lives(), "byte 0 stays locked while the producer lives", "its lock is free")
    pid = run.pid()
    claimed = consumer.control64(ControlPage.START_TIME)
    expect(claimed == system.start_time(pid), f"Control.start_time is that of process {pid}, {system.start_time(pid)}",
           f"{claimed}")
    run.send(signal.SIGKILL)
    wait_until(lambda: not consumer.producer_lives(), "the lock goes with the process", consumer.situation,
               bench.patience_s)
    return f"pid {pid}"


def exclusive(bench):
    """A second producer of the same name ends with 8 and leaves the first alone."""
    first = bench.start()
    consumer = first.join()
    follow([consumer], 2)
    header_before, inode = page_of(first.path), consumer.inode
    second = bench.start(first.session)
    wait_until(lambda: second.code() is not None, "the second producer ends with exit code 8",
               lambda: "it still runs", bench.patience_s)
    expect(second.code() == 8, "a name with a living producer is in use, exit code 8", second.over)
    expect(first.path.exists() and first.path.stat().st_ino == inode, "the name still leads to the first object",
           "another object or none")
    expect(page_of(first.path) == header_before, "the header of the first object is untouched", "it changed")
    follow([consumer], 5)
    expect(second.last_message(), "the second producer says why", "no message")
    return f"'{second.last_message()}'"


def stale(bench):
    """An object that a killed producer left, or anything else without a lock, is replaced."""
    first = bench.start()
    old = first.look()
    first.send(signal.SIGKILL)
    first.process.wait()
    expect(first.has_name(), "the suite needs the object of the killed producer", "it is gone")
    play_over(bench, first.session, old.inode)
    left = [b"", b"not a segment", MAGIC.to_bytes(8, "little") + bytes(PAGE)]
    for content in left:
        first.path.write_bytes(content)
        first.path.chmod(0o600)
        play_over(bench, first.session, first.path.stat().st_ino)
    return f"a killed producer's object and {len(left)} other files replaced"


def play_over(bench, session, inode):
    """A producer replaces the object of this inode and plays."""
    run = bench.start(session)

    def replaced():
        try:
            about = run.path.stat()
            return about.st_ino != inode and about.st_size > 0
        except FileNotFoundError:
            return False

    run.wait(replaced, "an object whose lock of byte 0 is free is unlinked and replaced")
    consumer = run.join()
    follow([consumer], 3)
    consumer.leave()
    run.expect_end(0, "the producer drains when all have left")


def nobody_comes(bench):
    """Without a consumer the producer gives up with exit code 3 and unlinks its object."""
    extra = (bench.attach_timeout_option, "1") if bench.attach_timeout_option else ()
    run = bench.start(extra=extra)
    segment = run.look()
    run.expect_end(3, "a producer without a consumer gives up after its attach time-out (or 60 s)")
    expect_aborted(segment, 3)
    return f"'{segment.reason()[1]}'"


def expect_aborted(segment, *codes):
    """The control page says aborted, with the exit code and a reason."""
    expect(segment.state() == 5, "a producer that fails says so: state 5 (aborted)", segment.situation)
    code, text = segment.reason()
    expect(code in codes, f"Control.reason_code is the exit code, {codes[0]}", f"{code}")
    expect(text.strip(), "Control.reason_text is a sentence", "nothing")


FIRST = (header, mode, lock, exclusive, stale)
LAST = (nobody_comes,)
