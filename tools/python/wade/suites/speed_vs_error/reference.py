"""Makes the reference of an impulse case: runs it at a fine spacing and stores what each agent met."""

import json
import subprocess
import tempfile
from pathlib import Path

from wade.paths import ROOT
from wade.reports.files import say, write_whole

DATA = ROOT / "tests" / "validation" / "data"
# Columns of the curves that `validate` writes, and the curve of each table.
TABLES = {"standing": ("impulse", 4), "walking": ("outcome", 5)}


def heading(run):
    return [f"# Reference of the case {run['case']}: a run of our own at a spacing of {run['spacing_m']:g} m, "
            f"{run['particles']} particles, {run['steps']} steps, {run['cpu_s']:.0f} s of CPU; not a measurement.",
            f"# Commit {run['git']}, {run['compiler']}. Made by tools/wade speed-vs-error --reference {run['case']} "
            f"--spacing {run['spacing_m']:.10g}"]


def make(program, case, spacing, threads):
    with tempfile.TemporaryDirectory() as scratch:
        command = [program, "--case", case, "--spacing", spacing, "--no-reference", "--threads", str(threads)]
        if subprocess.run([*command, "--out", scratch]).returncode != 0:
            raise ValueError(f"--reference {case} --spacing {spacing}: the run failed")
        run = json.loads(next((Path(scratch) / "runs").glob(f"{case}-spacing-*.json")).read_text())
        for name, (curve, columns) in TABLES.items():
            file = next(c["file"] for c in run["curves"] if c["name"] == curve)
            rows = (Path(scratch) / "runs" / file).read_text().splitlines()
            lines = heading(run) + [",".join(row.split(",")[:columns]) for row in rows]
            write_whole(DATA / f"{case}_{name}.csv", "\n".join(lines) + "\n")
            say(DATA / f"{case}_{name}.csv")
    return 0
