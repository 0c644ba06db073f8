"""Runs that go on where they were stopped."""

import json
import tempfile
import unittest
from pathlib import Path

from wade.reports.jobs import Children, Job, do_all


class Jobs(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.result = Path(folder.name) / "runs" / "one.json"
        self.result.parent.mkdir()

    def job(self, script, fingerprint="now", **more):
        return Job("one", ("/bin/sh", "-c", script), self.result, fingerprint, **more)

    def writing(self, fingerprint):
        return f"echo '{json.dumps({'fingerprint': fingerprint})}' > {self.result}; echo ran >> {self.result.parent}/count"

    def count(self):
        return len((self.result.parent / "count").read_text().splitlines())

    def test_an_old_result_stays_until_its_repeat_starts(self):
        self.result.write_text("{}")
        children = Children()
        children.stop()
        self.assertIsNone(children.run(self.job("exit 0")))
        self.assertTrue(self.result.exists())
        self.assertEqual(Children().run(self.job("exit 1")), 1)
        self.assertFalse(self.result.exists())

    def test_each_run_is_told_how_many_threads_it_has(self):
        self.assertEqual(do_all([self.job("echo $OMP_NUM_THREADS", threads=3)], 1), 0)
        self.assertEqual(self.result.with_suffix(".log").read_text(), "3\n")

    def test_what_is_complete_by_the_same_program_is_not_repeated(self):
        for fingerprint, again, runs in (("now", False, 1), ("now", False, 1), ("later", False, 2), ("later", True, 3)):
            do_all([self.job(self.writing(fingerprint), fingerprint)], 1, again)
            self.assertEqual(self.count(), runs)


if __name__ == "__main__":
    unittest.main()
