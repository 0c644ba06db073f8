"""The table of tools/wade: each subcommand is there, is told by --help in 100 columns, and builds what it needs."""

import contextlib
import importlib
import io
import os
import re
import subprocess
import unittest
from pathlib import Path
from unittest import mock

from wade import cli
from wade.building import BuildError
from wade.commands import all_commands, find_command
from wade import UsageError
from wade.paths import BUILD, ROOT, WADE

WIDE = {"COLUMNS": "300"}  # a terminal wider than any line may be


def answer(*words):
    return subprocess.run(words, capture_output=True, text=True, env={**os.environ, **WIDE}, stdin=subprocess.DEVNULL)


def call(*arguments):
    """(exit code, stdout, stderr) of tools/wade, in this process."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err), mock.patch.dict(os.environ, WIDE):
        try:
            code = cli.main(list(arguments))
        except SystemExit as end:
            code = end.code or 0
    return code, out.getvalue(), err.getvalue()


class Table(unittest.TestCase):
    def test_overview_names_all_subcommands_in_lines_that_fit(self):
        code, text, _ = call("--help")
        self.assertEqual(code, 0)
        for command in all_commands():
            self.assertRegex(text, rf"\n  {command.name} +{re.escape(command.meaning)}\n")
        self.assertLessEqual(max(map(len, text.splitlines())), 100)
        self.assertEqual(call()[0], 2)

    def test_names_are_unique_and_found_in_their_older_forms(self):
        names = [name for command in all_commands() for name in (command.name, *command.old_names)]
        self.assertEqual(len(names), len(set(names)))
        for command in all_commands():
            for name in (command.name, command.name.replace("-", "_"), *command.old_names):
                self.assertIs(find_command(name), command)

    def test_each_script_of_the_folder_is_a_subcommand(self):
        scripts = [file for file in (ROOT / "tools").glob("*.sh") if file.is_symlink()]
        self.assertGreater(len(scripts), 8)
        for file in scripts:
            self.assertEqual(file.resolve(), WADE.resolve())
            self.assertIsNotNone(find_command(file.stem), file.name)

    def test_unknown_subcommands_come_with_the_nearest(self):
        code, _, said = call("validte")
        self.assertEqual(code, 2)
        self.assertIn("did you mean validate?", said)

    def test_an_end_from_outside_leaves_no_traceback(self):
        for end, code in ((KeyboardInterrupt, 130), (BuildError, 1), (UsageError("no"), 2)):
            with mock.patch.object(cli, "overview", side_effect=end):
                self.assertEqual(call("--help")[0], code)

    def test_a_reader_that_has_gone_leaves_no_traceback(self):
        done = subprocess.run(["sh", "-c", f"{WADE} scenes | head -n 1"], capture_output=True, text=True)
        self.assertEqual((len(done.stdout.splitlines()), done.stderr), (1, ""))

    def test_programs_are_targets_of_the_build(self):
        targets = set(re.findall(r"^build (\w+): (?:phony|CXX_EXECUTABLE)", (BUILD / "build.ninja").read_text(), re.MULTILINE))
        for command in all_commands():
            for name in command.programs:
                self.assertTrue(name in targets, f"{command.name}: {name}")

    def test_what_a_module_starts_of_the_build_is_built_before(self):
        for command in all_commands():
            module = importlib.import_module(command.module) if command.module and not command.script else None
            if module is None or hasattr(module, "programs_for"):
                continue
            file = Path(module.__file__)
            sources = file.parent.rglob("*.py") if file.name == "__init__.py" else [file]
            text = "".join(source.read_text(encoding="utf-8") for source in sources)
            started = set(re.findall(r'BUILD / "(\w+)"(?! /)', text)) | set(re.findall(r'BUILD\.rglob\("(\w+)"', text))
            self.assertLessEqual(started, set(command.programs), command.name)

    def test_modules_have_a_main(self):
        for command in all_commands():
            if not command.script:
                self.assertTrue(callable(importlib.import_module(command.module).main), command.name)


class Lines(unittest.TestCase):
    def assert_fits(self, text, whose):
        self.assertNotEqual(text.strip(), "", whose)
        for line in text.splitlines():
            self.assertLessEqual(len(line), 100, f"{whose}: {line}")

    def test_help_of_every_subcommand_fits_and_builds_nothing(self):
        for command in all_commands():
            with self.subTest(command.name), mock.patch.object(cli, "bring_up_to_date") as build:
                if command.script:
                    said = answer(WADE, command.name, "--help")
                    said = said.returncode, said.stdout, said.stderr
                else:
                    said = call(command.name, "--help")
                self.assertEqual((said[0], said[2]), (0, ""))
                self.assert_fits(said[1], command.name)
                build.assert_not_called()

    def test_a_wrong_option_is_refused_by_every_subcommand_in_lines_that_fit(self):
        # The options of run and test are those of other programs.
        for command in all_commands():
            if command.script or command.name in ("run", "test"):
                continue
            with self.subTest(command.name), mock.patch.object(cli, "bring_up_to_date"):
                code, _, said = call(command.name, "--nosuchoption")
                self.assertEqual(code, 2, said)
                self.assert_fits(said, command.name)

    def test_help_of_the_programs_for_sessions_fits(self):
        for name in ("shm_record", "shm_replay", "shm_inspect", "shm_clean"):
            with self.subTest(name):
                self.assert_fits(answer(BUILD / name, "--help").stdout, name)

    def test_help_of_the_other_scripts_fits(self):
        install = ROOT / "tools" / "install_dependencies.sh"
        self.assert_fits(answer(install, "--help").stdout, install.name)
        refused = answer(install, "nosuchset")
        self.assertEqual(refused.returncode, 2)
        self.assert_fits(refused.stderr, install.name)


if __name__ == "__main__":
    unittest.main()
