"""The tracked files of the project, and programs that look at them."""

import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def git(*arguments: str) -> list[str]:
    """The lines that git prints for these arguments, run at the root."""
    done = subprocess.run(["git", "-C", ROOT, *arguments], capture_output=True, text=True, check=True)
    return done.stdout.splitlines()


def tracked(*endings: str) -> list[Path]:
    """Returns the tracked files that exist and have one of these name endings, sorted, without links."""
    paths = [ROOT / name for name in git("ls-files") if name.endswith(endings)]
    return sorted(path for path in paths if path.is_file() and not path.is_symlink())


def complaints(*command) -> str:
    """Returns the output of a program that fails; empty if it exits with 0."""
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, cwd=ROOT, check=False)
    return "" if done.returncode == 0 else done.stdout + done.stderr
