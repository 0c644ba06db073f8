"""Numbers and tables of the report as text."""

from bands import in_words

# What each set of scenes stands for.
SET_UPS = {"observed": "as observed", "paper": "as run", "river": "as described", "manning": "on a slope"}


def markdown_table(head, lines):
    rows = [head, *lines]
    widths = [max(len(row[i]) for row in rows) for i in range(len(head))]
    text = ["| " + " | ".join(cell.ljust(width) for cell, width in zip(row, widths)) + " |" for row in rows]
    text.insert(1, "|" + "|".join("-" * (width + 2) for width in widths) + "|")
    return "\n".join(text) + "\n"


def shown(value, digits=0):
    return "-" if value in ("", None) else f"{float(value):.{digits}f}"


def time_of(result):
    return "-" if result is None or result.time is None else in_words(result.time)


def arrived_of(result):
    return "-" if result is None else in_words(result.arrived) + result.mark


def met_of(result):
    """Depth and speed that the agents met, "0.98 m, 1.49 m/s"."""
    return "-" if result is None or result.depth is None else f"{result.depth:.2f} m, {result.speed:.2f} m/s"


def error_percent(result, paper_time):
    """Of the mean time, to the paper's, "-18"."""
    if result is None or result.time is None or paper_time in ("", None):
        return "-"
    return f"{round(100 * (result.time[0] / float(paper_time) - 1)):+d}"
