"""Scenes by short names: `s05` is configs/paper/s05.json, `river/s05` configs/river/s05.json."""

import json
import re
import textwrap
from pathlib import Path

from wade import UsageError
from wade.paths import CONFIGS, ROOT
from wade.terminal import COLUMNS, Parser

DEFAULT_SCENE = CONFIGS / "paper" / "s05.json"
PREFERRED = "paper"  # the folder of a name that several have
DESCRIPTION = re.compile(r'"description"\s*:\s*("(?:[^"\\]|\\.)*")')


def resolved_scene(manifest):
    """Returns the scene of a manifest.json, with the keys of today: /site was /place in older runs."""
    scene = manifest["resolved_scene"]
    return {**{key: value for key, value in scene.items() if key != "place"}, "site": scene["place"]} if "place" in scene else scene


def short_names():
    """All scenes of the project, {short name: file}: the path from configs/ without .json, for example "river/s05"."""
    files = sorted(file for file in CONFIGS.rglob("*.json") if file.parent != CONFIGS)
    return {file.relative_to(CONFIGS).with_suffix("").as_posix(): file for file in files}


def find_scene(name):
    """The file of a scene: as named from here, as named from the project's folder, or by its short name.

    None stands for the default scene. UsageError names what comes near, if there is no such scene.
    """
    if name is None:
        return DEFAULT_SCENE
    for file in (Path(name), ROOT / name):
        if file.exists() and not file.is_dir():
            return file
    scenes = short_names()
    wanted = re.sub("^places/", "sites/", name.removesuffix(".json"))  # the folder's former name
    fitting = [short for short in scenes if short == wanted or short.endswith("/" + wanted)]
    preferred = f"{PREFERRED}/{wanted}"
    if preferred in fitting or len(fitting) == 1:
        return scenes[preferred if preferred in fitting else fitting[0]]
    if fitting:
        raise UsageError(f'the scene "{name}" stands in several folders; allowed: {", ".join(fitting)}')
    raise UsageError(f'there is no scene "{name}"{suggestion(wanted, scenes)}; `tools/wade scenes` lists all')


def suggestion(wanted, scenes):
    """Returns the scenes with the nearest names, in words; empty if no name is near."""
    import difflib  # only where something is wrong, as it takes its time

    wanted = wanted.removeprefix("configs/")
    # Of a bare name the folder does not count; each bare name stands for its preferred scene.
    known = list(scenes) if "/" in wanted else [short.rpartition("/")[2] for short in scenes]
    near = list(dict.fromkeys(difflib.get_close_matches(wanted, known, 6)))[:3]
    return f"; did you mean {' or '.join(near)}?" if near else ""


def described(file):
    """A line on a scene, from its description; empty if it has none."""
    found = DESCRIPTION.search(file.read_text(encoding="utf-8"))
    return json.loads(found[1]) if found else ""


def main(arguments):
    """tools/wade scenes."""
    parser = Parser("scenes", "Lists the scenes by the short names under which `tools/wade run` and others find them.")
    parser.add_argument("words", nargs="*", metavar="WORD", help="only scenes with all of these in name or description")
    parser.add_argument("--long", action="store_true", help="the whole description of each")
    options = parser.parse_args(arguments)
    listed = {short: described(file) for short, file in short_names().items()}
    width = max(map(len, listed))
    for short, text in listed.items():
        if not all(word.lower() in f"{short} {text}".lower() for word in options.words):
            continue
        if options.long:
            print(short, *textwrap.wrap(text, COLUMNS - 2, initial_indent="  ", subsequent_indent="  "), sep="\n")
        else:
            print(f"{short:{width}}  {textwrap.shorten(text, COLUMNS - width - 2, placeholder=' ...')}".rstrip())
    return 0
