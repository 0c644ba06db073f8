"""What a markdown text says, line by line: prose, tables, code spans, commands, JSON, links, headings."""

import dataclasses
import re

SPAN = re.compile(r"(?<!`)(`+)(?!`)(.+?)(?<!`)\1(?!`)", re.DOTALL)
LINK = re.compile(r"!?\[(?:[^\[\]]|\[[^\]]*\])*\]\(\s*<?([^)\s>]+)>?[^)]*\)")
REFERENCE = re.compile(r"^\s*\[[^\]]+\]:\s+(\S+)", re.MULTILINE)
FENCE = re.compile(r"^\s*(```+|~~~+)\s*(\w*)")
HEADING = re.compile(r"^#{1,6}\s+(.*?)\s*#*$")


@dataclasses.dataclass
class Found:
    line: int  # from 1
    text: str


@dataclasses.dataclass
class Document:
    spans: list  # of Found: inline code
    commands: list  # of Found: lines of shell, in fences, sessions ("$ ...") and indented code
    listings: list  # of Found: whole JSON fences
    links: list  # of Found: targets
    anchors: set  # of headings, as GitHub makes them
    prose: list  # of Found: lines outside fences and tables


def anchor_of(heading):
    """The anchor of a heading: its text in lower case, without punctuation, with dashes for blanks."""
    text = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", heading).replace("`", "")
    return re.sub(r"[^\w\- ]", "", text.lower()).replace(" ", "-")


def parse(text):
    document = Document([], [], [], [], set(), [])
    fence = language = None
    listing, paragraph = [], []
    for number, line in enumerate([*text.split("\n"), ""], 1):
        mark = FENCE.match(line)
        if fence is None and (mark or not line.strip() or line.lstrip().startswith("|")):
            _parse_paragraph(document, paragraph)
            paragraph = []
        if fence is None and mark:
            fence, language, listing = mark[1], mark[2], []
        elif fence is not None and mark and mark[1].startswith(fence) and not mark[2]:
            if language == "json":
                document.listings.append(Found(number - len(listing), "\n".join(listing)))
            fence = None
        elif fence is not None:
            listing.append(line)
            if language in ("sh", "bash", "shell"):
                document.commands.append(Found(number, line))
            elif line.startswith("$ "):
                document.commands.append(Found(number, line[2:]))
        elif re.match(r"    (tools|build)/", line):
            document.commands.append(Found(number, line))
        elif line.lstrip().startswith("|"):
            _parse_paragraph(document, [Found(number, line)])
        elif line.strip():
            document.prose.append(Found(number, line))
            _note_heading(document, line)
            paragraph.append(Found(number, line))
    return document


def _note_heading(document, line):
    heading = HEADING.match(line)
    if not heading:
        return
    anchor = anchor_of(heading[1])
    count = 1
    while anchor in document.anchors:
        anchor, count = f"{anchor_of(heading[1])}-{count}", count + 1
    document.anchors.add(anchor)


def _parse_paragraph(document, lines):
    """Code and links, which may go on from one line to the next."""
    text = "\n".join(line.text for line in lines)

    def place(offset):
        return lines[text.count("\n", 0, offset)].line

    document.spans += [Found(place(found.start()), " ".join(found[2].split())) for found in SPAN.finditer(text)]
    without_code = SPAN.sub(lambda found: "x" + "\n" * found[0].count("\n"), text)
    for form in (LINK, REFERENCE):
        for found in form.finditer(without_code):
            line = lines[without_code.count("\n", 0, found.start())].line
            document.links.append(Found(line, found[1]))
