"""Bad input and unsuitable peers: each has its message and its exit code, on both sides, and nothing is started."""

import os
import signal
import struct
import unittest

from harness import CLIENT, ENDLESS, SCENES, SERVER, SMALL, SystemTest

VERSION_MAJOR = 8  # shm_protocol/layout.hpp
SCENE_TEXT = SMALL.read_text()


class RefusedScenes(SystemTest):
    """Both programs refuse with exit code 2, before the session or the run folder exists."""

    def refuse(self, *texts, scene=SMALL, options=()):
        out = self.folder / "refused"
        for program in (SERVER, CLIENT):
            refused = self.start(program, scene, "--session", self.session, "--out", out, *options)
            self.assert_ends(refused, 2, *texts)
            self.assertFalse(out.exists(), "no run folder for a scene that is refused")

    def written(self, old, new, count=1):
        """A scene file like small.json with one text replaced."""
        self.assertEqual(SCENE_TEXT.count(old), count)
        file = self.folder / "scene.json"
        text = SCENE_TEXT.replace(old, new)
        file.write_text(text.replace("../../../configs", str(SCENES.parents[2] / "configs")))
        return file

    def test_unknown_key_names_the_nearest(self):
        scene = self.written('"tau"', '"tua"')
        self.refuse(str(scene), "/crowd/tua", '"tua"', '"tau"', scene=scene)

    def test_wrong_type_names_both_types(self):
        scene = self.written('"duration_s": 8', '"duration_s": "long"')
        self.refuse(str(scene), "/duration_s", "number", '"long"', scene=scene)

    def test_value_out_of_range_names_the_range(self):
        scene = self.written('"tau": 0.2', '"tau": 1.5')
        self.refuse(str(scene), "/crowd/tau", "1.5", ">= 0 and <= 1", scene=scene)

    def test_broken_json_names_line_and_column(self):
        scene = self.written('"seed": 5,', '"seed": 5;')
        line = SCENE_TEXT[: SCENE_TEXT.index('"seed"')].count("\n") + 1
        column = SCENE_TEXT.splitlines()[line - 1].index(",") + 1
        self.refuse(str(scene), f"line {line}, column {column}", scene=scene)

    def test_missing_file_is_named(self):
        scene = self.folder / "nowhere.json"
        self.refuse(str(scene), "cannot be read", scene=scene)

    def test_capacity_too_small_says_how_much_is_needed(self):
        # 20 m x 4 m x 1 m of water in cubes of 0.5 m.
        self.refuse("/fluid/max_particles", "100", "640", options=["--set", "/fluid/max_particles=100"])

    def test_goal_inside_an_obstacle_is_refused(self):
        box = '[{"x_min_m": 13, "x_max_m": 15, "z_min_m": 5, "z_max_m": 7, "height_m": 1}]'
        goal = '{"x_m": 14, "z_m": 6}'
        self.refuse(
            "/crowd/groups/0/goal",
            "obstacle",
            options=["--set", f"/obstacles={box}", "--set", f"/crowd/groups/0/goal={goal}"],
        )

    def test_agent_inside_an_obstacle_is_refused(self):
        box = '[{"x_min_m": 13, "x_max_m": 15, "z_min_m": 5, "z_max_m": 7, "height_m": 1}]'
        self.refuse(
            "/crowd/groups/0/start",
            "obstacle",
            options=["--set", f"/obstacles={box}", "--set", "/crowd/groups/0/start/z_m=6"],
        )

    def test_spacing_larger_than_the_channel_is_refused(self):
        self.refuse("/fluid/particle_spacing_m", "4.5", "width", options=["--set", "/fluid/particle_spacing_m=4.5"])

    def test_unknown_option_names_the_nearest(self):
        self.refuse('"--thread"', '"--threads"', options=["--thread", "2"])


class RefusedPeers(SystemTest):
    def test_output_folder_below_a_file_is_refused(self):
        file = self.folder / "file"
        file.write_text("not a folder")
        client = self.client(out=file / "run")
        self.assert_ends(client, 2, "--out", str(file / "run"))
        self.assert_ends(self.server("--out", file / "run"), 2, "--out", str(file / "run"))

    @unittest.skipIf(os.geteuid() == 0, "root may write everywhere")
    def test_output_folder_without_permission_is_refused(self):
        locked = self.folder / "locked"
        locked.mkdir(mode=0o500)
        self.assert_ends(self.client(out=locked / "run"), 2, "--out", str(locked / "run"))

    def test_absent_server_is_an_attach_timeout(self):
        client = self.client("--attach-timeout-s", "0.3")
        self.assert_ends(client, 3, self.session, "0.3 s")
        self.assertEqual(client.run.outcome()["status"], "attach_timeout")

    def test_absent_crowd_is_an_attach_timeout(self):
        self.assert_ends(self.server("--attach-timeout-s", "0.3"), 3, "0.3 s")

    def test_different_scenes_are_refused_on_both_sides(self):
        server = self.server()
        client = self.client("--set", "/crowd/tau=0.3")
        self.assert_ends(client, 6, "different scenes")
        self.assert_ends(server, 5, "different scenes")
        self.assertEqual(client.run.outcome()["status"], "protocol_violation")

    def test_another_protocol_version_is_refused_by_the_client(self):
        server = self.server()
        self.wait_for_segment()
        with open(f"/dev/shm/{self.session}-fluid", "r+b") as segment:
            segment.seek(VERSION_MAJOR)
            segment.write(struct.pack("<I", 7))
        client = self.client()
        self.assert_ends(client, 6, "version", "7", "1")
        self.assertEqual(client.run.outcome()["status"], "protocol_violation")
        server.send(signal.SIGTERM)
        self.assert_ends(server, 143)

    def test_name_of_a_living_server_is_refused(self):
        first = self.server(*ENDLESS)
        self.wait_for_segment()
        self.assert_ends(self.server(), 8, self.session)
        # The first one is none the worse for it.
        client = self.client(*ENDLESS)
        self.wait_for_frame(5, first, client)
        client.send(signal.SIGINT)
        self.assert_ends(client, 130)
        self.assert_ends(first, 5)

    def test_name_of_a_dead_server_is_taken_over(self):
        first = self.server(*ENDLESS)
        self.wait_for_segment()
        self.kill_server(first)
        self.assertNotEqual(self.word(0, "<Q"), 0, "a killed server leaves its segment")
        self.pair()


if __name__ == "__main__":
    unittest.main()
