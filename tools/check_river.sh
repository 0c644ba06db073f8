#!/usr/bin/env bash
# Runs the recirculating river for 300 simulated seconds and checks mass, depth, speed in tiles and driving force.
set -euo pipefail
# shellcheck source=tools/build.bash
. "$(dirname "${BASH_SOURCE[0]}")/build.bash"

case "${1:-}" in
  -h | --help)
    cat <<'HELP'
Usage: tools/check_river.sh [--fine]

Runs the river of configs/river at v_F 0.5, 1.5 and 2.5 m/s for 300 simulated seconds at the default spacing, or with
--fine at 0.25 m (v_F 1.5 m/s, 10 m of the channel); takes about 12 and 5 minutes on two cores. Prints areal mass, mean
depth, bulk speed, the worst 10 m x 3 m tile and the driving acceleration; exit code 0 if all are within their limits.
HELP
    exit 0
    ;;
esac

"$root/tools/install_dependencies.sh"
lock_build_folder
configure_release -DWADE_BUILD_TESTS=ON
ninja -C "$build" test_validation >&2
unlock_build_folder
export GOMP_SPINCOUNT=${GOMP_SPINCOUNT:-2000}
if [ "${1:-}" = --fine ]; then
  exec "$build/tests/validation/test_validation" "[river_fine]"
fi
exec "$build/tests/validation/test_validation" "[river_default]"
