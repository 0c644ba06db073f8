"""tools/run.sh with a recorder, a replay and another producer, and its commands."""

import fcntl
import json
import os
import pty
import re
import signal
import subprocess
import threading
import unittest
from pathlib import Path

from harness import ENDLESS, PROGRAMS, ROOT, SMALL, Launcher, Run, unwrapped, wait_until

RUN = ROOT / "tools" / "run.sh"
SHORT = ["--until-s", "1"]
CLIENT_PAUSED = 3 * 4096 + 84  # shm_protocol/layout.hpp: of the first consumer


def drain(terminal):
    """Reads the output of a terminal until all processes have closed it."""
    try:
        while os.read(terminal, 4096):
            pass
    except OSError:
        pass


class RunScript(Launcher):
    def run_sh(self, out, *arguments, scene=SMALL):
        program = self.script(
            RUN, scene, "--session", self.session, "--out", self.folder / out, "--no-figure", *arguments
        )
        program.run = Run(self.folder / out)
        return program

    def refused(self, arguments, *texts):
        out = self.folder / "run"
        self.assert_refused_here("run", SMALL, "--session", self.session, "--out", out, "--no-figure", *arguments, texts=texts)
        self.assertFalse(out.exists())

    def assert_same_results(self, run, other):
        for name in ("outcome.json", "agents.csv", "trajectories.sqlite", "water.bin"):
            self.assertEqual(run.bytes_of(name), other.bytes_of(name), name)

    def test_record_and_replay_give_the_same_results(self):
        file = self.folder / "run.wrec"
        live = self.run_sh("live", "--reproducible", "--record", file)
        self.assert_ended_well(live)
        self.assertIn(f"recording: {file}", self.output_of(live))
        self.assertIn("240 frames", (live.run.folder / "shm_record.log").read_text())
        replay = self.run_sh("replay", "--reproducible", "--replay", file)
        self.assert_ended_well(replay)
        self.assert_same_results(live.run, replay.run)
        self.assertIn("240 frames played", (replay.run.folder / "producer.log").read_text())

    def test_replay_of_another_scene_needs_any_scene_as_the_help_says(self):
        file = self.folder / "run.wrec"
        self.assert_ended_well(self.run_sh("live", *SHORT, "--record", file))
        other = ["--set", "/crowd/tau=0.5", "--replay", file]
        self.assert_ends(self.run_sh("refused", *SHORT, *other), 6, "different scenes")
        self.assert_ended_well(self.run_sh("replay", *SHORT, *other, "--any-scene"))
        self.assertIn("--any-scene", subprocess.run([RUN, "--help"], capture_output=True, text=True, check=True).stdout)

    def test_a_rounded_recording_that_is_given_no_region_takes_the_world(self):
        file = self.folder / "run.wrec"
        run_sh = self.run_sh("live", *SHORT, "--record", file, "--quantised", "--interval-s", "0.5", "--no-figure")
        self.assert_ended_well(run_sh)
        info = subprocess.run([PROGRAMS / "shm_replay", "--info", file], capture_output=True, text=True, check=True).stdout
        self.assertIn("a frame each 0.5 s; x -1 to 21, y -16 to 48, z -1 to 13 m; places within", info)
        self.assertRegex(info, r"frames +1 to 3,")

    def test_any_command_can_be_the_producer(self):
        file = self.folder / "run.wrec"
        live = self.run_sh("live", "--reproducible", *SHORT, "--record", file)
        self.assert_ended_well(live)
        program = f"{PROGRAMS / 'shm_replay'} {file}"
        copy = self.folder / "copy.wrec"
        for out, command, options in (
            ("named", f"{program} --session {{session}}", []),
            ("appended", program, []),
            ("below a shell", f"sh -c '{program} --session {{session}}; exit $?'", []),
            ("recorded", f"{program} --consumers {{consumers}}", ["--record", copy]),
        ):
            with self.subTest(out):
                run_sh = self.run_sh(out, "--reproducible", *SHORT, *options, "--producer", command)
                self.assert_ended_well(run_sh)
                self.assert_same_results(live.run, run_sh.run)

    def test_wrong_choices_of_a_producer_are_refused(self):
        for arguments, *texts in (
            (["--replay", "a", "--producer", "b"], "--replay", "--producer", "exclude"),
            (["--producer", "/no/such/program"], "/no/such/program"),
            (["--replay", self.folder / "absent.wrec"], "absent.wrec"),
            (["--record", self.folder / "no" / "such" / "folder.wrec"], "folder.wrec"),
        ):
            with self.subTest(arguments):
                self.assert_ends(self.run_sh("run", *arguments), 2, *texts)

    def test_recording_that_was_not_written_is_not_named(self):
        other = self.folder / "notes.txt"
        other.write_text("no recording, and so not replaced")
        for file in (self.folder / "no" / "such" / "folder.wrec", other):
            with self.subTest(file):
                run_sh = self.run_sh("run", *SHORT, "--record", file)
                self.assert_ends(run_sh, 2, file.name)
                self.assertNotIn("recording:", self.output_of(run_sh))

    def test_crowd_that_takes_the_latest_frames_gets_water_that_does_not_wait(self):
        for out, *options in (("plain",), ("clock", "--clock=real_time"), ("consumers", "--consumers", "0")):
            with self.subTest(out):
                run_sh = self.run_sh(out, *SHORT, "--mode", "latest", *options)
                self.assert_ended_well(run_sh)
                outcome = run_sh.run.outcome()
                self.assertEqual((outcome["status"], outcome["mode"]), ("completed", "latest"))
                self.assertGreater(outcome["frames"], 1)
                self.assertIn("waiting for no crowd", unwrapped((run_sh.run.folder / "fluid_server.log").read_text()))

    def test_latest_frames_of_another_producer_beside_a_recorder(self):
        file = self.folder / "run.wrec"
        server = f"{PROGRAMS / 'fluid_server'} {{scene}} --until-s 1 --clock real_time --consumers {{consumers}}"
        run_sh = self.run_sh("run", *SHORT, "--mode", "latest", "--record", file, "--producer", server)
        self.assert_ended_well(run_sh)
        self.assertEqual(run_sh.run.outcome()["mode"], "latest")
        self.assertIn(f"recording: {file}", self.output_of(run_sh))
        self.assertIn("waiting for no crowd", unwrapped((run_sh.run.folder / "producer.log").read_text()))

    def test_many_crowds_can_take_the_latest_frames(self):
        run_sh = self.run_sh("run", *SHORT, "--mode=latest", *self.list_of_crowds("a", "b"))
        self.assert_ended_well(run_sh)
        self.assertIn("b: completed", self.output_of(run_sh))

    def test_water_that_waits_or_hurries_does_not_go_with_the_latest_frames(self):
        for arguments in (
            ["--consumers", "1"], ["--consumers=2"], ["--clock", "fast"], ["--clock=fast"], ["--replay", "a.wrec"],
        ):
            with self.subTest(arguments):
                name = arguments[0].partition("=")[0]
                self.refused(["--mode", "latest", *arguments], "--mode latest", name, "exclude")

    def test_empty_values_are_refused_before_anything_starts(self):
        for arguments, *texts in (
            (["--out="], "--out", "a folder"),
            (["--out", ""], "--out", "a folder"),
            (["--session", ""], "--session", "1 to 200 letters"),
            (["--session="], "--session", "1 to 200 letters"),
            (["--record="], "--record", "a file"),
            (["--replay="], "--replay", "a recording"),
            (["--producer", ""], "--producer", "a command"),
            (["--producer", " "], "--producer", "a command"),
            (["--producer", "''"], "--producer", "a command"),
            (["--producer", '"'], "--producer", "No closing quotation", "a command"),
            (["--no-figure=1"], "--no-figure: no value is allowed"),
            (["--no-figure="], "--no-figure: no value is allowed"),
        ):
            with self.subTest(arguments):
                self.refused(arguments, *texts)

    def test_failed_producer_is_reported_with_its_code_and_log(self):
        run_sh = self.run_sh("run", "--producer", "sh -c 'echo no water today; exit 9'")
        self.assert_ends(run_sh, 9, "exit code 9", "no water today")

    def test_bytes_of_a_producer_are_shown_harmlessly(self):
        log = "printf '\\033]0;x\\007 \\302\\233 1m \\233 2m \\377 \\342\\200\\256 Ende\\n' >&2; exit 9"
        run_sh = self.run_sh("run", "--producer", f'sh -c "{log}"')
        self.assert_ends(run_sh, 9, "\\x1b]0;x\\x07", "\\x9b 1m", "\\x9b 2m", "Ende")
        for line in run_sh.messages().splitlines():
            self.assertTrue(line.isprintable(), repr(line))

    def test_any_standard_stream_may_be_closed(self):
        for n, closed in enumerate(("<&-", ">&-", "2>&-", "<&- >&- 2>&-")):
            with self.subTest(closed):
                out = self.folder / f"run{n}"
                command = [str(RUN), str(SMALL), "--session", self.session, "--out", str(out), *SHORT]
                draws = n == 3
                run_sh = self.script("sh", "-c", f'"$@" {closed}', "sh", *command, *([] if draws else ["--no-figure"]))
                self.assert_ended_well(run_sh)
                self.assertEqual(Run(out).outcome()["status"], "completed")
                self.assertEqual((out / "figure.png").exists(), draws)

    def test_scenes_are_found_by_their_short_names(self):
        run_sh = self.script(RUN, "river/s05", "--print-config")
        self.assert_ended_well(run_sh)
        self.assertEqual(json.loads(self.output_of(run_sh))["name"], "river_s05")
        self.assert_ends(self.script(RUN, "river/s5"), 2, 'no scene "river/s5"', "river/s05")

    def test_a_typing_error_is_told_in_a_fresh_clone_before_anything_is_built(self):
        build = self.folder / "build"
        for words, text in ((["--treads", "2"], '"--threads"'), (["rivr/s05"], "river/s05"),
                            (["--set", "/fluid/modle=sph"], '"model"')):
            with self.subTest(words):
                run_sh = self.start(RUN, *words, env={**os.environ, "WADE_BUILD": str(build)})
                self.assert_ends(run_sh, 2, text)
                self.assertFalse(build.exists())

    def test_programs_that_are_up_to_date_start_while_another_build_has_the_folder(self):
        with open(PROGRAMS / ".lock", "ab") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            self.assert_ended_well(self.script(RUN, SMALL, "--check"))

    @unittest.skipIf(os.getuid() != 0, "only root can be another user")
    def test_another_user_runs_what_is_built(self):
        self.folder.chmod(0o777)
        command = ["setpriv", "--reuid=65534", "--regid=65534", "--clear-groups", RUN, SMALL, "--until-s", "1"]
        environment = {**os.environ, "WADE_BUILD": str(PROGRAMS), "HOME": "/nonexistent", "TMPDIR": str(self.folder)}
        if subprocess.run([*command[:4], "test", "-r", SMALL]).returncode != 0:
            self.skipTest("the project lies where another user cannot read")
        run_sh = self.start(*command, cwd=self.folder, env=environment)
        self.assert_ended_well(run_sh)
        folder = Path(re.search("^run folder: (.*)$", self.output_of(run_sh), re.MULTILINE)[1])
        self.assertEqual(folder.parent, self.folder / "runs")
        self.assertEqual(folder.stat().st_uid, 65534)
        self.assertTrue((folder / "figure.png").exists())

    def list_of_crowds(self, *names):
        file = self.folder / "crowds.json"
        file.write_text(json.dumps([{"name": name} for name in names]))
        return ["--crowds", file]

    def test_outcome_of_an_earlier_run_is_not_shown_as_that_of_a_failed_one(self):
        no_producer = ["--producer", "sh -c 'exit 9'"]
        first = self.run_sh("run", *SHORT)
        self.assert_ended_well(first)
        self.assertNotIn("earlier", first.messages())
        again = self.run_sh("run", *SHORT)
        self.assert_ends(again, 0, f"replaces the results of an earlier run in '{self.folder / 'run'}': ")
        results = self.folder / "run" / "outcome.json"
        earlier = results.read_bytes()
        failed = self.run_sh("run", *SHORT, *no_producer)
        self.assert_ends(failed, 9)
        self.assertNotIn("completed", self.output_of(failed))
        self.assertIn("of an earlier run, not of this one: outcome.json\n", self.output_of(failed))
        self.assertEqual(results.read_bytes(), earlier)

    def test_crowds_of_an_earlier_list_are_named_as_such(self):
        no_producer = ["--producer", "sh -c 'exit 9'"]
        first = self.run_sh("run", *SHORT, *self.list_of_crowds("a", "b"))
        self.assert_ended_well(first)
        self.assertNotIn("earlier", self.output_of(first))
        second = self.run_sh("run", *SHORT, *self.list_of_crowds("b", "c"))
        self.assert_ended_well(second)
        self.assertIn("of an earlier run, not of this one: a\n", self.output_of(second))
        third = self.run_sh("run", *SHORT, *self.list_of_crowds("b", "c"), *no_producer)
        self.assert_ends(third, 9)
        self.assertIn("of an earlier run, not of this one: crowds.csv, a, b, c\n", self.output_of(third))
        self.assertNotIn("completed", self.output_of(third))

    def test_killed_recorder_is_reported(self):
        run_sh = self.run_sh("run", *ENDLESS, "--record", self.folder / "run.wrec")
        self.wait_for_frame(5, run_sh)
        for child in Path(f"/proc/{run_sh.process.pid}/task/{run_sh.process.pid}/children").read_text().split():
            if "shm_record" in Path(f"/proc/{child}/cmdline").read_text():
                os.kill(int(child), signal.SIGKILL)
        self.assert_ends(run_sh, 128 + signal.SIGKILL, "shm_record ended with exit code 137", "recorder")

    def test_signals_pause_and_resume_the_crowd(self):
        run_sh = self.run_sh("run", *ENDLESS)
        self.wait_for_frame(5, run_sh)
        run_sh.send(signal.SIGUSR1)
        wait_until(lambda: self.word(CLIENT_PAUSED, "<I") == 1, "the crowd to pause")
        run_sh.send(signal.SIGUSR1)
        wait_until(lambda: self.word(CLIENT_PAUSED, "<I") == 0, "the crowd to go on")
        self.wait_for_frame(self.published_frame() + 5, run_sh)
        run_sh.send(signal.SIGTERM)
        self.assert_ends(run_sh, 143)

    def test_commands_can_be_typed_into_the_terminal(self):
        command = [RUN, SMALL, "--session", self.session, "--out", self.folder / "run", "--no-figure", *ENDLESS]
        pid, terminal = pty.fork()
        if pid == 0:
            os.execve(RUN, list(map(str, command)), {**os.environ, "WADE_BUILD": str(PROGRAMS)})
        shown = threading.Thread(target=drain, args=[terminal])
        shown.start()
        try:
            wait_until(lambda: self.published_frame() >= 5, "frame 5")
            os.write(terminal, b"pause\n")
            wait_until(lambda: self.word(CLIENT_PAUSED, "<I") == 1, "the crowd to pause")
            os.write(terminal, b"resume\n")
            wait_until(lambda: self.word(CLIENT_PAUSED, "<I") == 0, "the crowd to go on")
        finally:
            os.write(terminal, b"\x03")  # Ctrl-C, for all of them
            _, status = os.waitpid(pid, 0)
            shown.join()
            os.close(terminal)
        self.assertEqual(os.waitstatus_to_exitcode(status), 130)

    def test_commands_come_from_standard_input(self):
        command = f"printf 'tau 0.7\\nquit\\n' | {RUN} {SMALL} --session {self.session} --out {self.folder / 'run'} "
        run_sh = self.script("sh", "-c", command + "--no-figure --commands - " + " ".join(ENDLESS))
        self.assert_ends(run_sh, 130, "0.7", "told to quit")
        self.assertIn('"tau":0.7', (self.folder / "run" / "events.jsonl").read_text().replace(" ", ""))


class DepthSweep(Launcher):
    def test_wrong_choices_are_refused_and_leave_nothing(self):
        out = self.folder / "sweep"
        for arguments, *texts in ((["--scene", "nosuch"], "nosuch"), (["--points", "1"], "--points: 1, allowed is 2 to 50"),
                                  (["--taus", "0.2,7"], "0.2,7, allowed is above 0 to 1 each")):
            with self.subTest(arguments):
                self.assert_refused_here("depth-sweep", "--out", out, *arguments, texts=texts)
                self.assertFalse(out.exists())


if __name__ == "__main__":
    unittest.main()
