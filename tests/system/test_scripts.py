"""tools/run.sh and tools/reproduce_paper.sh from end to end, with the programs of this build."""

import csv
import json
import os
import signal
import subprocess
import unittest
from pathlib import Path
from unittest import mock

from harness import ENDLESS, ROOT, SMALL, Launcher, Run, alive, children_of, command_of, wait_until

from wade.pictures import figure

RUN = ROOT / "tools" / "run.sh"
REPRODUCE = ROOT / "tools" / "reproduce_paper.sh"
INSTALL = ROOT / "tools" / "install_dependencies.sh"
PNG = b"\x89PNG\r\n\x1a\n"


class Scripts(Launcher):
    def run_sh(self, *arguments):
        return self.script(RUN, "--session", self.session, "--out", self.folder / "run", *arguments)

    def test_run_sh_runs_a_scene_to_its_picture(self):
        run_sh = self.run_sh(SMALL, "--threads", "1", "--water-every-s=1")
        self.assert_ended_well(run_sh)
        folder = self.folder / "run"
        outcome, _ = self.assert_complete_records(Run(folder), "completed")
        self.assertEqual(outcome["fluid"]["position_clamps"], 0)
        self.assertEqual((folder / "figure.png").read_bytes()[:8], PNG)
        self.assertIn("240 frames", (folder / "fluid_server.log").read_text())
        said = self.output_of(run_sh)
        self.assertIn(f"system_small: completed; {outcome['arrived']} of 6 arrived", said)
        self.assertIn(str(folder / "figure.png"), said)
        self.assertIn(f"tools/wade view {folder}", said)

    def test_run_sh_without_paths_says_that_there_is_no_picture(self):
        run_sh = self.run_sh(SMALL, "--until-s", "1", "--no-trajectories")
        self.assert_ended_well(run_sh)
        self.assertIn("no picture: --no-trajectories", self.output_of(run_sh))
        self.assertEqual(list((self.folder / "run").glob("*.png")), [])

    def test_killed_crowd_is_drawn_as_cut_off(self):
        run_sh = self.run_sh(SMALL, *ENDLESS)
        self.wait_for_frame(30, run_sh)
        client = next(pid for pid in children_of(run_sh.process.pid) if "crowd_client" in command_of(pid))
        os.kill(client, signal.SIGKILL)
        self.assertNotEqual(run_sh.wait(), 0)
        self.assertEqual(Run(self.folder / "run").outcome()["status"], "running")
        (self.folder / "run" / "agents.csv").unlink(missing_ok=True)  # of a run that had gone on for some seconds
        with mock.patch.object(figure, "save_picture") as save:
            figure.draw(self.folder / "run", None, None)
        drawing = save.call_args.args[0]
        title, *_ = [text.get_text() for text in drawing.texts]
        self.assertTrue(title.endswith("cut off, no outcome"), title)
        self.assertIn("last seen (6)", [text.get_text() for text in drawing.legends[0].get_texts()])

    def test_run_sh_makes_a_session_of_its_own(self):
        first, second = (
            self.script(RUN, "configs/paper/s01.json", "--until-s", "2", "--no-figure", "--out", self.folder / name)
            for name in ("first", "second")
        )
        self.assert_ended_well(first, second)
        runs = [Run(self.folder / name) for name in ("first", "second")]
        self.assertEqual(runs[0].outcome()["frame_hash"], runs[1].outcome()["frame_hash"])
        sessions = {json.loads(run.bytes_of("manifest.json"))["session"] for run in runs}
        self.assertEqual(len(sessions), 2)
        self.assertEqual([name for name in sessions if Path(f"/dev/shm/{name}-fluid").exists()], [])

    def test_run_sh_refuses_a_bad_scene_before_anything_starts(self):
        run_sh = self.run_sh(SMALL, "--set", "/crowd/tau=2")
        self.assert_ends(run_sh, 2, "/crowd/tau", "out of range")
        self.assertFalse((self.folder / "run").exists())

    def test_run_sh_refuses_an_unknown_option(self):
        self.assert_ends(self.run_sh(SMALL, "--treads", "2"), 2, '"--treads"', '"--threads"')

    def test_run_sh_check_answers_and_runs_nothing(self):
        run_sh = self.run_sh(SMALL, "--check")
        self.assert_ended_well(run_sh)
        self.assertIn("system_small", self.output_of(run_sh))
        self.assertFalse((self.folder / "run").exists())

    def test_run_sh_check_asks_both_programs(self):
        for arguments, *texts in (
            (["--clock", "nosuch"], "wade run: --clock: nosuch", "real_time"),
            (["--from-state", "/nonexistent"], "--from-state: /nonexistent cannot be read"),
            ([f"--from-state={self.folder}"], "--from-state", "cannot be read"),
            (["--mode", "nosuch"], "wade run: --mode: nosuch", "latest"),
        ):
            for question in ("--check", "--print-config"):
                with self.subTest(arguments, question=question):
                    run_sh = self.run_sh(SMALL, question, *arguments)
                    self.assert_ends(run_sh, 2, *texts)
                    self.assertEqual(self.output_of(run_sh), "")

    def test_run_sh_prints_the_scene_once(self):
        for question, named in (("--check", "system_small"), ("--version", "crowd_client")):
            run_sh = self.run_sh(SMALL, question)
            self.assert_ended_well(run_sh)
            lines = self.output_of(run_sh).splitlines()
            self.assertEqual(sum(named in line for line in lines), 1, lines)
        run_sh = self.run_sh(SMALL, "--print-config")
        self.assert_ended_well(run_sh)
        self.assertEqual(json.loads(self.output_of(run_sh))["name"], "system_small")

    def test_run_sh_refuses_a_session_in_use(self):
        server = self.server(*ENDLESS)
        self.wait_for_segment()
        self.assert_ends(self.run_sh(SMALL), 8, "exit code 8", self.session)
        self.assertTrue(server.running(), "the living server is left in peace")
        server.send(signal.SIGTERM)
        self.assert_ends(server, 143)

    def test_run_sh_passes_signals_on_and_leaves_no_orphans(self):
        for number, code in ((signal.SIGINT, 130), (signal.SIGTERM, 143)):
            with self.subTest(signal=number.name):
                run_sh = self.run_sh(SMALL, *ENDLESS)
                self.wait_for_frame(5, run_sh)
                below = children_of(run_sh.process.pid)
                self.assertEqual(len(below), 3)  # both programs, and the picture that is prepared
                run_sh.send(number)
                self.assert_ends(run_sh, code)
                self.assertEqual([pid for pid in below if alive(pid)], [])
                self.assertFalse(Path(f"/dev/shm/{self.session}-fluid").exists())

    def test_killed_run_sh_takes_both_programs_with_it(self):
        run_sh = self.run_sh(SMALL, *ENDLESS)
        self.wait_for_frame(5, run_sh)
        below = children_of(run_sh.process.pid)
        run_sh.send(signal.SIGKILL)
        self.assertEqual(run_sh.wait(), -signal.SIGKILL)
        wait_until(lambda: not any(alive(pid) for pid in below), "both programs to end")

    def test_run_sh_reports_a_killed_server(self):
        run_sh = self.run_sh(SMALL, *ENDLESS, "--no-figure")
        self.wait_for_frame(5, run_sh)
        server = next(pid for pid in children_of(run_sh.process.pid) if "fluid_server" in command_of(pid))
        os.kill(server, signal.SIGKILL)
        self.assert_ends(run_sh, 128 + signal.SIGKILL, "fluid_server ended with exit code 137")
        self.assert_complete_records(Run(self.folder / "run"), "peer_dead")
        self.remove_segment_of_killed_server()

    def test_reproduce_paper_writes_the_table_and_resumes(self):
        out = self.folder / "paper"
        command = (REPRODUCE, "--quick", "--set-of-scenes", "paper", "--until-s", "1", "--out", out)
        first = self.script(*command)
        self.assert_ended_well(first)
        with open(out / "table1.csv", newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([row["scenario"] for row in rows], ["S1", "S4", "S5", "S8"])
        fifth = rows[2]
        self.assertEqual((fifth["set"], fifth["tau"], fifth["v_f_m_s"]), ("paper", "0.2", "1.5"))
        self.assertEqual((fifth["paper_time_s"], fifth["paper_diff_percent"]), ("93", "102"))
        self.assertEqual((fifth["arrived_mean"], fifth["time_s_mean"], fifth["in_band"]), ("0", "", ""))
        self.assertIn("| S8", self.output_of(first))
        self.assertEqual(self.output_of(first).split("\n## ")[0], (out / "report.md").read_text().split("\n## ")[0])
        outcome = out / "paper" / "v1.5" / "s5-seed1" / "outcome.json"
        written = outcome.stat().st_mtime_ns
        again = self.script(*command)
        self.assert_ended_well(again)
        self.assertEqual(again.messages().count("(done before)"), 4)
        self.assertEqual(outcome.stat().st_mtime_ns, written)
        other = self.script(*command, "--until-s", "0.5")
        self.assert_ended_well(other)
        self.assertEqual(other.messages().count("(run)"), 4, "another scene is run again")

    def test_install_dependencies_says_nothing_when_nothing_is_missing(self):
        answer = subprocess.run([INSTALL], capture_output=True, text=True)
        self.assertEqual((answer.returncode, answer.stdout, answer.stderr), (0, "", ""))


if __name__ == "__main__":
    unittest.main()
