"""CMake where optional packages are there in part: each is told in one line and left out, and the rest is configured."""

import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

from harness import PROGRAMS, ROOT, SMALL

from wade import view
from wade.paths import module_command

# A wrapper of Open MPI as openmpi-bin has it, without the headers and libraries of libopenmpi-dev.
HALF_MPI = """#!/bin/sh
case "$*" in
  *-showme:version*) echo "mpicxx: Open MPI 4.1.4 (Language: C++)" ;;
  *-showme:incdirs*) echo {folder}/none/include ;;
  *-showme:libdirs*) echo {folder}/none/lib ;;
  *-showme:libs*) echo mpi_cxx mpi ;;
  *-showme*) echo g++ -I{folder}/none/include -L{folder}/none/lib -lmpi_cxx -lmpi ;;
  *) exec g++ "$@" -I{folder}/none/include -L{folder}/none/lib -lmpi_cxx -lmpi ;;
esac
"""
HALF_ZEROMQ = """Name: libzmq
Description: a description without its library
Version: 4.3.4
Libs: -L{folder}/none/lib -lzmq_of_no_package
Cflags: -I{folder}/include
"""


# Programs of optional parts, which some find first on their path.
BROKEN = ("mpicxx", "mpic++", "mpiCC", "mpirun", "mpiexec", "help2man", "spin", "pkg-config", "gdalinfo", "gdalwarp", "ogr2ogr", "npm",
          "node", "nodejs", "blender", "chromium", "ffmpeg", "parallel")
# A package file as a removed package leaves it, and one without its headers.
WITHOUT_TARGETS = 'include("${CMAKE_CURRENT_LIST_DIR}/Targets-of-no-package.cmake")\n'
WITHOUT_HEADERS = """add_library(benchmark::benchmark INTERFACE IMPORTED)
set_target_properties(benchmark::benchmark PROPERTIES INTERFACE_INCLUDE_DIRECTORIES {folder}/none/include)
"""
ANY_VERSION = "set(PACKAGE_VERSION ${PACKAGE_FIND_VERSION})\nset(PACKAGE_VERSION_COMPATIBLE TRUE)\n"


class Configure(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="wade-test-")
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)

    def file(self, name, text):
        file = self.folder / name
        file.parent.mkdir(exist_ok=True, parents=True)
        file.write_text(text.replace("{folder}", str(self.folder)))
        file.chmod(0o755)
        return file

    def package(self, name, text):
        """A CMake package in the prefix of this test."""
        self.file(f"prefix/lib/cmake/{name}/{name}Config.cmake", text)
        self.file(f"prefix/lib/cmake/{name}/{name}ConfigVersion.cmake", ANY_VERSION)

    def broken_path(self):
        """An environment with broken programs first on the path."""
        for name in BROKEN:
            self.file(f"bin/{name}", "#!/bin/sh\necho cannot load its library >&2\nexit 127\n")
        return {**os.environ, "PATH": f"{self.folder / 'bin'}:{os.environ['PATH']}"}

    def configure(self, *options, **environment):
        """What CMake leaves out, by its first word, and the manifest of ninja. CMake must succeed."""
        words = ["cmake", "--preset", "release", "-B", self.folder / "build", "-DCMAKE_EXPORT_COMPILE_COMMANDS=OFF", *options]
        done = subprocess.run(words, cwd=ROOT, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, env={**os.environ, **environment})
        self.assertEqual(done.returncode, 0, done.stdout)
        self.assertNotIn("CMake Error", done.stdout)
        left_out = {what.split(",")[0]: reason for what, reason in re.findall(r"Left out: (.*) \((.*)\); ", done.stdout)}
        return left_out, (self.folder / "build" / "build.ninja").read_text()

    def assert_without_parts(self, left_out, targets):
        for part in ("fluid_server_ranks", "man pages", "ZeroMQ of bench_protocol", "the addon wade_shm_node"):
            self.assertIn(part, left_out)
        for absent in ("build fluid_server_ranks:", "build man_pages:", "build wade_shm_node:", "WADE_HAS_ZEROMQ"):
            self.assertNotIn(absent, targets)
        self.assertIn("build fluid_server:", targets)

    def test_packages_that_are_there_in_part_are_left_out(self):
        mpi = self.file("mpicxx", HALF_MPI)
        # Answers as a sound one, and makes no page.
        help2man = self.file("help2man", "#!/bin/sh\n[ \"$*\" = --version ]\n")
        self.file("include/zmq.h", "")
        self.file("pc/libzmq.pc", HALF_ZEROMQ)
        self.package("benchmark", WITHOUT_HEADERS)
        left_out, targets = self.configure("-DWADE_BUILD_TESTS=ON", f"-DMPI_CXX_COMPILER={mpi}", f"-DWADE_HELP2MAN={help2man}",
                                           f"-DWADE_NODE_INCLUDE={self.folder}/none", "-DWADE_NODE=/bin/true",
                                           f"-DCMAKE_PREFIX_PATH={self.folder}/prefix", PKG_CONFIG_PATH=str(self.folder / "pc"))
        self.assert_without_parts(left_out, targets)
        self.assertIn("fails with 1", left_out["man pages"])
        self.assertIn("cannot find -lzmq_of_no_package", left_out["ZeroMQ of bench_protocol"])
        self.assertIn("node_api.h: No such file", left_out["the addon wade_shm_node"])
        self.assertIn("bench_kernels", left_out)
        self.assertNotIn("build bench_kernels:", targets)

    def test_a_path_that_is_not_there_beside_sound_ones_is_no_error(self):
        whole = self.file("mpicxx", HALF_MPI.replace("exec g++ \"$@\" -I{folder}/none/include -L{folder}/none/lib -lmpi_cxx -lmpi",
                                                     "exec g++ \"$@\"").replace("echo mpi_cxx mpi", "echo m")
                          .replace("-lmpi_cxx -lmpi", "-lm"))
        self.file("include/mpi.h", "")
        left_out, _ = self.configure(f"-DMPI_CXX_COMPILER={whole}", CPATH=str(self.folder / "include"))
        self.assertIn("fluid_server_ranks", left_out)

    def test_broken_programs_first_on_the_path_are_left_out(self):
        self.package("Catch2", WITHOUT_TARGETS)
        left_out, targets = self.configure(f"-DCMAKE_PREFIX_PATH={self.folder}/prefix", **self.broken_path())
        self.assertIn("the tests", left_out)
        self.assertNotIn("build validate:", targets)
        left_out, targets = self.configure("-DCMAKE_PREFIX_PATH=", "-DWADE_BUILD_TESTS=ON", "-UCatch2_DIR", **self.broken_path())
        self.assert_without_parts(left_out, targets)

    def test_commands_tell_broken_programs_in_a_line(self):
        environment = {**self.broken_path(), "WADE_BUILD": str(PROGRAMS)}
        run, grid = self.folder / "run", self.file("a.asc", "")
        model = ROOT / "tests" / "protocol" / "model" / "check_model.sh"

        def said_by(code, *words):
            done = subprocess.run([*map(str, words)], text=True, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                  stderr=subprocess.STDOUT, env=environment)
            self.assertEqual(done.returncode, code, done.stdout)
            return " ".join(done.stdout.split())

        # Where the page cannot be installed the run goes on.
        shown = [] if view.has_module(view.modules_folder(), "three") else ["--view"]
        said = said_by(0, *module_command("wade.run.pair"), SMALL, *shown, "--no-figure", "--until-s", "1", "--out", run)
        if shown:
            self.assertIn("no viewer beside the run: npm is installed but fails with exit code 127", said)
        self.assertIn("run folder", said)
        self.file("modules/matplotlib/__init__.py", "raise ImportError('libpng is missing')\n")
        environment["PYTHONPATH"] = f"{self.folder}/modules:{environment.get('PYTHONPATH', '')}"
        said = said_by(0, *module_command("wade.run.pair"), SMALL, "--until-s", "1", "--out", self.folder / "drawn")
        self.assertIn("no picture: ImportError: libpng is missing", said)
        self.assertNotIn("Traceback", said)
        environment["PYTHONPATH"] = os.environ.get("PYTHONPATH", "")
        self.assertIn("skipped, spin", said_by(77, model, "--quick"))
        for code, word, *command in ((2, "gdalinfo", "wade.site", "import", grid, "--out", self.folder / "site"),
                                     (2, "blender", "wade.pictures.render", run, "--time", "0"),
                                     (2, "ffmpeg", "wade.pictures.film", run),
                                     (2, "parallel", "wade.many", SMALL, "--engine", "parallel", "--out", self.folder / "many"),
                                     (2, "mpirun", "wade.run.pair", SMALL, "--ranks", "2")):
            said = said_by(code, *module_command(command[0]), *command[1:])
            self.assertIn(f"{word} is installed but fails with exit code 127 (cannot load its library)", said)
            self.assertNotIn("Traceback", said)

    def test_without_their_packages_the_tests_are_left_out(self):
        packages = ("Catch2", "benchmark", "PkgConfig")
        left_out, targets = self.configure(*(f"-DCMAKE_DISABLE_FIND_PACKAGE_{name}=ON" for name in packages))
        self.assertIn("the tests", left_out)
        self.assertIn("build crowd_client:", targets)
        self.assertNotIn("build validate:", targets)
        with self.assertRaisesRegex(AssertionError, "Catch2"):
            self.configure("-DWADE_BUILD_TESTS=ON", "-DCMAKE_DISABLE_FIND_PACKAGE_Catch2=ON")


if __name__ == "__main__":
    unittest.main()
