"""Commands during a run: pause, single frames, another tau, the end; and runs that repeat those with commands."""

import json
import re
import signal
import time
import unittest

from harness import CLIENT, ENDLESS, PROGRAMS, SystemTest, wait_until

# shm_protocol/layout.hpp: `paused` of the control block and of the first consumer.
PRODUCER_PAUSED, CONSUMER_PAUSED = 4096 + 148, 3 * 4096 + 84


class Commands(SystemTest):
    def client_with_commands(self, *arguments):
        """A client that has made its FIFO and takes signals; `say` sends it lines."""
        fifo = self.folder / f"commands{len(self.programs)}"
        client = self.client("--commands", fifo, *arguments)
        records = client.run.folder / "outcome.json"
        wait_until(lambda: records.exists() or not client.running(), "the client's run folder")
        client.say = lambda *lines: fifo.write_text("".join(line + "\n" for line in lines))
        return client

    def wait_for_pause_after(self, frame, client):
        def paused():
            return self.acknowledged_frame() == frame and self.word(CONSUMER_PAUSED, "<I") == 1

        wait_until(lambda: paused() or not client.running(), f"the crowd to pause after frame {frame}")
        self.assertTrue(client.running(), client.messages())

    def played_events(self, client):
        return [json.loads(line) for line in client.run.bytes_of("events.jsonl").splitlines()]

    def assert_same_run(self, run, other):
        self.assertEqual(run.bytes_of("agents.csv"), other.bytes_of("agents.csv"))
        self.assertEqual(run.rows(), other.rows())
        self.assertEqual(run.bytes_of("outcome.json"), other.bytes_of("outcome.json"))

    def played_run(self, *arguments):
        """A run that is paused before frame 1 and after frame 3 and gets another tau each time."""
        client = self.client_with_commands("--reproducible", *arguments)
        client.say("pause")
        server = self.server("--reproducible", *arguments)
        self.wait_for_pause_after(0, client)
        client.say("tau 0.9 group walkers", "tau 0.1 agent 2", "step 3")
        self.wait_for_pause_after(3, client)
        client.say("tau 0 agent 4", "resume")
        self.assert_ended_well(server, client)
        return client

    def test_run_with_commands_is_repeated_by_the_scene_as_played(self):
        # With 45 steps a second there are one and two in turn in a frame, with 10 one in three frames.
        for rate, third_frame in (30, 4), (45, 4), (10, 6):
            with self.subTest(step_rate_hz=rate):
                settings = ["--set", f"/crowd/step_rate_hz={rate}", "--set", '/events=[{"frame":1,"tau":0.5}]']
                first_frame = 3 if rate == 10 else 1
                played = self.played_run(*settings)
                self.assertEqual(
                    self.played_events(played),
                    [
                        {"frame": first_frame, "tau": 0.9, "group": "walkers"},
                        {"frame": first_frame, "tau": 0.1, "agent": 2},
                        {"frame": third_frame, "tau": 0, "agent": 4},
                    ],
                )
                repeated = self.pair("--reproducible", scene=played.run.folder / "scene_as_played.json")
                self.assert_same_run(played.run, repeated)
                self.assertFalse((repeated.folder / "scene_as_played.json").exists())
                self.assertNotEqual(played.run.rows(), self.pair("--reproducible", *settings).rows())

    def test_pause_and_steps_by_signals_change_nothing(self):
        undisturbed = self.pair("--reproducible")
        client = self.client_with_commands("--reproducible")
        client.send(signal.SIGUSR1)
        server = self.server("--reproducible")
        self.wait_for_pause_after(0, client)
        for frame in (1, 2):
            client.send(signal.SIGUSR2)
            self.wait_for_pause_after(frame, client)
        client.send(signal.SIGUSR1)
        self.assert_ended_well(server, client)
        self.assert_same_run(undisturbed, client.run)
        self.assertFalse((client.run.folder / "events.jsonl").exists())

    def test_pause_of_either_side_outlasts_the_time_out_of_the_other(self):
        limit_s = 1.5
        for lag in "off", "serial":
            limit = ["--step-timeout-s", limit_s, "--set", f"/coupling/agents_stream={lag}", *ENDLESS]
            server, client = self.server(*limit), self.client(*limit)
            self.wait_for_frame(3, server, client)
            for program, paused in (client, CONSUMER_PAUSED), (server, PRODUCER_PAUSED):
                with self.subTest(agents_stream=lag, paused=program.name):
                    program.send(signal.SIGUSR1)
                    wait_until(
                        lambda word=paused, p=program: self.word(word, "<I") == 1 or not p.running(),
                        f"{program.name} to pause",
                    )
                    begin = time.monotonic()
                    wait_until(lambda since=begin: time.monotonic() - since > 1.5 * limit_s, "the time-out to be over")
                    last = self.published_frame()
                    program.send(signal.SIGUSR1)
                    self.wait_for_frame(last + 10, server, client)
            client.send(signal.SIGTERM)
            self.assert_ends(client, 143)
            self.assert_ends(server, 5)

    def test_paused_side_notices_that_the_other_one_died(self):
        server, client = self.server(*ENDLESS), self.client_with_commands(*ENDLESS)
        self.wait_for_frame(2, server, client)
        client.say("pause")
        wait_until(lambda: self.word(CONSUMER_PAUSED, "<I") == 1, "the crowd to pause")
        self.kill_server(server)
        self.assert_ends(client, 4, "died at frame")
        self.remove_segment_of_killed_server()

        server, client = self.server(*ENDLESS), self.client(*ENDLESS)
        self.wait_for_frame(2, server, client)
        server.send(signal.SIGUSR1)
        wait_until(lambda: self.word(PRODUCER_PAUSED, "<I") == 1, "the water to pause")
        client.send(signal.SIGKILL)
        self.assert_ends(server, 4, "died at frame")

    def test_wrong_commands_are_messages_and_no_end(self):
        client = self.client_with_commands()
        client.say("jump", "tau 2", "tau 0.5 agent 6", "tau 0.5 group swimmers")
        server = self.server()
        self.assert_ended_well(server, client)
        for text in ('"jump"', '"tau 2"', "no agent 6; allowed: 0 to 5", '"swimmers"; allowed: walkers'):
            self.assertIn(text, client.messages())
        self.assertFalse((client.run.folder / "events.jsonl").exists())

    def test_quit_is_a_goodbye(self):
        for settings in ([], ["--set", "/coupling/agents_stream=parallel"]):
            with self.subTest(settings=settings):
                client = self.client_with_commands(*ENDLESS, *settings)
                server = self.server(*ENDLESS, *settings)
                self.wait_for_frame(5, server, client)
                client.say("quit")
                self.assert_ends(client, 130, "told to quit after frame")
                self.assert_ended_well(server)
                self.assert_complete_records(client.run, "interrupted")

    def test_pause_does_not_cost_a_third_party_its_patience(self):
        recording = self.folder / "paused.wrec"
        server = self.server("--consumers", "2", *ENDLESS)
        recorder = self.start(PROGRAMS / "shm_record", self.session, recording, "--step-timeout-s", "1")
        client = self.client_with_commands(*ENDLESS)
        self.wait_for_frame(5, server, client, recorder)
        client.say("pause")
        wait_until(lambda: self.word(CONSUMER_PAUSED, "<I") or self.word(CONSUMER_PAUSED + 4096, "<I"), "the pause")
        wait_until(lambda: self.word(PRODUCER_PAUSED, "<I") == 1, "the water to pass the pause on")
        time.sleep(3)  # three times the patience of the recorder
        self.assertTrue(recorder.running(), recorder.messages())
        client.say("resume", "quit")
        self.assert_ends(client, 130)
        self.assert_ended_well(server, recorder)

    def test_pause_of_the_crowd_stops_the_clock_of_the_water(self):
        length = ["--until-s", "3", "--set", "/stop_when_no_agent_is_active=false"]
        server, client = self.server("--clock", "real_time", *length), self.client_with_commands(*length)
        self.wait_for_frame(5, server, client)
        client.say("pause")
        wait_until(lambda: self.word(PRODUCER_PAUSED, "<I") == 1, "the water to pass the pause on")
        time.sleep(3)
        client.say("resume")
        self.assert_ended_well(server, client)
        # Without it all frames after the pause would be about three seconds late; a busy machine is late by less than two.
        late = re.search(r"by up to (\d+) ms", server.messages())
        self.assertLess(int(late[1]) if late else 0, 2000, server.messages())

    def test_killed_run_keeps_the_commands_it_obeyed(self):
        client = self.client_with_commands(*ENDLESS)
        client.say("tau 0.75", "step 3")
        server = self.server(*ENDLESS)
        self.wait_for_pause_after(3, client)
        client.send(signal.SIGKILL)
        self.assertEqual(client.wait(), -signal.SIGKILL)
        self.assert_ends(server, 4)
        self.assertEqual(self.played_events(client), [{"frame": 1, "tau": 0.75}])
        check = self.start(CLIENT, client.run.folder / "scene_as_played.json", "--check")
        self.assert_ended_well(check)

    def test_place_that_cannot_be_a_fifo_is_a_usage_error(self):
        place = self.folder / "file"
        place.write_text("")
        client = self.client("--commands", place)
        self.assert_ends(client, 2, "--commands", str(place))
        self.assertFalse(client.run.folder.exists())


if __name__ == "__main__":
    unittest.main()
