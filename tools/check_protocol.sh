#!/usr/bin/env bash
# The long form of what the tests show about the protocol; about twenty minutes, --quick: some minutes.
set -euo pipefail
# shellcheck source=tools/build.bash
. "$(dirname "${BASH_SOURCE[0]}")/build.bash"

kills=500 fuzz_runs=3000000 rounds=20 model=()
case "${1:-}" in
  "") ;;
  --quick) kills=60 fuzz_runs=200000 rounds=2 model=(--quick) ;;
  *)
    echo "Usage: tools/check_protocol.sh [--quick]"
    echo "Model checking, random kills, ThreadSanitizer, fuzzing, and the conformance of every producer, one after another."
    [ "$1" = -h ] || [ "$1" = --help ]
    exit
    ;;
esac

"$root/tools/install_dependencies.sh"
lock_build_folder
configure_release -DWADE_BUILD_TESTS=ON
ninja -C "$build" >&2
unlock_build_folder

failed=()
# part TITLE COMMAND...: runs on after a failure, so that one report shows all.
part() {
  echo
  echo "== $1"
  shift
  "$@" || failed+=("$1")
}

part "Model checking" "$root/tools/check_model.sh" "${model[@]}"
part "$kills random kills" /usr/bin/python3 "$root/tests/protocol/kills/kill_test.py" \
  --peer "$build/tests/protocol/kills/kill_peer" --runs "$kills"
part "Races, and mutants that must be caught ($rounds rounds)" \
  ctest --test-dir "$build" --output-on-failure -R protocol_races --repeat "until-fail:$rounds"
part "Fuzzing" "$root/tools/fuzz.sh" --runs "$fuzz_runs"
part "The latest frame, long form" "$build/tests/unit/shm_protocol/test_shm_protocol" "[long]"
part "Conformance of every producer" ctest --test-dir "$build" --output-on-failure -R conformance

echo
if [ ${#failed[@]} -gt 0 ]; then
  echo "FAILED: ${failed[*]}"
  exit 1
fi
echo "All of it holds."
