#!/usr/bin/env bash
# Measures what the parts cost and prints the machine beside it; on a busy machine only the ratios mean something.
set -euo pipefail
# shellcheck source=tools/build.bash
. "$(dirname "${BASH_SOURCE[0]}")/build.bash"

help_if_asked "$@" <<'HELP'
Usage: tools/bench.sh [--quick] [--only NAME] [--threads N] [--json FILE] [--compare FILE] [--out DIR] [--from FILE]

Measures the water, the crowd, the coupling, the protocol and whole runs, each several times, and prints medians with
counts of the work and the errors beside them. Builds the programs first.

  --quick         fewer rounds, no case of a million particles, 20 s of the whole run
  --only NAME     names that begin with NAME, for example fluid/river, coupling, end_to_end
  --threads N     this number of threads only [one, and as many as there are processors]
  --json FILE     the results as {machine, results: [{name, size, threads, median, min, max, unit, ...}]}
  --compare FILE  how many times as fast as in FILE, which --json has written, by name, size and threads
  --out DIR       DIR/bench.json and the page DIR/bench.md with its pictures: rates and errors, profile of a step by
                  stages, goals, and how far from what the processor and the memory of this machine allow
  --from FILE     measures nothing: writes the page of --out anew from the bench.json of another day

Names: fluid/river, fluid/river_quartic_spline, fluid/growth, fluid/dam_break, fluid/dam_break_733_steps, fluid/column_at_rest, shallow_water/..., steering/..., crowd/..., coupling/contacts,
protocol/..., kernels/..., machine/..., features/..., end_to_end/s05, end_to_end/s05_depth_1, end_to_end/river_s05, end_to_end/fine.
Exit code: 0, 1 if a part failed (the others are still measured), 2 for a mistake in the options.
HELP

programs=(bench_fluid bench_shallow_water bench_steering bench_crowd bench_coupling bench_kernels bench_protocol)

"$root/tools/install_dependencies.sh" || exit 1
build_with_tests fluid_server crowd_client "${programs[@]}" || { echo "bench.sh: the build failed" >&2; exit 1; }
exec /usr/bin/python3 "$root/tools/bench/bench.py" --programs "$build" "$@"
