"""Numbers as text, and tables; prose of reports is wrapped, and stays the same text."""

import tempfile
import unittest
from pathlib import Path

from wade.reports import tables
from wade.reports.tables import document, wrapped

PROSE = " ".join(f"word{n}" for n in range(60))


class Tables(unittest.TestCase):
    def test_a_bar_or_a_line_in_a_cell_does_not_break_the_table(self):
        lines = tables.markdown(("a", "b"), [("x|y", "1.0"), ("two\nlines", 2)]).splitlines()
        self.assertEqual(lines[0], "| a | b |")
        self.assertEqual(lines[2:], ["| x\\|y | 1.0 |", "| two lines | 2 |"])
        self.assertEqual({line.count("|") - line.count("\\|") for line in lines}, {3})

    def test_numbers_stay_as_they_were_written(self):
        self.assertIn("| 1.10 |", tables.markdown(("a",), [("1.10",)]))
        self.assertEqual(tables.plain(("name", "n"), [("a", "1.10"), ("bb", "10")]).splitlines()[1].split(),
                         ["a", "1.10"])

    def test_a_section_without_parts_is_none(self):
        self.assertEqual(tables.section("A", "", None), "")
        self.assertEqual(tables.section("A", "text\n", "", "more"), "## A\n\ntext\n\nmore\n")

    def test_a_table_is_read_as_it_was_written(self):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "new" / "t.csv"
            tables.write_csv(file, ("a", "b", "c"), [{"a": 1.23456789, "c": "x,y"}, ["", None, 2]])
            self.assertEqual(tables.read_csv(file),
                             [{"a": "1.23457", "b": "", "c": "x,y"}, {"a": "", "b": "", "c": "2"}])

    def test_words(self):
        self.assertEqual([tables.listed(parts) for parts in ([], "a", "ab", "abc")],
                         ["none", "a", "a and b", "a, b and c"])
        self.assertEqual([tables.count(n) for n in (None, 12345, 1.23456)], ["-", "12,345", "1.235"])


class Wrapped(unittest.TestCase):
    def test_lines_of_prose_are_no_wider_than_asked_for(self):
        lines = wrapped(f"{PROSE}\n\n* {PROSE}\n", 80).split("\n")
        self.assertLessEqual(max(len(line) for line in lines), 80)
        self.assertGreater(len(lines), 10)

    def test_words_and_their_order_stay(self):
        self.assertEqual(wrapped(PROSE, 80).split(), PROSE.split())

    def test_further_lines_of_an_item_belong_to_it(self):
        first, *rest = wrapped(f"* {PROSE}", 80).split("\n")
        self.assertTrue(first.startswith("* word0"))
        self.assertTrue(all(line.startswith("  word") for line in rest))

    def test_tables_headings_pictures_and_listings_are_left_alone(self):
        text = f"# {PROSE}\n\n| {PROSE} |\n\n![{PROSE}](a.png)\n\n```\n{PROSE}\n```\n"
        self.assertEqual(wrapped(text, 80), text)

    def test_no_line_begins_with_what_would_be_a_mark(self):
        for mark in ("-", "*", "+", "12.", "#", "="):
            with self.subTest(mark=mark):
                lines = wrapped(" ".join(f"word{n} {mark} {n}{n}" for n in range(100)), 40).split("\n")
                self.assertGreater(len(lines), 10)
                self.assertFalse([line for line in lines[1:] if line.split()[0] == mark])

    def test_a_document_is_wrapped(self):
        self.assertEqual(document(PROSE), wrapped(PROSE) + "\n")


if __name__ == "__main__":
    unittest.main()
