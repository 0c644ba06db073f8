"""tools/wade export: each format is read back by a reader that knows nothing of its writer, where one is installed.

tools/install_dependencies.sh readers installs those of Debian; those of npm are found in build/readers, or where
WADE_READERS says, after npm install --prefix build/readers gltf-validator tinyusdz.
"""

import contextlib
import csv
import functools
import importlib.util
import io
import itertools
import json
import os
import re
import shutil
import sqlite3
import struct
import signal
import subprocess
import tempfile
import time
import unittest
from pathlib import Path
from unittest import mock

import numpy as np
import recording_file
from harness import BASIN, CLIENT, PROGRAMS, ROOT, SERVER, SMALL, SystemTest

from wade import cli
from wade.outside import works
from wade.states import STATES

READERS = Path(os.environ.get("WADE_READERS", ROOT / "build" / "readers")) / "node_modules"
TEMPORARY = tempfile.TemporaryDirectory(prefix="wade-exports-")
FOLDER = Path(TEMPORARY.name)
RUN, RECORDING, PLAIN = FOLDER / "run", FOLDER / "water.wrec", FOLDER / "plain.wrec"
FRAMES = 240  # of 8 s


def tearDownModule():
    TEMPORARY.cleanup()


@functools.cache
def recorded_run():
    """A whole run with its water, compressed and not; (outcome, rows of agents.csv)."""
    session = f"wade-exports-{os.getpid()}"
    commands = ([SERVER, SMALL, "--session", session, "--consumers", "3"],
                [PROGRAMS / "shm_record", session, RECORDING],
                [PROGRAMS / "shm_record", session, PLAIN, "--compression", "0"],
                [CLIENT, SMALL, "--session", session, "--out", RUN])
    started = [subprocess.Popen(command, stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL) for command in commands]
    assert [program.wait(120) for program in started] == [0, 0, 0, 0]
    with open(RUN / "agents.csv", newline="", encoding="utf-8") as file:
        return json.loads((RUN / "outcome.json").read_text()), list(csv.DictReader(file))


def first_and_last():
    """(time_s, positions, velocities) of the first and last frame of the recording, read as tools/shm/README.md says."""
    data = PLAIN.read_bytes()
    frames = [r for r in recording_file.records(data) if r.kind == recording_file.FRAME]
    for record in (frames[0], frames[-1]):
        _, number, _, count, *_ = record.descriptor(data)
        fields = np.frombuffer(record.payload(data), "<f4").reshape(7, count)
        yield number / 30, fields[4:].T, fields[1:4].T


def needs(module, package):
    return unittest.skipUnless(importlib.util.find_spec(module), f"needs {package} (tools/install_dependencies.sh readers)")


def needs_npm(name):
    there = works("node") and (READERS / name).is_dir()
    return unittest.skipUnless(there, f"needs node and npm's {name} in {READERS}")


class ExportTest(SystemTest):
    def setUp(self):
        super().setUp()
        self.outcome, self.agents = recorded_run()
        self.out = self.folder / "out"

    def export(self, *arguments):
        """What an export says, run in this process."""
        with contextlib.redirect_stdout(io.StringIO()) as said, contextlib.redirect_stderr(said):
            code = cli.main(["export", *map(str, arguments), "--out", str(self.out)])
        self.assertEqual(code, 0, said.getvalue())
        return said.getvalue()

    def rows(self, name):
        with open(self.out / name, newline="", encoding="utf-8") as file:
            return list(csv.DictReader(file))

    def node(self, script, *arguments):
        command = ["node", "--input-type=module", "-e", script, READERS, *arguments]
        done = subprocess.run(command, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)

    def assert_states(self, states):
        """Of the last frame, as words: as many arrived and dead as outcome.json says."""
        states = list(states)
        for word in ("arrived", "dead"):
            self.assertEqual(states.count(word), self.outcome[word])
        self.assertEqual(len(states), self.outcome["agents"])


class Tables(ExportTest):
    def test_csv_has_all_frames_and_ends_as_the_outcome_says(self):
        self.assertIn("no poses.csv: states are unknown", self.export(RUN, "--water", RECORDING, "--to", "csv"))
        water, people = self.rows("water.csv"), self.rows("people.csv")
        self.assertEqual(len(water), FRAMES * 640)
        last = [row for row in people if row["frame"] == people[-1]["frame"]]
        self.assert_states(row["state"] for row in last)
        # trajectories.sqlite holds no states: empty before an end, the state of agents.csv at the end of the run.
        ends = {agent["id"]: float(agent["time_s"]) for agent in self.agents}
        self.assertEqual({row["state"] for row in people if float(row["time_s"]) < ends[row["id"]] - 1e-3}, {""})
        self.assertEqual([row["state"] for row in last if self.agents[int(row["id"])]["outcome"] == "active"],
                         [agent["state"] for agent in self.agents if agent["outcome"] == "active"])
        for row, agent in zip(last, self.agents):
            self.assertEqual((row["id"], row["height_m"]), (agent["id"], agent["height_m"]))
            self.assertLess(max(abs(float(row[name]) - float(agent[name])) for name in ("x_m", "z_m")), 0.02)
        for (time_s, places, velocities), rows in zip(first_and_last(), (water[:640], water[-640:])):
            self.assertAlmostEqual(float(rows[0]["time_s"]), time_s, 6)
            names = ("x_m", "y_m", "z_m", "vx_m_s", "vy_m_s", "vz_m_s")
            found = np.array([[float(row[name]) for name in names] for row in rows])
            # Seven digits are written.
            np.testing.assert_allclose(found, np.concatenate([places, velocities], axis=1), rtol=1e-6, atol=1e-9)

    def test_velocities_of_people_are_those_of_their_paths(self):
        self.export(RUN, "--to", "csv")
        of_one = [row for row in self.rows("people.csv") if row["id"] == "0"]
        for before, row in zip(of_one, of_one[1:]):
            way = float(row["x_m"]) - float(before["x_m"])
            passed = float(row["time_s"]) - float(before["time_s"])
            self.assertAlmostEqual(way, passed * float(row["vx_m_s"]), 4)

    def test_compression_changes_nothing(self):
        tables = []
        for file in (PLAIN, RECORDING):
            self.export(file, "--to", "csv", "--every", 60)
            tables.append((self.out / "water.csv").read_bytes())
        self.assertEqual(*tables)

    def test_time_and_place_are_thinned(self):
        said = self.export(RECORDING, "--to", "csv", "--interval-s", 0.5, "--from-s", 2, "--until-s", 4,
                           "--region", "0,10,4,6")
        rows = self.rows("water.csv")
        self.assertIn("water: 5 frames", said)
        self.assertEqual(sorted({float(row["time_s"]) for row in rows}), [2, 2.5, 3, 3.5, 4])
        self.assertTrue(all(0 <= float(row["x_m"]) <= 10 and 4 <= float(row["z_m"]) <= 6 for row in rows))
        self.assertIn("water: 24 frames", self.export(RECORDING, "--to", "csv", "--every", 10))

    def test_pedpys_text_is_what_its_loader_asks_for(self):
        """load_trajectory_from_txt: comments with the frame rate and x/m, then ID FR X Y Z between blanks."""
        self.export(RUN, "--to", "pedpy", "--every", 6)
        text = (self.out / "people.txt").read_text()
        self.assertEqual(float(re.search(r"#.*framerate: ([\d.]+)", text)[1]), 5)
        self.assertIn("x/m", text)
        rows = np.loadtxt(self.out / "people.txt")
        self.assertEqual(len(np.unique(rows[:, 0])), len(self.agents))
        self.assertEqual(len({(who, frame) for who, frame in rows[:, :2]}), len(rows))
        self.assertTrue(np.all(rows[:, :2] == np.floor(rows[:, :2])))
        # The positions equal the run's trajectories up to the four digits that are written; pos_y is z, too.
        with contextlib.closing(sqlite3.connect(RUN / "trajectories.sqlite")) as database:
            rate = float(database.execute("SELECT value FROM metadata WHERE key = 'fps'").fetchone()[0])
            paths = {(who, round(30 * frame / rate)): place for who, frame, *place in
                     database.execute("SELECT id, frame, pos_x, pos_y FROM trajectory_data")}
        compared = [(row[2:4], paths[who, 6 * frame]) for row in rows if (who := int(row[0]), 6 * (frame := int(row[1]))) in paths]
        self.assertGreater(len(compared), 50)
        self.assertLess(max(np.abs(np.subtract(*pair)).max() for pair in compared), 6e-5)
        ended = [agent for agent in self.agents if agent["outcome"] != "active"]
        self.assertGreater(len(ended), 0)
        for agent in ended:  # no rows after the end of an agent
            own = rows[rows[:, 0] == int(agent["id"])]
            self.assertLessEqual(own[-1, 1] / 5, float(agent["time_s"]) + 0.2)


class Readers(ExportTest):
    @needs("vtk", "python3-vtk9")
    def test_vtk_reads_the_numbers_of_the_recording(self):
        import vtk
        from vtk.util.numpy_support import vtk_to_numpy

        self.export(RUN, "--water", RECORDING, "--to", "vtk", "--every", FRAMES - 1)
        listed = re.findall(r'timestep="([^"]+)".*file="([^"]+)"', (self.out / "water.pvd").read_text())
        self.assertEqual(len(listed), 2)
        reader = vtk.vtkXMLPolyDataReader()
        for (time_s, places, velocities), (told, file) in zip(first_and_last(), listed):
            reader.SetFileName(str(self.out / file))
            reader.Update()
            data = reader.GetOutput()
            self.assertAlmostEqual(float(told), time_s, 6)
            self.assertAlmostEqual(data.GetFieldData().GetArray("TimeValue").GetValue(0), time_s, 6)
            self.assertEqual((data.GetNumberOfPoints(), data.GetNumberOfVerts()), (640, 640))
            # y across, z up.
            self.assertTrue(np.array_equal(vtk_to_numpy(data.GetPoints().GetData()), places[:, [0, 2, 1]]))
            self.assertTrue(np.array_equal(vtk_to_numpy(data.GetPointData().GetVectors()), velocities[:, [0, 2, 1]]))
        reader.SetFileName(str(max(self.out.glob("people_*.vtp"))))
        reader.Update()
        states = vtk_to_numpy(reader.GetOutput().GetPointData().GetArray("state"))
        self.assert_states([*STATES, "unknown"][code] for code in states)

    @needs("vtk", "python3-vtk9")
    def test_vtk_reads_the_depths_of_the_snapshots(self):
        import vtk
        from vtk.util.numpy_support import vtk_to_numpy

        from wade.pictures.run_files import read_water

        self.export(RUN, "--to", "vtk", "--from-s", 1)
        listed = re.findall(r'timestep="([^"]+)".*file="([^"]+)"', (self.out / "depth.pvd").read_text())
        self.assertEqual(float(listed[0][0]), 5)
        time_s, x0, z0, cell, depth = read_water(RUN / "water.bin", 5)
        self.assertEqual(time_s, 5)
        reader = vtk.vtkXMLImageDataReader()
        reader.SetFileName(str(self.out / listed[0][1]))
        reader.Update()
        data = reader.GetOutput()
        self.assertEqual((data.GetOrigin(), data.GetSpacing()), ((x0, z0, 0), (cell, cell, 1)))
        found = vtk_to_numpy(data.GetCellData().GetArray("depth")).reshape(depth.shape)
        self.assertTrue(np.array_equal(found, depth.astype("f4")))
        # A metre of water over 20 x 4 m, but for what its particles' own spacing stretches.
        self.assertAlmostEqual(float(found.sum()) * cell**2 / 80, 1, 1)

    @needs("meshio", "python3-meshio")
    def test_meshio_reads_the_ply(self):
        import meshio

        self.export(RECORDING, "--to", "ply", "--every", FRAMES - 1)
        for (_, places, velocities), file in zip(first_and_last(), sorted(self.out.glob("water_*.ply"))):
            mesh = meshio.read(file)
            self.assertTrue(np.array_equal(mesh.points, places[:, [0, 2, 1]]))
            self.assertTrue(np.array_equal(mesh.point_data["vz"], velocities[:, 1]))

    @needs_npm("gltf-validator")
    def test_gltfs_validator_finds_nothing(self):
        self.export(RUN, "--to", "gltf")
        self.node("""
            import fs from 'fs';
            const [, modules, folder] = process.argv;
            const validator = (await import(modules + '/gltf-validator/index.js')).default;
            const bytes = name => Promise.resolve(new Uint8Array(fs.readFileSync(folder + '/' + name)));
            const report = await validator.validateBytes(await bytes('people.gltf'), {externalResourceFunction: bytes});
            fs.writeFileSync(folder + '/report.json', JSON.stringify(report));""", self.out)
        report = json.loads((self.out / "report.json").read_text())
        self.assertEqual(report["issues"]["messages"], [])
        self.assertEqual(report["info"]["animationCount"], 1)

    @needs_npm("tinyusdz")
    def test_tinyusdz_reads_all_samples(self):
        self.export(RUN, "--water", RECORDING, "--to", "usd", "--every", FRAMES - 1)
        # It follows no reference: in "one" the first person has the mesh itself, for its skeleton to be checked, too.
        head, person, *_ = (self.out / "figures.usda").read_text().split("        def SkelRoot")
        figure = re.search(r'def Mesh "figure"\n +\{\n(.*?) {12}\}\n', head, re.DOTALL)[1]
        person = re.sub(r" +prepend references = .*\n( +\)\n +\{\n)", lambda found: found[1] + figure, person)
        (self.out / "one.usda").write_text(head[: head.index('        class "Figures"')] + "        def SkelRoot" + person + "}\n")
        # The module asks where it runs, and is told a lie.
        self.node("""
            import fs from 'fs';
            globalThis.window = {};
            Object.defineProperty(process, 'type', {value: 'renderer'});
            const [, modules, folder] = process.argv;
            const init = (await import(modules + '/tinyusdz/tinyusdz.js')).default;
            const usd = await init({wasmBinary: fs.readFileSync(modules + '/tinyusdz/tinyusdz.wasm')});
            const read = name => {
                const loader = new usd.TinyUSDZLoaderNative();
                const whole = loader.loadAsLayerFromBinary(new Uint8Array(fs.readFileSync(folder + '/' + name)), name);
                const text = loader.layerToString();
                return [whole && loader.loadFromBinary(new Uint8Array(fs.readFileSync(folder + '/' + name)), name), text,
                        loader.error()];
            };
            fs.writeFileSync(folder + '/read.json', JSON.stringify(['water', 'people', 'figures', 'one'].map(name => read(name + '.usda'))));
            process.exit(0);""", self.out)
        layers = json.loads((self.out / "read.json").read_text())
        for whole, _, error in layers:
            self.assertEqual((whole, error), (True, ""))
        water, people, figures, _ = (text for _, text, _ in layers)
        samples = re.search(r"point3f\[\] points\.timeSamples = \{(.*?)\}", water, re.DOTALL)[1].strip().splitlines()
        self.assertEqual(len(samples), 2)
        for (time_s, places, _), line in zip(first_and_last(), samples):
            code, values = line.split(":", 1)
            self.assertAlmostEqual(float(code), 30 * time_s, 4)
            found = np.array(re.findall(r"-?[\d.]+(?:e[-+]?\d+)?", values), float).reshape(-1, 3)
            np.testing.assert_allclose(found, places[:, [0, 2, 1]], rtol=1e-5, atol=1e-6)  # tinyusdz prints six digits
        for name in ("positions", "orientations", "velocities", "ids", "protoIndices", "primvars:state"):
            self.assertIn(f" {name}.timeSamples", people)
        # One skeleton per person; its path ends at the last position of the person.
        roots = figures.split("def SkelRoot")[1:]
        self.assertEqual(len(roots), len(self.agents))
        for text, agent in zip(roots, self.agents):
            self.assertIn(f'"person_{agent["id"]}"', text)
            last = re.findall(r"\d+: \(([^()]*)\)", text[text.index("xformOp:translate.timeSamples"):].split("}")[0])[-1]
            x, y, _ = map(float, last.split(","))
            self.assertLess(np.hypot(x - float(agent["x_m"]), y - float(agent["z_m"])), 0.05)  # a step of 1/30 s at 1.4 m/s
            self.assertEqual(text.count('"trunk/arm_right"'), 2)


def volume_of(vertices, triangles):
    """Volume within a mesh, m3, positive if its triangles go round anticlockwise as seen from outside."""
    a, b, c = np.moveaxis(np.asarray(vertices, float)[triangles], 1, 0)
    return np.sum(a * np.cross(b, c)) / 6


def is_closed(triangles):
    """Whether each edge lies between two triangles that go round alike."""
    edges = np.concatenate([triangles[:, [i, (i + 1) % 3]] for i in range(3)])
    there, back = (sorted(map(tuple, pairs.tolist())) for pairs in (edges, edges[:, ::-1]))
    return there == back


class Surfaces(ExportTest):
    def read_obj(self, file):
        rows = [line.split() for line in file.read_text().splitlines()]
        points = np.array([row[1:] for row in rows if row[0] == "v"], float)
        return points, np.array([row[1:] for row in rows if row[0] == "f"], int).reshape(-1, 3) - 1

    @needs("skimage", "python3-skimage")
    def test_the_mesh_round_particles_holds_their_water(self):
        # 640 particles of 125 kg: 80 m3, 1 m deep on 20 m x 4 m. The smoothing rounds the edges of the block, 52 m without those at
        # the bed: by 0.83 of the squared width of 0.375 m, the area beyond the contour where the product of
        # two error functions is a half. That is 6 m3, 8 %; half as much again for particles that lie anyhow.
        for spacing in (0.35, 0.25):
            self.export(RUN, "--water", RECORDING, "--to", "obj", "--every", FRAMES - 1, "--spacing", spacing)
            for file in sorted(self.out.glob("surface_*.obj")):
                points, triangles = self.read_obj(file)
                self.assertTrue(is_closed(triangles))
                self.assertLess(abs(volume_of(points, triangles) / 80 - 1), 0.12)
                x, y, z = points.T  # y up, -z across
                self.assertLess(abs(np.median(y[y > 0.5]) - 1), 0.15)
                self.assertTrue(3.8 < -z.max() and -z.min() < 8.2 and y.min() > -0.01)
        people, triangles = self.read_obj(sorted(self.out.glob("people_*.obj"))[-1])
        self.assertTrue(is_closed(triangles))
        # Six bodies of up to 2 m; of water's density they weigh as people do.
        self.assertTrue(6 * 0.03 < volume_of(people, triangles) < 6 * 0.11)

    @needs("meshio", "python3-meshio")
    @needs("skimage", "python3-skimage")
    def test_meshio_reads_the_surface_with_its_velocities(self):
        import meshio

        self.export(RECORDING, "--to", "ply", "--every", FRAMES - 1)
        for (_, _, velocities), file in zip(first_and_last(), sorted(self.out.glob("surface_*.ply"))):
            mesh = meshio.read(file)
            triangles = mesh.cells_dict["triangle"]
            self.assertTrue(is_closed(triangles))
            self.assertGreater(volume_of(mesh.points, triangles), 0)
            # The surface moves as the water: means over all, to a tenth of the largest speed.
            mean = np.mean(mesh.point_data["vx"]) - np.mean(velocities[:, 0])
            self.assertLess(abs(mean), 0.1 * np.abs(velocities).max())

    def test_columns_and_snapshots_have_closed_surfaces_of_their_volume(self):
        from wade.export.sources import Points
        from wade.export.surfaces import are_columns, over_columns

        # Two layers of particles in columns of 1 m on a bed that rises, 0.5 m deep in x < 5 m, dry beyond.
        x, z = (axis.ravel() + 0.5 for axis in np.meshgrid(np.arange(5.0), np.arange(3.0)))
        layers = np.concatenate([0.1 * x + depth for depth in (0.125, 0.375)])
        both, still = (np.tile(axis, 2) for axis in (x, z)), np.zeros(2 * len(x))
        arrays = dict(zip("xz", both)) | {"y": layers, "vx": still - 1, "vy": still, "vz": still, "mass": still + 250}
        points = Points(1, 0.0, arrays)
        self.assertTrue(are_columns(points))
        mesh = over_columns(points, 1.0, 1000)
        self.assertTrue(is_closed(mesh.triangles))
        # Heights at corners are means of the cells round them, which keeps the volume of columns of one depth.
        self.assertAlmostEqual(volume_of(mesh.vertices, mesh.triangles), 7.5, 6)
        np.testing.assert_allclose(mesh.velocities, np.tile([-1, 0, 0], (len(mesh.vertices), 1)), atol=1e-12)
        self.assertIn("surface: ", self.export(RUN, "--to", "obj"))
        points, triangles = self.read_obj(sorted(self.out.glob("surface_*.obj"))[-1])
        self.assertTrue(is_closed(triangles))
        # The snapshot has whole millimetres in cells of half a metre; corners beside dry ground round it off.
        self.assertLess(abs(volume_of(points, triangles) / 80 - 1), 0.05)

    @unittest.skipUnless(os.environ.get("WADE_RENDER") and works("blender"), "a long test, system_render; needs blender")
    def test_blender_opens_people_and_water(self):
        self.export(RUN, "--to", "gltf")
        opener = self.out / "open_in_blender.py"
        probe = self.folder / "probe.py"
        with contextlib.redirect_stdout(io.StringIO()):
            self.assertEqual(cli.main(["export", str(RUN), "--to", "ply", "--out", str(self.folder / "ply")]), 0)
        for file in (self.folder / "ply").glob("surface_*.ply"):
            shutil.copy(file, self.out)
        probe.write_text(f"""
import bpy, runpy
runpy.run_path({str(opener)!r}, run_name="__main__")
scene, water = bpy.context.scene, bpy.data.objects["water"]
people = [thing for thing in bpy.data.objects if thing.name.startswith("person")]
places = []
for frame in (1, scene.frame_end):
    scene.frame_set(frame)
    places.append([tuple(one.matrix_world.translation) for one in people])
    print("WADE", frame, len(people), water["file"], len(water.data.polygons))
print("WADE moved", max(abs(b[1] - a[1]) for a, b in zip(*places)) > 1)
""")
        done = subprocess.run(["blender", "--background", "--factory-startup", "--python", probe], capture_output=True, text=True)
        said = [line.split() for line in done.stdout.splitlines() if line.startswith("WADE")]
        self.assertEqual(len(said), 3, done.stdout + done.stderr)
        self.assertEqual([row[2] for row in said[:2]], ["6", "6"])
        self.assertNotEqual(said[0][3], said[1][3])
        self.assertEqual(said[2], ["WADE", "moved", "True"])


class Maps(ExportTest):
    def flooded(self):
        """A run in a small site and its recording."""
        scene, run, file = self.folder / "basin.json", self.folder / "flood", self.folder / "flood.wrec"
        scene.write_text(json.dumps(BASIN))
        server = self.start(SERVER, scene, "--session", self.session, "--consumers", "2", "--out", run)
        recorder = self.start(PROGRAMS / "shm_record", self.session, file, "--compression", "0")
        client = self.start(CLIENT, scene, "--session", self.session, "--out", run, "--water-every-s", "1")
        self.assert_ended_well(server, client, recorder)
        return run, file

    def bands_of(self, file):
        """What gdalinfo says of a file, and its values as GDAL's own raw format has them, the southern row first."""
        raw = self.folder / "raw"
        told = subprocess.run(["gdalinfo", "-json", file], capture_output=True, text=True, check=True)
        subprocess.run(["gdal_translate", "-q", "-of", "ENVI", file, raw], check=True)
        info = json.loads(told.stdout)
        columns, rows = info["size"]
        return info, np.fromfile(raw, "<f4").reshape(len(info["bands"]), rows, columns)[:, ::-1].astype(float)

    @unittest.skipUnless(works("gdal_translate", "gdalinfo"), "needs gdal-bin (tools/install_dependencies.sh readers)")
    def test_gdal_finds_the_water_of_each_time_where_it_lies(self):
        run, file = self.flooded()
        said = self.export(run, "--water", file, "--to", "geotiff")
        self.assertIn("water: 40 frames", said)
        frames = [self.bands_of(tif) for tif in sorted(self.out.glob("water_*.tif"))[7::8]]
        info, (depth, speed, product, hazard) = frames[-1]
        self.assertEqual(info["geoTransform"], [500000, 1, 0, 5300016, 0, -1])
        self.assertIn('ID["EPSG",32632]', info["coordinateSystem"]["wkt"])
        self.assertEqual([band["description"] for band in info["bands"]], ["depth_m", "speed_m_s", "dv_m2_s", "arr_h"])
        self.assertEqual(float(info["metadata"][""]["time_s"]), 4)
        # 24 m over (0.5 - 0.08 z) m, z from 0 to 6.25 m: 37.5 m3 less the house's 12 m x 0.22 m, and 6 m3/s over 4 s.
        self.assertAlmostEqual(np.nansum(depth) / (37.5 - 12 * 0.22 + 24), 1, 2)
        self.assertTrue(np.isnan(depth[2:5, 8:12]).all() and np.isfinite(np.delete(depth, range(8, 12), axis=1)).all())
        np.testing.assert_allclose(product, depth * speed, rtol=1e-6)
        self.assertGreater(np.nanmax(speed), 0.1)
        self.assertEqual(set(np.unique(hazard[np.isfinite(hazard)])) - {0, 1, 2, 3, 4}, set())

        # The maps, which the server wrote, hold no less than any frame; where water rose all the time they are the last one.
        _, (largest,) = self.bands_of(self.out / "max_depth_m.tif")
        for _, (depth, *_) in frames:
            self.assertLess(np.nanmax(depth - largest), 0.002)  # thin water is dealt to what is shown
        self.assertLess(np.nanmedian(np.abs(depth - largest)[depth > 0.05]), 0.02)
        self.assertEqual((self.out / "arrival_s.tif").read_bytes(), (run / "maps" / "arrival_s.tif").read_bytes())

        # Without a recording there are depths only.
        said = self.export(run, "--to", "geotiff", "--from-s", 2, "--interval-s", 2, "--region", "2,9,0,4")
        self.assertIn("depth: 2 frames", said)
        info, (part,) = self.bands_of(self.out / "water_000040.tif")
        self.assertEqual((info["geoTransform"], part.shape), ([500002, 1, 0, 5300004, 0, -1], (4, 7)))
        np.testing.assert_allclose(part, depth[:4, 2:9], atol=0.002)

    @unittest.skipUnless(works("gdal_translate", "gdalinfo"), "needs gdal-bin (tools/install_dependencies.sh readers)")
    def test_a_channel_has_no_coordinate_system_but_a_place_in_its_own_metres(self):
        self.export(RUN, "--water", RECORDING, "--to", "geotiff", "--every", FRAMES - 1)
        info, (depth, *_) = self.bands_of(max(self.out.glob("water_*.tif")))
        self.assertEqual((info["geoTransform"], depth.shape), ([0, 0.5, 0, 8, 0, -0.5], (8, 40)))
        self.assertAlmostEqual(depth.sum() * 0.25, 80, 2)

    def test_pillow_reads_the_depths_of_the_snapshots(self):
        from wade.pictures.run_files import read_map

        self.assertIn("depth: 1 frames", self.export(RUN, "--to", "geotiff", "--from-s", 1, "--until-s", 6))
        depth, dx, dz = read_map(self.out / "water_000150.tif")
        self.assertEqual((depth.shape, dx, dz), ((8, 40), 0.5, 0.5))
        self.assertAlmostEqual(depth.sum() * dx * dz, 80, 1)  # the file rounds to millimetres
        self.assert_refused_here("export", RECORDING, "--to", "geotiff", "--out", self.out, texts=["needs the run folder"])


class Walking(ExportTest):
    def test_feet_keep_time_with_the_way(self):
        """The accessors of the glTF by its specification: a step is as long as Inman's rule says of the mean speed."""
        self.export(RUN, "--to", "gltf")
        document = json.loads((self.out / "people.gltf").read_text())
        data = (self.out / document["buffers"][0]["uri"]).read_bytes()

        def values(index):
            accessor = document["accessors"][index]
            at = document["bufferViews"][accessor["bufferView"]]["byteOffset"]
            width = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}[accessor["type"]]
            flat = struct.unpack_from(f"<{accessor['count'] * width}f", data, at)
            return np.array(flat).reshape(-1, width)

        animation = document["animations"][0]
        for root in document["scenes"][0]["nodes"]:
            node = document["nodes"][root]
            agent = self.agents[node["extras"]["id"]]
            tracks = {}
            for channel in animation["channels"]:
                sampler = animation["samplers"][channel["sampler"]]
                target = channel["target"]["node"], channel["target"]["path"]
                tracks[target] = values(sampler["input"]), values(sampler["output"])
            times, places = tracks[root, "translation"]
            self.assertTrue(np.all(np.diff(times[:, 0]) > 0))
            # glTF is right-handed with y up: z is Wade's -z.
            self.assertLess(np.abs(places[-1] - [float(agent["x_m"]), 0, -float(agent["z_m"])]).max(), 0.02)
            end = min(float(agent["time_s"]), times[-1, 0])
            keys, turns = tracks[root + 2, "rotation"]
            steps = np.sum((np.abs(turns[:, 2]) > 0.05) & (keys[:, 0] <= end))
            self.assertGreater(steps, 5)
            way = np.sum(np.hypot(*np.diff(places[:, [0, 2]], axis=0).T))
            length = np.sqrt(0.24 * float(agent["height_m"]) * way / end)
            # A walk of n steps takes n or n + 1 of them; speeds differ, and the rule is a root: 10 % more is allowed.
            self.assertLess(abs(steps * length / way - 1), 0.1 + 1 / steps)


    def test_legs_and_arms_of_skeletons_swing_in_turn(self):
        self.export(RUN, "--to", "usd")
        for text, agent in zip((self.out / "figures.usda").read_text().split("def SkelRoot")[1:], self.agents):
            rows = text.split("rotations.timeSamples = {")[1].split("}")[0]
            values = np.array(re.findall(r"-?[\d.]+(?:e[-+]?\d+)?", rows), float).reshape(-1, 21)  # a time, five quaternions
            seconds, turns = values[:, 0] / 30, values[:, 1:].reshape(-1, 5, 4)
            np.testing.assert_allclose(np.sum(turns**2, axis=2), 1, atol=1e-6)
            walks = seconds < float(agent["time_s"])
            left, right = turns[:, 1, 2], turns[:, 2, 2]
            np.testing.assert_allclose(left, -right, atol=1e-9)
            np.testing.assert_allclose(turns[:, 3, 2], right, atol=1e-9)  # the left arm goes with the right leg
            # A step of Inman's rule at 1.3 m/s is 0.73 m of a leg of 0.9 m: 23 degrees to either side, half of them as sine.
            self.assertTrue(0.1 < np.abs(left[walks]).max() < 0.32, np.abs(left[walks]).max())
            self.assertTrue(np.all(turns[:, 0, 0] == 1))


class Films(ExportTest):
    def film(self, *arguments):
        """(exit code, what it said) of tools/wade film, in this process."""
        with contextlib.redirect_stdout(io.StringIO()) as said, contextlib.redirect_stderr(said):
            return cli.main(["film", str(RUN), "--out", str(self.folder / "film.mp4"), *map(str, arguments)]), said.getvalue()

    @unittest.skipUnless(works("ffmpeg", "ffprobe"), "needs ffmpeg")
    def test_ffprobe_finds_the_frames_that_were_asked_for_and_they_move(self):
        code, said = self.film("--water", RECORDING, "--rate-hz", 5, "--speed", 4, "--width-px", 320)
        self.assertEqual(code, 0, said)
        file = self.folder / "film.mp4"
        asked = "stream=codec_name,pix_fmt,width,nb_frames,r_frame_rate"
        found = json.loads(subprocess.run(["ffprobe", "-v", "error", "-show_entries", asked, "-of", "json", file],
                                          capture_output=True, check=True).stdout)["streams"][0]
        last_s = self.outcome["sim_time_s"]
        self.assertEqual((found["codec_name"], found["pix_fmt"], found["width"], found["r_frame_rate"]),
                         ("h264", "yuv420p", 320, "5/1"))
        self.assertEqual(int(found["nb_frames"]), int(last_s * 5 / 4 + 1e-6) + 1)
        raw = subprocess.run(["ffmpeg", "-v", "error", "-i", file, "-f", "rawvideo", "-pix_fmt", "gray", "-"],
                             capture_output=True, check=True).stdout
        frames = np.frombuffer(raw, np.uint8).reshape(int(found["nb_frames"]), -1).astype(int)
        for before, after in zip(frames, frames[1:]):
            self.assertGreater(np.sum(np.abs(after - before) > 20), 10)
        self.assertEqual([path.name for path in self.folder.glob("*film*")], ["film.mp4"])

    def test_its_last_frame_counts_as_the_outcome_says(self):
        from wade.export.sources import Thinning
        from wade.pictures.film import Film

        drawn = Film(RUN, None, Thinning(), 320)
        last_s = self.outcome["sim_time_s"]
        drawn.advance(last_s)
        self.assertEqual(drawn.people_at(last_s), {word: self.outcome[word] for word in ("arrived", "dead", "active")})

    def test_without_ffmpeg_it_says_what_to_install(self):
        with mock.patch.dict(os.environ, {"PATH": str(self.folder)}):
            code, said = self.film()
        self.assertEqual(code, 2)
        self.assertIn("apt-get install ffmpeg", said)

    def test_wrong_choices_are_told(self):
        for wrong, text in ((["--width-px", "321"], "even numbers from 320"), (["--rate-hz", "0"], "1 to 120"),
                            (["--out", "film.avi"], ".mp4"), (["--speed", "0"], "above 0")):
            self.assert_refused_here("film", RUN, *wrong, texts=[wrong[0], text])


class Rendered(ExportTest):
    @unittest.skipUnless(os.environ.get("WADE_RENDER") and works("blender"), "a long test, system_render; needs blender")
    def test_blender_renders_water_and_people(self):
        from PIL import Image

        file = self.folder / "moment.png"
        with contextlib.redirect_stdout(io.StringIO()) as said, contextlib.redirect_stderr(said):
            code = cli.main(["render", str(RUN), "--water", str(RECORDING), "--time", "2", "--out", str(file), "--width-px", "128",
                             "--samples", "4"])
        self.assertEqual(code, 0, said.getvalue())
        with Image.open(file) as picture:
            self.assertEqual(picture.size, (128, 72))
            self.assertGreater(len(picture.convert("RGB").getcolors(128 * 72)), 500)

    def test_without_blender_it_says_what_to_install(self):
        with mock.patch.dict(os.environ, {"PATH": str(self.folder)}):
            self.assert_refused_here("render", RUN, "--time", "1", texts=["apt-get install blender"])
        self.assert_refused_here("render", self.folder, "--time", "1", texts=["is no run folder"])
        self.assert_refused_here("render", RUN, "--time", "1", "--eye", "1,2", texts=["--eye", "x,y,z"])


class Interrupted(ExportTest):
    def interrupted(self, number, moment):
        """(exit code, stderr) of an export that gets a signal as soon as moment(its id) is true."""
        command = [ROOT / "tools" / "wade", "export", RUN, "--water", RECORDING, "--to", "csv", "--out", self.out]
        with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as program:
            while program.poll() is None and not moment(program.pid):
                time.sleep(0.001)
            program.send_signal(number)
            return program.wait(60), program.stderr.read()

    def test_a_signal_ends_an_export_in_one_line_and_leaves_nothing(self):
        def among_imports(pid):
            caught = re.search(r"SigCgt:\s*(\w+)", Path(f"/proc/{pid}/status").read_text())
            return caught and int(caught[1], 16) >> (signal.SIGHUP - 1) & 1  # the last one that is set

        def at_work(_):
            return any(self.out.glob(".part-*/*"))

        for number, moment in itertools.product((signal.SIGINT, signal.SIGTERM, signal.SIGHUP), (among_imports, at_work)):
            with self.subTest(signal=number.name, moment=moment.__name__):
                code, said = self.interrupted(number, moment)
                self.assertEqual(code, 128 + number)
                self.assertNotIn("Traceback", said)
                self.assertEqual(said.count("interrupted"), 1, said)
                self.assertRegex(said.splitlines()[-1], f"^wade( export)?: interrupted by {number.name}$")
                self.assertFalse(self.out.exists())


class Refusals(ExportTest):
    def refused(self, *arguments, texts):
        self.assert_refused_here("export", *arguments, "--out", self.out, texts=texts)

    def test_bad_input_is_told_in_a_line(self):
        nothing, text = self.folder / "nothing", self.folder / "text.wrec"
        text.write_text("my only copy")
        self.refused(nothing, "--to", "vtk", texts=[str(nothing), "no such run folder or recording"])
        self.refused(self.folder, "--to", "vtk", texts=["is no run folder", "manifest.json"])
        self.refused(text, "--to", "vtk", texts=["is no recording"])
        self.refused(RUN, "--to", "fbx", texts=["--to", "fbx", "gltf"])
        self.refused(RECORDING, "--to", "gltf", texts=["gltf is for people"])
        self.refused(RUN, "--to", "csv", "--water", RUN, texts=["cannot read"])
        self.refused(RUN, "--to", "csv", "--region", "3,2,0,1", texts=["--region", "x0 < x1"])
        self.refused(RUN, "--to", "csv", "--every", "0", texts=["--every", "from 1"])
        self.refused(RUN, "--to", "csv", "--from-s", "-1", texts=["--from-s", "0 or more"])

    def test_a_recording_that_was_cut_off_opens_to_its_last_whole_frame(self):
        data = RECORDING.read_bytes()
        seventh = recording_file.records(data)[6]
        file = self.folder / "part.wrec"
        for cut in (seventh.at + 5, seventh.body_at + 300, seventh.end - 1, seventh.at):
            file.write_bytes(data[:cut])
            said = self.export(file, "--to", "csv")
            self.assertIn("water: 6 frames", said)
            self.assertEqual("cut off" in said, cut != seventh.at)
        file.write_bytes(data[: recording_file.HEAD_BYTES + recording_file.PAGE_BYTES])
        self.refused(file, "--to", "csv", texts=["holds no whole frame"])

    def test_damaged_particles_are_refused(self):
        data = bytearray(RECORDING.read_bytes())
        data[recording_file.records(data)[6].end - 1] ^= 0x10
        file = self.folder / "spoilt.wrec"
        file.write_bytes(data)
        self.refused(file, "--to", "csv", texts=["damaged", "frame 7"])


if __name__ == "__main__":
    unittest.main()
