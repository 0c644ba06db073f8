"""Many crowds in the water of one server: crowd_client --crowds."""

import csv
import json
import os
import re
import resource
import signal
import subprocess
import unittest

from harness import CLIENT, ENDLESS, PROGRAMS, ROOT, SMALL, Run, SystemTest

# What each crowd sets, and the same as options of a single run. Only crowds that leave the seed alone meet the water of
# a single run in kinematic scenes; the solver of this scene uses no seed.
CROWDS = {
    "base": {},
    "sum": {"/coupling/contact_rule": "sum", "/crowd/tau": 0.7},
    "seed-9": {"/seed": 9, "/crowd/tau": {"min": 0.1, "max": 0.9}, "/crowd/groups/0/start/jitter_m": 0.5},
    "fast_steps": {"/crowd/step_rate_hz": 75, "/coupling/rule": "continuous"},
    "event": {"/events/0": {"frame": 60, "tau": 1}},
}


class Crowds(SystemTest):
    def list_of(self, crowds):
        file = self.folder / "crowds.json"
        file.write_text(json.dumps([{"name": name, "set": values} for name, values in crowds.items()]))
        return file

    def crowds_csv(self, folder):
        with open(folder / "crowds.csv", newline="", encoding="utf-8") as file:
            return {row["name"]: row for row in csv.DictReader(file)}

    def test_each_crowd_leaves_what_a_run_of_its_own_leaves(self):
        server = self.server()
        many = "--crowds", self.list_of(CROWDS), "--reproducible", "--threads", "2"
        client = self.client(*many, out=self.folder / "many")
        self.assert_ended_well(server, client)
        rows = self.crowds_csv(self.folder / "many")
        self.assertEqual(list(rows), list(CROWDS))
        for name, values in CROWDS.items():
            with self.subTest(crowd=name):
                changes = [f"{pointer}={json.dumps(value)}" for pointer, value in values.items()]
                alone = self.pair(*(word for change in changes for word in ("--set", change)), "--reproducible")
                run = Run(self.folder / "many" / name)
                self.assertEqual(run.outcome(), alone.outcome())
                self.assertEqual(run.bytes_of("agents.csv"), alone.bytes_of("agents.csv"))
                self.assertEqual(run.bytes_of("water.bin"), alone.bytes_of("water.bin"))
                self.assertEqual(run.rows(), alone.rows())
                self.assertEqual({f.name for f in run.folder.iterdir()}, {f.name for f in alone.folder.iterdir()})
                manifests = [json.loads(r.bytes_of("manifest.json")) for r in (run, alone)]
                for key in ("scene_hash", "seed", "resolved_scene"):
                    self.assertEqual(manifests[0][key], manifests[1][key])
                self.assertEqual(rows[name]["arrived"], str(alone.outcome()["arrived"]))

    def test_bodies_that_long_steps_carry_far_meet_the_same_water_as_alone(self):
        slow = {"/crowd/step_rate_hz": 0.25, "/crowd/bodies": "fast", "/crowd/markers": "redrawn"}
        crowds = {name: {**slow, "/crowd/tau": tau} for name, tau in (("carried", 1), ("pushed", 0.5))}
        server = self.server()
        client = self.client("--crowds", self.list_of(crowds), "--reproducible", out=self.folder / "many")
        self.assert_ended_well(server, client)
        for name, values in crowds.items():
            changes = [f"{pointer}={json.dumps(value)}" for pointer, value in values.items()]
            alone = self.pair(*(word for change in changes for word in ("--set", change)), "--reproducible")
            self.assertEqual(Run(self.folder / "many" / name).bytes_of("agents.csv"), alone.bytes_of("agents.csv"))

    def test_drawn_values_stand_in_agents_csv(self):
        run = self.pair("--set", '/crowd/tau={"min":0.4,"max":0.8}', "--set", '/crowd/mass_kg={"min":40,"max":100}')
        for key, low, high in (("tau", 0.4, 0.8), ("mass_kg", 40, 100)):
            values = [float(agent[key]) for agent in run.agents()]
            self.assertEqual(len(set(values)), 6)
            self.assertTrue(all(low <= value < high for value in values), values)

    def test_without_trajectories_only_that_file_is_missing(self):
        server = self.server()
        client = self.client("--crowds", self.list_of({"a": {}}), "--no-trajectories", out=self.folder / "many")
        self.assert_ended_well(server, client)
        names = {file.name for file in (self.folder / "many" / "a").iterdir()}
        self.assertEqual(names, {"agents.csv", "manifest.json", "outcome.json", "water.bin"})

    def test_a_crowd_may_do_without_pictures_and_ends_the_same(self):
        entries = [{"name": "plain", "pictures": False}, {"name": "drawn"}]
        (self.folder / "crowds.json").write_text(json.dumps(entries))
        server = self.server()
        client = self.client("--crowds", self.folder / "crowds.json", "--reproducible", out=self.folder / "many")
        self.assert_ended_well(server, client)
        plain, drawn = (Run(self.folder / "many" / entry["name"]) for entry in entries)
        self.assertEqual({file.name for file in plain.folder.iterdir()}, {"agents.csv", "manifest.json", "outcome.json"})
        self.assertTrue((drawn.folder / "trajectories.sqlite").exists() and (drawn.folder / "water.bin").exists())
        self.assertEqual(plain.bytes_of("agents.csv"), drawn.bytes_of("agents.csv"))

    def test_crowd_whose_files_cannot_be_written_fails_alone(self):
        # "blocked" and "same" are over in one frame, "later" walks on.
        blocked = self.folder / "many" / "blocked" / "agents.csv" / "not_empty"
        blocked.mkdir(parents=True)
        fast = {"/crowd/desired_speed_m_s": 3}
        crowds = {"blocked": fast, "later": {}, "same": fast}
        server = self.server()
        client = self.client("--crowds", self.list_of(crowds), "--reproducible", out=self.folder / "many")
        self.assert_ends(client, 1, 'crowd "blocked": cannot write', "agents.csv", "2 of 3 crowds are over without error")
        self.assertEqual(server.wait(), 0, server.messages())
        rows = self.crowds_csv(self.folder / "many")
        self.assertEqual([row["status"] for row in rows.values()], ["failed", "completed", "completed"])
        self.assertIn("agents.csv", rows["blocked"]["message"])
        self.assertEqual([row["arrived"] for row in rows.values()], ["6", "3", "6"])
        outcomes = {name: Run(self.folder / "many" / name).outcome() for name in crowds}
        self.assertEqual(outcomes["blocked"]["status"], "failed")
        self.assertIn("agents.csv", outcomes["blocked"]["message"])
        alone = self.pair("--reproducible", "--set", "/crowd/desired_speed_m_s=3")
        self.assertEqual(outcomes["same"], alone.outcome())
        self.assertGreater(outcomes["later"]["frames"], outcomes["same"]["frames"])

    def test_more_crowds_than_files_may_be_open_are_refused_before_anything_starts(self):
        few = {"preexec_fn": lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (64, 64))}
        crowds = self.list_of({f"c{k}": {} for k in range(9)})
        client = self.client("--crowds", crowds, out=self.folder / "many", **few)
        self.assert_ends(client, 2, "--crowds: 9 crowds", "64 (ulimit -Hn)")
        said = re.search(r"up to (\d+) files open.*the first (\d+) crowds", client.messages())
        of_program = 48
        of_crowd, rest = divmod(int(said[1]) - of_program, 9)
        self.assertGreaterEqual(of_crowd, 4)  # each output that grows keeps one open
        self.assertEqual((rest, int(said[2])), (0, (64 - of_program) // of_crowd))
        self.assertFalse((self.folder / "many").exists())
        server = self.server()
        spare = "--no-trajectories", "--water-every-s", "0"
        self.assert_ended_well(server, self.client("--crowds", crowds, *spare, out=self.folder / "many", **few))
        server = self.server()
        allowed = self.list_of({f"c{k}": {} for k in range(int(said[2]))})
        self.assert_ended_well(server, self.client("--crowds", allowed, out=self.folder / "allowed", **few))

    def test_death_of_the_server_leaves_complete_records_of_all_crowds(self):
        server = self.server(*ENDLESS)
        client = self.client(*ENDLESS, "--crowds", self.list_of(CROWDS), out=self.folder / "many")
        self.wait_for_frame(20, server, client)
        self.kill_server(server)
        self.assert_ends(client, 4)
        for name in CROWDS:
            self.assert_complete_records(Run(self.folder / "many" / name), "peer_dead")
        self.assertEqual({row["status"] for row in self.crowds_csv(self.folder / "many").values()}, {"peer_dead"})
        self.remove_segment_of_killed_server()

    def test_signal_ends_all_crowds_and_the_server(self):
        server = self.server(*ENDLESS)
        client = self.client(*ENDLESS, "--crowds", self.list_of(CROWDS), out=self.folder / "many")
        self.wait_for_frame(20, server, client)
        client.send(signal.SIGTERM)
        self.assert_ends(client, 143)
        self.assertNotEqual(server.wait(), 0)
        for name in CROWDS:
            self.assert_complete_records(Run(self.folder / "many" / name), "interrupted")

    def test_bad_lists_are_refused_before_anything_starts(self):
        water = self.list_of({"a": {"/channel/velocity_m_s": 2}})
        client = self.client("--crowds", water, out=self.folder / "many")
        self.assert_ends(client, 2, "crowds.json: crowd \"a\": /channel/velocity_m_s: 2.0 is not the scene's 0.5")
        self.assert_ends(self.client("--crowds", self.folder / "none.json"), 2, "none.json cannot be read")
        check = self.client("--crowds", water, "--check")
        self.assert_ends(check, 2, "/channel/velocity_m_s")
        two_way = self.client("--crowds", self.list_of({"a": {}}), "--set", "/coupling/agents_stream=serial")
        self.assert_ends(two_way, 2, "/coupling/agents_stream")
        self.assertFalse((self.folder / "many").exists())

    def test_check_counts_the_crowds(self):
        command = [CLIENT, SMALL, "--crowds", self.list_of(CROWDS), "--check"]
        answer = subprocess.run(command, capture_output=True, text=True)
        self.assertEqual(answer.returncode, 0, answer.stderr)
        self.assertIn("crowds.json: valid; 5 crowds", answer.stdout)

    def test_run_sh_takes_a_list(self):
        run_sh = self.start(
            ROOT / "tools" / "run.sh", SMALL, "--session", self.session, "--out", self.folder / "run",
            "--crowds", self.list_of(CROWDS), "--threads", "1", cwd=self.folder,
            env={**os.environ, "WADE_BUILD": str(PROGRAMS)},
        )  # fmt: skip
        self.assert_ended_well(run_sh)
        run_sh.output.seek(0)
        said = run_sh.output.read()
        for name in CROWDS:
            self.assertIn(f"{name}: completed; ", said)
        self.assertTrue((self.folder / "run" / "fluid_server.log").exists())


if __name__ == "__main__":
    unittest.main()
