"""Programs of others that look on: into trajectories.sqlite during a run, which keeps each of its frames, and engines."""

import ctypes
import os
import signal
import sqlite3
import subprocess
import sys
import unittest
from unittest import mock

import numpy as np
from harness import ENDLESS, PROGRAMS, ROOT, SystemTest, wait_until

from wade.outside import works

ENGINES = ROOT / "tools" / "engines"
LIBRARY, VIEWER = PROGRAMS / "libwade_shm.so", PROGRAMS / "wade_view_server"
needs_mono = unittest.skipUnless(works("mcs", "mono"),
                                 "needs mono-mcs and mono-runtime (tools/install_dependencies.sh readers)")
sys.path += [str(ENGINES), str(ROOT / "tools" / "producers" / "python")]

# Prints each frame that it sees, and that the stream has ended.
DRIVER = """
using System;
using System.Globalization;

static class Driver
{
    static void Show(double number, double time, int count, params float[][] arrays)
    {
        Console.Write(number + " " + time.ToString("R", CultureInfo.InvariantCulture));
        foreach (float[] values in arrays)
            for (int k = 0; k < count && k < values.Length; ++k)
                Console.Write(" " + values[k].ToString("R", CultureInfo.InvariantCulture));
        Console.WriteLine();
    }

    static int Main(string[] arguments)
    {
        try
        {
            if (arguments[1] == "web")
                using (var web = new Wade.WebStream(arguments[0]))
                    for (;;)
                    {
                        Wade.News news = web.Poll();
                        if (news == Wade.News.End) { Console.WriteLine("end"); return 0; }
                        if (news == Wade.News.Nothing) { System.Threading.Thread.Sleep(1); continue; }
                        Show(web.Number, web.TimeS, web.Count, web.X, web.Y, web.Z, web.Vx, web.Vy, web.Vz, web.Volume);
                    }
            using (var stream = new Wade.Stream(arguments[0], arguments[1] == "people", 10))
                for (;;)
                {
                    Wade.News news = stream.Poll();
                    if (news == Wade.News.End) { Console.WriteLine("end"); return 0; }
                    if (news == Wade.News.Nothing) { System.Threading.Thread.Sleep(1); continue; }
                    Show(stream.Number, stream.TimeS, stream.Count, stream.X, stream.Y, stream.Z, stream.Vx, stream.Vy,
                         stream.Vz, stream.Mass, stream.Radius, stream.Height, stream.State);
                }
        }
        catch (Wade.StreamException error) { Console.WriteLine(error.Code + " " + error.Message); return 1; }
    }
}
"""


class Readers(SystemTest):
    def setUp(self):
        super().setUp()
        self.water, self.crowd = self.server(*ENDLESS), self.client(*ENDLESS)
        self.file = self.crowd.run.folder / "trajectories.sqlite"
        self.wait_for_frame(5, self.water, self.crowd)

    def opened(self):
        """A connection of another program, which is given back at the end of the test."""
        database = sqlite3.connect(self.file, isolation_level=None, timeout=30)
        self.addCleanup(database.close)
        return database

    def go_on(self, frames):
        goal = self.acknowledged_frame() + frames
        wait_until(lambda: self.acknowledged_frame() >= goal or not self.crowd.running(), f"frame {goal}")
        self.assertTrue(self.crowd.running(), self.crowd.messages())

    def end(self):
        """Ends the run as a user does; returns the frames that it took."""
        self.crowd.send(signal.SIGINT)
        self.assert_ends(self.crowd, 130)
        self.assert_ends(self.water, 5)
        outcome = self.crowd.run.outcome()
        self.assertEqual(outcome["status"], "interrupted")
        return outcome["steps"]

    def frames_in(self, file):
        database = sqlite3.connect(file)
        try:
            return [row[0] for row in database.execute("SELECT frame FROM frame_data ORDER BY frame")]
        finally:
            database.close()

    def test_query_that_is_left_open(self):
        cursor = self.opened().execute("SELECT count(*) FROM trajectory_data UNION ALL SELECT 1")
        cursor.fetchone()
        self.go_on(20)
        steps = self.end()
        self.assertIn("-wal", self.crowd.messages())
        self.assertEqual(self.frames_in(self.file), list(range(steps + 1)))

    def test_lock_for_a_while(self):
        database = self.opened()
        for _ in range(3):
            database.execute("BEGIN IMMEDIATE")
            self.go_on(5)
            database.execute("ROLLBACK")
            self.go_on(5)
        database.close()
        steps = self.end()
        self.assertEqual(self.frames_in(self.file), list(range(steps + 1)))
        self.assertNotIn("warning", self.crowd.messages())

    def test_lock_for_ever(self):
        self.opened().execute("BEGIN EXCLUSIVE")
        self.go_on(20)
        steps = self.end()
        rest = self.file.with_name("trajectories.rest.sqlite")
        self.assertIn(str(rest), self.crowd.messages())
        self.assertEqual(self.frames_in(self.file) + self.frames_in(rest), list(range(steps + 1)))

    def test_file_that_is_deleted(self):
        self.file.unlink()
        self.go_on(20)
        steps = self.end()
        kept = self.frames_in(self.file.with_name("trajectories.rest.sqlite"))
        self.assertEqual(kept, list(range(kept[0], steps + 1)))
        self.assertIn("moved or deleted", self.crowd.messages())


class Engines(SystemTest):
    """The bridges of tools/engines see what a producer of centimetres with other axes sends, in the world's axes."""

    COUNT = 3

    def setUp(self):
        super().setUp()
        if not LIBRARY.exists():
            self.skipTest(f"needs {LIBRARY}")
        with mock.patch.dict(os.environ, {"WADE_SHM_LIBRARY": str(LIBRARY)}):
            import producer_ctypes

            self.abi, self.library = producer_ctypes, producer_ctypes.Library()

    def producer_of(self, kind):
        stream, publisher = self.abi.Stream(), ctypes.c_void_p()
        self.library("stream_defaults", ctypes.byref(stream))
        stream.producer_name, stream.kind, stream.capacity, stream.metres_per_unit = b"test", kind, self.COUNT, 0.01
        stream.origin[:], stream.axes[:] = (1, 2, 3), (2, -3, 1)
        self.library("publisher_open", self.session.encode(), ctypes.byref(stream), None, ctypes.byref(publisher))
        self.addCleanup(self.library, "publisher_free", publisher)
        return publisher

    def send(self, publisher, kind, final=False):
        """Sends a frame; returns its values in the world: x, y, z, vx, vy, vz, mass, radius, height, state."""
        slot = self.abi.Slot()
        self.library("publisher_begin_frame", publisher, ctypes.byref(slot))
        names = self.abi.FIELDS + ("radius", "height", "state") * (kind == 2)
        sent = {name: np.float32(10 * slot.frame + 100 * i + np.arange(self.COUNT)) for i, name in enumerate(names)}
        if kind == 2:
            sent["state"] = np.float32([0, 1, 2])
        for name, values in sent.items():
            np.ctypeslib.as_array(getattr(slot, name), (self.COUNT,))[:] = values
        self.library("publisher_end_frame", publisher, self.COUNT, None, int(final))
        world = [1 + 0.01 * sent["py"], 2 - 0.01 * sent["pz"], 3 + 0.01 * sent["px"],
                 0.01 * sent["vy"], -0.01 * sent["vz"], 0.01 * sent["vx"], sent["mass"]]
        return np.array(world + ([0.01 * sent["radius"], 0.01 * sent["height"], sent["state"]] if kind == 2 else []))

    def test_python(self):
        from wade_stream import Stream, StreamError

        with self.assertRaisesRegex(StreamError, self.session) as error:
            Stream(self.session, library=LIBRARY, attach_timeout_s=0.01)
        self.assertEqual(error.exception.code, 3)
        for kind in (1, 2):
            publisher = self.producer_of(kind)
            world = self.send(publisher, kind)
            reader = Stream(self.session, people=kind == 2, library=LIBRARY)
            self.assertTrue(reader.poll())
            self.assertEqual((reader.number, reader.count, reader.final), (1, self.COUNT, False))
            self.assertAlmostEqual(reader.time_s, (2 - kind) / 30)  # agents begin at 0
            x, y, z = world[:3]
            # Unreal: left-handed, z up, centimetres; Blender: right-handed, z up; glTF: right-handed, y up.
            for program, expected in (("wade", (x, y, z)), ("unity", (x, y, z)), ("unreal", (100 * x, -100 * z, 100 * y)),
                                      ("blender", (x, z, y)), ("gltf", (x, y, -z))):
                np.testing.assert_allclose(np.reshape(reader.places(program), (-1, 3)).T, expected, rtol=1e-6)
            np.testing.assert_allclose(np.reshape(reader.velocities("unreal"), (-1, 3)).T,
                                       100 * world[[3, 5, 4]] * [[1], [-1], [1]], rtol=1e-6)
            for name, values in zip(("mass", "radius", "height", "state"), world[6:]):
                np.testing.assert_allclose(reader.values(name), values, rtol=1e-6)
            self.assertFalse(reader.poll(), "no newer frame")
            self.send(publisher, kind, final=True)
            self.assertTrue(reader.poll() and reader.final)
            self.library("publisher_close", publisher)
            self.assertFalse(reader.poll())
            self.assertTrue(reader.ended)
            reader.close()

    def driver(self):
        """The C# file with a program round it, in the language that Unity 2018 and later take."""
        source, program = self.folder / "Driver.cs", self.folder / "driver.exe"
        source.write_text(DRIVER)
        subprocess.run(["mcs", "-langversion:7", f"-out:{program}", ENGINES / "WadeStream.cs", source], check=True)
        return program

    @needs_mono
    @unittest.skipUnless(VIEWER.exists(), f"needs {VIEWER}")
    def test_csharp_over_the_socket_of_the_viewer(self):
        program, three = self.driver(), self.folder / "three"
        for name in ("build/three.module.js", "build/three.core.js", "examples/jsm/controls/OrbitControls.js"):
            (three / name).parent.mkdir(parents=True, exist_ok=True)
            (three / name).write_text("// three\n")  # not requested in this test
        publisher = self.producer_of(1)
        worlds = [self.send(publisher, 1)]
        command = [VIEWER, "--session", self.session, "--page", ROOT / "tools" / "viewer" / "page", "--three", three]
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as viewer:
            address = viewer.stdout.readline().strip()  # with the key of the page
            with subprocess.Popen(["mono", program, address, "web"], stdout=subprocess.PIPE, text=True) as mono:
                lines = [mono.stdout.readline()]
                worlds.append(self.send(publisher, 1, final=True))
                self.library("publisher_close", publisher)
                lines += mono.stdout.readlines()
            viewer.send_signal(signal.SIGTERM)
        self.assertEqual((mono.returncode, lines[-1], len(lines)), (0, "end\n", 3), lines)
        for frame, (line, world) in enumerate(zip(lines, worlds), 1):
            number, time_s, *values = map(float, line.split())
            self.assertEqual(number, frame)
            self.assertAlmostEqual(time_s, frame / 30)
            np.testing.assert_allclose(np.reshape(values, (7, -1))[:6], world[:6], rtol=1e-6)

    @needs_mono
    def test_csharp(self):
        program = self.driver()
        environment = {**os.environ, "LD_LIBRARY_PATH": str(LIBRARY.parent)}
        for kind, word in ((1, "water"), (2, "people")):
            publisher = self.producer_of(kind)
            worlds = [self.send(publisher, kind)]
            with subprocess.Popen(["mono", program, self.session, word], stdout=subprocess.PIPE, text=True, env=environment) as mono:
                lines = [mono.stdout.readline()]
                worlds.append(self.send(publisher, kind, final=True))
                self.library("publisher_close", publisher)
                lines += mono.stdout.readlines()
            self.assertEqual((mono.returncode, lines[-1]), (0, "end\n"), lines)
            for frame, (line, world) in enumerate(zip(lines, worlds), 1):
                number, time_s, *values = map(float, line.split())
                self.assertEqual(number, frame)
                self.assertAlmostEqual(time_s, (frame + 1 - kind) / 30)
                np.testing.assert_allclose(np.reshape(values, world.shape), world, rtol=1e-6)


if __name__ == "__main__":
    unittest.main()
