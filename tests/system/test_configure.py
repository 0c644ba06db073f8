"""CMake where optional packages are there in part: each is told in one line and left out, and the rest is configured."""

import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
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


class Configure(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="wade-test-")
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)

    def file(self, name, text):
        file = self.folder / name
        file.parent.mkdir(exist_ok=True)
        file.write_text(text.replace("{folder}", str(self.folder)))
        file.chmod(0o755)
        return file

    def configure(self, *options, **environment):
        """What CMake says, which must succeed."""
        words = ["cmake", "--preset", "release", "-B", self.folder / "build", "-DCMAKE_EXPORT_COMPILE_COMMANDS=OFF", *options]
        done = subprocess.run(words, cwd=ROOT, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, env={**os.environ, **environment})
        self.assertEqual(done.returncode, 0, done.stdout)
        return dict(re.findall(r"Left out: (.*) \((.*)\); ", done.stdout)), (self.folder / "build" / "build.ninja").read_text()

    def test_packages_that_are_there_in_part_are_left_out(self):
        mpi = self.file("mpicxx", HALF_MPI)
        help2man = self.file("help2man", "#!/bin/sh\nexit 3\n")
        self.file("include/zmq.h", "")
        self.file("pc/libzmq.pc", HALF_ZEROMQ)
        said, targets = self.configure("-DWADE_BUILD_TESTS=ON", f"-DMPI_CXX_COMPILER={mpi}", f"-DWADE_HELP2MAN={help2man}",
                                       f"-DWADE_NODE_INCLUDE={self.folder}/none", "-DWADE_NODE=/bin/true",
                                       PKG_CONFIG_PATH=str(self.folder / "pc"))
        reasons = {what.split(",")[0]: reason for what, reason in said.items()}
        self.assertIn("mpi.h: No such file", reasons["fluid_server_ranks"])
        self.assertIn("fails with 3", reasons["man pages"])
        self.assertIn("cannot find -lzmq_of_no_package", reasons["ZeroMQ of bench_protocol"])
        self.assertIn("node_api.h: No such file", reasons["the addon wade_shm_node"])
        for absent in ("build fluid_server_ranks:", "build man_pages:", "build wade_shm_node:", "WADE_HAS_ZEROMQ"):
            self.assertNotIn(absent, targets)
        self.assertIn("build fluid_server:", targets)

    def test_without_their_packages_the_tests_are_left_out(self):
        packages = ("Catch2", "benchmark", "PkgConfig")
        said, targets = self.configure(*(f"-DCMAKE_DISABLE_FIND_PACKAGE_{name}=ON" for name in packages))
        self.assertIn("the tests", said)
        self.assertIn("build crowd_client:", targets)
        self.assertNotIn("build validate:", targets)
        with self.assertRaisesRegex(AssertionError, "Catch2"):
            self.configure("-DWADE_BUILD_TESTS=ON", "-DCMAKE_DISABLE_FIND_PACKAGE_Catch2=ON")


if __name__ == "__main__":
    unittest.main()
