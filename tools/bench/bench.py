#!/usr/bin/env python3
"""Runs the benchmarks one after the other, merges what they measure, compares and reports; tools/bench.sh calls it."""

import argparse
import os
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

import end_to_end  # noqa: E402
import features  # noqa: E402
import kernels  # noqa: E402
from machine import machine, machine_text  # noqa: E402
from results import comparison, read, summary, write  # noqa: E402

# Program, what its names begin with, whether it takes --only and --threads.
PROGRAMS = (
    ("bench_kernels", ("machine/", "kernels/"), False),
    ("bench_fluid", ("fluid/",), True),
    ("bench_shallow_water", ("shallow_water/",), True),
    ("bench_steering", ("steering/",), True),
    ("bench_crowd", ("crowd/",), False),
    ("bench_coupling", ("coupling/",), True),
    ("bench_protocol", ("protocol/",), True),
)


def arguments():
    parser = argparse.ArgumentParser(prog="tools/bench.sh", add_help=False)
    parser.add_argument("--programs", required=True)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--only", default="")
    parser.add_argument("--threads", type=int, default=0)
    parser.add_argument("--json")
    parser.add_argument("--compare")
    parser.add_argument("--out")
    parser.add_argument("--from", dest="source")
    chosen = parser.parse_args()
    if chosen.source and not chosen.out:
        parser.error("--from needs --out")
    if chosen.threads < 0:
        parser.error(f"--threads {chosen.threads}, allowed: 1 or more")
    return chosen


def may_match(prefix, only):
    return prefix.startswith(only) or only.startswith(prefix)


def run_program(program, chosen, takes_all):
    """Its results; raises if it fails."""
    with tempfile.TemporaryDirectory(prefix="wade-bench-") as folder:
        file = Path(folder) / "results.json"
        if program.name == "bench_kernels":
            command = kernels.command(program, file, chosen.only, chosen.quick)
        else:
            command = [program, "--json", file] + (["--quick"] if chosen.quick else [])
        if takes_all and chosen.only:
            command += ["--only", chosen.only]
        if takes_all and chosen.threads:
            command += ["--threads", chosen.threads]
        # The kernels' own table shows rates in units that are hard to read; ours follows at the end.
        quiet = subprocess.DEVNULL if program.name == "bench_kernels" else None
        done = subprocess.run([str(word) for word in command], stdout=quiet, stderr=quiet)
        if done.returncode != 0:
            raise RuntimeError(f"ended with exit code {done.returncode}")
        found = read(file)
        return kernels.results_of(found) if program.name == "bench_kernels" else found["results"]


def measure(chosen):
    """All results that are wanted, and whether all went well."""
    results, well = [], True
    folder = Path(chosen.programs) / "tests" / "bench"
    for name, prefixes, takes_all in PROGRAMS:
        program = folder / name
        if not program.exists() or not any(may_match(prefix, chosen.only) for prefix in prefixes):
            continue
        print(f"\n== {name}", flush=True)
        try:
            found = run_program(program, chosen, takes_all)
        except (RuntimeError, OSError, ValueError) as error:
            print(f"bench.sh: {name}: {error}", file=sys.stderr)
            well = False
            continue
        results += [r for r in found if r["name"].startswith(chosen.only)]
    wanted = lambda name: name.startswith(chosen.only)  # noqa: E731
    for prefix, title, room in (
        ("features/", "features", lambda: features.measure(chosen.programs, wanted, chosen.quick)),
        ("end_to_end/", "whole runs", lambda: end_to_end.measure(chosen.programs, wanted, chosen.quick, chosen.threads)),
    ):
        if may_match(prefix, chosen.only):
            print(f"\n== {title}", flush=True)
            found, fine = room()
            results, well = results + found, well and fine
    return results, well


def main():
    chosen = arguments()
    before = None
    if chosen.compare:
        try:
            before = read(chosen.compare)["results"]
        except (OSError, ValueError, KeyError) as error:
            print(f"bench.sh: --compare {chosen.compare}: {error}", file=sys.stderr)
            return 2
    if chosen.source:
        import page  # matplotlib is slow to load

        try:
            before = read(chosen.source)
            page.write_page(Path(chosen.out), before["machine"], before["results"], chosen.quick)
        except (OSError, ValueError, KeyError) as error:
            print(f"bench.sh: --from {chosen.source}: {error}", file=sys.stderr)
            return 2
        return 0
    here = machine()
    print(machine_text(here))
    if here["busy"]:
        print("warning: other programs use this machine; times are too long, only ratios within a program mean something")
    results, well = measure(chosen)
    if not results:
        print(f'bench.sh: --only {chosen.only}: no benchmark begins like this', file=sys.stderr)
        return 1 if not well else 2
    print()
    print("\n".join(summary(results)))
    if before is not None:
        print(f"\nBeside {chosen.compare}:")
        print("\n".join(comparison(before, results)))
    here["load_at_end"] = os.getloadavg()[0]
    if chosen.json:
        write(chosen.json, here, results)
    if chosen.out:
        import page  # matplotlib is slow to load

        write(Path(chosen.out) / "bench.json", here, results)
        page.write_page(Path(chosen.out), here, results, chosen.quick)
        print(f"\npage: {Path(chosen.out) / 'bench.md'}")
    return 0 if well else 1


if __name__ == "__main__":
    sys.exit(main())
