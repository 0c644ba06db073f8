"""Files of strangers: a FIFO, a folder, /dev/zero, half a file and an endless one in place of each file that a command reads.

Each command of tools/wade runs in a process of its own, forked from this one. An intact run tells, by Python's audit events,
which files the command opens. Each of them is then replaced: the command names the file and the reason, and needs neither
2 GB nor a patience of a minute.
"""

import json
import os
import resource
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from unittest import mock

from harness import BASIN, CLIENT, PROGRAMS, SERVER, SMALL, SystemTest, unwrapped

from wade import cli
from wade.outside import works

PATIENCE_S, MEMORY = 60, 2 << 30
KINDS = ("fifo", "folder", "zero", "half", "endless")
# What may go unsaid: a file that grows is read to its last whole row or to the time that is asked for, and SQLite does not read
# behind the end of its tables.
FINE = {("half", ".bin"), ("half", "poses.csv"), ("half", "terms.csv"), ("half", ".wrec"), ("endless", ".sqlite"),
        ("endless", "poses.csv"), ("endless", ".wrec")}
RUN = ("--module", "wade.run.pair")  # nothing is built before it
# A site with files for all that can be one, and people.
SITE = BASIN | {
    "duration_s": 3, "site": BASIN["site"] | {
        "ground": {"file": "ground.asc"}, "houses": [{"file": "houses.geojson"}], "residents_csv": "residents.csv",
        "sources": [{"polygon": [[0, 0], [6, 0], [6, 8], [0, 8]], "hydrograph_csv": "discharge.csv"}],
        "shelters": [{"polygon": [[16, 12], [22, 12], [22, 15], [16, 15]]}]},
    "crowd": {"response": "measured", "people_csv": "people.csv", "poses": {"rate_hz": 5},
              "groups": [{"name": "all", "start": {"from": "houses"}, "goal": {"to": "shelters"}}]},
}


def write_site(folder):
    """The scene SITE with its files."""
    folder.mkdir()
    rows = "\n".join(" ".join(f"{-0.5 + 0.08 * (15.5 - row):.3f}" for _ in range(24)) for row in range(16))
    (folder / "ground.asc").write_text(f"ncols 24\nnrows 16\nxllcorner 500000\nyllcorner 5300000\ncellsize 1\n{rows}\n")
    corners = [[500000 + x, 5300000 + z] for x, z in ((8, 2), (12, 2), (12, 5), (8, 5), (8, 2))]
    (folder / "houses.geojson").write_text(json.dumps({
        "type": "FeatureCollection", "crs": {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::32632"}},
        "features": [{"type": "Feature", "properties": {"height_m": 3},
                      "geometry": {"type": "Polygon", "coordinates": [corners]}}]}))
    (folder / "residents.csv").write_text("x,y\n500010,5300003\n")
    (folder / "discharge.csv").write_text("time_s,discharge_m3_s\n0,6\n100,6\n")
    (folder / "people.csv").write_text("mass_kg\n70\n")
    (folder / "scene.json").write_text(json.dumps(SITE))
    return folder / "scene.json"


def replace(file, kind):
    """Replaces a file by something of a kind."""
    data = file.read_bytes()
    file.unlink()
    if kind == "fifo":
        os.mkfifo(file)
    elif kind == "folder":
        file.mkdir()
    elif kind == "zero":
        file.symlink_to("/dev/zero")
    else:
        file.write_bytes(data[: len(data) // 2] if kind == "half" else data)
        if kind == "endless":
            os.truncate(file, 1 << 40)


class Answer:
    """What a command came to: its exit code, what it said, the memory that it had, and the files that it opened."""

    def __init__(self, code, said, bytes_used, opened=()):
        self.code, self.said, self.bytes_used, self.opened = code, said, bytes_used, opened


def wait_for(pid):
    """(status, bytes) of a child; None as status if it has to be killed."""
    end = time.monotonic() + PATIENCE_S
    while time.monotonic() < end:
        done, status, usage = os.wait4(pid, os.WNOHANG)
        if done:
            return status, 1024 * usage.ru_maxrss
        time.sleep(0.01)
    os.kill(pid, signal.SIGKILL)
    return None, 1024 * os.wait4(pid, 0)[2].ru_maxrss


def call(words, folder):
    """tools/wade with these words in a child."""
    said, opened = tempfile.TemporaryFile("w+", dir=folder), tempfile.TemporaryFile("w+", dir=folder)
    pid = os.fork()
    if pid == 0:
        code = 70
        try:
            resource.setrlimit(resource.RLIMIT_DATA, (MEMORY, MEMORY))
            os.dup2(said.fileno(), 1)
            os.dup2(said.fileno(), 2)

            def note(event, arguments):
                if event in ("open", "sqlite3.connect") and isinstance(arguments[0], (str, Path)):
                    print(str(arguments[0]), file=opened)

            sys.addaudithook(note)
            code = cli.main(list(map(str, words)))
        except SystemExit as end:
            code = end.code
        except BaseException:  # noqa: B902 - a child must not go on with the tests
            sys.excepthook(*sys.exc_info())
        finally:
            sys.stdout.flush()
            opened.flush()
            os._exit(code or 0)
    status, used = wait_for(pid)
    with said, opened:
        said.seek(0)
        opened.seek(0)
        return Answer(None if status is None else os.waitstatus_to_exitcode(status), unwrapped(said.read()), used,
                      set(opened.read().splitlines()))


def run(words, folder):
    """A program of its own with these words."""
    with tempfile.TemporaryFile("w+", dir=folder) as said:
        process = subprocess.Popen(list(map(str, words)), stdin=subprocess.DEVNULL, stdout=said, stderr=said)
        status, used = wait_for(process.pid)
        process.returncode = 0
        said.seek(0)
        return Answer(None if status is None else os.waitstatus_to_exitcode(status), unwrapped(said.read()), used)


class Strangers(SystemTest):
    def setUp(self):
        super().setUp()
        self.out = self.folder / "out"
        for module in ("matplotlib.pyplot", "wade.pictures.film", "wade.statistics.page", "wade.export.figures", "wade.many"):
            __import__(module)  # once, not in each child

    def judge(self, answer, file, kind, what):
        words = f"{what} with {file.name} as {kind}: {answer.said[-2000:]}"
        self.assertIsNotNone(answer.code, f"hangs: {words}")
        self.assertNotIn("Traceback", answer.said, words)
        self.assertGreaterEqual(answer.code, 0, words)
        self.assertLess(answer.bytes_used, MEMORY, words)
        if not any(kind == fine and file.name.endswith(ending) for fine, ending in FINE):
            self.assertIn(file.name, answer.said, words)
            self.assertTrue(answer.code != 0 or "no picture of a run" in answer.said, words)

    def try_all(self, folders, commands):
        """Replaces each file of the folders, one at a time, that a command opens."""
        tried = set()
        for words in commands:
            shutil.rmtree(self.out, ignore_errors=True)
            answer = call(words, self.folder)
            self.assertIn(answer.code, (0, 1) if words[0] == "render" else (0,), f"{words}: {answer.said}")
            texts = "\n".join(answer.opened)
            for file in sorted(file for folder in folders for file in folder.rglob("*") if file.is_file()):
                if str(file) not in texts:
                    continue
                tried.add(file.name)
                for kind in KINDS:
                    kept = self.folder / "kept"
                    shutil.copy(file, kept)
                    replace(file, kind)
                    shutil.rmtree(self.out, ignore_errors=True)
                    with self.subTest(command=words[0], file=file.name, kind=kind):
                        self.judge(call(words, self.folder), file, kind, " ".join(map(str, words)))
                    shutil.rmtree(file) if kind == "folder" else file.unlink()
                    shutil.move(kept, file)
        return tried

    def test_a_run_folder(self):
        # The water carries people, so that there are people to look for.
        options = ["--set", "/crowd/response=measured", "--set", "/crowd/poses/rate_hz=5", "--set", "/channel/velocity_m_s=2"]
        record = self.start(PROGRAMS / "shm_record", self.session, self.folder / "water.wrec")
        server, client = self.server("--consumers", "2", *options), self.client(
            *options, "--water-every-s", "1", "--terms-every-s", "1", "--danger-every-s", "1")
        self.assert_ended_well(record, server, client)
        folder = client.run.folder
        water = folder / "water.wrec"
        shutil.move(self.folder / "water.wrec", water)
        commands = [["figure", folder, "--output", self.out / "a.png"],
                    ["danger-map", folder, "--output", self.out / "a.png"],
                    ["render", folder, "--time", "2", "--out", self.out / "a.png"],
                    ["render", folder, "--time", "2", "--water", water, "--out", self.out / "a.png"],
                    ["table", folder, "--out", self.out], ["report", folder, "--out", self.out / "report.html"],
                    ["victims", folder, "--drift-s", "5", "--out", self.out],
                    *(["export", folder, "--to", form, "--from-s", "7", "--out", self.out]
                      for form in ("vtk", "ply", "geotiff")),
                    ["export", folder, "--to", "obj", "--from-s", "7.5", "--water", water, "--out", self.out],
                    ["export", water, "--to", "csv", "--from-s", "7.5", "--out", self.out]]
        if works("ffmpeg"):
            commands.append(["film", folder, "--from-s", "7.5", "--rate-hz", "2", "--width-px", "320", "--out", self.out / "a.gif"])
        # A Blender that draws nothing: what is read comes before it.
        (self.folder / "bin").mkdir()
        (self.folder / "bin" / "blender").write_text("#!/bin/sh\n")
        (self.folder / "bin" / "blender").chmod(0o755)
        with mock.patch.dict(os.environ, PATH=f"{self.folder / 'bin'}:{os.environ['PATH']}"):
            tried = self.try_all([folder], commands)
        self.assertEqual(tried, {"manifest.json", "outcome.json", "agents.csv", "trajectories.sqlite", "poses.csv", "terms.csv",
                                 "danger.csv", "water.bin", "water.wrec"})
        paths = folder / "poses.csv"
        paths.unlink()
        self.try_all([folder], [["export", folder, "--to", "csv", "--out", self.out]])

    def test_a_site_with_its_files(self):
        scene = write_site(self.folder / "site")
        run_of = self.folder / "run"
        self.assert_ended_well(self.server("--out", run_of, scene=scene), self.client(scene=scene, out=run_of))
        tried = self.try_all([run_of, scene.parent], [
            ["maps", run_of, "--map", "max_depth_m", "--out", self.out], ["maps", run_of, "--map", "arr_h", "--out", self.out],
            ["figure", run_of, "--output", self.out / "a.png"], ["export", run_of, "--to", "geotiff", "--out", self.out]])
        self.assertLessEqual({"houses.geojson", "max_depth_m.tif", "arr_h.tif", "water.bin"}, tried)
        for name in ("scene.json", "ground.asc", "houses.geojson", "residents.csv", "discharge.csv", "people.csv"):
            file, kept = scene.parent / name, self.folder / "kept"
            shutil.copy(file, kept)
            for kind in KINDS:
                replace(file, kind)
                for program in (SERVER, CLIENT):
                    if name == "people.csv" and program == SERVER:
                        continue
                    with self.subTest(program=program.name, file=name, kind=kind):
                        self.judge(run([program, scene, "--check"], self.folder), file, kind, program.name)
                with self.subTest(command="run", file=name, kind=kind):
                    self.judge(call([*RUN, scene, "--out", self.out, "--no-figure"], self.folder), file, kind, "wade run")
                shutil.rmtree(file) if kind == "folder" else file.unlink()
                shutil.copy(kept, file)

    def test_states_crowds_and_recordings(self):
        state, crowds, water = self.folder / "a.state", self.folder / "crowds.json", self.folder / "a.wrec"
        record = self.start(PROGRAMS / "shm_record", self.session, water)
        until = ("--until-s", "1")
        self.assert_ended_well(self.server("--consumers", "2", *until, "--save-state", state), self.client(*until), record)
        crowds.write_text(json.dumps([{"name": "a"}, {"name": "b"}]))
        for file, words in ((state, [SERVER, SMALL, "--from-state", state, "--consumers", "0"]),
                            (crowds, [CLIENT, SMALL, "--crowds", crowds, "--out", self.out]),
                            (water, [PROGRAMS / "shm_replay", water, "--attach-timeout-s", "1"])):
            kept = self.folder / "kept"
            shutil.copy(file, kept)
            for kind in KINDS:
                replace(file, kind)
                options = {state: ["--from-state", state], crowds: ["--crowds", crowds], water: ["--replay", water]}[file]
                with self.subTest(file=file.name, kind=kind):
                    self.judge(run([*words, "--session", self.session], self.folder), file, kind, words[0].name)
                    self.judge(call([*RUN, SMALL, "--out", self.out, "--no-figure", *options], self.folder), file, kind,
                               "wade run")
                shutil.rmtree(file) if kind == "folder" else file.unlink()
                shutil.copy(kept, file)
        data = bytearray(state.read_bytes())
        for particles in (2**32, 2**63):  # and a file that has room for them
            struct.pack_into("<Q", data, 32, particles)
            struct.pack_into("<Q", data, 16, 1 << 40)
            state.write_bytes(data)
            os.truncate(state, 1 << 40)
            answer = run([SERVER, SMALL, "--from-state", state, "--consumers", "0", "--session", self.session], self.folder)
            self.judge(answer, state, "claims", "fluid_server")
            self.assertIn("particles", answer.said)
