#!/usr/bin/env python3
"""Makes the reference of an impulse case: runs it at a fine spacing and stores what each agent met.

    tools/speed_vs_error/impulse_reference.py --validate build/release/validate --case impulse_front --spacing 0.0774

writes tests/validation/data/<case>_standing.csv and _walking.csv. Standard library only.
"""

import argparse
import json
import os
import subprocess
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
# Columns of the curves that `validate` writes, and the file of each.
TABLES = {"standing": ("impulse", 4), "walking": ("outcome", 5)}


def heading(document):
    return [
        f"# Reference of the case {document['case']}: a run of our own at a spacing of {document['spacing_m']:g} m, "
        f"{document['particles']} particles, {document['steps']} steps, {document['cpu_s']:.0f} s of CPU; not a measurement.",
        f"# Commit {document['git']}, {document['compiler']}. Made by tools/speed_vs_error/impulse_reference.py "
        f"--case {document['case']} --spacing {document['spacing_m']:.10g}"
        + "".join(f" --set {value}" for value in document["overrides"]),
    ]


def store(runs, document, folder):
    for name, (curve, columns) in TABLES.items():
        rows = (runs / next(c["file"] for c in document["curves"] if c["name"] == curve)).read_text().splitlines()
        lines = heading(document) + [",".join(row.split(",")[:columns]) for row in rows]
        file = folder / f"{document['case']}_{name}.csv"
        part = file.with_suffix(".part")
        part.write_text("\n".join(lines) + "\n")
        os.replace(part, file)
        print(file)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--case", required=True)
    parser.add_argument("--spacing", required=True, help="m")
    parser.add_argument("--validate", type=Path, default=ROOT / "build" / "release" / "validate")
    parser.add_argument("--set", action="append", default=[], metavar="/PTR=VALUE")
    parser.add_argument("--threads", default=str(os.cpu_count()))
    parser.add_argument("--runs", type=Path, help="use a run that is done: DIR/runs of `validate --out DIR`")
    parser.add_argument("--into", type=Path, default=ROOT / "tests" / "validation" / "data")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        runs = options.runs
        if runs is None:
            command = [options.validate, "--case", options.case, "--spacing", options.spacing]
            command += ["--no-reference", "--threads", options.threads]
            for value in options.set:
                command += ["--set", value]
            subprocess.run([*command, "--out", scratch], check=True)
            runs = Path(scratch) / "runs"
        documents = [json.loads(file.read_text()) for file in sorted(runs.glob(f"{options.case}-spacing-*.json"))]
        spacing = float(options.spacing)
        fitting = [d for d in documents if abs(d["spacing_m"] - spacing) < 1e-9 and d["status"] == "completed"]
        if not fitting:
            parser.error(f"--spacing {options.spacing}: {runs} holds no completed run of {options.case} at it")
        options.into.mkdir(parents=True, exist_ok=True)
        store(runs, fitting[0], options.into)


if __name__ == "__main__":
    main()
