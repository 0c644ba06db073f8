"""The crowd with a producer that is no fluid solver: one that is known exactly, and ones that misbehave."""

import math
import signal
import unittest

from harness import ENDLESS, SCENES, SystemTest

ONE_AGENT = SCENES / "one_agent.json"
# test_producer.cpp
PITCH, PARTICLE_MASS = 0.125, 16.0
# one_agent.json
FLOW, AGENT_MASS, DESIRED_SPEED, TAU, CONTACT, FRAME_RATE = -1.5, 65.0, 1.3, 0.5, 0.25, 30.0


def contact_mass(x, z):
    """Mass of the grid's particles closer than the contact distance, counted one by one."""

    def near(centre):
        first = math.floor((centre - CONTACT) / PITCH) - 1
        return [(i + 0.5) * PITCH for i in range(first, first + int(2 * CONTACT / PITCH) + 4)]

    return PARTICLE_MASS * sum(math.hypot(x - px, z - pz) < CONTACT for px in near(x) for pz in near(z))


class UniformStream(SystemTest):
    def velocities(self, *settings):
        """Positions before each move and the velocities of the moves of the only agent."""
        arguments = [word for setting in settings for word in ("--set", setting)]
        producer = self.producer(*arguments, scene=ONE_AGENT)
        client = self.client(*arguments, scene=ONE_AGENT)
        self.assert_ended_well(producer, client)
        path = [(x, z) for _, _, x, z, *_ in client.run.rows()]
        return [
            (before, tuple((b - a) * FRAME_RATE for a, b in zip(before, after)))
            for before, after in zip(path, path[1:])
        ]

    def assert_near(self, value, expected):
        # 1e-5 m/s is asked for; positions are doubles near 20 m, so that 30 differences a second carry 2e-13 m/s.
        self.assertLessEqual(abs(value - expected), 1e-5)

    def test_first_move_is_the_closed_form_of_equation_9(self):
        """v = (m_a v_B + tau m_c v_F) / (m_a + tau m_c), v_B taken from the same agent with tau = 0."""
        for x, z in ((15.03, 4.01), (12.37, 9.61), (3.21, 14.44), (17.9, 2.23)):
            start = [f"/crowd/groups/0/start/x_m={x}", f"/crowd/groups/0/start/z_m={z}", "/duration_s=0.1"]
            (_, walking), *_ = self.velocities(*start, "/crowd/groups/0/tau=0")
            self.assert_near(math.hypot(*walking), DESIRED_SPEED)
            m_c = contact_mass(x, z)
            self.assertGreater(m_c, 100, "the agent stands in the water")
            for tau in (0.1, 0.5, 1.0):
                with self.subTest(x=x, z=z, tau=tau):
                    (_, moved), *_ = self.velocities(*start, f"/crowd/groups/0/tau={tau}")
                    total = AGENT_MASS + tau * m_c
                    self.assert_near(moved[0], (AGENT_MASS * walking[0] + tau * m_c * FLOW) / total)
                    self.assert_near(moved[1], AGENT_MASS * walking[1] / total)

    def test_every_move_solved_for_walking_gives_the_desired_speed(self):
        moves = self.velocities()
        self.assertEqual(len(moves), 60)
        masses = set()
        for (x, z), (vx, vz) in moves:
            m_c = contact_mass(x, z)
            masses.add(m_c)
            total = AGENT_MASS + TAU * m_c
            walking = ((vx * total - TAU * m_c * FLOW) / AGENT_MASS, vz * total / AGENT_MASS)
            self.assert_near(math.hypot(*walking), DESIRED_SPEED)
        self.assertGreater(len(masses), 1, "the agent crossed the grid")


class Misbehaviour(SystemTest):
    def test_velocity_that_is_no_number_ends_the_client(self):
        producer = self.producer("--nan-at-frame", "7", scene=ONE_AGENT)
        client = self.client(scene=ONE_AGENT)
        self.assert_ends(client, 6, "rame 7", "vx", "test_producer")
        outcome, last = self.assert_complete_records(client.run, "protocol_violation")
        self.assertEqual((outcome["frames"], last), (6, 6))
        self.assert_ends(producer, 5, "rame 7")

    def test_silent_producer_is_a_step_timeout(self):
        producer = self.producer("--silent-after-frame", "5", scene=ONE_AGENT)
        client = self.client("--step-timeout-s", "1.5", scene=ONE_AGENT)
        self.assert_ends(client, 7, "frame 6", "test_producer")
        outcome, last = self.assert_complete_records(client.run, "step_timeout")
        self.assertEqual((outcome["frames"], last), (5, 5))
        producer.send(signal.SIGTERM)
        self.assert_ended_well(producer)

    def test_producer_of_another_scene_is_refused(self):
        producer = self.producer("--other-scene", scene=ONE_AGENT)
        client = self.client(scene=ONE_AGENT)
        self.assert_ends(client, 6, "different scenes")
        self.assert_ends(producer, 5, "different scenes")

    def test_silent_crowd_is_a_step_timeout_of_the_server(self):
        server = self.server(*ENDLESS, "--step-timeout-s", "1.5")
        self.wait_for_segment()
        client = self.client(*ENDLESS)
        self.wait_for_frame(1, server, client)
        self.stop(client)
        self.assert_ends(server, 7, "crowd")
        client.send(signal.SIGCONT)
        self.assert_ends(client, 5)


if __name__ == "__main__":
    unittest.main()
