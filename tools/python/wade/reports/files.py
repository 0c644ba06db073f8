"""Files that appear whole or not at all, lines that a gone reader cannot break, and what is published of a report."""

import contextlib
import os
import re
import secrets
import shutil
import sys

from wade.paths import ROOT
from wade.terminal import harmless, wrapped

PUBLISHED = ROOT / "docs" / "reports"
PICTURE = re.compile(r"!\[[^\]]*\]\(([^)]+\.png)\)")


@contextlib.contextmanager
def whole_file(file):
    """Gives a name beside the file to write under. The file appears by a rename at the end; an error leaves no part of it."""
    file.parent.mkdir(parents=True, exist_ok=True)
    part = file.with_name(f".{file.stem}-{secrets.token_hex(6)}{file.suffix}")  # random: no other user can foresee it
    try:
        yield part
        to_disk(part)
        part.replace(file)
    finally:
        part.unlink(missing_ok=True)


@contextlib.contextmanager
def whole_folder(folder):
    """Gives a folder to write files in. They move to `folder` at the end; an error leaves none of them there."""
    is_new = not folder.exists()
    part = folder / f".part-{secrets.token_hex(6)}"
    try:
        part.mkdir(parents=True)
        yield part
        files = sorted(part.iterdir())
        for file in files:
            to_disk(file)
        for file in files:
            file.replace(folder / file.name)
    finally:
        shutil.rmtree(part, ignore_errors=True)
        if is_new:
            with contextlib.suppress(OSError):  # files are in it
                folder.rmdir()


def to_disk(file):
    """Waits until a file is on the disk, so that its name never stands for less than all of it."""
    with open(file, "rb") as written:
        os.fsync(written.fileno())


def write_whole(file, data):
    """Writes text or bytes whole or not at all, with the folder that it needs."""
    with whole_file(file) as part:
        part.write_bytes(data if isinstance(data, bytes) else data.encode())


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
