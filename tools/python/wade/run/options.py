"""Options of the programs of a run, known before the programs are built, and checks of their values.

What only the programs can know, for example the length of a list of the scene, they check themselves.
"""

import json
import re

from wade import UsageError
from wade.paths import CONFIGS

SCHEMA = CONFIGS / "scene.schema.json"

# {program: {option: allowed values}}. None is a switch; "" is any text. The other words are those that the program answers
# to a wrong value. A test compares the table with the programs.
SWITCHES = {"--help": None, "--version": None}
TIME_OUTS = {"--attach-timeout-s": "0 to 86400", "--step-timeout-s": "0 to 86400"}
OF_BOTH = {
    **SWITCHES, **TIME_OUTS, "--session": "", "--out": "", "--reproducible": None,
    "--threads": "whole numbers from 0 to 1024", "--seed": "", "--until-s": "", "--set": "", "--check": None,
    "--print-config": None,
}
OPTIONS = {
    "fluid_server": {
        **OF_BOTH, "--consumers": "whole numbers from 0 to 16", "--clock": "fast, real_time, variable", "--from-state": "",
        "--save-state": "",
    },
    "crowd_client": {
        **OF_BOTH, "--water-every-s": "0 to 1e+06", "--danger-every-s": "0 to 1e+06", "--terms-every-s": "0 to 1e+06",
        "--no-trajectories": None, "--step-times": None, "--crowds": "", "--mode": "lockstep, latest",
        "--agents-consumers": "whole numbers from 1 to 16", "--commands": "",
    },
    "shm_record": {
        **SWITCHES, **TIME_OUTS, "--stream": "fluid, agents", "--lead": None, "--frames": "whole numbers from 0 to 1e+15",
        "--compression": "whole numbers from 0 to 19", "--interval-s": "0 to 86400", "--region": "", "--quantised": None,
    },
    "shm_replay": {
        **SWITCHES, **TIME_OUTS, "--session": "", "--info": None, "--depth": "whole numbers from 0 to 63",
        "--consumers": "whole numbers from 0 to 16", "--any-scene": None, "--take-agents": None,
    },
}
POINTERS = {"--seed": "/seed", "--until-s": "/duration_s"}
TYPE_WORDS = {
    "number": "a number", "integer": "a whole number", "boolean": "true or false", "string": "a string",
    "object": "an object", "array": "an array",
}


def nearest(name, known):
    """The most similar of the known names."""
    import difflib  # only after an error, as the import takes time

    return difflib.get_close_matches(name, list(known), 1, 0)[0]


def number_of(text):
    """The number that a text holds, None if it holds none."""
    try:
        return float(text)
    except ValueError:
        return None


def refuse_constant(word):
    """Refuses NaN and Infinity, which Python reads and JSON does not have."""
    raise ValueError(word)


def check_option(name, value, allowed):
    """Checks the value of a program's option by the words of the table. UsageError."""
    if name == "--set":
        check_set(value)
    elif name in POINTERS:
        set_value(POINTERS[name], value, f"{name} {value}")
    elif found := re.fullmatch(r"(whole numbers from )?(\S+) to (\S+)", allowed):
        whole, low, high = found[1], float(found[2]), float(found[3])
        number = number_of(value)
        if number is None or not low <= number <= high or whole and number != int(number):
            raise UsageError(f"{name}: {value} is not allowed; allowed: {allowed}")
    elif allowed and value not in allowed.split(", "):
        raise UsageError(f"{name}: {value} is not allowed; allowed: {allowed}")


def check_set(assignment):
    """Checks POINTER=VALUE by the schema of scenes. UsageError."""
    pointer, equals, value = assignment.partition("=")
    source = "--set " + (assignment if len(assignment) <= 100 else assignment[:100] + "...")
    if not equals:
        raise UsageError(f"{source}: expected /json/pointer=value, for example /fluid/cfl=0.3")
    if not pointer.startswith("/"):
        raise UsageError(f'{source}: "{pointer}" is not a JSON pointer; one begins with \'/\', for example /fluid/cfl')
    set_value(pointer, value, source)


def set_value(pointer, text, source):
    """Checks a text that is set at a JSON pointer: JSON, or else the text itself."""
    node, above = json.loads(SCHEMA.read_text(encoding="utf-8")), ""
    for key in re.sub("^/place(?=/|$)", "/site", pointer)[1:].split("/"):  # the former name
        key = key.replace("~1", "/").replace("~0", "~")
        if "properties" in node:
            node = member(node, key, above, source)
        elif node.get("items", {}).get("type") == "object":
            if not re.fullmatch("[0-9]+", key):
                raise UsageError(f'{source}: {above}/{key}: "{key}" is not an index of {above}; allowed: a whole number from 0')
            node = node["items"]
        else:
            raise UsageError(f"{source}: {above} is no object and no array, so that nothing lies below it")
        above += "/" + key
    value = text
    try:
        parsed = json.loads(text, parse_constant=refuse_constant)
        if node["type"] != "string" or isinstance(parsed, str):
            value = parsed
    except (ValueError, RecursionError):
        pass
    check_value(value, node, above, source)


def member(node, key, pointer, source):
    """The schema of a key of an object."""
    if key not in node["properties"]:
        raise UsageError(f'{source}: {pointer}/{key}: unknown key {shown(key)}; the nearest known key is '
                         f'"{nearest(key, node["properties"])}"')
    return node["properties"][key]


def shown(value):
    """A value as JSON; long ones are cut."""
    text = json.dumps(value, ensure_ascii=False, separators=(",", ":"))
    return text if len(text) <= 60 else text[:60] + "..."


def has_type(value, name):
    """Whether a JSON value is of a type of the schema."""
    if name in ("number", "integer"):
        is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
        return is_number and (name == "number" or value == value // 1)
    return isinstance(value, {"boolean": bool, "string": str, "object": dict, "array": list}[name])


def is_within(value, node):
    """Whether a number is in the range of the schema."""
    return (node.get("minimum", value) <= value <= node.get("maximum", value)
            and not ("exclusiveMinimum" in node and value <= node["exclusiveMinimum"])
            and not ("exclusiveMaximum" in node and value >= node["exclusiveMaximum"]))


def range_words(node):
    """The range of the schema in words, for example "> 0 and <= 1000 s"."""
    signs = {"exclusiveMinimum": ">", "minimum": ">=", "exclusiveMaximum": "<", "maximum": "<="}
    return " and ".join(f"{sign} {node[name]}" for name, sign in signs.items() if name in node) + (
        " " + node["x-unit"] if "x-unit" in node else "")


def check_value(value, node, pointer, source):
    """Checks a JSON value by its schema. UsageError names key, value and what is allowed."""
    types = node["type"] if isinstance(node["type"], list) else [node["type"]]
    if not any(has_type(value, name) for name in types):
        words = " or ".join(TYPE_WORDS[name] for name in types)
        raise UsageError(f"{source}: {pointer}: expected {words}, found {shown(value)}")
    if isinstance(value, dict):
        for key, inner in value.items():
            check_value(inner, member(node, key, pointer, source), f"{pointer}/{key}", source)
    elif isinstance(value, list):
        if not node.get("minItems", 0) <= len(value) <= node.get("maxItems", len(value)):
            raise UsageError(f"{source}: {pointer}: {shown(value)} is not a point; allowed: {node['minItems']} numbers")
        for i, inner in enumerate(value):
            check_value(inner, node["items"], f"{pointer}/{i}", source)
    elif isinstance(value, str):
        if "enum" in node and value not in node["enum"]:
            allowed = ", ".join(f'"{word}"' for word in node["enum"])
            raise UsageError(f'{source}: {pointer}: {shown(value)} is not allowed; allowed: {allowed}; the nearest is '
                             f'"{nearest(value, node["enum"])}"')
        size = len(value.encode())
        if not node.get("minLength", 0) <= size <= node.get("maxLength", size) or not re.search(node.get("pattern", ""), value):
            limits = f"{node.get('minLength', 0)} to {node.get('maxLength', 'any number of')} characters"
            pattern = f", {node['pattern']}" if "pattern" in node else ""
            raise UsageError(f"{source}: {pointer}: {shown(value)} is not allowed; allowed: {limits}{pattern}")
    elif not isinstance(value, bool) and not is_within(value, node):
        raise UsageError(f"{source}: {pointer}: {shown(value)} is out of range; allowed: {range_words(node)}")
