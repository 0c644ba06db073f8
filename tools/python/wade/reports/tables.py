"""Numbers as text, and tables as Markdown, as plain text and as CSV."""

import csv
import io
import re
import textwrap

from tabulate import tabulate

from wade import plain_file
from wade.reports.files import write_whole


def number(value, digits=3, none="-"):
    """A number with so many significant digits; `none` for None."""
    return none if value is None else f"{value:.{digits}g}"


def count(value):
    """A count with separators, or four digits; "-" for None."""
    return "-" if value is None else f"{value:,.0f}" if abs(value) >= 1e4 else f"{value:.4g}"


def count_of(number, noun="run"):
    """"1 run", "3 runs"."""
    return f"{number} {noun}{'' if number == 1 else 's'}"


def listed(parts):
    """"a, b and c"; "none" of nothing."""
    parts = list(parts)
    return f"{', '.join(parts[:-1])} and {parts[-1]}" if len(parts) > 1 else parts[0] if parts else "none"


def markdown(head, rows):
    """A table, its cells as they are; a bar or a line's end within a cell does not break it."""
    cells = [[str(cell).replace("|", "\\|").replace("\n", " ") for cell in row] for row in rows]
    text = tabulate(cells, head, tablefmt="github", disable_numparse=True, stralign=None, numalign=None)
    first, _, *rest = text.split("\n")
    return "\n".join([first, "|" + "---|" * len(head), *rest]) + "\n"


def plain(head, rows):
    """A table for the terminal, its first column to the left, the others to the right."""
    align = ("left", *["right"] * (len(head) - 1))
    return tabulate([[str(cell) for cell in row] for row in rows], head, "plain", disable_numparse=True, colalign=align)


def section(title, *parts, level=2):
    """Returns a section of a report with all parts that are not empty; "" if all are."""
    parts = [part.rstrip("\n") for part in parts if part]
    return "\n\n".join([f"{'#' * level} {title}", *parts]) + "\n" if parts else ""


def wrapped(text, width=160):
    """Wraps the prose of Markdown to at most `width` columns; leaves tables, listings and headings as they are."""
    lines, fenced = [], False
    for line in text.split("\n"):
        fenced ^= line.lstrip().startswith("```")
        if fenced or len(line) <= width or re.match(r"\s*(```|[|#>!]|\[[^\]]+\]:|    )", line):
            lines.append(line)
            continue
        mark = re.match(r"\s*(?:[*+-]|\d+[.)])\s+|\s*", line)[0]
        parts = textwrap.wrap(line, width, subsequent_indent=" " * len(mark), break_long_words=False,
                              break_on_hyphens=False)
        for place, part in enumerate(parts):
            if place > 0 and re.match(r"\s*([*+-]|\d+[.)]|[#>|=]+)(\s|$)", part):  # would begin a list or a heading
                lines[-1] += " " + part.lstrip()
            else:
                lines.append(part)
    return "\n".join(lines)


def document(*sections):
    """Returns a report with all sections that are not empty."""
    return wrapped("\n".join(part.rstrip("\n") + "\n" for part in sections if part))


def write_csv(file, columns, rows):
    """Rows as lists or dictionaries; floats with six digits, None as nothing. Whole or not at all."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    for row in rows:
        cells = [row.get(column) for column in columns] if isinstance(row, dict) else row
        writer.writerow([f"{cell:.6g}" if isinstance(cell, float) else "" if cell is None else cell for cell in cells])
    write_whole(file, text.getvalue())


read_csv = plain_file.read_table
