"""The options that tools/wade run knows without the programs, against the programs."""

import re
import subprocess
import unittest

from wade import UsageError
from wade.paths import BUILD
from wade.run.options import OPTIONS, check_set
from wade.scenes import DEFAULT_SCENE

OPTION = re.compile(r"^  (?:-\w,)?(--[a-z0-9-]+)( [A-Z][A-Z=]*)?(?:  |$)", re.MULTILINE)
WRONG = (
    "/duration_s=abc", "/duration_s=-1", "/duration_s", "/world/length_m/x=1", "/fluid=3", "fluid/model=1", "/seed=1.5",
    "/fluid/modle=dfsph", '/fluid={"modle":1}', "/fluid/model=sph", "/crowd/tau=2", '/crowd/tau={"min":0.1,"max":3}',
    "/duration_s=NaN", "/events/0=3", "/name=", "/crowd/groups/a/x=1", "/stop_when_no_agent_is_active=1",
)
RIGHT = ("/fluid/model=kinematic", '/fluid/model="kinematic"', "/crowd/tau=0.5", '/crowd/tau={"min":0.1,"max":0.3}', "/name=1",
         "/crowd/groups/0/tau=1", "/stop_when_no_agent_is_active=false", "/seed=2.0")


def answer(program, *words):
    """(exit code, messages in one line) of a program."""
    done = subprocess.run([BUILD / program, *words], capture_output=True, text=True)
    return done.returncode, done.stdout if done.returncode == 0 else " ".join(done.stderr.split())


class Table(unittest.TestCase):
    def test_programs_have_these_options(self):
        for program, options in OPTIONS.items():
            with self.subTest(program):
                said = {name: bool(value) for name, value in OPTION.findall(answer(program, "--help")[1])}
                self.assertEqual(said, {name: allowed is not None for name, allowed in options.items()})

    def test_programs_allow_these_values(self):
        files = {"shm_record": ["a", "b"], "shm_replay": ["a"]}
        for program, options in OPTIONS.items():
            for name, allowed in options.items():
                if allowed:
                    with self.subTest(program, name=name):
                        code, said = answer(program, *files.get(program, [DEFAULT_SCENE]), name, "?")
                        self.assertEqual(code, 2)
                        self.assertIn(f"{name}: ? is not allowed; allowed: {allowed} (", said)


class Settings(unittest.TestCase):
    def test_what_is_refused_here_programs_refuse_at_the_same_key(self):
        for assignment in WRONG:
            with self.subTest(assignment):
                with self.assertRaises(UsageError) as refused:
                    check_set(assignment)
                code, said = answer("crowd_client", DEFAULT_SCENE, "--check", "--set", assignment)
                self.assertEqual(code, 2)
                start = " ".join(str(refused.exception).split()).partition(" allowed: ")[0].partition("; the nearest")[0]
                self.assertIn(start, said)

    def test_what_programs_take_is_taken_here(self):
        for assignment in RIGHT:
            with self.subTest(assignment):
                check_set(assignment)
                self.assertEqual(answer("crowd_client", DEFAULT_SCENE, "--check", "--set", assignment)[0], 0)


if __name__ == "__main__":
    unittest.main()
