"""The names of wade.pictures.run_files for scripts that do not stand in the package."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent / "python"))

from wade.pictures.run_files import *  # noqa: E402, F401, F403
