#!/usr/bin/env bash
# Runs the hard cases of the fluid and the crowd with every solver setting. Writes stability.csv and report.md.
set -euo pipefail
# shellcheck source=tools/build.bash
. "$(dirname "${BASH_SOURCE[0]}")/build.bash"

help_if_asked "$@" <<'HELP'
Usage: tools/stability.sh [--quick] [--out DIR] [--cases A,B] [--settings S,T] [--long] [--jobs N] [--again]

Runs each hard case (configs/stability) with each solver setting, and sweeps the CFL factor and the tolerance of the
density solve in three of them. Writes DIR/stability.csv, DIR/report.md with plots, and DIR/runs/ with the numbers of
each run.

  --quick         small forms, at the default settings and at CFL 1, no sweeps; a minute or two. Its runs lie beside
                  those of the full form (DIR/runs/quick, DIR/runs/full); table and report are of the last form asked for
  --out DIR       [runs/stability in the project]
  --cases A,B     only these; patterns such as 'tank*' may stand for several
  --settings S,T  only these, for example default,cfl_1
  --long          a million steps in the case `leak`
  --jobs N        runs side by side, one thread each [number of processors]
  --again         repeats runs that are complete
  --list          lists the cases and the settings, and ends
A run that is complete and whose program and scenes are still the same is not repeated. The program counts by its bytes
without the commit that it names: a commit, or changes not yet committed, repeat runs only if they change what is computed.

Columns of stability.csv: case, setting, model; steps of the solver; max_density_error, the compression max(0, rho/rho_0 - 1)
of the worst single particle in any step; energy_ratio, energy over what was there or put in, the largest of all steps;
lost_particles; nonfinite; max_displacement_over_spacing, the longest way of a particle in a step; pass, yes or no; remark, what
is broken; mean_density_error, the compression as mean over the particles, the largest of all steps. The rule on compression
(1 %) is about the mean: single particles at edges and in splashes may have more.

Exit code 1: a run left no result, or a run at one of the settings (default, cfl_1, ...) breaks a rule and is not a known
failure (tests/stability/known_failures.csv). Runs of the sweeps do not count: they look for what breaks. Exit
code 2: wrong options; 130, 143: interrupted; the same command then goes on.
HELP

"$root/tools/install_dependencies.sh" || exit 1
build_with_tests stability || { echo "stability.sh: the build failed" >&2; exit 1; }
exec /usr/bin/python3 "$root/tools/stability/stability.py" --program "$build/stability" "$@"
