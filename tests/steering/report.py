"""Plots and page of the tables that steering_map has written: report.py DIR."""

import csv
import math
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt


def rows_of(path):
    if not path.exists():
        return []
    with open(path, newline="") as file:
        return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]


def number(value):
    if math.isnan(value):
        return "plug"
    if math.isinf(value):
        return "more than 20"
    return f"{value:.0f}" if value >= 1000 else f"{value:.3g}"


def table(rows, columns):
    lines = ["| " + " | ".join(title for _, title in columns) + " |", "|" + "---|" * len(columns)]
    lines += ["| " + " | ".join(number(row[key]) for key, _ in columns) + " |" for row in rows]
    return "\n".join(lines)


def axes(count, titles):
    figure, all_axes = plt.subplots(1, count, figsize=(5 * count, 3.8), squeeze=False)
    for ax, (x, y) in zip(all_axes[0], titles):
        ax.set_xlabel(x)
        ax.set_ylabel(y)
        ax.grid(True, alpha=0.3)
    return figure, all_axes[0]


def save(figure, path):
    figure.tight_layout()
    figure.savefig(path, dpi=110)
    plt.close(figure)


def rest(folder):
    rows = rows_of(folder / "rest.csv")
    if not rows:
        return ""
    base = 0.0
    by_radius = [row for row in rows if row["cohesion_weight"] == base]
    by_cohesion = sorted((r for r in rows if r["separation_radius_d"] == 1.12), key=lambda r: r["cohesion_weight"])
    figure, ax = axes(2, [("radius of separation, d", "spacing, d; density over rest density"),
                          ("weight of cohesion", "spacing, d; density over rest density")])
    for a, some, key in ((ax[0], by_radius, "separation_radius_d"), (ax[1], by_cohesion, "cohesion_weight")):
        x = [row[key] for row in some]
        a.plot(x, [row["spacing_d"] for row in some], "o-", label="nearest neighbour")
        a.plot(x, [row["density"] for row in some], "s-", label="density, middle third")
        a.plot(x, [1 / row["depth_over_filled"] for row in some], "^:", label="filled depth over depth")
        a.legend()
    save(figure, folder / "rest.png")
    columns = [("separation_radius_d", "radius of separation, d"), ("cohesion_weight", "weight of cohesion"),
               ("spacing_d", "nearest neighbour, d"), ("density", "density, middle third"),
               ("depth_over_filled", "depth over that filled in"),
               ("unevenness_d", "unevenness of the surface, d")]
    return "## Spacing and density at rest\n\n![](rest.png)\n\n" + table(rows, columns) + "\n"


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
    figure, ax = axes(3, [("weight of cohesion", "U d; U^2"), ("weight of the loss", "U d; U^2"), ("velocity, U", "height, d")])
    for a, some, key in ((ax[0], cohesion, "cohesion_weight"), (ax[1], loss, "loss_weight")):
        x = [r[key] for r in some]
        a.plot(x, [r["parabola_viscosity_over_U_d"] for r in some], "o-", label="viscosity, parabola")
        a.plot(x, [r["bingham_viscosity_over_U_d"] for r in some], "s-", label="viscosity, Bingham")
        a.plot(x, [r["yield_stress_over_U2"] for r in some], "^:", label="yield stress, Bingham")
        a.legend(fontsize=8)
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
               ("wall_stress_over_U2", "stress at the planes, U^2"), ("parabola_viscosity_over_U_d", "viscosity by a parabola, U d"),
               ("residual", "residual, of the span"), ("bingham_viscosity_over_U_d", "viscosity by Bingham, U d"),
               ("yield_stress_over_U2", "yield stress, U^2"), ("sheared", "share of the height that shears"),
               ("slip_over_U", "slip, U"), ("peak_over_U", "peak, U")]
    return "## Apparent viscosity between planes\n\n![](viscosity.png)\n\n" + table(rows, columns) + "\n"


def settling(folder):
    rows = rows_of(folder / "settling.csv")
    if not rows:
        return ""
    figure, ax = axes(2, [("time, s", "kinetic energy, J"), ("weight of the loss", "time to rest, s")])
    energy = rows_of(folder / "energy.csv")
    for c, w in sorted({(r["loss_weight"], r["wall_loss"]) for r in energy}):
        some = [r for r in energy if (r["loss_weight"], r["wall_loss"]) == (c, w)]
        ax[0].semilogy([r["time_s"] for r in some], [max(r["kinetic_j"], 1e-12) for r in some], lw=0.8, label=f"{c:g}, {w:g}")
    ax[0].legend(title="loss, walls", fontsize=7)
    for w in sorted({r["wall_loss"] for r in rows}):
        some = sorted((r for r in rows if r["wall_loss"] == w), key=lambda r: r["loss_weight"])
        ax[1].plot([r["loss_weight"] for r in some], [min(r["time_to_rest_s"], 20) for r in some], "o-", label=f"{w:g}")
    ax[1].legend(title="loss at walls", fontsize=7)
    save(figure, folder / "settling.png")
    columns = [("loss_weight", "weight of the loss"), ("wall_loss", "loss at walls"), ("time_to_rest_s", "time to rest, s"),
               ("last_over_largest", "kinetic energy after 20 s over the largest"),
               ("energy_growth", "largest growth of the energy, of it")]
    return "## Time to rest\n\n![](settling.png)\n\n" + table(rows, columns) + "\n"


def dam(folder):
    if not (folder / "dam.csv").exists():
        return ""
    with open(folder / "dam.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    figure, ax = axes(2, [("s / H", "depth / H"), ("s / H", "velocity / sqrt(g H)")])
    with open(folder / "dam_profiles.csv", newline="") as file:
        profiles = list(csv.DictReader(file))
    for model in ("dfsph", "steering"):
        some = [r for r in profiles if r["model"] == model]
        s = [float(r["s"]) for r in some]
        ax[0].plot(s, [float(r["depth"]) for r in some], ".-", lw=0.7, label=model)
        ax[1].plot(s, [float(r["velocity"]) for r in some], ".-", lw=0.7, label=model)
        if model == "dfsph":
            ax[0].plot(s, [float(r["exact_depth"]) for r in some], "k-", lw=1, label="Ritter")
            ax[1].plot(s, [float(r["exact_velocity"]) for r in some], "k-", lw=1, label="Ritter")
    for a in ax:
        a.legend(fontsize=8)
    save(figure, folder / "dam.png")
    titles = {"model": "model", "spacing_m": "spacing, m", "particles": "particles", "depth_l1": "depth, L1 over H",
              "speed_l1": "speed, L1 over sqrt(g H)", "tip_lag": "lag of the tip", "cpu_s": "CPU time of the steps, s", "steps": "steps",
              "particle_steps_per_cpu_s": "particle-steps a CPU second"}
    lines = ["| " + " | ".join(titles.values()) + " |", "|" + "---|" * len(titles)]
    for row in rows:
        lines.append("| " + " | ".join(row[k] if k == "model" else number(float(row[k])) for k in titles) + " |")
    return "## Dam break over a dry bed, against Ritter (1892)\n\n![](dam.png)\n\n" + "\n".join(lines) + "\n"


def main():
    folder = Path(sys.argv[1])
    parts = [part(folder) for part in (rest, viscosity, settling, dam)]
    words = folder / "findings.md"
    head = "# What the weights of the steering water mean\n\nWritten by `tools/steering_map.sh`. Lengths in spacings d, " \
           "velocities in U, U^2 = g H + V^2 (`/fluid/steering` in docs/scene_keys.md).\n"
    text = [head] + ([words.read_text()] if words.exists() else []) + [part for part in parts if part]
    (folder / "report.md").write_text("\n".join(text))


if __name__ == "__main__":
    main()
