#!/usr/bin/env bash
# How much the outcome depends on the frame rate, with each coupling rule.
set -euo pipefail
# shellcheck source=tools/build.bash
. "$(dirname "${BASH_SOURCE[0]}")/build.bash"

for argument in "$@"; do
  case "$argument" in
    -h | --help)
      # Needs neither packages nor a build, so that help is always at hand.
      cat <<'HELP'
Usage: tools/frame_rates.sh [SCENE...] [--out DIR] [--seeds N] [--rates A,B] [--vary both|frames|steps]
                            [--sampling-rate-hz R] [--threads N]

Runs each scene (default: S5, S7 and S10 of configs/observed) at 15, 30, 60 and 120 frames/s, with as many steps of the
crowd, with the coupling rules per_frame and continuous, and without water (tau 0). Prints arrivals and times with 95 %
intervals; writes DIR/frame_rates.csv, DIR/report.md and DIR/runs/. Kinematic water is the same at all rates; the solved
models make other water at each, and the report says so. Events must be given by time_s.

  --out DIR      [runs/frame_rates in the project]
  --seeds N      seeds of the markers, 1 to 1000 [10]
  --rates A,B    at least two frame rates, 0.01 to 1000 Hz [15,30,60,120]
  --vary WHAT    frames: how often the water is sampled, with the steps of the crowd at the highest rate; steps: those
                 of the crowd, with the frames at the highest rate; both [both]
  --sampling-rate-hz R
                 also the rule continuous with the water sampled R times a second within its steps
  --threads N    of the crowds and the water [number of processors]

Exit code: 0 if all runs ended well, whether the rates agree or not; 1 if one failed, which makes its scene incomplete;
2 bad usage or scene.
HELP
      exit 0
      ;;
  esac
done

"$root/tools/install_dependencies.sh" || exit 1
build_programs || { echo "frame_rates.sh: the build failed" >&2; exit 1; }
exec /usr/bin/python3 "$root/tools/frame_rates.py" --programs "$build" "$@"
