#!/usr/bin/env bash
# Runs a scene with both programs: installs and builds what is missing, starts the pair, waits, draws the picture.
set -euo pipefail
# shellcheck source=tools/build.bash
. "$(dirname "${BASH_SOURCE[0]}")/build.bash"

for argument in "$@"; do
  if [ "$argument" = --help ] || [ "$argument" = -h ]; then
    cat <<'HELP'
Usage: tools/run.sh [SCENE] [--out DIR] [--no-figure] [any option of the two programs]

Runs SCENE (default configs/paper/s05.json): installs missing packages, builds a release build if needed, starts
fluid_server and crowd_client, waits for both, prints the outcome and draws DIR/figure.png.

  --out DIR        run folder [runs/<scene>-<time>/ in the project]; the server's log is DIR/fluid_server.log
  --session NAME   name under which the two programs meet [a unique one]
  --no-figure      do not draw figure.png
  --check          only check the scene
Other options go to the program, or both programs, that have them; see
build/release/fluid_server --help and build/release/crowd_client --help.

Exit code: 0 if both programs ended well and the picture is drawn, else that of the program that failed first:
1 unexpected, 2 bad configuration or usage, 3 attach time-out, 4 peer dead, 5 peer aborted, 6 protocol violation,
7 step time-out, 8 name in use, 9 numerical failure, 130/143 interrupted.
HELP
    exit 0
  fi
done

"$root/tools/install_dependencies.sh" || exit 1
build_programs || { echo "run.sh: the build failed" >&2; exit 1; }
exec /usr/bin/python3 "$root/tools/run_pair.py" --programs "$build" "$@"
