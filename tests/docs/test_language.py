"""Comments, messages and documents are in plain words: few pronouns for things, few relative clauses, short sentences."""

import re
import statistics
import unittest

from document import parse
from known_names import Tree

TREE = Tree()
FOLDERS = ("configs", "shm_protocol", "fluid_server", "crowd_client", "tests", "tools")
LIKE_C = (".cpp", ".hpp", ".h", ".c", ".inc", ".js", ".mjs", ".cs")
GENERATED = ("docs/scene_keys.md", "docs/commands.md", "docs/reports/", "CHANGELOG.md")
COMMENT = {
    "c": re.compile(r'"(?:[^"\\\n]|\\.)*"|//(?P<line>[^\n]*)|/\*(?P<block>.*?)\*/', re.DOTALL),
    "python": re.compile(r'"""(?P<block>.*?)"""|"(?:[^"\\\n]|\\.)*"|\'(?:[^\'\\\n]|\\.)*\'|#(?P<line>[^\n]*)', re.DOTALL),
    "shell": re.compile(r"(?P<block>(?!))|^\s*#(?!!)(?P<line>[^\n]*)", re.MULTILINE),
}
MESSAGE = re.compile(r'"((?:[^"\\\n]|\\.)*)"')

# Found a thousand words, at most. Comments of Box2D, Jolt, JuPedSim, preCICE and MuJoCo have 0 to 0.67, 0 to 0.05 and 0.25 to 1.16.
LIMITS = {
    r"\b(who|whom|whose)\b": 0.5,
    r"\b(somebody|nobody|everybody)\b": 0.2,
    r"\b(of|in|with) (which|whom|those)\b": 1.0,
}
MEDIAN_OF_SENTENCE = 18  # words, of a document


def comments_of(name, text):
    kind = "c" if name.endswith(LIKE_C) else "python" if name.endswith(".py") else "shell"
    found = COMMENT[kind].finditer(text)
    return " ".join(match["line"] or match["block"] or "" for match in found)


def messages_of(text):
    """String literals of several words; those side by side are one."""
    code = re.sub(r'//[^\n]*|#include[^\n]*', "", text)
    joined = re.sub(r'"\s*\n\s*"', "", code)
    return " ".join(found for found in MESSAGE.findall(joined) if found.count(" ") >= 2)


def texts():
    """{kind of text: all of it}"""
    files = [name for name in sorted(TREE.files) if name.endswith((*LIKE_C, ".py", ".sh"))]
    found = {}
    for folder in FOLDERS:
        own = [name for name in files if name.startswith(folder + "/")]
        found[f"comments in {folder}"] = " ".join(comments_of(name, TREE.text(name)) for name in own)
        if folder != "tests":
            found[f"messages in {folder}"] = " ".join(messages_of(TREE.text(name)) for name in own if name.endswith(LIKE_C))
    written = [name for name in TREE.documents() if not name.startswith(GENERATED)]
    found["documents"] = " ".join(TREE.text(name) for name in written)
    return found


def per_thousand(pattern, text):
    words = len(re.findall(r"[A-Za-z']+", text))
    return 1000 * len(re.findall(pattern, text.replace("\n", " "), re.IGNORECASE)) / max(words, 1)


def sentences(text):
    """Lengths of the sentences of paragraphs, in words."""
    prose = "\n".join("" if line.text.startswith("#") else line.text for line in parse(text).prose)
    paragraphs = re.split(r"\n\s*\n|^\s*[*-] |\n\s*[*-] ", prose)
    parts = [part for paragraph in paragraphs for part in re.split(r"(?<=[.!?])\s+(?=[A-Z`\[])", paragraph)]
    return [len(part.split()) for part in parts if part.rstrip().endswith((".", "!", "?", ":"))]


class Language(unittest.TestCase):
    def test_of_comments_messages_and_documents_is_plain(self):
        above = [f"{kind}: {per_thousand(pattern, text):.2f} of {pattern}, allowed {limit}"
                 for kind, text in texts().items() for pattern, limit in LIMITS.items() if per_thousand(pattern, text) > limit]
        self.assertEqual(above, [], "\n" + "\n".join(above))

    def test_of_documents_has_short_sentences(self):
        lengths = {name: sentences(TREE.text(name)) for name in TREE.documents() if not name.startswith(GENERATED)}
        long = [f"{name}: {statistics.median(found):g} words" for name, found in lengths.items()
                if len(found) >= 10 and statistics.median(found) > MEDIAN_OF_SENTENCE]
        self.assertEqual(long, [], "\n" + "\n".join(long))

    def test_is_found_in_all_forms(self):
        self.assertEqual(comments_of("a.cpp", 'f("// no");  // who\n/* of\nwhich */').split(), ["who", "of", "which"])
        self.assertEqual(comments_of("a.py", '"""Whose."""\nx = "# no"  # nobody').split(), ["Whose.", "nobody"])
        self.assertEqual(comments_of("a.sh", "#!/bin/sh\n# who\necho x").split(), ["who"])
        self.assertEqual(messages_of('throw E("no agent who\\n"\n      " may enter");'), "no agent who\\n may enter")
        self.assertEqual(sentences("# A title\nOne two three. Four\nfive.\n\n* Six."), [3, 2, 1])
        self.assertEqual(per_thousand(r"\bwho\b", "who " + "word " * 9), 100)
        words = [len(text.split()) for text in texts().values()]
        self.assertGreater(min(words), 500, "the scan is blind")


if __name__ == "__main__":
    unittest.main()
