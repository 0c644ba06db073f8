"""Stands in for `tools/wade figure` where it is started by its file."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent / "python"))

from wade.pictures.figure import main  # noqa: E402

sys.exit(main(sys.argv[1:]))
