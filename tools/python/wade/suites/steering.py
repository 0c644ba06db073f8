"""Measures what the weights of the steering water mean as properties of a fluid, in small scenes of configs/models.

Parts: rest, spacing, density and depth over the radius of separation and the weight of cohesion;
viscosity, apparent viscosity between planes over the weights of cohesion and of the loss; settling,
time until the kinetic energy is 1e-4 of its largest, over the losses; dam, a dam break over a dry
bed, error against Ritter and CPU time beside DFSPH. All of them take about ten minutes.
"""

import math
import subprocess

from wade import progress
from wade.paths import BUILD
from wade.reports import options
from wade.reports.files import publish, say, write_whole
from wade.reports.plots import panels, save
from wade.reports.tables import document, markdown, read_csv, section, write_csv

PARTS = ("rest", "viscosity", "settling", "dam")
HEAD = """# What the weights of the steering water mean

Written by `tools/wade steering`. Lengths in spacings d, velocities in U, U^2 = g H + V^2 (`/fluid/steering` in
`docs/scene_keys.md`). [What follows from it](README.md).
"""


def rows_of(path):
    """Rows of a table, its numbers as numbers; none without the file."""
    rows = read_csv(path) if path.exists() else []
    return [{key: value if key == "model" else float(value) for key, value in row.items()} for row in rows]


def number(value):
    if math.isnan(value):
        return "plug"
    if math.isinf(value):
        return "more than 20"
    return f"{value:.0f}" if value >= 1000 else f"{value:.3g}"


def table(rows, columns):
    """columns: (key, title)."""
    cells = [[row[key] if key == "model" else number(row[key]) for key, _ in columns] for row in rows]
    return markdown([title for _, title in columns], cells)


def line_over(axes, rows, key, curves):
    """curves: (column, style, label)."""
    for column, style, label in curves:
        axes.plot([row[key] for row in rows], [row[column] for row in rows], style, label=label)
    axes.legend(fontsize=8)


REST = (("separation_radius_d", "radius of separation, d"), ("cohesion_weight", "weight of cohesion"),
        ("spacing_d", "nearest neighbour, d"), ("density", "density, middle third"),
        ("depth_over_filled", "depth over that filled in"), ("unevenness_d", "unevenness of the surface, d"))
SETTLING = (("loss_weight", "weight of the loss"), ("wall_loss", "loss at walls"), ("time_to_rest_s", "time to rest, s"),
            ("last_over_largest", "kinetic energy after 20 s over the largest"),
            ("energy_growth", "largest growth of the energy, of it"))


def plain_table(title, rows, columns):
    return section(title, table(rows, columns)) if rows else ""


def viscosity(folder):
    rows = rows_of(folder / "viscosity.csv")
    if not rows:
        return ""
    for row in rows:
        # A plug, or too little of the height that shears for a line.
        if row["parabola_viscosity_over_U_d"] < 0:
            row["parabola_viscosity_over_U_d"] = math.nan
        if row["bingham_viscosity_over_U_d"] <= 0:
            row["bingham_viscosity_over_U_d"] = row["yield_stress_over_U2"] = math.nan
    strong = max(r["wall_stress_over_U2"] for r in rows)
    at_strong = [r for r in rows if r["wall_stress_over_U2"] == strong]
    cohesion = sorted((r for r in at_strong if r["loss_weight"] == 0.1), key=lambda r: r["cohesion_weight"])
    loss = sorted((r for r in at_strong if r["cohesion_weight"] == 0), key=lambda r: r["loss_weight"])
    figure, ax = panels(3, labels=[("weight of cohesion", "U d; U^2"), ("weight of the loss", "U d; U^2"),
                                   ("velocity, U", "height, d")])
    for a, some, key in ((ax[0], cohesion, "cohesion_weight"), (ax[1], loss, "loss_weight")):
        line_over(a, some, key, (("parabola_viscosity_over_U_d", "o-", "viscosity, parabola"),
                                 ("bingham_viscosity_over_U_d", "s-", "viscosity, Bingham"),
                                 ("yield_stress_over_U2", "^:", "yield stress, Bingham")))
    profiles = rows_of(folder / "profiles.csv")
    chosen = sorted({(r["cohesion_weight"], r["loss_weight"], r["wall_stress_over_U2"]) for r in profiles})
    for k, key in enumerate(chosen):
        some = [r for r in profiles if (r["cohesion_weight"], r["loss_weight"], r["wall_stress_over_U2"]) == key]
        line, = ax[2].plot([r["velocity_over_U"] for r in some], [r["height_d"] for r in some], ".", color=f"C{k % 10}",
                           label=", ".join(f"{v:g}" for v in key))
        ax[2].plot([r["fit_over_U"] for r in some], [r["height_d"] for r in some], "-", lw=0.8, color=line.get_color())
    ax[2].legend(title="cohesion, loss,\nwall stress", fontsize=7, loc="center left", bbox_to_anchor=(1, 0.5))
    save(figure, folder / "viscosity.png")
    columns = [("cohesion_weight", "weight of cohesion"), ("loss_weight", "weight of the loss"),
               ("wall_stress_over_U2", "stress at the planes, U^2"),
               ("parabola_viscosity_over_U_d", "viscosity by a parabola, U d"),
               ("residual", "residual, of the span"), ("bingham_viscosity_over_U_d", "viscosity by Bingham, U d"),
               ("yield_stress_over_U2", "yield stress, U^2"), ("sheared", "share of the height that shears"),
               ("slip_over_U", "slip, U"), ("peak_over_U", "peak, U")]
    return section("Apparent viscosity between planes", "![](viscosity.png)", table(rows, columns))


def dam(folder):
    rows = rows_of(folder / "dam.csv")
    if not rows:
        return ""
    figure, ax = panels(2, labels=[("s / H", "depth / H"), ("s / H", "velocity / sqrt(g H)")])
    profiles = rows_of(folder / "dam_profiles.csv")
    for model in ("dfsph", "steering"):
        some = [r for r in profiles if r["model"] == model]
        for a, column in zip(ax, ("depth", "velocity")):
            a.plot([r["s"] for r in some], [r[column] for r in some], ".-", linewidth=0.7, label=model)
            if model == "dfsph":
                a.plot([r["s"] for r in some], [r[f"exact_{column}"] for r in some], "k-", linewidth=1, label="Ritter")
            a.legend(fontsize=8)
    save(figure, folder / "dam.png")
    columns = [("model", "model"), ("spacing_m", "spacing, m"), ("particles", "particles"),
               ("depth_l1", "depth, L1 over H"),
               ("speed_l1", "speed, L1 over sqrt(g H)"), ("tip_lag", "lag of the tip"),
               ("cpu_s", "CPU time of the steps, s"),
               ("steps", "steps"), ("particle_steps_per_cpu_s", "particle-steps a CPU second")]
    return section("Dam break over a dry bed, against Ritter (1892)", "![](dam.png)", table(rows, columns))


def write(folder):
    """report.md, its pictures, and steering.csv."""
    rows = [(name, k, key, value) for name in ("rest", "viscosity", "settling", "dam")
            for k, row in enumerate(read_csv(folder / f"{name}.csv") if (folder / f"{name}.csv").exists() else [], 1)
            for key, value in row.items()]
    write_csv(folder / "steering.csv", ("table", "row", "quantity", "value"), rows)
    write_whole(folder / "report.md", document(
        HEAD, plain_table("Spacing and density at rest", rows_of(folder / "rest.csv"), REST), viscosity(folder),
        plain_table("Time to rest", rows_of(folder / "settling.csv"), SETTLING), dam(folder)))


def main(arguments):
    parser = options.parser_of("steering", "steering", __doc__, "steering.csv")
    parser.add_argument("parts", nargs="*", choices=[[], *PARTS], metavar="PART",
                        help="only these of " + ", ".join(PARTS))
    parser.add_argument("--report-only", action="store_true", help="measure nothing: the report of the tables in DIR")
    chosen = parser.parse_args(arguments)
    chosen.out.mkdir(parents=True, exist_ok=True)
    if not chosen.report_only:
        parts = chosen.parts or (["rest", "dam"] if chosen.quick else [])
        program = next(BUILD.rglob("steering_map"))
        for part in progress.over(parts or PARTS, "measures the parts"):
            code = subprocess.run([program, chosen.out, part]).returncode
            if code != 0:
                return code
    write(chosen.out)
    say(f"report: {chosen.out / 'report.md'}, table: {chosen.out / 'steering.csv'}")
    if chosen.publish:
        publish(chosen.out, "steering", "steering.csv")
    return 0
