"""Table and report of `tools/wade frame-rates`: means, intervals, and whether the rates agree."""

from wade.reports.intervals import bootstrap_mean
from wade.reports.tables import document, markdown, section

RULES = ("per_frame", "continuous", "no water")
SAMPLED = "continuous, sampled"
MEASURES = ("arrived", "time_s", "agent_time_s")
COLUMNS = ("scene", "model", "rule", "frame_rate_hz", "status", "seeds", "agents") + tuple(
    f"{measure}_{end}" for measure in MEASURES for end in ("mean", "lo", "hi")
)


def interval(values):
    """(mean, lower, upper) of the mean of what is known, with 95 %; None if nothing is."""
    values = [value for value in values if value is not None]
    if not values:
        return None, None, None
    mean, *ends = bootstrap_mean(values)
    return (mean, *(mean if end is None else end for end in ends))


def verdict(rows, key):
    """What the rates say of a measure: the spread of its means and whether all intervals share a value, in words."""
    if any(row["status"] != "completed" for row in rows):
        return "incomplete"
    if any(row[f"{key}_mean"] is None for row in rows):
        return "-"  # somewhere nobody arrived
    means = [row[f"{key}_mean"] for row in rows]
    agree = max(row[f"{key}_lo"] for row in rows) <= min(row[f"{key}_hi"] for row in rows)
    return f"{max(means) - min(means):.2f}, {'pass' if agree else 'FAIL'}"


def shown(row, key, digits=1):
    if row["status"] != "completed":
        return row["status"]
    if row[f"{key}_mean"] is None:
        return "-"
    return "{:.{d}f} ({:.{d}f} .. {:.{d}f})".format(*(row[f"{key}{end}"] for end in ("_mean", "_lo", "_hi")), d=digits)


HEADER = """# Outcomes at several frame rates

`{command}`: {varied} at {rates} Hz{kept}, {seeds} seeds of the markers in one water;
means with 95 % intervals (bootstrap over the seeds). A rule passes where the intervals of all rates share a value; it
is incomplete where the run at a rate failed.
"no water" is the walk alone (tau 0): what varies there is due to the walking rule and the markers. Time: of the last
arrival; agents' time: mean over all who arrive.
"""
FRAMES, STEPS = "frames of the water", "steps of the crowd"
VARIED = {"both": (f"{FRAMES} and {STEPS}", None), "frames": (FRAMES, STEPS), "steps": (STEPS, FRAMES)}  # (what, kept)
OTHER_WATER = """\
The water of the model {model} is not the same at all rates, as its time steps end where frames do, so what varies
here is due to the water, too.
"""


def of_scene(scene, rows):
    """The section of a scene."""
    model = rows[0]["model"]
    cells = [(row["rule"], row["frame_rate_hz"], shown(row, "arrived"), shown(row, "time_s"), shown(row, "agent_time_s", 2))
             for row in rows]
    answers = [(rule, *(verdict([row for row in rows if row["rule"] == rule], key) for key in MEASURES))
               for rule in dict.fromkeys(row["rule"] for row in rows)]
    return section(f"{scene} ({model})", "" if model == "kinematic" else OTHER_WATER.format(model=model),
                   markdown(("rule", "rate", "arrived", "time, s", "agents' time, s"), cells),
                   markdown(("rule", "arrived: range of the means", "time, s", "agents' time, s"), answers))


def report(rows, options):
    rates = sorted({row["frame_rate_hz"] for row in rows})
    varied, other = VARIED[options.vary]
    kept = f", {other} at {max(rates)} Hz" if other else ""
    head = HEADER.format(command=options.command, varied=varied, kept=kept, rates=", ".join(map(str, rates)),
                         seeds=options.seeds)
    return document(head, *(of_scene(scene, [row for row in rows if row["scene"] == scene])
                            for scene in dict.fromkeys(row["scene"] for row in rows)))
