"""Writes the table of all scene keys into docs/scene_keys.md, from configs/scene.schema.json."""

import json
import pathlib

from wade.errors import UsageError
from wade.paths import CONFIGS, ROOT
from wade.terminal import Parser, say_error

BEGIN = "<!-- keys: written by tools/wade scene-docs from scene.schema.json -->"
END = "<!-- end of keys -->"


def range_of(schema):
    """The allowed values as mathematics: an interval, a list of choices, or the type."""
    if "enum" in schema:
        return ", ".join(f"`{name}`" for name in schema["enum"])
    kind, alternative = schema["type"], ""
    if isinstance(kind, list):  # a number, or an object with limits between which it is drawn
        kind = kind[0]
        alternative = ", or " + " and ".join(f"`{name}`" for name in schema["properties"])
    if kind in ("integer", "number"):
        left = f"({schema['exclusiveMinimum']}" if "exclusiveMinimum" in schema else f"[{schema.get('minimum', '-inf')}"
        right = f"{schema['exclusiveMaximum']})" if "exclusiveMaximum" in schema else f"{schema.get('maximum', 'inf')}]"
        return f"{'whole, ' if kind == 'integer' else ''}{left}, {right}{alternative}"
    return {"boolean": "`true`, `false`", "string": "text", "array": "list", "object": "object"}[kind]


def default_of(schema, required):
    if required:
        return "**required**"
    if "default" in schema:
        return f"`{json.dumps(schema['default'])}`"
    return schema.get("x-default", "")


def rows(schema, prefix=""):
    """One row for each key, depth first in the order of the schema: (key, unit, range, default, meaning)."""
    required = schema.get("required", [])
    for name, member in schema["properties"].items():
        key = f"{prefix}{name}"
        yield key, member.get("x-unit", ""), range_of(member), default_of(member, name in required), member["description"]
        if member["type"] == "object":
            yield from rows(member, f"{key}.")
        elif member["type"] == "array" and member["items"]["type"] == "object":
            yield from rows(member["items"], f"{key}[].")


def of_whole_scenes(schema):
    """The schema with what it asks of files that extend no other one asked of all."""
    whole = schema["else"]
    channel = schema["properties"]["channel"] | whole["properties"]["channel"]
    return schema | {"required": whole["required"], "properties": schema["properties"] | {"channel": channel}}


def table(schema):
    lines = ["| key | unit | range | default | meaning |", "|---|---|---|---|---|"]
    for key, unit, allowed, default, meaning in rows(schema):
        cells = (f"`{key}`", unit, allowed, default, meaning)
        lines.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
    return "\n".join(lines)


def main(arguments):
    """tools/wade scene-docs."""
    parser = Parser("scene-docs", __doc__)
    parser.add_argument("--check", action="store_true", help="change nothing; exit code 1 if the table is stale")
    parser.add_argument("--readme", type=pathlib.Path, help="file to write [docs/scene_keys.md]")
    options = parser.parse_args(arguments)
    readme = options.readme or ROOT / "docs" / "scene_keys.md"

    text = readme.read_text(encoding="utf-8")
    if text.count(BEGIN) != 1 or text.count(END) != 1:
        raise UsageError(f"{readme}: the two lines that frame the table are missing: {BEGIN} and {END}")
    before, rest = text.split(BEGIN)
    after = rest.split(END)[1]
    schema = json.loads((CONFIGS / "scene.schema.json").read_text(encoding="utf-8"))
    wanted = f"{before}{BEGIN}\n{table(of_whole_scenes(schema))}\n{END}{after}"
    if text == wanted:
        return 0
    if options.check:
        say_error(f"{readme}: the table of keys is stale; run tools/wade scene-docs")
        return 1
    readme.write_text(wanted, encoding="utf-8")
    return 0
