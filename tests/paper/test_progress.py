"""What tools/paper/progress.py expects of a campaign, and what it says of its speed."""

import io
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools" / "paper"))

from progress import Progress, duration, most_work, particles_of, steps_in_a_frame, work_done  # noqa: E402


def scene(spacing=0.4642, velocity=1.5, model="dfsph"):
    return {
        "duration_s": 400, "frame_rate_hz": 30, "world": {"gravity_m_s2": 9.81},
        "channel": {"x_min_m": 0, "x_max_m": 100, "z_min_m": 11.5, "z_max_m": 38.5, "depth_m": 1, "velocity_m_s": velocity},
        "fluid": {"model": model, "particle_spacing_m": spacing, "cfl": 0.5},
    }


class Work(unittest.TestCase):
    def test_the_river_of_the_paper_takes_a_step_a_frame(self):
        # 0.5 * 0.4642 / (1.5 + 3.13) = 0.050 s, longer than 1/30 s; with 0.25 m 0.027 s.
        self.assertEqual(steps_in_a_frame(scene()), 1)
        self.assertEqual(steps_in_a_frame(scene(spacing=0.25)), 2)
        self.assertEqual(particles_of(scene(spacing=0.25)), 172800)
        self.assertEqual(most_work(scene(spacing=0.25)), 172800 * 2 * 12000)

    def test_given_water_has_no_time_steps_of_its_own(self):
        self.assertEqual(steps_in_a_frame(scene(spacing=0.1, model="kinematic")), 1)

    def test_a_run_without_a_solver_counts_particles_and_frames(self):
        self.assertEqual(work_done({"frames": 10, "fluid": {"particle_steps": 700, "particles_max": 100}}), 700)
        self.assertEqual(work_done({"frames": 10, "fluid": {"particle_steps": None, "particles_max": 100}}), 1000)

    def test_durations(self):
        self.assertEqual([duration(s) for s in (45, 720, 11100)], ["45 s", "12 min", "3 h 05 min"])


class Telling(unittest.TestCase):
    def test_time_to_go_follows_the_speed_of_each_kind_of_water(self):
        now, said = [0.0], io.StringIO()
        progress = Progress(clock=lambda: now[0], stream=said)
        progress.plan({"o/a": (3, 1000e6, "kinematic"), "r/a": (10, 400e6, "dfsph"), "r/b": (10, 600e6, "dfsph")})
        self.assertIn("ahead: 3 waters, 23 crowds; to be solved at most 1,000 M particle-steps\n", said.getvalue())
        now[0] = 10
        progress.finished("o/a", 500e6, 10)
        self.assertIn("1 of 3 waters in 10 s, at most 0 s and 2 waters of a kind not yet run to go", said.getvalue())
        now[0] = 210
        progress.finished("r/a", 100e6, 200)
        line = said.getvalue().splitlines()[-1]
        # 600 M at 0.5 M/s
        expected = "r/a: 100 M particle-steps in 3 min (0.50 M particle-steps/s); 2 of 3 waters in 4 min, at most 20 min to go"
        self.assertEqual(line, expected)
        progress.finished("r/b", 100e6, 200)
        self.assertTrue(said.getvalue().endswith("3 of 3 waters in 4 min\n"))

    def test_a_further_round_of_seeds_was_not_in_the_plan(self):
        said = io.StringIO()
        progress = Progress(stream=said)
        progress.plan({})
        progress.finished("o/a", 1, 1)
        self.assertEqual(said.getvalue(), "")


if __name__ == "__main__":
    unittest.main()
