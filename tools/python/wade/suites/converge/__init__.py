"""How far survival depends on numerics: shares of outcomes and times over rates, cells and spacings, one at a time.

Each scene runs with its reference values and with one numerical factor at another value, by the same seeds. Measures
are the shares of people (safe, lost, off their feet, no end yet) and the times until half and nine tenths of the ends.
A paired difference has an interval of 95 % (bootstrap over seeds): equal where it lies within 3 points, or 5 % of the
time; different where it lies outside; else undecided, which asks for more seeds, up to --most-seeds. --quick: single persons in
steady water, one seed; outcomes and states must be the same.

Physical choices (the law of walking in water, one-way or two-way coupling, bodies) are varied likewise. Their
differences are reported with intervals and have no limit. --factors 'walking law' runs one of them alone.

If `--check` warns of a value, it names a remedy: the report says so, and gives its differences apart (crowds only).

What is complete is not run again, so that the suite goes on where it was interrupted; --quick starts anew.
Exit code 1: a share or a time is different without a warning.
"""

import contextlib
import json
import re
import shlex
import shutil
import statistics
import subprocess
import sys
import time
from types import SimpleNamespace

from wade import UsageError, plain_file, progress
from wade.ensembles.plan import PlannedRun, plan_text
from wade.many import seed_range
from wade.paths import BUILD, CONFIGS, module_command
from wade.reports.files import publish, say, write_whole
from wade.reports.options import choose, parser_of, whole
from wade.reports.plots import COLOURS, INK, panels, save
from wade.reports.tables import document, markdown, read_csv, section, write_csv
from wade.states import end_of
from wade.statistics.shares import bootstrap_mean
from wade.suites.converge.cases import CASES

SAME_POINTS = 3.0  # of 100 people
SAME_TIME = 0.05  # of a time
SAME_WALK = 0.02  # of the time of one person; the path depends on markers that are drawn in each step
SHARES = {
    "safe": lambda row: end_of(row["outcome"]) == "safe",
    "lost": lambda row: end_of(row["outcome"]) == "lost",
    "off their feet": lambda row: row["off_feet_s"] != "",
    "no end yet": lambda row: end_of(row["outcome"]) == "none",
}
TIMES = {"half had an end, s": 0.5, "nine tenths had an end, s": 0.9}
COLUMNS = ("scene", "factor", "value", "reference", "measure", "seeds", "of_reference", "of_value", "difference", "low", "high",
           "verdict", "warned")
PATIENCE_S = "300"
DRAWN = ("safe", "lost")
SEEDS_OF_THREADS = 2  # bits do not need more
FACTORS = list({factor.name: factor for case in CASES for factor in case.varied}.values())
FACTORS_BY_WORD = {factor.name.split(",")[0]: factor.name for factor in FACTORS}  # without units, for --factors


def measures_of(rows):
    """{measure: value} of the lines of an agents.csv: shares in points, times in s; None without any end."""
    found = {name: 100 * sum(map(holds, rows)) / len(rows) for name, holds in SHARES.items()}
    ends = sorted(float(row["time_s"]) for row in rows if not SHARES["no end yet"](row))
    for name, share in TIMES.items():
        found[name] = ends[min(len(ends) - 1, int(share * len(ends)))] if ends else None
    return found


def verdict(measure, reference, values):
    """(mean difference, low, high, verdict) of paired values; pairs without any end are left out."""
    pairs = [(a, b) for a, b in zip(reference, values) if a is not None and b is not None]
    if not pairs:
        return None, None, None, "equal"
    mean, low, high = bootstrap_mean([b - a for a, b in pairs])
    allowed = SAME_TIME * statistics.fmean(a for a, _ in pairs) if measure in TIMES else SAME_POINTS
    if low is None:  # of one seed
        low = high = mean
    if -allowed <= low and high <= allowed:
        return mean, low, high, "equal"
    return mean, low, high, "different" if low > allowed or high < -allowed else "undecided"


def people_verdict(reference, found):
    """The verdict on single persons: the same outcomes, states and worst states, and ends within SAME_WALK of the time."""
    keys = ("outcome", "state", "worst_state")
    same = [all(a[key] == b[key] for key in keys) and abs(float(a["time_s"]) - float(b["time_s"])) <= SAME_WALK * float(a["time_s"])
            for a, b in zip(reference, found)]
    return "equal" if all(same) else "different"


def settings_of(case, varied=None):
    """{(factor, value in words): what is set}; the reference, which is first, is ("reference", ""). varied: all by default."""
    settings = {("reference", ""): dict(case.reference)}
    for factor in case.varied if varied is None else varied:
        for value in factor.values:
            settings[factor.name, factor.word(value)] = {**case.reference, **factor.sets(value)}
    return settings


def is_warned(case, factor, values):
    """Whether `--check` warns of the keys that a factor sets, with these values."""
    words = [word for pointer, value in values.items() for word in ("--set", f"{pointer}={json.dumps(value)}")]
    answer = subprocess.run([BUILD / "crowd_client", CONFIGS / f"{case.scene}.json", "--check", *words], capture_output=True,
                            text=True, check=True)
    warnings = [line for line in (answer.stdout + answer.stderr).splitlines() if line.startswith("warning: ")]
    return any(pointer in line for line in warnings for pointer in factor.pointers)


def varied_in(case, options):
    """The factors that --factors and --quick leave of a case."""
    all_of_them = case.factors if options.quick else case.varied
    return tuple(factor for factor in all_of_them if factor.name in options.factor_names)


def run(case, stages, options):
    """Runs what is not there yet; {(factor, value): {seed: lines of agents.csv}}. stages: [(seeds, settings)], each beside the reference."""
    varied = varied_in(case, options)
    chosen = "-".join([case.name, *(re.sub(r"\W+", "_", factor.name) for factor in varied)]) if options.factors else case.name
    out = options.out / ("quick" if options.quick else "runs") / chosen
    out.parent.mkdir(parents=True, exist_ok=True)
    settings = settings_of(case, varied)
    places = [(key, seed) for seeds, keys in stages for seed in seeds for key in settings
              if key[0] != "threads" and (key[0] == "reference" or key in keys)]
    found = run_plan(case.scene, settings, places, out)
    for key in settings:
        if key[0] == "threads":
            places = [(key, seed) for seed in stages[0][0][:SEEDS_OF_THREADS]]
            found |= run_plan(case.scene, settings, places, out.with_name(f"{chosen}-threads-{key[1]}"), "--threads", key[1])
    return found


def tell_how_far(many, log, name):
    """Tells how many runs have ended, as tools/wade many writes it into its log, until it ends."""
    while many.poll() is None:
        done, total = (re.findall(r"^\[(\d+)/(\d+)\]", plain_file.read_text(log, "replace"), re.MULTILINE) or [(0, 0)])[-1]
        progress.at(f"runs {name}", int(done), int(total) or None)
        try:
            with contextlib.suppress(subprocess.TimeoutExpired):
                many.wait(1)
        except KeyboardInterrupt:
            many.terminate()
            raise


def run_plan(scene, settings, places, out, *words):
    """Runs each (setting, seed) of `places` with these options; returns {setting: {seed: lines of agents.csv}}."""
    plan = [PlannedRun(k + 1, scene, seed, settings[key]) for k, (key, seed) in enumerate(places)]
    file = out.with_suffix(".csv")
    write_whole(file, plan_text(plan))
    command = [*module_command("wade.many"), file, "--out", out, "--resume", "--reproducible", "--", "--no-trajectories", "--water-every-s",
               "0", "--attach-timeout-s", PATIENCE_S, "--step-timeout-s", PATIENCE_S, *words]
    log = out.with_suffix(".log")
    with plain_file.create(log) as said, subprocess.Popen(command, stdout=said, stderr=said) as many:
        tell_how_far(many, log, out.name)
    table = out / "runs.csv"
    complete = {int(row["index"]) for row in read_csv(table) if row["status"] == "completed"} if table.is_file() else set()
    found = {}
    for line, (key, seed) in zip(plan, places):
        if line.index not in complete:
            raise UsageError(f"{line} did not end well; {out.with_suffix('.log')} says why")
        found.setdefault(key, {})[seed] = read_csv(out / "runs" / line.name / "agents.csv")
    return found


def draw(case, rows, file):
    """A panel for each of DRAWN: the differences of all settings with their intervals, beside the limit."""
    settings = list(dict.fromkeys((row["factor"], row["value"]) for row in rows))
    figure, axes = panels(len(DRAWN), (3.6, 0.9 + 0.2 * len(settings)), [(f"{name}, difference in points", "") for name in DRAWN])
    for axis, measure in zip(axes, DRAWN):
        axis.axvspan(-SAME_POINTS, SAME_POINTS, color="#e4e4e8")
        for k, key in enumerate(settings):
            row = next(r for r in rows if (r["factor"], r["value"]) == key and r["measure"] == measure)
            colour = COLOURS[7] if row["verdict"] == "reported" else COLOURS[0]
            axis.errorbar(row["difference"], -k, xerr=[[row["difference"] - row["low"]], [row["high"] - row["difference"]]]
                          if row["low"] is not None else None, color=colour, marker="o", markersize=4, capsize=2.5)
        axis.set_yticks([-k for k in range(len(settings))], [f"{factor} {value}" for factor, value in settings] if axis is axes[0] else [])
        axis.axvline(0, color=INK, linewidth=0.8)
    figure.suptitle(f"{case.name}: grey band {SAME_POINTS:g} points; grey marks are physical choices")
    figure.tight_layout()
    save(figure, file)


def compared(case, found, warned_of=is_warned):
    """The rows of the table. warned_of(case, factor, settings): whether `--check` warns."""
    reference = found["reference", ""]
    settings = settings_of(case)
    for (factor, value), runs in found.items():
        if factor == "reference":
            continue
        has_limit = case.factor(factor) in case.factors
        warned = has_limit and not case.quick and warned_of(case, case.factor(factor), settings[factor, value])
        start = {"scene": case.name, "factor": factor, "value": value, "seeds": len(runs), "warned": "yes" if warned else "",
                 "reference": case.factor(factor).word(case.factor(factor).reference)}
        if case.quick and has_limit:
            same = [people_verdict(reference[seed], runs[seed]) for seed in runs]
            yield {**start, "measure": "states", "verdict": "equal" if set(same) == {"equal"} else "different"}
            continue
        pairs = [(measures_of(reference[seed]), measures_of(runs[seed])) for seed in runs]
        for measure in (*SHARES, *TIMES):
            of_reference, of_value = ([pair[k][measure] for pair in pairs] for k in (0, 1))
            mean, low, high, word = verdict(measure, of_reference, of_value)
            known = [[v for v in values if v is not None] for values in (of_reference, of_value)]
            means = [statistics.fmean(values) if values else None for values in known]
            yield {**start, "measure": measure, "of_reference": means[0], "of_value": means[1], "difference": mean, "low": low,
                   "high": high, "verdict": word if has_limit else "reported"}


def decide(case, options):
    """The rows of a case; settings with an undecided row get more seeds, up to --most-seeds."""
    seeds = [1] if case.quick else list(options.seeds)
    undecided = set(settings_of(case, varied_in(case, options)))
    stages, rows = [], {}
    while undecided and seeds:
        stages.append((seeds, undecided))
        found = list(compared(case, run(case, stages, options)))
        for key in {(row["factor"], row["value"]) for row in found}:
            rows[key] = [row for row in found if (row["factor"], row["value"]) == key]
        undecided = {key for key, of_key in rows.items() if any(row["verdict"] == "undecided" for row in of_key)}
        last, done = stages[-1][0][-1], sum(len(stage) for stage, _ in stages)
        seeds = [] if case.quick else list(range(last + 1, last + 1 + min(done, options.most_seeds - done)))
    order = list(settings_of(case, varied_in(case, options)))
    return [row for key in sorted(rows, key=order.index) for row in rows[key]]


def shown(row):
    def of(value):
        return "-" if value is None else f"{value:.1f}"

    interval = "" if row.get("low") is None else f"{of(row['difference'])} ({of(row['low'])} to {of(row['high'])})"
    return (row["factor"], row["value"], row["measure"], of(row.get("of_reference")), of(row.get("of_value")), interval,
            row["seeds"], row["verdict"] + (", warned" if row["warned"] else ""))


def counts(rows):
    """Counts what --check is silent on: compared, equal, of these alike, undecided, different; what it warns of: compared, not equal."""
    silent = [row for row in rows if not row["warned"] and row["verdict"] != "reported"]
    alike = sum(row["verdict"] == "equal" and row.get("low") == row.get("high") for row in silent)
    warned = [row["verdict"] for row in rows if row["warned"]]
    equal, *others = (sum(row["verdict"] == word for row in silent) for word in ("equal", "undecided", "different"))
    return len(silent), equal, alike, *others, len(warned), len(warned) - warned.count("equal")


def report(rows, options):
    """The page: counts of all scenes, then of each scene a figure and a table of what is not equal."""
    scenes = list(dict.fromkeys(row["scene"] for row in rows))
    per_scene = [(scene, *counts([row for row in rows if row["scene"] == scene])) for scene in scenes]
    head = (f"# Convergence of outcomes\n\n`{options.command}`. A share is equal where the 95 % interval of the paired difference lies "
            f"within {SAME_POINTS:g} points, a time within {100 * SAME_TIME:g} %, and different where it lies outside. Physical choices "
            "are reported and have no limit. `--check` warns of some values and names a remedy; their comparisons stand apart. "
            "*Alike* counts equal comparisons whose difference is the same in all seeds: their interval has no width, and a rare "
            "difference can escape it.\n")
    table = markdown(("scene", "compared", "equal", "alike", "undecided", "different", "compared, warned", "not equal, warned"),
                     [*per_scene, ("all", *counts(rows))])
    sections = []
    for scene in scenes:
        own = [row for row in rows if row["scene"] == scene]
        rest = [shown(row) for row in own if row["verdict"] != "equal"]
        unequal = markdown(("factor", "value", "measure", "reference", "found", "difference", "seeds", ""), rest) if rest else ""
        picture = f"![Differences of {' and '.join(DRAWN)}]({scene}.png)\n" if own[0]["measure"] != "states" else ""
        sections.append(section(scene, *(part for part in (picture, unequal) if part)))
    return document(head, table, *sections)


def parse(arguments):
    parser = parser_of("converge", "converge", __doc__, "converge.csv")
    parser.add_argument("cases", nargs="*", metavar="CASE", help=f"names or patterns of: {', '.join(c.name for c in CASES)} [all]")
    parser.add_argument("--factors", metavar="LIST", help="names or patterns, comma-separated, of: "
                        + ", ".join(f"'{word}'" if " " in word else word for word in FACTORS_BY_WORD) + " [all]")
    parser.add_argument("--seeds", type=seed_range, default=range(1, 21), metavar="A-B", help="to begin with [1-20]")
    parser.add_argument("--most-seeds", type=whole(1), default=80, metavar="N", help="of what is undecided [80]")
    options = parser.parse_args(arguments)
    words = [SimpleNamespace(name=word) for word in FACTORS_BY_WORD]
    try:
        options.factor_names = [FACTORS_BY_WORD[word.name] for word in choose(words, options.factors, "--factors")]
        options.chosen = choose(CASES, ",".join(options.cases) or None, "CASE")
    except ValueError as error:
        raise UsageError(f"converge: {error}") from error
    options.command = shlex.join(["tools/wade", "converge", *arguments])
    return options


def main(arguments):
    """tools/wade converge."""
    options = parse(arguments)
    chosen = [case for case in options.chosen if (case.quick or not options.quick) and varied_in(case, options)]
    rows = []
    if options.quick:
        shutil.rmtree(options.out / "quick", ignore_errors=True)
    for case in chosen:
        begin = time.monotonic()
        print(f"{case.name}: time left in {options.out}/{'quick' if options.quick else 'runs'}/{case.name}*.log", file=sys.stderr)
        own = decide(case, options)
        rows += own
        if own[0]["measure"] != "states":
            draw(case, own, options.out / f"{case.name}.png")
        write_csv(options.out / "converge.csv", COLUMNS, [{key: row.get(key) for key in COLUMNS} for row in rows])
        write_whole(options.out / "report.md", report(rows, options))
        print(f"{case.name}: {sum(r['verdict'] in ('undecided', 'different') for r in rows if r['scene'] == case.name)} not equal, "
              f"{time.monotonic() - begin:.0f} s", file=sys.stderr)
    say(report(rows, options))
    if options.publish:
        publish(options.out, "converge", "converge.csv")
    return 1 if any(row["verdict"] == "different" and not row["warned"] for row in rows) else 0
