"""Titles and legends of pictures: what a run was and how it ended, in words that fit."""

import re

from wade.pictures.top_view import INK, speeds_of
from wade.terminal import harmless

GREY = "#6b6b72"
NAMED_TAUS = 4  # more of them are told by their range
NAME_LENGTH = 40  # of a scene, in characters
LEGEND_LENGTH = 96  # of all names of groups together
SHARE = 0.97  # of the picture's width that a line may take


def plain(name, length=NAME_LENGTH):
    """A name as text that is drawn as it stands: no formula, no control characters, its middle left out if it is long."""
    name = harmless(name)
    if len(name) > length:
        name = f"{name[: (length - 1) // 2]}\u2026{name[-(length // 2):]}"
    return name.replace("$", r"\$")


def short_name(name):
    match = re.search(r"(?:^|[_-])s0*(\d+)$", name)
    return f"S{match.group(1)}" if match else plain(name)


def range_of(value):
    """Returns (lowest, highest) of a group's value: one value for all agents, or a range that each agent draws from."""
    return (value["min"], value["max"]) if isinstance(value, dict) else (value, value)


def interval(low, high):
    return f"{low:g}" if low == high else f"{low:g}\u2013{high:g}"


def tau_text(scene):
    """Returns the values of tau at the start, "by body" for groups without one, then the values set by events."""
    groups = scene["crowd"]["groups"]
    ranges = sorted({range_of(group["tau"]) for group in groups if "tau" in group})
    if len(ranges) > NAMED_TAUS:
        words = [f"{interval(ranges[0][0], max(high for _, high in ranges))} ({len(ranges)} values)"]
    else:
        words = [interval(*ends) for ends in ranges]
    text = "/".join(words + ["by body"] * any("tau" not in group for group in groups))
    switches = [f"{event['tau']:g}" for event in scene.get("events", [])]
    if len(switches) > NAMED_TAUS:
        switches = [f"\u2026 ({len(switches)} switches)", switches[-1]]
    return "\u2192".join([text, *switches])


def title_of(scene, agents, ends, arrivals, cut_off=""):
    """cut_off: "so far" if the run was, and its results are those of a moment before, "unknown" if it left none."""
    parts = []
    if agents:
        parts.append(f"\u03c4 {tau_text(scene)}")
    if scene["channel"]["flow"] != "closed":
        low, high = speeds_of(scene)
        parts.append(f"$v_F$ {low:g} m/s" if low == high else f"$v_F$ {low:g} to {high:g} m/s")
    title = f"{short_name(scene['name'])}: " + ", ".join(parts) if parts else short_name(scene["name"])
    if not agents:
        return title
    if cut_off == "unknown":
        return f"{title} \u2013 cut off, no outcome"
    result = [f"{len(ends['arrived'])} of {len(agents)} arrived"]
    if arrivals:
        result.append(f"last after {max(arrivals):.0f} s")
    if ends.get("sheltered"):
        result.append(f"{len(ends['sheltered'])} sheltered")
    inside = len(agents) - sum(map(len, ends.values()))
    if scene.get("site") and inside:
        result.append(f"{inside} indoors")
    if ends["dead"]:
        result.append(f"{len(ends['dead'])} dead")
    if cut_off:
        result.append("then cut off")
    return f"{title} \u2013 " + ", ".join(result)


def subtitle_of(outcome, time, water, whole_run):
    parts = [plain(outcome["scene"]), f"seed {outcome['seed']}"]
    if outcome["fluid"]["model"]:
        parts.append(f"water: {plain(outcome['fluid']['model'])}")
    parts.append(f"contact rule {outcome['contact_rule']}")
    parts.append(f"0 to {time:.1f} s" if whole_run else f"t = {time:.1f} s")
    if water:
        parts.append(f"water at {water[0]:.1f} s")
    if outcome["status"] not in ("completed", "running"):
        parts.append(outcome["status"].replace("_", " "))
    return "  \u00b7  ".join(parts)


def group_names(groups, rows=1):
    """Returns the names of groups, shortened so that all fit into so many lines of a legend."""
    length = max(6, LEGEND_LENGTH * max(1, rows) // max(1, len(groups)))
    # A label that begins with "_" would be left out.
    return [re.sub("^_", " _", plain(group["name"], length)) for group in groups]


def shrunk(drawn, figure):
    """Makes a text as small as it must be to fit into the picture; returns it."""
    allowed = SHARE * figure.bbox.width
    wide = drawn.get_window_extent(figure.canvas.get_renderer()).width
    if wide > allowed:
        drawn.set_fontsize(drawn.get_fontsize() * allowed / wide)
    return drawn


def draw_title(figure, title, *subtitles):
    """The title and lines of small text below it, at the top of a picture."""
    high = figure.get_figheight()
    for text, inches, size, colour in [(title, 0.25, 14, INK),
                                       *((text, 0.53 + 0.21 * i, 8, GREY) for i, text in enumerate(subtitles))]:
        shrunk(figure.text(0.5, 1 - inches / high, text, ha="center", va="center", fontsize=size, color=colour), figure)


def draw_legend(figure, handles, inches, rows=1):
    """A legend in one line or more, so many inches above the lower edge; smaller where it would not fit."""
    if not handles:
        return
    allowed, size = SHARE * figure.bbox.width, 8.5
    for _ in range(3):
        legend = figure.legend(handles=handles, loc="lower center", ncol=-(-len(handles) // rows), frameon=False,
                               fontsize=size, handlelength=2 if rows == 1 else 3, handletextpad=0.5, columnspacing=1.6,
                               bbox_to_anchor=(0.5, inches / figure.get_figheight()))
        wide = legend.get_window_extent(figure.canvas.get_renderer()).width
        if wide <= allowed:
            return
        legend.remove()
        size *= 0.98 * allowed / wide
    figure.add_artist(legend)
