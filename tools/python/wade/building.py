"""Brings programs of the build folder up to date before they are run, and installs what that needs.

Nothing is asked of somebody who needs nothing: no root and no packages where the programs are built, no write access
where they are not older than their sources.
"""

import fcntl
import importlib.util
import os
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path

from wade import UsageError
from wade.paths import BUILD, INSTALLED, ROOT, home_folder
from wade.terminal import say_error

PICTURES = ("numpy", "matplotlib", "PIL", "tabulate")


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


def install_pictures():
    """Installs what pictures need, if something is missing; without it, runs go without pictures."""
    home = home_folder()  # matplotlib keeps its list of fonts there
    if str(home) != os.path.expanduser("~"):
        os.environ.setdefault("MPLCONFIGDIR", str(home / "matplotlib"))
    if not all(map(importlib.util.find_spec, PICTURES)) and not install("pictures"):
        say_error("wade: pictures cannot be drawn without " + " and ".join(PICTURES))


@contextmanager
def installing_pictures():
    """Installs what pictures need beside what is done within, if root can do so without a question."""
    alone = INSTALLED or not can_build() or os.geteuid() != 0
    if alone or all(map(importlib.util.find_spec, PICTURES)):
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
    """A build folder that was named belongs to one source folder; another one's programs must not run in its place."""
    home = cached("CMAKE_HOME_DIRECTORY")
    if home and ROOT != Path(home).resolve():
        raise UsageError(f"{BUILD} is the build folder of {home}, not of {ROOT}; name another one in WADE_BUILD")


@contextmanager
def locked():
    """Lets two that start at the same time build one after the other. PermissionError where nothing can be written."""
    try:
        BUILD.mkdir(parents=True, exist_ok=True)
        lock = open(BUILD / ".lock", "ab")
    except OSError as error:  # of another user, or on a medium that is only read
        raise PermissionError from error
    with lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            print(f"waiting for another build in {BUILD}", file=sys.stderr)
            fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def look_again(found):
    """Configures a build folder once more that was configured when something was not there yet; `found` names it in the cache."""
    if (BUILD / "build.ninja").exists() and not cached(found) and can_build():
        subprocess.run(["cmake", "-B", BUILD], cwd=ROOT, stdout=subprocess.DEVNULL)


def files_to_compile(targets):
    """How many files ninja would compile for these targets; None if it cannot tell."""
    if not can_build() or not (BUILD / "build.ninja").exists():
        return None
    steps = subprocess.run(["ninja", "-n", "-C", BUILD, *targets], capture_output=True, text=True)
    if steps.returncode != 0 or "Re-running CMake" in steps.stdout:
        return None
    # version.cpp is listed each time, in case the commit has changed.
    return sum("Building C" in line and "version.cpp" not in line for line in steps.stdout.splitlines())


def is_built(name):
    """Whether there is a program of this name, at the top of the build folder or with the tests."""
    return any(os.access(file, os.X_OK) for file in (BUILD / name, *BUILD.glob(f"tests/*/{name}")))


def run_tool(*words):
    if subprocess.run([*map(str, words)], cwd=ROOT, stdout=sys.stderr).returncode != 0:
        raise BuildError


def build(targets, with_tests):
    """Builds targets, all if none is named, in a folder that is locked."""
    needs_tests = with_tests and cached("WADE_BUILD_TESTS") != "ON"
    count = None if needs_tests or not targets else files_to_compile(targets)
    if count == 0:
        return run_tool("ninja", "--quiet", "-C", BUILD, *targets)
    installed = install("build", *(["tests"] if with_tests else []))
    if not installed and not can_build():
        raise BuildError
    if needs_tests or not (BUILD / "build.ninja").exists():
        print(f"Configuring the release build in {BUILD}", file=sys.stderr)
        run_tool("cmake", "--preset", "release", "-B", BUILD, f"-DWADE_BUILD_TESTS={'ON' if with_tests else 'OFF'}")
        count = files_to_compile(targets)
    what = " ".join(targets) if len(targets) < 4 else f"{len(targets)} programs" if targets else "programs and tests"
    files = f", {count} files" if count else ""
    print(f"Building {what} (release{files}); a full build takes a minute or two", file=sys.stderr)
    run_tool("ninja", "-C", BUILD, *targets)


def check_installed(targets):
    """UsageError if what is to be run is not part of an installation."""
    missing = [name for name in targets if not is_built(name)]
    if missing or not targets:
        raise UsageError(f"{', '.join(missing) or 'this'} is not part of an installation; call tools/wade in the sources")


def bring_up_to_date(targets, with_tests=False):
    """Builds these programs, all if none is named, if they are older than their sources.

    with_tests: they are built only together with the tests. Where nothing can be written, or nothing be built, programs
    that are there are taken as they are. BuildError, UsageError.
    """
    if INSTALLED:
        return check_installed(targets)
    check_owner()
    there = bool(targets) and all(map(is_built, targets))
    if there and not can_build():
        return
    try:
        with locked():
            build(targets, with_tests)
    except PermissionError as error:
        if not there:
            raise UsageError(f"{BUILD} cannot be written, and {' or '.join(targets) or 'a test'} is not built there; build as "
                             "the owner of the project, or name another folder in WADE_BUILD") from error
        if files_to_compile(targets) != 0:
            say_error(f"wade: warning: the programs in {BUILD} are older than their sources and cannot be built anew, as the "
                      "folder cannot be written; they run as they are")
