"""The agents as a stream for the water, which is moved by it only where people push back."""

import signal
import unittest
from pathlib import Path

from harness import ENDLESS, SystemTest, wait_until
from test_recordings import RecordingTest

LAGS = ("serial", "parallel")


def way_back(lag):
    return ["--set", f"/coupling/agents_stream={lag}"]


TWO_WAY = ["--set", "/coupling/two_way=true", "--set", "/fluid/shallow_water/cell_size_m=0.5"]


class WayBack(SystemTest):
    def segments(self):
        return sorted(path.name.removeprefix(self.session + "-") for path in Path("/dev/shm").glob(f"{self.session}-*"))

    def assert_only_left_then_remove(self, *kinds):
        """Only segments of a killed producer remain; a process that lives removes its own."""
        self.assertEqual(self.segments(), sorted(kinds))
        for kind in kinds:
            Path(f"/dev/shm/{self.session}-{kind}").unlink()

    def started(self, lag, frame):
        arguments = [*way_back(lag), *TWO_WAY, *ENDLESS]
        server, client = self.server(*arguments), self.client(*arguments)
        self.wait_for_frame(frame, server, client)
        return server, client

    def test_water_and_outcome_are_those_without_the_way_back(self):
        off = self.pair()
        self.assertIsNone(off.outcome()["agents_hash"])
        for lag in LAGS:
            with self.subTest(lag=lag):
                run = self.pair(*way_back(lag))
                self.assertEqual(run.outcome()["frame_hash"], off.outcome()["frame_hash"])
                self.assertEqual(run.bytes_of("agents.csv"), off.bytes_of("agents.csv"))
                self.assertEqual(run.rows(), off.rows())

    def test_agents_are_the_same_in_both_lags_at_all_depths_and_in_every_run(self):
        hashes = [
            self.pair(*way_back(lag), "--set", f"/lockstep_depth={depth}").outcome()["agents_hash"]
            for lag in LAGS
            for depth in (1, 2, 3, 3)
        ]
        self.assertIsNotNone(hashes[0])
        self.assertEqual(hashes, [hashes[0]] * 8)

    def test_people_who_push_leave_the_momentum_where_it_was(self):
        outcomes = []
        for model in ("dfsph", "shallow_water", "mixed"):
            for lag in LAGS:
                with self.subTest(model=model, lag=lag):
                    run = self.pair(*way_back(lag), *TWO_WAY, "--set", f"/fluid/model={model}")
                    outcome = run.outcome()
                    got = max(map(abs, outcome["momentum"]["people_got_n_s"]))
                    self.assertGreater(got, 10)
                    # float32: each velocity that is changed is rounded by 3e-8 of it.
                    self.assertLess(outcome["momentum_balance_n_s"], 1e-5 * got)
                    outcomes.append(outcome["frame_hash"])
        self.assertEqual(len(set(outcomes)), len(outcomes))

    def test_people_who_push_lead_to_the_same_bits_at_all_depths_with_any_threads(self):
        for lag in LAGS:
            hashes = [
                self.pair(*way_back(lag), *TWO_WAY, "--set", f"/lockstep_depth={depth}", "--threads", threads).outcome()["frame_hash"]
                for depth, threads in ((1, "1"), (3, "1"), (2, "2"))
            ]
            self.assertEqual(hashes, [hashes[0]] * 3)

    def test_two_way_asks_for_the_parallel_stream(self):
        alone = self.pair(*TWO_WAY)
        self.assertEqual(alone.outcome()["frame_hash"], self.pair(*way_back("parallel"), *TWO_WAY).outcome()["frame_hash"])

    def test_other_paths_give_another_hash(self):
        self.assertNotEqual(
            self.pair(*way_back("serial")).outcome()["agents_hash"],
            self.pair(*way_back("serial"), "--set", "/crowd/tau=0.3").outcome()["agents_hash"],
        )

    def test_killed_server_ends_the_client(self):
        for lag in LAGS:
            for frame in (1, 40):
                with self.subTest(lag=lag, frame=frame):
                    server, client = self.started(lag, frame)
                    self.kill_server(server)
                    self.assert_ends(client, 4, "died")
                    self.assert_complete_records(client.run, "peer_dead")
                    self.assert_only_left_then_remove("fluid")

    def test_killed_client_ends_the_server(self):
        for lag in LAGS:
            for frame in (1, 40):
                with self.subTest(lag=lag, frame=frame):
                    server, client = self.started(lag, frame)
                    client.send(signal.SIGKILL)
                    self.assertEqual(client.wait(), -signal.SIGKILL)
                    self.assert_ends(server, 4, "died")
                    self.assert_only_left_then_remove("agents")

    def test_interrupted_side_tells_the_other_one(self):
        for lag in LAGS:
            for interrupted in (0, 1):
                with self.subTest(lag=lag, interrupted=("server", "client")[interrupted]):
                    pair = self.started(lag, 20)
                    pair[interrupted].send(signal.SIGINT)
                    self.assert_ends(pair[interrupted], 130, "nterrupted")
                    self.assert_ends(pair[1 - interrupted], 5, "nterrupted")
                    self.assertEqual(self.segments(), [])

    def test_water_that_dies_before_it_takes_the_agents_is_a_dead_peer(self):
        server = self.server("--consumers", "2", *way_back("serial"))  # waits for a second consumer
        client = self.client(*way_back("serial"))
        wait_until(lambda: any("agents" in name for name in self.segments()), "the agents' stream")
        self.kill_server(server)
        self.assert_ends(client, 4, "died")
        self.assert_only_left_then_remove("fluid")

    def test_second_crowd_is_refused_and_disturbs_nobody(self):
        server, client = self.started("serial", 20)
        for _ in range(5):
            self.assert_ends(self.client(*ENDLESS, *way_back("serial")), 8, "has a crowd")
        self.assertTrue(server.running() and client.running())
        client.send(signal.SIGINT)
        self.assert_ends(client, 130)
        self.assert_ends(server, 5)

    def test_crowd_that_has_arrived_ends_both_well(self):
        near = ["--until-s", "5000", "--set", "/crowd/groups/0/goal/z_m=4", "--set", "/crowd/tau=0"]
        hashes = [self.pair(*near, *way_back(lag)).outcome()["agents_hash"] for lag in LAGS]
        self.assertEqual(hashes[0], hashes[1])

    def test_producer_that_takes_no_agents_is_named(self):
        client = self.client("--attach-timeout-s", "1", *way_back("serial"))
        producer = self.producer(*way_back("serial"))
        self.assert_ends(client, 3, "1 consumer", f"{self.session}")
        self.assert_ends(producer, 5, "1 consumer")


class Recorded(RecordingTest):
    def test_recording_of_people_who_push_is_refused_as_nothing_in_it_can_be_pushed(self):
        pushing = ["--until-s", "4", "--set", "/coupling/two_way=true"]
        live = self.recorded_run(*pushing)
        self.assertGreater(max(map(abs, live.outcome()["momentum"]["people_got_n_s"])), 1)
        replay, crowd = self.replay("--take-agents"), self.client(*pushing)
        self.assert_ends(replay, 6, "cannot answer people that push")
        self.assert_ends(crowd, 5, "cannot answer people that push")


if __name__ == "__main__":
    unittest.main()
