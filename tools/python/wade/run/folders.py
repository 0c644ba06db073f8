"""Where runs go that were given no --out."""

import os
import re
import time
from pathlib import Path

from wade import UsageError
from wade.paths import RUNS, home_folder


def file_name(text):
    """A name for a file or folder: letters, digits, '.', '-' and '_' of a text."""
    return re.sub(r"[^\w.-]+", "_", text).strip("._")[:80] or "scene"


def runs_folder():
    """The first of these folders that can be written: RUNS, runs/ of this folder, then one of the user's own."""
    places = [RUNS, Path.cwd() / "runs", home_folder() / "wade-runs"]
    for place in places:
        try:
            place.mkdir(parents=True, exist_ok=True)
        except OSError:
            continue
        if os.access(place, os.W_OK | os.X_OK):
            return place
    raise UsageError(f"--out DIR is needed, as no folder for runs can be written; tried: {', '.join(map(str, places))}")


def new_folder(name):
    """A folder in runs/ for something of this name that starts now; it is not made yet."""
    stem = runs_folder() / f"{file_name(name)}-{time.strftime('%Y%m%d-%H%M%S')}"
    folder, n = stem, 1
    while folder.exists():
        n += 1
        folder = stem.with_name(f"{stem.name}-{n}")
    return folder
