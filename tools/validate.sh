#!/usr/bin/env bash
# Runs the validation cases: water and people whose behaviour is known. Writes validation.csv and report.md.
set -euo pipefail
# shellcheck source=tools/build.bash
. "$(dirname "${BASH_SOURCE[0]}")/build.bash"

for argument in "$@"; do
  case "$argument" in
    -h | --help)
      # Needs neither packages nor a build, so that help is always at hand.
      cat <<'HELP'
Usage: tools/validate.sh [--quick] [--out DIR] [--cases A,B] [--levels L,M] [--long] [--jobs N] [--again]

Runs each validation case at its coarse, medium and fine resolution and compares it with what is known: analytic
solutions, published experiments and tables. Writes DIR/validation.csv, DIR/report.md with a plot a case and the
observed order of convergence, and DIR/runs/ with the numbers of each run.

  --quick       only the quick cases, at one resolution each, as the tests run them; a few minutes
  --out DIR     [runs/validation in the project]
  --cases A,B   only these; patterns such as 'wet_bed*' may stand for several
  --levels L,M  only these of coarse, medium and fine
  --long        also what takes hours: finest resolutions and rivers of 600 s
  --jobs N      runs side by side, one thread each [number of processors]
  --again       repeats runs that are complete
  --list        lists the cases and ends
A run that is complete and whose program and scenes are still the same is not repeated, so that the command goes on where it
was stopped. Exit code 1: a run failed, or a value is above its threshold and not among the known failures.
HELP
      exit 0
      ;;
  esac
done

"$root/tools/install_dependencies.sh" || exit 1
lock_build_folder
if ! grep -q '^WADE_BUILD_TESTS:BOOL=ON' "$build/CMakeCache.txt" 2>/dev/null; then
  configure_release -DWADE_BUILD_TESTS=ON
fi
unlock_build_folder
build_programs validate || { echo "validate.sh: the build failed" >&2; exit 1; }
exec /usr/bin/python3 "$root/tools/validation/validate.py" --program "$build/validate" "$@"
