"""What is shown on a terminal: no line over 100 columns but for paths, nothing that a terminal would obey."""

import argparse
import os
import sys
import textwrap
import time

from wade import plain_file
from wade.paths import INSTALLED
from wade.progress import STATE

COLUMNS = 100
# What messages call the commands of the sources, and what an installed command calls them.
NAMES = (("tools/install_dependencies.sh viewer", "Debian: apt-get install npm chromium"),
         ("tools/install_dependencies.sh engines", "Debian: apt-get install parallel openmpi-bin"),
         ("tools/install_dependencies.sh readers", "Debian: apt-get install ffmpeg gdal-bin"),
         ("tools/wade", "wade"), ("tools/run.sh", "wade run"))


def as_installed(text):
    """A text with the names of an installed command."""
    for name, installed in NAMES:
        text = text.replace(name, installed)
    return text


class Stream:
    """A standard stream that notes when it is written to, and of an installed command has its names."""

    def __init__(self, stream):
        self.stream = stream

    def __getattr__(self, name):
        return getattr(self.stream, name)

    def write(self, text):
        STATE.last = time.monotonic()
        if STATE.is_shown and not text.startswith("\r"):  # clears the line of progress
            STATE.is_shown, text = False, "\r\x1b[K" + text
        return self.stream.write(as_installed(text) if INSTALLED else text)


def open_standard_streams():
    """Lets /dev/null stand for each standard stream that was closed, so that no file takes its number."""
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the lowest free number, which is this one
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, mode, encoding="utf-8"))
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")
    for name in ("stdout", "stderr"):
        if not isinstance(getattr(sys, name), Stream):
            setattr(sys, name, Stream(getattr(sys, name)))


def harmless(text):
    """Text of another program or file: what cannot be printed is shown as an escape, for example \\x9b."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in text)


def tail_of(log, lines):
    """The last lines of a log, harmless."""
    return [harmless(line) for line in plain_file.read_text(log, "backslashreplace").split("\n") if line.strip()][-lines:]


def wrapped(text, indent="  "):
    """Text in lines of at most 100 columns; words, and with them most paths, stay whole."""
    return textwrap.fill(text, COLUMNS, subsequent_indent=indent, break_long_words=False, break_on_hyphens=False)


def say_error(text):
    """Tells on stderr what is wrong, each line of the text wrapped."""
    for line in str(text).split("\n"):
        print(wrapped(harmless(line)), file=sys.stderr)


def paragraphs(text):
    """A description with its paragraphs filled anew; those with lines that are indented stay as they are."""
    parts = (part if part.startswith(" ") or "\n " in part else textwrap.fill(part, COLUMNS) for part in (text or "").split("\n\n"))
    return "\n\n".join(parts)


def _formatter(prog):
    return argparse.RawDescriptionHelpFormatter(prog, max_help_position=22, width=COLUMNS)


class Parser(argparse.ArgumentParser):
    """An argument parser with help and errors of at most 100 columns."""

    def __init__(self, subcommand, description, epilog=None, **others):
        super().__init__(prog=f"tools/wade {subcommand}", description=paragraphs(description), epilog=paragraphs(epilog),
                         allow_abbrev=False, formatter_class=_formatter, **others)

    def error(self, message):
        say_error(f"{self.prog.removeprefix('tools/')}: {message} ({self.prog} --help tells more)")
        sys.exit(2)
