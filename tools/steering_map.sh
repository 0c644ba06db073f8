#!/usr/bin/env bash
# Measures what the weights of the steering water mean as properties of a fluid.
set -euo pipefail
# shellcheck source=tools/build.bash
. "$(dirname "${BASH_SOURCE[0]}")/build.bash"

help_if_asked "$@" <<'HELP'
Usage: tools/steering_map.sh [--out DIR] [PART ...]

Runs small scenes of configs/models and writes tables, plots and a page to DIR (default: steering_map):
  rest        spacing, density and depth of water at rest over the radius of separation and the weight of cohesion
  viscosity   apparent viscosity between planes (fit of a parabola) over the weight of cohesion and over the loss
  settling    time until the kinetic energy is 1e-4 of its largest, over the losses
  dam         dam break over a dry bed, error against Ritter and CPU time beside DFSPH
Without PART all of them, about ten minutes. Builds the program first. Exit code: 0, 1 for an error, 2 for a mistake in the options.
HELP

out=steering_map
parts=()
while [ $# -gt 0 ]; do
    case "$1" in
        --out) out="${2:?steering_map.sh: --out needs a folder}"; shift 2 ;;
        rest | viscosity | settling | dam) parts+=("$1"); shift ;;
        *) echo "steering_map.sh: $1; allowed: --out DIR, rest, viscosity, settling, dam" >&2; exit 2 ;;
    esac
done

build_with_tests steering_map || { echo "steering_map.sh: the build failed" >&2; exit 1; }
mkdir -p "$out"
program="$(find "$build" -name steering_map -type f -perm -u+x | head -n 1)"
"$program" "$out" ${parts[@]+"${parts[@]}"}
exec /usr/bin/python3 "$root/tests/steering/report.py" "$out"
