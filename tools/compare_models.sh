#!/usr/bin/env bash
# Compares all models of the water: error and cost on the validation cases, and Table 1 of the paper by each.
set -euo pipefail
# shellcheck source=tools/build.bash
. "$(dirname "${BASH_SOURCE[0]}")/build.bash"

help_if_asked "$@" <<'HELP'
Usage: tools/compare_models.sh [--quick] [--out DIR] [--report-to DIR] [--models A,B] [--cases A,B] [--levels L,M]
                               [--parts cases,table1] [--set-of-scenes river,paper] [--seeds N] [--time-limit S]
                               [--until-s T] [--set MODEL:/POINTER=VALUE] [--validation-csv FILE]
                               [--dfsph-campaign DIR] [--report-only]

Runs each validation case that a model can run (a case refuses the others by itself) and the scenes of Table 1 of the paper
with each model of the water, nothing changed but /fluid/model, one run at a time in one thread. Writes report.md, with
plots and with conclusions that follow from the numbers by rule, models.csv and models_table1.csv.

  --quick                the quick cases at one resolution each, and S1, S4, S5 and S8 of configs/river with one seed
  --out DIR              folder of the runs [runs/compare_models in the project]; DIR/table1/runs.jsonl and the files result.json
                         below DIR/cases are all that a report needs
  --report-to DIR        folder of report, tables and pictures [that of --out]
  --models A,B           models, as /fluid/model names them [dfsph,mixed,shallow_water,steering,kinematic]
  --cases A,B            only these cases; patterns such as 'wet_bed*' may stand for several
  --levels L,M           resolutions of coarse, medium and fine [coarse,medium]
  --parts A,B            only these of cases and table1
  --set-of-scenes A,B    scenes of Table 1: river (a river 1 m deep that flows), paper (an emitter, dry start)
                         [river,paper; with --quick river]
  --seeds N              crowds of each scenario of Table 1, with the seeds 1 to N; they share one run of the water, but
                         for mixed, which follows people [3, with --quick 1]
  --time-limit S         wall time after which a run of a case is given up, s; a finer resolution that is expected to
                         take more CPU time is left out and named [600]
  --until-s T            simulated time at which the runs of Table 1 end, s [the scene's, 400]
  --set MODEL:/POINTER=VALUE  a value of all scenes that a model needs besides; may be given several times
  --validation-csv FILE  table of tools/validate.sh whose runs of DFSPH are taken instead of being made again; none: run
                         all [docs/reports/validation/validation.csv]
  --dfsph-campaign DIR   folder of tools/reproduce_paper.sh, or of Table 1 of this command, whose complete runs of the same
                         scenes and seeds are read as those of DFSPH; its runs.jsonl is enough, and nothing is changed in it
  --report-only          run nothing: the report of what is complete in DIR
A run that is complete and whose program and scenes are still the same is not repeated, so that the command goes on where it
was stopped. Shallow water, steering and kinematic take about an hour on one core, most of it steering water in Table 1;
DFSPH without --validation-csv and --dfsph-campaign some hours more. Exit code 1: a run failed; 2: wrong options; 130,
143: interrupted. A limit that is missed is a result, not a failure.

Columns of models.csv, a line a metric of a run: case, model, level, spacing_m; status: completed, refused, failed or left out;
particles, or cells of a grid; metric, value, unit; limit; met, yes or no, empty if the metric has no limit; cpu_s of the solver,
simulated_s, cpu_s_per_sim_s; source, "run" or the file it was read from; commit of the program; remark, why there is no result.
models_table1.csv has the columns of table1.csv of tools/reproduce_paper.sh after the model, and the cost of the server.
HELP

"$root/tools/install_dependencies.sh" || exit 1
build_with_tests validate fluid_server crowd_client || { echo "compare_models.sh: the build failed" >&2; exit 1; }
exec /usr/bin/python3 "$root/tools/compare_models" --programs "$build" "$@"
