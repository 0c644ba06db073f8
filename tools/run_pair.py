"""Stands in for wade.run.pair where it is started by its file: run_pair.py --programs DIR ..."""

import os
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent / "python"))
at = sys.argv.index("--programs")
os.environ["WADE_BUILD"] = sys.argv[at + 1]

from wade.run.pair import main  # noqa: E402

sys.exit(main(sys.argv[1:at] + sys.argv[at + 2 :]))
