"""What the system tests share: the two programs as processes, a session of their own, and a look at its segment.

The programs are found in the folder that WADE_PROGRAMS names. Nothing here measures time: waits end when a condition
holds, and the time-outs only keep a broken program from blocking the tests.
"""

import contextlib
import csv
import itertools
import json
import os
import re
import secrets
import signal
import sqlite3
import struct
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

from wade import cli

ROOT = Path(__file__).resolve().parents[2]
SCENES = Path(__file__).resolve().parent / "scenes"
SMALL = SCENES / "small.json"
PROGRAMS = Path(os.environ.get("WADE_PROGRAMS", ROOT / "build" / "release"))
SERVER, CLIENT = PROGRAMS / "fluid_server", PROGRAMS / "crowd_client"
PRODUCER = Path(os.environ.get("WADE_TEST_PRODUCER", PROGRAMS / "tests" / "system" / "test_producer"))
# Far more than any test takes, also with sanitizers on a busy machine.
SAFETY_NET_S = 120

# A run that lasts until something ends it.
ENDLESS = ["--until-s", "5000", "--set", "/stop_when_no_agent_is_active=false"]

# A site of 24 x 16 m that is run in a moment.
BASIN = {
    "description": "Water beside a slope with a house, which a source fills.", "duration_s": 4, "frame_rate_hz": 10,
    "world": {"length_m": 24, "width_m": 16},
    "site": {"epsg": 32632, "origin_easting_m": 500000, "origin_northing_m": 5300000,
              "ground": {"level_m": -0.5, "slope_z": 0.08}, "water": [{"level_m": 0}],
              "houses": [{"polygon": [[8, 2], [12, 2], [12, 5], [8, 5]]}],
              "sources": [{"polygon": [[0, 0], [6, 0], [6, 8], [0, 8]], "discharge_m3_s": 6}]},
    "fluid": {"shallow_water": {"cell_size_m": 1}}, "stop_when_no_agent_is_active": False,
}

# shm_protocol/layout.hpp: of the control block and of the first consumer.
PUBLISHED_FRAME, ACKNOWLEDGED_FRAME, CONSUMER_WAITING = 4096 + 8, 3 * 4096 + 8, 3 * 4096 + 16


def wait_until(condition, what):
    """Polls until the condition holds."""
    deadline = time.monotonic() + SAFETY_NET_S
    while not condition():
        if time.monotonic() > deadline:
            raise AssertionError(f"gave up waiting for {what}")
        time.sleep(0.001)


def unwrapped(text):
    """Messages in one line each, which the console breaks at 100 columns and indents."""
    return re.sub(r"\n {2,}", " ", text)


def children_of(pid):
    """The processes below a process, itself not included."""
    try:
        lists = [task.read_text() for task in Path(f"/proc/{pid}/task").glob("*/children")]
    except (FileNotFoundError, ProcessLookupError):  # it has ended meanwhile
        return []
    children = [int(child) for text in lists for child in text.split()]
    return children + [below for child in children for below in children_of(child)]


def alive(pid):
    """Whether the process runs; one that has ended and was not yet waited for does not."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] not in "ZX"
    except FileNotFoundError:
        return False


def command_of(pid):
    try:
        return Path(f"/proc/{pid}/cmdline").read_text()
    except FileNotFoundError:
        return ""


class Program:
    """A running program. Its messages go to a file, so that it never waits for a reader."""

    def __init__(self, command, folder, **options):
        self.name = Path(command[0]).name
        self.errors = tempfile.TemporaryFile("w+", dir=folder)
        self.output = tempfile.TemporaryFile("w+", dir=folder)
        self.process = subprocess.Popen(
            list(map(str, command)), stdin=subprocess.DEVNULL, stdout=self.output, stderr=self.errors, **options
        )

    def wait(self):
        """The exit code, -N if signal N ended it."""
        return self.process.wait(SAFETY_NET_S)

    def running(self):
        return self.process.poll() is None

    def send(self, number):
        self.process.send_signal(number)

    def stopped(self):
        stat = Path(f"/proc/{self.process.pid}/stat").read_text()
        return stat.rsplit(")", 1)[1].split()[0] == "T"

    def messages(self):
        """What the program said, each message in one line, however the console broke it."""
        self.errors.seek(0)
        return unwrapped(self.errors.read())

    def close(self):
        if self.running():
            self.process.kill()
        self.process.wait()
        self.errors.close()
        self.output.close()


class Run:
    """The records of a run folder."""

    def __init__(self, folder):
        self.folder = folder

    def bytes_of(self, name):
        return (self.folder / name).read_bytes()

    def outcome(self):
        return json.loads(self.bytes_of("outcome.json"))

    def agents(self):
        with open(self.folder / "agents.csv", newline="", encoding="utf-8") as file:
            return list(csv.DictReader(file))

    def query(self, sql):
        database = sqlite3.connect(f"file:{self.folder / 'trajectories.sqlite'}?mode=ro", uri=True)
        try:
            return database.execute(sql).fetchall()
        finally:
            database.close()

    def rows(self):
        return self.query("SELECT * FROM trajectory_data ORDER BY frame, id")


class SystemTest(unittest.TestCase):
    """Gives each test a session and a folder, ends what it started, and looks for segments left behind."""

    maxDiff = 2000

    def setUp(self):
        self.session = f"wade-system-{os.getpid()}-{secrets.token_hex(4)}"
        self.temporary = tempfile.TemporaryDirectory(prefix="wade-test-")
        self.folder = Path(self.temporary.name)
        self.programs = []
        self.mounts = []
        self.run_numbers = itertools.count(1)

    def tearDown(self):
        for program in self.programs:
            program.close()
        for mount in self.mounts:
            subprocess.run(["umount", mount], check=True)
        left = list(Path("/dev/shm").glob(f"{self.session}*"))
        for segment in left:
            segment.unlink()
        self.temporary.cleanup()
        self.assertEqual(left, [], "segments left in /dev/shm")

    def start(self, *command, **options):
        program = Program(command, self.folder, **options)
        self.programs.append(program)
        return program

    def server(self, *arguments, scene=SMALL, **options):
        return self.start(SERVER, scene, "--session", self.session, *arguments, **options)

    def client(self, *arguments, scene=SMALL, out=None, **options):
        out = out or self.folder / f"run{next(self.run_numbers)}"
        program = self.start(CLIENT, scene, "--session", self.session, "--out", out, *arguments, **options)
        program.run = Run(out)
        return program

    def producer(self, *arguments, scene=SMALL):
        return self.start(PRODUCER, scene, "--session", self.session, *arguments)

    def pair(self, *arguments, scene=SMALL):
        """Runs both programs to their end, which must be a good one; returns the run."""
        server, client = self.server(*arguments, scene=scene), self.client(*arguments, scene=scene)
        self.assert_ended_well(server, client)
        return client.run

    def assert_ended_well(self, *programs):
        for program in programs:
            self.assertEqual(program.wait(), 0, f"{program.name}: {program.messages()}")

    def assert_ends(self, program, code, *texts):
        """The program ends with this exit code and its messages contain the texts."""
        self.assertEqual(program.wait(), code, f"{program.name}: {program.messages()}")
        for text in texts:
            self.assertIn(text, program.messages())

    def assert_refused_here(self, *command, texts=()):
        """tools/wade refuses this command line in this process, which saves the start of one."""
        with tempfile.TemporaryFile("w+", dir=self.folder) as said:
            with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
                try:
                    code = cli.main(list(map(str, command)))
                except SystemExit as end:
                    code = end.code
            said.seek(0)
            messages = unwrapped(said.read())
        self.assertEqual(code, 2, messages)
        for text in texts:
            self.assertIn(text, messages)
        self.assertNotIn("Traceback", messages)

    def word(self, offset, form):
        """A word of the session's segment; 0 while there is none."""
        try:
            with open(f"/dev/shm/{self.session}-fluid", "rb") as segment:
                segment.seek(offset)
                data = segment.read(struct.calcsize(form))
        except FileNotFoundError:
            return 0
        return struct.unpack(form, data)[0] if len(data) == struct.calcsize(form) else 0

    def published_frame(self):
        return self.word(PUBLISHED_FRAME, "<Q")

    def wait_for_frame(self, frame, *programs):
        wait_until(
            lambda: self.published_frame() >= frame or not all(p.running() for p in programs), f"frame {frame}"
        )
        for program in programs:
            self.assertTrue(program.running(), f"{program.name} ended early: {program.messages()}")

    def acknowledged_frame(self):
        return self.word(ACKNOWLEDGED_FRAME, "<Q")

    def wait_for_segment(self):
        wait_until(lambda: self.word(0, "<Q") != 0, "the segment")

    def kill_server(self, server):
        """A server that is killed cannot remove its segment; the next one of that name takes it over."""
        server.send(signal.SIGKILL)
        self.assertEqual(server.wait(), -signal.SIGKILL)

    def remove_segment_of_killed_server(self):
        Path(f"/dev/shm/{self.session}-fluid").unlink()

    def stop(self, program):
        program.send(signal.SIGSTOP)
        wait_until(program.stopped, f"{program.name} to stop")

    def assert_complete_records(self, run, status):
        """outcome.json, agents.csv and trajectories.sqlite agree with one another, up to the last whole frame."""
        outcome = run.outcome()
        self.assertEqual(outcome["status"], status)
        self.assertEqual(outcome["arrived"] + outcome["dead"] + outcome["active"], outcome["agents"])
        agents = run.agents()
        self.assertEqual(len(agents), outcome["agents"])
        self.assertEqual(run.query("PRAGMA integrity_check"), [("ok",)])
        self.assertEqual(run.query("SELECT value FROM metadata WHERE key = 'version'"), [("2",)])
        per_frame = dict(run.query("SELECT frame, COUNT(*) FROM trajectory_data GROUP BY frame"))
        last = max(per_frame)
        # Logged frames are whole: an agent has a row in every frame up to the first since its end and in none after it.
        rate = float(run.query("SELECT value FROM metadata WHERE key = 'fps'")[0][0])
        for frame, count in per_frame.items():
            present = [a for a in agents if a["outcome"] == "active" or float(a["time_s"]) * rate > frame - 1 + 1e-6]
            self.assertEqual(count, len(present), f"rows of frame {frame}")
        return outcome, last


class Launcher(SystemTest):
    """Tests of scripts that start the programs themselves."""

    def script(self, *command):
        # From a folder that is not the project's.
        return self.start(*command, cwd=self.folder, env={**os.environ, "WADE_BUILD": str(PROGRAMS)})

    def output_of(self, program):
        program.output.seek(0)
        return program.output.read()
