"""Runs that go on where they were stopped: what is complete by the same program is not repeated. A run is done again if its
program or its inputs have changed, not if a commit has.
"""

import hashlib
import os
import re
import subprocess
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from wade import interrupts, plain_file, progress
from wade.reports.files import complain, say


def exit_code(interrupt):
    """The exit code of an interrupted command, which is told how to go on."""
    complain("interrupted; the same command goes on from here")
    return interrupts.exit_code(interrupt)


@dataclass(frozen=True)
class Job:
    """A program that writes a result, a JSON object with a fingerprint, and its words to a log."""

    name: str  # in words
    command: tuple
    result: Path
    fingerprint: str
    threads: int = 1
    fine: tuple = (0,)  # exit codes of a program that has left a result

    @property
    def log(self):
        return self.result.with_suffix(".log")

    def kept(self):
        """Its result if it is complete and up to date, else None."""
        document = read_result(self.result)
        return document if document and document.get("fingerprint") == self.fingerprint else None


def read_result(file):
    """A complete result, or None."""
    try:
        return plain_file.read_json(file)
    except plain_file.FileError:
        return None


class Children:
    """Programs that run side by side and end together."""

    def __init__(self):
        self.lock = threading.Lock()
        self.running = set()
        self.stopped = False

    def run(self, job):
        """Runs a job; removes its old result first, so that one that dies leaves none instead of an old one. The exit
        code; None if all were stopped before it started."""
        environment = {"OMP_NUM_THREADS": str(job.threads), "GOMP_SPINCOUNT": "2000"}
        with self.lock:
            if self.stopped:
                return None
            job.result.unlink(missing_ok=True)
            with plain_file.create(job.log) as log:
                process = subprocess.Popen(list(map(str, job.command)), stdout=log, stderr=subprocess.STDOUT,
                                           env={**os.environ, **environment})
            self.running.add(process)
        code = process.wait()
        with self.lock:
            self.running.discard(process)
        return code

    def stop(self):
        with self.lock:
            self.stopped = True
            for process in self.running:
                process.terminate()


def do(job, children):
    """One job; returns a line about it."""
    began = time.monotonic()
    code = children.run(job)
    if code is None:
        return f"{job.name}: not started"
    if code in job.fine:
        return f"{job.name}: done in {time.monotonic() - began:.1f} s"
    lines = plain_file.read_text(job.log, "backslashreplace").splitlines()
    messages = [line for line in lines if line.startswith(f"{Path(job.command[0]).name}: ")]
    return f"{job.name}: exit code {code}; {(messages or lines or ['no message'])[-1]}"


def do_all(jobs, side_by_side, again=False):
    """Does what is not up to date; 0, or the exit code of the signal that interrupted it."""
    due = [job for job in jobs if again or job.kept() is None]
    for job in due:
        job.result.parent.mkdir(parents=True, exist_ok=True)
    say(f"{len(jobs)} runs, {len(jobs) - len(due)} of them complete, {side_by_side} at a time")
    children = Children()
    with ThreadPoolExecutor(side_by_side) as pool:
        try:
            futures = [pool.submit(do, job, children) for job in due]
            for future in progress.over(futures, f"runs {len(due)} cases"):
                say(future.result())
        except KeyboardInterrupt as interrupt:
            children.stop()
            return exit_code(interrupt)
        except BaseException:
            children.stop()
            raise
    return 0


# The commit as the programs keep it (version.cpp), and the build number that the linker computes over it.
COMMIT = re.compile(rb"wade-commit=[\0-\xff]{52}")
BUILD_ID = re.compile(rb"(?<=\x04\0\0\0\x14\0\0\0\x03\0\0\0GNU\0)[\0-\xff]{20}")


def program_bytes(program):
    """The program without the commit that it names: neither a commit nor uncommitted changes ("-dirty") make a run out
    of date, unless they change the program."""
    return BUILD_ID.sub(bytes(20), COMMIT.sub(b"", program.read_bytes()))


def spheric2_data():
    """What WADE_SPHERIC2_DATA gives to the case spheric2, as far as a fingerprint needs: folder, files, sizes."""
    folder = os.environ.get("WADE_SPHERIC2_DATA", "")
    if not folder:
        return b""
    sizes = []
    if os.path.isdir(folder):
        sizes = sorted((e.name, e.stat().st_size) for e in os.scandir(folder) if e.name.endswith(".csv")
                       and e.is_file())
    return repr((os.path.abspath(folder), sizes)).encode()


class Fingerprints:
    """Of programs and all that they read: a run with the same one would give the same numbers."""

    def __init__(self, programs, root, patterns, words=()):
        """patterns: of files below root that the programs read; words: settings of all runs."""
        self.digest = hashlib.sha256(b"".join(map(program_bytes, programs)))
        for word in words:
            self.digest.update(word.encode() + b"\0")
        for file in [file for pattern in patterns for file in sorted(root.glob(pattern)) if file.is_file()]:
            self.digest.update(str(file.relative_to(root)).encode() + b"\0" + file.read_bytes())

    def __call__(self, case=""):
        digest = self.digest.copy()
        if case == "spheric2":
            digest.update(spheric2_data())
        return digest.hexdigest()[:16]
