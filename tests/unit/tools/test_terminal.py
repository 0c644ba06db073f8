"""What is shown on a terminal: escapes for what it would obey, lines of at most 100 columns, closed streams."""

import contextlib
import io
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from wade import terminal


class Harmless(unittest.TestCase):
    def test_nothing_that_a_terminal_obeys_is_left(self):
        for code in [*range(0x20), *range(0x7F, 0xA0), 0x200E, 0x202E, 0x2066, 0xFEFF, 0xD800]:
            shown = terminal.harmless(f"a{chr(code)}b")
            self.assertTrue(shown.isascii() and shown.isprintable(), repr(shown))
            self.assertTrue(shown.startswith("a\\") and shown.endswith("b"), shown)

    def test_letters_stay(self):
        for text in ("Überlauf bei 3 m²/s, “so”", "水位", "plain"):
            self.assertEqual(terminal.harmless(text), text)

    def test_the_end_of_a_log_of_any_bytes_can_be_shown(self):
        with tempfile.TemporaryDirectory(prefix="wade-test-") as folder:
            log = Path(folder) / "log"
            log.write_bytes(b"first\n" + bytes(range(256)) + b"\n\xc2\x9b31m\xe2\x80\xae\x1b]0;x\x07\n")
            for line in terminal.tail_of(log, 3):
                self.assertTrue(line.isprintable(), repr(line))
            self.assertEqual(len(terminal.tail_of(log, 1)), 1)
            self.assertIn("\\x9b31m", terminal.tail_of(log, 1)[0])


class Width(unittest.TestCase):
    def test_errors_are_wrapped_and_paths_stay_whole(self):
        path = "/a/path/" + "long/" * 30 + "file-with-a-name.json"
        said = io.StringIO()
        with contextlib.redirect_stderr(said):
            terminal.say_error(f"wade: {path}: " + "it is not what was asked for " * 20)
        self.assertIn(path, said.getvalue())
        self.assertTrue(all(len(line) <= 100 or path in line for line in said.getvalue().splitlines()))

    def test_help_of_a_parser_is_at_most_100_columns_wide(self):
        parser = terminal.Parser("some-command", "Does something. " * 40 + "\n\n  kept as it is\n\n" + "More. " * 40, "End. " * 90)
        parser.add_argument("--an-option-with-a-long-name", metavar="A_VALUE", help="what it is for " * 30)
        self.assertLessEqual(max(map(len, parser.format_help().splitlines())), 100)
        self.assertIn("\n  kept as it is\n", parser.format_help())


class ClosedStreams(unittest.TestCase):
    def test_files_never_take_the_number_of_a_closed_stream(self):
        code = ("from wade.terminal import open_standard_streams as o; o(); import sys; f = open('/dev/null'); "
                "print('x'); sys.stdin.isatty(); sys.stdin.read(0); print('y', file=sys.stderr); sys.exit(f.fileno())")
        for closed in ("", "<&-", ">&-", "2>&-", "<&- >&-", "<&- 2>&-", ">&- 2>&-", "<&- >&- 2>&-"):
            with self.subTest(closed):
                done = subprocess.run(["sh", "-c", f'exec "$0" -c "$1" {closed}', sys.executable, code])
                self.assertGreaterEqual(done.returncode, 3)


if __name__ == "__main__":
    unittest.main()
