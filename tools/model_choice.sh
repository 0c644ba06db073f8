#!/usr/bin/env bash
# Checks the choice of the model: how often the model that "auto" chooses keeps the error that was asked for.
set -euo pipefail
# shellcheck source=tools/build.bash
. "$(dirname "${BASH_SOURCE[0]}")/build.bash"

"$root/tools/install_dependencies.sh" || exit 1
build_with_tests fluid_server impulse_scene || { echo "model_choice.sh: the build failed" >&2; exit 1; }
PYTHONPATH=$root/tools/python exec /usr/bin/python3 -B -c 'import sys; from wade.suites.model_choice import main; sys.exit(main(sys.argv[1:]))' "$@"
