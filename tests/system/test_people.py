"""What becomes of people between walls and water."""

import json
import re
import unittest

from harness import CLIENT, ROOT, SystemTest


def closed_scene(model, bodies, moved_m=0, mirrored=False):
    """Returns a scene: a dam breaks towards nine people at the other end of a closed channel, 10 m long."""
    length, end = 10, moved_m + 10

    def along(x):
        return end - x if mirrored else moved_m + x

    def between(a, b):
        return {"x_min_m": min(along(a), along(b)), "x_max_m": max(along(a), along(b)), "z_min_m": 0, "z_max_m": 3}

    return {
        "name": "closed",
        "duration_s": 5,
        "frame_rate_hz": 30,
        "world": {"length_m": 2 * moved_m + length, "width_m": 3},
        "channel": {**between(0, length), "flow": "closed", "water_blocks": [{**between(7, 10), "depth_m": 2}]},
        "fluid": {"model": model, "particle_spacing_m": 0.25, "max_particles": 2000},
        "crowd": {
            "tau": 1,
            "desired_speed_m_s": 0.3,
            "goal_radius_m": 0.5,
            "bodies": bodies,
            "markers": "redrawn",
            "groups": [
                {
                    "name": "walkers",
                    "columns": 3,
                    "rows": 3,
                    "start": {"x_m": min(along(0.3), along(1.9)), "z_m": 0.7, "pitch_x_m": 0.8, "pitch_z_m": 0.8},
                    "goal": {"x_m": along(9), "z_m": 1.5},
                }
            ],
        },
    }


class ClosedChannels(SystemTest):
    def test_nobody_dies_or_passes_a_wall_of_a_closed_channel(self):
        """Whichever model moves the water, whatever people are, wherever the channel lies."""
        for model, bodies, moved_m, mirrored in (
            ("shallow_water", "none", 0, False),
            ("shallow_water", "human", 5, False),
            ("dfsph", "none", 0, False),
            ("dfsph", "human", 0, False),
            ("dfsph", "fast", 5, True),
            ("mixed", "fast", 0, False),
            ("mixed", "none", 5, False),
        ):
            with self.subTest(model=model, bodies=bodies, moved_m=moved_m, mirrored=mirrored):
                scene = self.folder / f"{model}-{bodies}-{moved_m}.json"
                scene.write_text(json.dumps(closed_scene(model, bodies, moved_m, mirrored)))
                run = self.pair(scene=scene)
                self.assertEqual(run.outcome()["dead"], 0)
                ends = run.query("SELECT min(pos_x), max(pos_x) FROM trajectory_data")[0]
                self.assertGreaterEqual(ends[0], moved_m)
                self.assertLessEqual(ends[1], moved_m + 10)
                # The water reached the people that started 0.3 m from the wall and pressed them against it.
                reached = moved_m + 10 - ends[1] if mirrored else ends[0] - moved_m
                self.assertLess(reached, 0.05)


class Hamlet(SystemTest):
    """The shipped hamlet: people leave their houses for two shelters while the river rises."""

    scene = ROOT / "configs" / "sites" / "hamlet.json"

    def test_everybody_is_somewhere_and_nobody_went_through_a_wall(self):
        run = self.pair("--until-s", "90", scene=self.scene)
        outcome = run.outcome()
        states = outcome["states"]
        self.assertEqual(sum(states.values()), 100)
        ends = ("arrived", "dead", "active", "sheltered", "indoors", "upper_floor")
        self.assertEqual(sum(outcome[end] for end in ends), 100)
        self.assertGreater(outcome["sheltered"], 10)
        self.assertGreater(outcome["indoors"], 5)
        self.assertGreater(outcome["upper_floor"], 0)
        houses = [h["polygon"] for h in json.loads(run.bytes_of("manifest.json"))["resolved_scene"]["site"]["houses"]]
        for x, z in run.query("SELECT pos_x, pos_y FROM trajectory_data"):
            self.assertFalse(any(is_inside(house, x, z) for house in houses), (x, z))

    def test_columns_near_people_are_all_that_they_feel(self):
        """People that walk straight across the bank get the same water if only the columns near agents are sent."""
        group = {"name": "straight", "columns": 3, "start": {"x_m": 60, "z_m": 30, "pitch_x_m": 20},
                 "goal": {"x_m": 100, "z_m": 70}}
        lives = {"name": "lives", "start": {"from": "houses"}, "goal": {"x_m": 100, "z_m": 72}}
        paths = []
        for publish in ("all", "near_agents"):
            scene = json.loads(re.sub(r"^//.*$", "", self.scene.read_text(encoding="utf-8"), flags=re.M))
            scene["coupling"] = {"agents_stream": "serial"}
            scene["crowd"]["navigation"] = {"rule": "straight"}
            scene["crowd"]["groups"] = [group, lives]
            del scene["site"]["residents_csv"]
            scene["fluid"]["publish"] = publish
            file = self.folder / f"{publish}.json"
            file.write_text(json.dumps(scene))
            run = self.pair("--until-s", "12", scene=file)
            paths.append(run.rows())
            self.assertGreater(max(float(agent["max_depth_m"]) for agent in run.agents()), 0.1)
        self.assertEqual(paths[0], paths[1])


def is_inside(ring, x, z):
    inside = False
    for (ax, az), (bx, bz) in zip(ring, ring[1:] + ring[:1]):
        if (az > z) != (bz > z) and x < ax + (bx - ax) * (z - az) / (bz - az):
            inside = not inside
    return inside


class Standing(SystemTest):
    def scene(self, x_min_m=5, x_max_m=11, **crowd):
        """Four people before a box; it leaves a route round it or none."""
        box = {"x_min_m": x_min_m, "x_max_m": x_max_m, "z_min_m": 5, "z_max_m": 8, "height_m": 3}
        group = {"name": "g", "columns": 4, "start": {"x_m": 5.5, "z_m": 2}, "goal": {"x_m": 8, "z_m": 14}}
        scene = {
            "name": "before_a_box",
            "duration_s": 40,
            "frame_rate_hz": 5,
            "world": {"length_m": 20, "width_m": 20},
            "channel": {"x_min_m": 0, "x_max_m": 20, "z_min_m": 0, "z_max_m": 20, "flow": "closed"},
            "obstacles": [box],
            "fluid": {"model": "shallow_water", "max_particles": 1000},
            "crowd": {"goal_radius_m": 0.5, "groups": [group], **crowd},
        }
        file = self.folder / "scene.json"
        file.write_text(json.dumps(scene))
        return file

    def test_people_who_stand_are_counted_and_said_once_with_the_key_that_helps(self):
        scene = self.scene(navigation={"rule": "straight"})
        server, client = self.server(scene=scene), self.client(scene=scene)
        self.assert_ended_well(server, client)
        outcome = client.run.outcome()
        self.assertEqual(outcome["standing"], outcome["active"])
        self.assertGreater(outcome["standing"], 0)
        self.assertEqual(outcome["states"]["standing"], outcome["standing"])
        self.assertEqual(len(outcome["warnings"]), 1)
        self.assertIn("/crowd/navigation/rule", outcome["warnings"][0])
        self.assertEqual(client.messages().count("warning: " + outcome["warnings"][0]), 1)
        self.assertEqual([a["state"] for a in client.run.agents()].count("standing"), outcome["standing"])
        self.assertEqual(self.pair(scene=self.scene()).outcome()["arrived"], 4)

    def test_what_check_says_the_run_says(self):
        for settings, words in (
            ({"markers_per_cell": 8}, "/crowd/markers_per_cell"),
            ({"x_min_m": 0, "x_max_m": 20}, "without a way"),
        ):
            scene = self.scene(**settings)
            check = self.start(CLIENT, scene, "--check")
            self.assert_ended_well(check)
            check.output.seek(0)
            said = [line for line in check.output.read().splitlines() if line.startswith("warning: ")]
            self.assertEqual(len(said), 1)
            self.assertIn(words, said[0])
            until = ["--until-s", "1"]
            server, client = self.server(*until, scene=scene), self.client(*until, scene=scene)
            self.assert_ended_well(server, client)
            self.assertIn(said[0], client.messages())
            self.assertEqual(client.run.outcome()["warnings"], [said[0].removeprefix("warning: ")])


class Measured(SystemTest):
    SETTINGS = (
        "--set",
        "/crowd/response=measured",
        "--set",
        "/crowd/skill=poor",
        "--set",
        '/crowd/height_m={"min": 1.5, "max": 1.9}',
    )

    def test_people_answer_by_their_bodies_in_each_water_and_with_each_kind_of_body(self):
        states = set()
        for model, bodies in (
            ("dfsph", "none"),
            ("kinematic", "fast"),
            ("shallow_water", "human"),
            ("steering", "none"),
            ("mixed", "none"),
        ):
            with self.subTest(model=model, bodies=bodies):
                settings = ["--set", f"/fluid/model={model}", "--set", f"/crowd/bodies={bodies}", *self.SETTINGS]
                settings += ["--set", "/crowd/markers=redrawn", "--set", "/coupling/agents_stream=serial"]
                run = self.pair(*settings)
                outcome, people = run.outcome(), run.agents()
                self.assertEqual(sum(outcome["states"].values()), 6)
                self.assertIn("drowned", outcome["states"])
                self.assertEqual(outcome["walking_in_water"], "relative")
                self.assertEqual(set(outcome["beyond_measured"]), {"people", "time_s"})
                heights = [float(a["height_m"]) for a in people]
                self.assertTrue(all(1.5 <= h <= 1.9 for h in heights) and len(set(heights)) == 6)
                self.assertEqual(outcome["dead"], sum(a["outcome"] == "dead" for a in people))
                states |= {a["state"] for a in people}
                # Water of 0.5 m/s, 1 m deep, makes feet of friction 0.07 slip and topples these people.
                self.assertGreater(sum(float(a["max_depth_m"]) > 0.5 for a in people), 0)

    def test_people_tire_in_cold_water_beside_those_whose_tau_is_given_in_time(self):
        points = [{"time_s": 0, "tau": 0}, {"time_s": 0.5, "tau": 0.4}, {"time_s": 1, "tau": 0.1}]
        told = {"name": "told", "start": {"x_m": 8, "z_m": 5}, "goal": {"x_m": 8, "z_m": 12}, "tau_history": points}
        tires = {"name": "tires", "rows": 3, "start": {"x_m": 12, "z_m": 5}, "goal": {"x_m": 14, "z_m": 12}}
        changes = {"groups": [told, tires], "fatigue": True, "water_temperature_c": 5, "can_swim": True}
        settings = ["--set", "/fluid/model=shallow_water", *self.SETTINGS]
        for key, value in changes.items():
            settings += ["--set", f"/crowd/{key}={json.dumps(value)}"]
        run = self.pair(*settings)
        self.assertEqual(sum(run.outcome()["states"].values()), 4)
        self.assertEqual(float(run.agents()[0]["tau"]), 0.1)



if __name__ == "__main__":
    unittest.main()
