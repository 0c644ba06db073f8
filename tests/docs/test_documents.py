"""No document names a file, a command, an option or a scene key that does not exist."""

import os
import re
import unittest
from pathlib import Path

from checks import WIDEST_PROSE, Checker
from known_names import ROOT, Commands, Schema, Tree

TREE = Tree()
COMMANDS = Commands(TREE, os.environ.get("WADE_PROGRAMS", ROOT / "build" / "release"))


def checker():
    return Checker(TREE, COMMANDS, Schema(TREE))


class Documents(unittest.TestCase):
    def test_name_nothing_that_is_not_there(self):
        check = checker()
        found = [f"{name}:{line}: {kind}: {what}" for name in TREE.documents() for line, kind, what in check.problems(name)]
        self.assertEqual(found, [], "\n" + "\n".join(found))
        for kind in ("link", "anchor", "path", "file", "output", "program", "option", "key"):
            self.assertGreater(check.seen.get(kind, 0), 10, f"hardly a {kind} is found: the scan is blind")

    def test_are_held_against_the_help_of_built_programs(self):
        check = checker()
        for name in TREE.documents():
            check.problems(name)
        if COMMANDS.not_built:
            self.skipTest(f"not built, so that options are looked for in the code: {', '.join(sorted(COMMANDS.not_built))}")

    def test_that_sources_name_are_there(self):
        named = re.findall(r"\b(?:docs|tools|tests|configs|fluid_server|crowd_client|shm_protocol)/[\w/]+\.md\b", TREE.sources)
        self.assertEqual([name for name in sorted(set(named)) if not TREE.has(name)], [])

    def test_glossary_names_words_of_the_code(self):
        rows = [line.split("|") for line in TREE.text("docs/glossary.md").split("\n") if line.count("|") == 7]
        spans = [span for row in rows[2:] for cell in (row[3], row[6]) for span in re.findall(r"`([^`]+)`", cell)]
        words = [word for span in spans for word in re.findall(r"[A-Za-z_]\w+", os.path.splitext(span)[0])]
        self.assertGreater(len(words), 60)
        self.assertEqual([word for word in words if word not in TREE.words], [])


class MadeUpDocument(unittest.TestCase):
    """A name that is wrong is found, one that is right is not."""

    def problems(self, text, name="docs/made_up.md"):
        return [(kind, line) for line, kind, _ in checker().problems(name, text)]

    def assert_found(self, kind, *texts):
        for text in texts:
            with self.subTest(text=text):
                self.assertEqual(self.problems("# A title\n\n" + text), [(kind, 3 + text.count("\n") // 2)])

    def assert_fine(self, *texts):
        for text in texts:
            with self.subTest(text=text):
                self.assertEqual(self.problems("# A title\n\n" + text), [])

    def test_links(self):
        self.assert_fine("[a](results.md)", "[a](../README.md)", "![a](../configs/paper/s05.png)", "[a](https://example.org/x.md)")
        self.assert_found("link", "[a](result.md)", "[a](../READMI.md)", "![a](../configs/paper/s055.png)", "| [a](no.md) |")

    def test_anchors(self):
        self.assert_fine("[a](#a-title)", "[a](results.md#the-paper)")
        self.assert_found("anchor", "[a](#a-titel)", "[a](results.md#the-papers)")

    def test_paths(self):
        self.assert_fine("`configs/paper/s05.json`", "`docs/`", "`configs/**/*.json`", "`docs/{results,limits}.md`", "`tests/unit/my_part`")
        self.assert_found("path", "`configs/paper/s055.json`", "`docs/result.md`", "`configs/**/*.jsn`", "`tests/units`")
        self.assert_found("path", "`docs/{results,limit}.md`", "```sh\ntools/runn.sh\n```")

    def test_files_named_alone(self):
        self.assert_fine("`layout.hpp`", "`agents.csv`", "`paper/s05.json`")
        self.assert_found("file", "`layuot.hpp`", "`nowhere/layout.hpp`")
        self.assert_found("output", "`agnets.csv`", "`outcomes_of_all.json`")

    def test_programs(self):
        self.assert_fine("`build/release/fluid_server SCENE`")
        self.assert_found("program", "`build/release/fluid_servant SCENE`")

    def test_options(self):
        self.assert_fine("`--reproducible`", "`tools/run.sh SCENE --record FILE`", "`cmake --made-up`", "```sh\ntools/run.sh --no-figure\n```")
        self.assert_found("option", "`--reproducable`", "`tools/run.sh SCENE --rekord FILE`", "`shm_inspect --watchh`")

    def test_scene_keys(self):
        self.assert_fine("`/fluid/model`", "`crowd.groups[].tau`", "`/crowd/groups/0/tau`", "`--set /fluid/model=mixed`", "`/dev/shm`")
        self.assert_found("key", "`/fluid/modell`", "`crowd.groups[].taus`", "`/fluids/model`", "`--set /fluid/kernel=cubic`")
        self.assert_fine('`"fluid": { "model": "auto" }`', '```json\n{ "crowd": { "tau": 0.1 } }\n```')
        self.assert_found("key", '`"fluid": { "modell": "auto" }`', '`"fluid": { "model": "water" }`')
        self.assert_found("key", '```json\n{ "crowd": { "taus": 0.1 } }\n```')

    def test_width_of_prose(self):
        self.assert_fine("x" * WIDEST_PROSE, "| " + "x" * WIDEST_PROSE + " |")
        self.assert_found("width", "x" * (WIDEST_PROSE + 1))

    def test_a_changelog_may_name_what_is_gone(self):
        self.assertEqual(self.problems("`tools/gone.sh`", "CHANGELOG.md"), [])
        self.assertEqual(self.problems("[a](tools/gone.sh)", "CHANGELOG.md"), [("link", 1)])


if __name__ == "__main__":
    unittest.main()
