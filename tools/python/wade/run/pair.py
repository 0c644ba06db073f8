"""Starts a producer of water and crowd_client on one scene, waits for both, prints the outcome and draws the picture.

The producer is fluid_server, shm_replay with --replay, or any command with --producer; --record adds shm_record.
Standard library only.
"""

import importlib.util
import json
import os
import re
import shlex
import signal
import subprocess
import sys
import time
from pathlib import Path

from wade.building import PICTURES, cached, is_built
from wade import UsageError, plain_file
from wade.outside import fault_of
from wade.paths import BUILD, module_command
from wade.reports.files import write_whole
from wade.run.arguments import asks_for_help, help_text, is_given, split_arguments, suit_to_latest, values_of
from wade.run.folders import new_folder
from wade.run.outcome import BeforeRun, crowds_summary, has_frames, state_of, summary
from wade.run.processes import Pair, answer_of, answers_of, end_with_parent, meaning, wait_for_own_segment, wait_until_joined
from wade.scenes import find_scene
from wade.terminal import harmless, say_error, tail_of, wrapped
from wade.view import FIFO, Server, install_modules, settings_for_view

OVER_RANKS = "fluid_server_ranks"
ANSWERS = ("--check", "--print-config", "--version")  # one program answers and nothing is run
PATIENCE_S = "300"  # of the water until its crowd has joined
SHOWN_OF_LOG = 5  # lines, of a program that failed


def programs_for(arguments):
    """The programs of the build folder that a command line needs. UsageError for what is wrong without asking them."""
    run = Run(arguments)
    ranks = [OVER_RANKS] if "--ranks" in run.own else []
    return [*run.arguments, *ranks, *(["wade_view_server"] if run.view else [])]


def check_ranks(arguments):
    """Returns the program that spreads its water over ranks. UsageError without Open MPI or with another producer."""
    for name in ("--replay", "--producer"):
        if is_given(arguments, name):
            raise UsageError(f"{name} and --ranks exclude one another; allowed over ranks: the water of fluid_server")
    if fault := fault_of("mpirun"):
        raise UsageError(f"--ranks: mpirun {fault}; tools/install_dependencies.sh engines installs Open MPI")
    if not (is_built(OVER_RANKS) or cached("MPI_CXX_HEADER_DIR")):
        raise UsageError("--ranks: Open MPI was not there when the programs were built; tools/install_dependencies.sh engines "
                         "installs it, then cmake --preset release")
    return OVER_RANKS


def programs_of(arguments):
    """(name of the producer's program or None, names of all programs that take part)."""
    if is_given(arguments, "--replay") and is_given(arguments, "--producer"):
        raise UsageError("--replay and --producer exclude one another")
    producer = "shm_replay" if is_given(arguments, "--replay") else "fluid_server"
    if is_given(arguments, "--producer"):
        producer = None
    recorder = ["shm_record"] if is_given(arguments, "--record") else []
    return producer, [name for name in (producer, "crowd_client", *recorder) if name]


def has_view(arguments):
    """Whether the page is shown beside the run."""
    return is_given(arguments, "--view") or is_given(arguments, "--view-port")


def without_comments(text):
    """Returns JSON with blanks instead of the comments that scenes may have."""
    blank = lambda found: found[0] if found[0].startswith('"') else re.sub(r"[^\n]", " ", found[0])  # noqa: E731
    return re.sub(r'"(?:\\.|[^"\\\n])*"|//[^\n]*|/\*.*?\*/', blank, text, flags=re.DOTALL)


def check_files(scene, own, arguments):
    """Refuses files that cannot be read, and a scene that is no JSON; what they hold the programs check. UsageError."""
    named = {name: [file for words in arguments.values() for file in values_of(words, name)]
             for name in ("--from-state", "--crowds")}
    named["--replay"] = [own["--replay"]] if "--replay" in own else []
    allowed = {"--from-state": "a state that --save-state FILE has written", "--crowds": "a JSON list of crowds",
               "--replay": "a recording"}
    for name, files in named.items():
        for file in files:
            try:
                plain_file.open_plain(file).close()
            except plain_file.FileError as error:
                raise UsageError(f"{name}: {file} cannot be read: {error.strerror}; allowed: {allowed[name]}") from error
    try:
        if scene.is_file():
            json.loads(without_comments(plain_file.read_text(scene).removeprefix("\ufeff")))
    except json.JSONDecodeError as error:
        raise UsageError(f"{scene}: not valid JSON at line {error.lineno}, column {error.colno}: {error.msg}") from error
    except OSError as error:
        raise UsageError(f"{scene} cannot be read: {error.strerror}") from error
    except (ValueError, RecursionError):  # no UTF-8, or too deep
        pass


def producer_command(run, folder, session):
    """The command line of whatever sends the water."""
    own, arguments = run.own, run.arguments
    latest = "latest" in values_of(arguments["crowd_client"], "--mode")
    consumers = 0 if latest else 2 if "--record" in own else 1
    counted = ["--consumers", str(consumers)] if consumers > 1 else []
    if run.producer == "fluid_server":
        server = [BUILD / "fluid_server", run.scene]
        if "--ranks" in own:
            mpirun = ["mpirun", "-q", *shlex.split(own.get("--mpirun", "")), "-np", own["--ranks"]]
            server = [*mpirun, BUILD / OVER_RANKS, run.scene]
        # The pair ends with its first program, so that a crowd that takes long to set up is waited for.
        patience = [] if is_given(arguments["fluid_server"], "--attach-timeout-s") else ["--attach-timeout-s", PATIENCE_S]
        # Its log is our redirection to the same file; after a numerical failure it leaves the water's state there.
        return [*server, *counted, *patience, *arguments["fluid_server"], "--session", session, "--out", folder]
    if run.producer == "shm_replay":
        coupling = run.resolved.get("coupling", {})
        way_back = coupling.get("agents_stream", "off") != "off"
        switches = ["--take-agents"] if way_back else []
        replay = [BUILD / "shm_replay", own["--replay"]]
        return [*replay, *switches, *counted, *arguments["shm_replay"], "--session", session]
    words = shlex.split(own["--producer"])
    if not any("{session}" in word for word in words):
        words += ["--session", "{session}"]
    known = {"{session}": session, "{scene}": str(run.scene), "{consumers}": str(consumers)}
    for place, value in known.items():
        words = [word.replace(place, value) for word in words]
    return words


def stdin_of_client(arguments):
    """The terminal, or whatever the user says the commands come from; None = that of this process."""
    from_stdin = "--commands=-" in arguments or ("--commands", "-") in zip(arguments, arguments[1:])
    return None if sys.stdin.isatty() or from_stdin else subprocess.DEVNULL


class Artist:
    """The process that draws figure.png. It loads its modules and fonts while the run goes on, and draws when the run has ended."""

    def __init__(self, folder):
        self.figure = folder / "figure.png"
        self.process = subprocess.Popen([*module_command("wade.pictures.figure"), folder, "--when-told"], stdin=subprocess.PIPE,
                                        stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, errors="backslashreplace",
                                        preexec_fn=end_with_parent)

    def draw(self, pair):
        """Draws; returns why there is no picture, "" if there is one. Signals that the run receives are passed on."""
        pair.processes.append(self.process)
        _, said = self.process.communicate("draw\n")
        if self.process.returncode == 0 and self.figure.exists():
            return ""
        return said.strip() or "it ended early"

    def leave(self):
        """Lets the process end without a picture."""
        if self.process.poll() is None and not self.process.stdin.closed:
            self.process.communicate()


class Run:
    """What the command line asks for."""

    def __init__(self, arguments):
        self.producer, names = programs_of(arguments)
        scene, self.own, self.arguments = split_arguments(arguments, names)
        if "--ranks" in self.own:
            check_ranks(arguments)
        suit_to_latest(self.arguments)
        self.view = has_view(arguments)
        if self.view and is_given(arguments, "--crowds"):
            raise UsageError("--view shows one crowd; allowed with --crowds: none (tools/wade view DIR/<name> later)")
        self.scene = find_scene(scene)
        self.resolved = None
        self.suits_view = False
        check_files(self.scene, self.own, self.arguments)

    def check_scene(self):
        """Reads the scene as the programs do; returns the exit code of the one that refuses it, else 0."""
        programs = [name for name in ("fluid_server", "crowd_client") if name in self.arguments]
        for code, text in answers_of([[BUILD / name, self.scene, *self.arguments[name], "--print-config"] for name in programs]):
            if code != 0:
                return code
            self.resolved = json.loads(text)
        if self.view and not self.suits_view:
            return self.suit_to_view()
        if "--replay" in self.own and self.resolved["coupling"]["two_way"]:
            raise UsageError("/coupling/two_way: a recording cannot answer people who push it; allowed with --replay: false")
        return 0

    def suit_to_view(self):
        """Lets the run keep what the page shows, but for what the user said himself, and checks the scene again."""
        both, crowd = settings_for_view(self.resolved, [word for words in self.arguments.values() for word in words])
        for name in ("fluid_server", "crowd_client"):
            if name in self.arguments:
                self.arguments[name] += both
        self.arguments["crowd_client"] += crowd
        if "--replay" in self.own and both:
            self.arguments["shm_replay"].append("--any-scene")  # poses change no path, but the hash of the scene
        self.suits_view = True
        return self.check_scene()


def start_viewer(run, folder, session):
    """The page beside a run that is about to start; prints its address."""
    given = values_of(run.arguments["crowd_client"], "--commands")
    fifo = given[0] if given else folder / FIFO
    if not given:
        run.arguments["crowd_client"] += ["--commands", str(fifo)]
    scene = folder / ".scene.json"
    write_whole(scene, json.dumps(run.resolved))
    server = Server("--run", folder, "--session", session, "--scene", scene, "--commands", fifo, "--starts",
                    port=run.own.get("--view-port", 0), folder=folder)
    if server.address:
        print(f"viewer: {server}", flush=True)
    return server


def viewer_of(run, folder, session):
    """As start_viewer; None, with a message, where the page's packages cannot be installed: the run goes on without it."""
    try:
        install_modules()
    except UsageError as error:
        say_error(f"wade run: no viewer beside the run: {error}")
        return None
    return start_viewer(run, folder, session)


def stay(viewer, pair):
    """Lets the page show the run that is over, until the user has seen enough."""
    if pair.signal == 0 and viewer.process.poll() is None:
        print(f"viewer: {viewer} goes on; Ctrl-C ends it", flush=True)
    while pair.signal == 0 and viewer.process.poll() is None:
        time.sleep(0.1)
    viewer.end()


def region_of(run):
    """The region of a recording that is rounded and was given none: the world and the channel of the scene, and 1 m more."""
    arguments = run.arguments["shm_record"]
    if "--quantised" not in arguments or is_given(arguments, "--region"):
        return []
    world, channel = run.resolved["world"], run.resolved["channel"]
    ends = (min(0, channel["x_min_m"]) - 1, max(world["length_m"], channel["x_max_m"]) + 1,
            min(0, channel["z_min_m"]) - 1, max(world["width_m"], channel["z_max_m"]) + 1)
    return ["--region=" + ",".join(f"{end:g}" for end in ends)]


def start_all(run, pair, folder, session):
    """Starts the producer, the recorder if there is one, and the crowd; returns {name: (process, its log or None)}."""
    producer_name = run.producer or "the producer"
    started = {}

    def start_logged(name, command, log_name):
        log = folder / log_name
        with plain_file.create(log) as file:
            try:
                started[name] = pair.start(command, stdout=file, stderr=file), log
            except OSError as error:
                raise UsageError(f"cannot start {command[0]}: {error.strerror}") from error
        return started[name][0]

    # Over ranks the server writes its log itself, as mpirun, which ends them, drops last words.
    log_name = "mpirun.log" if "--ranks" in run.own else "fluid_server.log" if run.producer == "fluid_server" else "producer.log"
    producer = start_logged(producer_name, producer_command(run, folder, session), log_name)
    wait_for_own_segment(producer, session)
    if "--record" in run.own:
        command = [BUILD / "shm_record", session, run.own["--record"], *run.arguments["shm_record"], *region_of(run)]
        recorder = start_logged("shm_record", command, "shm_record.log")
        if not wait_until_joined(recorder, producer, session):
            return started
    if not producer.poll():
        arguments = run.arguments["crowd_client"]
        command = [BUILD / "crowd_client", run.scene, *arguments, "--session", session, "--out", folder]
        client = pair.start(command, stdin=stdin_of_client(arguments), stdout=subprocess.DEVNULL)
        started["crowd_client"] = client, None
        pair.controlled = client
    return started


def tell_failures(started, codes):
    """Shows the ends of the logs of programs that failed; what has no log has said it itself."""
    for (name, (_process, log)), ended in zip(started.items(), codes):
        own_log = log and log.with_name("fluid_server.log")
        if log and log.name == "mpirun.log" and own_log.is_file() and own_log.stat().st_size > 0:
            log = own_log
        if ended and log:
            print(f"wade run: {name} ended with exit code {ended}; the end of its log:", file=sys.stderr)
            print(*("  " + line for line in tail_of(log, SHOWN_OF_LOG)), sep="\n", file=sys.stderr)


def why_no_picture(run):
    """Why a run is not drawn, "" if it is."""
    if not all(map(importlib.util.find_spec, PICTURES)):
        return f"{', '.join(PICTURES)} are not all installed"
    if is_given(run.arguments["crowd_client"], "--no-trajectories"):
        return "--no-trajectories leaves no paths to draw"
    return ""


def picture(run, folder, pair, artist):
    """Draws the run unless there is a reason not to, and says so; false if the picture failed."""
    why = why_no_picture(run) if artist is None else artist.draw(pair)
    if not why:
        print(f"picture: {folder / 'figure.png'}")
        if not run.view:
            print(f"in the browser: tools/wade view {folder}")
    elif artist is None or re.match(r"\w*(ImportError|ModuleNotFoundError)", why.split("\n")[-1]):
        print(wrapped(harmless(f"no picture: {why.split(chr(10))[-1]}")))  # packages that are installed in part
    else:
        say_error(f"{why}\nwade run: the picture could not be drawn")
        return False
    return True


def carry_out(run):
    """Runs everything to its end; returns the exit code."""
    code = run.check_scene()
    if code:
        return code
    own = run.own
    folder = Path(own["--out"]) if "--out" in own else new_folder(run.resolved["name"])
    session = own.get("--session") or f"wade-{os.getuid()}-{os.getpid()}-{os.urandom(4).hex()}"
    recording = Path(own["--record"]) if "--record" in own else None
    earlier_recording = recording and state_of(recording)
    many = is_given(run.arguments["crowd_client"], "--crowds")
    pair = Pair()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        before = BeforeRun(folder, many)
        viewer = viewer_of(run, folder, session) if run.view else None
        if viewer and not viewer.address:
            return viewer.wait()
        started = start_all(run, pair, folder, session)
        artist = None if many or "--no-figure" in own or why_no_picture(run) else Artist(folder)
    except OSError as error:
        raise UsageError(f"--out: cannot write to {folder}: {error.strerror}") from error
    codes = pair.wait()
    code = meaning(codes)
    if "--session" not in own:
        # Only a killed producer leaves its segment behind, and no other run knows this name.
        for kind in ("fluid", "agents"):
            Path(f"/dev/shm/{session}-{kind}").unlink(missing_ok=True)

    tell_failures(started, codes)
    if before.has_new_results():
        for line in crowds_summary(folder) if many else summary(folder):
            print(wrapped(harmless(line)))
    if left := before.left_from_earlier():
        print(wrapped(f"of an earlier run, not of this one: {', '.join(left)}"))
    print(f"run folder{'s below' if many else ''}: {folder}")
    if recording and state_of(recording) not in (None, earlier_recording):
        print(f"recording: {recording}")
    drawable = not many and not pair.signal and before.has_new_results() and has_frames(folder)
    if "--no-figure" not in own and drawable and not picture(run, folder, pair, artist):
        code = code or 1
    if artist:
        artist.leave()
    if viewer:
        interrupted = pair.signal
        stay(viewer, pair)
        (folder / ".scene.json").unlink(missing_ok=True)
        return code if not interrupted else 130 if interrupted == signal.SIGINT else 143
    if pair.signal:
        code = 130 if pair.signal == signal.SIGINT else 143
    return code


def answer(run):
    """Prints what the programs say to --check, both, or else the crowd; the exit code of the one that refuses, else 0."""
    said = []
    for name in ("fluid_server", "crowd_client"):
        if name in run.arguments:
            code, text = answer_of([BUILD / name, run.scene, *run.arguments[name]])
            if code != 0:
                return code
            lines = text.splitlines()
            both = "--check" in run.arguments["crowd_client"]
            said = [*said, *(line for line in lines if line not in said)] if both else lines
    print("\n".join(said))
    return 0


def main(arguments):
    """tools/wade run."""
    if asks_for_help(arguments):
        print(help_text())
        return 0
    try:
        run = Run(arguments)
        return answer(run) if any(word in run.arguments["crowd_client"] for word in ANSWERS) else carry_out(run)
    except UsageError as error:
        say_error(f"wade run: {error} (tools/wade run --help shows the options)")
        return 2
