#!/usr/bin/env bash
# Records three simulated seconds of the small scene: record_run.sh PROGRAMS_FOLDER FILE
set -euo pipefail
programs=$1
file=$2
scene=$(cd "$(dirname "${BASH_SOURCE[0]}")/../../system/scenes" && pwd)/small.json
session=conformance-recording-$$

"$programs/shm_record" "$session" "$file" &
recorder=$!
"$programs/crowd_client" "$scene" --session "$session" --until-s 3 --out "$file.run" &
crowd=$!
"$programs/fluid_server" "$scene" --session "$session" --until-s 3 --consumers 2
wait "$crowd"
wait "$recorder"
