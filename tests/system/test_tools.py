"""shm_inspect reads without any effect on a run; shm_clean removes the segments of dead processes and nothing else."""

import json
import os
import signal
import struct
import subprocess
import unittest
from pathlib import Path

from harness import ENDLESS, PROGRAMS, SystemTest, wait_until

INSPECT, CLEAN, RECORD = PROGRAMS / "shm_inspect", PROGRAMS / "shm_clean", PROGRAMS / "shm_record"
SHM = Path("/dev/shm")


class ToolTest(SystemTest):
    def segment(self, kind="fluid"):
        return SHM / f"{self.session}-{kind}"

    def running(self):
        """An endless run of three, some frames old."""
        server = self.server("--consumers", "2", *ENDLESS)
        recorder = self.start(RECORD, self.session, self.folder / "run.wrec")
        client = self.client(*ENDLESS)
        self.wait_for_frame(10, server, recorder, client)
        return server, recorder, client

    def end(self, server, *others):
        server.send(signal.SIGTERM)
        self.assert_ends(server, 143)
        for other in others:
            self.assert_ends(other, 5)

    def killed_server(self):
        server = self.server(*ENDLESS)
        self.wait_for_segment()
        self.kill_server(server)


class Inspect(ToolTest):
    def answer(self, code, *arguments):
        done = subprocess.run([INSPECT, *map(str, arguments)], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done.stdout

    def seen(self, code, *arguments):
        (segment,) = json.loads(self.answer(code, self.session, "--json", *arguments))
        return segment

    def test_absent_session_is_said_to_be_absent(self):
        self.assertEqual(self.answer(3, self.session), "no segments\n")
        self.assertEqual(json.loads(self.answer(3, self.session, "--json")), [])

    def test_living_session_is_shown_with_all_who_take_part(self):
        server, recorder, client = self.running()
        seen = self.seen(0, "--interval-s", "0.3")
        self.assertEqual((seen["condition"], seen["producer_alive"], seen["kind"]), ("readable", True, "fluid"))
        self.assertEqual((seen["producer"]["name"], seen["producer"]["pid"]), ("dfsph", server.process.pid))
        self.assertEqual((seen["producer"]["state"], seen["capacity"]), ("running", 1000))
        self.assertGreaterEqual(seen["published_frame"], 10)
        self.assertGreater(seen["frames_per_s"], 0)
        self.assertEqual(seen["last_frame"]["particles"], 640)
        self.assertGreaterEqual(seen["last_frame"]["sub_steps"], 1)
        self.assertIsNotNone(seen["last_frame"]["mean_density_error"])
        consumers = {consumer["pid"]: consumer for consumer in seen["consumers"]}
        self.assertEqual(set(consumers), {recorder.process.pid, client.process.pid})
        for consumer in consumers.values():
            self.assertEqual((consumer["alive"], consumer["state"], consumer["mode"]), (True, "joined", "lockstep"))
            self.assertLessEqual(consumer["frames_behind"], seen["depth"])
        self.assertTrue(consumers[recorder.process.pid]["follows"])
        self.assertFalse(consumers[client.process.pid]["follows"])
        self.end(server, recorder, client)

    def test_text_names_everybody(self):
        server, recorder, client = self.running()
        text = self.answer(0, self.session, "--interval-s", "0")
        for words in (
            f"{self.session}-fluid  running, producer 'dfsph' (process {server.process.pid}, alive)",
            "640 particles, hash ",
            "density error",
            f"(process {recorder.process.pid}, alive) lockstep, follower, since frame 1",
            f"'crowd' (process {client.process.pid}, alive) lockstep, since frame 1",
        ):
            self.assertIn(words, text)
        self.end(server, recorder, client)

    def test_stopped_crowd_is_behind_by_the_depth_and_the_server_waits(self):
        server, client = self.server(*ENDLESS), self.client(*ENDLESS)
        self.wait_for_frame(5, server, client)
        self.stop(client)
        wait_until(lambda: self.seen(0, "--interval-s", "0")["producer"]["waiting"], "the server to wait")
        seen = self.seen(0, "--interval-s", "0.1")
        self.assertEqual(seen["frames_per_s"], 0)
        (consumer,) = seen["consumers"]
        self.assertEqual((consumer["alive"], consumer["frames_behind"]), (True, seen["depth"]))
        client.send(signal.SIGCONT)
        self.end(server, client)

    def test_dead_producer_is_told_from_a_living_one(self):
        self.killed_server()
        seen = self.seen(4)
        self.assertEqual((seen["condition"], seen["producer_alive"]), ("readable", False))
        self.assertIn("dead", self.answer(4, self.session))
        self.segment().unlink()

    def test_dead_consumer_is_told_from_a_living_one(self):
        server, client = self.server(*ENDLESS), self.client(*ENDLESS)
        self.wait_for_frame(5, server, client)
        self.stop(server)
        client.send(signal.SIGKILL)
        client.wait()
        (consumer,) = self.seen(0)["consumers"]
        self.assertEqual((consumer["state"], consumer["alive"]), ("joined", False))
        server.send(signal.SIGCONT)
        self.assert_ends(server, 4)

    def test_unfinished_and_broken_segments_are_named_so(self):
        for content, code, condition in (
            (b"", 4, "unfinished"),
            (bytes(8192), 4, "unfinished"),
            (b"WADESHM1", 6, "refused"),
            (b"WADESHM1" + bytes(8184), 6, "refused"),
            (os.urandom(4096), 6, "refused"),
        ):
            with self.subTest(bytes=len(content), condition=condition):
                self.segment().write_bytes(content)
                self.assertEqual(self.seen(code)["condition"], condition)
                self.assertIn(self.session, self.answer(code, self.session))
        self.segment().unlink()

    def test_looking_changes_no_byte(self):
        server, recorder, client = self.running()
        for program in (client, recorder, server):
            self.stop(program)
        before = self.segment().read_bytes()
        for _ in range(3):
            self.seen(0, "--interval-s", "0")
        self.assertEqual(self.segment().read_bytes(), before)
        for program in (server, recorder, client):
            program.send(signal.SIGCONT)
        self.end(server, recorder, client)

    def test_watched_run_gives_the_same_frames_and_the_watch_ends_with_it(self):
        alone = self.pair("--reproducible")
        server = self.server("--reproducible")
        self.wait_for_segment()
        watch = self.start(INSPECT, self.session, "--watch", "--interval-s", "0", "--json")
        client = self.client("--reproducible")
        self.assert_ended_well(server, client, watch)
        watch.output.seek(0)
        for line in watch.output.read().splitlines():
            self.assertEqual(json.loads(line)[0]["session_id"].strip("0123456789abcdef"), "")
        self.assertEqual(alone.bytes_of("outcome.json"), client.run.bytes_of("outcome.json"))

    def test_all_segments_are_shown_without_a_session(self):
        server = self.server(*ENDLESS)
        self.wait_for_segment()
        for arguments in ([], ["--all"]):
            seen = json.loads(self.answer(0, "--json", "--interval-s", "0", *arguments))
            self.assertIn(f"/{self.session}-fluid", [segment["segment"] for segment in seen])
        self.answer(2, "--all", self.session)
        self.end(server)


class Clean(ToolTest):
    def clean(self, *arguments, code=0):
        pattern = f"{self.session}*"
        done = subprocess.run([CLEAN, pattern, *arguments], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done.stdout

    def assert_kept(self, reason):
        self.assertIn(f"kept  /{self.session}-fluid  {reason}", self.clean())
        self.assertTrue(os.path.lexists(self.segment()))

    def test_living_session_is_kept_and_goes_on(self):
        server, recorder, client = self.running()
        self.assert_kept("its producer is alive")
        self.wait_for_frame(self.published_frame() + 10, server, recorder, client)
        self.end(server, recorder, client)

    def test_stopped_producer_is_alive(self):
        server = self.server(*ENDLESS)
        self.wait_for_segment()
        self.stop(server)
        self.assert_kept("its producer is alive")
        server.send(signal.SIGCONT)
        self.end(server)

    def test_dead_producers_segment_is_removed(self):
        self.killed_server()
        self.assertIn("removed", self.clean())
        self.assertFalse(self.segment().exists())

    def test_dry_run_removes_nothing(self):
        self.killed_server()
        self.assertIn("would remove", self.clean("--dry-run"))
        self.assertTrue(self.segment().exists())
        self.clean()

    def test_unfinished_segment_of_nobody_is_removed(self):
        for content in (b"", bytes(4096)):
            self.segment().write_bytes(content)
            self.assertIn("removed", self.clean())
            self.assertFalse(self.segment().exists())

    def test_agents_segment_of_nobody_is_removed(self):
        self.segment("agents").write_bytes(struct.pack("<Q", 0x314D485345444157) + bytes(4088))
        self.assertIn(f"removed  /{self.session}-agents", self.clean())
        self.assertFalse(self.segment("agents").exists())

    def test_file_of_another_program_is_kept(self):
        self.segment().write_bytes(b"something else that ends in -fluid")
        self.assert_kept("is no segment")
        self.segment().unlink()

    def test_fifo_is_named_and_kept_and_nobody_waits_for_it(self):
        os.mkfifo(self.segment(), 0o666)
        self.assertIn("a FIFO of user", self.clean())
        for words in ([INSPECT, self.session], [INSPECT, "--all", "--json"]):
            done = subprocess.run([*words, "--interval-s", "0"], capture_output=True, text=True, timeout=60, check=False)
            self.assertIn("a FIFO of user", done.stdout)
        self.segment().unlink()

    def test_link_and_folder_are_kept(self):
        target = self.folder / "target"
        target.write_bytes(b"")
        self.segment().symlink_to(target)
        self.assert_kept("is no plain file")
        self.segment().unlink()
        self.segment().mkdir()
        self.assert_kept("is no plain file")
        self.segment().rmdir()

    @unittest.skipUnless(os.geteuid() == 0, "only root can make another user's file")
    def test_another_users_segment_is_kept(self):
        self.segment().write_bytes(b"")
        os.chown(self.segment(), 65534, 65534)
        self.assert_kept("belongs to another user")
        self.segment().unlink()

    def test_pattern_leaves_other_sessions_alone(self):
        self.segment().write_bytes(b"")
        done = subprocess.run([CLEAN, "no-such-session-*"], capture_output=True, text=True, check=True)
        self.assertEqual(done.stdout, "0 removed, 0 kept\n")
        self.assertTrue(self.segment().exists())
        self.clean()


if __name__ == "__main__":
    unittest.main()
