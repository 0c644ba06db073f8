"""Files that nobody meets half written, lines that a gone reader cannot break, and what is published of a report."""

import os
import re
import shutil
import sys

from wade.paths import ROOT
from wade.terminal import harmless, wrapped

PUBLISHED = ROOT / "docs" / "reports"
PICTURE = re.compile(r"!\[[^\]]*\]\(([^)]+\.png)\)")


def write_whole(file, data):
    """Writes text or bytes whole or not at all, with the folder that it needs."""
    file.parent.mkdir(parents=True, exist_ok=True)
    part = file.with_name(f"{file.name}.part{os.getpid()}")
    part.write_bytes(data if isinstance(data, bytes) else data.encode())
    part.replace(file)


def say(text, stream=None):
    """Prints a line. A reader that has gone, as of `| head`, must not cost the report."""
    stream = stream or sys.stdout
    if stream is None:
        return
    try:
        print(text, file=stream, flush=True)
    except OSError:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, stream.fileno())
        os.close(nowhere)


def complain(text):
    """Tells on stderr what is wrong, or how far something is."""
    say("\n".join(wrapped(harmless(line)) for line in str(text).split("\n")), sys.stderr)


def publish(out, suite, table=None, page="report.md"):
    """Copies a page, the pictures that it shows and its table to docs/reports/<suite>, and nothing else.

    Pictures there that neither it nor another text there shows go.
    """
    home = PUBLISHED / suite
    names = set(PICTURE.findall((out / page).read_text(encoding="utf-8")))
    texts = [text.read_text(encoding="utf-8") for text in home.glob("*.md") if text.name != page]
    shown = names.union(*map(PICTURE.findall, texts))
    for old in home.glob("**/*.png"):
        if str(old.relative_to(home)) not in shown:
            old.unlink()
    for name in (page, *([table] if table else []), *names):
        (home / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(out / name, home / name)
    say(f"published: {home.relative_to(ROOT)}")
