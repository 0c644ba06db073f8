#!/usr/bin/env python3
"""Does what a recipe of CONTRIBUTING.md says, in a copy of the files that it touches.

apply_recipe.py ROOT HEADING OUT FILE...   writes each FILE (a path from ROOT) to OUT, changed or made as the recipe says

A recipe shows code in blocks that begin with the comment "// file PATH", a whole file, or "// in PATH", lines that are
added to a file: an #include behind the last one of the same folder, other lines at the end of the list `registered`.
"""

import re
import sys
from pathlib import Path


def section(text, heading):
    """The text below a heading of the second level."""
    found = re.search(rf"^## {re.escape(heading)}\n(.*?)(?=^## |\Z)", text, re.S | re.M)
    if not found:
        raise SystemExit(f"CONTRIBUTING.md has no heading '## {heading}'")
    return found.group(1)


def blocks(text):
    """(kind, path, code) of each block of code that names a file."""
    return re.findall(r"^```cpp\n// (file|in) (\S+)\n(.*?)^```$", text, re.S | re.M)


def with_lines(text, lines):
    """A source with lines added where the recipe's reader would add them."""
    for line in lines.splitlines():
        if line.startswith("#include"):
            folder = line[: line.rindex("/") + 1]
            place = text.rindex(folder)
            end = text.index("\n", place) + 1
        else:
            end = text.index("\n};\n", text.index(" registered{")) + 1
        text = text[:end] + line + "\n" + text[end:]
    return text


def main(root, heading, out, *files):
    recipe = blocks(section((Path(root) / "CONTRIBUTING.md").read_text(encoding="utf-8"), heading))
    for path in files:
        mine = [(kind, code) for kind, of, code in recipe if of == path]
        if not mine:
            raise SystemExit(f"the recipe '{heading}' does not name {path}")
        text = None
        for kind, code in mine:
            text = code if kind == "file" else with_lines(text or (Path(root) / path).read_text(encoding="utf-8"), code)
        target = Path(out) / path
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
