# Sourced by the scripts of this folder: what must be there before anything runs.

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=${WADE_BUILD:-$root/build/release}  # another build folder may be named, for example one with sanitizers

# help_if_asked "$@" < TEXT: prints the text and ends the script if -h or --help is among its arguments, up to "--". Needs
# neither packages nor a build, so that help is always at hand.
help_if_asked() {
  local argument
  for argument in "$@"; do
    case "$argument" in
      --) return ;;
      -h | --help) cat && exit ;;
    esac
  done
}

# Two scripts that start at the same time build one after the other.
lock_build_folder() {
  check_build_folder || exit
  mkdir -p "$build"
  exec 9>"$build/.lock"
  flock 9
}

unlock_build_folder() {
  exec 9>&-
}

# A build folder that was named belongs to one source folder; another one's programs must not run in its place.
check_build_folder() {
  local home
  home=$(sed -n 's/^CMAKE_HOME_DIRECTORY:INTERNAL=//p' "$build/CMakeCache.txt" 2>/dev/null) || true
  if [ -n "$home" ] && [ "$(readlink -f "$home")" != "$(readlink -f "$root")" ]; then
    echo "$build is the build folder of $home, not of $root; name another one in WADE_BUILD" >&2
    return 2
  fi
}

# configure_release [-D...]: fresh build folders only, or one whose options change.
configure_release() {
  echo "Configuring the release build in $build" >&2
  (cd "$root" && cmake --preset release -B "$build" "$@" >&2)
}

# build_programs [TARGET...]: brings both programs, or those named, up to date; quick when they are.
build_programs() {
  [ $# -gt 0 ] || set -- fluid_server crowd_client
  lock_build_folder
  if [ ! -f "$build/build.ninja" ]; then
    configure_release -DWADE_BUILD_TESTS=OFF || return
  fi
  local to_compile
  # version.cpp is listed each time, in case the commit has changed.
  to_compile=$(ninja -n -C "$build" "$@" | grep 'Building CXX' | grep -vc 'version\.cpp') || true
  if [ "$to_compile" -gt 0 ]; then
    echo "Building $* (release, $to_compile files); a full build takes a minute or two" >&2
    ninja -C "$build" "$@" >&2 || return
  else
    ninja --quiet -C "$build" "$@" >&2 || return
  fi
  unlock_build_folder
}

# build_with_tests TARGET...: the same for programs that are only built together with the tests.
build_with_tests() {
  lock_build_folder
  if ! grep -qs '^WADE_BUILD_TESTS:BOOL=ON' "$build/CMakeCache.txt"; then
    configure_release -DWADE_BUILD_TESTS=ON || return
  fi
  unlock_build_folder
  build_programs "$@"
}
