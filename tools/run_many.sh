#!/usr/bin/env bash
# Runs many scenes, or one with many seeds, several pairs of programs at once.
set -euo pipefail
# shellcheck source=tools/build.bash
. "$(dirname "${BASH_SOURCE[0]}")/build.bash"

help_if_asked "$@" <<'HELP'
Usage: tools/run_many.sh [--jobs N] [--out DIR] [--seeds A-B] [--figures] SCENE... [-- options of every run]

Runs each SCENE, or each with each of the seeds A to B, N pairs of fluid_server and crowd_client at once, each pair in a
session of its own. Prints a line for each run that ends and a table at the end; writes DIR/summary.csv and a run
folder for each run, with what its programs said in run.log.

  --jobs N       pairs at once [half the processors, at least 1]
  --out DIR      [runs/many-<time>/ in the project]
  --seeds A-B    whole numbers, for example 1-8, or a single one [the scene's own seed]
  --figures      draw figure.png of each run
Behind -- stand options for every run, for example -- --until-s 60 --set /crowd/tau=0.3; see tools/run.sh --help. Not
allowed are --out, --session, --record and --commands, which each run needs for itself, --crowds, and --seed
and --set /seed beside --seeds. Unless --threads is among them, the pairs share the processors evenly. A run that fails does not stop
the others; Ctrl-C ends all of them.

Exit code: 0 if all runs ended well, 1 if one did not, 2 bad usage, 130/143 interrupted.
HELP

"$root/tools/install_dependencies.sh" || exit 1
build_programs || { echo "run_many.sh: the build failed" >&2; exit 1; }
exec /usr/bin/python3 "$root/tools/run_many.py" --programs "$build" "$@"
