#!/usr/bin/env bash
# Installs the Debian packages that the build, the tests and the pictures need; does nothing when all are there.
set -euo pipefail

packages=(
  g++ cmake ninja-build git               # build; git names the commit in --version
  libbenchmark-dev                        # kernels measured by themselves
  libeigen3-dev libboost-dev nlohmann-json3-dev libcli11-dev libhwy-dev libsqlite3-dev libzstd-dev
  catch2                                  # unit tests
  spin clang libclang-rt-14-dev           # the protocol's model and the fuzzer of its header
  libzmq3-dev pkgconf                     # what the protocol is measured against
  python3 python3-numpy python3-matplotlib python3-pil  # scripts, system tests, pictures
  python3-jsonschema                      # the test that scenes keep their schema
)

# Headers for the producer in Node; a node from elsewhere often brings them along.
node=$(readlink -f "$(command -v node || true)" || true)
if [ ! -f "${node%/bin/node}/include/node/node_api.h" ]; then
  packages+=(nodejs libnode-dev)
fi

case "${1:-}" in
  "") ;;
  -h | --help)
    echo "Usage: tools/install_dependencies.sh"
    echo "Installs, as root or with sudo, those of these packages that are missing:"
    printf '  %s\n' "${packages[@]}"
    exit 0
    ;;
  *)
    echo "install_dependencies.sh: unexpected argument \"$1\"; see --help" >&2
    exit 2
    ;;
esac

fail() {
  echo "install_dependencies.sh: $*" >&2
  exit 1
}

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
  fail "this system has no dpkg and apt; install by its own means what these Debian packages hold: ${packages[*]}"
fi

# shellcheck disable=SC2016  # the format is dpkg's, not the shell's
known=$(dpkg-query --show --showformat='${Package} ${db:Status-Status}\n' "${packages[@]}" 2>/dev/null) || true
missing=()
for package in "${packages[@]}"; do
  [[ $'\n'$known$'\n' == *$'\n'"$package installed"$'\n'* ]] || missing+=("$package")
done
[ ${#missing[@]} -gt 0 ] || exit 0

echo "Installing ${#missing[@]} Debian packages: ${missing[*]}" >&2
as_root=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null ||
    fail "needs root or sudo to install ${missing[*]}; as root: apt-get install ${missing[*]}"
  as_root=(sudo)
fi
# A lock held by another apt, for example that of a machine that just started, is waited for.
apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get --quiet -o DPkg::Lock::Timeout=300)
"${apt[@]}" update >&2 || echo "install_dependencies.sh: warning: apt-get update failed; trying with the lists at hand" >&2
"${apt[@]}" install --yes --no-install-recommends "${missing[@]}" >&2 ||
  fail "apt-get could not install ${missing[*]}; its messages above say why (network, disk space, sources.list?)"
