#!/usr/bin/env bash
# Sweeps the settings of the water and sets the error of each beside what it costs.
set -euo pipefail
# shellcheck source=tools/build.bash
. "$(dirname "${BASH_SOURCE[0]}")/build.bash"

help_if_asked "$@" <<'HELP'
Usage: tools/speed_vs_error.sh [--quick] [--out DIR] [--cases A,B] [--spacings N] [--repeats N] [--time-limit S]
                               [--splishsplash PROGRAM]

Runs cases of the validation suite, among them the impulse of the water on people, at three spacings and with other
tolerances of both solves, fewest iterations of the density solve, CFL numbers, kernels and numbers of threads: one at a
time around the default, then joined where each alone lies near the front. Writes DIR/speed_vs_error.csv, DIR/report.md
("for an error below x choose this") and a plot of error over CPU time for each error. Takes hours; a run that is there
already, of the same program and scenes, is not repeated.

Columns of speed_vs_error.csv, a line a point and error: case, model; spacing_m; tolerance of the density solve; cfl; threads;
particles; cpu_s_per_sim_s and wall_s_per_sim_s of the solver, medians of the repeats; particle_steps_per_s of wall time;
error_metric, error; on_front, yes if nothing cheaper is as exact; min_iterations of the density solve; divergence_tolerance
("off" without that solve); kernel; repeats; is_default, yes for the default settings at this spacing; failure, why a run
has no result.

  --quick                 two spacings, few settings, one run each: two minutes
  --out DIR               [runs/speed_vs_error in the project]
  --cases A,B             only these
  --spacings N            only the N coarsest spacings of each case, 1 to 3 [3]
  --repeats N             runs of each point; its cost is their median [3, quick: 1]
  --time-limit S          wall time after which a run is given up, s [3600]; a larger limit tries it again.
                          A spacing whose default is expected to take more CPU time is left out and named
  --splishsplash PROGRAM  measures the front of the impulse case with SPlisHSPlasH too: the program that
                          tools/splishsplash/build.sh makes
HELP

"$root/tools/install_dependencies.sh" || exit 1
build_with_tests validate crowd_client || { echo "speed_vs_error.sh: the build failed" >&2; exit 1; }
exec /usr/bin/python3 "$root/tools/speed_vs_error" --validate "$build/validate" "$@"
