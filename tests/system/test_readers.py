"""Programs that look into trajectories.sqlite, or lock it, during a run: the run ends well and keeps each of its frames."""

import signal
import sqlite3
import unittest

from harness import ENDLESS, SystemTest, wait_until


class Readers(SystemTest):
    def setUp(self):
        super().setUp()
        self.water, self.crowd = self.server(*ENDLESS), self.client(*ENDLESS)
        self.file = self.crowd.run.folder / "trajectories.sqlite"
        self.wait_for_frame(5, self.water, self.crowd)

    def opened(self):
        """A connection of another program, which is given back at the end of the test."""
        database = sqlite3.connect(self.file, isolation_level=None, timeout=30)
        self.addCleanup(database.close)
        return database

    def go_on(self, frames):
        goal = self.acknowledged_frame() + frames
        wait_until(lambda: self.acknowledged_frame() >= goal or not self.crowd.running(), f"frame {goal}")
        self.assertTrue(self.crowd.running(), self.crowd.messages())

    def end(self):
        """Ends the run as a user does; returns the frames that it took."""
        self.crowd.send(signal.SIGINT)
        self.assert_ends(self.crowd, 130)
        self.assert_ends(self.water, 5)
        outcome = self.crowd.run.outcome()
        self.assertEqual(outcome["status"], "interrupted")
        return outcome["steps"]

    def frames_in(self, file):
        database = sqlite3.connect(file)
        try:
            return [row[0] for row in database.execute("SELECT frame FROM frame_data ORDER BY frame")]
        finally:
            database.close()

    def test_query_that_is_left_open(self):
        cursor = self.opened().execute("SELECT count(*) FROM trajectory_data UNION ALL SELECT 1")
        cursor.fetchone()
        self.go_on(20)
        steps = self.end()
        self.assertIn("-wal", self.crowd.messages())
        self.assertEqual(self.frames_in(self.file), list(range(steps + 1)))

    def test_lock_for_a_while(self):
        database = self.opened()
        for _ in range(3):
            database.execute("BEGIN IMMEDIATE")
            self.go_on(5)
            database.execute("ROLLBACK")
            self.go_on(5)
        database.close()
        steps = self.end()
        self.assertEqual(self.frames_in(self.file), list(range(steps + 1)))
        self.assertNotIn("warning", self.crowd.messages())

    def test_lock_for_ever(self):
        self.opened().execute("BEGIN EXCLUSIVE")
        self.go_on(20)
        steps = self.end()
        rest = self.file.with_name("trajectories.rest.sqlite")
        self.assertIn(str(rest), self.crowd.messages())
        self.assertEqual(self.frames_in(self.file) + self.frames_in(rest), list(range(steps + 1)))

    def test_file_that_is_deleted(self):
        self.file.unlink()
        self.go_on(20)
        steps = self.end()
        kept = self.frames_in(self.file.with_name("trajectories.rest.sqlite"))
        self.assertEqual(kept, list(range(kept[0], steps + 1)))
        self.assertIn("moved or deleted", self.crowd.messages())


if __name__ == "__main__":
    unittest.main()
