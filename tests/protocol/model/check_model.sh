#!/usr/bin/env bash
# Searches the SPIN models of the protocol: the sound ones must have no error, each mutant the one meant for it.
set -euo pipefail

usage() {
  cat <<'HELP'
Usage: tools/wade check-model [--quick] [MODEL]

Searches the state spaces of tests/protocol/model (or of one MODEL of it: lockstep, memory_order,
latest) and prints a line for each search: verdict, states, depth, seconds, definitions. --quick
leaves out the searches marked long in tests/protocol/model/runs.txt, which take up to MEMORY_MB
(default 8000) of memory and some minutes each, and makes as many at once as there are processors.
Exit code 0 if every sound model is without error, every mutant refuted and no search cut short; 77
without spin.
HELP
}

models=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
memory_mb=${MEMORY_MB:-8000}
form=long
only=
while [ $# -gt 0 ]; do
  case "$1" in
    -h | --help) usage; exit 0 ;;
    --quick) form=quick ;;
    -*) echo "check-model: unexpected argument \"$1\"; see --help" >&2; exit 2 ;;
    *)
      only=$1
      if [ ! -f "$models/$only.pml" ]; then
        echo "check-model: there is no model \"$only\" in tests/protocol/model" >&2
        exit 2
      fi
      ;;
  esac
  shift
done
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
echo 'active proctype probe() { skip }' >"$work/probe.pml"
if ! (cd "$work" && spin -a probe.pml && [ -f pan.c ]) >"$work/said" 2>&1; then
  echo "check-model: skipped, spin is not installed or does not work (Debian package spin): $(tail -n 1 "$work/said")"
  exit 77
fi

# search FOLDER EXPECTATION MODEL DEFINITIONS...: leaves pan's report in FOLDER/report
search() {
  local folder=$1 model=$3 optimise=-O0 # a small search is over before a better compilation would pay
  if [ "$2" = sound ] && [ "$model" = lockstep ] && [ "$form" = long ]; then optimise=-O2; fi
  shift 3
  cd "$folder"
  spin -a "$@" "$models/$model.pml" >report 2>&1 || return
  # No check for cycles: nothing here may loop for ever without a step of another process, and such waits are sleeps.
  gcc $optimise -w -DSAFETY -DVECTORSZ=512 "-DMEMLIM=$memory_mb" -o pan pan.c >>report 2>&1 || return
  ./pan -m1000000 >>report 2>&1
}

# judge EXPECTATION REPORT: what the report amounts to
judge() {
  local report=$2
  if ! grep -q 'errors: ' "$report"; then
    echo "FAIL: no result"
  elif grep -q 'max search depth too small\|Search not completed\|out of memory\|pan: reached -DMEMLIM' "$report" &&
    [ "$1" = sound ]; then
    echo "FAIL: cut short"
  elif grep -q 'assertion violated' "$report"; then
    [ "$1" = assertion ] && echo refuted || echo "FAIL: $(grep -o 'assertion violated.*' "$report")"
  elif grep -q 'invalid end state (at depth' "$report"; then
    [ "$1" = deadlock ] && echo refuted || echo "FAIL: waits for ever"
  elif grep -q 'errors: 0' "$report"; then
    [ "$1" = sound ] && echo sound || echo "FAIL: not refuted"
  else
    echo "FAIL: another error"
  fi
}

count() { # of states or depth in a report; one without it is a failure that judge has seen
  { grep -o "$1" "$2" || echo 0; } | grep -o '[0-9.e+]*[0-9]' | head -1
}

# run FOLDER EXPECTATION MODEL DEFINITIONS...: one search and its line; the end of a failed one on the error output
run() {
  local folder=$1 expectation=$2 began=$SECONDS verdict
  (search "$@") || true
  verdict=$(judge "$expectation" "$folder/report")
  printf '%-28s %11.0f %6s %5s  %s\n' "$verdict" "$(count '[0-9.e+]* states, stored' "$folder/report")" \
    "$(count 'depth reached [0-9]*' "$folder/report")" $((SECONDS - began)) "${*:3}"
  case "$verdict" in
    FAIL*)
      touch "$folder/failed"
      tail -n 5 "$folder/report" >&2
      ;;
  esac
  rm -f "$folder"/pan* "$folder"/*.trail
}

searches=0
jobs=1 # the large searches share the memory
if [ "$form" = quick ]; then jobs=$(nproc); fi
printf '%-28s %11s %6s %5s  %s\n' verdict states depth s model
while read -r when expectation model definitions; do
  case "$when" in "" | "#"*) continue ;; esac
  if [ "$form" = quick ] && [ "$when" = long ]; then continue; fi
  if [ -n "$only" ] && [ "$only" != "$model" ]; then continue; fi
  while [ "$(jobs -rp | wc -l)" -ge "$jobs" ]; do wait -n || true; done
  mkdir "$work/$searches"
  # shellcheck disable=SC2086  # the definitions are words
  run "$work/$searches" "$expectation" "$model" $definitions &
  searches=$((searches + 1))
done <"$models/runs.txt"
wait
failures=$(find "$work" -name failed | wc -l)
echo "$searches searches, $failures failed"
[ "$failures" -eq 0 ] && [ "$searches" -gt 0 ]
