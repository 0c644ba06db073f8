"""tools/install_dependencies.sh with package managers that only note what they were asked for."""

import os
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

from wade.paths import ROOT

INSTALL = ROOT / "tools" / "install_dependencies.sh"
TOOLS = ("bash", "env", "awk", "grep", "xargs", "fold", "readlink", "cat", "echo")


class Installer(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="wade-test-")
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)
        for name in TOOLS:
            (self.folder / name).symlink_to(shutil.which(name))
        self.asked = self.folder / "asked"

    def program(self, name, script):
        file = self.folder / name
        file.write_text(f"#!/bin/sh\n{script}\n")
        file.chmod(0o755)

    def debian(self, installed=(), user=0):
        lines = "".join(f"echo '{name} installed'\n" for name in installed)
        self.program("dpkg-query", f"{lines}exit 1")
        self.program("apt-get", f'echo "$@" >> {self.asked}')
        self.program("id", f"echo {user}")

    def install(self, *sets):
        environment = {"PATH": str(self.folder), "HOME": os.environ.get("HOME", "/")}
        return subprocess.run([INSTALL, *sets], capture_output=True, text=True, env=environment)

    def packages_asked_for(self):
        last = self.asked.read_text().splitlines()[-1].split()
        return set(last[last.index("--no-install-recommends") + 1 :])

    def test_each_set_is_installed_by_itself_and_all_without_an_argument(self):
        self.debian()
        found = {}
        for sets in (("build",), ("pictures",), ("tests",), ("build", "pictures"), ()):
            self.assertEqual(self.install(*sets).returncode, 0)
            found[sets] = self.packages_asked_for()
        self.assertIn("g++", found["build",])
        self.assertEqual(found["build",] & {"catch2", "spin", "clang", "python3-matplotlib"}, set())
        self.assertIn("python3-matplotlib", found["pictures",])
        self.assertLessEqual({"catch2", "clang-format", "clang-tidy", "shellcheck", "pyflakes3"}, found["tests",])
        self.assertEqual(found["build", "pictures"], found["build",] | found["pictures",])
        self.assertEqual(found[()], found["build",] | found["pictures",] | found["tests",])

    def test_only_what_is_missing_is_asked_for(self):
        self.debian()
        self.install("pictures")
        every = self.packages_asked_for()
        self.debian(installed=every - {"python3-numpy"})
        self.assertEqual(self.install("pictures").returncode, 0)
        self.assertEqual(self.packages_asked_for(), {"python3-numpy"})

    def test_nothing_is_asked_of_anybody_where_nothing_is_missing(self):
        self.debian()
        self.install("build")
        self.debian(installed=self.packages_asked_for(), user=1000)
        self.asked.unlink()
        answer = self.install("build")
        self.assertEqual((answer.returncode, answer.stdout, answer.stderr), (0, "", ""))
        self.assertFalse(self.asked.exists())

    def test_who_is_not_root_goes_by_sudo_or_is_told_the_command(self):
        self.debian(user=1000)
        refused = self.install("pictures")
        self.assertEqual(refused.returncode, 1)
        self.assertIn("apt-get install", refused.stderr)
        self.assertIn("python3-numpy", refused.stderr.replace("\n", ""))
        self.program("sudo", '"$@"')
        self.assertEqual(self.install("pictures").returncode, 0)
        self.assertIn("python3-numpy", self.packages_asked_for())

    def test_the_lock_of_another_apt_is_told_in_one_line(self):
        self.debian()
        self.program("apt-get", "for n in 1 2 3; do echo Waiting for cache lock: held by process $n; done; echo end")
        answer = self.install("build")
        self.assertEqual(answer.returncode, 0)
        self.assertEqual([line for line in answer.stderr.splitlines() if line.startswith("Waiting") or line == "end"],
                         ["Waiting for cache lock: held by process 1", "end"] * 2)
        self.program("apt-get", "echo no space left; exit 100")
        answer = self.install("build")
        self.assertEqual(answer.returncode, 1)
        self.assertIn("no space left", answer.stderr)

    def test_other_systems_are_told_their_names(self):
        self.assertIn("libhwy-dev", self.install("build").stderr.replace("\n", ""))
        self.program("brew", "exit 1")
        answer = self.install("build")
        self.assertEqual(answer.returncode, 1)
        self.assertIn("brew install", answer.stderr)
        self.assertIn("nlohmann-json", answer.stderr.replace("\n", ""))
        self.program("dnf", "exit 1")
        self.program("rpm", "exit 1")
        answer = self.install("build")
        self.assertIn("eigen3-devel", answer.stderr.replace("\n", ""))
        self.program("rpm", "exit 0")
        self.assertEqual(self.install("build").returncode, 0)

    def test_lines_fit(self):
        self.debian(user=1000)
        for answer in (self.install(), self.install("--help"), self.install("nosuchset")):
            for line in (answer.stdout + answer.stderr).splitlines():
                self.assertLessEqual(len(line), 100, line)


if __name__ == "__main__":
    unittest.main()
