"""Which inputs decide who survives: a plan of runs over ranges of inputs, then what they say.

With a SCENE it writes DIR/plan.csv and DIR/design.json; `tools/wade many DIR/plan.csv --out DIR` runs it; with that DIR it
writes sensitivity.csv, sensitivity.md and sensitivity.png. First --morris over all inputs, then --sobol over those that matter.

Inputs are a JSON list: name, set (pointers; * stands for each group), min, max, source, unit, times_own
for a factor on the scene's own value. An input applies only if the scene has a value at the pointer needs
and none at the pointer unless. All points have the same seeds, so that chance is common to them.
"""

import json
from pathlib import Path

import numpy as np

from wade import UsageError, plain_file, progress
from wade.ensembles.plan import scene_name
from wade.many import seed_range
from wade.reports.files import say, write_whole
from wade.reports.options import patterns_of, whole
from wade.reports.tables import document, markdown, number, section, write_csv
from wade.run.processes import resolved
from wade.scenes import find_scene
from wade.states import OFF_FEET, SAFE
from wade.statistics.ensemble import planned, read_outcome
from wade.statistics.indices import elementary_effects, sobol_indices, sobol_points, trajectories
from wade.terminal import Parser

DEFAULT_INPUTS = Path(__file__).with_name("inputs.json")
DESIGN, PLAN = "design.json", "plan.csv"
NEEDED = ("name", "set", "min", "max", "source")
# Results of a run to analyse: the share of people, in words, and from outcome.json.
RESULTS = {
    "died": ("who die", lambda o: o["dead"] / o["agents"]),
    "arrived": ("who arrive, or find shelter", lambda o: sum(o["states"].get(s, 0) for s in SAFE) / o["agents"]),
    "off_feet": ("who are off their feet at the end", lambda o: sum(o["states"].get(s, 0) for s in OFF_FEET) / o["agents"]),
}
EPILOG = """Exit code: 0; 1 runs are missing; 2 bad usage."""


class Input:
    """A line of the list, as it applies to a scene: pointers and what each is set to."""

    def __init__(self, entry, scene):
        self.name, self.entry = entry["name"], entry
        pointers = [one for pointer in entry["set"] for one in spread(pointer, scene)]
        self.factors = {pointer: value_of(scene, pointer) if entry.get("times_own") else 1 for pointer in pointers}
        fits = value_of(scene, entry.get("needs", "/crowd")) and not ("unless" in entry and value_of(scene, entry["unless"]))
        self.factors = {pointer: own for pointer, own in self.factors.items() if fits and isinstance(own, (int, float)) and own}

    def settings(self, unit):
        """Returns {pointer: value} at a coordinate of the unit interval."""
        value = self.entry["min"] + unit * (self.entry["max"] - self.entry["min"])
        return {pointer: round(value * factor, 9) for pointer, factor in self.factors.items()}

    def in_words(self):
        if len(set(self.factors.values())) > 1:
            return f"{self.entry['min']:g} to {self.entry['max']:g} times each"
        factor = next(iter(self.factors.values()))
        return f"{self.entry['min'] * factor:.4g} to {self.entry['max'] * factor:.4g} {self.entry.get('unit', '')}".rstrip()


def value_of(scene, pointer):
    """The value at a pointer of a resolved scene; None where there is none."""
    at = scene
    for part in pointer.strip("/").split("/"):
        at = at[int(part)] if isinstance(at, list) else at.get(part) if isinstance(at, dict) else None
    return at if isinstance(at, (int, float, list, dict)) else None


def spread(pointer, scene):
    """Returns the pointers of a pattern: one for each group of the scene if it has *, else itself."""
    if "/*/" not in pointer:
        return [pointer]
    head, tail = pointer.split("/*/")
    return [f"{head}/{k}/{tail}" for k in range(len(value_of(scene, head) or []))]


def read_inputs(file, scene, only=()):
    """The inputs of a file that apply to a scene; UsageError names what is wrong."""
    try:
        entries = plain_file.read_json(file, list)
    except plain_file.FileError as error:
        raise UsageError(f"--inputs {file}: {error.strerror}") from error
    for place, entry in enumerate(entries):
        missing = [key for key in NEEDED if key not in entry]
        if missing:
            raise UsageError(f"--inputs {file}: /{place} has no {missing[0]}; needed are {', '.join(NEEDED)}")
        if not entry["min"] < entry["max"]:
            raise UsageError(f"--inputs {file}: /{place} min {entry['min']}, max {entry['max']}; allowed: min below max")
    inputs = [Input(entry, scene) for entry in entries]
    for place, one in enumerate(inputs):
        if not one.factors and file != DEFAULT_INPUTS:
            raise UsageError(f"--inputs {file}: /{place}: the scene has nothing at {', '.join(one.entry['set'])}")
    inputs = [one for one in inputs if one.factors]
    names = [one.name for one in inputs]
    unknown = [name for name in only if name not in names]
    if unknown:
        raise UsageError(f'--only {unknown[0]}: no such input; allowed: {", ".join(names)}')
    return [one for one in inputs if one.name in only or not only]


def why_silent(inputs, scene):
    """Inputs of the default list that cannot change anything in this scene, with the reason."""
    silent = {}
    crowd = scene["crowd"]
    by_body = crowd.get("response") == "measured"
    for one in inputs:
        last = one.entry["set"][0].rpartition("/")[2]
        if last in ("ground_friction", "bracing_arm", "height_m", "age", "water_temperature_c") and not by_body:
            silent[one.name] = "people have the response `paper`"
        elif last == "age" and crowd.get("walking_in_water") != "bernardini":
            silent[one.name] = "walking_in_water is not `bernardini`"
    return silent


def points_of(options, inputs):
    """All points of a design, rows of the unit cube in the order of its runs."""
    if options.sobol:
        points = sobol_points(inputs, options.sobol, options.design_seed)
        if options.repeat:
            points = np.concatenate([points, points[:1]])
    else:
        points = trajectories(inputs, options.morris, options.design_seed)
    return points.reshape(-1, inputs)


def write_plan(options):
    """plan.csv and design.json of a scene."""
    file = find_scene(options.target)
    scene = resolved(file)
    inputs = read_inputs(options.inputs, scene, options.only)
    silent = why_silent(inputs, scene) if options.inputs == DEFAULT_INPUTS else {}
    inputs = [one for one in inputs if one.name not in silent]
    points = points_of(options, len(inputs))
    seeds = list(options.seeds)
    written = scene_name(file)
    rows = []
    for place, point in enumerate(points):
        settings = {pointer: value for one, unit in zip(inputs, point) for pointer, value in one.settings(unit).items()}
        # The repeated runs, after all others, have the seeds after the last one.
        again = options.sobol and options.repeat and place >= len(points) - options.sobol
        for seed in seeds:
            rows.append([len(rows) + 1, written, seed + (len(seeds) if again else 0), json.dumps(settings)])
    write_csv(options.out / PLAN, ("index", "scene", "seed", "settings"), rows)
    design = {"kind": "sobol" if options.sobol else "morris", "count": options.sobol or options.morris, "scene": written,
              "seeds": seeds, "design_seed": options.design_seed, "repeated": bool(options.sobol and options.repeat),
              "inputs": [{**one.entry, "range": one.in_words()} for one in inputs], "left_out": silent,
              "points": points.round(12).tolist()}
    write_whole(options.out / DESIGN, json.dumps(design) + "\n")
    for name, why in silent.items():
        say(f"left out: {name}, as {why}")
    say(f"{len(rows)} runs of {len(inputs)} inputs: tools/wade many {options.out / PLAN} --out {options.out}\n"
        f"then: tools/wade sensitivity {options.out}")
    return 0


def results_of(folder, design, result):
    """What the runs gave, a mean over seeds a point, and how many are missing."""
    rows = planned(folder)
    if rows is None or len(rows) != len(design["points"]) * len(design["seeds"]):
        raise UsageError(f"{folder / PLAN} is not that of {folder / DESIGN}")
    values = []
    for run, _, _, seed, why_not in progress.over(rows, "reads the runs"):
        outcome, _ = (None, why_not) if why_not else read_outcome(run, seed)
        values.append(np.nan if outcome is None else RESULTS[result][1](outcome))
    return np.array(values).reshape(-1, len(design["seeds"])).mean(axis=1), int(np.isnan(values).sum())


def morris_rows(design, results):
    inputs = len(design["inputs"])
    points = np.array(design["points"]).reshape(design["count"], inputs + 1, inputs)
    effects = elementary_effects(points, results.reshape(design["count"], inputs + 1))
    return [(one["name"], one["range"], *values) for one, *values in
            zip(design["inputs"], effects.size, effects.low, effects.high, effects.spread)]


def sobol_rows(design, results):
    inputs, count = len(design["inputs"]), design["count"]
    rows = results.reshape(-1, count)
    found = sobol_indices(rows[: inputs + 2], rows[inputs + 2] if design["repeated"] else None)
    return found, [(one["name"], one["range"], *values) for one, *values in
                   zip(design["inputs"], found.first, found.first_low, found.first_high, found.total, found.total_low,
                       found.total_high)]


HEADS = {"morris": ("input", "range", "mu*", "low", "high", "sigma"),
         "sobol": ("input", "range", "S", "S low", "S high", "S_T", "S_T low", "S_T high")}


def draw(kind, rows, result, file):
    """Bars with intervals, the largest on top."""
    from wade.reports.plots import COLOURS, panels, save

    rows, words = sorted(rows, key=lambda row: row[5] if kind == "sobol" else row[2]), RESULTS[result][0]
    figure, (axes,) = panels(1, (6.4, 1.2 + 0.42 * len(rows)))
    at = np.arange(len(rows))
    parts = (("S, alone", 2, -0.18), ("S_T, with others", 5, 0.18)) if kind == "sobol" else (("mu*", 2, 0.0),)
    for colour, (label, column, shift) in enumerate(parts):
        values, low, high = (np.array([row[column + k] for row in rows]) for k in range(3))
        axes.barh(at + shift, values, 0.34, color=COLOURS[colour], label=label)
        axes.errorbar(values, at + shift, xerr=np.clip([values - low, high - values], 0, None), fmt="none", ecolor="#2a2a2e",
                      capsize=2, linewidth=0.9)
    what = "share of the variance" if kind == "sobol" else "mean change over the whole range"
    axes.set(yticks=at, yticklabels=[row[0] for row in rows], xlabel=f"{what} of the share {words}")
    axes.legend(loc="lower right")
    save(figure, file)


def page(design, result, rows, found):
    """sensitivity.md."""
    kind = design["kind"]
    runs = len(design["points"]) * len(design["seeds"])
    head = (f"# What matters: {design['scene']}\n\nResult: the share of people {RESULTS[result][0]}. {runs} runs, "
            f"{len(design['seeds'])} seed{'s' if len(design['seeds']) > 1 else ''} in each point.\n")
    key = 5 if kind == "sobol" else 2
    ordered = sorted(rows, key=lambda row: -row[key])
    table = markdown(HEADS[kind], [[*row[:2], *(number(value, 3) for value in row[2:])] for row in ordered])
    how = (f"Morris, {design['count']} ways: mu* is the mean change of the result over the whole range of an input, sigma how "
           "much that depends on the others. Intervals of 95 %, ways resampled. Whose interval begins near 0 may be left as it "
           "is.\n" if kind == "morris" else
           f"Sobol, N = {design['count']}: S is the share of the variance that an input makes alone, S_T with all others. "
           "Intervals of 95 %, points resampled.\n")
    if found is not None and found.noise == found.noise:
        how += f"Runs of the same inputs with other seeds make {100 * found.noise:.1f} % of the variance.\n"
    sources = markdown(("input", "range", "source"), [[one["name"], one["range"], one["source"]] for one in design["inputs"]])
    left = "".join(f"* {name}: {why}\n" for name, why in design["left_out"].items())
    return document(head, section("In short", how, table, "![What matters](sensitivity.png)"), section("Ranges", sources),
                    section("Left out", left) if left else "")


def analyse(options):
    """Writes sensitivity.md, .csv and .png of a folder if its runs are complete; returns the exit code."""
    folder = Path(options.target)
    design = plain_file.read_json(folder / DESIGN)
    results, missing = results_of(folder, design, options.result)
    if missing:
        say(f"{missing} runs are missing; tools/wade many {folder / PLAN} --out {folder} goes on")
        return 1
    found, rows = sobol_rows(design, results) if design["kind"] == "sobol" else (None, morris_rows(design, results))
    columns = [head.lower().replace("*", "_star").replace(" ", "_") for head in HEADS[design["kind"]]]
    write_csv(folder / "sensitivity.csv", columns, rows)
    draw(design["kind"], rows, options.result, folder / "sensitivity.png")
    text = page(design, options.result, rows, found)
    write_whole(folder / "sensitivity.md", text)
    say(text)
    return 0


def parse(arguments):
    parser = Parser("sensitivity", __doc__, EPILOG)
    parser.add_argument("target", metavar="SCENE|DIR", help="a scene, to write a plan; or the folder of a plan that was run")
    parser.add_argument("--inputs", type=Path, default=DEFAULT_INPUTS, metavar="FILE",
                        help="JSON list of inputs [inputs.json beside this program's source]")
    parser.add_argument("--only", type=patterns_of, default=[], metavar="A,B", help="only these inputs, by name")
    parser.add_argument("--morris", type=whole(2, 10000), default=20, metavar="R", help="ways through the ranges [20]")
    parser.add_argument("--sobol", type=whole(8, 65536), metavar="N",
                        help="in place of Morris: N points, a power of two; N (inputs + 2) runs")
    parser.add_argument("--repeat", action="store_true", help="N more runs with other seeds, which tell what is chance")
    parser.add_argument("--seeds", type=seed_range, default=[1], metavar="A-B", help="of each point [1]")
    parser.add_argument("--design-seed", type=whole(0), default=1, metavar="N", help="of the points [1]")
    parser.add_argument("--result", choices=tuple(RESULTS), default="died", help="what of a run is looked at [died]")
    parser.add_argument("--out", type=Path, metavar="DIR", help="folder of the plan [runs/sensitivity-<time>/]")
    options = parser.parse_args(arguments)
    if options.sobol and options.sobol & (options.sobol - 1):
        parser.error(f"--sobol: {options.sobol} is not allowed; allowed: powers of two")
    return options


def programs_for(arguments):
    """A plan needs the crowd, which reads the scene."""
    return ("crowd_client",)


def main(arguments):
    """tools/wade sensitivity."""
    options = parse(arguments)
    if (Path(options.target) / DESIGN).exists():
        return analyse(options)
    if options.out is None:
        from wade.run.folders import new_folder

        options.out = new_folder("sensitivity")
    return write_plan(options)
