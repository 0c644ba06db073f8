"""What a document names that does not exist. Each check gives (line, kind, what is wrong)."""

import json
import os
import re
import shlex

from known_names import CODE, OUTPUTS, parts_of
from document import parse

WIDEST_PROSE = 240
FOREIGN = {"dev", "proc", "usr", "etc", "tmp", "var", "home", "opt"}  # first folders of paths outside the tree
MADE_UP = "my_"  # files that a reader is told to write have names that begin so
INTERPRETERS = {"python3", "/usr/bin/python3", "node", "nice", "sudo", "time"}


def is_made_up(path):
    return any(part.startswith(MADE_UP) for part in path.split("/"))


class Checker:
    def __init__(self, tree, commands, schema):
        self.tree, self.commands, self.schema = tree, commands, schema
        self.seen = {}  # kind: how many names were looked at

    def problems(self, name, text=None):
        """Of the document `name`, or of `text` as if it stood there."""
        document = parse(self.tree.text(name) if text is None else text)
        found = [*self.width(document), *self.links(name, document)]
        if name != "CHANGELOG.md":  # it also names what is gone
            for span in document.spans:
                found += self.span(name, span)
            for line in document.commands:
                found += self.command_line(name, line)
            for listing in document.listings:
                found += self.listing(listing)
        return found

    def note(self, kind):
        self.seen[kind] = self.seen.get(kind, 0) + 1

    def width(self, document):
        for line in document.prose:
            if len(line.text) > WIDEST_PROSE:
                yield line.line, "width", f"{len(line.text)} characters, more than {WIDEST_PROSE}"

    def links(self, name, document):
        for link in document.links:
            if re.match(r"[a-z]+:", link.text):
                continue
            path, _, anchor = link.text.partition("#")
            target = os.path.normpath(os.path.join(os.path.dirname(name), path)) if path else name
            self.note("link")
            if target != name and not self.tree.has(target):
                yield link.line, "link", f"no file {target}"
            elif anchor and target.endswith(".md"):
                self.note("anchor")
                anchors = document.anchors if target == name else parse(self.tree.text(target)).anchors
                if anchor not in anchors:
                    yield link.line, "anchor", f"no heading #{anchor} in {target}"

    # Code spans and commands

    def span(self, name, span):
        text = span.text
        if text.startswith("--"):
            return [*self.options(span.line, text.split(), None), *self.command_line(name, span)]
        if re.fullmatch(r'"[\w$]+":.*', text):
            return self.listing(span, "{" + text + "}")
        if re.fullmatch(r"\$?[a-z]\w*(\[\])?(\.\w+(\[\])?)+", text) and not self.looks_like_file(text):
            return self.dotted_key(span.line, text)
        return self.command_line(name, span)

    def command_line(self, name, line):
        found = []
        try:
            words = shlex.split(line.text, comments=True)
        except ValueError:
            words = line.text.split()
        command = []
        for word in [*words, ";"]:
            if word in ("&", "&&", "|", ";"):
                found += self.command(name, line.line, command)
                command = []
            else:
                command.append(word)
        return found

    def command(self, name, line, words):
        found = []
        foreign = len(words) > 1 and re.fullmatch(r"[a-z+]+", words[0]) and words[0] not in self.tree.programs
        for word in words:
            if re.match(r"/[a-z$]", word):
                found += self.pointer(line, word)
            elif "/" in word or not foreign:  # what a compiler writes and reads is its own
                found += self.path(name, line, word)
        while words and (words[0] in INTERPRETERS or re.fullmatch(r"[A-Z_]+=.*", words[0])):
            words = words[1:]
        if words:
            found += self.subcommand(line, words)
            if any(word.startswith("--") for word in words):
                found += self.options(line, words[1:], self.known_options(words))
        return found

    def subcommand(self, line, words):
        if words[0] not in ("tools/wade", "wade") or len(words) < 2 or not re.fullmatch(r"[a-z][\w-]*", words[1]):
            return
        self.note("subcommand")
        if words[1] not in self.commands.subcommands:
            yield line, "subcommand", f"tools/wade has no {words[1]}"

    def known_options(self, words):
        """Those of the command that words begin with: empty if it is none of ours, None if it is not built."""
        command = "tools/wade" if words[0] == "wade" else words[0]
        program = command.rsplit("/", 1)[-1]
        if program in self.tree.programs and (command == program or command.startswith("build/")):
            return self.commands.options_of_program(program)
        if not command.startswith("tools/") or not os.access(self.tree.root / command, os.X_OK):
            return set()
        start = [command]
        if command == "tools/wade" and len(words) > 1 and words[1] in self.commands.subcommands:
            start.append(words[1])
        options = self.commands.options_of_command(*start)
        if start in (["tools/run.sh"], ["tools/wade", "run"]):
            passed_on = self.commands.options_passed_on()
            return None if passed_on is None else options | passed_on
        return options

    def options(self, line, words, known):
        for word in words:
            if word == "--":
                return
            option = re.match(r"--[a-z][\w-]*", word)
            if not option or known == set():
                continue
            self.note("option")
            if known is None and not re.search(re.escape(option[0]) + r"(?![\w-])", self.tree.sources):
                yield line, "option", f"nothing has an option {option[0]}"
            elif known is not None and option[0] not in known:
                yield line, "option", f"{option[0]} is not in the help of this command"

    # Files

    def looks_like_file(self, text):
        return os.path.splitext(text)[1] in CODE | OUTPUTS

    def path(self, name, line, word):
        for token in self.expand(word.split("=")[-1].strip("'\"(),;:").rstrip(".")):
            if not re.fullmatch(r"[\w.*/+-]+", token) or "..." in token or is_made_up(token) or token.startswith("/"):
                continue
            first, ending = token.split("/")[0], os.path.splitext(token)[1]
            if token.startswith("build/release/"):
                yield from self.program(line, token)
            elif first == "build":
                continue  # written by a build of another preset
            elif first in self.tree.top and "/" in token:
                self.note("path")
                if not self.tree.has(token):
                    yield line, "path", f"no file or folder {token}"
            elif first in self.tree.scene_folders and re.fullmatch(r"\w+/\w+", token):
                self.note("scene")
                if not self.tree.has(f"configs/{token}.json"):
                    yield line, "scene", f"no scene {token}"
            elif ending in CODE and token != ending:
                self.note("file")
                beside = os.path.join(os.path.dirname(name), token)
                if not (self.tree.has(beside) or self.tree.has_end(token) or first[:1].isupper()):
                    yield line, "file", f"no file {token}"
            elif ending in OUTPUTS and token != ending and "/" not in token and "*" not in token:
                self.note("output")
                if token not in self.tree.names and token not in self.tree.sources:
                    yield line, "output", f"no file {token}, and no code that writes it"

    @staticmethod
    def expand(token):
        """a/{b,c} as a/b and a/c."""
        braces = re.fullmatch(r"(.*)\{([^{}]*,[^{}]*)\}(.*)", token)
        return [braces[1] + part + braces[3] for part in braces[2].split(",")] if braces else [token]

    def program(self, line, token):
        name = token.rsplit("/", 1)[-1]
        self.note("program")
        is_library = name.startswith("lib")
        if name and not is_library and name not in self.tree.programs and token.count("/") == 2:
            yield line, "program", f"no program {name}"

    # Keys of scenes

    def pointer(self, line, word):
        key, equals, value = word.partition("=")
        key = key.rstrip(".,;:")
        if key.split("/")[1] in FOREIGN or not re.fullmatch(r"[/\w$\[\]]+", key):
            return
        self.note("key")
        node = self.schema.node(parts_of(key))
        if node is None:
            yield line, "key", f"no key {key} in a scene"
        elif equals:
            yield from self.value(line, key, node, value.strip('"'))

    def dotted_key(self, line, text):
        parts = parts_of(text)
        if parts[0] not in self.schema.first_keys:
            return
        self.note("key")
        if self.schema.node(parts) is None:
            yield line, "key", f"no key {text} in a scene"

    def value(self, line, key, node, value):
        choices = self.schema.choices(node)
        if choices and isinstance(value, str) and re.fullmatch(r"[a-z]\w*", value) and value not in choices:
            yield line, "key", f"{key} cannot be {value}"

    def listing(self, listing, text=None):
        """A scene, a part of one, or a list of crowds."""
        text = re.sub(r'(?m)(^|\s)//[^"\n]*$', "", listing.text if text is None else text)
        try:
            value = json.loads(text)
        except json.JSONDecodeError as error:
            return [] if text.startswith('{"') else [(listing.line, "key", f"no JSON: {error}")]
        if isinstance(value, list):
            return [found for crowd in value for found in self.crowd_of_list(listing.line, crowd)]
        if not set(value) & self.schema.first_keys:
            return []
        return list(self.keys(listing.line, [], value))

    def crowd_of_list(self, line, crowd):
        for key, value in crowd.get("set", {}).items():
            yield from self.pointer(line, f"{key}={value}" if isinstance(value, str) else key)

    def keys(self, line, parts, value):
        if isinstance(value, dict):
            for key, inner in value.items():
                yield from self.keys(line, [*parts, key], inner)
        elif isinstance(value, list):
            for inner in value:
                yield from self.keys(line, [*parts, "[]"], inner)
        self.note("key")
        node = self.schema.node(parts)
        if node is None:
            yield line, "key", f"no key {'/' + '/'.join(parts)} in a scene"
        else:
            yield from self.value(line, "/" + "/".join(parts), node, value)

