"""What the contract needs from Linux on x86-64: locks of open file descriptions, futexes, shared pages, process times.

On this processor plain loads acquire and plain stores release (total store order), so that Python's single accesses to
aligned words are enough; a store before a load of another word needs fence().
"""

import ctypes
import fcntl
import mmap
import os
import struct
import threading
import time
from contextlib import contextmanager

F_OFD_GETLK, F_OFD_SETLK = 36, 37
_FLOCK = struct.Struct("@hhqqi4x")
_FUTEX = 202  # system call number
_FUTEX_WAIT, _FUTEX_WAKE = 0, 1
_libc = ctypes.CDLL(None, use_errno=True)
_barrier = threading.Lock()


class _Timespec(ctypes.Structure):
    _fields_ = [("seconds", ctypes.c_long), ("nanoseconds", ctypes.c_long)]


def lock_byte(fd, byte):
    """Takes the exclusive lock of a byte for this open file description; False if another one has it."""
    try:
        fcntl.fcntl(fd, F_OFD_SETLK, _FLOCK.pack(fcntl.F_WRLCK, os.SEEK_SET, byte, 1, 0))
    except (BlockingIOError, PermissionError):
        return False
    return True


def unlock_byte(fd, byte):
    fcntl.fcntl(fd, F_OFD_SETLK, _FLOCK.pack(fcntl.F_UNLCK, os.SEEK_SET, byte, 1, 0))


def is_locked_by_other(fd, byte):
    """Whether another open file description holds the lock of a byte."""
    answer = fcntl.fcntl(fd, F_OFD_GETLK, _FLOCK.pack(fcntl.F_WRLCK, os.SEEK_SET, byte, 1, 0))
    return _FLOCK.unpack(answer)[0] != fcntl.F_UNLCK


class Words:
    """Mapped bytes of an object as aligned words: each access is one load or store of the processor."""

    def __init__(self, fd, offset, length, writable):
        prot = mmap.PROT_READ | (mmap.PROT_WRITE if writable else 0)
        self.map = mmap.mmap(fd, length, mmap.MAP_SHARED, prot, offset=offset)
        self.bytes = memoryview(self.map)
        self._u32, self._u64, self._i32 = (self.bytes.cast(form) for form in "IQi")

    def u32(self, offset):
        return self._u32[offset >> 2]

    def u64(self, offset):
        return self._u64[offset >> 3]

    def i32(self, offset):
        return self._i32[offset >> 2]

    def set_u32(self, offset, value):
        self._u32[offset >> 2] = value & 0xFFFFFFFF

    def set_u64(self, offset, value):
        self._u64[offset >> 3] = value

    def set_i32(self, offset, value):
        self._i32[offset >> 2] = value

    def set_text(self, offset, room, text):
        """A zero-terminated text, cut at its room."""
        data = text.encode()[: room - 1]
        self.bytes[offset : offset + len(data) + 1] = data + b"\0"

    def address(self, offset):
        """Address of a word for futex(2); the mapping must be writable."""
        return ctypes.addressof(ctypes.c_uint32.from_buffer(self.map, offset))


def fence():
    """A full memory barrier: taking a lock is an atomic read-modify-write."""
    with _barrier:
        pass


def futex_wait(address, seen, seconds):
    """Sleeps while the word is `seen`; 'woken', 'changed' (it was another value) or 'timeout'."""
    whole = int(seconds)
    limit = _Timespec(whole, int((seconds - whole) * 1e9))
    result = _libc.syscall(
        ctypes.c_long(_FUTEX), ctypes.c_void_p(address), ctypes.c_long(_FUTEX_WAIT), ctypes.c_long(seen),
        ctypes.byref(limit), ctypes.c_void_p(None), ctypes.c_long(0),
    )
    return "woken" if result == 0 else {110: "timeout"}.get(ctypes.get_errno(), "changed")


def futex_wake_all(address):
    _libc.syscall(ctypes.c_long(_FUTEX), ctypes.c_void_p(address), ctypes.c_long(_FUTEX_WAKE), ctypes.c_long(2**31 - 1),
                  ctypes.c_void_p(None), ctypes.c_void_p(None), ctypes.c_long(0))


@contextmanager
def apart_from(pid):
    """This process and another one on processors of their own, if there are two, so that one can watch the other."""
    usable = os.sched_getaffinity(0)
    if len(usable) > 1:
        first, *others = sorted(usable)
        os.sched_setaffinity(0, {first})
        os.sched_setaffinity(pid, others)
    try:
        yield
    finally:
        os.sched_setaffinity(0, usable)


def monotonic_ns():
    return time.clock_gettime_ns(time.CLOCK_MONOTONIC)


def is_stopped(pid):
    """Whether a process stands still (/proc/PID/stat, field 3)."""
    with open(f"/proc/{pid}/stat", encoding="utf-8", errors="replace") as file:
        return file.read().rsplit(")", 1)[1].split()[0] in "Tt"


def start_time(pid):
    """Start of a process in clock ticks since boot (/proc/PID/stat, field 22); 0 if there is no such process."""
    try:
        with open(f"/proc/{pid}/stat", encoding="utf-8", errors="replace") as file:
            return int(file.read().rsplit(")", 1)[1].split()[19])
    except OSError:
        return 0
