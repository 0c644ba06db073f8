"""Python sources pass pyflakes: no name that is unknown, imported for nothing or defined twice. Files that another user may
have made are opened by one module of each language."""

import re
import tempfile
import unittest
from pathlib import Path

from sources import ROOT, complaints, tracked

CHECK = ["/usr/bin/python3", "-m", "pyflakes"]


class Python(unittest.TestCase):
    def test_sources_pass(self):
        sources = tracked(".py")
        self.assertGreater(len(sources), 50)
        self.assertEqual(complaints(*CHECK, *sources), "")

    def test_a_fault_is_seen(self):
        with tempfile.TemporaryDirectory() as folder:
            source = Path(folder, "source.py")
            source.write_text("import os\nprint(unknown)\n")
            said = complaints(*CHECK, source)
            self.assertIn("'os' imported but unused", said)
            self.assertIn("undefined name 'unknown'", said)


class FilesOfOthers(unittest.TestCase):
    """Run folders, scenes and recordings are read by wade/plain_file.py and configs/files/plain_file.hpp, which never wait."""

    PYTHON = re.compile(r"(?<!plain_file)\.read_(?:text|bytes)\(|json\.load\(|sqlite3\.connect\(|np\.(?:load|fromfile)\(|"
                        r"copyfile\((?!pathlib\.Path\(__file__\)|PAGE)")
    FOLDERS = ("ensembles", "export", "pictures", "run", "statistics", "sweeps", "many.py", "terminal.py", "view.py")
    # What they read instead is their own, of the kernel or of the sources.
    OWN = {"pictures/render.py", "export/open_in_blender.py", "run/processes.py", "run/options.py", "view.py"}
    OF_KERNEL = {"configs/program/memory.cpp", "fluid_server/server/ranks_of_mpi.cpp", "fluid_server/server/run_server.cpp",
                 "fluid_server/server/threads_in_use.cpp", "shm_protocol/inside/liveness.cpp"}

    def test_python_reads_them_by_one_module(self):
        wade = ROOT / "tools" / "python" / "wade"
        found = {str(path.relative_to(wade)) for path in tracked(".py") if wade in path.parents
                 and path.relative_to(wade).parts[0] in self.FOLDERS and self.PYTHON.search(path.read_text())}
        self.assertEqual(found, self.OWN)

    def test_programs_read_them_by_one_class(self):
        folders = ("configs", "crowd_client", "fluid_server", "shm_protocol", "tools")
        found = {str(path.relative_to(ROOT)) for path in tracked(".cpp", ".hpp")
                 if path.relative_to(ROOT).parts[0] in folders and re.search(r"\bifstream\b|\bfopen\(", path.read_text())}
        self.assertEqual(found, self.OF_KERNEL)


if __name__ == "__main__":
    unittest.main()
