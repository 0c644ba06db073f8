#!/usr/bin/python3
"""Plays the known stream of ../README.md through libwade_shm.so, for machines where plain Python will not do.

The library is found in build/release or where WADE_SHM_LIBRARY says. With numpy, straight into the shared memory.
"""

import ctypes
import os
from pathlib import Path

import known_stream
import numpy as np

ABI_VERSION = 2
OK, END, UNEXPECTED, USAGE = 0, -1, 1, 2
U32, U64, F64 = ctypes.c_uint32, ctypes.c_uint64, ctypes.c_double
FIELDS = ("mass", "vx", "vy", "vz", "px", "py", "pz")


class Stream(ctypes.Structure):
    """wade_stream"""

    _fields_ = [
        ("producer_name", ctypes.c_char * 64), ("kind", U32), ("capacity", U32), ("depth", U32), ("slots", U32),
        ("ticks_per_second", U64), ("ticks_per_frame", U64), ("metres_per_unit", F64), ("origin", F64 * 3),
        ("axes", ctypes.c_int32 * 3), ("coupling_lag", U32), ("particle_radius", F64), ("rest_density", F64),
        ("scene_hash", U64), ("session_id", U64), ("hash_frames", U32), ("group_access", U32),
        ("column_width", F64 * 2),
    ]  # fmt: skip


INTERRUPTED = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p)


class Waiting(ctypes.Structure):
    """wade_waiting"""

    _fields_ = [
        ("attach_timeout_s", F64), ("step_warning_s", F64), ("step_timeout_s", F64),
        ("interrupted", INTERRUPTED), ("warn", ctypes.c_void_p), ("context", ctypes.c_void_p),
    ]  # fmt: skip


class Slot(ctypes.Structure):
    """wade_slot"""

    _fields_ = [("frame", U64), ("capacity", U64)] + [(name, ctypes.POINTER(ctypes.c_float))
                                                      for name in FIELDS + ("radius", "height", "state")]


class Join(ctypes.Structure):
    """wade_join"""

    _fields_ = [("scene_hash", U64), ("kind", U32), ("follows", U32), ("group_access", U32), ("reserved", U32),
                ("waiting", Waiting)]


class Frame(ctypes.Structure):
    """wade_frame, as far as it is read here"""

    _fields_ = [("frame", U64), ("tick", U64), ("hash", U64), ("count", U32), ("final", U32)] + [
        (name, ctypes.POINTER(ctypes.c_float)) for name in FIELDS + ("radius", "height", "state")] + [
        ("diagnostics", ctypes.c_char * 192)]


class Diagnostics(ctypes.Structure):
    """wade_diagnostics, named as far as it is written here"""

    _fields_ = [("of_the_solver", ctypes.c_char * 112), ("taken_x", F64), ("taken_z", F64), ("missing_x", F64),
                ("missing_z", F64), ("reserved", U64 * 6)]


class Impulses(ctypes.Structure):
    """wade_frame_impulses; all NULL in a stream of agents without"""

    _fields_ = [(name, ctypes.POINTER(ctypes.c_float)) for name in ("jx", "jz", "submerged", "spread")]


class StreamError(Exception):
    def __init__(self, code, message):
        super().__init__(message)
        self.code = code


class Library:
    """libwade_shm.so; a call that fails raises StreamError."""

    def __init__(self):
        default = Path(__file__).resolve().parents[3] / "build" / "release" / "libwade_shm.so"
        path = os.environ.get("WADE_SHM_LIBRARY", default)
        try:
            self.library = ctypes.CDLL(str(path))
        except OSError as error:
            raise StreamError(USAGE, f"Cannot load {path}: {error}; build the target wade_shm_c.") from error
        self.library.wade_last_error.restype = ctypes.c_char_p
        if self.library.wade_abi_version() != ABI_VERSION:
            raise StreamError(USAGE, f"{path} has another ABI than version {ABI_VERSION}.")

    def __call__(self, name, *arguments):
        function = getattr(self.library, "wade_" + name)
        function.restype = None if name.endswith(("_defaults", "_free")) else ctypes.c_int
        result = function(*arguments)
        if result not in (None, OK, END):
            raise StreamError(result, self.library.wade_last_error().decode())
        return result


def open_publisher(library, options, interrupted):
    stream, waiting, publisher = Stream(), Waiting(), ctypes.c_void_p()
    library("stream_defaults", ctypes.byref(stream))
    library("waiting_defaults", ctypes.byref(waiting))
    stream.producer_name, stream.rest_density = b"producer_ctypes", 1000
    stream.particle_radius = known_stream.PARTICLE_RADIUS_M
    stream.capacity, stream.depth, stream.scene_hash = options.particles, options.depth, options.scene_hash
    waiting.attach_timeout_s, waiting.step_timeout_s = options.attach_timeout_s, options.step_timeout_s
    waiting.interrupted = interrupted
    session = options.session.encode()
    library("publisher_open", session, ctypes.byref(stream), ctypes.byref(waiting), ctypes.byref(publisher))
    return publisher


class People:
    """The agents stream, for --take-people: the agents that push the water, and the momentum that it loses to them."""

    def __init__(self, library, options, interrupted):
        self.library, self.subscriber, self.frame = library, ctypes.c_void_p(), Frame()
        join = Join()
        library("join_defaults", ctypes.byref(join))
        join.kind, join.waiting.interrupted = 2, interrupted
        join.waiting.attach_timeout_s, join.waiting.step_timeout_s = options.attach_timeout_s, options.step_timeout_s
        session = options.session.encode()
        library("subscriber_open", session, b"producer_ctypes", ctypes.byref(join), ctypes.byref(self.subscriber))
        stream = Stream()
        library("subscriber_stream", self.subscriber, ctypes.byref(stream))
        self.lag = stream.coupling_lag
        self.account = Diagnostics()  # N s since the start: what the water lost, and what it did not have
        library("diagnostics_defaults", ctypes.byref(self.account))
        self.account.taken_x = self.account.taken_z = self.account.missing_x = self.account.missing_z = 0

    def push(self, frame, fields):
        """Takes the agents that are due before a frame and their impulses from the particles; False: the crowd has left."""
        if frame <= self.lag:
            return True
        if self.library("subscriber_acquire", self.subscriber, ctypes.byref(self.frame)) == END:
            return False
        impulses = Impulses()
        self.library("subscriber_impulses", self.subscriber, ctypes.byref(impulses))
        if impulses.jx:
            people = [np.ctypeslib.as_array(array, (self.frame.count,)) for array in
                      (self.frame.px, self.frame.pz, impulses.jx, impulses.jz, impulses.submerged, impulses.spread)]
            for person in zip(*people):
                take_impulse(fields, self.account, *map(float, person))
        self.library("subscriber_release", self.subscriber)
        return True

    def free(self):
        self.library("subscriber_leave", self.subscriber)
        self.library("subscriber_free", self.subscriber)


def take_impulse(fields, account, x, z, jx, jz, submerged, spread):
    """v -= w J / S over the cone round a person, so that the water loses J; nothing where there is none.

    The account gets what it lost, rounded to float32, and what it did not have.
    """
    mass, vx, _, vz, px, py, pz = fields
    if jx == jz == 0:
        return
    weight = np.maximum(0, 1 - np.hypot(px - x, pz - z) / spread) * (py <= submerged)
    total = np.sum(weight * mass, dtype=float)
    if not total > 0:
        account.missing_x += jx
        account.missing_z += jz
        return
    before_x, before_z = vx.astype(float), vz.astype(float)
    vx[:] = before_x - weight * (jx / total)
    vz[:] = before_z - weight * (jz / total)
    account.taken_x += float(np.sum(mass * (before_x - vx)))
    account.taken_z += float(np.sum(mass * (before_z - vz)))


def play(library, publisher, options, signal_received, interrupted):
    start_x, z = known_stream.block(np, options.particles)
    slot = Slot()
    library("publisher_wait_for_consumers", publisher, 1)
    people = People(library, options, interrupted) if options.take_people else None
    for frame in range(1, options.frames + 1):
        if signal_received():
            raise StreamError(128 + signal_received(), f"Interrupted after frame {frame - 1}.")
        if library("publisher_begin_frame", publisher, ctypes.byref(slot)) == END:
            break
        fields = [np.ctypeslib.as_array(getattr(slot, name), (slot.capacity,)) for name in FIELDS]
        known_stream.fill(np, fields, start_x, z, options.speed, slot.frame)
        if people and not people.push(frame, fields):
            break
        account = ctypes.byref(people.account) if people else None
        library("publisher_end_frame", publisher, options.particles, account, int(frame == options.frames))
    if people:
        people.free()
    library("publisher_close", publisher)


def produce(options):
    library, signal_received = Library(), known_stream.catch_signals()
    interrupted = INTERRUPTED(lambda _: signal_received())  # must live as long as the publisher
    publisher = open_publisher(library, options, interrupted)
    try:
        play(library, publisher, options, signal_received, interrupted)
    except Exception as error:
        code = 128 + signal_received() if signal_received() else getattr(error, "code", UNEXPECTED)
        library("publisher_abort", publisher, code, str(error).encode())
        raise StreamError(code, str(error)) from error
    finally:
        library("publisher_free", publisher)


if __name__ == "__main__":
    known_stream.run("producer_ctypes", produce, StreamError, lambda program: known_stream.read_options(program, people=True))
