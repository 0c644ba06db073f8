#!/usr/bin/env bash
# Runs the scenarios S1 to S12 of the paper and sets the results beside its Table 1.
set -euo pipefail
# shellcheck source=tools/build.bash
. "$(dirname "${BASH_SOURCE[0]}")/build.bash"

for argument in "$@"; do
  case "$argument" in
    -h | --help)
      # Needs neither packages nor a build, so that help is always at hand.
      cat <<'HELP'
Usage: tools/reproduce_paper.sh [--out DIR] [--seeds N] [--quick] [--set-of-scenes paper|river|observed|both]
                                [--threads N] [--until-s T]

Runs S1 to S12 of configs/paper (as the authors ran it) and configs/river (as the paper describes it), one after
another; writes DIR/table1.csv, DIR/report.md and a run folder with a picture for each run; prints the table and,
below it, whether the results are those of the paper where these can be told apart.

  --out DIR             [runs/reproduce_paper in the project]
  --seeds N             runs of each scene, with the seeds 1 to N [1]
  --quick               only S1, S4, S5 and S8
  --set-of-scenes SET   paper, river, observed or both (paper and river) [both]
  --threads N           threads of the fluid server [2]
  --until-s T           simulated time at which each run ends, s [the scene's, 400]; such runs are not judged
A run in DIR that is complete and whose scene is still the same is not repeated. Scenes that were not run, as with
--quick, have no part in the verdict. Exit code 1: a run failed, or the verdict has a no.
HELP
      exit 0
      ;;
  esac
done

"$root/tools/install_dependencies.sh" || exit 1
build_programs || { echo "reproduce_paper.sh: the build failed" >&2; exit 1; }
exec /usr/bin/python3 "$root/tools/paper/reproduce.py" --programs "$build" "$@"
