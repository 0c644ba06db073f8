"""How well the choice of the model holds, see tools/model_choice.sh --help."""

import argparse
import csv
import io
import sys
from pathlib import Path

import plot
import report
import runs
import scenes

HEADER = (
    "scene,demand,kind,chosen,pilot,went_up,estimated_median,estimated_p95,actual_median,actual_p95,held,default_median,"
    "particle_steps,cpu_s_per_sim_s,cost_over_default,choice_cpu_s,refused"
).split(",")


def cost(document):
    return document["solver_cpu_s"] / document["simulated_s"]


def row_of(name, demand, truth, default, choice, get):
    """A line of the table; None if the run is not there."""
    row = {"scene": name, "demand": f"{demand:g}"}
    default_median, _ = runs.median_and_p95(runs.standing_of(default), truth)
    row["default_median"] = f"{default_median:.4g}"
    if "refused" in choice:
        return row | {"refused": choice["refused"]}
    document = get(scenes.file_of(name), choice["overrides"])
    if document is None:
        return None
    if "error" in document:
        raise SystemExit(f"model_choice: {name} as chosen: {document['error']}")
    median, p95 = runs.median_and_p95(runs.standing_of(document), truth)
    return row | {
        "kind": choice["kind"],
        "chosen": choice["chosen"],
        "pilot": choice["pilot"],
        "went_up": "yes" if choice["went_up"] else "no",
        "estimated_median": f"{choice['estimated_median']:.4g}",
        "estimated_p95": f"{choice['estimated_p95']:.4g}",
        "actual_median": f"{median:.4g}",
        "actual_p95": f"{p95:.4g}",
        "held": "yes" if median <= demand else "no",
        "particle_steps": f"{document['particle_steps']:.6g}",
        "cpu_s_per_sim_s": f"{cost(document):.4g}",
        "cost_over_default": f"{cost(document) / cost(default):.3g}",
        "choice_cpu_s": f"{choice['cpu_s']:.2g}",
    }


def rows_of(name, get):
    """The lines of a scene; `get` answers a run, or None if it is not there. Demands with the same choice share a run."""
    scene = scenes.file_of(name)
    finest, default = get(scene, scenes.finest_overrides(name)), get(scene, [])
    if finest is None or default is None:
        return []
    for document in (finest, default):
        if "error" in document:
            raise SystemExit(f"model_choice: {scene}: {document['error']}")
    truth = runs.standing_of(finest)
    rows = [row_of(name, d, truth, default, runs.choose(scene, d), get) for d in scenes.demands(name)]
    return [row for row in rows if row is not None]


def write(rows, out, names):
    text = io.StringIO()
    writer = csv.DictWriter(text, HEADER, lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    runs.write_whole(out / "model_choice.csv", text.getvalue())
    plot.write(rows, out / "estimate_against_actual.png")
    runs.write_whole(out / "report.md", report.text(rows, names))


def main():
    parser = argparse.ArgumentParser(prog="tools/model_choice.sh")
    parser.add_argument("--programs", type=Path, default=runs.PROGRAM.parent, help="folder of fluid_server and impulse_scene")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--out", type=Path, default=runs.ROOT / "runs" / "model_choice")
    parser.add_argument("--report-only", action="store_true")
    options = parser.parse_args()
    runs.PROGRAM, runs.SERVER = options.programs / "impulse_scene", options.programs / "fluid_server"
    names = scenes.QUICK if options.quick else list(scenes.FINEST)

    def get(scene, overrides):
        return runs.run(scene, overrides, options.out / "runs", only_stored=options.report_only)

    rows = []
    for name in names:
        rows += rows_of(name, get)
        if rows:
            write(rows, options.out, names)
    if not rows:
        sys.exit(f"model_choice: no runs in {options.out / 'runs'}")
    print(options.out / "report.md")


if __name__ == "__main__":
    main()
