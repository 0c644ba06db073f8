#!/usr/bin/env bash
# Builds the release preset with its tests and runs them; options go to ctest, for example: tools/test.sh -R unit -V
set -euo pipefail
# shellcheck source=tools/build.bash
. "$(dirname "${BASH_SOURCE[0]}")/build.bash"

case "${1:-}" in
  -h | --help)
    echo "Usage: tools/test.sh [ctest options]"
    echo "Installs missing packages, builds the release preset and its tests, runs ctest; its exit code is ctest's."
    exit 0
    ;;
esac

"$root/tools/install_dependencies.sh"
lock_build_folder
configure_release -DWADE_BUILD_TESTS=ON
echo "Building programs and tests (release)" >&2
ninja -C "$build" >&2
unlock_build_folder

export CTEST_PARALLEL_LEVEL=${CTEST_PARALLEL_LEVEL:-$(nproc)}
exec ctest --test-dir "$build" --output-on-failure "$@"
