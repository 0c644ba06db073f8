"""What tools/wade many tells while runs share a water."""

import contextlib
import io
import json
import tempfile
import types
import unittest

from wade.ensembles.folder import EnsembleFolder
from wade.many import Progress, duration


class SharedWater(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="wade-test-")
        self.addCleanup(temporary.cleanup)
        folder = EnsembleFolder(temporary.name)
        self.water = folder.work / "wade-many-1" / "water"
        (self.water / "00001").mkdir(parents=True)
        (self.water / "00001" / "manifest.json").write_text(json.dumps({"resolved_scene": {"duration_s": 400}}))
        plan = [types.SimpleNamespace(index=k) for k in range(1, 31)]
        self.progress = Progress(types.SimpleNamespace(plan=plan, folder=folder))

    def told(self):
        said = io.StringIO()
        with contextlib.redirect_stderr(said):
            self.progress(None)
        return said.getvalue()

    def test_the_last_line_of_the_crowds_is_told_once(self):
        log = self.water / "crowd_client.log"
        log.write_text("crowd_client: joined session 'a' of 'dfsph' with 30 crowds\n"
                       "t 0.0 s  30 of 30 crowds walk, 1500 agents  464 particles, error 0.010 %, 1+2 iterations\n")
        self.assertEqual(self.told(), "")
        with open(log, "a", encoding="utf-8") as lines:
            lines.write("t 40.0 s  18 of 30 crowds walk, 900 agents  8584 particles, error 0.002 %  2.00 x real time\n")
        self.assertEqual(self.told(), "[0/30] 12 of 30 runs of one water have ended, t 40 s of 400 s, at most 3 min left\n")
        self.assertEqual(self.told(), "")

    def test_runs_that_engines_do_not_name_are_counted(self):
        for k in (1, 2, 3):
            (self.progress.ensemble.folder.runs / f"{k:05d}").mkdir(parents=True)
        self.assertRegex(self.told(), r"^\[3/30\], \d+ \w+ left\n$")

    def test_durations(self):
        self.assertEqual([duration(s) for s in (7, 99, 130, 7200)], ["7 s", "99 s", "2 min", "2.0 h"])


if __name__ == "__main__":
    unittest.main()
