"""What tests of ensembles share: tools/wade many in a folder of its own, its table, and kills at random."""

import csv
import os
import random
import re
import shutil
import signal
import time
from pathlib import Path

from harness import Launcher, Run, alive, children_of, wait_until

from wade.paths import module_command


class EnsembleTest(Launcher):
    def many(self, *arguments, out="many"):
        # Without tools/wade, which would look each time whether something is to be built; with two jobs each has one thread.
        return self.script(*module_command("wade.many"), "--jobs", "2", "--out", self.folder / out, *arguments)

    def rows(self, out="many"):
        with open(self.folder / out / "runs.csv", newline="", encoding="utf-8") as file:
            return list(csv.DictReader(file))

    def table(self, out="many"):
        return (self.folder / out / "runs.csv").read_text(encoding="utf-8")

    def run_of(self, index, out="many"):
        return Run(self.folder / out / "runs" / f"{index:05d}")

    def segments(self, out="many"):
        """What the workers of an ensemble have in shared memory."""
        found = re.search(r'"ensemble": "(\w+)"', (self.folder / out / "ensemble.json").read_text())
        return list(Path("/dev/shm").glob(f"wade-many-{found[1]}-*"))

    def assert_nothing_left(self, out="many"):
        self.assertEqual(self.segments(out), [])
        self.assertEqual(list((self.folder / out).glob("work/*")), [])

    def undisturbed(self, *arguments, out="undisturbed"):
        """Returns the table of an ensemble that runs without interruption."""
        self.assert_ended_well(self.many(*arguments, out=out))
        return self.table(out)

    def assert_kills_change_nothing(self, kills, *arguments):
        """Kills processes of an ensemble at random, workers, programs and now and then the command itself."""
        chance = random.Random(1)
        command = ("--reproducible", "--tries", "2", "--resume", *arguments)
        killed = starts = 0
        many = self.many(*command)
        while killed < kills:
            victims = children_of(many.process.pid)
            if not many.running():
                ends = (0, 1, -signal.SIGKILL)
                if "fails with signal" in many.messages():  # a kill of the engine as it was asked for its version
                    ends = (2,)
                self.assertIn(many.wait(), ends, many.messages())
                starts += 1
                self.assertLess(starts, 10 * kills, many.messages())
                if many.wait() == 0:  # too quick for the kills; some of it is to be done once more
                    shutil.rmtree(chance.choice(sorted((self.folder / "many" / "runs").iterdir())))
                many = self.many(*command)
            elif victims:
                victim = many.process.pid if chance.random() < 0.05 else chance.choice(victims)
                try:
                    os.kill(victim, signal.SIGKILL)
                    killed += 1
                except ProcessLookupError:
                    pass
            time.sleep(chance.uniform(0, 0.06))
        for _ in range(50):
            if many.wait() == 0:
                break
            many = self.many(*command)
        self.assertEqual(many.wait(), 0, many.messages())
        self.assertEqual(self.table(), self.undisturbed("--reproducible", *arguments))
        self.assert_nothing_left()

    def assert_ends_with_children(self, many, number, code):
        """A signal ends the command and all that it has started."""
        below = children_of(many.process.pid)
        many.send(number)
        self.assert_ends(many, code, "--resume goes on")
        wait_until(lambda: not any(alive(pid) for pid in below), "the workers to end")
