#!/usr/bin/env bash
# Fuzzes what readers do with a header page of unknown origin (libFuzzer, AddressSanitizer, UBSan; needs clang).
set -euo pipefail

usage() {
  cat <<'HELP'
Usage: tools/wade fuzz [--runs N] [--quick] [--merge]

Builds tests/fuzz/fuzz_header.cpp with clang and runs it on the inputs in tests/fuzz/corpus.tar.gz:
N inputs (default 3000000), with --quick 100000. New inputs go to a temporary folder; --merge adds
those that reach new code to the kept corpus, minimised. An input that breaks an expectation is kept
as fuzz_header-crash-* in the current folder; give that file to the program to see it again. Exit
code 0 without a finding, 1 with one, 77 without clang and its fuzzer library.
HELP
}

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
kept=$root/tests/fuzz/corpus.tar.gz
runs=3000000
merge=false
while [ $# -gt 0 ]; do
  case "$1" in
    -h | --help) usage; exit 0 ;;
    --quick) runs=100000 ;;
    --merge) merge=true ;;
    --runs)
      runs=${2:-}
      if ! [[ $runs =~ ^[1-9][0-9]*$ ]]; then
        echo "fuzz: --runs needs a number above 0, not \"$runs\"" >&2
        exit 2
      fi
      shift
      ;;
    *) echo "fuzz: unexpected argument \"$1\"; see --help" >&2; exit 2 ;;
  esac
  shift
done

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
compiler=${CLANGXX:-clang++}
echo 'extern "C" int LLVMFuzzerTestOneInput(const unsigned char*, unsigned long) { return 0; }' >"$work/probe.cpp"
if ! command -v "$compiler" >/dev/null ||
  ! "$compiler" -fsanitize=fuzzer,address "$work/probe.cpp" -o "$work/probe" 2>/dev/null; then
  echo "fuzz: skipped, no clang with libFuzzer is installed (Debian packages clang and libclang-rt-14-dev)"
  exit 77
fi

flags=(-std=c++20 -O2 -g -Wall -Wextra -Werror "-I$root")
# The checksum is most of the work and none of the question: no sanitizers there.
"$compiler" "${flags[@]}" -c "$root/shm_protocol/inside/bytes/crc32c.cpp" -o "$work/crc32c.o"
"$compiler" "${flags[@]}" -fsanitize=fuzzer,address,undefined -fno-sanitize-recover=all \
  "$root/tests/fuzz/fuzz_header.cpp" "$root/shm_protocol/inside/header.cpp" "$root/shm_protocol/inside/bytes/text.cpp" "$work/crc32c.o" -o "$work/fuzz_header"
if $merge; then
  "$compiler" "${flags[@]}" "$root/tests/fuzz/header_seeds.cpp" "$root/shm_protocol/inside/header.cpp" "$root/shm_protocol/inside/bytes/text.cpp" "$work/crc32c.o" \
    -o "$work/header_seeds"
  mkdir "$work/seeds"
  "$work/header_seeds" "$work/seeds"
fi

corpus=$work/corpus
mkdir "$work/new" "$corpus"
tar -C "$corpus" -xzf "$kept"
here=$PWD
longest=4097 # a byte of repairs and a page
if ! "$work/fuzz_header" -runs="$runs" -max_len="$longest" -artifact_prefix="$here/fuzz_header-" \
  "$work/new" "$corpus" >"$work/log" 2>&1; then
  grep -v '^#[0-9]*[[:space:]]*\(NEW\|REDUCE\|pulse\)' "$work/log" | tail -n 60 >&2
  exit 1
fi
grep 'DONE' "$work/log"
if $merge; then
  mkdir "$work/merged"
  "$work/fuzz_header" -merge=1 -max_len="$longest" "$work/merged" "$work/seeds" "$corpus" "$work/new" >/dev/null 2>&1
  corpus=$work/merged
  tar -C "$corpus" --sort=name --mtime=@0 --owner=0 --group=0 --numeric-owner -c . | gzip -9n >"$kept"
fi
echo "fuzz_header: $(find "$corpus" -type f | wc -l) inputs in the corpus, $runs runs, nothing found"
