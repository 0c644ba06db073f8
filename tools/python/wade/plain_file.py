"""Opens files that another user may have made: plain files within a limit of size, without waiting.

Modules of Wade open the files of run folders, scenes and recordings here. A FIFO, a device, a folder, a file above its limit
and content that cannot be read are a FileError, which names the file and the reason. The programs have
configs/files/plain_file.hpp for the same.
"""

import contextlib
import errno
import json
import os
import stat
from pathlib import Path

from wade import UsageError

TEXT_MIB, TABLE_MIB, LINE_MIB = 64, 1024, 1  # limits of texts and JSON, of tables that are kept in memory, of a line
STEPS_OF_QUESTION = 2_000_000_000  # of SQLite's machine
KINDS = ((stat.S_ISDIR, "a folder"), (stat.S_ISFIFO, "a pipe (FIFO)"), (stat.S_ISSOCK, "a socket"))


class FileError(UsageError, OSError):
    """A file that cannot be read, with the reason."""

    def __init__(self, file, reason, number=errno.EINVAL):
        super().__init__(number, reason, str(file))

    def __str__(self):
        return f"cannot read '{self.filename}': {self.strerror}"


def demand_plain(file, mode):
    """Raises FileError if a mode, as stat gives it, is not that of a plain file."""
    if not stat.S_ISREG(mode):
        kind = next((words for is_kind, words in KINDS if is_kind(mode)), "a device")
        raise FileError(file, f"it is {kind}; allowed: a plain file")


def open_plain(file, most_mib=None):
    """Opens a plain file of at most that size to read bytes. Without O_NONBLOCK the opening of a FIFO waits for a writer."""
    try:
        descriptor = os.open(file, os.O_RDONLY | os.O_NONBLOCK | os.O_NOCTTY | os.O_CLOEXEC)
    except OSError as error:
        raise FileError(file, "it is no plain file" if error.errno == errno.ENXIO else error.strerror, error.errno) from error
    try:
        demand_plain(file, os.fstat(descriptor).st_mode)
        if most_mib is not None and os.fstat(descriptor).st_size > most_mib << 20:
            raise FileError(file, f"it is longer than {most_mib} MiB")
    except FileError:
        os.close(descriptor)
        raise
    return os.fdopen(descriptor, "rb")


def read_bytes(file, most_mib=TEXT_MIB):
    """All of a file."""
    with open_plain(file, most_mib) as opened:
        data = opened.read((most_mib << 20) + 1) or b""
    if len(data) > most_mib << 20:  # a file of /proc does not tell its size
        raise FileError(file, f"it is longer than {most_mib} MiB")
    return data


def read_text(file, errors="strict"):
    """All of a text in UTF-8."""
    try:
        return read_bytes(file).decode("utf-8", errors)
    except UnicodeDecodeError as error:
        raise FileError(file, f"it is not UTF-8 at byte {error.start}") from error


class Entries(dict):
    """An object of a JSON file or a row of a table; an entry that is missing is a FileError."""

    def __init__(self, entries, file):
        super().__init__(entries)
        self.file = file

    def __missing__(self, key):
        raise FileError(self.file, f'it has no "{key}"')


def read_json(file, kind=dict):
    """The value of a JSON file, which must be of that type."""
    try:
        value = json.loads(read_text(file), object_hook=lambda entries: Entries(entries, file))
    except (ValueError, RecursionError) as error:
        raise FileError(file, f"it is not valid JSON: {error}") from error
    if not isinstance(value, kind):
        raise FileError(file, f"it holds no JSON {'object' if kind is dict else 'list'}")
    return value


def whole_lines(file, most_mib=None, grows=False):
    """The lines of a text. A last one without an end is left out of a file that grows, as a kill has cut it off."""
    longest = LINE_MIB << 20
    with open_plain(file, most_mib) as opened:
        number = 0
        while line := opened.readline(longest + 1):
            number += 1
            if len(line) > longest:
                raise FileError(file, f"line {number} is longer than {LINE_MIB} MiB")
            if not line.endswith(b"\n"):
                if grows:
                    return
                raise FileError(file, "it is cut off: its last line has no end")
            try:
                yield line.decode("utf-8")
            except UnicodeDecodeError as error:
                raise FileError(file, f"line {number} is not UTF-8") from error


def table_cells(file, most_mib=None, grows=False):
    """The head and the rows of a table as lists, one after the other; lines that begin with # are notes."""
    import csv  # only where it is needed, as workers of ensembles read this module

    reader = csv.reader(line for line in whole_lines(file, most_mib, grows) if not line.startswith("#"))
    try:
        head = next(reader, [])
        yield head
        for cells in reader:
            if cells and len(cells) != len(head):
                raise FileError(file, f"row {reader.line_num} has {len(cells)} values, the head {len(head)}")
            if cells:
                yield cells
    except csv.Error as error:
        raise FileError(file, f"row {reader.line_num}: {error}") from error


def table_rows(file, most_mib=None, grows=True):
    """The rows of a table, of one that grows by default, as dictionaries, one after the other."""
    cells = table_cells(file, most_mib, grows)
    head = next(cells)
    for row in cells:
        yield Entries(zip(head, row), file)


def read_table(file):
    """All rows of a table as dictionaries."""
    return list(table_rows(file, TABLE_MIB, grows=False))


def read_columns(file, grows=False):
    """The columns of a table, {name: texts}."""
    head, *rows = table_cells(file, TABLE_MIB, grows)
    return {**dict.fromkeys(head, ()), **dict(zip(head, zip(*rows)))}


@contextlib.contextmanager
def database(file):
    """A database of SQLite, which is only read. A view may run for ever, so that the steps of a question are limited."""
    import sqlite3  # as above

    open_plain(file).close()  # SQLite opens it by its name
    try:
        with contextlib.closing(sqlite3.connect(f"{Path(file).absolute().as_uri()}?mode=ro", uri=True)) as opened:
            left = [STEPS_OF_QUESTION // 1_000_000]

            def is_too_long():
                left[0] -= 1
                return left[0] < 0

            opened.set_progress_handler(is_too_long, 1_000_000)
            opened.execute("PRAGMA trusted_schema = OFF")
            yield opened
    except (sqlite3.Error, OverflowError, UnicodeDecodeError) as error:
        raise FileError(file, str(error)) from error


def create(file):
    """Opens a new text file to write. What has its name is removed, so that no link leads elsewhere and no FIFO waits."""
    with contextlib.suppress(FileNotFoundError):
        os.unlink(file)
    return open(file, "x", encoding="utf-8")


def open_lock(file):
    """Opens a file for a lock, and makes it if it is missing; it may lie in a folder of other users."""
    descriptor = os.open(file, os.O_RDWR | os.O_CREAT | os.O_NONBLOCK | os.O_NOFOLLOW | os.O_CLOEXEC, 0o666)
    opened = os.fdopen(descriptor, "rb")
    demand_plain(file, os.fstat(descriptor).st_mode)
    return opened
