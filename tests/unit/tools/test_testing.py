"""tools/wade test and check-protocol: which tests run."""

import contextlib
import io
import unittest
from unittest import mock

from wade import check_protocol, testing
from wade.paths import BUILD

COMMON = ["--test-dir", str(BUILD), "--output-on-failure"]
QUICK = ["-LE", "^long$"]


class Choice(unittest.TestCase):
    def test_without_a_choice_the_long_ones_are_left_out(self):
        for arguments in ([], ["-V"], ["-j", "3"], ["-E", "kills"], ["--stop-on-failure"]):
            self.assertEqual(testing.ctest_options(arguments), [*COMMON, *QUICK, *arguments])

    def test_all_are_all(self):
        self.assertEqual(testing.ctest_options(["--all"]), COMMON)
        self.assertEqual(testing.ctest_options(["-V", "--all", "-j", "2"]), [*COMMON, "-V", "-j", "2"])

    def test_who_chooses_tests_gets_them_whatever_their_label(self):
        for arguments in (["-R", "protocol_model"], ["-L", "long"], ["-LE", "x"], ["-I", "1,5"], ["--tests-regex=x"],
                          ["--rerun-failed"]):
            self.assertEqual(testing.ctest_options(arguments), [*COMMON, *arguments])

    def test_the_exit_code_is_that_of_ctest_after_everything_is_built(self):
        with mock.patch.object(testing, "install") as install, mock.patch.object(testing, "bring_up_to_date") as build, \
                mock.patch.object(testing, "install_modules"), \
                mock.patch.object(testing.os, "execvp", return_value=8) as ctest, mock.patch.dict(testing.os.environ):
            self.assertEqual(testing.main(["--all"]), 8)
        self.assertEqual([call.args for call in install.call_args_list],
                         [("build", "pictures", "tests"), ("viewer",), ("readers",), ("engines",), ("builds",)])
        build.assert_called_once_with((), with_tests=True)
        ctest.assert_called_once_with("ctest", ["ctest", *COMMON])


class Protocol(unittest.TestCase):
    def run_with(self, codes, *arguments):
        said = io.StringIO()
        answers = [mock.Mock(returncode=code) for code in codes]
        with mock.patch.object(check_protocol, "bring_up_to_date"), contextlib.redirect_stdout(said), \
                mock.patch.object(check_protocol.subprocess, "run", side_effect=answers) as run:
            code = check_protocol.main(list(arguments))
        return code, said.getvalue(), [call.args[0] for call in run.call_args_list]

    def test_a_failure_is_named_at_the_end_and_stops_nothing(self):
        count = len(check_protocol.parts(False))
        code, text, commands = self.run_with([0, 1, *[0] * (count - 2)])
        self.assertEqual((code, len(commands)), (1, count))
        self.assertIn(f"FAILED: {check_protocol.parts(False)[1][0]}", text)

    def test_what_is_not_installed_is_no_failure(self):
        code, text, commands = self.run_with([77] * len(check_protocol.parts(True)), "--quick")
        self.assertEqual(code, 0)
        self.assertIn("All of it holds.", text)
        self.assertIn("--quick", commands[0])


if __name__ == "__main__":
    unittest.main()
