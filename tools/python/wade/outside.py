"""Programs of other projects that optional parts call: whether they are installed, and whether they work."""

import functools
import shutil
import subprocess

from wade import UsageError

QUESTIONS = {"ffmpeg": "-version", "ffprobe": "-version", "sbatch": "-V", "slurmctld": "-V", "slurmd": "-V"}  # else --version
PATIENCE_S = 60


def fault_of(program):
    """Why a program cannot be used, in a few words; empty if it answers the question for its version."""
    path = shutil.which(program)
    return "is not installed" if path is None else fault_of_file(path, QUESTIONS.get(program, "--version"))


@functools.cache
def fault_of_file(path, question):
    """As fault_of, of a file; asks once."""
    try:
        done = subprocess.run([path, question], stdin=subprocess.DEVNULL, capture_output=True,
                              text=True, errors="backslashreplace", timeout=PATIENCE_S)
    except OSError as error:
        return f"does not start: {error.strerror}"
    except subprocess.TimeoutExpired:
        return f"does not answer within {PATIENCE_S} s"
    if done.returncode == 0:
        return ""
    said = (done.stderr or done.stdout).strip().split("\n")[-1].strip()[:100]
    how = f"signal {-done.returncode}" if done.returncode < 0 else f"exit code {done.returncode}"
    return f"is installed but fails with {how}" + (f" ({said})" if said else "")


def works(*programs):
    """Whether all of these programs answer."""
    return not any(map(fault_of, programs))


def require(program, remedy):
    """UsageError with the remedy if a program cannot be used."""
    if fault := fault_of(program):
        raise UsageError(f"{program} {fault}; {remedy}")
