"""One unit of an ensemble: a run, or runs that share a water. Skips what is complete, starts again what is not.

tools/wade run-one PLAN INDEX does what any engine hands out; a run gets its folder whole or not at all.
"""

import json
import os
import re
import signal
import subprocess
import sys
from pathlib import Path

from wade import UsageError, plain_file
from wade.ensembles.folder import (FAILURE, EnsembleFolder, is_accident, is_complete, message_of, name_of, publish,
                                   read_json, remove_left_overs, remove_tree, status_of, worker_name)
from wade.paths import BUILD, CACHE, ROOT, module_command
from wade.run.processes import Pair, meaning

CONFIGURATION = 2  # exit code
NO_PICTURES = ("--no-trajectories", "--water-every-s", "0")
# Many crowds take long to set up, and a machine that does many runs is busy.
PATIENCE_S = "300"

HELP = """\
Usage: tools/wade run-one PLAN INDEX ...
       tools/wade run-one PLAN --of LIST --share K/N

Does what tools/wade many has prepared beside PLAN, DIR/plan.csv, under these indices: a run, or the
runs that share a water, of which INDEX is the first. What is complete is skipped, what is not is
started again. For engines that hand out indices; tools/wade many --prepare names them.

  --of LIST      a file with an index a line
  --share K/N    the lines K, K + N, ... of LIST, counted from 0; with mpirun: --share mpi, K and N
                 are rank and size
Exit code: 0 if all runs are complete, else that of the first that failed, as in tools/wade run."""


START = "import sys; sys.path.insert(0, {package!r}); from wade.ensembles.one import main; sys.exit(main(sys.argv[1:]))"


def worker_command():
    """Words that start main() in a process of its own, with as little around it as there can be: engines do so for each run."""
    return [sys.executable, "-S", "-E", "-X", f"pycache_prefix={CACHE}", "-c", START.format(package=str(ROOT / "tools" / "python"))]


class Unit:
    """What stands in units/NNNNN.json, and where it belongs."""

    def __init__(self, ensemble, document):
        self.ensemble, self.runs = ensemble, document["runs"]
        self.scene, self.identity = document["scene"], document["ensemble"]
        self.server, self.crowd = document["fluid_server"], document["crowd_client"]
        self.launcher = document["launcher"]  # words of tools/wade run, for water of another producer
        self.pictures, self.figures, self.threads = document["pictures"], document["figures"], document["threads"]

    @property
    def index(self):
        return self.runs[0]["index"]

    def place(self, run):
        return self.ensemble.run(run["index"])

    def is_due(self, run):
        return not is_complete(self.place(run), run["fingerprint"], run["seed"])

    def options(self, words):
        """Options of a program: those of all runs, and what is not said there."""
        threads = os.environ.get("SLURM_CPUS_PER_TASK") or str(self.threads)
        more = {"--threads": threads, "--attach-timeout-s": PATIENCE_S, "--step-timeout-s": PATIENCE_S}
        given = {word.partition("=")[0] for word in words}
        return [*(part for name, value in more.items() if name not in given for part in (name, value)), *words]


def start_pair(pair, unit, runs, home, session):
    """Starts the programs of a run, or of many crowds in one water; what they say goes to the folder."""
    first = runs[0]
    scene = [unit.scene, "--seed", str(first["seed"]), "--session", session]
    logs = {}

    def start(name, command):
        with plain_file.create(home / f"{name}.log") as log:
            logs[name] = home / f"{name}.log"
            return pair.start(command, stdout=log, stderr=log)

    drawn = [] if unit.pictures else NO_PICTURES
    if unit.launcher is not None:
        start("run", [*module_command("wade.run.pair"), *scene, *first["words"], *drawn, *unit.options(unit.launcher),
                      "--out", home, "--no-figure"])
        return logs
    if len(runs) > 1:
        crowds = [{"name": name_of(run["index"]), "set": run["crowd"]} for run in runs]
        (home / "crowds.json").write_text(json.dumps(crowds), encoding="utf-8")
        both, crowd = first["water_words"], ["--crowds", home / "crowds.json"]
    else:
        both, crowd = first["words"], []
    start("fluid_server", [BUILD / "fluid_server", *scene, *both, *unit.options(unit.server), "--out", home])
    pair.controlled = start("crowd_client", [BUILD / "crowd_client", *scene, *both, *crowd, *drawn,
                                             *unit.options(unit.crowd), "--out", home])
    return logs


def why(folder, logs, codes):
    """Why a run failed: that a program was killed, else what the crowd says of it, else the last message of the culprit."""
    cause = meaning(codes)
    culprit = next((name for name, code in zip(logs, codes) if code == cause), list(logs)[-1])
    if cause > 128:
        return f"{culprit} was killed by signal {cause - 128}"
    said = (read_json(folder / "outcome.json") or {}).get("message")
    said = said or message_of(plain_file.read_text(logs[culprit], "backslashreplace")) or "no message"
    return re.sub(r" \(process \d+\)", "", said)


def draw(unit, folder):
    if unit.figures and subprocess.run([*module_command("wade.pictures.figure"), folder],
                                       stdout=subprocess.DEVNULL).returncode != 0:
        print(f"wade run-one: no picture of {folder}", file=sys.stderr)


def hand_in(unit, run, folder, logs, codes):
    """Moves the results of a run into its folder, with the reason if it failed."""
    status = status_of(folder, run["fingerprint"], run["seed"]) if folder.is_dir() else "failed"
    if status == "completed":
        draw(unit, folder)
    else:
        folder.mkdir(exist_ok=True)
        code = meaning(codes) or 1
        reason = why(folder, logs, codes)
        if status == "stale":
            reason = "its scene has changed since the plan was made; the same command with --resume makes it anew"
        failure = {"exit_code": code, "reason": reason, "accident": is_accident(code)}
        (folder / FAILURE).write_text(json.dumps(failure, indent=1), encoding="utf-8")
    publish(folder, unit.place(run), run["fingerprint"], run["seed"])


def hand_in_all(unit, runs, home, logs, codes):
    """Hands in one run, or many and their water; one that cannot be written does not keep the others back."""
    error = None
    for run in runs:
        try:
            hand_in(unit, run, home if len(runs) == 1 else home / name_of(run["index"]), logs, codes)
        except OSError as its_error:
            error = its_error
    if len(runs) > 1:
        keep_water(unit, home)
    if error:
        raise error


def keep_water(unit, home):
    """Keeps what belongs to the water of many runs; of an earlier try it goes."""
    place = unit.ensemble.waters / name_of(unit.index)
    place.parent.mkdir(exist_ok=True)
    remove_tree(place)
    home.rename(place)


def attempt(unit, runs):
    """Does runs, several in one water; (exit code, number of the signal that ended it or 0)."""
    session = worker_name(unit.identity, runs[0]["index"])
    work = unit.ensemble.work / session
    home = work / name_of(runs[0]["index"]) if len(runs) == 1 else work / "water"
    pair = Pair()
    try:
        home.mkdir(parents=True)
        unit.ensemble.runs.mkdir(exist_ok=True)
        logs = start_pair(pair, unit, runs, home, session)
        codes = pair.wait()
        if pair.signal:
            return 130 if pair.signal == signal.SIGINT else 143, pair.signal
        hand_in_all(unit, runs, home, logs, codes)
        return meaning(codes), 0
    except OSError as error:  # a full disk, for example
        pair.send(signal.SIGTERM)
        pair.wait()
        print(f"wade run-one: {work}: {error.strerror or error}", file=sys.stderr)
        return 1, pair.signal
    finally:
        remove_tree(work)
        for kind in ("fluid", "agents"):
            Path(f"/dev/shm/{session}-{kind}").unlink(missing_ok=True)


def carry_out(unit):
    """Does what is due of a unit; the exit code."""
    remove_left_overs(unit.identity, unit.ensemble.work)
    due = [run for run in unit.runs if unit.is_due(run)]
    if not due:
        return 0
    code, number = attempt(unit, due)
    if number == 0 and code == CONFIGURATION and len(due) > 1:
        # One that the crowd refuses makes it refuse the list; each by itself tells which.
        for run in due:
            one, number = attempt(unit, [run])
            if number:
                return one
            code = one or (0 if code == CONFIGURATION else code)
    if number == 0 and code == 0 and any(unit.is_due(run) for run in due):
        return 1
    return code


def read_unit(ensemble, index):
    document = read_json(ensemble.unit(index))
    if document is None:
        raise UsageError(f"{ensemble.plan}: nothing is prepared under index {index}; allowed: those of `tools/wade many --prepare`")
    return Unit(ensemble, document)


def own_share(lines, text):
    """The lines K, K + N, ... for "K/N"."""
    if text == "mpi":
        names = (("OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE"), ("PMI_RANK", "PMI_SIZE"), ("SLURM_PROCID", "SLURM_NTASKS"))
        found = [(os.environ[rank], os.environ[size]) for rank, size in names if rank in os.environ and size in os.environ]
        if not found:
            raise UsageError("--share mpi: there is no rank here; allowed: within mpirun, mpiexec or srun")
        text = "/".join(found[0])
    part, _, parts = text.partition("/")
    if not (part.isdigit() and parts.isdigit() and int(part) < int(parts)):
        raise UsageError(f'--share: "{text}" is not allowed; allowed: K/N with 0 <= K < N, or mpi')
    return lines[int(part) :: int(parts)]


def indices_of(words):
    """Returns the indices of a command line, and whether they are an MPI rank's: its end would end the other ranks."""
    if words and "--of" not in words:
        indices, mpi = " ".join(words).split(), False
    elif len(words) == 4 and words[0] == "--of" and words[2] == "--share":
        indices, mpi = own_share(plain_file.read_text(words[1]).split(), words[3]), words[3] == "mpi"
    else:
        raise UsageError("behind PLAN is allowed: INDEX ..., or --of LIST --share K/N")
    for index in indices:
        if not index.isdigit():
            raise UsageError(f'"{index}" is not allowed; allowed: an index, a whole number')
    return [int(index) for index in indices], mpi


def programs_for(_arguments):
    """None is built: tools/wade many has done so, and all workers take the same."""
    return ()


def carry_out_all(plan, words):
    """Does all indices that are named; the exit code."""
    ensemble = EnsembleFolder(Path(plan).parent)
    code = 0
    indices, mpi = indices_of(words)
    for index in indices:
        one = carry_out(read_unit(ensemble, index))
        if one in (130, 143):
            return one
        code = code or one
    return 0 if mpi else code


def main(arguments):
    """tools/wade run-one."""
    if not arguments or "-h" in arguments or "--help" in arguments:
        print(HELP)
        return 0 if arguments else 2
    try:
        return carry_out_all(arguments[0], arguments[1:])
    except UsageError as error:
        print(f"wade run-one: {error}\n(tools/wade run-one --help tells more)", file=sys.stderr)
        return 2
