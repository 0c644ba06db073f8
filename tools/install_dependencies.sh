#!/usr/bin/env bash
# Installs the packages that the build, the pictures and the tests need; does nothing when all are there.
set -euo pipefail

# set, and the package's name on Debian and Ubuntu, on Fedora and in Homebrew; - where there is none that fits.
packages='
build     g++                 gcc-c++              gcc
build     cmake               cmake                cmake
build     ninja-build         ninja-build          ninja
build     git                 git                  git
build     python3             python3              python
build     libeigen3-dev       eigen3-devel         eigen
build     libboost-dev        boost-devel          boost
build     nlohmann-json3-dev  json-devel           nlohmann-json
build     libcli11-dev        cli11-devel          cli11
build     libhwy-dev          highway-devel        highway
build     libgeos-dev         geos-devel           geos
build     libsqlite3-dev      sqlite-devel         sqlite
build     libwslay-dev        wslay-devel          wslay
build     libzstd-dev         libzstd-devel        zstd
build     libtiff-dev         libtiff-devel        libtiff
pictures  python3-numpy       python3-numpy        numpy
pictures  python3-matplotlib  python3-matplotlib   python-matplotlib
pictures  python3-pil         python3-pillow       pillow
pictures  python3-tabulate    python3-tabulate     -
pictures  python3-scipy       python3-scipy        python-scipy
tests     catch2              catch2-devel         -
tests     libbenchmark-dev    google-benchmark-devel  google-benchmark
tests     spin                -                    -
tests     clang               clang                llvm
tests     libclang-rt-14-dev  compiler-rt          llvm
tests     libzmq3-dev         zeromq-devel         zeromq
tests     pkgconf             pkgconf              pkgconf
tests     help2man            help2man             help2man
tests     dpkg-dev            dpkg-dev             dpkg
tests     python3-jsonschema  python3-jsonschema   -
tests     clang-format        clang-tools-extra    clang-format
tests     clang-tidy          clang-tools-extra    llvm
tests     shellcheck          ShellCheck           shellcheck
tests     pyflakes3           python3-pyflakes     pyflakes
readers   python3-vtk9        -                    -
readers   python3-meshio      -                    -
readers   python3-skimage     python3-scikit-image -
readers   blender             blender              -
readers   ffmpeg              ffmpeg               ffmpeg
readers   gdal-bin            gdal                 gdal
readers   mono-mcs            -                    -
readers   mono-runtime        -                    -
viewer    chromium            chromium             -
engines   parallel            parallel             parallel
engines   openmpi-bin         openmpi              open-mpi
engines   libopenmpi-dev      openmpi-devel        open-mpi
engines   slurmctld           slurm-slurmctld      -
engines   slurmd              slurm-slurmd         -
engines   slurm-client        slurm                -
engines   munge               munge                munge
builds    g++-aarch64-linux-gnu  -                 -
builds    qemu-user           -                    -
builds    mmdebstrap          -                    -
'
# Headers for the producer in Node; a node from elsewhere often brings them along.
node=$(readlink -f "$(command -v node || true)" || true)
if [ ! -f "${node%/bin/node}/include/node/node_api.h" ]; then
  packages+='
tests     nodejs              nodejs               node
tests     libnode-dev         nodejs-devel         node
'
fi
# A node from elsewhere often brings npm along, too.
command -v npm >/dev/null || packages+='
viewer    npm                 nodejs-npm           node
'

fail() {
  printf '%s\n' "install_dependencies.sh: $*" | fold -s -w 100 >&2
  exit 1
}

usage() {
  cat <<HELP
Usage: tools/install_dependencies.sh [SET]...

Installs, as root or with sudo, what is missing of these sets of Debian's packages; without an
argument build, pictures and tests. A run needs build and pictures, tests and what CI checks tests,
too. readers are programs of others that read what Wade writes: ffmpeg makes films, the others are
for tests, which are skipped without them. viewer: npm brings the page of tools/wade view its one
package, chromium is for its test. engines: what tools/wade many can hand runs to, and MPI for water
over ranks (tools/wade run --ranks). builds: the cross compiler and the emulator of the test that
arm64 has the bits of x86-64. On other systems it names the packages, which you install
yourself:

set       Debian, Ubuntu      Fedora               Homebrew
$(grep . <<<"$packages")

Tested on Debian 12. Not supported: macOS and Windows, as the programs wait on Linux futexes and
look for their peers in /proc (Homebrew means that on Linux; on Windows take WSL 2), and
Catch2 3, as the tests are written for Catch2 2. The conformance suite runs on x86-64 only.
HELP
}

sets=()
for argument in "$@"; do
  case "$argument" in
    build | pictures | tests | readers | viewer | engines | builds) sets+=("$argument") ;;
    -h | --help) usage; exit 0 ;;
    *)
      echo "install_dependencies.sh: unexpected \"$argument\"; allowed: build, pictures, tests, readers," >&2
      echo "  viewer, engines, builds" >&2
      exit 2
      ;;
  esac
done
[ ${#sets[@]} -gt 0 ] || sets=(build pictures tests)

# names COLUMN: the packages of the wanted sets in one of the columns 2 to 4.
names() {
  awk -v sets=" ${sets[*]} " -v column="$1" 'index(sets, " " $1 " ") && $column != "-" && !seen[$column]++ { print $column }' \
    <<<"$packages"
}

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
  if command -v dnf >/dev/null; then
    # shellcheck disable=SC2046  # one word each
    rpm -q --quiet $(names 3) && exit 0
    fail "install the packages of Fedora yourself: dnf install $(names 3 | xargs)"
  fi
  command -v brew >/dev/null && fail "install the packages of Homebrew yourself: brew install $(names 4 | xargs)"
  fail "this system has no apt; install by its own means what these Debian packages hold: $(names 2 | xargs)"
fi

mapfile -t wanted < <(names 2)
# shellcheck disable=SC2016  # the format is dpkg's, not the shell's
known=$(dpkg-query --show --showformat='${Package} ${db:Status-Status}\n' "${wanted[@]}" 2>/dev/null) || true
missing=()
for package in "${wanted[@]}"; do
  [[ $'\n'$known$'\n' == *$'\n'"$package installed"$'\n'* ]] || missing+=("$package")
done
[ ${#missing[@]} -gt 0 ] || exit 0

echo "Installing ${#missing[@]} Debian packages (${sets[*]}): ${missing[*]}" | fold -s -w 100 >&2
as_root=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || fail "needs root or sudo; as root: apt-get install ${missing[*]}"
  as_root=(sudo)
fi
# told COMMAND ...: passes on what apt says on stderr. apt says each second that it waits for the lock of another apt, for
# example of a machine that just started; that is passed on once.
told() {
  local line waits=
  "$@" 2>&1 | while IFS= read -r line || [ -n "$line" ]; do
    if [[ "$line" == "Waiting for cache lock"* ]]; then
      [ -z "$waits" ] || continue
      waits=1
    fi
    printf '%s\n' "$line"
  done >&2
}
apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get --quiet -o DPkg::Lock::Timeout=300)
told "${apt[@]}" update || echo "install_dependencies.sh: warning: apt-get update failed; trying with the lists at hand" >&2
told "${apt[@]}" install --yes --no-install-recommends "${missing[@]}" ||
  fail "apt-get could not install ${missing[*]}; its messages above say why (network, disk space, sources.list?)"
