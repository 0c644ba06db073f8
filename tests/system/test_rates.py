"""Frames of the water and steps of the crowd at rates of their own, and the crowd on the newest frames only."""

import signal
import sqlite3
import unittest

from harness import ENDLESS, SystemTest, wait_until

# A run that lasts until no agent is active any more.
LONG = ["--until-s", "5000"]


def has_walked(run):
    """Returns true if the records, which may have no tables yet, hold steps after the initial positions."""
    try:
        return bool(run.query("SELECT 1 FROM trajectory_data WHERE frame > 1 LIMIT 1"))
    except sqlite3.OperationalError:
        return False


class Rates(SystemTest):
    def test_steps_follow_their_own_rate_through_the_same_water(self):
        equal = self.pair()
        for rate in (45, 10, 60, 7.5):
            with self.subTest(step_rate_hz=rate):
                run = self.pair("--set", f"/crowd/step_rate_hz={rate}")
                outcome = run.outcome()
                self.assertEqual(outcome["status"], "completed")
                self.assertEqual((outcome["frames"], outcome["steps"]), (240, 8 * rate))
                self.assertEqual((outcome["frame_rate_hz"], outcome["step_rate_hz"]), (30, rate))
                self.assertEqual(outcome["sim_time_s"], 8)
                self.assertEqual(outcome["frame_hash"], equal.outcome()["frame_hash"])
                self.assertEqual(run.query("SELECT MAX(frame) FROM frame_data"), [(8 * rate,)])
                self.assertEqual(run.query("SELECT value FROM metadata WHERE key = 'fps'"), [(f"{rate:g}",)])
                times = {float(agent["time_s"]) for agent in run.agents() if agent["outcome"] == "active"}
                self.assertLessEqual(times, {8.0})

    def test_frame_rate_stated_as_step_rate_changes_nothing(self):
        default, stated = self.pair(), self.pair("--set", "/crowd/step_rate_hz=30")
        self.assertEqual(default.bytes_of("agents.csv"), stated.bytes_of("agents.csv"))
        self.assertEqual(default.rows(), stated.rows())

    def test_lockstep_depth_changes_nothing_at_unequal_rates(self):
        runs = [self.pair("--set", "/crowd/step_rate_hz=45", "--set", f"/lockstep_depth={d}") for d in (1, 2, 3)]
        for run in runs[1:]:
            self.assertEqual(run.bytes_of("agents.csv"), runs[0].bytes_of("agents.csv"))
            self.assertEqual(run.rows(), runs[0].rows())

    def test_frames_of_variable_length_lead_to_all_steps(self):
        second = ["--until-s", "1"]
        server, client = self.server("--clock", "variable", *second), self.client(*second)
        self.assert_ended_well(server, client)
        outcome = client.run.outcome()
        self.assertEqual((outcome["status"], outcome["steps"], outcome["sim_time_s"]), ("completed", 30, 1))


class Latest(SystemTest):
    def test_crowd_on_the_newest_frames_takes_all_steps(self):
        client = self.client("--mode", "latest", *LONG)
        server = self.server("--consumers", "0", *LONG)
        self.assert_ended_well(client)
        outcome, last = self.assert_complete_records(client.run, "completed")
        self.assertEqual((outcome["mode"], outcome["frame_hash"]), ("latest", None))
        self.assertEqual(outcome["active"], 0)
        # No step is missing up to the end of the last agent, however many frames there are.
        steps = [frame for frame, in client.run.query("SELECT DISTINCT frame FROM trajectory_data ORDER BY frame")]
        self.assertEqual(steps, list(range(steps[0], last + 1)))
        self.assertLessEqual(steps[0], 1)
        last_end = max(float(agent["time_s"]) for agent in client.run.agents())
        self.assertEqual(round(last_end * outcome["step_rate_hz"]), outcome["steps"])
        self.assertTrue(server.running(), "nobody holds it up")
        server.send(signal.SIGTERM)
        self.assert_ends(server, 143)

    def test_crowd_on_the_newest_frames_sees_its_producer_die(self):
        client = self.client("--mode", "latest", *ENDLESS)
        server = self.server("--consumers", "0", *ENDLESS)
        self.wait_for_frame(20, server, client)
        # The water waits for no consumer and may start before the crowd.
        wait_until(lambda: has_walked(client.run), "the crowd's first steps")
        self.kill_server(server)
        self.assert_ends(client, 4, "died")
        self.assert_complete_records(client.run, "peer_dead")
        self.remove_segment_of_killed_server()

    def test_server_that_waits_for_a_crowd_in_lockstep_says_so_to_one_that_does_not(self):
        limit = ["--attach-timeout-s", "1"]
        server, client = self.server(*limit), self.client("--mode", "latest")
        self.assert_ends(server, 3)
        self.assert_ends(client, 5)

    def test_newest_frames_and_the_way_back_exclude_each_other(self):
        client = self.client("--mode", "latest", "--set", "/coupling/agents_stream=serial")
        self.assert_ends(client, 2, "--mode latest", "/coupling/agents_stream")


if __name__ == "__main__":
    unittest.main()
