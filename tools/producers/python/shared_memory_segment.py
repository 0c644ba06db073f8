"""The object of a shared-memory stream: creation, removal, locks, and two system calls; standard library only."""

import ctypes
import fcntl
import os
import platform
import stat
import struct

SLICE_S = 0.05
SESSION_CHARACTERS = set("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-")

SYSTEM_CALLS = {"x86_64": (202, 324), "aarch64": (98, 283)}  # futex, membarrier
FUTEX_WAIT, FUTEX_WAKE = 0, 1
MEMBARRIER_GLOBAL_EXPEDITED, MEMBARRIER_REGISTER_GLOBAL_EXPEDITED = 2, 4


class StreamError(Exception):
    """The stream cannot go on; `code` is the exit code that the contract gives for the reason."""

    def __init__(self, code, message):
        super().__init__(message)
        self.code = code


UNEXPECTED, USAGE, ATTACH_TIMEOUT, PEER_DEAD, PEER_ABORTED, VIOLATION, STEP_TIMEOUT, NAME_IN_USE = range(1, 9)


class Kernel:
    """futex and membarrier."""

    class Timespec(ctypes.Structure):
        _fields_ = [("seconds", ctypes.c_long), ("nanoseconds", ctypes.c_long)]

    def __init__(self):
        machine = platform.machine()
        if machine not in SYSTEM_CALLS or platform.python_implementation() != "CPython":
            raise StreamError(USAGE,
                              f"Not possible on {machine} with {platform.python_implementation()}: use libwade_shm.so.")
        self.futex, self.membarrier = SYSTEM_CALLS[machine]
        self.call = ctypes.CDLL(None, use_errno=True).syscall
        self.slice = self.Timespec(0, int(SLICE_S * 1e9))
        self.has_barrier = self.call(self.membarrier, MEMBARRIER_REGISTER_GLOBAL_EXPEDITED, 0, 0) == 0
        if not self.has_barrier and machine != "x86_64":
            raise StreamError(USAGE, "This kernel has no membarrier system call: use libwade_shm.so.")

    def fence(self):
        """Full memory barrier. Without it x86-64 may lose a wake-up, which costs one slice and nothing else."""
        if self.has_barrier:
            self.call(self.membarrier, MEMBARRIER_GLOBAL_EXPEDITED, 0, 0)

    def wake_all(self, word):
        self.call(self.futex, ctypes.byref(word), FUTEX_WAKE, 0x7FFFFFFF, None, None, 0)

    def sleep_while(self, word, seen):
        """Sleeps at most a slice while the word has the value seen; False after a whole slice or a signal."""
        result = self.call(self.futex, ctypes.byref(word), FUTEX_WAIT, seen, ctypes.byref(self.slice), None, 0)
        return result == 0 or ctypes.get_errno() == 11  # EAGAIN: it had another value


class Segment:
    """The shared-memory object /dev/shm/<session>-fluid of this producer, `total` bytes, with its lock held."""

    def __init__(self, session, total):
        if not 1 <= len(session) <= 200 or not SESSION_CHARACTERS.issuperset(session):
            raise StreamError(USAGE,
                              f"Session name '{session}' is not allowed: 1 to 200 characters of A-Z a-z 0-9 . _ - are.")
        self.path = f"/dev/shm/{session}-fluid"
        self.create(total)

    def create(self, total):
        """Sets fd: creates the object exclusively, lock before size. Unlinks an older object of a dead producer."""
        for _ in range(100):  # each lost round means that another process made progress
            try:
                self.fd = os.open(self.path, os.O_CREAT | os.O_EXCL | os.O_RDWR | os.O_CLOEXEC, 0o600)
            except FileExistsError:
                self.remove_stale()
                continue
            except OSError as error:
                raise StreamError(UNEXPECTED, f"Cannot create {self.path}: {error.strerror}.") from error
            if self.lock(0) and self.still_named():
                break
            os.close(self.fd)
        else:
            raise StreamError(NAME_IN_USE, f"The name {self.path} is fought over by other producers.")
        try:
            os.posix_fallocate(self.fd, 0, total)
        except OSError as error:
            self.unlink()
            raise StreamError(
                UNEXPECTED, f"Cannot allocate {total} bytes for {self.path}: {error.strerror}; see 'df /dev/shm'."
            ) from error

    def remove_stale(self):
        try:
            self.fd = os.open(self.path, os.O_RDWR | os.O_CLOEXEC | os.O_NOFOLLOW | os.O_NONBLOCK)
        except FileNotFoundError:
            return
        except PermissionError:
            self.fd = -1
        except OSError as error:
            raise StreamError(NAME_IN_USE, f"{self.path} cannot be opened: {error.strerror}.") from error
        try:
            if self.fd >= 0 and not stat.S_ISREG(os.fstat(self.fd).st_mode):
                raise StreamError(NAME_IN_USE, f"{self.path} is no plain file; choose another session name.")
            if self.fd < 0 or os.fstat(self.fd).st_uid != os.geteuid():
                raise StreamError(NAME_IN_USE, f"{self.path} belongs to another user; choose another session name.")
            if self.lock(0):
                self.unlink()
            elif self.still_named():
                raise StreamError(NAME_IN_USE,
                                  f"{self.path} is in use by a living producer; choose another session name.")
        finally:
            if self.fd >= 0:
                os.close(self.fd)

    def still_named(self):
        try:
            return os.path.samestat(os.lstat(self.path), os.fstat(self.fd))
        except FileNotFoundError:
            return False

    def unlink(self):
        if self.still_named():
            os.unlink(self.path)

    def lock(self, byte):
        """Takes the exclusive OFD lock of a byte, which the kernel drops when this process ends, however it ends."""
        try:
            fcntl.fcntl(self.fd, fcntl.F_OFD_SETLK, struct.pack("hhqqi4x", fcntl.F_WRLCK, os.SEEK_SET, byte, 1, 0))
        except (BlockingIOError, PermissionError):
            return False
        return True

    def locked_by_other(self, byte):
        probe = struct.pack("hhqqi4x", fcntl.F_WRLCK, os.SEEK_SET, byte, 1, 0)
        return struct.unpack_from("h", fcntl.fcntl(self.fd, fcntl.F_OFD_GETLK, probe))[0] != fcntl.F_UNLCK
