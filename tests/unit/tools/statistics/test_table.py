"""What is read of an ensemble's folder, and the table of runs that are made up."""

import contextlib
import csv
import io
import json
import re
import tempfile
import unittest
from pathlib import Path

import numpy as np

from wade import UsageError
from wade.reports.tables import read_csv
from wade.statistics import page, sensitivity, table, victims
from wade.statistics.ensemble import classes, read_ensemble
from wade.statistics.indices import trajectories

HEAD = ("id,group,outcome,time_s,x_m,z_m,tau,mass_kg,path_length_m,max_depth_m,max_dv_m2_s,mean_depth_m,mean_dv_m2_s,state,"
        "height_m,mean_tau,worst_state,age,skill,start_x_m,start_z_m,off_feet_s")
SCENE = {"crowd": {"response": "measured", "goal_radius_m": 2, "groups": [{"name": "walkers", "goal": {"x_m": 90, "z_m": 45}}]},
         "channel": {"flow": "open", "x_min_m": 0, "x_max_m": 100, "z_min_m": 10, "z_max_m": 40, "velocity_m_s": 1.0, "depth_m": 1.0,
                     "velocity_history": [], "water_blocks": []},
         "world": {"length_m": 100, "width_m": 50, "ends": "open"}, "obstacles": []}


def write_run(folder, seed, arrive, drown, people=20, status="completed"):
    """Writes a run: the first people arrive, the next drown at (30, 25) and the others walk."""
    folder.mkdir(parents=True)
    states = ["arrived"] * arrive + ["drowned"] * drown + ["walking"] * (people - arrive - drown)
    outcome = {"arrived": "arrived", "drowned": "dead", "walking": "active"}
    lines = [f"{k},walkers,{outcome[state]},{50 + k if state != 'walking' else 100},30,25,0.2,65,9,1,1,1,1,{state},1.7,0.2,walking,"
             f"{20 if k % 2 else 70},normal,{10 * k},5,{40 if state == 'drowned' else ''}" for k, state in enumerate(states)]
    (folder / "agents.csv").write_text("\n".join([HEAD, *lines]) + "\n")
    (folder / "outcome.json").write_text(json.dumps({
        "scene": "made_up", "seed": seed, "status": status, "agents": people, "arrived": arrive, "dead": drown,
        "sim_time_s": 100.0, "states": {"walking": people - arrive - drown, "arrived": arrive, "drowned": drown},
        "beyond_measured": {"people": 2, "time_s": 8.5}, "warnings": [], "fluid": {"model": "shallow_water"}}))
    (folder / "manifest.json").write_text(json.dumps({"resolved_scene": {**SCENE, "seed": seed, "name": "made_up"}, "seed": seed,
                                                      "git_hash": "abc", "version": "1"}))


def write_plan(folder, lines):
    folder.mkdir(parents=True, exist_ok=True)
    with open(folder / "plan.csv", "w", newline="") as file:
        csv.writer(file).writerows([("index", "scene", "seed", "settings"), *lines])


def ensemble_in(folder, seeds=range(1, 25), drowned=lambda seed: 1 + seed % 4, all_end=False):
    write_plan(folder, [(seed, "river/s08", seed, "{}") for seed in seeds])
    for seed in seeds:
        arrive = 20 - drowned(seed) if all_end else 10 + seed % 3
        write_run(folder / "runs" / f"{seed:05d}", seed, arrive, drowned(seed))


def flooded_in(folder, seeds, people=20):
    """Runs of people indoors with 0.4 m of water at the door, or 2.4 m (the last five), of 5 to 80 years."""
    write_plan(folder, [(seed, "village", seed, "{}") for seed in seeds])
    for seed in seeds:
        write_run(folder / "runs" / f"{seed:05d}", seed, 0, 0, people)
        file = folder / "runs" / f"{seed:05d}" / "agents.csv"
        head, *lines = file.read_text().splitlines()
        rows = []
        for k, line in enumerate(lines):
            cells = dict(zip(head.split(","), line.split(",")))
            cells |= {"outcome": "indoors", "state": "indoors", "age": 5 + 75 * k // (people - 1), "height_m": 1.1 + 0.03 * k}
            rows.append(",".join(map(str, [*cells.values(), 0.4 if k < people - 5 else 2.4])))
        file.write_text("\n".join([f"{head},door_depth_m", *rows]) + "\n")


def quietly(command, *arguments):
    """What a command prints."""
    said = io.StringIO()
    with contextlib.redirect_stdout(said):
        code = command(list(map(str, arguments)))
    return code, said.getvalue()


class Folder(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="wade-test-")
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)

    def test_only_complete_runs_count_and_none_twice(self):
        write_plan(self.folder, [(k, "river/s08", min(k, 5), "{}") for k in range(1, 8)])
        for k in range(1, 7):
            write_run(self.folder / "runs" / f"{k:05d}", min(k, 5), 10, 1, status="interrupted" if k == 2 else "completed")
        with open(self.folder / "runs/00003/agents.csv", "r+") as file:
            file.truncate(500)
        (self.folder / "runs.csv").write_text("index,status\n4,stale\n")
        found = read_ensemble(self.folder)
        self.assertEqual(found.cases[0].seeds, [1, 5])
        self.assertEqual(found.left_out, {"interrupted": ["runs/00002"], "agents.csv cut off": ["runs/00003"], "stale": ["runs/00004"],
                                          "twice the same seed": ["runs/00006"], "not run": ["runs/00007"]})

    def test_each_run_that_is_left_out_is_named_with_its_reason(self):
        for k in range(1, 7):
            write_run(self.folder / f"run{k}", k, 10, 1)
        for k, name in ((2, "outcome.json"), (3, "agents.csv"), (4, "manifest.json")):
            (self.folder / f"run{k}" / name).unlink()
        (self.folder / "run5/outcome.json").write_text("{}")
        words = ("run3 (no agents.csv); run4 (no manifest.json); run2 (no outcome.json); run5 (outcome.json without status).")
        _, said = quietly(table.main, self.folder, "--no-figures")
        self.assertIn(f"Left out: {words}", said)
        quietly(page.main, self.folder)
        self.assertIn(f"Runs that are not counted: {words}", (self.folder / "report.html").read_text())
        for k in range(1, 7):
            (self.folder / f"run{k}/outcome.json").unlink(missing_ok=True)
        with self.assertRaisesRegex(UsageError, r"no complete run in it \(run1, run2, .*run6 \(no outcome.json\)\)"):
            read_ensemble(self.folder)

    def test_people_without_a_skill_are_told_the_reason_and_the_remedy(self):
        write_run(self.folder / "run1", 1, 10, 1)
        file, manifest = self.folder / "run1/agents.csv", self.folder / "run1/manifest.json"
        file.write_text(file.read_text().replace(",0.2,walking,", ",0.2,,"))
        _, said = quietly(table.main, self.folder, "--by", "skill", "--no-figures")
        self.assertIn("20 of 20 people are in no class: they have a given endurance tau and no skill; allowed: groups without tau.",
                      said.replace("\n", " "))
        manifest.write_text(manifest.read_text().replace("measured", "paper"))
        _, said = quietly(table.main, self.folder, "--by", "skill", "--no-figures")
        self.assertIn("runs with --set /crowd/response=measured and groups without tau", said.replace("\n", " "))
        file.write_text(file.read_text().replace(",skill,", ",skill_of_old,"))
        _, said = quietly(table.main, self.folder, "--by", "skill", "--no-figures")
        self.assertIn("agents.csv has no column skill; run them again", said)
        quietly(page.main, self.folder)
        text = (self.folder / "report.html").read_text()
        self.assertNotIn("How soon people drown adrift", text)
        self.assertIn("People with a given endurance do not drown", text)

    def test_the_page_of_one_run_tells_of_no_others(self):
        write_run(self.folder / "run1", 1, 10, 3)
        quietly(page.main, self.folder)
        text = (self.folder / "report.html").read_text()
        for words in ("3 to 3", "from run to run", "of all runs", "other runs", " 1 runs"):
            self.assertNotIn(words, text)
        _, said = quietly(table.main, self.folder, "--no-figures")
        self.assertIn("die, 3 of 20.", said)

    def test_none_and_all_of_the_runs_have_one_sided_intervals(self):
        for seed in (1, 2, 3):
            write_run(self.folder / f"run{seed}", seed, 10, 0)
        _, said = quietly(table.main, self.folder, "--no-figures")
        self.assertIn("| 1 | 0.0 % | below 63.2 % |", said)
        self.assertIn("die, 0 of 20 a run.", said)
        self.assertEqual([table.percent(share) for share in (1 - 1e-13, 0.99996, 0.9995, 1e-13, 0.00004)],
                         ["100.0", "99.996", "99.95", "0.0", "0.004"])

    def test_the_page_of_many_settings_names_them_and_defines_first_and_second(self):
        write_plan(self.folder, [(k, "river/s08", 1 + k % 2, json.dumps({"/crowd/groups/0/goal/x_m": 8 + (k - 1) // 2}))
                                 for k in range(1, 7)])
        for k in range(1, 7):
            write_run(self.folder / "runs" / f"{k:05d}", 1 + k % 2, 9 + k, 1)
        quietly(page.main, self.folder)
        text = (self.folder / "report.html").read_text()
        self.assertIn("Without an end yet at the end of the runs, by setting: 22.5 to 42.5 % walking. Longer runs decide", text)
        self.assertIn("against /crowd/groups/0/goal/x_m 8, of 100", text)
        self.assertIn("First: /crowd/groups/0/goal/x_m 8. Second: the setting of the row.", text)
        self.assertIn("<th class=l>/crowd/groups/0/goal/x_m</th>", text)
        self.assertNotIn("<h2>8</h2>", text)
        _, said = quietly(table.main, self.folder, "--no-figures")
        self.assertIn("First: /crowd/groups/0/goal/x_m 8. Second", said.replace("\n", " "))

    def test_what_was_assumed_covers_all_settings(self):
        write_plan(self.folder, [(k, "river/s08", 1, json.dumps({"/channel/velocity_m_s": k})) for k in (1, 2, 3)])
        for k in (1, 2, 3):
            folder = self.folder / "runs" / f"{k:05d}"
            write_run(folder, 1, 10, 1)
            manifest = json.loads((folder / "manifest.json").read_text())
            manifest["resolved_scene"]["channel"]["velocity_m_s"] = k
            (folder / "manifest.json").write_text(json.dumps(manifest))
        quietly(page.main, self.folder)
        text = (self.folder / "report.html").read_text()
        self.assertIn("1: 1 m deep, 1 m/s asked for<br>2: 1 m deep, 2 m/s asked for<br>3: 1 m deep, 3 m/s asked for", text)

    def test_an_outcome_that_is_not_in_the_list_is_refused(self):
        write_run(self.folder / "run1", 1, 10, 1)
        file = self.folder / "run1/agents.csv"
        file.write_text(file.read_text().replace(",dead,", ",vanished,"))
        with self.assertRaisesRegex(UsageError, 'agents.csv, row 11: outcome "vanished" is not allowed; allowed: active, arrived, dead'):
            read_ensemble(self.folder)

    def test_settings_make_cases_and_folders_without_a_plan_are_read(self):
        write_plan(self.folder / "a", [(1, "river/s08", 1, '{"/channel/depth_m": 1}'), (2, "river/s08", 1, '{"/channel/depth_m": 2}')])
        for k in (1, 2):
            write_run(self.folder / "a/runs" / f"{k:05d}", 1, 10, 1)
            write_run(self.folder / "b" / f"seed{k}", k, 10, 1)
        self.assertEqual([case.name for case in read_ensemble(self.folder / "a").cases],
                         ["river/s08, depth_m 1", "river/s08, depth_m 2"])
        self.assertEqual(read_ensemble(self.folder / "b").cases[0].seeds, [1, 2])
        with self.assertRaisesRegex(UsageError, "no complete run"):
            (self.folder / "empty").mkdir()
            read_ensemble(self.folder / "empty")

    def test_a_run_folder_that_is_a_link_is_found_once(self):
        write_run(self.folder / "elsewhere/seed1", 1, 10, 1)
        write_run(self.folder / "all/seed2", 2, 10, 1)
        (self.folder / "all/seed1").symlink_to(self.folder / "elsewhere/seed1")
        (self.folder / "all/round").symlink_to(self.folder / "all")
        self.assertEqual(read_ensemble(self.folder / "all").cases[0].seeds, [1, 2])

    def test_classes_tell_people_apart(self):
        ensemble_in(self.folder, range(1, 3))
        case = read_ensemble(self.folder).cases[0]
        self.assertEqual([(name, int(who.sum())) for name, who in classes(case, "age")], [("15 to 64", 20), ("65 and over", 20)])
        self.assertEqual([name for name, _ in classes(case, "start")][:2], ["x 0, z 0", "x 20, z 0"])

    def test_the_table_has_shares_intervals_and_reasons(self):
        ensemble_in(self.folder)
        code, said = quietly(table.main, self.folder, "--by", "age", "--no-figures")
        self.assertEqual(code, 0)
        rows = {(row["by"], row["class"], row["fate"]): row for row in read_csv(self.folder / "table.csv")}
        of_all = rows["all", "all", "drowned"]
        self.assertEqual((of_all["runs"], of_all["people"], of_all["number"]), ("24", "480", "60"))
        self.assertTrue(float(of_all["low"]) < 0.125 < float(of_all["high"]))
        none = rows["all", "all", "sheltered"]
        self.assertAlmostEqual(float(none["high"]), 1 - 0.05 ** (1 / 24), places=5)
        self.assertEqual((none["low"], none["why_no_interval"]), ("0", "one-sided: in none of 24 runs"))
        self.assertIn("below 11.7 %", said)
        self.assertNotIn(("all", "all", "holding"), rows, "a kind that does not occur is no column")
        self.assertEqual(rows["all", "all", "no end yet"]["number"], rows["all", "all", "walking"]["number"])
        self.assertEqual(rows["age", "65 and over", "arrived"]["people"], "240")
        self.assertIn("24 runs with 480 people in all: 12.5 %", said)
        curves = {(row["curve"], row["time_s"]): row for row in read_csv(self.folder / "curves.csv")}
        last = max((key for key in curves if key[0] == "died"), key=lambda key: float(key[1]))
        self.assertAlmostEqual(float(curves[last]["share"]), 0.125)
        self.assertTrue(float(curves[last]["low"]) < 0.125 < float(curves[last]["high"]))

    def test_pairs_of_two_folders(self):
        ensemble_in(self.folder / "a")
        ensemble_in(self.folder / "b", range(3, 25), lambda seed: seed % 4)
        quietly(table.main, self.folder / "a", "--against", self.folder / "b", "--out", self.folder, "--no-figures")
        rows = {row["fate"]: row for row in read_csv(self.folder / "compared.csv") if row["by"] == "all"}
        self.assertEqual(rows["lost"]["pairs"], "22")
        self.assertAlmostEqual(float(rows["lost"]["difference"]), -0.05)
        # Of 20 in a run some 6 still walk: they may all be lost in the first runs and none in the second, or the reverse.
        walking = float(rows["no end yet"]["share_first"]), float(rows["no end yet"]["share_second"])
        self.assertAlmostEqual(float(rows["lost, at least"]["difference"]), -0.05 - walking[0])
        self.assertAlmostEqual(float(rows["lost, at most"]["difference"]), -0.05 + walking[1])
        self.assertEqual({row["people_for_one_more"] for row in rows.values()}, {""})
        self.assertEqual(rows["lost"]["why_no_interval"], "people without an end yet decide")
        with self.assertRaisesRegex(UsageError, "no seed in common"):
            ensemble_in(self.folder / "c", range(90, 92))
            quietly(table.main, self.folder / "a", "--against", self.folder / "c", "--no-figures", "--out", self.folder)

    def test_where_all_have_an_end_so_many_people_are_needed_for_one_more(self):
        ensemble_in(self.folder / "a", drowned=lambda seed: 2 + seed % 4, all_end=True)
        ensemble_in(self.folder / "b", drowned=lambda seed: 2 + seed % 4 - seed // 4 % 2 * 2, all_end=True)
        quietly(table.main, self.folder / "a", "--against", self.folder / "b", "--out", self.folder, "--no-figures")
        rows = {row["fate"]: row for row in read_csv(self.folder / "compared.csv") if row["by"] == "all"}
        self.assertAlmostEqual(float(rows["lost"]["people_for_one_more"]), 20)
        self.assertEqual({fate for fate, row in rows.items() if row["people_for_one_more"]}, {"lost"})
        quietly(page.main, self.folder / "a", "--against", self.folder / "b")
        self.assertIn("One fewer is lost for 20 people", (self.folder / "a/report.html").read_text())

    def test_the_search_begins_where_they_drowned(self):
        ensemble_in(self.folder)
        code, said = quietly(victims.main, self.folder)
        self.assertEqual(code, 0)
        self.assertEqual(read_csv(self.folder / "victims.csv")[0]["x_m"], "30")
        self.assertIn("60 dead, 0 missing", said)
        self.assertTrue((self.folder / "victims.png").exists())
        _, said = quietly(victims.main, self.folder, "--drift-s", "15", "--out", self.folder / "d")
        self.assertEqual(read_csv(self.folder / "d/victims.csv")[0]["x_m"], "10", "15 s downstream at 1 m/s")


    def test_the_page_holds_its_pictures_and_says_what_is_beyond(self):
        ensemble_in(self.folder / "a")
        ensemble_in(self.folder / "b", drowned=lambda seed: seed % 4)
        quietly(page.main, self.folder / "a", "--against", self.folder / "b", "--title", "A <b> town")
        text = (self.folder / "a/report.html").read_text()
        self.assertIn("A &lt;b&gt; town", text)
        self.assertEqual(re.findall(r'(?:src|href)="(?!data:image/png;base64,)[^"]*"', text), [], "nothing from elsewhere")
        self.assertEqual(text.count("data:image/png"), 3)
        for words in ("<b>12.5 of 100</b>die", "10 % of the people (48 of 480)", "about 55 arrive in safety",
                      "depends on those without an end yet", "first 32.5 walking of 100; second 37.5 walking of 100"):
            self.assertIn(words, text)


    def test_people_in_flooded_houses_are_told_apart_and_no_longer_run_decides_for_them(self):
        flooded_in(self.folder, range(1, 12))
        _, said = quietly(table.main, self.folder, "--no-figures")
        rows = {row["fate"]: row for row in read_csv(self.folder / "table.csv") if row["by"] == "all"}
        self.assertEqual({fate: int(rows[fate]["number"]) for fate in ("no end yet", "indoors", "in flooded houses")},
                         {"no end yet": 220, "indoors": 165, "in flooded houses": 55})
        text = " ".join(said.split())
        self.assertIn("No longer run decides for those who are in flooded houses and indoors, as houses are not modelled.", text)
        self.assertIn("up to 2.4 m of water at their door", text)
        self.assertNotIn("Longer runs decide", text)

    def test_the_page_describes_the_people_as_they_ran(self):
        flooded_in(self.folder, (7,))
        quietly(page.main, self.folder)
        text = (self.folder / "report.html").read_text()
        for words in ("<td class=l>5 to 80 years, median 42</td>", "1.10 to 1.67 m, median 1.39", "normal (100.0 %)", "1 simulated run<",
                      "There is only 1 run.", "No person is lost in these runs."):
            self.assertIn(words, text)
        for words in ("0 obstacles", "of all floods like this"):
            self.assertNotIn(words, text)

    def test_losses_are_counted_by_place_and_by_minute(self):
        ensemble_in(self.folder)
        _, said = quietly(table.main, self.folder)
        self.assertEqual(read_csv(self.folder / "losses.csv"), [{
            "case": "river/s08", "x_m": "20", "z_m": "20", "lost_a_run": "2.5", "share": "1", "runs_with_any": "24"}])
        self.assertIn("| 20 to 40 | 20 to 40 | 2.5 | 100.0 % | 24 |", said)
        self.assertIn("| 1 to 2 | 2.5 | 100.0 % | 100.0 % |", said)
        self.assertTrue((self.folder / "losses.png").exists())

    def test_a_varied_value_is_one_table_and_one_figure(self):
        lines = [(k + 1, "river/s08", 1 + k % 12, json.dumps({"/crowd/tau": k // 12 / 4})) for k in range(36)]
        write_plan(self.folder, lines)
        for k, _, seed, _ in lines:
            write_run(self.folder / "runs" / f"{k:05d}", seed, 8, (k - 1) // 12 * (1 + seed % 3))
        _, said = quietly(table.main, self.folder)
        self.assertLess(len(said.splitlines()), 40)
        self.assertEqual(re.findall(r"^\| (0\.?\d*) \| 12 \|", said, re.MULTILINE), ["0.0", "0.25", "0.5"])
        self.assertTrue((self.folder / "values.png").exists())
        quietly(page.main, self.folder)
        text = (self.folder / "report.html").read_text()
        self.assertEqual(text.count("What was assumed"), 1)


class Sensitivity(unittest.TestCase):
    def test_inputs_of_the_list_are_those_that_the_scene_has(self):
        scene = {**SCENE, "site": {"sources": [{"discharge_m3_s": 2.0}, {"discharge_m3_s": 10.0}, {"hydrograph_csv": "a"}]}}
        inputs = {one.name: one for one in sensitivity.read_inputs(sensitivity.DEFAULT_INPUTS, scene)}
        self.assertEqual(inputs["discharge of the sources"].settings(1),
                         {"/site/sources/0/discharge_m3_s": 2.5, "/site/sources/1/discharge_m3_s": 12.5})
        self.assertNotIn("friction of a site for water", inputs)
        self.assertNotIn("speed of the water", inputs, "that of a channel")
        river = {one.name: one for one in sensitivity.read_inputs(sensitivity.DEFAULT_INPUTS, SCENE)}
        self.assertEqual(river["speed of the water"].settings(0), {"/channel/velocity_m_s": 0.75})
        self.assertNotIn("when people leave their houses", river)
        self.assertEqual(sorted(inputs["mass of a person"].settings(0.5)), ["/crowd/groups/0/mass_kg"])
        for entry in json.loads(sensitivity.DEFAULT_INPUTS.read_text()):
            self.assertTrue(entry["source"], entry["name"])

    def test_runs_that_are_there_are_told_and_missing_ones_are_counted(self):
        with tempfile.TemporaryDirectory(prefix="wade-test-") as name:
            folder = Path(name)
            ways = trajectories(2, 6, 1)
            points = ways.reshape(-1, 2)
            write_plan(folder, [(k + 1, "river/s08", 1, "{}") for k in range(len(points))])
            inputs = [{"name": name, "set": ["/x"], "min": 0, "max": 1, "range": "0 to 1", "source": "here"} for name in "ab"]
            (folder / "design.json").write_text(json.dumps({"kind": "morris", "count": 6, "scene": "river/s08", "seeds": [1],
                                                            "repeated": False, "inputs": inputs, "left_out": {},
                                                            "points": points.tolist()}))
            for k, point in enumerate(points[:-1]):
                write_run(folder / "runs" / f"{k + 1:05d}", 1, 10, round(9 * point[0]))
            self.assertEqual(quietly(sensitivity.main, folder)[0], 1)
            write_run(folder / "runs" / f"{len(points):05d}", 1, 10, round(9 * points[-1][0]))
            self.assertEqual(quietly(sensitivity.main, folder)[0], 0)
            rows = {row["input"]: float(row["mu_star"]) for row in read_csv(folder / "sensitivity.csv")}
            np.testing.assert_allclose((rows["a"], rows["b"]), (9 / 20, 0), atol=1e-9)


if __name__ == "__main__":
    unittest.main()
