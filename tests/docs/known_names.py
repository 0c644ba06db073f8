"""The names that there are: files of the tree, programs, commands and their options, keys of scenes."""

import functools
import json
import os
import re
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
CODE = {".cpp", ".hpp", ".h", ".c", ".py", ".sh", ".bash", ".mjs", ".pml", ".cmake", ".md"}
OUTPUTS = {".csv", ".json", ".jsonl", ".sqlite", ".bin"}


class Tree:
    """The files of the repository, those that are not committed yet among them."""

    def __init__(self, root=ROOT):
        self.root = root
        listed = subprocess.run(
            ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
            cwd=root, capture_output=True, text=True, check=True).stdout.split("\0")
        self.files = {name for name in listed if name and (root / name).is_file()}
        self.folders = {str(parent) for name in self.files for parent in Path(name).parents} - {"."}
        self.top = {name.split("/")[0] for name in self.files}
        self.scene_folders = {name.split("/")[1] for name in self.files if re.match(r"configs/\w+/\w+\.json$", name)}
        self.names = {name.rsplit("/", 1)[-1] for name in self.files}

    def has(self, path):
        """Whether a path, perhaps with * in it, leads to a file or a folder."""
        path = os.path.normpath(path)
        if "*" in path:
            form = re.compile(re.escape(path).replace(r"\*\*/", "(.*/)?").replace(r"\*", "[^/]*"))
            return any(form.fullmatch(name) for name in self.files | self.folders)
        return path in self.files or path in self.folders

    def has_end(self, path):
        """Whether some file's path ends with this one."""
        return path in self.files or any(name.endswith("/" + path) for name in self.files)

    def documents(self):
        return sorted(name for name in self.files if name.endswith(".md"))

    def text(self, name):
        return (self.root / name).read_text(encoding="utf-8", errors="replace")

    @functools.cached_property
    def sources(self):
        """All code in one string."""
        endings = CODE - {".md"} | {".txt"}
        own = "tests/docs/"
        code = (name for name in sorted(self.files) if Path(name).suffix in endings or "." not in Path(name).name)
        return "\n".join(self.text(name) for name in code if not name.startswith(own))

    @functools.cached_property
    def words(self):
        return set(re.findall(r"\w+", self.sources))

    @functools.cached_property
    def programs(self):
        """Names of the programs that CMake builds."""
        lists = "\n".join(self.text(name) for name in self.files if name.endswith("CMakeLists.txt"))
        names = set(re.findall(r"(?:add_executable|wade_program)\((\w+)", lists))
        for variable, values, body in re.findall(r"foreach\((\w+)\s+([^)]*)\)(.*?)endforeach", lists, re.DOTALL):
            for made in re.findall(r"(?:add_executable|wade_program)\(([\w${}]+)", body):
                names |= {made.replace("${" + variable + "}", value) for value in values.split()}
        return names

    def rooms(self, folders):
        """{target of a room: targets that it builds on}, as CMake has them."""
        lists = (name for name in self.files if name.split("/")[0] in folders and name.endswith("CMakeLists.txt"))
        built = {}
        for name in lists:
            for room, words in re.findall(r"wade_room\((\w+)([^)]*)\)", self.text(name)):
                uses = re.search(r"USES([\w\s]*)", words)
                built[room] = set(uses[1].split()) if uses else set()
        return built


class Commands:
    """What commands of the tree and built programs say in their --help."""

    PASSED_ON = ("fluid_server", "crowd_client", "shm_record", "shm_replay")  # by tools/run.sh

    def __init__(self, tree, build):
        self.tree = tree
        self.build = Path(build)
        self.not_built = set()  # programs that were asked for

    # All subcommands in one process, as most of the time goes into what they import.
    HELPS = """if True:
        import contextlib, io, json
        from wade import cli, commands
        said = {}
        for command in commands.all_commands():
            if command.module:
                with contextlib.redirect_stdout(io.StringIO()) as out, contextlib.suppress(SystemExit):
                    cli.main([command.name, "--help"])
                said |= dict.fromkeys((command.name, *command.old_names), out.getvalue())
        print(json.dumps(said))
    """

    @functools.cached_property
    def helps(self):
        """What each subcommand of tools/wade says, by name and older name."""
        done = subprocess.run(["/usr/bin/python3", "-B", "-c", self.HELPS], cwd=self.tree.root / "tools/python",
                              stdout=subprocess.PIPE, text=True, timeout=60, check=True)
        return json.loads(done.stdout)

    @functools.lru_cache(maxsize=None)
    def help_of(self, *words):
        program = self.tree.root / words[0]
        if program.resolve() == self.tree.root / "tools/wade":
            name = words[1] if len(words) > 1 else program.stem.replace("_", "-")
            if name in self.helps:
                return self.helps[name]
        done = subprocess.run([*words, "--help"], cwd=self.tree.root, capture_output=True, text=True, timeout=60,
                              stdin=subprocess.DEVNULL)
        return done.stdout + done.stderr

    def options_of_command(self, *words):
        return set(re.findall(r"(?<![\w-])--[a-z][\w-]*", self.help_of(*words))) | {"--help", "--version"}

    @functools.lru_cache(maxsize=None)
    def options_of_program(self, name):
        """None if it is not built."""
        for path in sorted(self.build.rglob(name)):
            if path.is_file() and os.access(path, os.X_OK):
                return self.options_of_command(str(path))
        self.not_built.add(name)
        return None

    def options_passed_on(self):
        options = [self.options_of_program(name) for name in self.PASSED_ON]
        return None if None in options else set().union(*options)

    @functools.cached_property
    def subcommands(self):
        """Of tools/wade: the first words of the indented lines of its help."""
        return set(re.findall(r"^ {2,}([a-z][a-z-]*)\b", self.help_of("tools/wade"), re.MULTILINE))


class Schema:
    """The keys of scenes."""

    def __init__(self, tree):
        self.whole = json.loads(tree.text("configs/scene.schema.json"))

    def _variants(self, node):
        if "$ref" in node:
            target = self.whole
            for part in node["$ref"].lstrip("#/").split("/"):
                target = target[part]
            return self._variants(target)
        found = [node]
        for word in ("oneOf", "anyOf", "allOf"):
            for choice in node.get(word, []):
                found += self._variants(choice)
        return found

    def _below(self, node, part):
        for variant in self._variants(node):
            if part in variant.get("properties", {}):
                return variant["properties"][part]
            if part == "[]" or part.isdigit():
                if "items" in variant:
                    return variant["items"]
        return None

    def node(self, parts):
        """What the schema says of the key at a path, or None if there is no such key."""
        node = self.whole
        for part in parts:
            node = self._below(node, part)
            if node is None:
                return None
        return node

    def choices(self, node):
        """The words that a value may be; empty if it is no choice."""
        return {word for variant in self._variants(node) for word in variant.get("enum", []) if isinstance(word, str)}

    @property
    def first_keys(self):
        return set(self.whole["properties"])


def parts_of(key):
    """['crowd', 'groups', '[]', 'tau'] of /crowd/groups[]/tau, /crowd/groups/0/tau or crowd.groups[].tau."""
    split = key.strip("/").replace(".", "/").replace("[]", "/[]").split("/")
    return [part for part in split if part]
