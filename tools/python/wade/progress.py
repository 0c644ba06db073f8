"""Tells what a command does, how far it is and how long it takes, once it has been silent for some seconds.

A command calls at() as it goes on; a thread tells the newest state on stderr: in one line of a terminal, else in lines that
become rarer.
"""

import sys
import threading
import time

SILENT_S = 3.0
RAREST_S = 60.0


def duration(seconds):
    """A time in words, for example "4 s" or "3 min"."""
    return f"{seconds:.0f} s" if seconds < 120 else f"{seconds / 60:.0f} min" if seconds < 7200 else f"{seconds / 3600:.1f} h"


class State:
    """What is being done: `what` in words, `done` of `total` (None: not known; whole numbers are shown as such) since `began`;
    last: when something was printed.

    is_shown: a terminal shows the line of progress, which what is printed next replaces.
    """

    def __init__(self):
        self.what, self.done, self.total, self.began, self.last = "", 0, None, time.monotonic(), time.monotonic()
        self.is_shown = False

    def line(self, command, now, started):
        """What is told."""
        text = f"wade {command}: {self.what or 'at work'}"
        if self.total and self.total < float("inf"):
            counts = isinstance(self.done, int) and isinstance(self.total, int)
            text += f", {self.done} of {self.total}" if counts else f", {min(100, 100 * self.done / self.total):.0f} %"
            if self.done > 0:
                text += f", about {duration((now - self.began) * max(0, self.total / self.done - 1))} left"
        elif self.done:
            text += f" {self.done:g}"
        return f"{text}, {duration(now - started)} so far"


STATE = State()


def at(what, done=0, total=None):
    """States what is done now and how far it is."""
    if what != STATE.what:
        STATE.began = time.monotonic()
    STATE.what, STATE.done, STATE.total = what, done, total


def over(items, what, total=None):
    """Yields the items; each counts as a step."""
    total = len(items) if total is None and hasattr(items, "__len__") else total
    for done, item in enumerate(items):
        at(what, done, total)
        yield item


class Teller:
    """A context; while it lasts, a thread tells the state."""

    def __init__(self, command):
        self.command, self.ended, self.thread = command, threading.Event(), threading.Thread(target=self.tell, daemon=True)

    def __enter__(self):
        STATE.__init__()
        self.started = time.monotonic()
        self.thread.start()

    def __exit__(self, *_error):
        self.ended.set()
        self.thread.join()

    def tell(self):
        is_terminal, pause, told = sys.stderr.isatty(), SILENT_S, False
        while not self.ended.wait(0.5 if told and is_terminal else 1.0):
            now = time.monotonic()
            if not (told and is_terminal) and now - STATE.last < pause:
                continue
            line = STATE.line(self.command, now, self.started)
            sys.stderr.write(f"\r\x1b[K{line[:99]}" if is_terminal else line + "\n")
            sys.stderr.flush()
            STATE.last, STATE.is_shown, told = now, is_terminal, True
            pause = min(RAREST_S, 1.5 * pause)
        if STATE.is_shown:
            STATE.is_shown = False
            sys.stderr.write("\r\x1b[K")
            sys.stderr.flush()
