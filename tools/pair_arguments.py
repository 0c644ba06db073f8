"""Names of the package for scripts that do not stand in it."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent / "python"))

from wade.scenes import find_scene  # noqa: E402, F401
