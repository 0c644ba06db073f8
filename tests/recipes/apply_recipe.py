#!/usr/bin/env python3
"""Does what a recipe of CONTRIBUTING.md says.

apply_recipe.py ROOT HEADING OUT FILE...   writes each FILE (a path from ROOT) to OUT, made or with lines added
apply_recipe.py ROOT HEADING               carries out all steps in the folder ROOT

A recipe shows its steps in blocks. Their first line is a comment that names a file:

  // file PATH   the block is the whole file
  // in PATH     its lines are added: an #include behind the last one of the same folder, other lines at the end of the
                 list `registered`; lines that are there already are left out
  # in PATH      of a block ```diff: "-" lines are replaced by "+" lines, other lines stay and tell where; "@@" stands
                 between changes. What "-" and other lines say must be there once

The lines of a block ```sh are commands.
"""

import re
import subprocess
import sys
import textwrap
from pathlib import Path


def section(text, heading):
    """The text below a heading of the second level."""
    found = re.search(rf"^## {re.escape(heading)}\n(.*?)(?=^## |\Z)", text, re.S | re.M)
    if not found:
        raise SystemExit(f"CONTRIBUTING.md has no heading '## {heading}'")
    return found.group(1)


def blocks(text):
    """(kind, path, code) of each block that is a step; kind: file, in, diff, or sh without a path."""
    found = []
    for indent, language, code in re.findall(r"^( *)```(\w+)\n(.*?)^\1```$", text, re.S | re.M):
        code = textwrap.dedent(code) if indent else code
        named = re.match(r"(?://|#|<!--) (file|in) (\S+)(?: -->)?\n", code)
        if language == "sh":
            found.append(("sh", "", code))
        elif named:
            found.append(("diff" if language == "diff" else named[1], named[2], code[named.end():]))
    return found


def with_lines(text, lines):
    """A source with lines added where the recipe's reader would add them."""
    for line in lines.splitlines():
        if line in text.splitlines():
            continue
        if line.startswith("#include"):
            folder = line[: line.rindex("/") + 1]
            place = text.rindex(folder)
            end = text.index("\n", place) + 1
        else:
            end = text.index("\n};\n", text.index(" registered{")) + 1
        text = text[:end] + line + "\n" + text[end:]
    return text


def with_changes(text, changes, path):
    """A text with the changes of a diff."""
    for change in re.split(r"^@@\n", changes, flags=re.M):
        lines = change.splitlines()
        old = "".join(line[1:] + "\n" for line in lines if not line.startswith("+"))
        new = "".join(line[1:] + "\n" for line in lines if not line.startswith("-"))
        places = [found.start() for found in re.finditer(rf"^{re.escape(old)}", text, re.M)]
        if len(places) != 1:
            raise SystemExit(f"{path}: these lines are there {len(places)} times, not once:\n{old}")
        text = text[: places[0]] + new + text[places[0] + len(old):]
    return text


def carry_out(root, heading):
    """Carries out all steps of a recipe in a folder."""
    for kind, path, code in blocks(section((root / "CONTRIBUTING.md").read_text(encoding="utf-8"), heading)):
        if kind == "sh":
            subprocess.run(["bash", "-euxc", code], cwd=root, check=True)
            continue
        file = root / path
        file.parent.mkdir(parents=True, exist_ok=True)
        if kind != "file":
            text = file.read_text(encoding="utf-8")
            code = with_lines(text, code) if kind == "in" else with_changes(text, code, path)
        file.write_text(code, encoding="utf-8")


def write_files(root, heading, out, files):
    """Writes single files of a recipe to another folder."""
    recipe = blocks(section((root / "CONTRIBUTING.md").read_text(encoding="utf-8"), heading))
    for path in files:
        mine = [(kind, code) for kind, of, code in recipe if of == path and kind != "diff"]
        if not mine:
            raise SystemExit(f"the recipe '{heading}' does not name {path}")
        text = None
        for kind, code in mine:
            text = code if kind == "file" else with_lines(text or (root / path).read_text(encoding="utf-8"), code)
        target = out / path
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(text, encoding="utf-8")


def main(root, heading, out=None, *files):
    if out is None:
        carry_out(Path(root), heading)
    else:
        write_files(Path(root), heading, Path(out), files)


if __name__ == "__main__":
    main(*sys.argv[1:])
