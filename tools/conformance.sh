#!/usr/bin/env bash
# Runs a fluid producer through the checks of the shared-memory contract; --help tells more.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
exec /usr/bin/python3 -B "$here/conformance" "$@"
