"""The producers of tools/producers: all play the stream that their README defines, and the crowd cannot tell."""

import math
import os
import shutil
import subprocess
import sys
import unittest
from array import array
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tests" / "system"))
from harness import PROGRAMS, SystemTest  # noqa: E402
from wade.conformance.layout import chain  # noqa: E402

FOLDER = ROOT / "tools" / "producers"
PYTHON = ["/usr/bin/python3", "-B"]
SCENE = ROOT / "configs" / "paper" / "s05.json"
FRAMES = 120  # 4 s: some of the 50 people of the scene have reached the water by then

os.environ.setdefault("WADE_SHM_LIBRARY", str(PROGRAMS / "libwade_shm.so"))
os.environ.setdefault("WADE_NODE_ADDON", str(PROGRAMS / "producers" / "wade_shm_node.node"))
PRODUCERS = {
    "c": [PROGRAMS / "producers" / "c_producer"],
    "plain": [*PYTHON, FOLDER / "python" / "producer_plain.py"],
    "numpy": [*PYTHON, FOLDER / "python" / "producer_numpy.py"],
    "ctypes": [*PYTHON, FOLDER / "python" / "producer_ctypes.py"],
    "node": [os.environ.get("WADE_NODE", "node"), FOLDER / "node" / "producer.mjs"],
    "people": [PROGRAMS / "producers" / "people_producer"],
}
TAKE_PEOPLE = {"ctypes": ["serial"], "node": ["parallel"], "people": ["serial", "parallel"]}  # and the coupling lags tried
PRODUCERS = {name: PRODUCERS[name] for name in os.environ.get("WADE_PRODUCERS", " ".join(PRODUCERS)).split()}


def definition(frame, speed, particles):
    """The arrays of a frame as tools/producers/README.md defines them, as bytes."""
    places = range(particles)
    x = [(60 + k // 50 * 0.4642) - speed * frame / 30 for k in places]
    arrays = (
        [100] * particles,
        [-speed] * particles,
        [0] * particles,
        [0] * particles,
        [v - 100 * math.floor(v / 100) for v in x],
        [0.23] * particles,
        [12 + k % 50 * 0.4642 for k in places],
    )
    return [array("f", values).tobytes() for values in arrays]


def hash_of_definition(frames, speed=1.5, particles=2000):
    value = 0
    for frame in range(1, frames + 1):
        value = chain(value, frame, definition(frame, speed, particles))
    return f"{value:016x}"


class ProducersAgree(SystemTest):
    def play(self, command, *options, frames=FRAMES):
        """Runs a producer and the crowd to a good end; returns the run of the crowd."""
        producer = self.start(*command, SCENE, "--session", self.session, "--frames", frames, *options)
        client = self.client("--reproducible", "--until-s", frames / 30, scene=SCENE)
        self.assert_ended_well(client, producer)
        self.assertEqual(client.run.outcome()["frames"], frames)
        return client.run

    def test_every_producer_plays_the_frames_of_the_definition_and_moves_the_same_people(self):
        expected = hash_of_definition(FRAMES)
        paths = {}
        for name, command in PRODUCERS.items():
            with self.subTest(producer=name):
                run = self.play(command)
                self.assertEqual(run.outcome()["frame_hash"], expected)
                paths[name] = run.bytes_of("agents.csv"), run.rows()
        for name, path in paths.items():
            with self.subTest(producer=name):
                self.assertEqual(path, paths["c"], "the outcome of the crowd is that with the C producer")

    def test_the_stream_reaches_the_people(self):
        """So that the comparison of their paths could fail."""
        slow, fast = (self.play(PRODUCERS["c"], "--speed", speed).bytes_of("agents.csv") for speed in ("0.5", "1.5"))
        self.assertNotEqual(slow, fast)

    def people_in_water_of(self, name, lag, two_way):
        """outcome.json of the crowd beside a producer that takes people."""
        producer = self.start(*PRODUCERS[name], "--take-people", SCENE, "--session", self.session, "--frames", FRAMES)
        coupling = ["--set", f"/coupling/agents_stream={lag}", "--set", f"/coupling/two_way={two_way}"]
        client = self.client("--reproducible", "--until-s", FRAMES / 30, *coupling, scene=SCENE)
        self.assert_ended_well(client, producer)
        return client.run.outcome()

    def test_water_of_each_producer_that_takes_people_loses_what_they_got(self):
        """float32: a velocity that is changed is rounded by 6e-8 of it, that of a particle of 100 kg by 1e-5 N s."""
        for name in filter(PRODUCERS.__contains__, TAKE_PEOPLE):
            for lag in TAKE_PEOPLE[name]:
                with self.subTest(producer=name, lag=lag):
                    outcome = self.people_in_water_of(name, lag, "true")
                    momentum = outcome["momentum"]
                    got = max(map(abs, momentum["people_got_n_s"]))
                    self.assertGreater(got, 10)
                    self.assertLess(outcome["momentum_balance_n_s"], 1e-5 * got)
                    self.assertLess(max(map(abs, momentum["water_had_not_n_s"])), 0.1 * got)
                    self.assertNotEqual(outcome["frame_hash"], hash_of_definition(FRAMES))

    def test_people_who_do_not_push_leave_the_frames_as_they_are(self):
        for name in filter(PRODUCERS.__contains__, TAKE_PEOPLE):
            with self.subTest(producer=name):
                outcome = self.people_in_water_of(name, "serial", "false")
                self.assertEqual(outcome["frame_hash"], hash_of_definition(FRAMES))

    def test_options_mean_the_same_to_every_producer(self):
        """Fast enough to go round the channel; the depth makes no difference to the frames."""
        options = ["--speed", "37.7", "--particles", "1003", "--depth", "3"]
        expected = hash_of_definition(60, 37.7, 1003)
        for name, command in PRODUCERS.items():
            with self.subTest(producer=name):
                self.assertEqual(self.play(command, *options, frames=60).outcome()["frame_hash"], expected)

    def test_plain_producer_needs_no_package(self):
        bare = ["/usr/bin/python3", "-B", "-S"]  # without site-packages
        self.assertNotEqual(subprocess.run([*bare, "-c", "import numpy"], stderr=subprocess.DEVNULL).returncode, 0)
        self.play([*bare, FOLDER / "python" / "producer_plain.py"], frames=5)

    def test_c_producer_needs_nothing_but_a_c_compiler(self):
        for file in (FOLDER / "c").iterdir():
            shutil.copy(file, self.folder)
        program = self.folder / "own_producer"
        subprocess.run(["cc", "-std=c11", "-O2", "producer.c", "-o", program, "-lm"], cwd=self.folder, check=True)
        self.assertEqual(self.play([program], frames=60).outcome()["frame_hash"], hash_of_definition(60))

    def test_a_crowd_with_another_scene_is_turned_away(self):
        for name, command in PRODUCERS.items():
            with self.subTest(producer=name):
                producer = self.start(*command, "--session", self.session, "--scene-hash", "123456789abcdef0")
                client = self.client(scene=SCENE)
                self.assert_ends(client, 6, "123456789abcdef0")
                self.assert_ends(producer, 5, "123456789abcdef0")

    def test_wrong_options_are_refused_by_name(self):
        wrong = {
            "--frames": ["0", "1.5", "many"],
            "--particles": ["0", "-1"],
            "--depth": ["0", "64"],
            "--speed": ["101", "nan", "fast"],
            "--scene-hash": ["xyz", "1" * 17],
            "--step-timeout-s": ["-1"],
        }
        cases = [(option, value) for option, values in wrong.items() for value in values]
        for name, command in PRODUCERS.items():
            # Starting an interpreter takes long: one value of each option is enough for programs with a common parser.
            chosen = cases if name in ("c", "plain", "node", "people") else cases[::4]
            for option, value in chosen:
                with self.subTest(producer=name, option=option, value=value):
                    self.assert_ends(self.start(*command, "--session", self.session, option, value), 2, option, value)
            with self.subTest(producer=name, option="--session"):
                self.assert_ends(self.start(*command, "--session", "a/b"), 2, "a/b")
                self.assert_ends(self.start(*command), 2, "--session")
                self.assert_ends(self.start(*command, "--session", self.session, "--sped", "1"), 2, "--sped")


if __name__ == "__main__":
    unittest.main()
