"""The comparison of frame rates: rates and scenes that it takes, what its crowds set, what it says of a failed run."""

import argparse
import types
import unittest

from wade.sweeps import frame_rates


def scene(taus=(0.2,), events=(), model="kinematic"):
    """What the programs resolve: each group with a tau of its own, each event with its frame."""
    return {
        "fluid": {"model": model},
        "crowd": {"goal_radius_m": 3.0, "groups": [{"name": "walkers", "count": 5, "tau": tau} for tau in taus]},
        "events": [{"frame": frame, "tau": 1.0} for frame in events],
    }


class Rates(unittest.TestCase):
    def test_they_come_ascending_and_whole_where_they_are(self):
        self.assertEqual(frame_rates.rates_of("120,15,29.97"), [15, 29.97, 120])
        self.assertEqual([str(rate) for rate in frame_rates.rates_of("30.0,15")], ["15", "30"])

    def test_others_are_refused_with_what_is_allowed(self):
        for text in ("15,abc", "15", "15,15", "15,15.0,30", "", "15,", "0,15", "-1,15", "15,nan", "15,inf", "15,1001"):
            with self.subTest(text), self.assertRaises(argparse.ArgumentTypeError) as refused:
                frame_rates.rates_of(text)
            for part in (f'"{text}"', "two different rates", "0.01 to 1000 Hz"):
                self.assertIn(part, str(refused.exception))

    def test_steps_of_the_crowd_follow_the_frames_whatever_the_scene_says(self):
        self.assertEqual(frame_rates.at_rate(15), ["--set", "/frame_rate_hz=15", "--set", "/crowd/step_rate_hz=15"])


    def test_frames_or_steps_can_be_varied_alone(self):
        frames = ["--set", "/frame_rate_hz=15", "--set", "/crowd/step_rate_hz=120"]
        self.assertEqual(frame_rates.at_rate(15, "frames", 120), frames)
        steps = ["--set", "/frame_rate_hz=120", "--set", "/crowd/step_rate_hz=15"]
        self.assertEqual(frame_rates.at_rate(15, "steps", 120), steps)


class Changes(unittest.TestCase):
    def test_walk_without_water_takes_tau_from_every_group_and_all_events(self):
        described = scene(taus=(0.2, {"min": 0.4, "max": 0.8}), events=(60,))
        changes = frame_rates.changes_of("no water", described)
        self.assertEqual([group["tau"] for group in changes["/crowd"]["groups"]], [0, 0])
        self.assertEqual(changes["/events"], [])
        changes["/crowd"]["groups"][1]["tau"] = {"min": 0.4, "max": 0.8}
        changes["/crowd"]["groups"][0]["tau"] = 0.2
        self.assertEqual(changes["/crowd"], described["crowd"], "the rest of the crowd stays, and so does the scene")

    def test_rules_change_the_rule_alone(self):
        for rule in ("per_frame", "continuous"):
            self.assertEqual(frame_rates.changes_of(rule, scene(events=(60,))), {"/coupling/rule": rule})

    def test_the_sampled_rule_is_there_if_it_is_asked_for(self):
        self.assertNotIn("continuous, sampled", frame_rates.rules_of(None))
        self.assertIn("continuous, sampled", frame_rates.rules_of(120))
        expected = {"/coupling/rule": "continuous", "/coupling/sampling_rate_hz": 120}
        self.assertEqual(frame_rates.changes_of("continuous, sampled", scene(), 120), expected)

    def test_events_at_fixed_frames_are_told_from_events_at_fixed_times(self):
        self.assertFalse(frame_rates.moves_events({15: scene(), 30: scene()}))
        # 2.05 s at each rate: in the next frame after it.
        self.assertFalse(frame_rates.moves_events({15: scene(events=(31,)), 30: scene(events=(62,))}))
        self.assertTrue(frame_rates.moves_events({15: scene(events=(31,)), 30: scene(events=(31,))}))
        self.assertTrue(frame_rates.moves_events({15: scene(events=(30, 31)), 30: scene(events=(60, 31))}))


class Report(unittest.TestCase):
    options = types.SimpleNamespace(command="tools/frame_rates.sh", seeds=2, vary="both")

    def rows(self, arrived_at, model="kinematic"):
        """Rows of both rates; arrived_at: {rate: (mean, lo, hi) or None for a failed run}."""
        described = scene(model=model)
        for rate, figures in arrived_at.items():
            for row in frame_rates.rows_of("configs/observed/s05.json", rate, described, None, 2):
                if figures:
                    row["status"] = "completed"
                    for measure in frame_rates.MEASURES:
                        row.update(zip((f"{measure}_{end}" for end in ("mean", "lo", "hi")), figures))
                yield row

    def verdicts(self, arrived_at):
        rows = [row for row in self.rows(arrived_at) if row["rule"] == "continuous"]
        return {frame_rates.verdict(rows, measure) for measure in frame_rates.MEASURES}

    def test_verdict_asks_all_intervals_for_a_common_value(self):
        self.assertEqual(self.verdicts({15: (5, 4, 6), 30: (6.5, 6, 7)}), {"1.50, pass"})
        self.assertEqual(self.verdicts({15: (5, 4, 6), 30: (7, 6.5, 8)}), {"2.00, FAIL"})
        self.assertEqual(self.verdicts({15: (5, 4, 6), 30: (None, None, None)}), {"-"})

    def test_failed_rate_stays_in_the_table_and_leaves_the_verdict_open(self):
        self.assertEqual(self.verdicts({15: (5, 4, 6), 30: None, 60: (5, 4, 6)}), {"incomplete"})
        text = frame_rates.report(list(self.rows({15: (5, 4, 6), 30: None})), self.options)
        self.assertIn("at 15, 30 Hz", text)
        self.assertIn("| per_frame | 30 | failed | failed | failed |", text)
        self.assertIn("| per_frame | incomplete | incomplete | incomplete |", text)
        self.assertNotIn("pass |", text)

    def test_report_says_that_solved_water_differs_between_rates(self):
        figures = {15: (5, 4, 6), 30: (5, 4, 6)}
        said = "of the model dfsph is not the same at all rates"
        self.assertIn(said, frame_rates.report(list(self.rows(figures, "dfsph")), self.options))
        text = frame_rates.report(list(self.rows(figures)), self.options)
        self.assertIn("## observed-s05 (kinematic)", text)
        self.assertNotIn("not the same", text)

    def test_report_says_what_was_kept(self):
        options = types.SimpleNamespace(command="tools/frame_rates.sh --vary frames", seeds=2, vary="frames")
        text = frame_rates.report(list(self.rows({15: (5, 4, 6), 30: (5, 4, 6)})), options)
        self.assertIn("frames of the water at 15, 30 Hz, steps of the crowd at 30 Hz, 2 seeds", text)

    def test_interval_is_that_of_the_mean_of_what_is_known(self):
        self.assertEqual(frame_rates.interval([None, None]), (None, None, None))
        self.assertEqual(frame_rates.interval([3, 3, None]), (3, 3, 3))
        mean, low, high = frame_rates.interval([1, 2, 3, 4])
        self.assertTrue(1 <= low < mean == 2.5 < high <= 4)


if __name__ == "__main__":
    unittest.main()
