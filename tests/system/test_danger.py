"""ragdoll.csv, poses.csv, danger.csv and the columns of danger in agents.csv, from runs of both programs."""

import csv
import json
import math
import signal
import subprocess
import unittest

from harness import ENDLESS, ROOT, SystemTest

# Six agents in a prescribed uniform stream of 2.5 m/s.
FAST = ["--set", "/fluid/model=kinematic", "--set", "/channel/velocity_m_s=2.5"]
WEAK = ["--set", "/crowd/tau=0.9"]
RAGDOLL = ["--set", "/crowd/ragdoll/condition=paper"]
DANGER = ["--danger-every-s", "1"]
RAGDOLL_HEADER = "frame,id,hip_height_m,rate_x_rad_s,rate_y_rad_s,rate_z_rad_s"
LEVELS = ["none", "low", "moderate", "high", "very_high"]
TIMES = [f"{level}_s" for level in LEVELS]


# The same six agents with the measured response, in solved water with particles of 0.25 m.
BODIES = ["--set", "/crowd/response=measured", "--set", "/channel/velocity_m_s=2", "--set", "/crowd/poses/rate_hz=30"]
SHALLOW = ["--set", "/fluid/model=shallow_water", "--set", "/fluid/particle_spacing_m=0.25"]
SHALLOW += ["--set", "/fluid/max_particles=8000", "--until-s", "6"]
FROM_STATE = {"toppled": {"falling"}, "carried": {"lying"}, "holding": {"lying"}, "pinned": {"lying"}, "drowned": {"lying"}}
FROM_STATE["recovering"] = {"sitting", "kneeling", "squatting", "rising"}


def table(run, name):
    with open(run.folder / name, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


class Ragdoll(SystemTest):
    def test_rows_belong_to_paths_and_follow_the_water(self):
        run = self.pair(*FAST, *WEAK, *RAGDOLL)
        self.assertEqual(run.bytes_of("ragdoll.csv").decode().splitlines()[0], RAGDOLL_HEADER)
        rows = table(run, "ragdoll.csv")
        keys = [(int(row["frame"]), int(row["id"])) for row in rows]
        self.assertGreater(len(keys), 0)
        self.assertEqual(keys, sorted(set(keys)), "a row for each frame and agent, in this order")
        self.assertLessEqual(set(keys), set(run.query("SELECT frame, id FROM trajectory_data")))
        for row in rows:
            self.assertTrue(0 < float(row["hip_height_m"]) < 1, row)  # the water is 1 m deep
            # The mean velocity is (-2.5, 0, 0) m/s up to its storage as a 32-bit number.
            for axis, velocity in (("x", -2.5), ("y", 0), ("z", 0)):
                increase = float(row[f"rate_{axis}_rad_s"]) - velocity
                self.assertTrue(0.1 - 1e-6 <= increase < 0.5 + 1e-6, row)

    def test_it_changes_no_path_and_is_the_same_again(self):
        plain, first, second = (self.pair(*FAST, *WEAK, *more) for more in ((), RAGDOLL, RAGDOLL))
        self.assertFalse((plain.folder / "ragdoll.csv").exists())
        self.assertEqual(plain.bytes_of("agents.csv"), first.bytes_of("agents.csv"))
        self.assertEqual(plain.rows(), first.rows())
        self.assertEqual(first.bytes_of("ragdoll.csv"), second.bytes_of("ragdoll.csv"))

    def test_condition_that_never_holds_leaves_the_header(self):
        run = self.pair(*FAST, *RAGDOLL)
        self.assertEqual(run.bytes_of("ragdoll.csv").decode(), RAGDOLL_HEADER + "\n")

    def test_tau_that_changes_ends_the_ragdoll(self):
        event = ["--set", '/events=[{"frame": 31, "tau": 0.1}]']
        run = self.pair(*FAST, *WEAK, *RAGDOLL, *event)
        frames = {int(row["frame"]) for row in table(run, "ragdoll.csv")}
        self.assertGreater(len(frames), 0)
        self.assertLessEqual(max(frames), 30 + 15, "it fades within half a second")

    def test_rows_follow_one_another_without_jumps(self):
        """Compares rows frame by frame. In solved water, particles touch an agent only now and then."""
        run = self.pair("--set", "/channel/velocity_m_s=2.5", *WEAK, *RAGDOLL, "--until-s", "3")
        rows = {(int(row["id"]), int(row["frame"])): row for row in table(run, "ragdoll.csv")}
        self.assertGreater(len(rows), 100)
        pieces = {}
        for (agent, frame), row in sorted(rows.items()):
            before = rows.get((agent, frame - 1))
            if before is None:
                pieces[agent] = pieces.get(agent, 0) + 1
                continue

            def change(name, row=row, before=before):
                return abs(float(row[name]) - float(before[name]))

            # w A / e in a thirtieth of a second, w = 4 1/s, of particles within 1.2 m and 8 m/s.
            self.assertLessEqual(change("hip_height_m"), 4 * 1.2 / math.e / 30)
            for axis in "xyz":
                self.assertLessEqual(change(f"rate_{axis}_rad_s"), 4 * 8 / math.e / 30)
        self.assertLessEqual(max(pieces.values()), 3, "rows of 3 s in few pieces")

    def test_rows_are_whole_when_the_crowd_is_killed(self):
        arguments = [*FAST, *WEAK, *RAGDOLL, *ENDLESS]
        server, client = self.server(*arguments), self.client(*arguments)
        self.wait_for_frame(40, server, client)
        client.send(signal.SIGKILL)
        client.wait()
        self.assertEqual(server.wait(), 4)
        text = client.run.bytes_of("ragdoll.csv").decode()
        self.assertTrue(text.endswith("\n"))
        self.assertEqual({line.count(",") for line in text.splitlines()}, {5})

    def test_v_f_that_nothing_sets_is_refused(self):
        client = self.client(*RAGDOLL, "--set", "/channel/flow=periodic")
        self.assert_ends(client, 2, "/crowd/ragdoll/condition", "nothing sets the speed", "local_speed")


class Poses(SystemTest):
    def test_poses_of_a_run_go_on_from_frame_to_frame(self):
        run = self.pair(*SHALLOW, *BODIES)
        rows = table(run, "poses.csv")
        keys = [(int(row["frame"]), int(row["id"])) for row in rows]
        self.assertEqual(keys, run.query("SELECT frame, id FROM trajectory_data ORDER BY frame, id"))
        self.assertIn("toppled", {row["state"] for row in rows})
        by_id = {}
        for row in rows:
            postures = FROM_STATE.get(row["state"], {"upright"})
            if row["state"] not in ("arrived", "dead", "afloat"):
                self.assertIn(row["posture"], postures, row)
            self.assertEqual(float(row["time_s"]), round(int(row["frame"]) / 30, 3))
            by_id.setdefault(row["id"], []).append(row)
        for agent in run.agents():
            self.assertEqual(agent["state"], by_id[agent["id"]][-1]["state"])
        # What the law of poses.csv allows in a thirtieth of a second, and the rounding to thousandths.
        fast = 5 / math.e / 30
        most = {
            "heading_rad": (math.pi + 2) / 30,
            "hip_height_m": 1.5 * fast,
            "lean_x_rad": math.pi * fast + math.pi / 30,
            "lean_z_rad": math.pi * fast + math.pi / 30,
            "step_length_m": 1.3 * fast,
            **{f"rate_{axis}_rad_s": 4 * fast for axis in "xyz"},
        }
        for one in by_id.values():
            for before, row in zip(one, one[1:]):
                for name, limit in most.items():
                    self.assertLessEqual(abs(float(row[name]) - float(before[name])), limit + 1.1e-3, (name, row))
                turned = (float(row["gait_phase"]) - float(before["gait_phase"])) % 1
                self.assertLessEqual(turned, 0.5 * 182 / 60 / 30 + 1.1e-3)

    def test_they_change_no_path_and_are_the_same_for_any_threads(self):
        plain = self.pair(*SHALLOW, *BODIES, "--set", "/crowd/poses/rate_hz=0")
        one = self.pair(*SHALLOW, *BODIES, "--threads", "1")
        two = self.pair(*SHALLOW, *BODIES, "--threads", "2")
        self.assertFalse((plain.folder / "poses.csv").exists())
        self.assertEqual(plain.bytes_of("agents.csv"), one.bytes_of("agents.csv"))
        self.assertEqual(one.bytes_of("poses.csv"), two.bytes_of("poses.csv"))

    def test_frames_are_whole_when_the_crowd_is_killed(self):
        arguments = [*FAST, *BODIES, *ENDLESS]
        server, client = self.server(*arguments), self.client(*arguments)
        self.wait_for_frame(40, server, client)
        client.send(signal.SIGKILL)
        client.wait()
        self.assertEqual(server.wait(), 4)
        text = client.run.bytes_of("poses.csv").decode()
        self.assertTrue(text.endswith("\n"))
        self.assertEqual({line.count(",") for line in text.splitlines()}, {17})


class Danger(SystemTest):
    def run_with_danger(self, *more):
        """Runs both programs; only the crowd's program gets the danger option. Returns the run."""
        server, client = self.server(*FAST), self.client(*FAST, *DANGER, *more)
        self.assert_ended_well(server, client)
        return client.run

    def test_agents_and_map_have_the_levels_of_the_water(self):
        plain, run = self.pair(*FAST), self.run_with_danger()
        self.assertFalse((plain.folder / "danger.csv").exists())
        for before, after in zip(plain.agents(), run.agents(), strict=True):
            self.assertEqual(before, {name: after[name] for name in before})
            self.assertEqual(list(after)[len(before):], ["danger_level", *TIMES])
            met = [level for level in LEVELS if float(after[f"{level}_s"]) > 0]
            self.assertEqual(after["danger_level"], met[-1])
        self.assertIn("very_high", {agent["danger_level"] for agent in run.agents()})
        # The times of an agent sum to all its steps, without the step at which it ends.
        for agent in run.agents():
            steps = round(float(agent["time_s"]) * 30) - (agent["outcome"] != "active")
            self.assertAlmostEqual(sum(float(agent[name]) for name in TIMES) * 30, steps, places=6)

        cells = table(run, "danger.csv")
        self.assertEqual(len(cells), 10 * 2)  # 20 x 4 m
        for cell in cells:
            self.assertEqual(cell["danger_level"], "very_high", "1 m at 2.5 m/s")
            # The lattice moves, and its particles are slightly narrower than their pitch. An edge of a cell of 2 m can
            # lose or gain some cm, up to 4 %. Water beyond the ends of the channel is added to the outermost cells.
            outermost = float(cell["x_min_m"]) == 0 or float(cell["x_max_m"]) == 20
            self.assertAlmostEqual(float(cell["max_dv_m2_s"]), 2.5, delta=0.25 if outermost else 0.1)
            self.assertAlmostEqual(float(cell["max_speed_m_s"]), 2.5, delta=1e-6)

    def test_crowds_in_one_water_have_the_files_of_single_runs(self):
        listed = self.folder / "crowds.json"
        ragdoll = {"/crowd/tau": 0.9, "/crowd/ragdoll/condition": "depth_speed"}
        listed.write_text(json.dumps([{"name": "plain"}, {"name": "ragdoll", "set": ragdoll}]))
        together = self.run_with_danger("--crowds", listed).folder
        self.assertFalse((together / "plain" / "ragdoll.csv").exists())
        alone = self.run_with_danger()
        settings = [word for key, value in ragdoll.items() for word in ("--set", f"{key}={value}")]
        tumbled = self.pair(*FAST, *settings)
        for name in ("danger.csv", "agents.csv"):
            self.assertEqual((together / "plain" / name).read_bytes(), alone.bytes_of(name))
        self.assertEqual((together / "ragdoll" / "ragdoll.csv").read_bytes(), tumbled.bytes_of("ragdoll.csv"))

    def test_picture_is_drawn_from_a_run_folder(self):
        run = self.run_with_danger()
        tool = [ROOT / "tools" / "wade", "danger-map"]
        subprocess.run([*tool, run.folder], check=True, capture_output=True)
        self.assertEqual(run.bytes_of("danger.png")[:8], b"\x89PNG\r\n\x1a\n")
        (run.folder / "danger.csv").unlink()
        refused = subprocess.run([*tool, run.folder], capture_output=True, text=True)
        self.assertEqual(refused.returncode, 1)
        self.assertIn("--danger-every-s", refused.stderr)


if __name__ == "__main__":
    unittest.main()
