"""Where the project and its programs lie."""

import os
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
CONFIGS = ROOT / "configs"
# An installed command has no sources beside it and builds nothing; the man page is made of what it says.
INSTALLED = not (ROOT / "CMakeLists.txt").exists() or "WADE_INSTALLED" in os.environ
# Another build folder may be named, for example one with sanitizers.
BUILD = Path(os.environ.get("WADE_BUILD") or ROOT / "build" / "release").absolute()
WADE = ROOT / "tools" / "wade"
# Where runs and reports go that were given no --out.
RUNS = (Path.cwd() if INSTALLED else ROOT) / "runs"
# Compiled modules: of an installed command a folder of the user's cache, which packaging/wade.in names.
CACHE = sys.pycache_prefix or str(ROOT / "build" / "pycache")


def home_folder():
    """The user's home, or a folder of his own among the temporary files where he has none that can be written."""
    home = Path(os.path.expanduser("~"))  # stays "~" for a user that the system does not know
    if home.is_absolute() and os.access(home, os.W_OK):
        return home
    import tempfile  # only where it is needed, as the import takes its time

    folder = Path(tempfile.gettempdir()) / f"wade-{os.getuid()}"
    folder.mkdir(mode=0o700, exist_ok=True)
    return folder if folder.lstat().st_uid == os.getuid() else Path(tempfile.mkdtemp(prefix="wade-"))


def module_command(name):
    """Words that start a module's main() in a process of its own, with nothing built before it."""
    package = ROOT / "tools" / "python"
    return [sys.executable, "-X", f"pycache_prefix={CACHE}", str(package), "--module", name]
