#!/usr/bin/env python3
"""Runs the scenarios of the paper and sets the results beside its Table 1.

tools/reproduce_paper.sh calls it once the programs are built. Standard library only.
"""

import argparse
import json
import subprocess
import sys
from pathlib import Path

from paper_report import Run, read_paper, report_text, table_rows, write_table
from paper_verdict import checks_of, verdict_text
from run_pair import ROOT, Pair

QUICK = ("S1", "S4", "S5", "S8")
SETS = ("paper", "river")
MORE_SETS = ("observed",)  # cheap, not judged


def scene_file(scene_set, scenario):
    return ROOT / "configs" / scene_set / f"s{int(scenario[1:]):02d}.json"


def resolved_scene(programs, scene, options):
    """The scene as the programs will run it; exits with their code if they refuse it."""
    answer = subprocess.run(
        [programs / "crowd_client", scene, *options, "--print-config"], stdout=subprocess.PIPE, text=True
    )
    if answer.returncode != 0:
        sys.exit(answer.returncode)
    return json.loads(answer.stdout)


def what_counts(scene):
    """The scene without the words that change no result."""
    return {key: value for key, value in scene.items() if key not in ("name", "description")}


def is_done(folder, scene):
    """Whether the folder holds a complete run of this very scene."""
    try:
        outcome = json.loads((folder / "outcome.json").read_text())
        manifest = json.loads((folder / "manifest.json").read_text())
    except (OSError, ValueError):
        return False
    complete = outcome.get("status") == "completed" and (folder / "agents.csv").exists()
    return complete and what_counts(manifest.get("resolved_scene") or {}) == what_counts(scene)


def run_scene(pair, programs, scene, options, folder):
    """Runs one pair; returns its exit code. On a terminal its progress is shown, else it goes to run.log."""
    folder.mkdir(parents=True, exist_ok=True)
    launcher = ["/usr/bin/python3", ROOT / "tools" / "run_pair.py", "--programs", programs]
    command = [*launcher, scene, "--out", folder, *options]
    with open(folder / "run.log", "w", encoding="utf-8") as log:
        process = pair.start(command, stdout=log, stderr=None if sys.stderr.isatty() else log)
        return process.wait()


def parse(arguments):
    parser = argparse.ArgumentParser(prog="reproduce_paper.sh", allow_abbrev=False, add_help=False)
    parser.add_argument("--programs", type=Path, required=True)
    parser.add_argument("--out", type=Path, default=ROOT / "runs" / "reproduce_paper")
    parser.add_argument("--seeds", type=int, default=1)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--set-of-scenes", choices=(*SETS, *MORE_SETS, "both"), default="both")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--until-s", type=float)
    options = parser.parse_args(arguments)
    if options.seeds < 1:
        parser.error(f"--seeds: {options.seeds} is out of range; allowed: 1 or more")
    return options


def main():
    options = parse(sys.argv[1:])
    sets = SETS if options.set_of_scenes == "both" else (options.set_of_scenes,)
    paper = read_paper(ROOT / "tools" / "paper_table1.csv")
    scenarios = [name for name in paper if name in QUICK or not options.quick]
    try:
        options.out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        sys.exit(f"reproduce_paper.sh: --out: cannot write to {options.out}: {error.strerror}")

    cut_short = options.until_s is not None
    until = ["--until-s", str(options.until_s)] if cut_short else []
    pair, runs, failures = Pair(), [], []
    for scene_set in sets:
        for scenario in scenarios:
            for seed in range(1, options.seeds + 1):
                scene = scene_file(scene_set, scenario)
                scene_options = ["--seed", str(seed), *until]
                folder = options.out / scene_set / f"{scene.stem}-seed{seed}"
                label = f"{scene_set} {scenario} seed {seed}"
                resolved = resolved_scene(options.programs, scene, scene_options)
                if is_done(folder, resolved):
                    how = "done before"
                else:
                    code = run_scene(
                        pair, options.programs, scene, [*scene_options, "--threads", str(options.threads)], folder
                    )
                    if pair.signal:
                        return code or 130
                    if code != 0 or not is_done(folder, resolved):
                        failures.append(label)
                        print(f"{label}: failed with exit code {code}, see {folder}/run.log", file=sys.stderr)
                        continue
                    how = "run"
                runs.append(Run(scene_set, scenario, seed, folder))
                print(f"{label}: {runs[-1].in_words()} ({how})", file=sys.stderr, flush=True)

    rows = table_rows(runs, paper)
    write_table(options.out / "table1.csv", rows)
    checks = [] if cut_short else checks_of(runs)
    text = report_text(rows, runs, options.out, failures, verdict_text(checks, runs, cut_short))
    (options.out / "report.md").write_text(text, encoding="utf-8")
    print(text)
    print(f"{options.out / 'table1.csv'}, {options.out / 'report.md'}")
    return 1 if failures or not all(check.holds for check in checks) else 0


if __name__ == "__main__":
    sys.exit(main())
