"""Programs by what they compute: a run is done again if its program or its inputs have changed, not if a commit has."""

import hashlib
import os
import re

# The commit as the programs keep it (version.cpp), and the build number that the linker computes over it.
COMMIT = re.compile(rb"wade-commit=[\0-\xff]{52}")
BUILD_ID = re.compile(rb"(?<=\x04\0\0\0\x14\0\0\0\x03\0\0\0GNU\0)[\0-\xff]{20}")


def program_bytes(program):
    """The program without the commit that it names: neither a commit nor uncommitted changes ("-dirty") make a run out
    of date, unless they change the program."""
    return BUILD_ID.sub(bytes(20), COMMIT.sub(b"", program.read_bytes()))


def spheric2_data():
    """What WADE_SPHERIC2_DATA gives to the case spheric2, as far as a fingerprint needs: folder, files, sizes."""
    folder = os.environ.get("WADE_SPHERIC2_DATA", "")
    if not folder:
        return b""
    sizes = []
    if os.path.isdir(folder):
        sizes = sorted((e.name, e.stat().st_size) for e in os.scandir(folder) if e.name.endswith(".csv")
                       and e.is_file())
    return repr((os.path.abspath(folder), sizes)).encode()


class Fingerprints:
    """Of programs and all that they read: a run with the same one would give the same numbers."""

    def __init__(self, programs, root, patterns, words=()):
        """patterns: of files below root that the programs read; words: settings of all runs."""
        self.digest = hashlib.sha256(b"".join(map(program_bytes, programs)))
        for word in words:
            self.digest.update(word.encode() + b"\0")
        for file in [file for pattern in patterns for file in sorted(root.glob(pattern)) if file.is_file()]:
            self.digest.update(str(file.relative_to(root)).encode() + b"\0" + file.read_bytes())

    def __call__(self, case=""):
        digest = self.digest.copy()
        if case == "spheric2":
            digest.update(spheric2_data())
        return digest.hexdigest()[:16]
