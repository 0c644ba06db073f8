"""Measures and verdicts of `wade converge`; runs nothing."""

import argparse
import tempfile
import unittest
from pathlib import Path
from unittest import mock

from wade import UsageError, progress
from wade.suites.converge import COLUMNS, compared, counts, measures_of, parse, people_verdict, report, settings_of, tell_how_far, verdict
from wade.suites.converge.cases import CASES, WALKING, Case, rates


def person(outcome="arrived", time=10.0, off="", state="arrived", worst="walking"):
    return {"outcome": outcome, "time_s": str(time), "off_feet_s": off, "state": state, "worst_state": worst}


class Measures(unittest.TestCase):
    def test_shares_and_times_count_everybody_once(self):
        rows = [person(time=10), person("sheltered", 20), person("dead", 30, off="5"), person("active", 99), person("indoors", 99)]
        found = measures_of(rows)
        self.assertEqual([found[key] for key in ("safe", "lost", "no end yet", "off their feet")], [40, 20, 40, 20])
        self.assertEqual(found["half had an end, s"], 20)
        self.assertEqual(found["nine tenths had an end, s"], 30)

    def test_where_nobody_had_an_end_there_is_no_time(self):
        self.assertIsNone(measures_of([person("active")])["half had an end, s"])


class Options(unittest.TestCase):
    def test_factors_are_named_without_their_units(self):
        self.assertEqual(parse(["--factors", "cell,walk*", "street"]).factor_names, ["cell, m", "walking law"])
        for wrong in (["--factors", "m"], ["nowhere"]):
            with self.assertRaisesRegex(UsageError, "no such case; allowed: "):
                parse(wrong)


class Verdicts(unittest.TestCase):
    reference = [40.0, 42, 44, 41, 39, 43, 40, 42]

    def word(self, changes, measure="lost"):
        return verdict(measure, self.reference, [a + b for a, b in zip(self.reference, changes)])[3]

    def test_a_share_is_equal_within_three_points_and_different_beyond(self):
        self.assertEqual(self.word([0.5, -0.5] * 4), "equal")
        self.assertEqual(self.word([7, 8] * 4), "different")
        self.assertEqual(self.word([-9, -8] * 4), "different")
        self.assertEqual(self.word([12, -6] * 4), "undecided")

    def test_a_time_is_measured_by_itself(self):
        self.assertEqual(self.word([1.5, 1.8] * 4, "half had an end, s"), "equal")  # 5 % are 2.07 s
        self.assertEqual(self.word([2.9, 3.1] * 4, "half had an end, s"), "different")
        self.assertEqual(verdict("half had an end, s", [None, 40.0], [50.0, None])[3], "equal")

    def test_single_persons_must_have_the_same_states_and_nearly_the_same_times(self):
        one = [person(time=50)]
        self.assertEqual(people_verdict(one, [person(time=50.9)]), "equal")
        self.assertEqual(people_verdict(one, [person(time=51.1)]), "different")
        self.assertEqual(people_verdict(one, [person(time=50, worst="sliding")]), "different")


class Table(unittest.TestCase):
    def test_each_factor_is_varied_alone(self):
        case = Case("toy", "toy", (rates(30, 8),))
        settings = settings_of(case)
        self.assertEqual(settings["reference", ""], {"/frame_rate_hz": 30, "/crowd/step_rate_hz": 30})
        self.assertEqual(settings["rate, 1/s", "8"], {"/frame_rate_hz": 8, "/crowd/step_rate_hz": 8})
        people = {1: [person()], 2: [person("dead", 5)]}
        rows = list(compared(case, {("reference", ""): people, ("rate, 1/s", "8"): people}, lambda *_: True))
        self.assertEqual({row["warned"] for row in rows}, {"yes"})
        self.assertEqual(counts(rows), (0, 0, 0, 0, 0, 6, 0))
        self.assertEqual({row["verdict"] for row in rows}, {"equal"})
        self.assertTrue(all(set(row) <= set(COLUMNS) for row in rows))
        self.assertEqual(counts([{**row, "warned": ""} for row in rows]), (6, 6, 6, 0, 0, 0, 0))

    def test_physical_choices_are_reported_without_a_limit(self):
        case = Case("toy", "toy", (rates(30, 8),), quick=True, choices=(WALKING,))
        settings = settings_of(case)
        self.assertEqual(settings["reference", ""]["/crowd/walking_in_water"], "relative")
        key = ("walking law", "bernardini")
        self.assertEqual(settings[key]["/crowd/walking_in_water"], "bernardini")
        rows = list(compared(case, {("reference", ""): {1: [person()]}, key: {1: [person("dead", 5)]}}))
        self.assertEqual({row["verdict"] for row in rows}, {"reported"})
        self.assertEqual({row["measure"]: row["difference"] for row in rows}["lost"], 100)
        self.assertIn("100.0", report(rows, argparse.Namespace(command="")))

    def test_each_case_varies_a_factor_by_four_at_least(self):
        for case in CASES:
            for factor in case.factors:
                values = (factor.reference, *factor.values)
                self.assertGreaterEqual(max(values) / min(values), 4, (case.name, factor.name))


class Progress(unittest.TestCase):
    def test_the_log_of_the_runs_tells_how_many_have_ended(self):
        with tempfile.TemporaryDirectory() as folder:
            log = Path(folder, "door.log")
            log.write_text("[1/40]\n[3/40] 00003, 2 min left\nt 5 s\n")
            tell_how_far(mock.Mock(poll=mock.Mock(side_effect=[None, 0])), log, "door")
        self.assertEqual((progress.STATE.what, progress.STATE.done, progress.STATE.total), ("runs door", 3, 40))


if __name__ == "__main__":
    unittest.main()
