"""What is installed and built before a run: nothing where nothing is missing, and as much as can be."""

import contextlib
import io
import tempfile
import unittest
from pathlib import Path
from unittest import mock

from wade import building
from wade import UsageError

PAIR = ("fluid_server", "crowd_client")


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
        self.replace("install", lambda *sets: self.installed.append(sets) or True)
        self.replace("can_build", lambda: True)
        self.stale(0)

    def replace(self, name, value):
        patch = mock.patch.object(building, name, value)
        patch.start()
        self.addCleanup(patch.stop)

    def stale(self, files):
        self.replace("files_to_compile", lambda _targets: files)

    def no_write_access(self):
        @contextlib.contextmanager
        def refused():
            raise PermissionError
            yield

        self.replace("locked", refused)

    def bring(self, *targets, **options):
        said = io.StringIO()
        with contextlib.redirect_stderr(said):
            building.bring_up_to_date(targets, **options)
        return said.getvalue()

    def pictures_beside(self, missing, root):
        """What starts beside the build where packages for pictures are missing or not, for root or somebody else."""
        processes, said = mock.MagicMock(), io.StringIO()
        with (
            mock.patch.object(building.importlib.util, "find_spec", lambda _name: None if missing else True),
            mock.patch.object(building.os, "geteuid", lambda: 0 if root else 1000),
            mock.patch.object(building.subprocess, "Popen", processes),
            contextlib.redirect_stderr(said),
            building.installing_pictures(),
        ):
            within = processes.call_count, list(self.installed)
        return *within, list(self.installed)

    def test_pictures_are_installed_beside_the_build_by_root_only(self):
        self.assertEqual(self.pictures_beside(missing=False, root=True), (0, [], []))
        self.assertEqual(self.pictures_beside(missing=True, root=True), (1, [], [("pictures",)]))
        self.installed.clear()
        self.assertEqual(self.pictures_beside(missing=True, root=False), (0, [("pictures",)], [("pictures",)]))

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


class Files(unittest.TestCase):
    def test_the_version_alone_is_nothing_to_compile(self):
        answer = mock.Mock(returncode=0, stdout="[1/5] Version and commit\n[2/5] Building CXX object a/version.cpp.o\n"
                                                "[3/5] Linking CXX executable fluid_server\n")
        with mock.patch.object(building.subprocess, "run", return_value=answer), \
                mock.patch.object(building, "can_build", return_value=True), \
                mock.patch.object(building, "BUILD", mock.MagicMock()):
            self.assertEqual(building.files_to_compile(PAIR), 0)
            answer.stdout += "[4/5] Building CXX object b/agents.cpp.o\n[5/5] Building C object c/crc.c.o\n"
            self.assertEqual(building.files_to_compile(PAIR), 2)
            answer.stdout = "[0/1] Re-running CMake...\n"
            self.assertIsNone(building.files_to_compile(PAIR))


if __name__ == "__main__":
    unittest.main()
