"""The model "auto": what the server says and leaves behind, and that the scene as chosen repeats the run."""

import json

from harness import SMALL, SystemTest

OPEN = ["--set", "/fluid/model=auto", "--set", "/fluid/max_impulse_error=0.3"]


class ModelChoice(SystemTest):
    def test_scene_as_chosen_repeats_the_run(self):
        folder = self.folder / "open"
        server, client = self.server(*OPEN, "--out", folder), self.client(*OPEN, out=folder)
        self.assert_ended_well(server, client)
        self.assertIn("chosen: ", server.messages())
        self.assertIn("without a choice the same is: --set /fluid/model=", server.messages())
        chosen = folder / "scene_as_chosen.json"
        document = json.loads(chosen.read_text())
        self.assertNotEqual(document["fluid"]["model"], "auto")
        self.assertEqual(document["fluid"]["max_impulse_error"], 0)
        again = self.pair(scene=chosen)
        self.assertEqual(again.outcome()["frame_hash"], client.run.outcome()["frame_hash"])
        self.assertEqual(again.bytes_of("agents.csv"), client.run.bytes_of("agents.csv"))

    def test_people_push_water_that_is_chosen_as_if_it_were_named(self):
        """The crowd learns model and spacing from the stream: the drag on what people feel depends on both."""
        two_way = ["--set", "/coupling/two_way=true", "--set", "/crowd/response=measured"]
        folder = self.folder / "open"
        server, client = self.server(*OPEN, *two_way, "--out", folder), self.client(*OPEN, *two_way, out=folder)
        self.assert_ended_well(server, client)
        outcome = client.run.outcome()
        got = max(map(abs, outcome["momentum"]["people_got_n_s"]))
        self.assertGreater(got, 10)
        self.assertLess(outcome["momentum_balance_n_s"], 1e-5 * got)
        again = self.pair(scene=folder / "scene_as_chosen.json")
        self.assertEqual(again.outcome()["frame_hash"], outcome["frame_hash"])
        self.assertEqual(again.bytes_of("agents.csv"), client.run.bytes_of("agents.csv"))

    def test_check_says_the_choice_and_print_config_the_scene_as_written(self):
        check = self.start_and_read("--check")
        self.assertIn("max_impulse_error 0.3: water of this scene:", check)
        self.assertEqual(check, self.start_and_read("--check", "--threads", "2"))
        self.assertEqual(json.loads(self.start_and_read("--print-config"))["fluid"]["model"], "auto")

    def test_demand_that_cannot_be_met_is_refused(self):
        server = self.server("--set", "/fluid/model=auto", "--set", "/fluid/max_impulse_error=1e-6")
        self.assert_ends(server, 2, f"{SMALL}: /fluid/max_impulse_error: 1e-06 cannot be met", "allowed: >= ")

    def start_and_read(self, *arguments):
        server = self.server(*OPEN, *arguments)
        self.assert_ended_well(server)
        server.output.seek(0)
        return server.output.read()
