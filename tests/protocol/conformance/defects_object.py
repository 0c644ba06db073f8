"""Defects of the object: its creation, its header, its locks, its name."""

import os
import time

from python_producer import CONTROL, Failure, Publisher

from wade.conformance import system
from wade.conformance.layout import HEADER_WORDS, PAGE, ControlPage


class MagicFirst(Publisher):
    caught_by = "header"

    def store_header(self):
        page = self.header()
        self.words.bytes[0:8] = page[0:8]
        time.sleep(0.5)
        self.words.bytes[8:PAGE] = page[8:]


class WrongChecksum(Publisher):
    caught_by = "header"

    def header(self):
        page = bytearray(super().header())
        page[HEADER_WORDS["crc32c"][0]] ^= 1
        return bytes(page)


class FieldsOverlap(Publisher):
    caught_by = "header"

    def header(self):
        self.field_bytes -= 64
        page = super().header()
        self.field_bytes += 64
        return page


class SlotsBeyondTheFile(Publisher):
    caught_by = "header"

    def header(self):
        self.slots += 1
        page = super().header()
        self.slots -= 1
        return page


class OnlySized(Publisher):
    """Reserves no memory, so that a full /dev/shm would be a SIGBUS later."""

    caught_by = "header"

    def create(self):
        fd = super().create()
        os.ftruncate(fd, 0)
        os.ftruncate(fd, self.total_bytes)
        return fd


class ReadableByAll(Publisher):
    caught_by = "mode"
    permissions = 0o644


class NoLock(Publisher):
    caught_by = "lock"

    def take_lock(self, fd):
        if system.lock_byte(fd, 0):
            system.unlock_byte(fd, 0)
            return True
        return False


class PidOfAnother(Publisher):
    caught_by = "lock"

    def fill_control(self):
        super().fill_control()
        self.words.set_u32(CONTROL + ControlPage.PID, os.getppid())


class TakesALivingName(Publisher):
    caught_by = "exclusive"

    def remove_stale(self):
        self.path.unlink(missing_ok=True)


class RefusesAStaleName(Publisher):
    caught_by = "stale"

    def remove_stale(self):
        raise Failure(8, "There is an object of this name.")
