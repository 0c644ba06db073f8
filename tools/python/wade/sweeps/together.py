"""Who keeps the feet hand in hand, and who alone: the same people in the same water, with their hands and without.

Each seed draws people anew. They stand or walk through the water of one server twice: as SCENE has them, and with
`hand_in_hand` `none` in all groups. People that never toppled, floated, were carried or drowned have kept the feet;
people that never slid either have stood firm. Writes DIR/together.csv with a line a group, measure and seed, and prints
a table: means over the seeds; the difference with the 95 % interval of a paired bootstrap over seeds; the people that
did it only with or only without hands, and how likely chance alone makes these two so different (exact test of McNemar
1947). That test counts people as independent, which people of a chain are not: the interval does not.
"""

import json
import math
import subprocess
from pathlib import Path

from wade import UsageError, plain_file
from wade.many import label, seed_range
from wade.paths import RUNS, module_command
from wade.reports.files import say
from wade.statistics.shares import bootstrap_mean, mean_of_alike
from wade.reports.tables import markdown, read_csv, write_csv
from wade.run.processes import resolved
from wade.scenes import find_scene
from wade.states import OFF_FEET
from wade.terminal import Parser, say_error

MEASURES = {"stood firm": ("sliding", *OFF_FEET), "kept the feet": OFF_FEET}  # the worst states that are too bad for it
COLUMNS = ("scene", "group", "measure", "seed", "people", "together", "alone", "only_together", "only_alone")
PATIENCE_S = "300"  # of either program: many crowds take long to set up, and the machine may be busy


def mcnemar(only_together, only_alone):
    """Returns the two-sided probability that a fair coin divides the pairs that differ at least so unevenly."""
    trials, less = only_together + only_alone, min(only_together, only_alone)
    tail = sum(math.comb(trials, k) for k in range(less + 1)) / 2**trials
    return min(1.0, 2 * tail)


def without_hands(scene):
    """What a crowd without hands sets in a resolved scene: {JSON pointer: value}."""
    held = [i for i, group in enumerate(scene["crowd"]["groups"]) if group["hand_in_hand"] != "none"]
    if not held:
        raise UsageError("no group of the scene walks hand in hand; allowed: a scene with hand_in_hand in a group")
    return {f"/crowd/groups/{i}/hand_in_hand": "none" for i in held}


def worst_states(rows):
    """{group: [the worst state of each]} of the lines of an agents.csv, in their order."""
    worst = {}
    for row in rows:
        worst.setdefault(row["group"], []).append(row["worst_state"])
    return worst


def compared(scene, seed, together, alone):
    """A line of the table for each group and measure: {group: [the worst state of each]} with hands and without."""
    for group, with_hands in together.items():
        for measure, lost in MEASURES.items():
            pairs = [(a not in lost, b not in lost) for a, b in zip(with_hands, alone[group])]
            yield dict(zip(COLUMNS, (scene, group, measure, seed, len(pairs), sum(a for a, _ in pairs),
                                     sum(b for _, b in pairs), sum(a and not b for a, b in pairs),
                                     sum(b and not a for a, b in pairs))))


def run(name, options):
    """The lines of all seeds of a scene, or None if the run failed."""
    out = options.out / label(name)
    out.mkdir(parents=True, exist_ok=True)
    alone = without_hands(resolved(name, *options.common))
    crowds = [{"name": f"{way}-seed{seed}", "set": {"/seed": seed, **changes}, "pictures": False}
              for seed in options.seeds for way, changes in (("together", {}), ("alone", alone))]
    (out / "crowds.json").write_text(json.dumps(crowds, indent=1))
    command = [*module_command("wade.run.pair"), name, "--out", out, "--crowds", out / "crowds.json", *options.common,
               "--attach-timeout-s", PATIENCE_S, "--step-timeout-s", PATIENCE_S]
    with plain_file.create(out / "run.log") as log:
        if subprocess.run(command, stdout=log, stderr=log).returncode != 0:
            say_error(f"wade together: {name} failed, see {out / 'run.log'}")
            return None
    worst = {crowd["name"]: worst_states(read_csv(out / crowd["name"] / "agents.csv")) for crowd in crowds}
    return [row for seed in options.seeds
            for row in compared(label(name), seed, worst[f"together-seed{seed}"], worst[f"alone-seed{seed}"])]


def summary(rows):
    """The table that is printed, a line a scene, group and measure."""
    lines = []
    for kind in dict.fromkeys((row["scene"], row["group"], row["measure"]) for row in rows):
        own = [row for row in rows if (row["scene"], row["group"], row["measure"]) == kind]
        differences = [row["together"] - row["alone"] for row in own]
        mean, low, high = bootstrap_mean(differences)
        if low is not None:
            low, high = mean_of_alike(differences, max(row["people"] for row in own)) or (low, high)
        interval = "" if low is None else f" ({low:.1f} .. {high:.1f})"
        only = [sum(row[key] for row in own) for key in ("only_together", "only_alone")]
        people, *means = (sum(row[key] for row in own) / len(own) for key in ("people", "together", "alone"))
        lines.append((*kind, f"{people:g}", *(f"{value:.1f}" for value in means), f"{mean:.1f}{interval}",
                      *map(str, only), f"{mcnemar(*only):.2g}"))
    return markdown(("scene", "group", "measure", "people", "together", "alone", "difference", "only together",
                     "only alone", "p"), lines)


def parse(arguments):
    common = []
    if "--" in arguments:
        at = arguments.index("--")
        arguments, common = arguments[:at], arguments[at + 1 :]
    parser = Parser("together", __doc__, """Behind -- stand options of the runs, for example -- --set /channel/velocity_m_s=1.

Exit code: 0 if all runs ended well, 1 if one did not, 2 bad usage or scene.""")
    parser.add_argument("scenes", nargs="*", metavar="SCENE", default=["models/hand_in_hand"],
                        help="files or short names [models/hand_in_hand]")
    parser.add_argument("--seeds", type=seed_range, default=range(1, 21), metavar="A-B", help="of the people [1-20]")
    parser.add_argument("--out", type=Path, default=RUNS / "together", metavar="DIR",
                        help="[runs/together in the project]")
    options = parser.parse_args(arguments)
    options.common = common
    return options


def main(arguments):
    """tools/wade together."""
    options = parse(arguments)
    tables = [run(find_scene(name), options) for name in options.scenes]
    rows = [row for table in tables if table for row in table]
    write_csv(options.out / "together.csv", COLUMNS, [[row[key] for key in COLUMNS] for row in rows])
    say(summary(rows))
    return 1 if None in tables else 0
