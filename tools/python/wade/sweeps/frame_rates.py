"""Runs each scene at several frame rates, with as many steps of the crowd, and with each coupling rule.

For each scene and rate one server sends the water to all crowds: the coupling rules per_frame and continuous, and the walk
without water (tau 0), each with N seeds of the markers. Prints arrivals and times with 95 % intervals; writes
DIR/frame_rates.csv, DIR/report.md and DIR/runs/. Kinematic water is the same at all rates; the solved models make other
water at each, and the report says so. Events must be given by time_s.
"""

import argparse
import json
import statistics
import subprocess
from pathlib import Path

from wade import UsageError, plain_file
from wade.many import label
from wade.paths import RUNS, module_command
from wade.reports.files import say, write_whole
from wade.statistics.shares import bootstrap_mean
from wade.reports.options import whole
from wade.reports.tables import document, markdown, read_csv, section, write_csv
from wade.run.processes import resolved
from wade.scenes import find_scene
from wade.terminal import Parser, say_error

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
        return "-"  # no arrivals at some rate
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


SCENES = ("observed/s05", "observed/s07", "observed/s10")
RATES = (15, 30, 60, 120)  # Hz
PATIENCE_S = "300"  # of either program: many crowds take long to set up, and the machine may be busy
ALLOWED_RATES = (0.01, 1000)  # /frame_rate_hz


def rates_of(text):
    """The rates of "15,30", Hz, ascending; at least two, as one agrees with itself."""
    try:
        rates = sorted(float(word) for word in text.split(","))
    except ValueError:
        rates = []
    low, high = ALLOWED_RATES
    if len(set(rates)) < max(2, len(rates)) or not all(low <= rate <= high for rate in rates):
        raise argparse.ArgumentTypeError(
            f'"{text}" is not allowed; allowed: at least two different rates, {low:g} to {high:g} Hz each, as in 15,30'
        )
    return [int(rate) if rate == int(rate) else rate for rate in rates]


def at_rate(rate, vary="both", highest=None):
    """Returns options for frames and steps at one rate; they also replace a crowd's own rate.

    vary: "frames" or "steps" keeps the others at the highest rate.
    """
    frames = highest if vary == "steps" else rate
    steps = highest if vary == "frames" else rate
    return ["--set", f"/frame_rate_hz={frames}", "--set", f"/crowd/step_rate_hz={steps}"]


def rate_options(rate, options):
    return at_rate(rate, options.vary, max(options.rates))


def resolve(scene, rates, options):
    """The resolved scene at each rate, {rate: scene}; ends the program if there is none or they are not comparable."""
    scenes = {rate: resolved(scene, *rate_options(rate, options)) for rate in rates}
    if moves_events(scenes):
        raise UsageError(f"{scene}: /events: an event that is given by its frame is at another time at each rate; allowed "
                         "here: time_s")
    return scenes


def moves_events(scenes):
    """Whether an event is at times that differ by more than a frame, of scenes {rate: scene}."""
    times = [[event["frame"] / scene.get("frame_rate_hz", rate) for event in scene["events"]]
             for rate, scene in scenes.items()]
    return any(max(of_event) - min(of_event) > 1 / min(scenes) + 1e-9 for of_event in zip(*times))


def rules_of(sampling):
    """The rules that are compared; sampling: samples of the water a second for a further one, 1/s, or None."""
    return RULES if sampling is None else (*RULES[:2], SAMPLED, *RULES[2:])


def changes_of(rule, scene, sampling=None):
    """What a crowd with this rule sets in a resolved scene: {JSON pointer: value}."""
    if rule == SAMPLED:
        return {"/coupling/rule": "continuous", "/coupling/sampling_rate_hz": sampling}
    if rule != "no water":
        return {"/coupling/rule": rule}
    # Groups may have a tau of their own, and an event may change any.
    groups = [{**group, "tau": 0} for group in scene["crowd"]["groups"]]
    return {"/crowd": {**scene["crowd"], "groups": groups}, "/events": []}


def run(name, rate, scene, options):
    """Runs all crowds of a scene file at one rate; returns {(rule, seed): run folder}, or None if the run failed."""
    out = options.out / "runs" / f"{label(name)}-{rate}hz"
    out.mkdir(parents=True, exist_ok=True)
    seeds = range(1, options.seeds + 1)
    crowds = {(rule, seed): f"{rule.replace(', ', '_').replace(' ', '_')}-seed{seed}"
              for rule in rules_of(options.sampling_rate_hz) for seed in seeds}
    crowd_list = [{"name": folder, "set": {"/seed": seed, **changes_of(rule, scene, options.sampling_rate_hz)}}
                  for (rule, seed), folder in crowds.items()]
    (out / "crowds.json").write_text(json.dumps(crowd_list, indent=1))
    command = [*module_command("wade.run.pair"), name, "--out", out,
               "--crowds", out / "crowds.json", *rate_options(rate, options), "--no-trajectories", "--water-every-s", "0",
               "--reproducible", "--threads", str(options.threads),
               "--attach-timeout-s", PATIENCE_S, "--step-timeout-s", PATIENCE_S]
    with plain_file.create(out / "run.log") as log:
        if subprocess.run(command, stdout=log, stderr=log).returncode != 0:
            say_error(f"wade frame-rates: {name} at {rate} Hz failed, see {out / 'run.log'}")
            return None
    return {key: out / folder for key, folder in crowds.items()}


def figures_of(folder):
    """Returns (arrivals, time of the last arrival, s, mean arrival time, s) of a crowd; times None without arrivals."""
    outcome = plain_file.read_json(folder / "outcome.json")
    times = [float(row["time_s"]) for row in read_csv(folder / "agents.csv") if row["outcome"] == "arrived"]
    return outcome["arrived"], outcome["last_arrival_s"], statistics.fmean(times) if times else None


def rows_of(name, rate, scene, folders, seeds, rules=RULES):
    """A row of the table for each rule. folders: {(rule, seed): run folder}, None if the run failed."""
    for rule in rules:
        row = dict.fromkeys(COLUMNS)
        row.update(scene=label(name), model=scene["fluid"]["model"], rule=rule, frame_rate_hz=rate, seeds=seeds,
                   agents=sum(group["count"] for group in scene["crowd"]["groups"]),
                   status="completed" if folders else "failed")
        if folders:
            figures = [figures_of(folders[rule, seed]) for seed in range(1, seeds + 1)]
            for measure, values in zip(MEASURES, zip(*figures)):
                row.update(zip((f"{measure}_{end}" for end in ("mean", "lo", "hi")), interval(values)))
        yield row


def parse(arguments):
    parser = Parser("frame-rates", __doc__, """Exit code: 0 if all runs ended well, whether the rates agree or not; 1 if one
failed, which makes its scene incomplete; 2 bad usage or scene.""")
    parser.add_argument("scenes", nargs="*", metavar="SCENE", default=list(SCENES),
                        help="files or short names [S5, S7 and S10 of configs/observed]")
    parser.add_argument("--out", type=Path, default=RUNS / "frame_rates", metavar="DIR",
                        help="[runs/frame_rates in the project]")
    parser.add_argument("--seeds", type=whole(1, 1000), default=10, metavar="N", help="seeds of the markers, 1 to 1000 [10]")
    parser.add_argument("--rates", type=rates_of, default=list(RATES), metavar="A,B",
                        help="at least two frame rates, 0.01 to 1000 Hz [15,30,60,120]")
    parser.add_argument("--vary", choices=("both", "frames", "steps"), default="both",
                        help="frames: how often the water is sampled, with the steps of the crowd at the highest rate; "
                             "steps: those of the crowd, with the frames at the highest rate [both]")
    parser.add_argument("--sampling-rate-hz", type=float, metavar="R",
                        help="also the rule continuous with the water sampled R times a second within its steps")
    parser.add_argument("--threads", type=int, default=0, metavar="N",
                        help="of the crowds and the water [number of processors]")
    options = parser.parse_args(arguments)
    if options.sampling_rate_hz is not None and not 0 < options.sampling_rate_hz <= 100000:
        parser.error(f"--sampling-rate-hz: {options.sampling_rate_hz:g} is not allowed; allowed: above 0 to 100000")
    options.command = " ".join(["tools/wade", "frame-rates", *arguments])
    return options


def main(arguments):
    """tools/wade frame-rates."""
    options = parse(arguments)
    scenes = [find_scene(name) for name in options.scenes]
    rows, failed = [], False
    at_rates = {name: resolve(name, options.rates, options) for name in scenes}
    for name in scenes:
        for rate, scene in at_rates[name].items():
            folders = run(name, rate, scene, options)
            failed = failed or folders is None
            rows += rows_of(name, rate, scene, folders, options.seeds, rules_of(options.sampling_rate_hz))
    order = [label(name) for name in scenes]
    rules = rules_of(options.sampling_rate_hz)
    rows.sort(key=lambda row: (order.index(row["scene"]), rules.index(row["rule"]), row["frame_rate_hz"]))
    write_csv(options.out / "frame_rates.csv", COLUMNS, rows)
    text = report(rows, options)
    write_whole(options.out / "report.md", text)
    say(text)
    return 1 if failed else 0
