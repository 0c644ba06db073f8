"""The same scene gives the same results, whatever the threads, the order of start, pauses, the lockstep depth, and the
processor."""

import os
import re
import signal
import unittest
from pathlib import Path
from unittest.mock import patch

from harness import CONSUMER_WAITING, ROOT, SystemTest, wait_until

# frame_hash of the water of scenes in configs, up to a time. Whoever changes bits on purpose writes the new ones, which the test
# tells, and says why in the changelog.
GOLDEN = {
    ("paper/s05", 1): "91e52b81d9899025",
    ("river/s05", 1): "ffda30f342b5f098",
    ("river/obstacle", 0.5): "dd3331a159d1f2da",
    ("manning/s08", 0.3): "cd018a678da28171",
    ("bench/dam_break", 0.3): "b69bbc8a013514e0",
    ("bench/column_at_rest", 0.2): "5c6adf986ebc1be1",
    ("models/container", 1): "8b9a69747505826b",
    ("models/mixed_obstacle", 2): "a917558b7bf64248",
    ("models/shallow_water_obstacle", 1): "a77f3469d674bfe4",
    ("models/planes", 0.5): "7a4fcf89eae0c171",
    ("sites/hamlet", 4): "680b1f37e72969ad",
    ("sites/paper_village", 4): "6323d449db0094b3",
    ("validation/cavity", 0.1): "846b0c049e35b842",
    ("validation/taylor_green", 0.1): "d8482a9addafa6f3",
}
# People push it, so that the crowd's bits are in the water's.
PUSHED = ("models/measured", 1, "abed311c313cf3b5")
# By particles, among houses from 10 s on.
AMONG_HOUSES = ("sites/paper_village", 13, "997119ffd6e7e39b")
BY_PARTICLES = ("--set", "/fluid/model=dfsph", "--set", "/fluid/particle_spacing_m=0.5")


def has_fused_multiply_add():
    """Of x86-64 the processors with AVX2 give the golden bits; what others give is not known."""
    info = Path("/proc/cpuinfo")
    return info.exists() and {"avx2", "fma"} <= set(re.findall(r"\w+", info.read_text(encoding="ascii", errors="replace")))


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

    @unittest.skipUnless(has_fused_multiply_add(), "x86-64 with AVX2 and FMA")
    def test_processors_with_narrow_and_wide_vectors_give_the_same_bits(self):
        def frame_hash(scene, until, *options):
            return self.pair("--until-s", until, *options, scene=ROOT / "configs" / f"{scene}.json").outcome()["frame_hash"]

        for environment in ({}, {"WADE_NARROW_VECTORS": "1"}):
            with patch.dict(os.environ, environment):
                found = {key: frame_hash(*key) for key in GOLDEN}
                pushed = (*PUSHED[:2], frame_hash(*PUSHED[:2], "--set", "/coupling/two_way=true"))
                among_houses = (*AMONG_HOUSES[:2], frame_hash(*AMONG_HOUSES[:2], *BY_PARTICLES))
            with self.subTest(environment=environment):
                self.assertEqual(found, GOLDEN)
                self.assertEqual(pushed, PUSHED)
                self.assertEqual(among_houses, AMONG_HOUSES)

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
