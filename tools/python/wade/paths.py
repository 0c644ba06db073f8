"""Where the project and its programs lie."""

import os
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
CONFIGS = ROOT / "configs"
# An installed command has no sources beside it and builds nothing.
INSTALLED = not (ROOT / "CMakeLists.txt").exists()
# Another build folder may be named, for example one with sanitizers.
BUILD = Path(os.environ.get("WADE_BUILD") or ROOT / "build" / "release").absolute()
WADE = ROOT / "tools" / "wade"


def home_folder():
    """The user's home, or a folder of his own among the temporary files where he has none that can be written."""
    home = Path(os.path.expanduser("~"))  # stays "~" for a user that the system does not know
    if home.is_absolute() and os.access(home, os.W_OK):
        return home
    import tempfile  # only for who needs it, as it takes its time

    folder = Path(tempfile.gettempdir()) / f"wade-{os.getuid()}"
    folder.mkdir(mode=0o700, exist_ok=True)
    return folder if folder.lstat().st_uid == os.getuid() else Path(tempfile.mkdtemp(prefix="wade-"))


def module_command(name):
    """Words that start a module's main() in a process of its own, with nothing built before it."""
    package = ROOT / "tools" / "python"
    return [sys.executable, "-X", f"pycache_prefix={ROOT / 'build' / 'pycache'}", str(package), "--module", name]
