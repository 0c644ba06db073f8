"""All recipes of CONTRIBUTING.md together, carried out in a clone of the tree, pass what a change must pass: .ci/run."""

import os
import re
import shutil
import subprocess
import unittest
from pathlib import Path

from apply_recipe import carry_out

ROOT = Path(__file__).resolve().parents[2]
CLONE = Path(os.environ["WADE_CLONE"])
OF_OUTER_RUN = ("WADE_", "CTEST_", "PYTHON")  # names of variables that the inner run must not see begin so


def git(*words, folder=ROOT, **options):
    return subprocess.run(["git", "-C", folder, *words], check=True, stdout=subprocess.PIPE, **options).stdout


def clone_tree():
    """Clones the tree as it is, with changes that are not committed."""
    shutil.rmtree(CLONE, ignore_errors=True)
    git("clone", "--quiet", ROOT, CLONE)
    if changes := git("diff", "--binary", "HEAD"):
        git("apply", "-", folder=CLONE, input=changes)
    for name in filter(None, git("ls-files", "-z", "--others", "--exclude-standard").decode().split("\0")):
        (CLONE / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, CLONE / name)


def recipes():
    """The headings of all recipes."""
    return re.findall(r"^## (An? .*)$", (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8"), re.M)


def apply_all():
    """Leaves a clone with all recipes carried out and committed."""
    clone_tree()
    for heading in recipes():
        carry_out(CLONE, heading)
    git("add", "--all", folder=CLONE)
    author = ("-c", "user.name=Recipes", "-c", "user.email=recipes@localhost")
    git(*author, "commit", "--quiet", "--message", "Carry out all recipes of CONTRIBUTING.md", folder=CLONE)


class Recipes(unittest.TestCase):
    def test_all_together_pass_what_a_change_must_pass(self):
        self.assertEqual(len(recipes()), 5)
        apply_all()
        environment = {name: value for name, value in os.environ.items() if not name.startswith(OF_OUTER_RUN)}
        self.assertEqual(subprocess.run([CLONE / ".ci" / "run"], cwd=CLONE, env=environment).returncode, 0)


if __name__ == "__main__":
    unittest.main()
