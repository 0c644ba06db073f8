"""Where the project and its programs lie."""

import os
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
CONFIGS = ROOT / "configs"
# Another build folder may be named, for example one with sanitizers.
BUILD = Path(os.environ.get("WADE_BUILD") or ROOT / "build" / "release").absolute()
WADE = ROOT / "tools" / "wade"


def module_command(name):
    """Words that start a module's main() in a process of its own, with nothing built before it."""
    package = ROOT / "tools" / "python"
    return [sys.executable, "-X", f"pycache_prefix={ROOT / 'build' / 'pycache'}", str(package), "--module", name]
