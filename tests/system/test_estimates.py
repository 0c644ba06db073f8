"""What --check says that a run will take: particles, memory, time; and that what is not there is refused before it is taken."""

import os
import re
import resource
import subprocess

from harness import CLIENT, ROOT, SMALL, SystemTest

# Scenes of every model, large enough that the water is most of what the server holds.
WATERS = {
    "dfsph": ["bench/dam_break.json", "--set", "/fluid/particle_spacing_m=0.03", "--set", "/fluid/max_particles=40000"],
    "dfsph, wide kernel": [
        *("bench/dam_break.json", "--set", "/fluid/particle_spacing_m=0.03", "--set", "/fluid/max_particles=40000"),
        *("--set", "/fluid/kernel=wendland_c2"),
    ],
    "kinematic": ["observed/s09.json", "--set", "/fluid/particle_spacing_m=0.2", "--set", "/fluid/max_particles=400000"],
    "shallow_water": ["models/shallow_water_obstacle.json", "--set", "/fluid/shallow_water/cell_size_m=0.1"],
    "steering": [
        *("models/container.json", "--set", "/fluid/particle_spacing_m=0.025", "--set", "/fluid/max_particles=49152"),
    ],
}
SAID = re.compile(r"the water: at most (\d+) particles, ([\d.]+) (MB|GB) of memory, (about|less than) .* of CPU time")


class Estimates(SystemTest):
    def said_of(self, scene, *arguments):
        """Particles and bytes by --check."""
        check = self.server("--check", *arguments, scene=scene)
        self.assert_ended_well(check)
        found = SAID.search(self.text_of(check))
        self.assertIsNotNone(found, self.text_of(check))
        return int(found[1]), float(found[2]) * {"MB": 1e6, "GB": 1e9}[found[3]]

    def text_of(self, program):
        program.output.seek(0)
        return program.output.read()

    def test_memory_of_every_model_is_known_to_a_factor_of_two(self):
        for name, (scene, *arguments) in WATERS.items():
            with self.subTest(name):
                scene = ROOT / "configs" / scene
                particles, memory = self.said_of(scene, *arguments)
                server = self.server(*arguments, "--consumers", "0", "--until-s", "0.1", scene=scene)
                self.assert_ended_well(server)
                measured = float(re.search(r"memory (\d+) MB", server.messages())[1]) * 1e6
                self.assertLess(measured / 2, memory)
                self.assertLess(memory, 2 * measured)
                self.assertGreater(particles, 0)

    def test_memory_that_is_not_there_is_refused_by_check_and_by_the_run(self):
        too_much = ["--set", "/fluid/max_particles=100000000"]

        def have_two_gigabytes():
            resource.setrlimit(resource.RLIMIT_AS, (2**31, 2**31))

        for question in (["--check"], ["--consumers", "0"]):
            with self.subTest(question):
                server = self.server(*too_much, *question, preexec_fn=have_two_gigabytes)
                self.assert_ends(server, 2, str(SMALL), "GB of memory", "are left; lower /fluid/max_particles")

    def test_memory_of_a_crowd_is_known_to_a_factor_of_two_and_refused_if_it_is_not_there(self):
        wide = ["--set", "/world/length_m=800", "--set", "/world/width_m=600"]
        people = ["--set", "/crowd/groups/0/columns=400", "--set", "/crowd/groups/0/rows=200",
                  "--set", "/crowd/groups/0/start/pitch_x_m=0.3", "--set", "/crowd/groups/0/start/pitch_z_m=0.3"]  # fmt: skip
        redrawn = ["--set", "/crowd/markers=redrawn"]
        for arguments in ([], wide, [*wide, *people], [*people, *redrawn, *wide]):
            with self.subTest(arguments):
                command = [CLIENT, SMALL, "--check", *arguments]
                with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as check:
                    text = check.stdout.read()
                    _, status, used = os.wait4(check.pid, 0)
                    check.returncode = os.waitstatus_to_exitcode(status)
                self.assertEqual(check.returncode, 0, text)
                said = 1e6 * float(re.search(r"the crowd: \d+ agents, (\d+) MB of memory", text)[1])
                measured = 1024 * used.ru_maxrss
                self.assertLess(measured / 2, said)
                self.assertLess(said, 2 * measured)

        def have_two_gigabytes():
            resource.setrlimit(resource.RLIMIT_AS, (2**31, 2**31))

        huge = ["--set", "/world/length_m=3000", "--set", "/world/width_m=3000"]
        client = self.client(*huge, "--check", preexec_fn=have_two_gigabytes)
        self.assert_ends(client, 2, str(SMALL), "the crowd: 6 agents", "GB of memory", "are left", "/crowd/markers redrawn")

    def test_check_reads_the_state_to_go_on_from_as_the_run_does(self):
        for question in (["--check"], ["--consumers", "0"]):
            with self.subTest(question):
                server = self.server("--from-state", SMALL, *question)
                self.assert_ends(server, 2, str(SMALL))
