"""The bands within which a set of scenes is said to agree with the paper, fixed before any result was known, and results as text.

Each is judged for each set. What the paper gives: Table 1, and the text for S6, two groups, obstacle, switch of tau.
"""

import math
import statistics
from dataclasses import dataclass

# Scenario: (lowest, highest mean time of the last arrival, s; lowest, highest mean number that arrive).
TIMES = {
    "S1": (45, 47, 50, 50),
    "S2": (45, 47, 50, 50),
    "S3": (45, 47, 50, 50),
    "S4": (0.9 * 54, 1.1 * 54, 50, 50),
    "S5": (0.75 * 93, 1.25 * 93, 50, 50),
    "S6": (0.5 * 160, 1.5 * 160, 30, 50),
    "S7": (0.75 * 97, 1.25 * 97, 50, 50),
    "S10": (0.5 * 140, 1.5 * 140, 50, 50),
}
# The paper has one run a scenario. Its "all" and "none" are taken as means that round to that: one agent in two runs.
SLACK = 0.5
NOBODY = ("S8", "S9", "S11", "S12")
SWITCH_TIME_S = (60, 90)
LEE_LENGTH_M, LEE_AT_S = 20, 15
PARTICLES_SHARE = 0.1  # of the coarse result


@dataclass
class Judgement:
    """A band for one set: whether it holds, None where it could not be judged, and what was found."""

    name: str
    asked: str
    found: str = ""
    holds: bool | None = None


def in_words(interval, digits=1):
    """Mean and interval, "49.3 (48.8 to 49.6)"."""
    mean, low, high = interval
    if low is None or round(low, digits) == round(high, digits):
        return f"{mean:.{digits}f}"
    return f"{mean:.{digits}f} ({low:.{digits}f} to {high:.{digits}f})"


def outcome_in_words(result):
    if result.arrived[0] == 0:
        return "nobody"
    return f"{in_words(result.time)} s, {in_words(result.arrived)} arrive"


def asked_of(scenario):
    if scenario in NOBODY:
        return "nobody arrives"
    low, high, least, most = TIMES[scenario]
    who = f"all {most}" if least == most else f"{least} to {most}"
    return f"{low:.1f} to {high:.1f} s, {who} arrive"


def judge_scenario(scenario, result):
    """The band of one scenario of Table 1; result None: it was not run."""
    judgement = Judgement(scenario, asked_of(scenario))
    if result is None:
        return judgement
    judgement.found = outcome_in_words(result)
    arrived = result.arrived[0]
    if scenario in NOBODY:
        judgement.holds = arrived <= SLACK
    else:
        low, high, least, most = TIMES[scenario]
        judgement.holds = result.time is not None and low <= result.time[0] <= high and least - SLACK <= arrived <= most
    return judgement


def count_in_words(judgements):
    """Returns how many of the judged bands hold, "5 of 7"; "-" if none was judged."""
    judged = [judgement.holds for judgement in judgements if judgement.holds is not None]
    return f"{sum(judged)} of {len(judged)}" if judged else "-"


def time_error(paper, result_of):
    """Mean factor between our times and the paper's in the scenarios that water slows down; None if one has no time.

    paper: its table by scenario; result_of: Result or None of a scenario.
    """
    errors = []
    for name in ("S4", "S5", "S6", "S7", "S10"):
        result = result_of(name)
        if result is None or result.time is None:
            return None
        errors.append(abs(math.log(result.time[0] / float(paper[name]["time_s"]))))
    return math.exp(statistics.fmean(errors))


def judge_two_groups(result):
    judgement = Judgement("two groups", "nobody of the upstream group arrives (8 in all in the paper)")
    if result is not None:
        crossing, upstream = result.arrived_of("walkers"), result.arrived_of("upstream")
        judgement.found = f"{in_words(crossing)} of 50 cross, {in_words(upstream)} of 50 go upstream"
        judgement.holds = upstream[0] <= SLACK
    return judgement


def judge_switch(result):
    low, high = SWITCH_TIME_S
    judgement = Judgement("tau switch", f"all arrive, the last after {low} to {high} s")
    if result is not None:
        judgement.found = outcome_in_words(result)
        all_arrive = result.arrived[0] >= result.agents - SLACK
        judgement.holds = all_arrive and low <= result.time[0] <= high
    return judgement


def judge_obstacle(with_it, without):
    judgement = Judgement("obstacle", "more arrive than without it, the intervals apart (26 against 8 in the paper)")
    if with_it is not None and without is not None:
        arrived = [in_words(result.arrived) for result in (with_it, without)]
        judgement.found = f"{' against '.join(arrived)} of {with_it.agents}"
        ends = with_it.arrived[1], without.arrived[2]
        judgement.holds = None if None in ends else ends[0] > ends[1]  # None: no interval can be given
    return judgement


def judge_lee(lee):
    """lee: (length at 15 s, m; greatest length, m; when, s); None where the water knows no obstacle."""
    judgement = Judgement("lee", f"at least {LEE_LENGTH_M} m long at {LEE_AT_S} s")
    if lee is not None:
        length, longest, time = lee
        judgement.found = f"{length:.0f} m; {longest:.0f} m at {time} s"
        judgement.holds = length >= LEE_LENGTH_M
    return judgement


def crossing_of(name, result):
    """Returns the arrivals of the group that crosses the river: all agents, where there is no other group."""
    return result.arrived_of("walkers") if name == "two groups" else result.arrived


def judge_particles(pairs):
    """pairs: {scenario: (coarse, fine)}."""
    judgement = Judgement("ten times the particles", "each number of arrivals within 10 % of the coarse result")
    known = {name: pair for name, pair in pairs.items() if None not in pair}
    if known:
        arrived = {name: [crossing_of(name, result) for result in pair] for name, pair in known.items()}
        judgement.found = "; ".join(f"{name} {in_words(arrived[name][1])} against {in_words(arrived[name][0])}"
                                    for name, (coarse, fine) in known.items())
        judgement.holds = all(abs(fine[0] - coarse[0]) <= max(PARTICLES_SHARE * coarse[0], SLACK)
                              for coarse, fine in arrived.values())
    return judgement


# What each set of scenes stands for.
SET_UPS = {"observed": "as observed", "paper": "as run", "river": "as described", "manning": "on a slope"}


def shown(value, digits=0):
    return "-" if value in ("", None) else f"{float(value):.{digits}f}"


def time_of(result):
    return "-" if result is None or result.time is None else in_words(result.time)


def arrived_of(result):
    return "-" if result is None else in_words(result.arrived)


def outcome(result):
    """Returns "93.0 s", with the number of arrivals if not all arrive; "nobody" without arrivals."""
    if result is None:
        return "-"
    if result.arrived[0] == 0:
        return "nobody"
    return time_of(result) + (f"; {in_words(result.arrived)} arrive" if result.arrived[0] < result.agents else "")


def crossing(result):
    """Returns the arrivals of the group that crosses the river, of 50, where two groups walk."""
    return "-" if result is None else in_words(result.arrived_of("walkers"))


def met_of(result):
    """Depth and speed that the agents met, "0.98 m, 1.49 m/s"."""
    return "-" if result is None or result.depth is None else f"{result.depth:.2f} m, {result.speed:.2f} m/s"


def error_percent(result, paper_time):
    """Of the mean time, to the paper's, "-18"."""
    if result is None or result.time is None or paper_time in ("", None):
        return "-"
    return f"{round(100 * (result.time[0] / float(paper_time) - 1)):+d}"
