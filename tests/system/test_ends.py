"""What happens to one program when the other one dies, is interrupted, or cannot write its records."""

import random
import resource
import shutil
import signal
import subprocess
import unittest
from pathlib import Path

from harness import ENDLESS, SystemTest, wait_until

LIMIT_BYTES = 300_000  # the trajectories of the small scene outgrow it after a few simulated seconds


def limit_file_size():
    """For the child: a write beyond the limit fails, much as on a full disk."""
    resource.setrlimit(resource.RLIMIT_FSIZE, (LIMIT_BYTES, LIMIT_BYTES))


class Ends(SystemTest):
    def started(self, frame):
        """A pair that runs until something ends it, at or after the given frame."""
        server, client = self.server(*ENDLESS), self.client(*ENDLESS)
        self.wait_for_frame(frame, server, client)
        return server, client

    @unittest.skipUnless(Path("/proc/self/comm").exists(), "no such list of processes")
    def test_lists_of_processes_name_the_programs(self):
        server, client = self.started(1)
        names = [Path(f"/proc/{of.process.pid}/comm").read_text(encoding="ascii") for of in (server, client)]
        server.send(signal.SIGTERM)
        self.assertEqual([server.wait(), client.wait()], [143, 5])
        self.assertEqual(names, ["fluid_server\n", "crowd_client\n"], "the server starts itself anew")

    def assert_server_summed_up(self, server):
        self.assertRegex(server.messages(), r"[1-9]\d* frames, .* memory [1-9]\d* MB")

    def test_killed_server_leaves_complete_records(self):
        moments = random.Random(20201016)
        for frame in [1] + [moments.randrange(2, 200) for _ in range(4)]:
            with self.subTest(frame=frame):
                server, client = self.started(frame)
                self.kill_server(server)
                self.assert_ends(client, 4, "died")
                outcome, last = self.assert_complete_records(client.run, "peer_dead")
                self.assertGreaterEqual(outcome["frames"], frame - 3, "at most the frames under way are lost")
                self.assertEqual(last, outcome["frames"], "every frame that was simulated is logged")
                self.remove_segment_of_killed_server()

    def test_killed_client_ends_the_server(self):
        moments = random.Random(20201018)
        for frame in [1] + [moments.randrange(2, 200) for _ in range(4)]:
            with self.subTest(frame=frame):
                server, client = self.started(frame)
                client.send(signal.SIGKILL)
                self.assertEqual(client.wait(), -signal.SIGKILL)
                self.assert_ends(server, 4, "died")
                self.assert_server_summed_up(server)
                # What was committed before the kill is readable, frame by frame.
                rows = dict(client.run.query("SELECT frame, COUNT(*) FROM trajectory_data GROUP BY frame"))
                self.assertEqual(set(rows), set(range(max(rows) + 1)))
                self.assertEqual(client.run.outcome()["status"], "running")

    def test_killed_client_leaves_results_as_they_stood(self):
        server, client = self.started(1)
        wait_until(lambda: client.run.outcome()["frames"] > 0 or not client.running(), "results of a run that goes on")
        self.assertTrue(client.running(), client.messages())
        client.send(signal.SIGKILL)
        client.wait()
        self.assert_ends(server, 4, "died")
        outcome = client.run.outcome()
        self.assertEqual(outcome["status"], "running")
        self.assertEqual(len(client.run.agents()), outcome["agents"])

    def test_interrupted_client_tells_the_server(self):
        for number, code in ((signal.SIGINT, 130), (signal.SIGTERM, 143)):
            with self.subTest(signal=number.name):
                server, client = self.started(20)
                client.send(number)
                self.assert_ends(client, code, "nterrupted")
                self.assert_ends(server, 5, "nterrupted")
                self.assert_complete_records(client.run, "interrupted")

    def test_interrupted_server_tells_the_client(self):
        for number, code in ((signal.SIGINT, 130), (signal.SIGTERM, 143)):
            with self.subTest(signal=number.name):
                server, client = self.started(20)
                server.send(number)
                self.assert_ends(server, code, "nterrupted")
                self.assert_server_summed_up(server)
                self.assert_ends(client, 5, "nterrupted")
                self.assert_complete_records(client.run, "peer_aborted")

    def test_server_that_waits_for_a_crowd_can_be_interrupted(self):
        server = self.server()
        self.wait_for_segment()
        server.send(signal.SIGINT)
        self.assert_ends(server, 130, "no frame simulated")

    def test_server_says_when_the_crowd_left_early(self):
        near = ["--until-s", "5000", "--set", "/crowd/groups/0/goal/z_m=4", "--set", "/crowd/tau=0"]
        server, client = self.server(*near), self.client(*near)
        self.assert_ended_well(server, client)
        frames = client.run.outcome()["frames"]
        self.assertLess(frames, 150_000)
        self.assertRegex(server.messages(), r"the crowd said goodbye before frame \d+ was sent, 49\d\d(\.\d)? s before the end")

    def assert_ended_by_full_disk(self, server, client):
        self.assert_ends(client, 1, str(client.run.folder / "trajectories.sqlite"))
        self.assert_ends(server, 5, "trajectories.sqlite")
        outcome, last = self.assert_complete_records(client.run, "disk_full")
        self.assertGreater(last, 0)
        # Frames are committed in batches; the batch that met the end of the disk is lost as a whole.
        self.assertLessEqual(last, outcome["frames"])

    def test_file_size_limit_while_logging_is_reported(self):
        server = self.server(*ENDLESS)
        client = self.client(*ENDLESS, "--water-every-s", "0", preexec_fn=limit_file_size)
        self.assert_ended_by_full_disk(server, client)

    def test_full_disk_while_logging_is_reported(self):
        disk = self.folder / "disk"
        disk.mkdir()
        command = ["mount", "-t", "tmpfs", "-o", "size=400k", "none", disk]
        if shutil.which("mount") is None or subprocess.run(command, capture_output=True).returncode != 0:
            self.skipTest("cannot mount a small disk; the limit of the file size stands in for it")
        self.mounts.append(disk)
        server = self.server(*ENDLESS)
        client = self.client(*ENDLESS, "--water-every-s", "0", out=disk / "run")
        self.assert_ended_by_full_disk(server, client)


if __name__ == "__main__":
    unittest.main()
