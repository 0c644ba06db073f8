"""What `cmake --install` puts serves others: programs in C and C++ find the library by CMake and by pkg-config.

The build is installed as it is, into a folder that is gone afterwards; the .deb holds the same files.
"""

import os
import re
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

from wade import view

ROOT = Path(__file__).resolve().parents[2]
BUILD = Path(os.environ["WADE_PROGRAMS"])

# A producer of three frames that waits for no consumer.
PRODUCER = """
#include <stdio.h>
#include <string.h>
#include <wade_shm.h>

int main(int argc, char** argv) {
    wade_stream stream;
    wade_stream_defaults(&stream);
    strcpy(stream.producer_name, "installed");
    stream.capacity = 1;
    wade_publisher* publisher;
    wade_slot slot;
    if (argc != 2 || wade_publisher_open(argv[1], &stream, NULL, &publisher) != WADE_OK) return 1;
    for (int frame = 1; frame <= 3; ++frame) {
        if (wade_publisher_begin_frame(publisher, &slot) != WADE_OK) return 2;
        *slot.mass = 100;
        *slot.vx = *slot.vy = *slot.vz = 0;
        *slot.px = *slot.py = *slot.pz = 1;
        if (wade_publisher_end_frame(publisher, 1, NULL, frame == 3) != WADE_OK) return 3;
    }
    printf("%d frames\\n", (int)wade_publisher_published_frames(publisher));
    const int closed = wade_publisher_close(publisher);
    wade_publisher_free(publisher);
    return closed == WADE_OK ? 0 : 4;
}
"""

PROJECT = """
cmake_minimum_required(VERSION 3.25)
project(producers C CXX)
find_package(WadeShm 0.1 REQUIRED)
foreach(language c cpp)
  add_executable(producer_${language} producer.${language})
  target_link_libraries(producer_${language} PRIVATE WadeShm::wade_shm)
endforeach()
"""


def output(*command, **options):
    """What a command prints; AssertionError with all that it said if it fails."""
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False, **options)
    assert done.returncode == 0, f"{command}: {done.returncode}\n{done.stdout}\n{done.stderr}"
    return done.stdout


def files_below(folder):
    return {path.relative_to(folder).as_posix() for path in folder.rglob("*") if not path.is_dir()}


class Install(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.prefix = Path(cls.folder.name, "usr")
        output("cmake", "--install", BUILD, "--prefix", cls.prefix)
        cls.library = next(cls.prefix.glob("lib*/**/libwade_shm.so")).parent
        cls.work = Path(cls.folder.name, "work")
        cls.work.mkdir()
        for ending in ("c", "cpp"):
            (cls.work / f"producer.{ending}").write_text(PRODUCER)

    def environment(self, **more):
        of_this_build = ("WADE_BUILD", "PYTHONPATH", "WADE_CONFIGS", "XDG_CACHE_HOME")
        kept = {name: value for name, value in os.environ.items() if name not in of_this_build}
        return {**kept, "LD_LIBRARY_PATH": str(self.library), "HOME": self.folder.name, **more}

    def wade(self, *words):
        """What the installed command prints, called in an empty folder."""
        return output(self.prefix / "bin" / "wade", *words, env=self.environment(), cwd=self.work)

    def assert_produces(self, program):
        session = f"install-{os.getpid()}-{Path(program).name}"
        self.assertEqual(output(program, session, env=self.environment()), "3 frames\n")

    def test_cmake_finds_the_library(self):
        (self.work / "CMakeLists.txt").write_text(PROJECT)
        build = self.work / "build"
        output("cmake", "-G", "Ninja", "-S", self.work, "-B", build, f"-DCMAKE_PREFIX_PATH={self.prefix}")
        output("ninja", "-C", build)
        self.assert_produces(build / "producer_c")
        self.assert_produces(build / "producer_cpp")

    def test_pkg_config_finds_the_library(self):
        environment = self.environment(PKG_CONFIG_PATH=str(self.library / "pkgconfig"))
        flags = output("pkg-config", "--cflags", "--libs", "wade_shm", env=environment).split()
        for compiler, ending in (("cc", "c"), ("c++", "cpp")):
            program = self.work / f"by_pkg_config_{ending}"
            output(compiler, self.work / f"producer.{ending}", "-o", program, *flags)
            self.assert_produces(program)
        example = ROOT / "tools" / "producers" / "c" / "people_producer.c"
        output("cc", example, "-o", self.work / "people_producer", *flags, "-lm")

    def test_programs_say_what_they_are(self):
        for name in ("fluid_server", "crowd_client", "shm_inspect", "shm_clean", "shm_record", "shm_replay"):
            self.assertIn(name, output(self.prefix / "bin" / name, "--version", env=self.environment()))

    def test_the_installed_command_runs_a_scene(self):
        run = Path(self.folder.name, "run")
        scene = self.work / "own.json"  # outside of the project
        scene.write_text('{"extends": "observed/s05", "duration_s": 1}')
        self.wade("run", scene, "--no-figure", "--out", run)
        self.assertIn('"status"', (run / "outcome.json").read_text())

    def test_it_holds_all_data_of_the_sources(self):
        no_data = {".cpp", ".hpp", ".inc", ".cmake", ".md", ".pyc"}
        share = self.prefix / "share" / "wade"
        for folder in ("configs", "tools/python", "tools/viewer/page"):
            code = no_data | {".py"} if folder == "configs" else no_data
            wanted = {name for name in files_below(ROOT / folder) if Path(name).suffix not in code
                      and Path(name).name != "CMakeLists.txt" and "node_modules" not in name}
            self.assertEqual(wanted, files_below(share / folder), folder)

    def test_a_site_runs_with_its_rasters_and_tables(self):
        run = self.work / "site"
        said = self.wade("run", "sites/hamlet", "--until-s", "2", "--out", run)
        self.assertIn(f"picture: {run}/figure.png", said)
        self.assertIn(f"in the browser: wade view {run}", said)
        self.assertTrue((run / "maps" / "max_depth_m.tif").exists())
        for scene in ("sites/village/village", "merewether", "seaside"):
            self.assertIn("valid", self.wade("run", scene, "--check"))

    def test_a_sensitivity_is_planned_run_and_told(self):
        design = self.work / "design"
        self.wade("sensitivity", "observed/s05", "--morris", "2", "--seeds", "1", "--out", design)
        self.wade("many", design / "plan.csv", "--out", design, "--", "--until-s", "1")
        self.wade("sensitivity", design)
        self.assertTrue((design / "sensitivity.md").exists())
        self.wade("table", design)

    def test_the_viewer_starts(self):
        modules = view.modules_folder() / "node_modules"
        if not (modules / "three").exists():
            self.skipTest("three is not there: tools/wade view --install-for-tests")
        own = Path(self.folder.name, ".cache", "wade-viewer")
        shutil.copytree(modules / "three", own / "node_modules" / "three")
        run = self.work / "viewed"
        self.wade("run", "observed/s05", "--until-s", "1", "--no-figure", "--out", run)
        words = [self.prefix / "bin" / "wade", "view", run, "--no-open"]
        with subprocess.Popen(words, stdout=subprocess.PIPE, text=True, env=self.environment(), cwd=self.work) as viewer:
            self.assertIn("viewer: http://127.0.0.1:", viewer.stdout.readline())
            viewer.terminate()

    def test_what_help_lists_can_be_called_by_this_name(self):
        listed = re.findall(r"^  ([a-z][a-z-]+)  ", self.wade("--help"), re.MULTILINE)
        self.assertIn("sensitivity", listed)
        self.assertNotIn("validate", listed)
        for name in listed:
            said = self.wade(name, "--help")
            self.assertRegex(said, rf"^[Uu]sage: wade {name}\b")
            self.assertNotIn("tools/", said)

    def test_what_needs_the_sources_says_so(self):
        for name in ("validate", "test", "fuzz"):
            done = subprocess.run([self.prefix / "bin" / "wade", name, "--quick"], capture_output=True, text=True,
                                  env=self.environment(), check=False)
            self.assertEqual(done.returncode, 2)
            self.assertIn("in the sources", done.stderr)

    def test_bash_completes(self):
        script = self.prefix / "share" / "bash-completion" / "completions" / "wade"
        ask = "COMP_WORDS=({words}); COMP_CWORD={last}; _wade {first}; echo ${{COMPREPLY[*]}}"
        wade = self.prefix / "bin" / "wade"
        for words, reply in (((wade, "dang"), "danger-map"), ((wade, "run", "river/s0"), "river/s05"),
                             ((wade, "run", "river/s05", "--s"), "--set"), ((wade, "run", "river/s05", "--s"), "--seed"),
                             ((wade, "many", "river/s05", "--", "--unt"), "--until-s"), ((wade, "many", "--vary"), "--vary"),
                             ((self.prefix / "bin" / "shm_clean", "--ver"), "--version")):
            asked = ask.format(words=" ".join(map(str, words)), last=len(words) - 1, first=words[0])
            said = output("bash", "-c", f". {script}; {asked}", env=self.environment())
            self.assertIn(reply, said.split())

    @unittest.skipUnless(list(BUILD.glob("man/*.1")), "no man pages: help2man is not installed")
    def test_man_pages_say_what_help_says(self):
        page = (self.prefix / "share" / "man" / "man1" / "crowd_client.1").read_text()
        self.assertIn("until", page)
        self.assertTrue((self.prefix / "share" / "man" / "man1" / "wade.1").exists())

    def test_the_package_holds_the_same_files(self):
        output("cpack", "-G", "DEB", "--config", BUILD / "CPackConfig.cmake", "-B", self.folder.name)
        packages = list(Path(self.folder.name).glob("wade_*.deb"))
        self.assertEqual(len(packages), 1)
        unpacked = Path(self.folder.name, "unpacked")
        output("dpkg-deb", "-x", packages[0], unpacked)
        self.assertEqual(files_below(unpacked / "usr"), files_below(self.prefix))
        self.assertIn("python3", output("dpkg-deb", "-f", packages[0], "Depends"))


if __name__ == "__main__":
    unittest.main()
