"""What the store keeps of runs, loses and refuses, on records that are made up; runs nothing."""

import json
import multiprocessing
import tempfile
import unittest
from pathlib import Path

from wade.suites.paper.results import arrival_times, groups_of
from wade.suites.paper.store import Store, StoreError, same_scene

SCENE = {"name": "s05", "seed": 1, "fluid": {"model": "dfsph", "cfl": 0.5}, "crowd": {"groups": [{"tau": 0.2}]}}
RUN = "observed/v1.5/s5"


def record(arrived, program="aaaa"):
    return {"commit": "abc", "program": program, "arrived": arrived}


def scene(**changed):
    return {**SCENE, **changed}


def add_many(file, run):
    store = Store(file)
    for seed in range(1, 41):
        store.add(run, seed, scene(fluid={"model": run}), record(seed))


class Stores(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory(prefix="wade-test-")
        self.addCleanup(self.temporary.cleanup)
        self.file = Path(self.temporary.name) / "runs.jsonl"

    def lines(self, key="run"):
        return [line for line in map(json.loads, self.file.read_text().splitlines()) if key in line]

    def test_what_was_added_is_found_again(self):
        self.assertIsNone(Store(self.file).find(RUN, 1, SCENE))
        Store(self.file).add(RUN, 1, SCENE, record(50))
        Store(self.file).add(RUN, 2, scene(seed=2), record(49))
        store = Store(self.file)
        self.assertEqual(store.find(RUN, 1, SCENE), record(50))
        self.assertEqual(store.find(RUN, 2, scene(seed=2, name="other")), record(49))
        self.assertEqual(store.seeds(RUN), {1, 2})
        self.assertIsNone(store.find(RUN, 3, scene(seed=3)))
        self.assertIsNone(store.find("observed/v1.5/s6", 1, SCENE))

    def test_a_run_counts_for_its_scene_alone(self):
        Store(self.file).add(RUN, 1, SCENE, record(50))
        other = scene(crowd={"groups": [{"tau": 0.8}]})
        self.assertIsNone(Store(self.file).find(RUN, 1, other))
        Store(self.file).add(RUN, 1, other, record(4))
        store = Store(self.file)
        self.assertEqual((store.find(RUN, 1, SCENE), store.find(RUN, 1, other)), (record(50), record(4)))

    def test_a_key_that_the_scene_did_not_have_then_must_have_its_default(self):
        Store(self.file).add(RUN, 1, SCENE, record(50))
        known, silent = {"model": "dfsph", "cfl": 0.5}, {"kernel": "cubic_spline"}
        self.assertEqual(Store(self.file).find(RUN, 1, scene(fluid={**known, **silent})), record(50))
        self.assertIsNone(Store(self.file).find(RUN, 1, scene(fluid={**known, "kernel": "wendland_c2"})))
        self.assertIsNone(Store(self.file).find(RUN, 1, scene(fluid={"model": "dfsph"})))

    def test_scenes_come_back_whole_and_are_kept_once(self):
        store, scenes = Store(self.file), [SCENE, scene(fluid={"model": "kinematic"}), scene(events=[{"at_s": 29}])]
        for number, each in enumerate([*scenes, *scenes]):
            store.add(f"observed/v1.5/c{number}", 1, each, record(number))
        kept = Store(self.file)
        for number, each in enumerate([*scenes, *scenes]):
            self.assertEqual(kept.find(f"observed/v1.5/c{number}", 1, each), record(number))
        self.assertEqual(len(self.lines("is")), len(scenes))

    def test_a_scene_may_be_told_from_another_one(self):
        Store(self.file).add(RUN, 1, SCENE, record(50))
        key = self.lines("is")[0]["scene"]
        with open(self.file, "a", encoding="utf-8") as file:
            file.write(json.dumps({"scene": "x", "as": key, "but": {"fluid": {"cfl": 0.4}}}) + "\n")
            file.write(json.dumps({"run": RUN, "seed": 2, "scene": "x", **record(7)}) + "\n")
        self.assertEqual(Store(self.file).find(RUN, 2, scene(seed=2, fluid={"model": "dfsph", "cfl": 0.4})), record(7))

    def test_of_two_lines_of_a_run_the_last_counts(self):
        store = Store(self.file)
        store.add(RUN, 1, SCENE, record(50))
        store.add(RUN, 1, SCENE, record(48, "bbbb"))
        self.assertEqual(Store(self.file).find(RUN, 1, SCENE), record(48, "bbbb"))
        self.assertEqual(len(self.lines()), 2)

    def test_a_line_that_a_crash_cut_off_does_not_count(self):
        store = Store(self.file)
        store.add(RUN, 1, SCENE, record(50))
        store.add(RUN, 2, SCENE, record(49))
        whole = self.file.read_bytes()
        second = whole.rindex(b"\n", 0, -1) + 1
        for end in (second + 1, second + 40, len(whole) - 1):
            with self.subTest(end=end):
                self.file.write_bytes(whole[:end])
                again = Store(self.file)
                self.assertEqual(again.seeds(RUN), {1})
                again.add(RUN, 2, SCENE, record(49))
                self.assertEqual(self.file.read_bytes(), whole)

    def test_any_other_line_that_is_none_is_refused(self):
        Store(self.file).add(RUN, 1, SCENE, record(50))
        whole = self.file.read_text()
        for wrong in ("<<<<<<< HEAD\n", "7\n", '{"format":2}\n', '{"run":"a/v/s1"}\n',
                      '{"scene":"x","as":"y","but":{}}\n', "\n"):
            with self.subTest(wrong=wrong), self.assertRaisesRegex(StoreError, "runs.jsonl:4: "):
                self.file.write_text(whole + wrong + whole)
                Store(self.file)

    def test_two_campaigns_add_to_one_file(self):
        runs = ["a/v/s1", "a/v/s2"]
        processes = [multiprocessing.Process(target=add_many, args=(self.file, run)) for run in runs]
        for process in processes:
            process.start()
        for process in processes:
            process.join()
            self.assertEqual(process.exitcode, 0)
        store = Store(self.file)
        for run in runs:
            self.assertEqual(store.seeds(run), set(range(1, 41)))
        self.assertEqual((len(self.lines()), len(self.lines("format"))), (80, 1))


class Records(unittest.TestCase):
    def test_arrivals_come_back_to_the_last_bit(self):
        steps = {"a": [1367, 929, 1366, 929], "b": [930]}
        agents = [{"group": g, "outcome": "arrived", "time_s": repr(s / 30)} for g, of_g in steps.items() for s in of_g]
        agents += [{"group": "b", "outcome": "dead", "time_s": "3"},
                   {"group": "c", "outcome": "active", "time_s": "400"}]
        kept = json.loads(json.dumps({"groups": groups_of(agents, 30.0), "step_rate_hz": 30.0}))
        self.assertEqual(arrival_times(kept, "a"), [s / 30 for s in sorted(steps["a"])])
        self.assertEqual(arrival_times(kept), [s / 30 for s in sorted(steps["a"] + steps["b"])])
        self.assertEqual([(g["agents"], g["dead"]) for g in kept["groups"].values()], [(4, 0), (2, 1), (1, 0)])


class Scenes(unittest.TestCase):
    OLD = {"name": "a", "seed": 1, "fluid": {"model": "dfsph"}, "crowd": {"tau": 0.2}}

    def changed(self, text):
        return same_scene(self.OLD, {**json.loads(json.dumps(self.OLD)), **text})

    def test_a_key_that_is_new_and_has_its_default_is_the_same_scene(self):
        self.assertTrue(self.changed({"name": "b"}))
        steering = {"bodies": [], "walls": {"rule": "both"}}
        self.assertTrue(self.changed({"fluid": {"model": "dfsph", "steering": steering}}))

    def test_groups_from_before_people_had_bodies_are_the_same_with_the_crowds_defaults(self):
        old = {"crowd": {"groups": [{"tau": 0.2}, {"tau": 0.8}]}}
        body = {"can_swim": False, "skill": "by_size", "people": []}
        self.assertTrue(same_scene(old, {"crowd": {"groups": [{"tau": 0.2, **body}, {"tau": 0.8, **body}]}}))
        self.assertFalse(same_scene(old, {"crowd": {"groups": [{"tau": 0.2, **body}, {"tau": 0.8, "skill": "poor"}]}}))
        self.assertFalse(same_scene(old, {"crowd": {"groups": [{"tau": 0.2, **body}]}}))
        self.assertFalse(same_scene(old, {"crowd": {"groups": [{"tau": 0.2}, {"tau": 0.7}]}}))

    def test_any_other_change_is_another_scene(self):
        self.assertFalse(self.changed({"seed": 2}))
        self.assertFalse(self.changed({"fluid": {"model": "steering"}}))
        self.assertFalse(self.changed({"fluid": {}}))
        self.assertFalse(self.changed({"crowd": {"tau": 0.2, "navigation": {"rule": "travel_time"}}}))
        self.assertFalse(self.changed({"crowd": {"tau": 0.2, "no_such_key": 0}}))


if __name__ == "__main__":
    unittest.main()
