#!/usr/bin/env bash
# Compiles the exporter against a checkout of SPlisHSPlasH and links splishsplash_producer if that checkout is built.
set -euo pipefail

if [[ "${1:-}" == -h || "${1:-}" == --help ]]; then
  cat <<'END'
Usage: tools/splishsplash/build.sh [CHECKOUT [BUILD_DIR]]
CHECKOUT   folder of SPlisHSPlasH, default $WADE_SPLISHSPLASH; without one nothing is done, exit code 77
BUILD_DIR  its CMake build folder (generator Unix Makefiles, as there), default CHECKOUT/build
Writes to $WADE_SPLISHSPLASH_OUT, default build/splishsplash. A checkout that is not built is compiled against only;
name the folders of its external headers (GenericParameters, CompactNSearch, Eigen) in CPATH then.
END
  exit 0
fi

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
checkout=${1:-${WADE_SPLISHSPLASH:-}}
if [[ -z "$checkout" ]]; then
  echo "SKIPPED: no checkout of SPlisHSPlasH; give its folder as an argument or in WADE_SPLISHSPLASH"
  exit 77
fi
if [[ ! -f "$checkout/Simulator/Exporter/ExporterBase.h" ]]; then
  echo "build.sh: '$checkout' is no checkout of SPlisHSPlasH: it has no Simulator/Exporter/ExporterBase.h" >&2
  exit 2
fi
checkout=$(cd "$checkout" && pwd)
their_build=${2:-$checkout/build}
out=${WADE_SPLISHSPLASH_OUT:-$root/build/splishsplash}
mkdir -p "$out"
out=$(cd "$out" && pwd)
compiler=${CXX:-g++}
sources=(model_units scene_settings ParticleExporter_Wade splishsplash_producer)

# The flags of the simulator's own program: they decide the layout of its classes. Its headers are not ours to warn of.
make_folder=$their_build/Simulator/CMakeFiles/SPHSimulator.dir
their_flags=(-O2 -fopenmp -isystem "$checkout" -isystem /usr/include/eigen3)
if [[ -f "$make_folder/flags.make" ]]; then
  flag_text=$(sed -n -e 's/^CXX_\(DEFINES\|INCLUDES\|FLAGS\) = //p' "$make_folder/flags.make")
  read -ra their_flags <<<"$(tr '\n' ' ' <<<"$flag_text" | sed -e 's/\(^\| \)-I/ -isystem /g' -e 's/-std=[^ ]*//')"
else
  echo "build.sh: $their_build is not configured with Unix Makefiles, compile check only" >&2
fi
our_flags=(-std=c++20 -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion -Wold-style-cast -Werror)

objects=()
for source in "${sources[@]}"; do
  echo "compiling $source.cpp"
  "$compiler" "${their_flags[@]}" "${our_flags[@]}" -I"$root" -c "$root/tools/splishsplash/$source.cpp" -o "$out/$source.o"
  objects+=("$out/$source.o")
done

their_program=$checkout/bin/SPHSimulator
if [[ ! -f "$make_folder/link.txt" || ! -x "$their_program" ]]; then
  echo "compiled, not linked: $their_build has no SPHSimulator yet"
  exit 0
fi

cmake -S "$root" -B "$out/wade" -G Ninja -DCMAKE_BUILD_TYPE=Release -DWADE_BUILD_TESTS=OFF >"$out/wade.log"
cmake --build "$out/wade" --target configs_json shm_ends >>"$out/wade.log"

# Their link line with our objects in place of theirs, in the folder that it was written for.
read -ra link <<<"$(sed -e 's#[^ ]*main\.cpp\.o#WADE_OBJECTS#' -e 's# -o [^ ]*# -o WADE_OUTPUT#' "$make_folder/link.txt")"
command=()
for word in "${link[@]}"; do
  case "$word" in
    WADE_OBJECTS) command+=("${objects[@]}" "$out"/wade/rooms/configs/libconfigs_json.a
      "$out"/wade/rooms/shm_protocol/libshm_{ends,inside,bytes}.a) ;;
    WADE_OUTPUT) command+=("$out/splishsplash_producer") ;;
    *) command+=("$word") ;;
  esac
done
(cd "$their_build/Simulator" && "${command[@]}")
# Emitters look for their shape beside the program.
ln -sfn "$checkout/bin/resources" "$out/resources"
"$out/splishsplash_producer" --help >/dev/null
echo "linked $out/splishsplash_producer"
