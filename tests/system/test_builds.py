"""The same bits from four builds: this one, for the processor of the machine; x86-64-v2, as packaged; clang; and arm64.

arm64 is compiled by Debian's cross compiler against arm64 packages that mmdebstrap extracts into the build folder, without
a foreign architecture in dpkg, and runs under qemu-user: tools/install_dependencies.sh builds. The scenes are small, as
qemu-user takes some hundred times as long.
"""

import itertools
import json
import os
import platform
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

from harness import BASIN, PROGRAMS, ROOT, SMALL, Run, SystemTest
from test_lockstep import has_fused_multiply_add

from wade.commands import PAIR
from wade.outside import works

FOLDER = Path(os.environ["WADE_BUILDS"])
ALL = "WADE_ALL" in os.environ  # tools/test.sh --all leaves nothing out
SYSROOT = FOLDER / "arm64_root"
CLANG = ("-DCMAKE_C_COMPILER=clang", "-DCMAKE_CXX_COMPILER=clang++")
ARM64 = ("-DCMAKE_SYSTEM_NAME=Linux", "-DCMAKE_SYSTEM_PROCESSOR=aarch64", "-DCMAKE_C_COMPILER=aarch64-linux-gnu-gcc",
         "-DCMAKE_CXX_COMPILER=aarch64-linux-gnu-g++", f"-DCMAKE_SYSROOT={SYSROOT}", "-DCMAKE_FIND_ROOT_PATH_MODE_PROGRAM=NEVER")
EMULATOR = ("qemu-aarch64", "-L", SYSROOT)
ENVIRONMENT = {**os.environ, "GOMP_SPINCOUNT": "2000"}  # programs that set it start once more, outside of the emulator

PATIENT = ("--attach-timeout-s", "600", "--step-timeout-s", "0")  # on a busy machine
TWO_WAY = ("--set", "/coupling/two_way=true")
BLOCK = ("--set", '/obstacles=[{"x_min_m": 6, "x_max_m": 8, "z_min_m": 5, "z_max_m": 7, "height_m": 0.8}]')
# Residents leave a house in water for a shelter on the slope, past a house at an angle.
SITE = BASIN | {
    "site": BASIN["site"] | {
        "manning": {"n": 0.03}, "water": [{"level_m": 0.1}],
        "houses": [{"polygon": [[8, 4], [11.5, 5], [10.5, 8.5], [7, 7.5]], "residents": 6, "doors": [[11, 6.75]]},
                   {"polygon": [[14, 2], [17, 1], [18, 4], [15, 5]]}],
        "outlets": [{"name": "east", "line": [[24, 1], [24, 6]]}],
        "shelters": [{"name": "hill", "polygon": [[16, 13], [22, 13], [22, 15], [16, 15]]}]},
    "fluid": {"particle_spacing_m": 0.5, "shallow_water": {"cell_size_m": 1}},
    "crowd": {
        "bodies": "human", "markers": "redrawn", "navigation": {"every_s": 1, "slope": "tobler"},
        "height_m": {"min": 1.1, "max": 1.9}, "mass_kg": {"min": 36, "max": 70},
        "groups": [{"name": "residents", "start": {"from": "houses"}, "goal": {"to": "shelters"},
                    "leaves": {"rule": "weibull", "after_s": 0, "scale_s": 2, "shape": 2}},
                   {"name": "walkers", "columns": 3, "rows": 2, "goal": {"to": "shelters"},
                    "start": {"x_m": 18, "z_m": 6, "pitch_x_m": 1, "pitch_z_m": 1}}]},
}


def cases():
    """Scene and options of each run: models x responses x couplings in a river, round a block and among houses."""
    pushed = ("dfsph", "shallow_water", "mixed")
    for model, response in itertools.product((*pushed, "kinematic", "steering"), ("paper", "measured")):
        options = ("--until-s", "2", "--set", f"/fluid/model={model}", "--set", f"/crowd/response={response}")
        yield "river", options
        if model in pushed:
            yield "river", (*options, *TWO_WAY)
    for model in (*pushed, "steering"):
        yield "river", ("--until-s", "1", "--set", f"/fluid/model={model}", *BLOCK)
    for model, response in itertools.product(("dfsph", "shallow_water"), ("paper", "measured")):
        options = ("--until-s", "4", "--set", f"/fluid/model={model}", "--set", f"/crowd/response={response}")
        yield "site", options
        yield "site", (*options, *TWO_WAY)


def make(*words):
    """Carries out a command; AssertionError with what it said if it fails."""
    done = subprocess.run(list(map(str, words)), cwd=ROOT, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    assert done.returncode == 0, f"{words}: {done.returncode}\n{done.stdout[-3000:]}"


def make_sysroot():
    """Extracts the libraries that the project is built with, for arm64."""
    if SYSROOT.exists():
        return
    listed = (ROOT / "tools" / "install_dependencies.sh").read_text(encoding="utf-8")
    packages = ["libc6-dev", *re.findall(r"^build +(\S+-dev) ", listed, re.MULTILINE)]
    release = re.search(r"^VERSION_CODENAME=(\w+)", Path("/etc/os-release").read_text(encoding="utf-8"), re.MULTILINE)[1]
    begun = SYSROOT.with_suffix(".begun")
    make("rm", "-rf", begun)
    make("mmdebstrap", "--quiet", "--variant=extract", "--architectures=arm64", f"--include={','.join(packages)}", release, begun)
    begun.rename(SYSROOT)


@unittest.skipUnless(platform.machine() == "x86_64" and has_fused_multiply_add(), "compares with x86-64 with AVX2 and FMA")
class Builds(SystemTest):
    maxDiff = None

    @classmethod
    def setUpClass(cls):
        cls.site = FOLDER / "site.json"
        cls.site.write_text(json.dumps(SITE))
        cls.expected = {case: cls.bits(PROGRAMS, (), case) for case in cases()}

    @classmethod
    def bits(cls, programs, emulator, case):
        """frame_hash and agents.csv of a run."""
        scene, options = case
        words = [{"river": SMALL, "site": cls.site}[scene], "--session", f"wade-builds-{os.getpid()}", "--threads", "1",
                 "--reproducible", *PATIENT, *options]
        with tempfile.TemporaryDirectory(prefix="wade-test-") as folder, open(Path(folder, "said"), "w+", encoding="utf-8") as said:
            run = Run(Path(folder, "run"))
            started = [subprocess.Popen(list(map(str, (*emulator, programs / name, *words, *more))),
                                        stdout=said, stderr=said, env=ENVIRONMENT)
                       for name, more in (("fluid_server", ()), ("crowd_client", ("--out", run.folder, "--no-trajectories")))]
            codes = [program.wait() for program in started]
            said.seek(0)
            assert codes == [0, 0], f"{case}: {codes}\n{said.read()}"
            return run.outcome()["frame_hash"], run.bytes_of("agents.csv").decode()

    def compare(self, name, *options, needs=(), emulator=()):
        if not works(*needs):
            left_out = f"{' or '.join(needs)} is missing: tools/install_dependencies.sh builds"
            self.fail(left_out) if ALL else self.skipTest(left_out)
        if emulator:
            make_sysroot()
        make("cmake", "--preset", "package", "-B", FOLDER / name, "-DCMAKE_EXPORT_COMPILE_COMMANDS=OFF", *options)
        make("cmake", "--build", FOLDER / name, "--target", *PAIR)
        for case, expected in self.expected.items():
            with self.subTest(case=case):
                self.assertEqual(self.bits(FOLDER / name, emulator, case), expected)

    def test_the_runs_are_worth_comparing(self):
        waters = [water for water, _ in self.expected.values()]
        self.assertNotIn(None, waters)
        self.assertEqual(len(set(self.expected.values())), len(self.expected), "each setting changes something")

    def test_x86_64_v2(self):
        self.compare("packaged")

    def test_clang(self):
        self.compare("clang", *CLANG, needs=("clang++",))

    def test_arm64(self):
        self.compare("arm64", *ARM64, needs=("aarch64-linux-gnu-g++", "qemu-aarch64", "mmdebstrap"), emulator=EMULATOR)


if __name__ == "__main__":
    unittest.main()
