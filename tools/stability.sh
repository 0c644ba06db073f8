#!/usr/bin/env bash
# Runs the hard cases of the fluid and the crowd with every solver setting. Writes stability.csv and report.md.
set -euo pipefail
# shellcheck source=tools/build.bash
. "$(dirname "${BASH_SOURCE[0]}")/build.bash"

"$root/tools/install_dependencies.sh" || exit 1
build_with_tests stability || { echo "stability.sh: the build failed" >&2; exit 1; }
PYTHONPATH=$root/tools/python exec /usr/bin/python3 -B -c 'import sys; from wade.suites.stability import main; sys.exit(main(sys.argv[1:]))' "$@"
