"""Results of the report as text."""

from wade.suites.paper.bands import in_words

# What each set of scenes stands for.
SET_UPS = {"observed": "as observed", "paper": "as run", "river": "as described", "manning": "on a slope"}


def shown(value, digits=0):
    return "-" if value in ("", None) else f"{float(value):.{digits}f}"


def time_of(result):
    return "-" if result is None or result.time is None else in_words(result.time)


def arrived_of(result):
    return "-" if result is None else in_words(result.arrived)


def outcome(result):
    """"93.0 s", with how many arrive if not all do; "nobody"."""
    if result is None:
        return "-"
    if result.arrived[0] == 0:
        return "nobody"
    return time_of(result) + (f"; {in_words(result.arrived)} arrive" if result.arrived[0] < result.agents else "")


def crossing(result):
    """Arrivals of those who cross the river where two groups walk, of 50."""
    return "-" if result is None else in_words(result.arrived_of("walkers"))


def met_of(result):
    """Depth and speed that the agents met, "0.98 m, 1.49 m/s"."""
    return "-" if result is None or result.depth is None else f"{result.depth:.2f} m, {result.speed:.2f} m/s"


def error_percent(result, paper_time):
    """Of the mean time, to the paper's, "-18"."""
    if result is None or result.time is None or paper_time in ("", None):
        return "-"
    return f"{round(100 * (result.time[0] / float(paper_time) - 1)):+d}"
