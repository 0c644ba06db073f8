"""Writes fluid_server/model_choice/table.csv, the table of the server's choice of a model, from measurements.

tests/validation/data/model_choice.csv holds the measurements. speed-vs-error made those of dfsph and of the kinematic
stream, which also checked the choices. This module measures the rest.
"""

import csv
import io
import json
import re

from wade.paths import ROOT
from wade.reports.files import write_whole
from wade.reports.tables import read_csv, write_csv
from wade.suites.model_choice.runs import command_of, median_and_p95, read_standing, run, standing_of, store_standing

TABLE = ROOT / "fluid_server" / "model_choice" / "table.csv"
DATA = ROOT / "tests" / "validation" / "data"
MEASURED = DATA / "model_choice.csv"
NOTE_OF_MEASURED = ("# Errors of the impulse on people who stand, and costs, from which `tools/wade model-choice --table` makes "
                    "the table of the choice.\n")
FINEST = 0.09284  # m, of the finest runs made here: a fifth of the paper's spacing
# kind of water: the scene that measures it, its finest run and the spacing of that, m.
SCENES = {
    "river": ("configs/validation/impulse_river.json", DATA / "impulse_river_standing.csv", 0.09284),
    "dry_front": ("configs/validation/impulse_front.json", DATA / "impulse_front_standing.csv", 0.0773667),
    "wet_front": ("configs/model_choice/table_wet_front.json", DATA / "table_wet_front_standing.csv", FINEST),
    "inflow": ("configs/model_choice/table_inflow.json", DATA / "table_inflow_standing.csv", FINEST),
    "lee": ("configs/validation/impulse_lee.json", DATA / "impulse_lee_standing.csv", 0.09284),
}
OF_SPEED_VS_ERROR = ("river", "dry_front", "lee")
SPACINGS = (0.4642, 0.2321, 0.1161)  # m
GRAVITY = 9.81  # m/s2
SEEDS = range(2, 9)  # chance of the models that draw particles at random; 1 is the scenes' own
ERRORS = ("impulse_median", "impulse_p95")
SETTINGS = ("model", "spacing_m", "tolerance", "divergence_tolerance", "cfl", "kernel")
DEFAULT = ("0.0005", "0.001", "0.5", "cubic_spline")
COLUMNS = ("kind", *SETTINGS, "chance", "particles", "particle_steps", "simulated_s", "solver_cpu_s", *ERRORS, "source")
HEADER = ("kind", *SETTINGS, *ERRORS, "steps_per_s", "us_per_particle_step", "wave_speed_m_s")
NOTE = """\
# From which the server chooses a model, see table.hpp. Written by `tools/wade model-choice --table`, not by hand.
# Errors of the impulse on people who stand, relative to a fine run of dfsph, in water 1 m deep and with a contact distance of
# 0.25 m. A row has the largest error that chance makes of it: of dfsph at least that of the default of its spacing, also with
# gravity changed by 0.01 %, of kinematic and shallow_water that of eight seeds. Of dfsph it is then divided by
# 1 - d_finest / d, as the finest run, of spacing d_finest, has an error, too, unless a finer run became worse than a coarser
# one by that.
"""


def water(model, spacing, cfl=0.5, chance=""):
    """Values of a run, with room for 14 m x 6 m x 1 m and an eighth more, at least what the emitter needs at 0.4642 m."""
    values = [f"/fluid/model={model}", f"/fluid/particle_spacing_m={spacing:g}"]
    if model == "shallow_water":
        values.append(f"/fluid/shallow_water/cell_size_m={spacing:g}")
    values.append(f"/fluid/cfl={cfl:g}")
    if chance.startswith("seed "):
        values.append(f"/seed={chance.removeprefix('seed ')}")
    elif chance:
        values.append(f"/world/gravity_m_s2={GRAVITY * (1 + float(chance.removeprefix('gravity '))):.10g}")
    return [*values, f"/fluid/max_particles={max(1200, int(84 * 1.125 / spacing**3))}"]


def points():
    """What is measured here: (kind, model, spacing, cfl, what is left to chance), the cheap ones first."""
    wanted = []
    for kind in SCENES:
        for d in SPACINGS:
            wanted.append((kind, "shallow_water", d, 0.5, ""))
            if d > 0.2:
                wanted.append((kind, "steering", d, 0.5, ""))
                wanted += [(kind, "dfsph", d, 0.5, f"gravity {change:g}") for change in (-1e-4, 1e-4)]
                models = ("shallow_water", "kinematic") if kind == "river" else ("shallow_water",)
                wanted += [(kind, model, d, 0.5, f"seed {seed}") for model in models for seed in SEEDS]
            if kind not in OF_SPEED_VS_ERROR or (d < 0.2 and kind != "dry_front"):
                wanted += [(kind, "dfsph", d, cfl, "") for cfl in (1.0, 0.5)]
    return sorted(wanted, key=lambda p: p[1] == "dfsph" and p[2] < 0.2)


def finest(kind, folder):
    scene, table, _ = SCENES[kind]
    if not table.exists():
        overrides = water("dfsph", FINEST)
        document = run(scene, overrides, folder)
        if "error" in document:
            raise SystemExit(f"model-choice: the finest run of {scene} failed: {document['error']}")
        store_standing(document, command_of(scene, overrides), table)
    return read_standing(table)


def measured_row(point, folder):
    """A row of what is measured; None if the run failed."""
    kind, model, d, cfl, chance = point
    document = run(SCENES[kind][0], water(model, d, cfl, chance), folder)
    if "error" in document:
        return None
    solved = (*DEFAULT[:2], f"{cfl:g}", DEFAULT[3]) if model == "dfsph" else [""] * 4
    costs = (f"{document[key]:.10g}" for key in ("particle_steps", "simulated_s", "solver_cpu_s"))
    errors = (f"{error:.6g}" for error in median_and_p95(standing_of(document), finest(kind, folder)))
    return dict(zip(COLUMNS,
                    [kind, model, f"{d:g}", *solved, chance, document["particles"], *costs, *errors, "impulse_scene"]))


def measure(folder):
    """Measures anew what speed-vs-error lacks, and keeps the rows of speed-vs-error."""
    rows = [row for point in points() if (row := measured_row(point, folder))]
    rows += [row for row in read_csv(MEASURED) if row["source"] == "speed-vs-error"]
    write_csv(MEASURED, COLUMNS, rows)
    write_whole(MEASURED, NOTE_OF_MEASURED + MEASURED.read_text())


def read_points():
    """{(kind, settings): values}, and errors that differ by chance, {(kind, model, spacing): [errors]}."""
    known, chance = {}, {}
    for row in read_csv(MEASURED):
        errors = {name: float(row[name]) for name in ERRORS}
        if row["chance"]:
            chance.setdefault((row["kind"], row["model"], row["spacing_m"]), []).append(errors)
            continue
        steps = float(row["particle_steps"])
        known[row["kind"], *(row[name] for name in SETTINGS)] = errors | {
            "steps_per_s": steps / float(row["particles"]) / float(row["simulated_s"]),
            "us_per_particle_step": 1e6 * float(row["solver_cpu_s"]) / steps,
        }
    return known, chance


def wave_speed(kind):
    """sqrt(g depth) + v_F of the scene that measured a kind, m/s."""
    scene = json.loads(re.sub(r"^\s*//.*$", "", (ROOT / SCENES[kind][0]).read_text(), flags=re.M))
    channel = scene["channel"]
    depth = max([block["depth_m"] for block in channel.get("water_blocks", [])] or [channel.get("depth_m", 1)])
    return (scene["world"]["gravity_m_s2"] * depth) ** 0.5 + channel.get("velocity_m_s", 0)


def beyond_finest(kind, model, spacing):
    """Returns the error of dfsph over its error against the finest run, which has an error itself.

    If errors are proportional to the spacing, two runs differ by 1 - d_finest / d times the coarser one's error.
    """
    return 1 / (1 - SCENES[kind][2] / spacing) if model == "dfsph" else 1.0


def table_text():
    known, chance = read_points()
    kinds = list(SCENES)
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(HEADER)
    estimates = {}  # of the next coarser spacing
    for key in sorted(known, key=lambda k: (kinds.index(k[0]), k[1], *k[3:], -float(k[2]))):
        kind, model, spacing = key[:3]
        values = []
        for name in ERRORS:
            same = [known[key], *chance.get((kind, model, spacing), [])]
            if model == "dfsph":
                same.append(known.get((kind, model, spacing, *DEFAULT), known[key]))
            error = max(point[name] for point in same)
            # The addition for the finest run's own error does not make a finer run worse than a coarser one.
            coarser = estimates.get((kind, model, *key[3:], name), float("inf"))
            values.append(min(error * beyond_finest(kind, model, float(spacing)), max(error, coarser)))
            estimates[kind, model, *key[3:], name] = values[-1]
        values += [known[key]["steps_per_s"], known[key]["us_per_particle_step"], wave_speed(kind)]
        writer.writerow([*key, *(f"{value:.4g}" for value in values)])
    return NOTE + out.getvalue()
