"""The same scene gives the same results, whatever the threads, the order of start, pauses and the lockstep depth."""

import signal
import unittest

from harness import CONSUMER_WAITING, ROOT, SystemTest, wait_until


class Lockstep(SystemTest):
    def assert_same_results(self, run, other):
        self.assertIsNotNone(run.outcome()["frame_hash"])
        self.assertEqual(run.outcome()["frame_hash"], other.outcome()["frame_hash"])
        self.assertEqual(run.bytes_of("agents.csv"), other.bytes_of("agents.csv"))
        self.assertEqual(run.rows(), other.rows())

    def test_small_scene_is_worth_comparing(self):
        run = self.pair()
        outcome = run.outcome()
        self.assertEqual((outcome["status"], outcome["agents"]), ("completed", 6))
        self.assertGreater(outcome["arrived"], 0)
        self.assertTrue(all(float(agent["max_depth_m"]) > 0 for agent in run.agents()), "all met water")
        self.assertEqual(outcome["fluid"]["position_clamps"], 0)

    def test_one_and_two_threads_give_the_same_bits(self):
        self.assert_same_results(self.pair("--threads", "1"), self.pair("--threads", "2"))

    def test_lockstep_depths_give_the_same_results(self):
        runs = [self.pair("--set", f"/lockstep_depth={depth}") for depth in (1, 2, 3)]
        self.assert_same_results(runs[0], runs[1])
        self.assert_same_results(runs[0], runs[2])

    def test_either_program_may_start_first(self):
        server = self.server()
        self.wait_for_segment()
        first = self.client()
        self.assert_ended_well(server, first)

        second = self.client()
        wait_until((second.run.folder / "outcome.json").exists, "the client's run folder")
        server = self.server()
        self.assert_ended_well(server, second)
        self.assert_same_results(first.run, second.run)

    def test_stopped_and_continued_programs_change_nothing(self):
        depth = 2
        undisturbed = self.pair("--set", f"/lockstep_depth={depth}")
        server = self.server("--set", f"/lockstep_depth={depth}")
        self.wait_for_segment()
        self.stop(server)
        client = self.client("--set", f"/lockstep_depth={depth}")
        wait_until(lambda: self.word(CONSUMER_WAITING, "<I") == 1, "the client to join")
        # From here on one of the two is always stopped, and the other one runs until it can only wait.
        for _ in range(5):
            self.stop(client)
            server.send(signal.SIGCONT)
            wait_until(lambda: self.published_frame() == self.acknowledged_frame() + depth, "the server to be ahead")
            self.stop(server)
            client.send(signal.SIGCONT)
            wait_until(lambda: self.acknowledged_frame() == self.published_frame(), "the client to catch up")
        self.assertEqual(self.published_frame(), 5 * depth)
        server.send(signal.SIGCONT)
        self.assert_ended_well(server, client)
        self.assert_same_results(undisturbed, client.run)

    def test_reproducible_runs_are_identical_byte_for_byte(self):
        runs = [self.pair("--reproducible") for _ in range(2)]
        for name in ("outcome.json", "manifest.json", "agents.csv"):
            self.assertEqual(runs[0].bytes_of(name), runs[1].bytes_of(name), name)

    def test_both_programs_agree_on_any_frame_rate(self):
        for rate in ("29.9701", "0.51234"):
            with self.subTest(rate=rate):
                outcome = self.pair("--set", f"/frame_rate_hz={rate}").outcome()
                self.assertEqual(outcome["frames"], round(8 * float(rate)))

    def test_progress_over_a_dry_river_has_no_depth(self):
        dry = ["--until-s", "0.1"]
        scene = ROOT / "configs" / "paper" / "s01.json"
        server, client = self.server(*dry, scene=scene), self.client(*dry, scene=scene)
        self.assert_ended_well(server, client)
        first = next(line for line in server.messages().splitlines() if line.startswith("t 0.0"))
        self.assertNotIn("nan", first)
        self.assertNotIn("depth", first)

    def test_another_seed_gives_other_paths(self):
        self.assertNotEqual(self.pair("--seed", "1").rows(), self.pair("--seed", "2").rows())


if __name__ == "__main__":
    unittest.main()
