"""tools/wade many on this machine: plans, shared waters, failures, kills, a full disk, and that it goes on."""

import contextlib
import io
import json
import os
import shutil
import signal
import subprocess
import sys
import unittest
from unittest import mock

from ensemble_test import EnsembleTest
from harness import PROGRAMS, ROOT, SMALL, wait_until

from wade.ensembles import waters
from wade.ensembles.folder import fingerprint, is_complete, publish, status_of
from wade.ensembles.plan import split_values, varied
from wade.ensembles.waters import water_of
from wade.many import say_all
from wade.paths import CONFIGS
from wade.suites.converge import settings_of
from wade.suites.converge.cases import CASES

SHORT = ["--until-s", "1"]
OF_A_RUN = {"outcome.json", "agents.csv", "manifest.json"}


def resolved(*changes, scene=SMALL):
    words = [word for change in changes for word in ("--set", change)]
    return json.loads(subprocess.check_output([PROGRAMS / "crowd_client", scene, *words, "--print-config"]))


class Many(EnsembleTest):
    def test_runs_that_share_a_water_equal_single_runs(self):
        plan = ["--seeds", "5-6", "--vary", "/crowd/tau=0.2,0.7", SMALL]
        self.assert_ended_well(self.many(*plan, "--pictures", "--reproducible"))
        self.assert_ended_well(self.many(*plan, "--own-water", "--pictures", "--reproducible", out="own"))
        self.assertEqual(self.table(), self.table("own"))
        self.assertEqual([f.name for f in (self.folder / "many" / "waters").iterdir()], ["00001"], "one water for all")
        self.assertFalse((self.folder / "own" / "waters").exists())
        rows = self.rows()
        self.assertEqual([(row["seed"], row["/crowd/tau"], row["status"]) for row in rows],
                         [(seed, tau, "completed") for seed in "56" for tau in ("0.2", "0.7")])
        for row in (rows[0], rows[3]):
            alone = self.pair("--reproducible", "--seed", row["seed"], "--set", f"/crowd/tau={row['/crowd/tau']}")
            for out in ("many", "own"):
                run = self.run_of(int(row["index"]), out)
                for name in ("outcome.json", "agents.csv", "trajectories.sqlite", "water.bin"):
                    self.assertEqual(run.bytes_of(name), alone.bytes_of(name), name)

    def test_what_shares_a_water_is_decided_from_the_scenes(self):
        base = water_of(resolved(), 1)
        for same in ("/crowd/tau=0.5", "/coupling/contact_rule=sum", "/name=other", '/events/0={"frame": 60, "tau": 1}'):
            self.assertEqual(water_of(resolved(same), 2), base, same)
        for other in ("/channel/velocity_m_s=0.6", "/duration_s=7", "/fluid/cfl=0.3", "/frame_rate_hz=20"):
            self.assertNotEqual(water_of(resolved(other), 1), base, other)
        kinematic = resolved("/fluid/model=kinematic")
        self.assertEqual(water_of(kinematic, 1), water_of(kinematic, 1))
        self.assertNotEqual(water_of(kinematic, 1), water_of(kinematic, 2), "its seed draws where particles lie")
        cells = resolved("/fluid/model=shallow_water")
        measured = resolved("/fluid/model=shallow_water", "/crowd/response=measured")
        self.assertNotEqual(water_of(cells, 1), water_of(cells, 2), "its seed draws where particles drift")
        self.assertNotEqual(water_of(cells, 1), water_of(measured, 1), "columns are published in place of particles")
        self.assertEqual(water_of(measured, 1), water_of(measured, 2), "columns have fixed positions")
        for own in ("/coupling/two_way=true", "/coupling/agents_stream=serial", "/fluid/model=auto"):
            self.assertIsNone(water_of(resolved(own), 1), own)
        folder = CONFIGS / "paper"
        self.assertEqual(len({water_of(resolved(scene=folder / f"s{k:02}.json"), 1) for k in (1, 5, 6)}), 3)

    def test_all_settings_of_wade_converge_are_allowed(self):
        settings = [(CONFIGS / f"{case.scene}.json", values) for case in CASES for values in settings_of(case).values()]
        for scene, values in settings:
            words = [word for pointer, value in values.items() for word in ("--set", f"{pointer}={json.dumps(value)}")]
            answer = subprocess.run([PROGRAMS / "crowd_client", scene, *words, "--check"], capture_output=True, text=True)
            self.assertEqual(answer.returncode, 0, answer.stderr)

    def test_water_that_a_seed_changes_is_not_shared(self):
        self.assert_ended_well(self.many(SMALL, "--seeds", "1-2", "--", *SHORT, "--set", "/fluid/model=kinematic"))
        self.assertEqual(len({row["frame_hash"] for row in self.rows()}), 2)
        self.assertFalse((self.folder / "many" / "waters").exists())

    def test_plan_file_says_scene_seed_and_settings(self):
        shutil.copy(SMALL, self.folder / "mine.json")
        plan = self.folder / "plan.csv"
        plan.write_text('# two runs\nindex,scene,seed,settings\n7,mine.json,3,"{""/crowd/tau"": 0.5}"\n9,mine.json,,\n')
        many = self.many(plan, "--", *SHORT, "--threads=1", "--attach-timeout-s", "60")
        self.assert_ended_well(many)
        self.assertEqual([(row["index"], row["seed"], row["/crowd/tau"]) for row in self.rows()],
                         [("7", "3", "0.5"), ("9", "5", "")])
        self.assertEqual({f.name for f in self.run_of(7).folder.iterdir()}, OF_A_RUN)
        manifests = [json.loads(self.run_of(index).bytes_of("manifest.json")) for index in (7, 9)]
        self.assertEqual([m["resolved_scene"]["crowd"]["groups"][0]["tau"] for m in manifests], [0.5, 0.2])

    def test_what_is_complete_stays_and_a_plan_may_grow(self):
        seeds = lambda text: (SMALL, "--seeds", text, "--reproducible", "--resume", "--", *SHORT)  # noqa: E731
        self.assert_ended_well(self.many(*seeds("1-2")))
        first = self.run_of(1).folder / "outcome.json"
        made = first.stat().st_mtime_ns
        (self.run_of(2).folder / "agents.csv").write_text("id\n")  # cut off
        self.assert_ended_well(self.many(*seeds("1-4")))
        self.assertEqual(first.stat().st_mtime_ns, made)
        self.assertEqual([row["status"] for row in self.rows()], 4 * ["completed"])
        self.assertEqual(self.table(), self.undisturbed(*seeds("1-4")))
        self.assert_ends(self.many(*seeds("2-5")), 2, "--resume: run 1", "begins as")
        self.assert_ends(self.many(SMALL, "--seeds", "1-4"), 2, "holds an ensemble", "--resume")
        self.assert_ends(self.many(*seeds("1-4"), "--set", "/crowd/tau=0.9"), 2, "options of every run")

    def test_runs_of_a_scene_that_has_changed_are_stale_and_made_anew(self):
        scene = self.folder / "scene.json"
        scene.write_text(SMALL.read_text().replace('"../../../', '"/'))
        self.assert_ended_well(self.many(scene, "--seeds", "1-2", "--", *SHORT))
        scene.write_text(scene.read_text().replace('"tau": 0.2', '"tau": 0.9'))
        self.assert_ends(self.many("--gather"), 1, "stale")
        self.assert_ended_well(self.many("--resume"))
        self.assertEqual([agent["tau"] for agent in self.run_of(2).agents()], 6 * ["0.9"])

    def test_failing_runs_are_listed_with_their_reason_and_stop_nobody(self):
        broken = self.folder / "broken.json"
        broken.write_text("{")
        collapse = SMALL.parent / "collapse.json"
        many = self.many(SMALL, broken, collapse, SMALL, "--vary", "/crowd/groups/0/columns=1,40", "--", *SHORT)
        self.assert_ends(many, 1, "broken.json", "the water failed", "outside the world")
        found = {(row["scene"].rsplit("/")[-1], row["/crowd/groups/0/columns"]): row for row in self.rows()}
        self.assertEqual(found["small.json", "1"]["status"], "completed")
        self.assertEqual(found["broken.json", "1"]["status"], "refused")
        self.assertEqual(found["collapse.json", "1"]["status"], "peer_aborted")
        self.assertIn("the water failed", found["collapse.json", "1"]["reason"])
        failure = json.loads((self.run_of(5).folder / "failure.json").read_text())
        self.assertEqual((failure["exit_code"], failure["accident"]), (9, False))
        self.assertTrue(all(row["reason"] for row in self.rows() if row["status"] != "completed"))
        self.assert_ends(self.many(broken, out="other"), 2, "no run of the plan can be done", "broken.json")
        self.assertFalse((self.folder / "other" / "plan.csv").exists())

    def test_run_one_does_what_an_index_names_and_skips_what_is_complete(self):
        prepared = self.many(SMALL, "--seeds", "1-3", "--share", "2", "--prepare", "--", *SHORT)
        self.assert_ended_well(prepared)
        self.assertEqual(self.output_of(prepared).split(), ["1", "3"])
        one = lambda *words: self.script(ROOT / "tools" / "wade", "run-one", self.folder / "many" / "plan.csv", *words)  # noqa: E731
        self.assert_ended_well(one("1"))
        self.assertEqual(sorted(f.name for f in (self.folder / "many" / "runs").iterdir()), ["00001", "00002"])
        made = (self.run_of(1).folder / "outcome.json").stat().st_mtime_ns
        (self.folder / "list").write_text("1\n3\n")
        self.assert_ended_well(one("--of", self.folder / "list", "--share", "0/1"))
        self.assertEqual((self.run_of(1).folder / "outcome.json").stat().st_mtime_ns, made)
        self.assert_ended_well(self.many("--gather"))
        self.assertEqual([row["status"] for row in self.rows()], 3 * ["completed"])
        self.assert_ends(one("2"), 2, "nothing is prepared under index 2")
        self.assert_ends(one("x"), 2, "a whole number")
        self.assert_ends(one("--of", self.folder / "list", "--share", "1/1"), 2, "K < N")
        self.assert_nothing_left()

    def test_interrupt_ends_all_and_the_ensemble_goes_on(self):
        plan = (SMALL, "--seeds", "1-3", "--own-water")
        long = ("--", "--until-s", "20", "--set", "/stop_when_no_agent_is_active=false")
        many = self.many(*plan, *long)
        logs = self.folder / "many" / "work"
        wait_until(lambda: sum("t 0.0/" in log.read_text() for log in logs.glob("*/*/fluid_server.log")) == 2
                   or not many.running(), "two runs to walk")
        self.assertEqual(len({name.parent.name for name in (self.folder / "many" / "work").glob("*/*")}), 2)
        self.assert_ends_with_children(many, signal.SIGINT, 130)
        self.assertEqual([row["status"] for row in self.rows()], 3 * ["not_run"])
        self.assert_nothing_left()
        self.assert_ended_well(self.many(*plan, "--resume", *long))

    def test_ten_kills_change_nothing(self):
        self.assert_kills_change_nothing(10, SMALL, "--seeds", "1-6", "--share", "2", "--", "--until-s", "3")

    def test_full_disk_loses_nothing(self):
        disk = self.folder / "disk"
        disk.mkdir()
        mount = ["mount", "-t", "tmpfs", "-o", "size=220k", "none", disk]
        if subprocess.run(mount, capture_output=True).returncode != 0:
            self.skipTest("no right to mount a small disk")
        self.mounts.append(disk)
        plan = (SMALL, "--seeds", "1-6", "--reproducible")
        many = self.many(*plan, "--own-water", "--", *SHORT, out="disk/many")
        self.assertEqual(many.wait(), 1, many.messages())
        self.assertIn("space", many.messages())
        subprocess.run(["mount", "-o", "remount,size=4m", disk], check=True)
        self.assert_ended_well(self.many(*plan, "--resume", "--", *SHORT, out="disk/many"))
        self.assertEqual(self.table("disk/many"), self.undisturbed(*plan, "--", *SHORT))

    def test_of_two_workers_that_do_one_run_the_first_counts(self):
        def made(name, status="completed", agents=2):
            folder = self.folder / name
            folder.mkdir()
            (folder / "outcome.json").write_text(json.dumps({"status": status, "agents": 2}))
            (folder / "manifest.json").write_text(json.dumps({"seed": 3, "resolved_scene": {"seed": 3, "a": 1}}))
            (folder / "agents.csv").write_text("id\n" + "0\n" * agents)
            return folder

        expected, place, numbers = fingerprint({"a": 1}), self.folder / "00001", {}
        for name, arguments, stays in (("failed", ("peer_dead",), "failed"), ("cut_off", ("completed", 1), "cut_off"),
                                       ("first", (), "first"), ("second", (), "first"), ("late", ("failed",), "first")):
            folder = made(name, *arguments)
            numbers[name] = folder.stat().st_ino
            publish(folder, place, expected, 3)
            self.assertEqual(place.stat().st_ino, numbers[stays], name)
            self.assertFalse(folder.exists())
        self.assertTrue(is_complete(place, expected, 3))
        self.assertEqual(status_of(place, expected, 4), "stale")
        self.assertEqual([folder.name for folder in self.folder.iterdir() if folder.is_dir()], ["00001"])

    def test_a_program_that_is_killed_as_it_reads_a_scene_is_asked_again(self):
        program = self.folder / "crowd_client"
        for kills, answer in ((2, ({"seed": 1}, None)), (10**6, (None, "exit code -9"))):
            (self.folder / "kills").write_text("")
            program.write_text(f"""#!/bin/bash
cd {self.folder}; echo >> kills
[ $(wc -l < kills) -gt {kills} ] || kill -KILL $$
echo '{{"seed": 1}}'
""")
            program.chmod(0o755)
            with mock.patch.object(waters, "BUILD", self.folder):
                self.assertEqual(waters.resolve("scene.json", []), answer)
        self.assertEqual(len((self.folder / "kills").read_text()), waters.MOST_KILLS)

    def test_values_that_vary(self):
        self.assertEqual(split_values('1,[2,3],{"a":[4,5]},"x,y",z'), ["1", "[2,3]", '{"a":[4,5]}', '"x,y"', "z"])
        self.assertEqual(varied("/crowd/tau=0.2,paper"), ("/crowd/tau", [0.2, "paper"]))

    def test_the_table_of_sites_says_who_is_sheltered_or_indoors(self):
        row = {"scene": "site/village.json", "status": "completed", "agents": 9, "arrived": 4, "dead": 1, "active": 0}
        site = {"sheltered": 2, "indoors": 1, "upper_floor": 1}

        def printed(rows):
            with contextlib.redirect_stdout(io.StringIO()) as told:
                say_all([{**one, "seed": k} for k, one in enumerate(rows)], [])
            return told.getvalue().splitlines()

        self.assertNotIn("sheltered", printed([row])[0])
        for count in (2, 50):  # a line a run, and the means of a scene
            head, *_, last = printed([row, *[{**row, **site}] * count])
            words = dict(zip(head.split(), last.split()))
            self.assertEqual([float(words[key]) for key in ("arrived", "sheltered", "indoors", "upper_floor", "dead")],
                             [4, 2, 1, 1, 1])

    def test_of_two_that_begin_an_ensemble_at_once_one_is_refused(self):
        first, second = (self.many("--seeds", seeds, SMALL, "--", *SHORT) for seeds in ("1-2", "3-4"))
        codes = {process.wait(): process for process in (first, second)}
        self.assertEqual(set(codes), {0, 2}, first.messages() + second.messages())
        self.assertIn("--resume goes on with it", codes[2].messages())
        self.assertEqual(len(self.rows()), 2)
        self.assertEqual({row["status"] for row in self.rows()}, {"completed"})

    def test_a_scene_that_is_not_there_stops_all_before_they_start(self):
        self.assert_ends(self.many(SMALL, "s055"), 2, 'no scene "s055"', "s05")
        self.assertFalse((self.folder / "many").exists())

    def test_wrong_usage_is_refused(self):
        plan = self.folder / "plan.csv"
        plan.write_text('index,scene,seed,settings\n1,s05,2,"{""/seed"": 1}"\n')
        for arguments, *texts in (
            (["--seeds", "3-1", SMALL], "--seeds", "3-1"),
            (["--vary", "crowd.tau=1", SMALL], "--vary", "JSON pointer"),
            (["--vary", "/seed=1,2", SMALL], "--vary", "--seeds"),
            (["--vary", "/crowd/tau=1", "--vary", "/crowd/tau=2", SMALL], "given twice"),
            (["--jobs", "0", SMALL], "--jobs", "whole numbers from 1"),
            (["--engine", "ray", SMALL], "--engine", "slurm"),
            ([], "SCENE"),
            ([plan], "run 1: settings", "pointers but /seed"),
            ([plan, "--seeds", "1-2"], "is a plan"),
            ([self.folder / "absent.csv"], "absent.csv cannot be read"),
            (["--resume"], "holds no ensemble"),
            (["--seeds", "1-2", SMALL, "--until-s", "60"], "--until-s", "behind --", "-- --until-s"),
            (["--seeds", "1-2", "--until-s=60", SMALL], "behind --", "-- --until-s=60"),
            ([SMALL, "--treads", "2"], "--treads", "behind --"),
            ([SMALL, "--", "--seed", "3"], "--seed", "--seeds"),
            ([SMALL, "--", "--set=/seed=3"], "--set /seed", "--seeds"),
            ([SMALL, "--", "--out", "x"], "--out"),
            ([SMALL, "--", "--crowds=list.json"], "--crowds is not allowed"),
        ):
            with self.subTest(arguments):
                self.assert_refused_here("--module", "wade.many", "--out", self.folder / "many", *arguments, texts=texts)


@unittest.skipUnless(os.environ.get("WADE_LONG"), "takes minutes")
class ManyKills(EnsembleTest):
    def test_a_hundred_kills_change_nothing_in_fifty_runs(self):
        for water in ("--own-water", "--share=5"):
            with self.subTest(water):
                shutil.rmtree(self.folder / "many", ignore_errors=True)
                shutil.rmtree(self.folder / "undisturbed", ignore_errors=True)
                self.assert_kills_change_nothing(100, SMALL, "--seeds", "1-50", water, "--jobs", "3")


if __name__ == "__main__":
    sys.exit(unittest.main())
