"""What validate.sh, stability.sh and speed_vs_error.sh share: a folder of runs that is filled, interrupted and continued."""

import argparse
import os
import re
import signal
import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

# The commit as the programs keep it (configs/program/version.cpp), and the build number that the linker computes over it.
COMMIT = re.compile(rb"wade-commit=[\0-\xff]{52}")
BUILD_ID = re.compile(rb"(?<=\x04\0\0\0\x14\0\0\0\x03\0\0\0GNU\0)[\0-\xff]{20}")


def suite_arguments(script, folder, *selections):
    """The parser of a suite: the options that all have, those that select runs, and where results go. Its --help is in the
    script."""
    parser = argparse.ArgumentParser(prog=f"tools/{script}", add_help=False)
    parser.add_argument("--program", type=lambda file: Path(file).resolve(), required=True)
    parser.add_argument("--out", type=Path, default=ROOT / "runs" / folder)
    parser.add_argument("--jobs", type=processors, default=os.cpu_count() or 1)
    for switch in ("--quick", "--long", "--again", "--list"):
        parser.add_argument(switch, action="store_true")
    for selection in selections:
        parser.add_argument(selection, default="")
    return parser


def processors(text):
    number = int(text) if text.isdecimal() else 0
    if not 1 <= number <= 1024:
        raise argparse.ArgumentTypeError(f"{text}: allowed: 1 to 1024")
    return number


class Ended(KeyboardInterrupt):
    """A signal asked the script to end; handled as if the user had pressed Ctrl-C."""

    code = 128 + signal.SIGTERM


def end_children_on_signals():
    """SIGTERM and SIGHUP end the script as Ctrl-C does: the children too, and what there is gets reported."""

    def end(_number, _frame):
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
        signal.signal(signal.SIGHUP, signal.SIG_IGN)
        raise Ended

    for number in (signal.SIGTERM, signal.SIGHUP):
        if signal.getsignal(number) == signal.SIG_DFL:  # not under nohup
            signal.signal(number, end)


def exit_code(interrupt):
    return interrupt.code if isinstance(interrupt, Ended) else 128 + signal.SIGINT


def say(text, stream=None):
    """Prints a line. A reader that has gone, as of `| head`, must not cost the report."""
    stream = stream or sys.stdout
    if stream is None:
        return
    try:
        print(text, file=stream, flush=True)
    except OSError:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, stream.fileno())
        os.close(nowhere)


def write_whole(file, data):
    """A reader never meets half a file."""
    part = file.with_name(file.name + f".part{os.getpid()}")
    part.write_bytes(data if isinstance(data, bytes) else data.encode())
    part.replace(file)


def program_bytes(program):
    """The program without the commit that it names: what is computed depends on the code, not on its name. So neither a
    commit nor uncommitted changes ("-dirty") make a run out of date, unless they change the program."""
    data = program.read_bytes()
    return BUILD_ID.sub(bytes(20), COMMIT.sub(b"", data))


def spheric2_data():
    """What WADE_SPHERIC2_DATA gives to the case spheric2, as far as a fingerprint needs: folder, files, sizes."""
    folder = os.environ.get("WADE_SPHERIC2_DATA", "")
    if not folder:
        return b""
    sizes = []
    if os.path.isdir(folder):
        sizes = sorted((e.name, e.stat().st_size) for e in os.scandir(folder) if e.name.endswith(".csv") and e.is_file())
    return repr((os.path.abspath(folder), sizes)).encode()


class Children:
    """Programs that run side by side and end together."""

    def __init__(self):
        self.lock = threading.Lock()
        self.running = set()
        self.stopped = False

    def run(self, command, log, environment, old_result):
        """Runs a program, all its words to the file `log`; removes its old result first, so that a run that dies leaves
        none instead of an old one. The exit code; None if all were stopped before it started."""
        with self.lock:
            if self.stopped:
                return None
            old_result.unlink(missing_ok=True)
            with open(log, "w", encoding="utf-8") as output:
                process = subprocess.Popen(
                    command, stdout=output, stderr=subprocess.STDOUT, env={**os.environ, **environment}
                )
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


def run_side_by_side(work, due, children, jobs):
    """Calls work(*run) of each run that is due and prints the line that it returns; 0, or the exit code of the signal that
    interrupted it."""
    with ThreadPoolExecutor(jobs) as pool:
        try:
            for future in [pool.submit(work, *run) for run in due]:
                say(future.result())
        except KeyboardInterrupt as interrupt:
            children.stop()
            say("interrupted; the same command goes on from here")
            return exit_code(interrupt)
        except BaseException:
            children.stop()
            raise
    return 0
