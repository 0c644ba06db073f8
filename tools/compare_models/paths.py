"""Where the modules of the other suites are that this one uses. tools/paper comes first: its names win."""

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[1:1] = [str(ROOT / "tools" / folder) for folder in (".", "paper", "validation", "speed_vs_error")]
