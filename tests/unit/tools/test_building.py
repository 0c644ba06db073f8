"""What is installed and built before a run: nothing where nothing is missing, and as much as can be."""

import contextlib
import fcntl
import io
import subprocess
import tempfile
import threading
import unittest
from pathlib import Path
from unittest import mock

from wade import build_lock, building, cli
from wade import UsageError
from wade.commands import PAIR
from wade.run import processes


class Prepared(unittest.TestCase):
    """A build folder of two programs, with everything that would be started replaced by a note of it."""

    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="wade-test-")
        self.addCleanup(temporary.cleanup)
        self.build = Path(temporary.name) / "build"
        self.build.mkdir()
        (self.build / "build.ninja").touch()
        (self.build / "CMakeCache.txt").write_text(f"CMAKE_HOME_DIRECTORY:INTERNAL={building.ROOT}\nWADE_BUILD_TESTS:BOOL=OFF\n")
        for name in PAIR:
            (self.build / name).touch(0o755)
        self.started, self.installed = [], []
        self.replace("BUILD", self.build)
        self.replace("run_tool", lambda *words: self.started.append(words[0]))
        self.replace("call_and_give_way", lambda command, *_, **__: self.started.append(command[0]) or 0)
        building.install_pictures.cache_clear()
        self.replace("install", lambda *sets: self.installed.append(sets) or True)
        self.replace("can_build", lambda: True)
        self.stale(0)

    def replace(self, name, value):
        patch = mock.patch.object(building, name, value)
        patch.start()
        self.addCleanup(patch.stop)

    def stale(self, files):
        self.replace("steps_left", lambda _targets: ["[1/1] Building CXX object"] * files)

    def no_write_access(self):
        @contextlib.contextmanager
        def refused(*_):
            raise PermissionError
            yield

        self.replace("locked", refused)

    def bring(self, *targets, **options):
        said = io.StringIO()
        with contextlib.redirect_stderr(said):
            building.bring_up_to_date(targets, **options)
        return said.getvalue()

    def pictures_beside(self, missing, root):
        """What starts beside the build where packages for pictures are missing or not, for root or another user."""
        processes, said = mock.MagicMock(), io.StringIO()
        building.install_pictures.cache_clear()
        with (
            mock.patch.object(building.importlib.util, "find_spec", lambda _name: None if missing else True),
            mock.patch.object(building.os, "geteuid", lambda: 0 if root else 1000),
            mock.patch.object(building.subprocess, "Popen", processes),
            contextlib.redirect_stderr(said),
        ):
            building.bring_up_to_date(PAIR, beside=building.installing_pictures)
            built = processes.call_count, list(self.installed)
            building.install_pictures()
        return *built, list(self.installed)

    def test_packages_of_pictures_are_installed_after_those_of_the_build_and_beside_it_by_root_only(self):
        self.stale(3)
        build, pictures = ("build",), ("pictures",)
        self.assertEqual(self.pictures_beside(missing=False, root=True), (0, [build], [build]))
        self.installed.clear()
        self.assertEqual(self.pictures_beside(missing=True, root=True), (1, [build, pictures], [build, pictures]))
        self.installed.clear()
        self.assertEqual(self.pictures_beside(missing=True, root=False), (0, [build, pictures], [build, pictures]))
        self.installed.clear()
        self.stale(0)
        self.assertEqual(self.pictures_beside(missing=True, root=True), (0, [], [pictures]))

    def test_nothing_is_installed_where_nothing_is_to_be_compiled(self):
        self.assertEqual(self.bring(*PAIR), "")
        self.assertEqual((self.started, self.installed), (["ninja"], []))

    def test_stale_programs_are_built_with_the_packages_of_the_build_alone(self):
        self.stale(3)
        self.assertIn("3 files", self.bring(*PAIR))
        self.assertEqual((self.started, self.installed), (["ninja"], [("build",)]))

    def test_programs_that_come_with_the_tests_are_configured_first(self):
        self.assertIn("Configuring", self.bring("validate", with_tests=True))
        self.assertEqual((self.started, self.installed), (["cmake", "ninja"], [("build", "tests")]))

    def test_a_build_of_everything_makes_the_programs_of_a_run_first(self):
        calls = []
        self.replace("run_tool", lambda *words: calls.append(words[3:] if words[0] == "ninja" else words[0]))
        self.replace("call_and_give_way", lambda command, *_, **__: calls.append(tuple(command[3:])) or 0)
        self.bring(with_tests=True)
        self.assertEqual(calls, ["cmake", PAIR, ()])

    def test_programs_that_are_up_to_date_do_not_wait_for_another_build(self):
        with open(self.build / ".lock", "ab") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            self.assertEqual(self.bring(*PAIR), "")
        self.assertEqual((self.started, self.installed), ([], []))

    def test_packages_that_cannot_be_installed_stop_nobody_who_can_build(self):
        self.stale(3)
        self.replace("install", lambda *sets: False)
        self.bring(*PAIR)
        self.assertEqual(self.started, ["ninja"])
        self.replace("can_build", lambda: False)
        (self.build / PAIR[0]).unlink()
        with self.assertRaises(building.BuildError):
            self.bring(*PAIR)

    def test_without_a_build_tool_programs_run_as_they_are(self):
        self.replace("can_build", lambda: False)
        self.assertEqual(self.bring(*PAIR), "")
        self.assertEqual((self.started, self.installed), ([], []))

    def test_without_write_access_programs_run_and_older_ones_with_a_warning(self):
        self.no_write_access()
        self.assertEqual(self.bring(*PAIR), "")
        self.stale(2)
        self.assertIn("older than their sources", self.bring(*PAIR))
        self.assertEqual((self.started, self.installed), ([], []))

    def test_a_build_folder_that_cannot_be_written_is_told_from_other_troubles(self):
        (self.build / ".lock").mkdir()  # stops root, too
        self.assertEqual(self.bring(*PAIR), "")
        self.assertEqual((self.started, self.installed), ([], []))

    def test_without_write_access_missing_programs_are_named(self):
        self.no_write_access()
        (self.build / PAIR[1]).unlink()
        with self.assertRaisesRegex(UsageError, "crowd_client"):
            self.bring(*PAIR)
        with self.assertRaisesRegex(UsageError, "cannot be written"):
            self.bring("bench_fluid", with_tests=True)

    def test_without_write_access_programs_that_lie_with_the_tests_run_too(self):
        self.no_write_access()
        program = self.build / "tests" / "bench" / "bench_fluid"
        program.parent.mkdir(parents=True)
        program.touch(0o755)
        self.assertEqual(self.bring("bench_fluid", with_tests=True), "")

    def test_the_build_folder_of_another_project_is_refused(self):
        (self.build / "CMakeCache.txt").write_text("CMAKE_HOME_DIRECTORY:INTERNAL=/some/other/project\n")
        with self.assertRaisesRegex(UsageError, "/some/other/project"):
            self.bring(*PAIR)
        self.assertEqual(self.started, [])


# What CMake writes, in small: a rule for all, the version that is looked at in each call, globs.
MANIFEST = """
rule CUSTOM_COMMAND
  command = $COMMAND
  description = $DESC
  restat = 1
rule OBJECT
  command = cat $in > $out && echo "$out: $in version.hpp" > $out.d
  depfile = $out.d
  deps = gcc
  description = Building CXX object $out
rule LINK
  command = cat $in > $out && chmod +x $out
  description = Linking CXX executable $out
rule VERIFY_GLOBS
  command = true
  description = Re-checking globbed directories...
  restat = 1
rule RERUN_CMAKE
  command = touch build.ninja
  description = Re-running CMake...
  generator = 1

build CMakeFiles/wade_build_version version.hpp | also.hpp: CUSTOM_COMMAND
  COMMAND = test -e version.hpp || echo 1 > version.hpp
  DESC = Version and commit

build wade_build_version: phony CMakeFiles/wade_build_version version.hpp

build version.cpp.o: OBJECT version.cpp || wade_build_version

build a.cpp.o: OBJECT a.cpp || wade_build_version

build fluid_server: LINK a.cpp.o version.cpp.o

build crowd_client: LINK a.cpp.o version.cpp.o

build force: phony

build globs: VERIFY_GLOBS | force
  pool = console

build build.ninja: RERUN_CMAKE globs | CMakeLists.txt
  pool = console

"""


class Ninja(unittest.TestCase):
    """A small build folder with the real ninja."""

    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="wade-test-")
        self.addCleanup(temporary.cleanup)
        self.build = Path(temporary.name)
        for patched in (building, processes):
            patch = mock.patch.object(patched, "BUILD", self.build)
            patch.start()
            self.addCleanup(patch.stop)
        for name in ("a.cpp", "version.cpp", "CMakeLists.txt", "globs"):
            (self.build / name).touch()
        (self.build / "build.ninja").write_text(MANIFEST)
        self.assertEqual(len(building.steps_left(PAIR)), 5, "before the first build, the version among them")
        subprocess.run(["ninja", "--quiet", "-C", self.build, *PAIR], check=True)

    def test_nothing_is_left_after_a_build_but_the_version_of_the_commit(self):
        self.assertEqual(building.steps_left(PAIR), [])
        steps = subprocess.run(["ninja", "-n", "-C", self.build, *PAIR], capture_output=True, text=True).stdout
        self.assertIn("Re-checking globbed directories", steps)

    def test_each_older_file_is_a_step_also_a_program_that_is_to_be_linked(self):
        (self.build / "fluid_server").unlink()
        self.assertEqual([step.split("] ")[1] for step in building.steps_left(PAIR)], ["Linking CXX executable fluid_server"])
        (self.build / "a.cpp").write_text("new")
        self.assertEqual(len(building.steps_left(PAIR)), 3)

    def test_a_new_version_of_the_commit_is_compiled_and_linked(self):
        (self.build / "version.hpp").write_text("2")
        self.assertNotEqual(building.steps_left(PAIR), [])

    def test_a_changed_list_of_files_is_left_to_cmake(self):
        (self.build / "CMakeLists.txt").write_text("new")
        self.assertIsNone(building.steps_left(PAIR))

    def test_the_logs_of_a_ninja_at_work_are_not_touched(self):
        log = self.build / ".ninja_deps"
        written = log.read_bytes()
        log.write_bytes(written[:-3])  # a record that is being written
        self.assertIsNotNone(building.steps_left(PAIR))
        self.assertEqual(log.read_bytes(), written[:-3])

    def test_a_program_that_is_being_linked_is_started_when_it_is_whole(self):
        program = self.build / "fluid_server"
        program.write_text("#!/bin/sh\necho whole\n")
        tried = threading.Event()
        answers = []
        with open(self.build / ".lock", "ab") as lock, mock.patch.object(processes.time, "sleep", lambda _s: tried.set()):
            fcntl.flock(lock, fcntl.LOCK_EX)
            with open(program, "ab"):
                run = threading.Thread(target=lambda: answers.append(processes.answer_of([program])))
                run.start()
                self.assertTrue(tried.wait(60))
                self.assertEqual(answers, [])
            run.join(60)
        self.assertEqual(answers, [(0, "whole\n")])
        with open(program, "ab"), self.assertRaises(OSError):  # it is not being linked
            processes.answer_of([program])


class Turns(unittest.TestCase):
    """A build of the tests by a program that stands for ninja, and a run that needs its programs."""

    NINJA = """
import signal, sys, time
from pathlib import Path
folder = Path(sys.argv[1])
def note(text):
    with open(folder / "log", "a") as log:
        print(text, file=log)
def end(*_):
    note("ninja ends early")
    sys.exit(2)
signal.signal(signal.SIGTERM, end)
note("ninja")
while not (folder / "done").exists():
    time.sleep(0.01)
note("ninja is done")
"""

    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="wade-test-")
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)
        self.codes = []

    def log(self):
        log = self.folder / "log"
        return log.read_text().splitlines() if log.exists() else []

    def build_tests(self):
        with build_lock.locked(self.folder) as lock:
            command = [building.sys.executable, "-c", self.NINJA, self.folder]
            self.codes.append(build_lock.call_and_give_way(command, lock, self.folder))

    def test_a_run_builds_first_and_then_the_build_of_the_tests_goes_on(self):
        with contextlib.redirect_stderr(io.StringIO()):
            tests = threading.Thread(target=self.build_tests)
            tests.start()
            while not self.log():
                pass
            with build_lock.locked(self.folder, hurries=True) as lock:
                self.assertTrue(lock)
                self.assertEqual(self.log(), ["ninja", "ninja ends early"])
                (self.folder / "done").touch()
            tests.join(60)
        self.assertEqual(self.codes, [0])
        self.assertEqual(self.log(), ["ninja", "ninja ends early", "ninja", "ninja is done"])

    def test_another_build_of_the_tests_waits(self):
        with contextlib.redirect_stderr(io.StringIO()):
            tests = [threading.Thread(target=self.build_tests) for _ in range(2)]
            for build in tests:
                build.start()
            while not self.log():
                pass
            (self.folder / "done").touch()
            for build in tests:
                build.join(60)
        self.assertEqual(self.log(), ["ninja", "ninja is done"] * 2)


class Typing(unittest.TestCase):
    def test_errors_are_told_before_anything_is_installed_or_built(self):
        for words, text in (
            (["--treads", "2"], 'unknown option "--treads"; the nearest is "--threads"'),
            (["rivr/s05"], "did you mean river/s05"),
            (["--set", "/fluid/modle=sph"], 'unknown key "modle"; the nearest known key is "model"'),
            (["--set", "/crowd/tau=2"], "2 is out of range; allowed: >= 0 and <= 1"),
            (["--threads", "many"], "--threads: many is not allowed; allowed: whole numbers from 0 to 1024"),
            (["--until-s=-1"], "--until-s -1: /duration_s: -1 is out of range"),
            ([__file__], "not valid JSON at line 1"),
        ):
            said = io.StringIO()
            with self.subTest(words), mock.patch.object(cli, "bring_up_to_date") as build, \
                    mock.patch.object(cli, "install_pictures") as install, contextlib.redirect_stderr(said):
                self.assertEqual(cli.main(["run", *words]), 2)
                self.assertIn(text, said.getvalue().replace("\n  ", " "))
                build.assert_not_called()
                install.assert_not_called()


if __name__ == "__main__":
    unittest.main()
