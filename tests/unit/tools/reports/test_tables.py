"""Prose of reports is wrapped, and stays the same text."""

import unittest

from wade.reports.tables import document, wrapped

PROSE = " ".join(f"word{n}" for n in range(60))


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
