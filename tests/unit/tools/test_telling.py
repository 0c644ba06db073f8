"""What a silent command tells of itself."""

import contextlib
import io
import unittest
from unittest import mock

from wade import progress


class Lines(unittest.TestCase):
    def line(self, done, total, now=30.0, began=10.0):
        state = progress.State()
        state.what, state.done, state.total, state.began = "writes the frames", done, total, began
        return state.line("export", now, 0.0)

    def test_say_what_is_done_how_far_it_is_and_how_long_it_takes(self):
        self.assertEqual(self.line(50, 200), "wade export: writes the frames, 50 of 200, about 60 s left, 30 s so far")
        self.assertEqual(self.line(0, 200), "wade export: writes the frames, 0 of 200, 30 s so far")
        self.assertEqual(self.line(2.5, 10.0), "wade export: writes the frames, 25 %, about 60 s left, 30 s so far")
        self.assertEqual(self.line(7, None), "wade export: writes the frames 7, 30 s so far")
        self.assertEqual(self.line(7, float("inf")), "wade export: writes the frames 7, 30 s so far")
        self.assertEqual(self.line(0, None, now=7500), "wade export: writes the frames, 2.1 h so far")

    def test_items_are_steps(self):
        seen = []
        for item in progress.over("abc", "reads"):
            seen.append((item, progress.STATE.what, progress.STATE.done, progress.STATE.total))
        self.assertEqual(seen, [("a", "reads", 0, 3), ("b", "reads", 1, 3), ("c", "reads", 2, 3)])


class Telling(unittest.TestCase):
    def told(self, waits):
        """What is told while this many pauses pass; each moment is as late as a pause is long."""
        said, clock = io.StringIO(), iter(range(0, 10000, 5))
        teller = progress.Teller("table")
        with contextlib.redirect_stderr(said), mock.patch.object(progress.time, "monotonic", lambda: next(clock)):
            progress.STATE.__init__()
            teller.started = 0
            teller.ended = mock.Mock(wait=mock.Mock(side_effect=[False] * waits + [True]))
            progress.at("reads the runs", 1, 4)
            teller.tell()
        return said.getvalue().splitlines()

    def test_a_log_gets_lines_that_become_rarer(self):
        few, many = self.told(3), self.told(100)
        self.assertTrue(few[0].startswith("wade table: reads the runs, 1 of 4"))
        self.assertLess(len(many), 50)

    def test_a_quick_command_says_nothing(self):
        self.assertEqual(self.told(0), [])


if __name__ == "__main__":
    unittest.main()
