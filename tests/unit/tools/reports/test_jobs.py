"""Runs that go on where they were stopped, and programs by what they compute."""

import json
import os
import tempfile
import unittest
from pathlib import Path
from unittest import mock

from wade.reports.jobs import Children, Fingerprints, Job, do_all


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


class Fingerprint(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def of(self, text, case="wave"):
        program = self.folder / "program"
        program.write_bytes(text)
        return Fingerprints([program], self.folder, ())(case)

    def test_the_name_of_the_commit_changes_nothing(self):
        note = b"\x04\0\0\0\x14\0\0\0\x03\0\0\0GNU\0"

        def program(build_id, code, commit):
            return self.of(note + 20 * build_id + code + b"wade-commit=" + commit.ljust(52, b"\0"))

        first = program(b"a", b"code", b"0123456789ab")
        self.assertEqual(first, program(b"b", b"code", b"ba9876543210"))
        self.assertEqual(first, program(b"b", b"code", b"ba9876543210-dirty"))
        self.assertNotEqual(first, program(b"a", b"Code", b"0123456789ab"))

    def test_settings_of_all_runs_count(self):
        program = self.folder / "program"
        program.write_bytes(b"code")
        prints = {Fingerprints([program], self.folder, (), settings)("wave") for settings in ([], ["/a=1"], ["/a=2"])}
        self.assertEqual(len(prints), 3)

    def test_the_series_of_spheric2_matters_to_it_only(self):
        (self.folder / "series.csv").write_text("1")
        with mock.patch.dict(os.environ, WADE_SPHERIC2_DATA=""):
            wave, tank = self.of(b"x"), self.of(b"x", "spheric2")
        with mock.patch.dict(os.environ, WADE_SPHERIC2_DATA=str(self.folder)):
            self.assertEqual(self.of(b"x"), wave)
            with_series = self.of(b"x", "spheric2")
            self.assertNotEqual(with_series, tank)
            (self.folder / "series.csv").write_text("12")
            self.assertNotEqual(self.of(b"x", "spheric2"), with_series)

    def test_files_that_are_read_count_by_place_and_content(self):
        program, scene = self.folder / "program", self.folder / "a.json"
        program.write_bytes(b"code")
        scene.write_text("1")
        first = Fingerprints([program], self.folder, ["*.json"])()
        scene.write_text("2")
        second = Fingerprints([program], self.folder, ["*.json"])()
        scene.rename(self.folder / "b.json")
        self.assertEqual(len({first, second, Fingerprints([program], self.folder, ["*.json"])()}), 3)


if __name__ == "__main__":
    unittest.main()
