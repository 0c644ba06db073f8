"""The viewer: its server against run folders, sessions, recordings and nonsense, and its page in a browser."""

import argparse
import base64
import contextlib
import csv
import io
import json
import os
import random
import re
import signal
import socket
import sqlite3
import struct
import subprocess
import sys
import unittest
import unittest.mock
import urllib.error
import urllib.request
from pathlib import Path

from harness import BASIN, CLIENT, ENDLESS, PROGRAMS, SMALL, SERVER as WATER, SystemTest, command_of, wait_until

from wade import view
from wade.outside import works
from wade.paths import CONFIGS

SERVER = PROGRAMS / "wade_view_server"
PAGE_TEST = Path(__file__).resolve().parent / "view_page.mjs"
HAMLET = CONFIGS / "sites" / "hamlet.json"
# People walk round a periodic world.
ROUND = [*ENDLESS, "--set", "/world/ends=periodic", "--set", "/crowd/groups/0/goal/x_m=100000", "--set", "/crowd/groups/0/goal/z_m=6"]
COLOURS_TEST = PAGE_TEST.with_name("view_colours.mjs")
# Particles in a river, cells in a channel, both, a prescribed flow, two sites with rasters: the scene, its options, its end, s.
COLOURED = (("river/s05", (), 2), ("models/shallow_water_s05", (), 4), ("models/mixed_s05", (), 2),
            ("river/s05", ("--set", "/fluid/model=kinematic"), 2),
            ("sites/village/village", ("--set", "/site/gates/0/opens_at_s=4"), 8), ("sites/merewether/merewether", (), 60))
KEPT = ["--set", "/crowd/poses/rate_hz=10"]  # both programs
CUT = ["--until-s", "7.97"]  # between two rows of the poses
TERMS = ["--terms-every-s", "0.1", "--water-every-s", "0.5"]  # the crowd
HEAD = struct.Struct("<4sIIIddIIfffI")  # tools/viewer/README.md


class Socket:
    """A client of the WebSocket, the least that talks to the server."""

    def __init__(self, port, headers=(), key=""):
        self.socket = socket.create_connection(("127.0.0.1", port), timeout=30)
        nonce = base64.b64encode(os.urandom(16)).decode()
        lines = [f"GET /stream HTTP/1.1\r\nHost: 127.0.0.1:{port}", "Upgrade: websocket", "Connection: Upgrade",
                 f"Sec-WebSocket-Key: {nonce}", "Sec-WebSocket-Version: 13",
                 f"Cookie: a=b; wade_{port}={key}", *headers]
        self.socket.sendall(("\r\n".join(lines) + "\r\n\r\n").encode())
        self.stream = self.socket.makefile("rb")
        self.answer = self.stream.readline().decode()
        while self.stream.readline().strip():
            pass

    def ask(self, **question):
        self.send(json.dumps(question).encode())

    def send(self, data, kind=1):
        length = struct.pack(">B", 0x80 | len(data)) if len(data) < 126 else struct.pack(">BH", 0x80 | 126, len(data))
        self.socket.sendall(bytes([0x80 | kind]) + length + b"\0\0\0\0" + data)  # masked with zeros

    def message(self):
        """The next message, text or (head, arrays); answers pings meanwhile."""
        kind, length = self.stream.read(2)
        length &= 0x7F
        if length == 126:
            length = struct.unpack(">H", self.stream.read(2))[0]
        elif length == 127:
            length = struct.unpack(">Q", self.stream.read(8))[0]
        data = self.stream.read(length)
        if kind & 15 == 9:
            self.send(data, 10)
            return self.message()
        if kind & 15 == 1:
            return json.loads(data)
        head = HEAD.unpack_from(data)
        count, fields = head[2:4]
        values = struct.unpack_from(f"<{count * fields}f", data, HEAD.size)
        return head, [values[k * count:(k + 1) * count] for k in range(fields)]

    def wait_for(self, wanted):
        """Returns the next message that satisfies wanted(); skips all others."""
        while True:
            message = self.message()
            if wanted(message):
                return message

    def get(self, **question):
        self.ask(**question)
        return self.wait_for(lambda m: not isinstance(m, dict) or "status" not in m)

    def status(self, wanted=lambda _: True):
        return self.wait_for(lambda m: isinstance(m, dict) and "status" in m and wanted(m["status"]))["status"]

    def close(self):
        self.stream.close()
        self.socket.close()


class ViewTest(SystemTest):
    def three(self):
        """A folder that looks like npm's; the page itself is for the browser."""
        for name in ("build/three.module.js", "build/three.core.js", "examples/jsm/controls/OrbitControls.js"):
            file = self.folder / "three" / name
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text("// three\n")
        return self.folder / "three"

    def view(self, *arguments, three=None):
        """A server, once it listens; .address, .port."""
        program = self.start(SERVER, "--page", view.PAGE, "--three", three or self.three(), *arguments)

        def address():
            program.output.seek(0)
            return program.output.read()

        wait_until(lambda: "\n" in address() or not program.running(), "the address")
        self.assertTrue(program.running(), program.messages())
        program.address = address().strip()
        port, program.key = re.fullmatch(r"http://127.0.0.1:(\d+)/\?key=([0-9a-f]{32})", program.address).groups()
        program.port = int(port)
        return program

    def connect(self, program, **options):
        client = Socket(program.port, key=program.key, **options)
        self.addCleanup(client.close)
        return client

    def kept_run(self):
        server, client = self.server(*KEPT), self.client(*KEPT, *TERMS)
        self.assert_ended_well(server, client)
        return client.run

    def fetch(self, program, path):
        request = urllib.request.Request(f"http://127.0.0.1:{program.port}{path}",
                                         headers={"Cookie": f"wade_{program.port}={program.key}"})
        with urllib.request.urlopen(request, timeout=30) as answer:
            return answer.read()


class Folders(ViewTest):
    def test_a_run_is_served_as_its_files_have_it(self):
        run = self.kept_run()
        program = self.view("--run", run.folder)
        description = json.loads(self.fetch(program, "/run.json"))
        self.assertEqual(json.loads(description["files"]["outcome.json"]), run.outcome())
        poses = list(csv.DictReader(io.StringIO(run.bytes_of("poses.csv").decode())))
        times = sorted({float(row["time_s"]) for row in poses})
        client = self.connect(program)
        status = client.status(lambda s: s["people"]["frames"] == len(times))
        self.assertEqual(status["people"]["last"], times[-1])
        self.assertEqual(status["outcome"], "completed")

        frame = len(times) // 2
        head, arrays = client.get(get="people", after=frame)
        rows = [row for row in poses if float(row["time_s"]) == times[frame]]
        self.assertEqual((head[0], head[1], head[2], head[4]), (b"WVF1", 2, len(rows), times[frame]))
        for name, values in zip(description["fields"], arrays):
            wanted = [row.get(name) for row in rows]
            if name == "state":
                wanted = [description["states"].index(row[name]) for row in rows]
            elif name == "posture":
                wanted = [description["postures"].index(row[name]) for row in rows]
            elif name == "holds":
                wanted = [-1] * len(rows)
            for value, number in zip(values, wanted):
                self.assertAlmostEqual(value, float(number), delta=1e-5 * (1 + abs(float(number))), msg=name)

        head, depths = client.get(get="depths", t=4)
        self.assertEqual((head[1], head[4]), (3, 4))
        # 1 m of water over 20 x 4 m; the file rounds to millimetres.
        self.assertAlmostEqual(sum(depths[0]) * head[10] ** 2, 80, delta=0.0005 * len(depths[0]))

        rows = list(csv.DictReader(io.StringIO(run.bytes_of("terms.csv").decode())))
        row = next(r for r in rows if r["id"] == "2" and float(r["time_s"]) >= 3)
        shown = client.get(get="terms", id=2, t=float(row["time_s"]))["terms"]
        self.assertEqual(next(csv.DictReader(io.StringIO(shown))), row)

        course = list(csv.DictReader(io.StringIO(client.get(get="course", id=2)["course"])))
        own = [r for r in rows if r["id"] == "2"]
        self.assertEqual(course, own[:: 1 + len({r["time_s"] for r in rows}) // 200])

        ends = {int(a["id"]): a["outcome"] for a in run.agents() if a["outcome"] != "active"}
        changes = client.get(get="changes", after=0)["changes"]
        self.assertEqual({i: s for _, i, s in changes if s in ("arrived", "dead")}, ends)
        head, paths = client.get(get="paths", t=0)
        self.assertEqual(len(set(paths[0])), 6)

    def test_states_that_are_not_in_the_list_are_unknown(self):
        run = self.kept_run()
        head, *rows = run.bytes_of("poses.csv").decode().splitlines()
        place = head.split(",").index("state")
        of_all = [row.split(",") for row in rows]
        times = sorted({float(cells[1]) for cells in of_all})
        for cells in of_all:  # person 0 from the start, person 1 from the middle on
            if cells[2] == "0" or cells[2] == "1" and float(cells[1]) >= times[len(times) // 2]:
                cells[place] = "moonwalking" if cells[2] == "0" else ""
        (run.folder / "poses.csv").write_text("\n".join([head, *map(",".join, of_all)]) + "\n")
        program = self.view("--run", run.folder)
        fields = json.loads(self.fetch(program, "/run.json"))["fields"]
        client = self.connect(program)
        client.status(lambda s: s["people"]["frames"] == len(times))
        for frame, unknown in ((1, {0}), (len(times) * 2 // 3, {0, 1})):
            _, arrays = client.get(get="people", after=frame)
            states = dict(zip(arrays[fields.index("id")], arrays[fields.index("state")]))
            self.assertEqual({int(i) for i, state in states.items() if state == -2}, unknown & {int(i) for i in states})
            self.assertIn(0, states)
        changes = client.get(get="changes", after=0)["changes"]
        self.assertIn([times[len(times) // 2], 1, "unknown"], changes)
        self.assertFalse([change for change in changes if change[1] == 0])

    def test_terms_are_those_of_the_equations(self):
        run = self.kept_run()
        rows = list(csv.DictReader(io.StringIO(run.bytes_of("terms.csv").decode())))
        wet = [{k: float(v) for k, v in row.items() if v} for row in rows if float(row["water_mass_kg"]) > 0]
        self.assertGreater(len(wet), 20)
        for row in wet:  # Eq. 9, by numbers that are rounded to thousandths
            pushed = row["tau"] * row["water_mass_kg"]
            for axis in "xz":
                speed = ((row["mass_kg"] * row[f"walking_{axis}_m_s"] + row["tau"] * row[f"water_momentum_{axis}_kg_m_s"])
                         / (row["mass_kg"] + pushed))
                self.assertAlmostEqual(row[f"velocity_{axis}_m_s"], speed, delta=0.003)

    def test_a_run_that_was_killed_is_served_up_to_its_last_whole_frame(self):
        run = self.kept_run()
        for name in ("poses.csv", "water.bin"):
            data = run.bytes_of(name)
            (run.folder / name).write_bytes(data[: len(data) * 2 // 3])
        client = self.connect(self.view("--run", run.folder))
        status = client.status(lambda s: s["people"]["frames"] > 0)
        head, _ = client.get(get="people", after=1e6)
        self.assertEqual(head[4], status["people"]["last"])
        self.assertLess(head[4], run.outcome()["sim_time_s"] * 0.9)
        self.assertLess(client.get(get="depths", t=1e6)[0][4], run.outcome()["sim_time_s"] * 0.9)

    def test_the_last_poses_may_come_between_two_frames(self):
        run = self.pair(*KEPT, *CUT)
        client = self.connect(self.view("--run", run.folder))
        status = client.status(lambda s: s["people"]["frames"] == 81)["people"]
        self.assertEqual((status["rate"], status["last"]), (10, 7.967))
        for frame, time in ((40, 4), (79, 7.9), (80, 7.967)):
            self.assertEqual(client.get(get="people", after=frame)[0][4], time)

    def test_a_site_is_described_with_its_ground_and_frames_go_by_their_numbers(self):
        folder, scene = self.folder / "run", self.folder / "basin.json"
        folder.mkdir()
        scene.write_text(json.dumps(BASIN))
        printed = subprocess.run([WATER, scene, "--print-config"], capture_output=True, check=True)
        (folder / "manifest.json").write_text(json.dumps({"resolved_scene": json.loads(printed.stdout)}))
        # The person is outdoors neither before frame 4 nor in frame 6.
        rows = [f"{frame},{frame / 2},7,3,{frame},{state},upright" + 10 * ",0" + ",,-0.1"
                for frame, state in ((4, "walking"), (5, "walking"), (7, "sheltered"))]
        head = "frame,time_s,id,x_m,z_m,state,posture,heading_rad,speed_m_s,gait_phase,step_length_m,hip_height_m"
        (folder / "poses.csv").write_text("\n".join([head, *rows, ""]))
        program = self.view("--run", folder)
        description = json.loads(self.fetch(program, "/run.json"))
        site = description["site"]
        self.assertEqual([house["rings"] for house in site["houses"]], [[[[8, 2], [12, 2], [12, 5], [8, 5]]]])
        self.assertEqual((site["houses"][0]["height"], len(site["sources"]), site["highest_water"]), (6, 1, 0))
        client = self.connect(program)
        head, (heights,) = client.get(get="ground")
        columns, step = head[7], head[10]
        self.assertEqual((columns, head[2]), (65, 65 * 44))
        for k in (0, 64, 65 * 20 + 3):
            self.assertAlmostEqual(heights[k], -0.5 + 0.08 * step * (k // columns), delta=1e-6)
        status = client.status(lambda s: s["people"]["frames"] > 0)["people"]
        self.assertEqual((status["frames"], status["last"], status["rate"]), (8, 3.5, 2))
        for frame, words in ((0, []), (4, ["walking"]), (6, []), (7, ["sheltered"])):
            head, arrays = client.get(get="people", after=frame)
            self.assertEqual(head[4], frame / 2)
            self.assertEqual([description["states"][int(state)] for state in arrays[3]], words)

    def test_a_site_whose_files_are_gone_is_told(self):
        folder = self.folder / "run"
        folder.mkdir()
        (folder / "outcome.json").write_text("{}")
        site = BASIN["site"] | {"ground": {"file": str(self.folder / "gone.asc")}}
        (folder / "manifest.json").write_text(json.dumps({"resolved_scene": BASIN | {"site": site}}))
        described = json.loads(self.fetch(self.view("--run", folder), "/run.json"))
        self.assertIn("gone.asc", described["site"]["problem"])

    def test_runs_without_paths_are_told_so(self):
        water, crowd = self.server(*KEPT, *CUT), self.client(*KEPT, *CUT, "--no-trajectories")
        self.assert_ended_well(water, crowd)
        client = self.connect(self.view("--run", crowd.run.folder))
        client.status(lambda s: s["people"]["frames"] > 0)
        head, paths = client.get(get="paths", t=0)
        self.assertEqual((head[1], head[2], paths), (4, 0, [()] * 4))

    def test_only_paths_show_people_upright(self):
        run = self.pair()
        client = self.connect(self.view("--run", run.folder))
        status = client.status(lambda s: s["people"]["frames"] > 0)
        self.assertFalse(status["people"]["poses"])
        frame = int(2 * status["people"]["rate"])
        _, arrays = client.get(get="people", after=frame)
        rows = run.query(f"SELECT id, pos_x, pos_y FROM trajectory_data WHERE frame = {frame}")
        for value, row in zip(zip(*arrays[:3]), rows):
            self.assertAlmostEqual(value[1], row[1], delta=1e-4)
            self.assertAlmostEqual(value[2], row[2], delta=1e-4)
        self.assertEqual(set(arrays[3]), {-1}, "paths hold no states")


class Sessions(ViewTest):
    def test_a_live_run_is_shown_and_a_client_that_stalls_holds_nobody_up(self):
        program = self.view("--session", self.session)
        client, stalled = self.connect(program), self.connect(program)
        self.assertEqual(client.status()["live"]["state"], "waiting")
        crowd, server = self.client(*KEPT, *ENDLESS), self.server(*KEPT, *ENDLESS)
        stalled.ask(get="live", after=-1)  # and never reads
        seen = []
        while len(seen) < 3:
            head, arrays = client.get(get="live", after=seen[-1] if seen else -1)
            self.assertEqual(head[2:4], (640, 7))
            self.assertAlmostEqual(sum(arrays[6]), 80, delta=1e-3)  # m3 of water
            seen.append(head[5])
        self.assertEqual(seen, sorted(set(seen)))
        self.wait_for_frame(self.published_frame() + 300, server, crowd)
        for program in (crowd, server):
            program.send(signal.SIGINT)
            program.wait()
        client.status(lambda s: s["live"]["state"] == "ended")

    def test_frames_without_people_are_known_as_the_crowd_has_passed_them(self):
        crowd, server = self.client(*KEPT, *ENDLESS), self.server(*KEPT, *ENDLESS)
        client = self.connect(self.view("--run", crowd.run.folder, "--session", self.session, "--starts"))
        client.status(lambda s: s["people"]["last"] > 30)  # all six have arrived long before
        head, _ = client.get(get="people", after=1e9)
        self.assertEqual(head[2], 0)
        self.assertAlmostEqual(head[4], head[5] / 10, delta=1e-9)
        self.assertEqual(client.get(get="people", after=20)[0][2], 6)
        self.assertLess(float(crowd.run.bytes_of("poses.csv").decode().split("\n")[-2].split(",")[1]), 30, "no more rows")
        for program in (crowd, server):
            program.send(signal.SIGINT)
            program.wait()
        self.assertLessEqual(head[4], crowd.run.outcome()["sim_time_s"])

    def test_a_producer_that_was_killed_is_told(self):
        client = self.connect(self.view("--session", self.session))
        crowd, server = self.client(*KEPT, *ENDLESS), self.server(*KEPT, *ENDLESS)
        client.get(get="live", after=-1)
        server.send(signal.SIGKILL)
        self.assertNotEqual(crowd.wait(), 0)
        client.status(lambda s: s["live"]["state"] == "killed")
        Path(f"/dev/shm/{self.session}-fluid").unlink()

    def test_tau_from_the_page_is_recorded_and_played_again(self):
        fifo = self.folder / "fifo"
        crowd = self.client(*KEPT, "--commands", fifo, "--reproducible")
        wait_until(fifo.exists, "the FIFO")
        client = self.connect(self.view("--run", crowd.run.folder, "--session", self.session, "--commands", fifo,
                                        "--starts"))
        self.assertIn("allowed", client.get(get="command", line="tau 7")["problem"])
        self.assertIn("quit", client.get(get="command", line="quit")["problem"])
        self.assertEqual(client.get(get="command", line="tau 0.9 group walkers")["problem"], "")
        server = self.server(*KEPT, "--reproducible")
        self.assert_ended_well(server, crowd)
        events = client.status(lambda s: s["events"])["events"]
        self.assertEqual([json.loads(line)["tau"] for line in events.splitlines()], [0.9])
        again = self.pair("--reproducible", scene=crowd.run.folder / "scene_as_played.json")
        self.assertEqual(crowd.run.bytes_of("agents.csv"), again.bytes_of("agents.csv"))

    def test_a_recording_that_was_cut_off_opens_to_its_last_whole_frame(self):
        file = self.folder / "water.wrec"
        server = self.server("--consumers", "2", "--until-s", "1")
        recorder = self.start(PROGRAMS / "shm_record", self.session, file)
        crowd = self.client("--until-s", "1")
        self.assert_ended_well(server, crowd, recorder)
        file.write_bytes(file.read_bytes()[: file.stat().st_size // 2])
        client = self.connect(self.view("--recording", file))
        recorded = client.status()["recorded"]
        self.assertFalse(recorded["whole"])
        self.assertIn(recorded["frames"], range(8, 20))
        head, arrays = client.get(get="water", t=99)
        self.assertEqual((head[2], head[4]), (640, recorded["last"]))
        self.assertTrue(all(0 <= x <= 20 for x in arrays[0]))


class Strangers(ViewTest):
    def test_nonsense_is_refused_and_survived(self):
        folder = self.folder / "run"
        folder.mkdir()
        program = self.view("--run", folder, "--starts")
        chance = random.Random(1)
        paths = ["/", "/run.json", "/../../etc/passwd", "/%2e%2e/%2e%2e/etc/passwd", "/viewer.js/../..", "//etc/passwd", "/stream"]
        for k in range(1000):
            with socket.create_connection(("127.0.0.1", program.port), timeout=30) as stranger:
                host = chance.choice(["127.0.0.1", "localhost", "evil.example"])
                request = (f"{chance.choice(['GET', 'POST', 'HEAD', 'TRACE', 'X' * 40])} {chance.choice(paths)} HTTP/1.1\r\n"
                           f"Host: {host}:{program.port}\r\n{'A: ' + 'b' * chance.choice([1, 9000])}\r\n\r\n").encode()
                if k % 4 == 1:
                    request = chance.randbytes(chance.randrange(1, 300))
                if k % 4 == 2:
                    request = request[: chance.randrange(len(request))]
                stranger.sendall(request)
                if k % 4 == 0:
                    self.assertNotIn(b"root:", stranger.recv(200))
        for k in range(60):  # broken sockets in the midst of the stream
            client = Socket(program.port, key=program.key)
            client.send(chance.choice([b"{", b"[]", b'{"get":1}', b'{"get":"people","after":1e999}', b"\xff\xfe", b"x" * 4000,
                                       b'{"get":"water","t":"x"}', b'{"get":"command","line":"tau 1\\ntau 0"}']), chance.choice([1, 2]))
            if k % 3 == 0:
                with contextlib.suppress(OSError):  # it may have closed by then
                    client.socket.sendall(chance.randbytes(50))
            client.close()
        self.assertIn(b"<title>Wade</title>", self.fetch(program, "/"))
        self.assertIn("status", self.connect(program).message())
        self.assertEqual(program.messages(), "")

    def test_a_folder_of_a_stranger_is_refused_file_by_file(self):
        names = ("outcome.json", "manifest.json", "agents.csv", "events.jsonl", "poses.csv", "terms.csv", "trajectories.sqlite",
                 "water.bin")
        fifos = self.folder / "fifos"
        fifos.mkdir()
        for name in names:
            os.mkfifo(fifos / name)
        program = self.view("--run", fifos)
        self.assertEqual(set(json.loads(self.fetch(program, "/run.json"))["files"].values()), {""})
        client = self.connect(program)
        status = client.status()
        self.assertEqual((status["people"]["frames"], status["depths"]["frames"]), (0, 0))
        os.mkfifo(fifos / "x.wrec")
        self.assert_ends(self.start(SERVER, "--page", view.PAGE, "--three", self.three(), "--recording", fifos / "x.wrec"), 2,
                         "it is a pipe (FIFO)")

        def water(columns, rows, cell=0.5, times=(0.0, 1.0)):
            head = b"WADEWAT1" + struct.pack("<IIddd", columns, rows, cell, 0, 0)
            return head.ljust(64, b"\0") + b"".join(struct.pack("<qd", 0, time) + bytes(2 * 12) for time in times)

        nan = float("nan")
        for content, frames in ((water(4, 3), 2), (water(0, 0), 0), (water(0, 3), 0), (water(2**32 - 1, 2**32 - 1), 0),
                                (water(2**31, 2**31 + 2**29), 0), (water(65536, 65536), 0), (water(4, 3, 0), 0),
                                (water(4, 3, nan), 0), (water(4, 3, -1), 0), (water(4, 3, times=(0.0, nan)), 1),
                                (water(4, 3, times=(1.0, 0.0)), 1), (b"x" * 100, 0)):
            folder = self.folder / f"water{content.__hash__()}"
            folder.mkdir()
            (folder / "water.bin").write_bytes(content)
            client = self.connect(self.view("--run", folder))
            client.status(lambda s: s["depths"]["frames"] == frames and
                          (frames == 2) != ("water.bin is refused" in s["depths"]["problem"]))
            if frames:
                self.assertEqual(client.get(get="depths", t=9)[0][2], 12)

        view_of_itself = self.folder / "endless"
        view_of_itself.mkdir()
        with contextlib.closing(sqlite3.connect(view_of_itself / "trajectories.sqlite")) as database:
            database.executescript("CREATE TABLE metadata(key, value); INSERT INTO metadata VALUES ('fps', 10);"
                                   "CREATE VIEW frame_data AS SELECT frame FROM trajectory_data;"
                                   "CREATE VIEW trajectory_data AS WITH RECURSIVE t(frame) AS (SELECT 1 UNION ALL SELECT frame + 1 "
                                   "FROM t) SELECT frame, 1 AS id, 1 AS pos_x, 1 AS pos_y, 0 AS ori_x, 0 AS ori_y FROM t;")
        self.assertIn("status", self.connect(self.view("--run", view_of_itself)).message())

    def test_other_users_get_nothing_without_the_key(self):
        folder = self.folder / "run"
        folder.mkdir()
        program = self.view("--run", folder, "--starts")

        def asked(path, cookie="a=b"):
            request = urllib.request.Request(f"http://127.0.0.1:{program.port}{path}", headers={"Cookie": cookie})
            try:
                with urllib.request.urlopen(request, timeout=30) as answer:
                    return answer.status, answer.headers
            except urllib.error.HTTPError as refused:
                refused.close()
                return refused.code, refused.headers

        wrong = "0" * 32
        for path in ("/", "/run.json", "/viewer.js", f"/?key={wrong}", "/?key=", "/?key"):
            for cookie in ("a=b", f"wade_{program.port}={wrong}", f"wade_{program.port}=", f"xwade_{program.port}={program.key}"):
                code, headers = asked(path, cookie)
                self.assertEqual((code, headers["Set-Cookie"]), (403, None), f"{path} {cookie}")
        stranger = Socket(program.port, key=wrong)
        self.addCleanup(stranger.close)
        self.assertIn("403", stranger.answer)
        code, headers = asked(f"/?key={program.key}")
        self.assertEqual((code, headers["Set-Cookie"]),
                         (200, f"wade_{program.port}={program.key}; HttpOnly; SameSite=Strict; Path=/"))
        self.assertIn("frame-ancestors 'none'", headers["Content-Security-Policy"])
        self.assertEqual(asked("/", headers["Set-Cookie"].split(";")[0])[0], 200)

    def test_half_open_connections_shut_nobody_out(self):
        folder = self.folder / "run"
        folder.mkdir()
        program = self.view("--run", folder, "--starts")
        for k in range(300):
            half = socket.create_connection(("127.0.0.1", program.port), timeout=30)
            self.addCleanup(half.close)
            if k % 2:
                half.sendall(b"GET / HTTP/1.1\r\n")
        self.assertIn(b"<title>Wade</title>", self.fetch(program, "/"))
        self.assertIn("status", self.connect(program).message())

    def test_the_page_is_opened_by_a_file_of_its_owner_and_its_key_stands_on_no_command_line(self):
        folder = self.folder / "run"
        folder.mkdir()
        (folder / "outcome.json").write_text("{}")
        with unittest.mock.patch.object(view, "install_modules", self.modules), \
                unittest.mock.patch.object(view, "BUILD", PROGRAMS):
            server = view.Server("--run", folder, folder=folder)
        opener = folder.resolve() / "view.html"
        self.assertIn(f"opened by {opener.as_uri()}", str(server))
        self.assertEqual(opener.stat().st_mode & 0o777, 0o600)
        address, key = server.address.split("?key=")
        self.assertIn(f"{address}?key={key}", opener.read_text())
        self.assertNotIn(key, str(server) + command_of(server.process.pid))
        server.end()
        server.process.stdout.close()
        self.assertFalse(opener.exists())

    def test_a_signal_removes_the_file_with_the_key(self):
        folder = self.folder / "run"
        folder.mkdir()
        (folder / "outcome.json").write_text("{}")
        call = (f"import sys; from pathlib import Path; from wade import view; view.install_modules = lambda: Path({str(self.modules())!r}); "
                f"view.BUILD = Path({str(PROGRAMS)!r}); sys.exit(view.main([{str(folder)!r}, '--no-open']))")
        for number in (signal.SIGTERM, signal.SIGHUP):
            program = self.start(sys.executable, "-c", call)
            wait_until(lambda: (folder / "view.html").exists() or not program.running(), "the opener")
            program.send(number)
            self.assertEqual(program.wait(), 0, program.messages())
            self.assertFalse((folder / "view.html").exists())

    def modules(self):
        node = self.folder / "node_modules"
        if not node.exists():
            node.mkdir()
            self.three().rename(node / "three")
        return self.folder

    def test_other_sites_get_nothing(self):
        folder = self.folder / "run"
        folder.mkdir()
        program = self.view("--run", folder, "--starts")
        with self.assertRaises(urllib.error.HTTPError) as refused:
            request = urllib.request.Request(f"http://127.0.0.1:{program.port}/run.json", headers={"Host": "evil.example"})
            urllib.request.urlopen(request, timeout=30)
        self.assertEqual(refused.exception.code, 403)
        refused.exception.close()
        self.assertIn("403", self.connect(program, headers=["Origin: http://evil.example"]).answer)

    def test_bad_input_is_told_in_a_line(self):
        page = ["--page", view.PAGE, "--three", self.three()]
        taken = socket.create_server(("127.0.0.1", 0))
        self.addCleanup(taken.close)
        port = taken.getsockname()[1]
        empty = self.folder / "empty"
        empty.mkdir()
        (self.folder / "no.wrec").write_text("no recording")
        for words, text in ((["--run", self.folder / "none"], "is no run folder"), (["--run", empty], "holds no run"),
                            (["--recording", self.folder / "no.wrec"], "is no recording"), ([], "nothing to show"),
                            (["--run", empty, "--starts", "--port", port], f"--port {port}: ")):
            self.assert_ends(self.start(SERVER, *page, *words), 2, text)
        self.assert_refused_here("view", self.folder / "none", texts=["there is no run folder or recording"])
        self.assert_refused_here("view", texts=["what to show is missing"])


WHOLE = os.environ.get("WADE_VIEW_PAGE") == "all"


def missing_for_page():
    """Why the page is not tested, as a sentence; empty if it is."""
    if "WADE_VIEW_PAGE" not in os.environ:
        return "in a browser by ctest -R system_view_page"
    if not works("chromium", "node"):
        return "chromium or node is not installed: tools/install_dependencies.sh viewer"
    folder = view.modules_folder()
    if not all(view.has_module(folder, name) for name in ("three", "playwright-core", "axe-core")):
        return "npm's packages are not there: tools/wade view --install-for-tests"
    return ""


class Page(ViewTest):
    def waiting_run(self, clock, three):
        """A crowd that waits for its water and the server of its page; the command of the water is for the page's test."""
        fifo, folder, session = self.folder / f"fifo_{clock}", self.folder / f"run_{clock}", f"{self.session}-{clock}"
        common = [SMALL, "--session", session, *KEPT, *ROUND]
        self.start(CLIENT, *common, *TERMS, "--commands", fifo, "--attach-timeout-s", "3600", "--out", folder)
        wait_until(fifo.exists, "the FIFO")
        server = self.view("--run", folder, "--session", session, "--commands", fifo, "--starts", three=three)
        return {"address": server.address, "server": server.process.pid, "folder": str(folder), "session": session,
                "water": [str(word) for word in (WATER, *common, "--clock", clock)]}

    @unittest.skipIf(missing_for_page(), missing_for_page())
    def test_the_page_in_a_browser(self):
        modules = view.modules_folder()
        recording = self.folder / "water.wrec"
        three = modules / "node_modules" / "three"
        water = self.server(*KEPT, *CUT, "--consumers", "2")
        recorder, crowd = self.start(PROGRAMS / "shm_record", self.session, recording), self.client(*KEPT, *CUT, *TERMS)
        self.assert_ended_well(water, recorder, crowd)
        recorded = self.view("--run", crowd.run.folder, "--recording", recording, three=three)
        ended = self.view("--run", crowd.run.folder, three=three)
        hamlet = [HAMLET, "--session", f"{self.session}-hamlet", "--set", "/fluid/shallow_water/cell_size_m=4",
                  "--set", "/crowd/poses/rate_hz=2", "--until-s", "30"]
        water = self.start(WATER, *hamlet)
        self.assert_ended_well(water, self.start(CLIENT, *hamlet, "--out", self.folder / "hamlet"))
        site = self.view("--run", self.folder / "hamlet", three=three)
        running = {clock: self.waiting_run(clock, three) for clock in ("real_time", "fast")}
        outcome = crowd.run.outcome()
        wanted = {"arrived": outcome["arrived"], "dead": outcome["dead"], "end": outcome["sim_time_s"], "folder": str(crowd.run.folder)}
        pictures = os.environ.get("WADE_VIEW_PICTURES", "-" if WHOLE else "")
        pages = {"ended": ended.address, "recorded": recorded.address, "site": site.address, "wanted": wanted, "running": running}
        test = subprocess.run(["node", PAGE_TEST, modules, pictures], input=json.dumps(pages), capture_output=True, text=True,
                              timeout=560)
        for one in running.values():
            Path(f"/dev/shm/{one['session']}-fluid").unlink(missing_ok=True)  # of the water that the test has killed
        self.assertEqual(test.returncode, 0, test.stdout + test.stderr)
        print(test.stdout, end="")
        events = Path(running["real_time"]["folder"], "events.jsonl").read_text(encoding="utf-8")
        self.assertIn('"tau":0.9', events.replace(" ", ""))

    @unittest.skipIf(missing_for_page(), missing_for_page())
    def test_the_page_is_under_3_mb_with_all_that_it_loads(self):
        three = view.modules_folder() / "node_modules" / "three"
        program = self.view("--run", self.kept_run().folder, three=three)
        names = [path.name for path in view.PAGE.glob("*.js")]
        paths = ["/", *(f"/{name}" for name in names), *(f"/three/three.{part}.js" for part in ("module", "core")),
                 "/three/OrbitControls.js"]
        self.assertLess(sum(len(self.fetch(program, path)) for path in paths), 3e6)

    @unittest.skipUnless(WHOLE and not missing_for_page(), missing_for_page() or "a long test, system_view_page_all")
    def test_colours_are_those_of_the_legend_in_scenes_of_each_kind(self):
        modules, pages = view.modules_folder(), []
        for k, (scene, options, end) in enumerate(COLOURED):
            words = [CONFIGS / f"{scene}.json", "--session", f"{self.session}-{k}", *options, "--until-s", str(end)]
            recording, folder = self.folder / f"{k}.wrec", self.folder / f"coloured{k}"
            water = self.start(WATER, *words, "--consumers", "2")
            recorder = self.start(PROGRAMS / "shm_record", f"{self.session}-{k}", recording)
            self.assert_ended_well(water, recorder, self.start(CLIENT, *words, "--out", folder))
            server = self.view("--run", folder, "--recording", recording, three=modules / "node_modules" / "three")
            pages.append({"name": " ".join([scene, *options]), "address": server.address, "time": end})
        test = subprocess.run(["node", COLOURS_TEST, modules], input=json.dumps(pages), capture_output=True, text=True, timeout=1100)
        self.assertEqual(test.returncode, 0, test.stdout + test.stderr)
        print(test.stdout, end="")

    @unittest.skipUnless(WHOLE and not missing_for_page(), missing_for_page() or "a long test, system_view_page_all")
    def test_films_by_the_viewers_camera(self):
        from PIL import Image

        from wade.pictures import film

        three = view.modules_folder() / "node_modules" / "three"
        run, scene = self.kept_run(), self.folder / "basin.json"
        scene.write_text(json.dumps(BASIN))
        basin = [f"{word}" for word in (scene, "--session", f"{self.session}-site", "--out", self.folder / "site")]
        water = self.start(WATER, *basin)
        self.assert_ended_well(water, self.start(CLIENT, *basin, "--water-every-s", "1"))
        options = argparse.Namespace(eye=(2, 2, -6), look=(12, 0, 5), colour="depth", width_px=320, height_px=180, panels=False,
                                     rate_hz=5)
        for folder, times in ((run.folder, [1.0, 2.0, 3.0]), (self.folder / "site", [1.0, 2.0, 4.0])):
            address = self.view('--run', folder, three=three).address
            for name in ("film.webp", "still.png"):
                film.write_seen(address, times, options, self.folder / name)
            with Image.open(self.folder / "film.webp") as moving, Image.open(self.folder / "still.png") as still:
                self.assertEqual((moving.n_frames, moving.size, still.size), (3, (320, 180), (320, 180)))
                # More than a palette: water coloured by its depth is flat.
                self.assertGreater(len(still.convert("RGB").getcolors(320 * 180)), 256)

    @unittest.skipUnless(WHOLE and not missing_for_page(), missing_for_page() or "a long test, system_view_page_all")
    def test_the_first_picture_of_the_readme_is_this_page(self):
        """Made as tools/viewer/README.md says; kept in WADE_VIEW_PICTURES, if that is a folder."""
        from PIL import Image, ImageChops, ImageStat

        from wade.pictures import film

        root = view.PAGE.parents[2]
        words = [f"{word}" for word in (root / "configs/river/s05.json", "--session", f"{self.session}-readme", "--until-s", "8",
                                        "--set", "/crowd/response=measured", "--set", "/crowd/poses/rate_hz=10")]
        water = self.start(WATER, *words)
        self.assert_ended_well(water, self.start(CLIENT, *words, "--water-every-s", "0.5", "--out", self.folder / "readme"))
        program = self.view("--run", self.folder / "readme", three=view.modules_folder() / "node_modules" / "three")
        options = argparse.Namespace(eye=(65, 3.2, 0.5), look=(73, 0.4, 10), colour="clear", width_px=1200, height_px=640,
                                     panels=True, rate_hz=5)
        made = Path(os.environ.get("WADE_VIEW_PICTURES", self.folder)) / "river_s05.png"
        film.write_seen(program.address, [7.5], options, made)
        with Image.open(made) as drawn:
            now = drawn.convert("RGB").quantize(256)
        now.save(made, optimize=True)
        with Image.open(root / "tools/viewer/river_s05.png") as shown:
            self.assertEqual(now.size, shown.size)
            apart = ImageStat.Stat(ImageChops.difference(now.convert("RGB"), shown.convert("RGB"))).mean
        # Two levels of 255: what another chromium may shade otherwise. The water by its depth is 17 away.
        self.assertLess(max(apart), 2)


if __name__ == "__main__":
    unittest.main()
