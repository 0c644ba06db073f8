"""The list of states, and that programs, tables, pages and documents know each of its lines."""

import re
import tempfile
import unittest
from pathlib import Path

from wade import UsageError, states
from wade.paths import CONFIGS, ROOT
from wade.pictures import top_view
from wade.statistics import page

LIST = CONFIGS / "scene" / "states.def"


class States(unittest.TestCase):
    def test_each_line_of_the_list_is_read(self):
        lines = [line for line in LIST.read_text().splitlines() if re.match(r"WADE_\w+\(", line)]
        self.assertEqual(len(states.STATES), len(lines))
        self.assertEqual(list(states.STATES)[:3], ["walking", "arrived", "dead"], "codes of the agents stream")

    def test_a_new_line_is_a_new_state(self):
        with tempfile.TemporaryDirectory(prefix="wade-test-") as folder:
            longer = Path(folder) / "states.def"
            longer.write_text(LIST.read_text() + "WADE_PERSON_STATE(flies, carried, none)\n")
            self.assertEqual(states.read_states(longer)["flies"], states.State("flies", "carried", "none", True, False))

    def test_each_state_is_drawn_once_or_hidden_by_walls(self):
        drawn = sorted(code for codes in top_view.CODES_OF.values() for code in codes)
        self.assertEqual(drawn, [states.UNKNOWN] + [code for word, code in states.CODES.items() if word not in states.IN_HOUSES])

    def test_the_page_of_the_viewer_has_a_symbol_of_each_state(self):
        text = (ROOT / "tools/viewer/page/panel.js").read_text()
        table = re.search(r"SYMBOLS = \{(.*?)\n\};", text, re.DOTALL)[1]
        self.assertEqual(set(states.STATES) - set(re.findall(r"(\w+): (?:\[|null)", table)), set())

    def test_the_report_explains_each_kind(self):
        kinds = {state.kind for state in states.STATES.values()}
        self.assertEqual(kinds - set(page.WORDS), set())
        self.assertEqual(kinds - set(page.COLOURS), set())

    def test_other_outcomes_and_states_are_refused_with_their_row(self):
        states.check_states("agents.csv", states.OUTCOMES, list(states.STATES))
        self.assertEqual(states.OUTCOMES, ("active", "arrived", "dead", "sheltered", "indoors", "upper_floor"))
        for outcomes, of_people, said in ((["dead", "vanished"], ["dead", "dead"], 'row 2: outcome "vanished" is not allowed; allowed: active, '),
                                          (["dead", "carried"], ["dead", "carried"], 'row 2: outcome "carried"'),
                                          (["active", "dead"], ["flying", "dead"], 'row 1: state "flying" is not allowed; allowed: walking, ')):
            with self.assertRaises(UsageError) as caught:
                states.check_states("agents.csv", outcomes, of_people)
            self.assertIn(said, str(caught.exception))

    def test_documents_name_each_code_of_the_exports(self):
        text = " ".join((ROOT / "docs/engines.md").read_text().split())
        self.assertIn(", ".join(f"{code} {word}" for word, code in states.CODES.items()), text)

    def test_documents_name_each_state(self):
        for name in ("docs/file_formats.md", "docs/survival.md"):
            text = (ROOT / name).read_text()
            self.assertEqual([word for word in states.STATES if f"`{word}`" not in text], [], name)


if __name__ == "__main__":
    unittest.main()
