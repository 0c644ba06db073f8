"""tools/wade many with the engines that hand out its runs: Slurm with two nodes of this machine, GNU parallel, Open MPI.

And one water over ranks. Each is skipped where it is not installed; tools/test.sh --all installs them.
"""

import contextlib
import os
import shlex
import signal
import socket
import subprocess
import tempfile
import unittest
from pathlib import Path

from ensemble_test import EnsembleTest
from harness import ENDLESS, PROGRAMS, SMALL, Launcher, Run, alive, children_of, command_of, wait_until

from wade.ensembles.one import worker_command
from wade.outside import works
from wade.paths import CONFIGS, module_command

PLAN = (SMALL, "--seeds", "1-6", "--share", "2", "--reproducible", "--resume")
# Some seconds each, long enough to be disturbed.
LONG = ("--", "--until-s", "120", "--set", "/stop_when_no_agent_is_active=false")
LOCAL_MPI = "--allow-run-as-root --oversubscribe"  # as root, with more ranks than processors

CONFIGURATION = """ClusterName=wade
SlurmctldHost={host}(127.0.0.1)
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
CryptoType=crypto/munge
SlurmUser=root
SlurmdUser=root
SlurmctldPort={ports[0]}
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool.%n
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.%n.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SchedulerType=sched/backfill
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
ReturnToService=1
MpiDefault=none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
NodeName=n1 NodeHostname={host} NodeAddr=127.0.0.1 Port={ports[1]} CPUs=1 State=UNKNOWN
NodeName=n2 NodeHostname={host} NodeAddr=127.0.0.1 Port={ports[2]} CPUs=1 State=UNKNOWN
PartitionName=wade Nodes=n1,n2 Default=YES MaxTime=INFINITE State=UP
"""


def free_ports(count):
    with contextlib.ExitStack() as stack:
        sockets = [stack.enter_context(socket.socket()) for _ in range(count)]
        for one in sockets:
            one.bind(("127.0.0.1", 0))
        return [one.getsockname()[1] for one in sockets]


class TwoNodes:
    """A Slurm of its own: munge, a controller and two nodes, in a folder."""

    def __init__(self, folder):
        self.folder, self.daemons = folder, []
        (folder / "state").mkdir(parents=True)
        key = folder / "munge.key"
        key.write_bytes(os.urandom(1024))
        key.chmod(0o400)
        conf = folder / "slurm.conf"
        conf.write_text(CONFIGURATION.format(host=socket.gethostname(), folder=folder, ports=free_ports(3)))
        self.environment = {**os.environ, "SLURM_CONF": str(conf)}
        named = [f"--{name}-file={folder}/munged.{name}" for name in ("pid", "log", "seed")]
        self.start("munged", "--foreground", "--force", f"--key-file={key}", f"--socket={folder / 'munge.socket'}", *named)
        wait_until((folder / "munge.socket").exists, "munge")
        self.start("slurmctld", "-D", "-c")
        for node in ("n1", "n2"):
            self.start("slurmd", "-D", "-N", node)
        wait_until(lambda: self.states() == {"n1": "idle", "n2": "idle"}, "two idle nodes")

    def start(self, *command):
        with open(self.folder / "daemons.log", "ab") as log:
            self.daemons.append(subprocess.Popen(command, env=self.environment, stdout=log, stderr=log))

    def ask(self, *command):
        return subprocess.run(command, env=self.environment, capture_output=True, text=True).stdout

    def states(self):
        return dict(line.split() for line in self.ask("sinfo", "--noheader", "--Node", "--format", "%N %t").splitlines())

    def tasks(self, state="RUNNING"):
        """{task, as scontrol names it: its node}."""
        lines = self.ask("squeue", "--noheader", "--array", "--states", state, "--format", "%i %N").splitlines()
        return dict((line.split() + [""])[:2] for line in lines)

    def hurry(self, task):
        """Slurm lets a task that was requeued wait for two minutes; this test does not."""
        wait_until(lambda: task in self.tasks("PENDING"), "the task to be queued again")
        self.ask("scontrol", "update", f"jobid={task}", "starttime=now")

    def end(self):
        self.ask("scancel", "--user", "root")
        for daemon in reversed(self.daemons):
            daemon.terminate()
        for daemon in reversed(self.daemons):
            daemon.wait(60)


@unittest.skipUnless(works("slurmctld", "slurmd", "sbatch", "munged") and os.geteuid() == 0, "no Slurm, or not root")
class Slurm(EnsembleTest):
    @classmethod
    def setUpClass(cls):
        cls.temporary_home = tempfile.TemporaryDirectory(prefix="wade-slurm-")
        cls.nodes = TwoNodes(Path(cls.temporary_home.name) / "slurm")

    @classmethod
    def tearDownClass(cls):
        cls.nodes.end()
        cls.temporary_home.cleanup()

    def many(self, *arguments, out="many"):
        command = (*module_command("wade.many"), "--jobs", "2", "--out", self.folder / out, *arguments)
        environment = {**self.nodes.environment, "WADE_BUILD": str(PROGRAMS)}
        return self.start(*command, cwd=self.folder, env=environment)

    def disturbed(self, disturb):
        """Returns the table of an ensemble after disturb() acts on its running array of tasks."""
        many = self.many("--engine", "slurm", *PLAN, *LONG)
        wait_until(lambda: len(self.nodes.tasks()) == 2 or not many.running(), "two tasks to run")
        logs = self.folder / "many" / "work"
        wait_until(lambda: sum("t 0.0/" in log.read_text() for log in logs.glob("*/water/fluid_server.log")) == 2
                   or not many.running(), "two waters to flow")
        self.assertTrue(many.running(), many.messages())
        disturb(self.nodes.tasks())
        self.assert_ended_well(many)
        self.assert_nothing_left()
        return self.table()

    def test_an_array_over_two_nodes_gives_the_table_of_this_machine(self):
        self.assert_ended_well(self.many("--engine", "slurm", *PLAN))
        self.assertEqual(self.table(), self.undisturbed(*PLAN))
        nodes = {self.nodes.ask("scontrol", "show", "job", job).partition("BatchHost=")[2].split()[0]
                 for job in self.nodes.ask("squeue", "--noheader", "--array", "--states", "all", "--format", "%A").split()}
        self.assertEqual(nodes, {"n1", "n2"})

    def test_a_task_that_is_requeued_in_mid_run_changes_nothing(self):
        def requeue(tasks):
            task = next(iter(tasks))
            self.nodes.ask("scontrol", "requeue", task)
            self.nodes.hurry(task)

        self.assertEqual(self.disturbed(requeue), self.undisturbed(*PLAN, *LONG))

    def test_a_node_that_is_lost_changes_nothing(self):
        def lose(tasks):
            task, node = next(iter(tasks.items()))
            self.nodes.ask("scontrol", "update", f"nodename={node}", "state=down", "reason=test")
            self.nodes.hurry(task)
            wait_until(lambda: task in self.nodes.tasks(), "the task to run on the other node")
            self.assertNotEqual(self.nodes.tasks().get(task), node)
            self.nodes.ask("scontrol", "update", f"nodename={node}", "state=resume")

        self.assertEqual(self.disturbed(lose), self.undisturbed(*PLAN, *LONG))

    def test_a_command_that_is_killed_leaves_its_job_which_is_waited_for(self):
        many = self.many("--engine", "slurm", *PLAN, *LONG)
        wait_until(lambda: len(self.nodes.tasks()) == 2 or not many.running(), "two tasks to run")
        many.send(signal.SIGKILL)
        many.wait()
        self.assert_ends(self.many("--engine", "slurm", *PLAN, *LONG), 2, "is not over", "scancel")
        wait_until(lambda: not self.nodes.tasks("PENDING,RUNNING,COMPLETING"), "the job to end")
        made = self.run_of(1).folder.stat().st_ino
        self.assert_ended_well(self.many("--engine", "slurm", *PLAN, *LONG))
        self.assertEqual(self.run_of(1).folder.stat().st_ino, made)
        self.assertEqual(self.table(), self.undisturbed(*PLAN, *LONG))

    def test_an_interrupt_ends_the_job_and_the_ensemble_goes_on(self):
        many = self.many("--engine", "slurm", *PLAN, "--", *ENDLESS)
        wait_until(lambda: len(self.nodes.tasks()) == 2 or not many.running(), "two tasks to run")
        many.send(signal.SIGTERM)
        self.assert_ends(many, 143, "--resume goes on")
        self.assertEqual(self.nodes.tasks("PENDING,RUNNING,COMPLETING"), {})
        self.assert_nothing_left()


@unittest.skipUnless(works("parallel"), "GNU parallel is not installed")
class Parallel(EnsembleTest):
    def test_gives_the_table_of_this_machine(self):
        self.assert_ended_well(self.many("--engine", "parallel", *PLAN))
        self.assertEqual(self.table(), self.undisturbed(*PLAN))

    def test_by_hand_its_own_resume_runs_nothing_twice(self):
        self.assert_ended_well(self.many(*PLAN, "--prepare"))
        worker = shlex.join(map(str, (*worker_command(), self.folder / "many" / "plan.csv"))) + " {}"
        command = ("parallel", "--will-cite", "-j2", "--joblog", self.folder / "log", "--resume", worker, ":::")
        self.assert_ended_well(self.script(*command, "1", "3"))
        self.assert_ended_well(self.script(*command, "1", "3", "5"))
        log = (self.folder / "log").read_text().splitlines()[1:]
        self.assertEqual(sorted(line.split()[0] for line in log), ["1", "2", "3"])
        self.assert_ended_well(self.many("--gather", "--reproducible"))
        self.assertEqual(self.table(), self.undisturbed(*PLAN))

    def test_kills_change_nothing(self):
        self.assert_kills_change_nothing(20, "--engine", "parallel", *PLAN)

    def test_an_interrupt_ends_all(self):
        many = self.many("--engine", "parallel", *PLAN, "--", *ENDLESS)
        wait_until(lambda: programs_below(many) == 4 or not many.running(), "two pairs to run")
        self.assert_ends_with_children(many, signal.SIGTERM, 143)
        self.assert_nothing_left()


@unittest.skipUnless(works("mpirun"), "Open MPI is not installed")
class Mpirun(EnsembleTest):
    MPI = ("--engine", "mpirun", "--engine-options", LOCAL_MPI)

    def test_gives_the_table_of_this_machine(self):
        self.assert_ended_well(self.many(*self.MPI, *PLAN))
        self.assertEqual(self.table(), self.undisturbed(*PLAN))

    def test_a_dead_rank_ends_its_round_and_changes_nothing(self):
        many = self.many(*self.MPI, *PLAN, *LONG)
        wait_until(lambda: programs_below(many) == 4 or not many.running(), "two pairs to run")
        ranks = [pid for pid in children_of(many.process.pid) if "wade.ensembles.one" in command_of(pid)]
        ranks = [pid for pid in ranks if "mpirun" not in command_of(pid)]
        os.kill(ranks[0], signal.SIGKILL)
        self.assert_ended_well(many)
        self.assertIn("once more", many.messages())
        self.assertEqual(self.table(), self.undisturbed(*PLAN, *LONG))
        self.assert_nothing_left()

    def test_an_interrupt_ends_all(self):
        many = self.many(*self.MPI, *PLAN, "--", *ENDLESS)
        wait_until(lambda: programs_below(many) == 4 or not many.running(), "two pairs to run")
        self.assert_ends_with_children(many, signal.SIGTERM, 143)
        self.assert_nothing_left()


@unittest.skipUnless(works("mpirun") and os.access(PROGRAMS / "fluid_server_ranks", os.X_OK),
                     "Open MPI is not installed, or was not when this was configured")
class Ranks(Launcher):
    """One water over several ranks (tools/wade run --ranks)."""

    def run_over(self, ranks, scene, *options):
        folder = self.folder / f"run{next(self.run_numbers)}"
        over = ("--ranks", str(ranks), "--mpirun", LOCAL_MPI) if ranks else ()
        program = self.script(*module_command("wade.run.pair"), scene, "--no-figure", "--session", self.session, "--out", folder,
                              *over, *options)
        program.run = Run(folder)
        return program

    def bits(self, ranks, scene, *options):
        program = self.run_over(ranks, scene, *options)
        self.assert_ended_well(program)
        return program.run.outcome()["frame_hash"], program.run.bytes_of("agents.csv")

    def test_any_number_of_ranks_and_threads_gives_the_same_bits(self):
        for scene, until in ((CONFIGS / "models" / "shallow_water_s05.json", "1"), (CONFIGS / "sites" / "hamlet.json", "2"),
                             (CONFIGS / "sites" / "village" / "village.json", "2")):
            alone = self.bits(0, scene, "--until-s", until, "--threads", "1")
            for ranks, threads in ((1, 1), (2, 1), (2, 2), (3, 1), (4, 1)):
                with self.subTest(scene=scene.stem, ranks=ranks, threads=threads):
                    self.assertEqual(self.bits(ranks, scene, "--until-s", until, "--threads", threads), alone)

    def started(self):
        """A run that goes on, and {rank: process}."""
        run = self.run_over(3, CONFIGS / "models" / "shallow_water_s05.json", *ENDLESS, "--threads", "1")
        wait_until(lambda: self.published_frame() > 3 or not run.running(), "the water to flow")
        self.assertTrue(run.running(), run.messages())
        ranks = {}
        for pid in children_of(run.process.pid):
            if command_of(pid).split("\0")[0].endswith("fluid_server_ranks"):
                words = Path(f"/proc/{pid}/environ").read_text().split("\0")
                ranks[next(int(word.partition("=")[2]) for word in words if word.startswith("OMPI_COMM_WORLD_RANK="))] = pid
        self.assertEqual(sorted(ranks), [0, 1, 2])
        return run, ranks

    def assert_all_ended(self, run, ranks):
        wait_until(lambda: not any(map(alive, ranks.values())), "all ranks to end")
        self.assertEqual(list(Path("/dev/shm").glob(f"{self.session}*")), [])

    def test_a_dead_rank_ends_the_run_and_the_crowd_is_told(self):
        run, ranks = self.started()
        os.kill(ranks[2], signal.SIGKILL)
        self.assert_ends(run, 128 + signal.SIGKILL, f"rank 2 of 3 (process {ranks[2]}) has died")
        self.assertEqual(run.run.outcome()["status"], "peer_aborted")
        self.assert_all_ended(run, ranks)

    def test_a_crowd_that_dies_ends_all_ranks(self):
        run, ranks = self.started()
        crowd = [pid for pid in children_of(run.process.pid) if command_of(pid).split("\0")[0].endswith("crowd_client")]
        os.kill(crowd[0], signal.SIGKILL)
        self.assert_ends(run, 128 + signal.SIGKILL, "died at frame")
        self.assert_all_ended(run, ranks)

    def test_an_interrupt_ends_all(self):
        run, ranks = self.started()
        run.send(signal.SIGTERM)
        self.assertEqual(run.wait(), 143, run.messages())
        self.assert_all_ended(run, ranks)

    def test_what_cannot_go_over_ranks_is_refused(self):
        for scene, options, text in ((SMALL, ("--set", "/fluid/model=dfsph"), "allowed over ranks: shallow_water"),
                                     (SMALL, ("--set", "/fluid/model=auto"), "allowed over ranks: shallow_water"),
                                     (SMALL, ("--set", "/fluid/model=shallow_water"), "rows a rank and more")):
            with self.subTest(options=options):
                self.assert_ends(self.run_over(40, scene, *options), 2, text)


def programs_below(many):
    """How many servers and crowds a command has started."""
    commands = [command_of(pid).split("\0")[0] for pid in children_of(many.process.pid) if alive(pid)]
    return sum(command.endswith(("fluid_server", "crowd_client")) for command in commands)


if __name__ == "__main__":
    unittest.main()
