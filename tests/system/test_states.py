"""The state of the water as a file: left behind by a numerical failure, saved at the end of a run, gone on from."""

import os
import re
import shlex
import signal
import struct
import unittest

from harness import ENDLESS, PROGRAMS, ROOT, SCENES, SERVER, SMALL, SystemTest

COLLAPSE = SCENES / "collapse.json"
DEEP_COLUMN = ROOT / "configs" / "stability" / "deep_column.json"
EMITTER = ROOT / "configs" / "paper" / "s05.json"
RUN = ROOT / "tools" / "run.sh"
HEADER_BYTES, PARTICLE_BYTES = 128, 33  # fluid_server/states/state_file.hpp


def water_of(file):
    """Returns a state without its scene (durations differ): time, frame, counters, emitter, particles."""
    data = file.read_bytes()
    particles = struct.unpack_from("<Q", data, 32)[0]
    return particles, data[48:112], data[HEADER_BYTES : HEADER_BYTES + PARTICLE_BYTES * particles]


class States(SystemTest):
    def alone(self, scene, *arguments):
        """A server without a crowd."""
        return self.server("--consumers", "0", *arguments, scene=scene)

    def failed_run(self, name="failed", *arguments, scene=COLLAPSE):
        out = self.folder / name
        server = self.alone(scene, "--out", out, *arguments)
        self.assert_ends(server, 9, "compressed by", "change /fluid/", str(out / "numerical_failure.state"))
        server.frame = int(re.search(r"failed in frame (\d+)", server.messages())[1])
        return server, out

    def test_failure_leaves_a_state_that_fails_in_the_same_frame_again(self):
        server, out = self.failed_run()
        self.assertIn("change /fluid/cfl from 2 to 0.5", server.messages())
        self.assertIn("/fluid/density_solve/max_iterations from 1 to 100", server.messages())
        self.assertEqual(list(out.glob("*.part")), [])
        dump = (out / "numerical_failure.state").read_bytes()
        for state in "numerical_failure.state", "last_sound.state":
            again, folder = self.failed_run(state, "--from-state", out / state, scene=out / "numerical_failure.json")
            self.assertEqual(again.frame, server.frame)
            self.assertEqual((folder / "numerical_failure.state").read_bytes(), dump)

    def test_a_hard_case_with_settings_that_cannot_hold_says_what_to_change_and_fails_from_its_state_again(self):
        """A case of the stability suite, spoilt on purpose: thrown against its wall, pressure solves cut short, half as deep; all of
        it, of 60 layers, holds even so."""
        settings = {
            "/fluid/cfl": "2",
            "/fluid/density_solve": '{"tolerance": 0.1, "min_iterations": 1, "max_iterations": 1}',
            "/fluid/divergence_solve/max_iterations": "1",
            "/channel/water_blocks/0/depth_m": "3",
            "/channel/water_blocks/0/velocity_x_m_s": "20",
        }
        options = [text for key, value in settings.items() for text in ("--set", f"{key}={value}")]
        server, out = self.failed_run("hard", *options, scene=DEEP_COLUMN)
        for advice in (
            "/fluid/cfl from 2 to 0.5",
            "/fluid/density_solve/max_iterations from 1 to 100",
            "/fluid/divergence_solve/max_iterations from 1 to 100",
        ):
            self.assertIn(advice, server.messages())
        failure = re.search(r"the water failed in frame.*?;", server.messages())[0]
        again, folder = self.failed_run(
            "again", "--from-state", out / "numerical_failure.state", scene=out / "numerical_failure.json"
        )
        self.assertIn(failure, again.messages())
        state = "numerical_failure.state"
        self.assertEqual((folder / state).read_bytes(), (out / state).read_bytes())

    def test_command_that_a_failure_prints_runs_through(self):
        server, _ = self.failed_run()
        command = shlex.split(re.search(r"go on with: fluid_server (.*)", server.messages())[1])
        self.assertIn("/fluid/cfl=0.5", command)
        self.assert_ended_well(self.start(SERVER, *command, "--session", self.session))

    def test_failure_without_a_run_folder_leaves_its_state_here(self):
        server = self.start(
            SERVER, COLLAPSE, "--session", self.session, "--consumers", "0", cwd=self.folder
        )
        self.assert_ends(server, 9, "is in numerical_failure.state")
        self.assertTrue((self.folder / "numerical_failure.state").exists())

    def test_failure_in_a_folder_that_cannot_be_written_is_still_a_numerical_failure(self):
        (self.folder / "numerical_failure.json").mkdir()
        server = self.start(
            SERVER, COLLAPSE, "--session", self.session, "--consumers", "0", cwd=self.folder
        )
        self.assert_ends(server, 9, "compressed by", "is lost: cannot write numerical_failure.json")

    def test_run_that_goes_on_from_a_state_has_the_same_bits(self):
        for scene, threads in (SMALL, 1), (EMITTER, 2):
            with self.subTest(scene=scene.name):
                whole, half, end = (self.folder / f"{scene.stem}-{n}.state" for n in ("whole", "half", "end"))
                self.assert_ended_well(self.alone(scene, "--until-s", "2", "--threads", "1", "--save-state", whole))
                self.assert_ended_well(self.alone(scene, "--until-s", "1", "--threads", "1", "--save-state", half))
                second = self.alone(
                    scene, "--until-s", "1", "--threads", threads, "--from-state", half, "--save-state", end
                )
                self.assert_ended_well(second)
                self.assertIn("goes on from", second.messages())
                self.assertIn("state written to", second.messages())
                self.assertEqual(water_of(end), water_of(whole))
                self.assertNotEqual(water_of(half), water_of(whole))

    def test_interrupted_run_saves_its_state(self):
        file = self.folder / "water.state"
        server = self.alone(SMALL, *ENDLESS, "--save-state", file)
        self.wait_for_frame(5, server)
        server.send(signal.SIGINT)
        self.assert_ends(server, 130, f"state written to {file}")
        on = self.alone(SMALL, "--until-s", "0.1", "--from-state", file)
        self.assert_ended_well(on)

    def test_states_that_do_not_fit_are_refused(self):
        file = self.folder / "water.state"
        self.assert_ended_well(self.alone(SMALL, "--until-s", "0.1", "--save-state", file))
        for setting, text in (
            ("/fluid/particle_spacing_m=0.4", "/fluid/particle_spacing_m is 0.5 in this file and 0.4 in the scene"),
            ("/channel/x_max_m=19", "20 in this file and 19 in the scene; allowed in the scene: 20"),
            ("/fluid/rest_density_kg_m3=900", "/fluid/rest_density_kg_m3"),
            ("/fluid/model=kinematic", "/fluid/model is kinematic; allowed: dfsph"),
        ):
            refused = self.alone(SMALL, "--from-state", file, "--set", setting, "--set", "/fluid/max_particles=5000")
            self.assert_ends(refused, 2, str(file), text)
        data = file.read_bytes()
        for bad, text in (data[:-7], "cut off"), (data[:200] + b"x" + data[201:], "checksum"), (b"{}", "size in bytes"):
            file.write_bytes(bad)
            self.assert_ends(self.alone(SMALL, "--from-state", file), 2, str(file), text)
        self.assert_ends(self.alone(SMALL, "--from-state", self.folder / "none"), 2, "none", "No such file")
        nowhere = self.folder / "no" / "water.state"
        self.assert_ends(self.alone(SMALL, "--save-state", nowhere), 2, "--save-state", str(nowhere))


class Launched(SystemTest):
    def run_sh(self, out, *arguments, scene=SMALL):
        command = [RUN, scene, "--session", self.session, "--out", self.folder / out, "--no-figure", *arguments]
        return self.start(*command, cwd=self.folder, env={**os.environ, "WADE_BUILD": str(PROGRAMS)})

    def test_failure_of_a_pair_leaves_state_and_whole_log_in_the_run_folder(self):
        self.assert_ends(self.run_sh("run", scene=COLLAPSE), 9, "compressed by", "go on with: fluid_server")
        log = (self.folder / "run" / "fluid_server.log").read_text()
        self.assertEqual(log.count("compressed by"), 1)
        self.assertNotIn("\0", log)
        self.assertTrue((self.folder / "run" / "numerical_failure.state").exists())

    def test_pair_goes_on_from_a_state(self):
        file = self.folder / "water.state"
        self.assert_ended_well(self.run_sh("first", "--until-s", "1", "--save-state", file))
        second = self.run_sh("second", "--until-s", "1", "--from-state", "water.state")
        self.assert_ended_well(second)
        log = (self.folder / "second" / "fluid_server.log").read_text()
        self.assertIn("goes on from water.state: frame 30 of the water, t = 1 s, 640 particles", log)
        self.assertIn("30 frames", log)


if __name__ == "__main__":
    unittest.main()
