"""Whether a run of older programs is a run of a scene of today."""

import functools
import json
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def what_counts(scene):
    """The scene without the words that change no result."""
    return {key: value for key, value in scene.items() if key not in ("name", "description")}


@functools.cache
def schema():
    return json.loads((ROOT / "configs" / "scene.schema.json").read_text(encoding="utf-8"))


def is_default(value, node):
    """Whether a value of a scene is what the schema gives where a scene is silent."""
    if isinstance(value, dict) and "properties" in node:
        return all(key in node["properties"] and is_default(v, node["properties"][key]) for key, v in value.items())
    return "default" in node and value == node["default"]


def same_scene(old, now):
    """Two resolved scenes are the same but for keys that the older programs did not know and that have their default
    now."""
    return same_part(what_counts(old), what_counts(now), schema())


def same_part(old, now, node):
    if not (isinstance(old, dict) and isinstance(now, dict)):
        return old == now
    known = node.get("properties", {})
    new_keys = now.keys() - old.keys()
    return old.keys() <= now.keys() and all(is_default(now[key], known.get(key, {})) for key in new_keys) and all(
        same_part(old[key], now[key], known.get(key, {})) for key in old
    )
