#!/usr/bin/env bash
# Checks the choice of the model: how often the model that "auto" chooses keeps the error that was asked for.
set -euo pipefail
# shellcheck source=tools/build.bash
. "$(dirname "${BASH_SOURCE[0]}")/build.bash"

help_if_asked "$@" <<'HELP'
Usage: tools/model_choice.sh [--quick] [--out DIR] [--report-only]

Runs fifteen scenes (configs/model_choice), none of which the table of the choice was measured with: rivers, fronts, blocks,
emitters, a slope. Each with /fluid/model "auto" and a max_impulse_error of 0.05, 0.1 and 0.3, with the default settings,
and with a fine spacing as the truth. Writes DIR/report.md, DIR/model_choice.csv (a line a scene and demand) and a plot:
demanded, estimated and actual error of the impulse on those who stand, and the cost. Held: the actual median is at most the
demand. About ten minutes; a run that is there already, of the same scene and settings, is not repeated: after a change of a
solver take another DIR.

Columns of model_choice.csv: scene; demand; kind, the kind of water that decides; chosen; pilot, the difference
that it found and the largest one that is allowed; went_up, yes if the pilot contradicted the first choice; estimated_median, estimated_p95; actual_median, actual_p95; held; default_median, error of the default settings;
particle_steps, cpu_s_per_sim_s, cost_over_default (CPU time of the solver); choice_cpu_s, CPU time of the choice with its pilot;
refused, why the demand was refused.

  --quick        three scenes
  --out DIR      [runs/model_choice in the project]
  --report-only  only writes the report of the runs that are there

tools/model_choice/measure.py measures what the table lacks, tools/model_choice/table.py writes it.
HELP

"$root/tools/install_dependencies.sh" || exit 1
build_with_tests fluid_server impulse_scene || { echo "model_choice.sh: the build failed" >&2; exit 1; }
exec /usr/bin/python3 "$root/tools/model_choice" --programs "$build" "$@"
