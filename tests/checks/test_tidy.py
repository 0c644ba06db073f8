"""Sources of the product pass the checks of .clang-tidy; each finding is an error.

The test checks the sources that the last commits changed, the newest first and at most MOST, as a file takes seconds.
With WADE_TIDY_ALL=1 it checks all of them.
"""

import json
import os
import shlex
import subprocess
import tempfile
import unittest
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from sources import ROOT, git, tracked

COMMITS = 20
MOST = 4
PRODUCT = ("configs/", "shm_protocol/", "fluid_server/", "crowd_client/", "tools/shm/", "tools/viewer/")


def compiled() -> dict[Path, list[str]]:
    """The command of each source of the product that the build compiles, as clang understands it."""
    database = Path(os.environ["WADE_PROGRAMS"], "compile_commands.json")
    commands = {}
    for entry in json.loads(database.read_text()):
        source = Path(entry["file"])
        if source.is_relative_to(ROOT) and str(source.relative_to(ROOT)).startswith(PRODUCT):
            words = shlex.split(entry["command"])
            commands[source] = [part for word, following in zip(words, words[1:]) for part in
                                ((word, following) if word == "-isystem" else
                                 (word,) if word.startswith(("-I", "-D", "-std", "-fopenmp")) else ())]
    return commands


def changed_last() -> list[Path]:
    """Sources changed by the work tree and the last commits, the newest first."""
    depth = min(COMMITS, len(git("rev-list", "--max-count", str(COMMITS + 1), "HEAD")) - 1)
    names = git("diff", "--name-only", "HEAD")
    for commit in range(depth):
        names += git("diff", "--name-only", f"HEAD~{commit + 1}", f"HEAD~{commit}")
    return [ROOT / name for name in dict.fromkeys(names)]


def tidy(source: Path, flags: list[str]) -> str:
    """What clang-tidy says of one source; empty if it finds nothing."""
    done = subprocess.run(
        ["clang-tidy", "--quiet", f"--config-file={ROOT / '.clang-tidy'}", str(source), "--", *flags, "-march=native"],
        capture_output=True, text=True, check=False)
    return "" if done.returncode == 0 else done.stdout + done.stderr


class Tidy(unittest.TestCase):
    def test_sources_pass(self):
        commands = compiled()
        self.assertGreater(len(commands), 100)
        if os.environ.get("WADE_TIDY_ALL"):
            chosen = [source for source in tracked(".cpp") if source in commands]
        else:
            chosen = [source for source in changed_last() if source in commands][:MOST]
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            said = list(pool.map(lambda source: tidy(source, commands[source]), chosen))
        self.assertFalse(any(said), "".join(said))

    def test_a_fault_is_seen(self):
        with tempfile.TemporaryDirectory() as folder:
            source = Path(folder, "source.cpp")
            source.write_text("int* nothing() { return 0; }\n")
            self.assertIn("modernize-use-nullptr", tidy(source, ["-std=c++20"]))


if __name__ == "__main__":
    unittest.main()
