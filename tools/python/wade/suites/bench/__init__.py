"""Measures the water, the crowd, the coupling, the protocol and whole runs, each several times.

Prints medians with counts of the work and the errors beside them. On a busy machine only ratios
within a program mean something. Names: fluid/river, fluid/river_quartic_spline, fluid/growth,
fluid/dam_break, fluid/dam_break_733_steps, fluid/column_at_rest, shallow_water/..., steering/...,
crowd/..., coupling/contacts, coupling/two_way, coupling/measured, protocol/..., kernels/...,
machine/..., end_to_end/s05, end_to_end/s05_depth_1, end_to_end/river_s05, end_to_end/fine,
end_to_end/people_5000, end_to_end/town, end_to_end/beside_busy_programs, end_to_end/pairs_at_once.

--json has {machine, results: [{name, size, threads, median, min, max, unit, ...}]}. --out writes
bench.json, bench.csv and report.md with its pictures: rates and errors, profile of a step by
stages, goals, and how far from what the processor and the memory of this machine allow.
Exit code: 0, 1 if a part failed (the others are still measured), 2 for a mistake in the options.
"""

import os
import subprocess
import tempfile
from pathlib import Path

from wade import progress
from wade.paths import BUILD
from wade.reports import options
from wade.reports.files import complain, publish, say
from wade.reports.machine import machine, machine_text
from wade.suites.bench import end_to_end
from wade.suites.bench.results import comparison, kernel_command, kernel_results, read, summary, write, write_table
from wade.terminal import wrapped

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


def parse(arguments):
    parser = options.parser_of("bench", "bench", __doc__, "bench.csv")
    parser.set_defaults(out=None)
    parser.add_argument("--only", default="", metavar="NAME",
                        help="names that begin with NAME, for example fluid/river")
    parser.add_argument("--threads", type=options.whole(1), metavar="N",
                        help="this number of threads only [one, and as many as there are processors]")
    parser.add_argument("--rvo2", type=Path, metavar="PROGRAM",
                        help="the crossing crowd beside RVO2 and nothing else: a program built from tools/rvo2/crossing.cpp")
    parser.add_argument("--json", metavar="FILE", help="write the results to FILE")
    parser.add_argument("--compare", metavar="FILE", help="how many times as fast as in FILE, which --json has written")
    parser.add_argument("--from", dest="source", metavar="FILE",
                        help="measure nothing: the page of --out anew from the bench.json of another day")
    chosen = parser.parse_args(arguments)
    if chosen.rvo2:
        if not chosen.rvo2.is_file() or chosen.only:
            parser.error(f"--rvo2 {chosen.rvo2}: allowed: a program built from tools/rvo2/crossing.cpp, without --only")
        chosen.only = "crowd/crossing"
    if (chosen.source or chosen.publish) and not chosen.out:
        parser.error("--from and --publish need --out")
    return chosen


def may_match(prefix, only):
    return prefix.startswith(only) or only.startswith(prefix)


def run_program(program, chosen, takes_all):
    """Its results; raises if it fails."""
    with tempfile.TemporaryDirectory(prefix="wade-bench-") as folder:
        file = Path(folder) / "results.json"
        if program.name == "bench_kernels":
            command = kernel_command(program, file, chosen.only, chosen.quick)
        else:
            command = [program, "--json", file] + (["--quick"] if chosen.quick else [])
        if chosen.rvo2:
            command += ["--rvo2", chosen.rvo2.resolve()]
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
        return kernel_results(found) if program.name == "bench_kernels" else found["results"]


def measure(chosen):
    """All results that are wanted, and whether all went well."""
    results, well = [], True
    wanted = [(BUILD / "tests" / "bench" / name, takes_all) for name, prefixes, takes_all in PROGRAMS
              if any(may_match(prefix, chosen.only) for prefix in prefixes)]
    for program, takes_all in progress.over([one for one in wanted if one[0].exists()], "runs the programs of benchmarks"):
        name = program.name
        say(f"\n== {name}")
        try:
            results += [r for r in run_program(program, chosen, takes_all) if r["name"].startswith(chosen.only)]
        except (RuntimeError, OSError, ValueError) as error:
            complain(f"bench: {name}: {error}")
            well = False
    if may_match("end_to_end/", chosen.only):
        say("\n== whole runs")
        found, fine = end_to_end.measure(chosen.only, chosen.quick, chosen.threads)
        results, well = results + found, well and fine
    return results, well


def write_page(chosen, here, results):
    from wade.suites.bench import page  # matplotlib is slow to load

    write_table(chosen.out / "bench.csv", results)
    page.write(chosen.out, here, results, chosen.quick)
    say(f"\npage: {chosen.out / 'report.md'}")
    if chosen.publish:
        publish(chosen.out, "bench", "bench.csv")


def main(arguments):
    chosen = parse(arguments)
    before = []
    for file in filter(None, (chosen.compare, chosen.source)):
        try:
            known = read(file)
            before = known["results"]
        except (OSError, ValueError, KeyError) as error:
            complain(f"bench: {file}: {error}")
            return 2
    if chosen.source:
        write_page(chosen, known["machine"], before)
        return 0
    here = machine()
    say(wrapped(machine_text(here)))
    if here["busy"]:
        say(wrapped("warning: other programs use this machine; times are too long, only ratios within a program mean something"))
    results, well = measure(chosen)
    if not results:
        complain(f"bench: --only {chosen.only}: no benchmark begins like this")
        return 1 if not well else 2
    say(f"\n{summary(results)}")
    if chosen.compare:
        say(f"\nBeside {chosen.compare}:\n{comparison(before, results)}")
    here["load_at_end"] = os.getloadavg()[0]
    for file in filter(None, (chosen.json and Path(chosen.json), chosen.out and chosen.out / "bench.json")):
        write(file, here, results)
    if chosen.out:
        write_page(chosen, here, results)
    return 0 if well else 1
