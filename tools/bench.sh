#!/usr/bin/env bash
# Measures what the parts cost and prints the machine beside it; on a busy machine only the ratios mean something.
set -euo pipefail
# shellcheck source=tools/build.bash
. "$(dirname "${BASH_SOURCE[0]}")/build.bash"

case "${1:-}" in
  -h | --help)
    echo "Usage: tools/bench.sh [--quick] [--json FILE]"
    echo "Measures the shared-memory protocol beside memcpy, a unix socket and, where it is installed, ZeroMQ."
    echo "--quick: fewer rounds; --json FILE: the results as {machine, results: [{name, size, threads, median, min, max, unit}]}"
    exit 0
    ;;
esac

"$root/tools/install_dependencies.sh"
lock_build_folder
configure_release -DWADE_BUILD_TESTS=ON
ninja -C "$build" bench_protocol >&2
unlock_build_folder
exec "$build/tests/bench/bench_protocol" "$@"
