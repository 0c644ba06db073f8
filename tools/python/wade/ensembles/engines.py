"""Engines hand out indices. An engine does not know what is done under an index, or whether it is complete."""

import os
import select
import shlex
import shutil
import signal
import subprocess
import sys
import time

from wade import UsageError, plain_file
from wade.ensembles.one import carry_out, read_unit, worker_command
from wade.outside import fault_of
from wade.paths import BUILD
from wade.run.processes import end_with_parent

LARGEST_ARRAY = 1000  # Slurm's MaxArraySize less one
LOOK_EVERY_S = (0.5, 15)  # at the queue: at first, and later
TELL_EVERY_S = 10  # of runs that share a water while none of them ends


class Signals:
    """What asks this command to end; passed on to what it has started."""

    def __init__(self):
        self.number, self.pass_on = 0, lambda number: None
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            signal.signal(number, self.receive)

    def receive(self, number, _frame):
        self.number = number
        self.pass_on(signal.SIGINT if number == signal.SIGINT else signal.SIGTERM)


def send(pids, number):
    for pid in pids:
        try:
            os.kill(pid, number)
        except ProcessLookupError:
            continue


def fork_worker(unit):
    """A process of its own for a unit, which spares the start of a Python; its number.

    No signal comes before the worker has its own answer to it.
    """
    numbers = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
    signal.pthread_sigmask(signal.SIG_BLOCK, numbers)
    pid = os.fork()
    if pid == 0:
        code = 1
        try:
            for number in numbers:
                signal.signal(number, signal.SIG_DFL)
            end_with_parent()
            signal.pthread_sigmask(signal.SIG_UNBLOCK, numbers)
            code = carry_out(unit)
        finally:
            sys.stderr.flush()
            os._exit(code)
    return pid


def ended_of(running, seconds):
    """Returns the process ids of the workers that have ended; waits for one, at most `seconds`."""
    watched = {os.pidfd_open(pid): pid for pid in running}
    try:
        poll = select.poll()
        for file in watched:
            poll.register(file, select.POLLIN)
        ended = [watched[file] for file, _ in poll.poll(1000 * seconds)]
    finally:
        for file in watched:
            os.close(file)
    for pid in ended:
        os.waitpid(pid, 0)
    return ended


def local(ensemble, indices, options, signals, tell):
    """Processes of this machine, so many at a time."""
    waiting, running = list(indices), {}
    signals.pass_on = lambda number: send(running, number)
    while running or waiting and not signals.number:
        while waiting and len(running) < options.jobs and not signals.number:
            index = waiting.pop(0)
            running[fork_worker(read_unit(ensemble, index))] = index
            signal.pthread_sigmask(signal.SIG_UNBLOCK, (signal.SIGINT, signal.SIGTERM, signal.SIGHUP))
        for pid in ended_of(running, TELL_EVERY_S) or [None]:
            tell(running.pop(pid, None))


def needs(program, package):
    if fault := fault_of(program):
        raise UsageError(f"--engine: {program} {fault}; Debian's package {package} holds it")


def written_list(ensemble, lines):
    """The file that an engine hands out, an index or several a line."""
    file = ensemble.path / "indices.txt"
    file.write_text("".join(f"{line}\n" for line in lines), encoding="utf-8")
    return file


def guided(indices, jobs):
    """Lines of several indices at first and of one at the end, so that all jobs end about at once."""
    left = list(indices)
    while left:
        count = max(1, min(10, len(left) // (4 * jobs)))
        yield " ".join(map(str, left[:count]))
        del left[:count]


def run_engine(command, signals, times):
    """Runs an engine's program to its end; a signal is passed on `times` times."""
    process = subprocess.Popen([*map(str, command)], stdin=subprocess.DEVNULL, start_new_session=True,
                               preexec_fn=end_with_parent)

    def pass_on(_number):
        for _ in range(times):
            process.terminate()

    signals.pass_on = pass_on
    if signals.number:
        pass_on(signals.number)
    return process.wait()


def parallel(ensemble, indices, options, signals, _tell):
    """GNU parallel. To start a worker takes 50 ms, which several runs share."""
    needs("parallel", "parallel")
    worker = shlex.join([*worker_command(), str(ensemble.plan)])
    # Asked once to end it starts no more, asked twice it ends what runs, which gets time to end well.
    run_engine(["parallel", "--will-cite", "--jobs", options.jobs, "--joblog", ensemble.path / "parallel.log",
                "--termseq", "TERM,10000,KILL,25", *options.engine_options, "-a",
                written_list(ensemble, guided(indices, options.jobs)), worker + " {}"], signals, 2)


def mpirun(ensemble, indices, options, signals, _tell):
    """Starts ranks; each takes its part of the list."""
    needs("mpirun", "openmpi-bin")
    ranks = min(options.jobs, len(indices))
    # Ranks get time to end well before they are killed; mpirun waits for all of it.
    run_engine(["mpirun", "-np", ranks, "--mca", "odls_base_sigkill_timeout", "5", *options.engine_options, *worker_command(), ensemble.plan,
                "--of", written_list(ensemble, indices), "--share", "mpi"], signals, 1)


JOB = """#!/bin/sh
# A task takes its share of the list; one that starts again goes on with what is not complete.
WADE_BUILD={build}
export WADE_BUILD
exec {worker} {plan} --of {list} --share "$SLURM_ARRAY_TASK_ID"/{tasks}
"""


def queued(job):
    """Whether tasks of a job wait or run; also while Slurm does not answer, as they may."""
    answer = subprocess.run(["squeue", "--noheader", "--jobs", job, "--format", "%T"], capture_output=True, text=True)
    return bool(answer.stdout.strip()) if answer.returncode == 0 else "Invalid job id" not in answer.stderr


def slurm(ensemble, indices, options, signals, tell):
    """An array of Slurm, a task an index as long as it allows so many."""
    needs("sbatch", "slurm-client")
    tasks = min(len(indices), LARGEST_ARRAY)
    logs = ensemble.path / "slurm"
    logs.mkdir(exist_ok=True)
    words = {"build": BUILD, "plan": ensemble.plan, "list": written_list(ensemble, indices)}
    quoted = {name: shlex.quote(str(word)) for name, word in words.items()}
    script = ensemble.path / "slurm.sh"
    script.write_text(JOB.format(**quoted, tasks=tasks, worker=shlex.join(worker_command())), encoding="utf-8")
    at_once = f"%{options.jobs}" if options.jobs_given else ""
    answer = subprocess.run(["sbatch", "--parsable", "--job-name=wade-many", "--requeue", "--open-mode=append",
                             f"--output={logs}/%A_%a.log", f"--array=0-{tasks - 1}{at_once}", *options.engine_options,
                             script], stdout=subprocess.PIPE, text=True)
    if answer.returncode != 0:
        raise UsageError("sbatch has refused the job; its message stands above")
    job = answer.stdout.strip().partition(";")[0]
    kept = ensemble.path / "slurm_job.txt"
    kept.write_text(job + "\n", encoding="utf-8")
    signals.pass_on = lambda _number: subprocess.run(["scancel", job])
    if signals.number:
        signals.pass_on(signals.number)
    pause = LOOK_EVERY_S[0]
    while queued(job):
        time.sleep(pause)
        pause = min(1.3 * pause, LOOK_EVERY_S[1])
        tell(None)
    kept.unlink()


def still_queued(ensemble):
    """The job of Slurm that an earlier call has left and that is not over; None if there is none."""
    try:
        job = plain_file.read_text(ensemble.path / "slurm_job.txt").strip()
    except OSError:
        return None
    return job if shutil.which("squeue") and queued(job) else None


ENGINES = {"local": local, "parallel": parallel, "slurm": slurm, "mpirun": mpirun}
