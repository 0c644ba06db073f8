"""The viewer in the browser: its npm package, its server, `tools/wade view`, and what `tools/wade run --view` needs of it."""

import argparse
import contextlib
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

from wade import UsageError, plain_file
from wade.outside import require
from wade.paths import BUILD, INSTALLED, ROOT, home_folder
from wade.run.processes import end_with_parent, resolved
from wade.terminal import Parser, say_error

PAGE = ROOT / "tools" / "viewer" / "page"
# What --view records for the page, unless the user says otherwise: poses a second, water and terms every so many seconds. The
# slower ones are for many people over a long time, so that a table has no more than so many rows.
POSES_HZ, WATER_S, TERMS_S = (10, 5, 2, 1, 0.5), 0.5, (0.1, 0.2, 0.5, 1, 2)
MOST_ROWS = 2e6
FIFO = ".commands"  # in the run folder


def modules_folder():
    """Where npm puts three: build/viewer, or a folder of the user's own where it cannot be written or nothing is built."""
    folder = home_folder() / ".cache" / "wade-viewer" if INSTALLED else ROOT / "build" / "viewer"
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        return home_folder() / ".cache" / "wade-viewer"
    return folder if os.access(folder, os.W_OK) else home_folder() / ".cache" / "wade-viewer"


def wanted_version(name):
    """The version of a package that the lock file names."""
    lock = json.loads((PAGE / "package-lock.json").read_text(encoding="utf-8"))
    return lock["packages"][f"node_modules/{name}"]["version"]


def has_module(folder, name):
    """Whether a package is there in the version of the lock file."""
    try:
        there = plain_file.read_json(folder / "node_modules" / name / "package.json")
    except plain_file.FileError:
        return False
    return there["version"] == wanted_version(name)


def install_modules(with_tests=False):
    """The folder of npm's packages of the page; installs them from the lock file if they are not there. UsageError."""
    folder = modules_folder()
    if all(has_module(folder, name) for name in ("three", *(["playwright-core", "axe-core"] if with_tests else []))):
        return folder
    require("npm", "the viewer needs it (tools/install_dependencies.sh viewer); runs do not")
    print(f"Installing three {wanted_version('three')} for the viewer in {folder}, once, by npm", file=sys.stderr)
    folder.mkdir(parents=True, exist_ok=True)
    for name in ("package.json", "package-lock.json"):
        shutil.copyfile(PAGE / name, folder / name)
    words = ["npm", "ci", "--ignore-scripts", "--no-audit", "--no-fund", "--no-update-notifier", *([] if with_tests else ["--omit=dev"])]
    if subprocess.run(words, cwd=folder, stdout=sys.stderr).returncode != 0:
        raise UsageError("npm could not install what the viewer needs; its messages above say why (network?)")
    return folder


OPENER = "view.html"  # in the run folder
ENDING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


def begin_server():
    """Runs in the server's process before its program: signals end it, and it ends with its parent."""
    signal.pthread_sigmask(signal.SIG_UNBLOCK, ENDING)
    end_with_parent()


def write_opener(file, address):
    """Writes the page, for its owner alone, that leads a browser to an address with a key, which stands on no command line then."""
    text = ('<!doctype html><meta charset="utf-8"><title>Wade</title>'
            f"<script>location.replace('{address}' + location.hash)</script><a href=\"{address}\">the viewer</a>\n")
    file.unlink(missing_ok=True)
    with os.fdopen(os.open(file, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW, 0o600), "w", encoding="utf-8") as opener:
        opener.write(text)


class Server:
    """wade_view_server as a process, with the address that it has printed. Where a folder is given, its OPENER opens the page."""

    def __init__(self, *arguments, port=0, folder=None):
        three = install_modules() / "node_modules" / "three"
        command = [BUILD / "wade_view_server", "--page", PAGE, "--three", three, "--port", str(port), *arguments]
        self.process = subprocess.Popen([*map(str, command)], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                        text=True, preexec_fn=begin_server)
        self.address = self.process.stdout.readline().strip()  # with the key of the page
        self.opener = None
        if folder is not None and self.address:
            try:
                self.open_by(folder)
            except BaseException:  # a signal leaves no file with the key
                self.end()
                raise

    def open_by(self, folder):
        """Writes the opener into a folder, or into one of its own if that cannot be written."""
        try:
            self.opener = Path(folder).resolve() / OPENER
            write_opener(self.opener, self.address)
        except OSError:
            self.opener = Path(tempfile.mkdtemp(prefix="wade-view-")) / OPENER
            write_opener(self.opener, self.address)

    def __str__(self):
        return f"{self.address.split('?')[0]}, opened by {self.opener.as_uri() if self.opener else 'its key'}"

    def wait(self):
        """Waits for its end; returns its exit code, 0 if the user has ended it."""
        try:
            code = self.process.wait()
        except KeyboardInterrupt:
            self.end()
            return 0
        self.remove_opener()
        return 0 if code in (-2, -15, 130, 143) else code

    def end(self):
        self.process.terminate()
        self.process.wait()
        self.remove_opener()

    def remove_opener(self):
        """Removes the opener unless it is another server's by now."""
        if self.opener is None:
            return
        with contextlib.suppress(OSError):
            if self.address in plain_file.read_text(self.opener):
                self.opener.unlink()
                if self.opener.parent.name.startswith("wade-view-"):
                    self.opener.parent.rmdir()


def settings_for_view(resolved_scene, arguments):
    """Options that a run with --view has beyond those that the user gave: {program: options}."""
    given = " ".join(arguments)
    both, crowd = [], []
    seconds_of_people = resolved_scene["duration_s"] * sum(group["count"] for group in resolved_scene["crowd"]["groups"])
    poses_hz, terms_s = next((pair for pair in zip(POSES_HZ, TERMS_S) if pair[0] * seconds_of_people <= MOST_ROWS),
                             (POSES_HZ[-1], TERMS_S[-1]))
    if resolved_scene["crowd"]["poses"]["rate_hz"] == 0 and "/crowd/poses" not in given:
        both += ["--set", f"/crowd/poses/rate_hz={poses_hz}"]
    if "--water-every-s" not in given:
        crowd += ["--water-every-s", str(WATER_S)]
    if "--terms-every-s" not in given:
        crowd += ["--terms-every-s", str(terms_s)]
    return both, crowd


def live_session(folder):
    """Options for a run that goes on in a folder: the session of its manifest, and its FIFO of commands."""
    try:
        session = plain_file.read_json(folder / "manifest.json")["session"]
    except plain_file.FileError:
        return []
    if not session or not Path(f"/dev/shm/{session}-fluid").exists():
        return []
    fifo = folder / FIFO
    return ["--session", session, *(["--commands", fifo] if fifo.is_fifo() else [])]


def options_for(target, options):
    """The server's options for a run folder or a recording."""
    words = []
    if target is not None and target.is_dir():
        recordings = sorted(target.glob("*.wrec"))
        words += ["--run", target, *live_session(target)]
        if recordings and options.recording is None:
            words += ["--recording", recordings[0]]
    elif target is not None and target.is_file():
        words += ["--recording", target]
    elif target is not None:
        raise UsageError(f"there is no run folder or recording {target}")
    if options.recording is not None:
        if not options.recording.is_file():
            raise UsageError(f"--recording: there is no file {options.recording}")
        words += ["--recording", options.recording]
    if options.session is not None:
        words += ["--session", options.session]
    if not words:
        raise UsageError("what to show is missing: a run folder, a recording, or --session NAME")
    return words


def parser_of_view():
    parser = Parser("view", "Shows a run in the browser: water, people, paths, time line, at 127.0.0.1. A run may go on, "
                    "have ended or been killed.")
    parser.add_argument("target", type=Path, nargs="?", metavar="RUN|RECORDING", help="run folder, or file of --record")
    parser.add_argument("--recording", type=Path, metavar="FILE", help="recording of the water of this run")
    parser.add_argument("--session", metavar="NAME", help="a session that runs")
    parser.add_argument("--scene", metavar="SCENE", help="the scene of a recording or session, for its ground and goals")
    parser.add_argument("--port", type=int, default=0, help="port at 127.0.0.1 [any that is free]")
    parser.add_argument("--no-open", action="store_true", help="open no browser, only print what opens the page")
    # npm's packages for the test of the page.
    parser.add_argument("--install-for-tests", action="store_true", help=argparse.SUPPRESS)
    return parser


def main(arguments):
    """tools/wade view."""
    import webbrowser  # only where it is needed, as every run reads this module

    options = parser_of_view().parse_args(arguments)
    try:
        if options.install_for_tests:
            print(install_modules(with_tests=True))
            return 0
        words = options_for(options.target, options)
        for number in (signal.SIGTERM, signal.SIGHUP):  # as Ctrl-C, so that the file with the key goes
            signal.signal(number, signal.default_int_handler)
        # Python drops an exception of a signal that comes within a callback, as of an import.
        signal.pthread_sigmask(signal.SIG_BLOCK, ENDING)
        with tempfile.TemporaryDirectory() as folder:
            if options.scene:
                from wade.scenes import find_scene

                scene = Path(folder) / "scene.json"
                scene.write_text(json.dumps(resolved(find_scene(options.scene))), encoding="utf-8")
                words += ["--scene", scene]
            is_folder = options.target is not None and options.target.is_dir()
            server = Server(*words, port=options.port, folder=options.target if is_folder else folder)
            said = f"viewer: {server}  (Ctrl-C ends it)" if server.address else ""
            try:
                signal.pthread_sigmask(signal.SIG_UNBLOCK, ENDING)
                if not server.address:
                    return server.wait()
                print(said, flush=True)
                if not options.no_open and (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
                    webbrowser.open(server.opener.as_uri())
                return server.wait()
            finally:
                server.end()
    except KeyboardInterrupt:  # before the wait for the server's end
        return 0
    except UsageError as error:
        say_error(f"wade view: {error}")
        return 2
