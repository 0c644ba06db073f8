"""A crowd that cannot start: it says why, outcome.json says so as far as it can be written, and the water learns of it."""

import os
import resource
import signal
import subprocess
import unittest

from harness import CLIENT, ENDLESS, SMALL, SystemTest, wait_until

# More people with bodies than fit into the world of 20 x 12 m. Only the placement of the bodies finds this out.
CRAMMED = {
    "/crowd/bodies": '"human"',
    "/crowd/markers": '"redrawn"',
    "/crowd/body_radius_m": "0.4",
    "/crowd/groups/0/columns": "25",
    "/crowd/groups/0/rows": "25",
    "/crowd/groups/0/start/pitch_x_m": "0.01",
    "/crowd/groups/0/start/pitch_z_m": "0.01",
}


def settings(values):
    return [word for pointer, value in values.items() for word in ("--set", f"{pointer}={value}")]


class FailingStarts(SystemTest):
    def waiting_server(self, *options):
        """One that would wait for its crowd for ever."""
        server = self.server(*options, "--attach-timeout-s", "0")
        wait_until(lambda: self.word(0, "<Q") != 0 or not server.running(), "the segment")
        self.assertTrue(server.running(), server.messages())
        return server

    def assert_fails(self, code, *texts, out=None, options=(), **process):
        """The crowd ends with this code and texts, and the water that waits for it with the same reason."""
        server = self.waiting_server(*options)
        client = self.client(*options, out=out, **process)
        self.assert_ends(client, code, *texts)
        self.assert_ends(server, 5, "refused the stream", *texts)
        return client.run

    def test_out_that_is_a_file(self):
        file = self.folder / "file"
        file.write_text("mine")
        self.assert_fails(2, "--out", str(file), out=file)
        self.assertEqual(file.read_text(), "mine")

    def test_out_below_a_file(self):
        file = self.folder / "file"
        file.write_text("mine")
        self.assert_fails(2, "--out", str(file / "run"), out=file / "run")

    def test_out_that_takes_no_files(self):
        self.assert_fails(2, "--out", "/proc/self", out="/proc/self")

    def test_too_few_open_files(self):
        limit = lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (5, 5))  # noqa: E731
        run = self.assert_fails(1, "trajectories.sqlite", preexec_fn=limit)
        outcome = run.outcome()
        self.assertEqual(outcome["status"], "failed")
        self.assertIn("trajectories.sqlite", outcome["message"])

    def test_files_that_may_not_grow(self):
        limit = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (8192, 8192))  # noqa: E731
        run = self.assert_fails(1, str(self.folder), preexec_fn=limit)
        outcome = run.outcome()
        self.assertEqual(outcome["status"], "disk_full")
        self.assertIn("no space left", outcome["message"])

    @unittest.skipUnless(os.geteuid() == 0, "only root may mount a small disk")
    def test_disk_that_is_full_but_for_little(self):
        for left in (0, 16384, 65536):
            with self.subTest(left=left):
                disk = self.folder / f"disk{left}"
                disk.mkdir()
                mount = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=256k", "tmpfs", disk], check=False)
                if mount.returncode:
                    self.skipTest("no small disk can be mounted here")
                self.mounts.append(disk)
                (disk / "ballast").write_bytes(bytes(256 * 1024 - left))
                run = self.assert_fails(1, "no space left", out=disk / "run")
                if left:
                    self.assertEqual(run.outcome()["status"], "disk_full")

    def test_scene_that_only_the_crowd_cannot_work_with(self):
        run = self.assert_fails(2, "/crowd", options=settings(CRAMMED))
        self.assertFalse(run.folder.exists())

    def test_check_says_what_the_run_says(self):
        checked = self.start(CLIENT, SMALL, "--check", *settings(CRAMMED))
        run = self.client(*settings(CRAMMED), "--attach-timeout-s", "0.1")
        self.assertEqual(run.wait(), 2)
        self.assert_ends(checked, 2, run.messages().strip())
        self.assert_ends(
            self.start(CLIENT, SMALL, "--check", "--mode", "latest", "--set", '/coupling/agents_stream="serial"'),
            2,
            "--mode latest",
        )
        self.assert_ended_well(self.start(CLIENT, SMALL, "--check"))

    def test_list_of_crowds_that_cannot_be_run(self):
        crowds = self.folder / "crowds.json"
        crowds.write_text('[{"name": "a"}, {"name": "a"}]')
        server = self.waiting_server()
        self.assert_ends(self.client("--crowds", crowds), 2, "/1/name")
        self.assert_ends(server, 5, "/1/name")

    def test_second_crowd_that_fails_disturbs_no_run(self):
        file = self.folder / "file"
        file.write_text("mine")
        server, first = self.server(*ENDLESS), self.client(*ENDLESS)
        self.wait_for_frame(3, server, first)
        self.assert_ends(self.client(*ENDLESS, out=file), 2, "--out")
        self.wait_for_frame(self.published_frame() + 10, server, first)
        first.send(signal.SIGINT)
        self.assert_ends(first, 130)
        self.assert_ends(server, 5)

    def test_water_that_never_comes_is_not_waited_for(self):
        file = self.folder / "file"
        file.write_text("mine")
        self.assert_ends(self.client("--attach-timeout-s", "0.1", out=file), 2, "--out")

    def test_water_that_cannot_start_tells_the_crowd(self):
        """The same for the water: a crowd that already waits for it ends at once, with its reason."""
        file = self.folder / "file"
        file.write_text("mine")
        for text, options in (
            ("no state of the fluid", ("--from-state", str(file))),
            ("--out", ("--out", str(file / "run"))),
            ("--save-state", ("--save-state", str(file / "state"))),
        ):
            with self.subTest(options=options):
                crowd = self.client("--attach-timeout-s", "0")
                wait_until(crowd.run.folder.exists, "the crowd")
                server = self.server(*options)
                self.assertNotEqual(server.wait(), 0)
                self.assertIn(text, server.messages())
                self.assert_ends(crowd, 5, text)
                self.assertEqual(crowd.run.outcome()["status"], "peer_aborted")


if __name__ == "__main__":
    unittest.main()
