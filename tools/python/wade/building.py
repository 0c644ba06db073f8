"""Brings programs of the build folder up to date before they are run, and installs what that needs.

Programs that are built need neither root nor packages, and no write access where they are not older than their sources.
"""

import functools
import importlib.util
import os
import re
import shutil
import subprocess
import sys
from contextlib import contextmanager, nullcontext
from pathlib import Path

from wade import UsageError
from wade.build_lock import call_and_give_way, hand_over, locked, run_waits
from wade.commands import PAIR
from wade.paths import BUILD, INSTALLED, ROOT, home_folder
from wade.run.processes import end_with_parent
from wade.terminal import say_error

PICTURES = ("numpy", "matplotlib", "PIL", "tabulate")
FULL_BUILD = "two minutes on two processors"


class BuildError(Exception):
    """The programs cannot be built; what went before says why."""


def can_build():
    """Whether ninja and CMake are there."""
    return all(any(os.access(Path(place) / tool, os.X_OK) for place in os.get_exec_path()) for tool in ("ninja", "cmake"))


def install(*sets):
    """Installs sets of packages of tools/install_dependencies.sh; false if that failed, which it says itself."""
    if INSTALLED:
        return False
    return subprocess.run([ROOT / "tools" / "install_dependencies.sh", *sets], stdout=sys.stderr).returncode == 0


def pictures_missing():
    """Whether packages that pictures need are missing."""
    return not all(map(importlib.util.find_spec, PICTURES))


@functools.cache
def install_pictures():
    """Installs what pictures need, if something is missing; without it, runs go without pictures. Tries once."""
    home = home_folder()  # matplotlib keeps its list of fonts there
    if str(home) != os.path.expanduser("~"):
        os.environ.setdefault("MPLCONFIGDIR", str(home / "matplotlib"))
    if pictures_missing() and not install("pictures"):
        say_error("wade: pictures cannot be drawn without " + " and ".join(PICTURES))


@contextmanager
def installing_pictures():
    """Installs what pictures need beside what is done within, if root can do so without a question, else before it.

    No other package may be installed meanwhile, as two apt wait for one another.
    """
    if not pictures_missing() or os.geteuid() != 0:
        install_pictures()
        yield
        return
    print("Installing what pictures need, beside the build", file=sys.stderr)
    script = ROOT / "tools" / "install_dependencies.sh"
    # matplotlib makes its list of fonts when it is first used, which takes seconds, too.
    work = ["sh", "-c", '"$0" pictures && exec "$1" -c "import matplotlib.font_manager"', script, sys.executable]
    with subprocess.Popen(work, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL):
        yield
    importlib.invalidate_caches()
    install_pictures()  # is quick now, or says what is wrong


def cached(name):
    """A value of the build folder's CMake cache; empty if there is none."""
    try:
        lines = (BUILD / "CMakeCache.txt").read_text(encoding="utf-8").splitlines()
    except OSError:
        return ""
    value = next((line.partition("=")[2] for line in lines if line.startswith(name + ":")), "")
    return "" if value.endswith("-NOTFOUND") else value


def check_owner():
    """Checks that a named build folder belongs to this source folder: other programs must not run instead."""
    home = cached("CMAKE_HOME_DIRECTORY")
    if home and ROOT != Path(home).resolve():
        raise UsageError(f"{BUILD} is the build folder of {home}, not of {ROOT}; name another one in WADE_BUILD")


def look_again(found):
    """Configures a build folder once more that was configured when something was not there yet; `found` names it in the cache."""
    if (BUILD / "build.ninja").exists() and not cached(found) and can_build():
        with locked(BUILD):
            subprocess.run(["cmake", "-B", BUILD], cwd=ROOT, stdout=subprocess.DEVNULL)


def without_steps_of_each_call(manifest):
    """The text of a build.ninja without what ninja does in each call: the version of the commit, and globs of tests."""
    def version(found):
        return f"build {found[1]}: phony\n\n" if (BUILD / found[2]).exists() else found[0]

    manifest = re.sub(r"^build (\S*/wade_build_version) (\S+) [^\n]*: CUSTOM_COMMAND.*?\n\n", version, manifest,
                      flags=re.MULTILINE | re.DOTALL)
    return re.sub(r"^build \S*: VERIFY_GLOBS .*?\n\n", "", manifest, flags=re.MULTILINE | re.DOTALL)


def steps_left(targets):
    """The steps that ninja would take for these targets; None if it cannot tell.

    Needs no lock, also while another ninja works in the folder: reads a copy of its logs, as ninja -n cuts off the
    last record of a log if it is being written. A program that is being linked has a step left.
    """
    import tempfile  # only here, as the import takes time

    if not can_build():
        return None
    try:
        with tempfile.TemporaryDirectory(prefix="wade-") as folder:
            manifest = without_steps_of_each_call((BUILD / "build.ninja").read_text(encoding="utf-8"))
            Path(folder, "build.ninja").write_text(f"builddir = {folder}\n{manifest}", encoding="utf-8")
            for log in filter(Path.exists, (BUILD / ".ninja_log", BUILD / ".ninja_deps")):
                shutil.copy(log, folder)
            command = ["ninja", "-n", "-C", BUILD, "-f", Path(folder, "build.ninja"), "build.ninja", *targets]
            steps = subprocess.run(command, capture_output=True, text=True)
    except OSError:  # nothing was configured yet, or CMake replaces a file
        return None
    if steps.returncode != 0 or "Re-running CMake" in steps.stdout:
        return None
    return [line for line in steps.stdout.splitlines() if line.startswith("[")]


def is_up_to_date(targets):
    """Whether these programs are there and no older than their sources."""
    return all(map(is_built, targets)) and steps_left(targets) == []


def is_built(name):
    """Whether there is a program of this name, at the top of the build folder or with the tests."""
    return any(os.access(file, os.X_OK) for file in (BUILD / name, *BUILD.glob(f"tests/*/{name}")))


def run_tool(*words):
    if subprocess.run([*map(str, words)], cwd=ROOT, stdout=sys.stderr, preexec_fn=end_with_parent).returncode != 0:
        raise BuildError


def build_and_give_way(lock, *words):
    """Calls ninja for something that no run waits for."""
    if run_waits(BUILD):
        hand_over(lock, BUILD)
    options = {"cwd": ROOT, "stdout": sys.stderr, "preexec_fn": end_with_parent}
    if call_and_give_way([*map(str, words)], lock, BUILD, **options) != 0:
        raise BuildError


def build(targets, with_tests, lock, beside):
    """Builds targets, all if none is named, in a folder that is locked."""
    needs_tests = with_tests and cached("WADE_BUILD_TESTS") != "ON"
    left = None if needs_tests or not targets else steps_left(targets)
    if left == []:
        return run_tool("ninja", "--quiet", "-C", BUILD, *targets)
    installed = install("build", *(["tests"] if with_tests else []))
    if not installed and not can_build():
        raise BuildError
    with beside():
        if needs_tests or not (BUILD / "build.ninja").exists():
            print(f"Configuring the release build in {BUILD}", file=sys.stderr)
            developer = "ON" if with_tests else "OFF"
            run_tool("cmake", "--preset", "release", "-B", BUILD, f"-DWADE_BUILD_TESTS={developer}",
                     f"-DCMAKE_EXPORT_COMPILE_COMMANDS={developer}")
            left = steps_left(targets)
        what = " ".join(targets) if len(targets) < 4 else f"{len(targets)} programs" if targets else "programs and tests"
        count = sum("Building C" in step for step in left or [])
        files = f", {count} files" if count else ""
        print(f"Building {what} (release{files}); a full build takes {FULL_BUILD}", file=sys.stderr)
        if not with_tests:
            return run_tool("ninja", "-C", BUILD, *targets)
        if not targets:
            run_tool("ninja", "-C", BUILD, *PAIR)
        return build_and_give_way(lock, "ninja", "-C", BUILD, *targets)


def check_installed(targets):
    """UsageError if what is to be run is not part of an installation."""
    missing = [name for name in targets if not is_built(name)]
    if missing or not targets:
        raise UsageError(f"{', '.join(missing) or 'this'} is not part of this installation")


def bring_up_to_date(targets, with_tests=False, beside=nullcontext):
    """Builds these programs, all if none is named, if they are older than their sources.

    with_tests: they are built only together with the tests, and runs that wait go first. beside: a context for what is
    done beside the build, after its packages are installed. Programs that are up to date are not waited for, whatever
    else is being built. Where nothing can be written, or nothing be built, programs that are there are taken as they
    are. BuildError, UsageError.
    """
    if INSTALLED:
        return check_installed(targets)
    check_owner()
    there = bool(targets) and all(map(is_built, targets))
    if there and not can_build():
        return
    try:
        with locked(BUILD, not with_tests, lambda: bool(targets) and is_up_to_date(targets)) as lock:
            if lock:
                build(targets, with_tests, lock, beside)
    except PermissionError as error:
        if not there:
            raise UsageError(f"{BUILD} cannot be written, and {' or '.join(targets) or 'a test'} is not built there; build as "
                             "the owner of the project, or name another folder in WADE_BUILD") from error
        if steps_left(targets) != []:
            say_error(f"wade: warning: the programs in {BUILD} are older than their sources and cannot be built anew, as the "
                      "folder cannot be written; they run as they are")
