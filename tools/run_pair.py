#!/usr/bin/env python3
"""Starts fluid_server and crowd_client on one scene, waits for both, prints the outcome and draws the picture.

tools/run.sh calls it once the programs are built. Standard library only.
"""

import ctypes
import json
import os
import re
import secrets
import signal
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
DEFAULT_SCENE = ROOT / "configs" / "paper" / "s05.json"
OWN_VALUES = ("--out", "--session", "--programs")
OWN_SWITCHES = ("--no-figure",)
ANSWERS = ("--check", "--print-config", "--version")  # one program answers and nothing is run
# Exit codes that are only the echo of what happened to the other side: attach time-out, peer dead, peer aborted,
# step time-out. The other side's own code says more.
ECHOES = (3, 4, 5, 7)
PEER_NOTICES_WITHIN_S = 3  # a dead peer is noticed after 50 ms; what waits longer waits for a peer that never came
PR_SET_PDEATHSIG = 1
SEGMENT_PID_AT = 4096 + 144  # the producer's process, see shm_protocol/layout.hpp


class UsageError(Exception):
    """A wrong command line; ends with exit code 2."""


def options_of(program):
    """The options of a program as {name: takes a value}, read from its --help."""
    text = subprocess.run([program, "--help"], capture_output=True, text=True, check=True).stdout
    pattern = re.compile(r"^  (?:-\w,)?(--[a-z0-9-]+)( [A-Z][A-Z=]*)?(?:  |$)", re.MULTILINE)
    return {name: bool(value) for name, value in pattern.findall(text)}


def split_arguments(arguments, server_options, client_options):
    """Sorts arguments into (scene or None, own options, server arguments, client arguments).

    An option goes to each program that has it, one that nobody has goes to both, so that they refuse it.
    """
    takes_value = {**server_options, **client_options}
    takes_value.update(dict.fromkeys(OWN_VALUES, True))
    takes_value.update(dict.fromkeys(OWN_SWITCHES, False))
    scene, own, server, client = None, {}, [], []
    unknown, surplus = False, None
    rest = list(arguments)
    while rest:
        argument = rest.pop(0)
        if not argument.startswith("-"):
            if scene is None:
                scene = argument
            else:
                surplus = surplus or argument
            continue
        name, equals, value = argument.partition("=")
        words = [argument]
        if takes_value.get(name) and not equals:
            if not rest:
                raise UsageError(f"{name}: a value is missing")
            value = rest.pop(0)
            words.append(value)
        if name in OWN_VALUES + OWN_SWITCHES:
            own[name] = value or True
            continue
        nobody = name not in takes_value
        unknown = unknown or nobody
        if name in server_options or nobody:
            server += words
        if name in client_options or nobody:
            client += words
    # After an unknown option this may be its value; then the programs say what is wrong.
    if surplus and not unknown:
        raise UsageError(f'unexpected argument "{surplus}"; one scene file is allowed')
    return scene, own, server, client


def find_scene(name):
    """The scene as named from here, else as named from the project's folder."""
    if name is None:
        return DEFAULT_SCENE
    here = Path(name)
    there = ROOT / name
    return there if not here.exists() and there.exists() else here


def resolved_scene(program, scene, arguments):
    """The resolved scene and 0, or None and the exit code if the program refuses it; it says why on stderr."""
    answer = subprocess.run([program, scene, *arguments, "--print-config"], stdout=subprocess.PIPE, text=True)
    return (json.loads(answer.stdout), 0) if answer.returncode == 0 else (None, answer.returncode)


def new_run_folder(scene_name):
    stem = ROOT / "runs" / f"{scene_name.replace('/', '_') or 'scene'}-{time.strftime('%Y%m%d-%H%M%S')}"
    folder, n = stem, 1
    while folder.exists():
        n += 1
        folder = stem.with_name(f"{stem.name}-{n}")
    return folder


def end_with_parent():
    """Runs in the child: it gets SIGTERM when this process dies, so that no orphan keeps simulating."""
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGTERM)


class Pair:
    """The two processes; signals that this process receives are passed on to both."""

    def __init__(self):
        self.processes = []
        self.signal = 0
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            signal.signal(number, self.pass_on)

    def pass_on(self, number, _frame):
        self.signal = number
        self.send(signal.SIGINT if number == signal.SIGINT else signal.SIGTERM)

    def send(self, number):
        for process in self.processes:
            if process.poll() is None:
                process.send_signal(number)

    def start(self, command, **streams):
        process = subprocess.Popen(command, stdin=subprocess.DEVNULL, preexec_fn=end_with_parent, **streams)
        self.processes.append(process)
        if self.signal:
            self.send(signal.SIGTERM)
        return process

    def wait(self):
        """Waits for all; returns their exit codes in the order of start, None for one that had to be told to end."""
        given_up_at, told = None, set()
        while any(process.poll() is None for process in self.processes):
            if given_up_at is None and any(process.poll() for process in self.processes):
                given_up_at = time.monotonic() + PEER_NOTICES_WITHIN_S
            if given_up_at is not None and time.monotonic() > given_up_at:
                told.update(process.pid for process in self.processes if process.poll() is None)
                self.send(signal.SIGTERM)
                given_up_at = time.monotonic() + PEER_NOTICES_WITHIN_S
            time.sleep(0.02)
        return [None if process.pid in told else exit_code(process) for process in self.processes]


def wait_for_own_segment(server, session):
    """Waits until the session is that of this server or the server has ended.

    A crowd that starts earlier could join another server that lives under the same name, and disturb it.
    """
    while server.poll() is None:
        try:
            with open(f"/dev/shm/{session}-fluid", "rb") as segment:
                segment.seek(SEGMENT_PID_AT)
                if segment.read(4) == server.pid.to_bytes(4, "little"):
                    return
        except OSError:
            pass
        time.sleep(0.01)


def exit_code(process):
    """As a shell shows it: 128 + number of the signal that ended it."""
    return process.returncode if process.returncode >= 0 else 128 - process.returncode


def meaning(codes):
    """The exit code of the pair: the cause rather than its echo on the other side."""
    bad = [code for code in codes if code]
    causes = [code for code in bad if code not in ECHOES]
    return (causes + bad + [0])[0]


def summary(folder):
    """The outcome in words, from outcome.json; empty if there is none."""
    try:
        outcome = json.loads((folder / "outcome.json").read_text())
    except (OSError, ValueError):
        return []
    last = outcome["last_arrival_s"]
    arrival = f", the last after {last:.1f} s" if last is not None else ""
    lines = [
        f"{outcome['scene']}: {outcome['status']}; {outcome['arrived']} of {outcome['agents']} arrived{arrival}; "
        f"{outcome['dead']} dead, {outcome['active']} active"
    ]
    wall, memory = outcome["wall_time_s"], outcome["fluid"].get("resident_bytes")
    if wall:
        simulated = outcome["sim_time_s"]
        speed = f"{simulated:.1f} s simulated in {wall:.1f} s ({simulated / wall:.2f} s per second)"
        lines.append(speed + (f", server memory {memory / 1e6:.0f} MB" if memory else ""))
    return lines


def has_frames(folder):
    try:
        return json.loads((folder / "outcome.json").read_text())["frames"] > 0
    except (OSError, ValueError, KeyError):
        return False


def draw(folder, pair):
    """Draws figure.png; true if it is there afterwards."""
    figure = folder / "figure.png"
    artist = pair.start(["/usr/bin/python3", ROOT / "tools" / "figure.py", folder], stdout=subprocess.DEVNULL)
    return artist.wait() == 0 and figure.exists()


def run(scene, own, server_arguments, client_arguments, programs):
    resolved, code = resolved_scene(programs / "fluid_server", scene, server_arguments)
    if resolved is not None:
        resolved, code = resolved_scene(programs / "crowd_client", scene, client_arguments)
    if resolved is None:
        return code
    folder = Path(own["--out"]) if "--out" in own else new_run_folder(resolved["name"])
    try:
        folder.mkdir(parents=True, exist_ok=True)
        log = open(folder / "fluid_server.log", "w", encoding="utf-8")
    except OSError as error:
        print(f"run.sh: --out: cannot write to {folder}: {error.strerror}", file=sys.stderr)
        return 2
    session = own.get("--session") or f"wade-{os.getuid()}-{os.getpid()}-{secrets.token_hex(4)}"

    pair = Pair()
    common = ["--session", session]
    with log:
        server = pair.start([programs / "fluid_server", scene, *server_arguments, *common], stdout=log, stderr=log)
        wait_for_own_segment(server, session)
        if not server.poll():
            client = [programs / "crowd_client", scene, *client_arguments, *common, "--out", folder]
            pair.start(client, stdout=subprocess.DEVNULL)
        codes = pair.wait()
    code = meaning(codes)
    if "--session" not in own:
        # Only a killed server leaves its segment behind, and nobody else knows this name.
        for kind in ("fluid", "agents"):
            Path(f"/dev/shm/{session}-{kind}").unlink(missing_ok=True)

    if codes[0]:
        print(f"run.sh: fluid_server ended with exit code {codes[0]}; the end of its log:", file=sys.stderr)
        for line in (folder / "fluid_server.log").read_text(errors="replace").splitlines()[-5:]:
            print("  " + line, file=sys.stderr)
    for line in summary(folder):
        print(line)
    print(f"run folder: {folder}")
    if "--no-figure" not in own and not pair.signal and has_frames(folder):
        if draw(folder, pair):
            print(f"picture: {folder / 'figure.png'}")
        else:
            print("run.sh: the picture could not be drawn", file=sys.stderr)
            code = code or 1
    if pair.signal:
        code = 130 if pair.signal == signal.SIGINT else 143
    return code


def main():
    arguments = sys.argv[1:]
    programs = Path(arguments[arguments.index("--programs") + 1])
    server_options = options_of(programs / "fluid_server")
    client_options = options_of(programs / "crowd_client")
    try:
        name, own, server, client = split_arguments(arguments, server_options, client_options)
    except UsageError as error:
        print(f"run.sh: {error} (tools/run.sh --help shows the options)", file=sys.stderr)
        return 2
    scene = find_scene(name)
    if any(answer in client for answer in ANSWERS):
        return subprocess.run([programs / "crowd_client", scene, *client]).returncode
    return run(scene, own, server, client, programs)


if __name__ == "__main__":
    sys.exit(main())
