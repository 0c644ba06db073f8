"""The newest frame of a Wade session, in the Python of Blender, Unreal and any other program: one file, no packages.

    from wade_stream import Stream
    water = Stream("demo", library="/path/of/libwade_shm.so")
    while not water.ended:          # in Blender: in a function for bpy.app.timers, see show_in_blender
        if water.poll():            # never waits
            flat = water.places("unreal")   # x, y, z, x, y, z, ... in that program's axes and units

A free-running reader: no producer waits for it, and it may miss frames. Wade's axes are left-handed: x upstream, y up,
z across, in metres; docs/engines.md lists the axes of other programs.
"""

import array
import ctypes
import os

U32, U64, F64, I32 = ctypes.c_uint32, ctypes.c_uint64, ctypes.c_double, ctypes.c_int32
FIELDS = ("mass", "vx", "vy", "vz", "px", "py", "pz")
OF_PEOPLE = ("radius", "height", "state")
OK, END, NOTHING_NEW, ABI_VERSION = 0, -1, -2, 2

# Of each program: the axes of the world that its x, y, z are, with their signs, and its units in a metre.
PROGRAMS = {
    "wade": (("x", 1), ("y", 1), ("z", 1), 1),
    "unity": (("x", 1), ("y", 1), ("z", 1), 1),
    "unreal": (("x", 1), ("z", -1), ("y", 1), 100),
    "blender": (("x", 1), ("z", 1), ("y", 1), 1),
    "gltf": (("x", 1), ("y", 1), ("z", -1), 1),
}


class _Join(ctypes.Structure):
    """wade_join"""

    _fields_ = [("scene_hash", U64), ("kind", U32), ("follows", U32), ("group_access", U32), ("reserved", U32),
                ("attach_timeout_s", F64), ("step_warning_s", F64), ("step_timeout_s", F64), ("interrupted", ctypes.c_void_p),
                ("warn", ctypes.c_void_p), ("context", ctypes.c_void_p)]


class _Info(ctypes.Structure):
    """wade_stream"""

    _fields_ = [("producer_name", ctypes.c_char * 64), ("kind", U32), ("capacity", U32), ("depth", U32), ("slots", U32),
                ("ticks_per_second", U64), ("ticks_per_frame", U64), ("metres_per_unit", F64), ("origin", F64 * 3),
                ("axes", I32 * 3), ("coupling_lag", U32), ("particle_radius", F64), ("rest_density", F64),
                ("scene_hash", U64), ("session_id", U64), ("hash_frames", U32), ("group_access", U32),
                ("column_width", F64 * 2)]


class _Frame(ctypes.Structure):
    """wade_frame"""

    _fields_ = [("frame", U64), ("tick", U64), ("hash", U64), ("count", U32), ("final", U32)] + [
        (name, ctypes.POINTER(ctypes.c_float)) for name in FIELDS + OF_PEOPLE] + [("diagnostics", ctypes.c_char * 192)]


class StreamError(Exception):
    """What the session or the library says is wrong; code: an exit code of docs/protocol.md."""

    def __init__(self, code, message):
        super().__init__(message)
        self.code = code


class Stream:
    """A session: number, time_s, count and final of its newest frame, its arrays, and whether it has ended.

    people: its agents (scenes with /coupling/agents_stream), else the water. library: where libwade_shm.so lies, by default
    what WADE_SHM_LIBRARY says or the system finds.
    """

    def __init__(self, session, people=False, library=None, attach_timeout_s=10, stride=1):
        self.ended, self.number, self.time_s, self.count, self.final = False, 0, 0.0, 0, False
        self._fields = FIELDS + OF_PEOPLE * people
        self._reader, self._frame, self._stored = ctypes.c_void_p(), _Frame(), {}
        path = str(library or os.environ.get("WADE_SHM_LIBRARY", "libwade_shm.so"))
        try:
            self._library = ctypes.CDLL(path)
        except OSError as error:
            raise StreamError(2, f"Cannot load {path}: {error}") from error
        self._library.wade_last_error.restype = ctypes.c_char_p
        self._library.wade_abi_version.restype = U32
        if self._library.wade_abi_version() != ABI_VERSION:
            raise StreamError(2, f"{path} has another ABI than version {ABI_VERSION}.")
        join, self.info = _Join(), _Info()
        self._library.wade_join_defaults(ctypes.byref(join))
        join.kind, join.attach_timeout_s = 2 if people else 1, attach_timeout_s
        self._call("latest_open", session.encode(), b"python", ctypes.byref(join), U32(stride), ctypes.byref(self._reader))
        self._call("latest_stream", self._reader, ctypes.byref(self.info))

    def _call(self, name, *arguments):
        result = getattr(self._library, "wade_" + name)(*arguments)
        if result not in (OK, END, NOTHING_NEW):
            raise StreamError(result, self._library.wade_last_error().decode("utf-8", "replace"))
        return result

    def poll(self):
        """Takes the newest frame; False if there is none that was not taken yet, or the stream has ended. Never waits."""
        if self.ended:
            return False
        result = self._call("latest_poll", self._reader, ctypes.byref(self._frame))
        self.ended = result == END
        if result != OK:
            return False
        frame = self._frame
        self.number, self.count, self.final = frame.frame, frame.count, bool(frame.final)
        self.time_s = frame.tick / self.info.ticks_per_second
        self._stored = {}
        for name in self._fields:  # copies, as the library's arrays last only to the next call
            self._stored[name] = array.array("f")
            self._stored[name].frombytes(ctypes.string_at(getattr(frame, name), 4 * self.count))
        return True

    def values(self, name):
        """mass (kg), of people radius and height (m) and state (0 walking, 1 arrived, 2 dead): an array of floats."""
        scale = self.info.metres_per_unit if name in ("radius", "height") else 1
        return self._stored[name] if scale == 1 else array.array("f", (scale * value for value in self._stored[name]))

    def _along(self, letter, axis, sign, units):
        """Returns an array along an axis of the world, "p" positions or "v" velocities, in a program's units."""
        i = "xyz".index(axis)
        stored = self.info.axes[i]
        values = self._stored[letter + "xyz"[abs(stored) - 1]]
        scale = sign * units * self.info.metres_per_unit * (1 if stored > 0 else -1)
        start = sign * units * self.info.origin[i] if letter == "p" else 0
        return values if (scale, start) == (1, 0) else array.array("f", (start + scale * value for value in values))

    def _flat(self, letter, program):
        *axes, units = PROGRAMS[program]
        flat = array.array("f", bytes(12 * self.count))
        for i, (axis, sign) in enumerate(axes):
            flat[i::3] = self._along(letter, axis, sign, units)
        return flat

    def places(self, program="wade"):
        """Returns positions x, y, z, x, y, z, ..., in the axes and units of wade, unity, unreal, blender or gltf."""
        return self._flat("p", program)

    def velocities(self, program="wade"):
        """Returns the velocities in the same order and axes, in units per second."""
        return self._flat("v", program)

    def close(self):
        if self._reader:
            self._library.wade_latest_leave(self._reader)
            self._library.wade_latest_free(self._reader)
            self._reader = ctypes.c_void_p()


def show_in_blender(session, **options):
    """Adds a mesh "water" to the Blender scene. Its vertices follow the particles while the session lives."""
    import bpy

    water = Stream(session, **options)
    shape = bpy.data.meshes.new("water")
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("water", shape))

    def follow():
        if water.poll():
            if len(shape.vertices) != water.count:
                shape.clear_geometry()
                shape.vertices.add(water.count)
            shape.vertices.foreach_set("co", water.places("blender"))
            shape.update()
        return None if water.ended else 1 / 30

    bpy.app.timers.register(follow)
    return water
