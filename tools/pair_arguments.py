"""Names of the package for scripts that do not stand in it."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent / "python"))

from wade import scenes  # noqa: E402
from wade.errors import UsageError  # noqa: E402


def find_scene(name):
    try:
        return scenes.find_scene(str(name))
    except UsageError as error:
        print(f"--scene: {name}: {error}", file=sys.stderr)
        sys.exit(2)
