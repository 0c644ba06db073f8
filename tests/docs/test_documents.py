"""No document names a file, a command, an option or a scene key that does not exist."""

import os
import re
import unittest

from checks import WIDEST_PROSE, Checker
from known_names import ROOT, Commands, Schema, Tree

TREE = Tree()
COMMANDS = Commands(TREE, os.environ.get("WADE_PROGRAMS", ROOT / "build" / "release"))
CHECKER = Checker(TREE, COMMANDS, Schema(TREE))
KINDS = ("link", "anchor", "path", "file", "output", "scene", "program", "subcommand", "option", "key")
ENDINGS = ("md", "py", "sh", "cpp", "hpp", "h", "json", "csv", "c", "mjs")
ROOMS = ("configs", "shm_protocol", "fluid_server", "crowd_client")


class Documents(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        CHECKER.seen.clear()
        cls.problems = [f"{name}:{line}: {kind}: {what}"
                        for name in TREE.documents() for line, kind, what in CHECKER.problems(name)]
        cls.seen = dict(CHECKER.seen)

    def test_name_nothing_that_is_not_there(self):
        self.assertEqual(self.problems, [], "\n" + "\n".join(self.problems))

    def test_are_seen_to_name_things_of_every_kind(self):
        self.assertEqual([kind for kind in KINDS if self.seen.get(kind, 0) < 3], [], "the scan is blind")

    def test_are_held_against_the_help_of_built_programs(self):
        if COMMANDS.not_built:
            self.skipTest("not built, so that options are looked for in the code: "
                          + ", ".join(sorted(COMMANDS.not_built)))

    def test_readme_is_short(self):
        self.assertLess(len(TREE.text("README.md").split()), 900)

class Sources(unittest.TestCase):
    """Comments, messages and help name files, too."""

    NAME = re.compile(rf"(?<![\w/$}}.<-])(?:docs|tools|tests|{'|'.join(ROOMS)})/[\w/.-]*\w\.(?:{'|'.join(ENDINGS)})\b")

    def names(self, text):
        return [name for name in self.NAME.findall(text) if not re.search("[A-Z]{2,}|my_", name.replace("README", ""))]

    def test_name_no_file_that_is_not_there(self):
        named = self.names(TREE.sources)
        self.assertGreater(len(named), 100)
        self.assertEqual([name for name in sorted(set(named)) if not TREE.has(name)], [])

    def test_names_are_found_in_comments_and_strings(self):
        self.assertEqual(self.names('// see docs/gone.md.\n"tools/gone.sh --help"'), ["docs/gone.md", "tools/gone.sh"])
        self.assertEqual(self.names("configs/NAME.json configs/my_scene.json ${DIR}/docs/gone.md"), [])


class Tables(unittest.TestCase):
    """Tables that say again what the code says."""

    def test_glossary_names_words_of_the_code(self):
        rows = [line.split("|") for line in TREE.text("docs/glossary.md").split("\n") if line.count("|") == 7]
        spans = [span for row in rows[2:] for cell in (row[3], row[6]) for span in re.findall(r"`([^`]+)`", cell)]
        words = [word for span in spans for word in re.findall(r"[A-Za-z_]\w+", os.path.splitext(span)[0])]
        self.assertGreater(len(words), 60)
        self.assertEqual([word for word in words if word not in TREE.words], [])

    def test_rooms_of_contributing_are_those_of_cmake_and_nothing_points_upward(self):
        rows = re.findall(r"(?m)^\| `(\w+)` \|.*\|(.*)\|$", TREE.text("CONTRIBUTING.md"))
        self.assertGreater(len(rows), 20)
        written = {room: set(re.findall(r"\w+", uses)) for room, uses in rows}
        self.assertEqual(written, TREE.rooms(ROOMS))
        seen = set()
        for room, _ in rows:
            self.assertLessEqual(written[room], seen, f"{room} stands above what it builds on")
            seen.add(room)

    def test_steps_have_the_stages_of_the_programs(self):
        water = TREE.text("docs/step_of_the_water.md")
        written = {"dfsph/fluid_world.hpp": re.findall(r"(?m)^\| `(\w+)` \|.*\|.*\|.*\|$", water)}
        for file in ("shallow_water/step.hpp", "mixed/mixed_world.hpp"):
            row = re.search(rf"(?m)^\| `\w+` \|(.*)\| `fluid_server/{file}` \|$", water)[1]
            written[file] = re.findall(r"`(\w+)`", row)
        for file, rows in written.items():
            names = re.search(r"stage_names\{([^}]*)\}", TREE.text("fluid_server/" + file))[1]
            self.assertEqual(sorted(rows), sorted(re.findall(r'"(\w+)"', names)), file)
        crowd = re.findall(r'Stage\{"([\w ]+)"', TREE.text("crowd_client/crowd_world.cpp"))
        self.assertGreater(len(crowd), 5)
        rows = re.findall(r"(?m)^\| ([\w ]+) \|[^|]*\|[^|]*\|[^|]*\|$", TREE.text("docs/step_of_the_crowd.md"))
        self.assertEqual([row for row in rows if row in crowd], crowd)

    def test_lists_of_documents_and_of_tests_are_complete(self):
        for sign, form in (("docs/README.md", r"docs/(\w+\.md)$"), ("tests/README.md", r"(tests/\w+)/"),
                           ("docs/reports/README.md", r"docs/reports/(\w+/report\.md)$")):
            there = {found[1] for found in map(re.compile(form).match, TREE.files) if found} - {"README.md"}
            self.assertGreater(len(there), 5)
            self.assertEqual([name for name in sorted(there) if name not in TREE.text(sign)], [], f"not in {sign}")

    def test_each_folder_of_the_product_has_a_door_sign(self):
        folders = {os.path.dirname(name) for name in TREE.files if re.match(rf"({'|'.join(ROOMS)})/.*\.[ch]pp$", name)}
        self.assertGreater(len(folders), 10)
        self.assertEqual([folder for folder in sorted(folders) if not TREE.has(folder + "/README.md")], [])


class MadeUpDocument(unittest.TestCase):
    """A name that is wrong is found, one that is right is not."""

    def problems(self, text, name="docs/made_up.md"):
        return [(kind, line) for line, kind, _ in CHECKER.problems(name, "# A title\n\n" + text)]

    def assert_found(self, kind, *texts):
        for text in texts:
            with self.subTest(text=text):
                self.assertEqual(self.problems(text), [(kind, 4 if text.startswith("```") else 3)])

    def assert_fine(self, *texts):
        for text in texts:
            with self.subTest(text=text):
                self.assertEqual(self.problems(text), [])

    def test_links(self):
        self.assert_fine("[a](results.md)", "[a](../README.md)", "![a](../tools/viewer/river_s05.png)", "[a](https://a.org)")
        self.assert_found("link", "[a](result.md)", "[a](../READMI.md)", "![a](../configs/paper/s055.png)")
        self.assert_found("link", "| [a](no.md) |", "[a](no.md)\nb", "[a]: no.md")

    def test_anchors(self):
        self.assert_fine("[a](#a-title)", "[a](results.md#the-paper)", "[a](file_formats.md#outcomejson)")
        self.assert_found("anchor", "[a](#a-titel)", "[a](results.md#the-papers)")

    def test_paths(self):
        self.assert_fine("`configs/paper/s05.json`", "`docs/`", "`configs/**/*.json`", "`docs/{results,limits}.md`")
        self.assert_fine("`configs/my_scene.json`", "`runs/s08/outcome.json`", "`DIR/figure.md`")
        self.assert_found("path", "`configs/paper/s055.json`", "`docs/result.md`", "`configs/**/*.jsn`", "`tools/x`")
        self.assert_found("path", "`docs/{results,limit}.md`", "```sh\ntools/runn.sh\n```", "| `tools/runn.sh` |")

    def test_files_named_alone(self):
        self.assert_fine("`layout.hpp`", "`agents.csv`", "`paper/s05.json`", "`gcc a.c -o a`")
        self.assert_found("file", "`layuot.hpp`", "`nowhere/layout.hpp`")
        self.assert_found("output", "`agnets.csv`", "`outcomes_of_all.json`")

    def test_short_names_of_scenes(self):
        self.assert_fine("`river/s05`", "`tools/wade run paper/s12`", "`river/my_scene`")
        self.assert_found("scene", "`river/s55`", "```sh\ntools/run.sh paper/s0 --seed 3\n```")

    def test_programs_and_subcommands(self):
        self.assert_fine("`build/release/fluid_server SCENE`", "`tools/wade validate`", "`tools/wade SUBCOMMAND`")
        self.assert_found("program", "`build/release/fluid_servant SCENE`")
        self.assert_found("subcommand", "`tools/wade valdate`", "`wade runn SCENE`")

    def test_options(self):
        self.assert_fine("`--reproducible`", "`tools/run.sh SCENE --record FILE`", "`cmake --made-up`")
        self.assert_found("option", "`--reproducable`", "`tools/run.sh SCENE --rekord FILE`", "`shm_inspect --watchh`")
        self.assert_found("option", "`tools/wade validate --quik`", "`tools/run.sh\n--rekord FILE`")
        self.assert_found("option", "```sh\ntools/run.sh --no-figur\n```", "```\n$ tools/run.sh --no-figur\n```")

    def test_scene_keys(self):
        self.assert_fine("`/fluid/model`", "`crowd.groups[].tau`", "`/crowd/groups/0/tau`", "`/dev/shm`", "`a.b`")
        self.assert_fine("`--set /fluid/model=mixed`", '`"fluid": { "model": "auto" }`')
        self.assert_found("key", "`/fluid/modell`", "`crowd.groups[].taus`", "`/fluids/model`", "`--set /fluid/cfll=1`")
        self.assert_found("key", '`"fluid": { "modell": "auto" }`', '`"fluid": { "model": "water" }`')
        self.assert_found("key", "`--set /fluid/kernel=cubic`", "`tools/run.sh SCENE --set /fluid/kernel=cubic`")

    def test_scenes(self):
        self.assert_fine('```json\n// a comment\n{ "crowd": { "tau": 0.1 } } // another\n```')
        self.assert_found("key", '```json\n{ "crowd": { "taus": 0.1 } }\n```', '```json\n{ "seed": 1\n```')
        self.assert_found("key", '```json\n[{ "name": "a", "set": { "/seeds": 3 } }]\n```')

    def test_width_of_prose(self):
        self.assert_fine("x" * WIDEST_PROSE, "| " + "x" * WIDEST_PROSE + " |", "```\n" + "x" * 300 + "\n```")
        self.assert_found("width", "x" * (WIDEST_PROSE + 1), "* " + "x" * WIDEST_PROSE)

    def test_a_changelog_may_name_what_is_gone(self):
        self.assertEqual(self.problems("`tools/gone.sh`", "CHANGELOG.md"), [])
        self.assertEqual(self.problems("[a](tools/gone.sh)", "CHANGELOG.md"), [("link", 3)])


if __name__ == "__main__":
    unittest.main()
