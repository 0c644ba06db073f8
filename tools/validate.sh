#!/usr/bin/env bash
# Runs the validation cases: water and people whose behaviour is known. Writes validation.csv and report.md.
set -euo pipefail
# shellcheck source=tools/build.bash
. "$(dirname "${BASH_SOURCE[0]}")/build.bash"

help_if_asked "$@" <<'HELP'
Usage: tools/validate.sh [--quick] [--out DIR] [--cases A,B] [--levels L,M] [--long] [--jobs N] [--threads N]
                         [--set /POINTER=VALUE] [--beside DIR] [--again]

Runs each validation case at its coarse, medium and fine resolution and compares it with what is known: analytic
solutions, published experiments and tables. Writes DIR/validation.csv, DIR/report.md with a plot a case and the
observed order of convergence, and DIR/runs/ with the numbers of each run.

  --quick       only the quick cases, at one resolution each, as the tests run them; a few minutes. bump_jump is not among
                them, as it takes two. The tests (ctest) run uniform_river at medium too, in a third of the width
  --out DIR     [runs/validation in the project]
  --cases A,B   only these; patterns such as 'wet_bed*' may stand for several
  --levels L,M  only these of coarse, medium and fine
  --long        also what takes hours and is left out without it: uniform_river_600s and manning_river_600s (600 s, all
                resolutions), the medium and the fine one of jump_fr5_wide, and the fine one of spheric2 (a million
                particles), bump_subcritical, bump_jump, cavity_100, cavity_400 and cavity_1000
  --jobs N      runs side by side [processors over threads of each]
  --threads N   of each run [1]; results have the same bits for any number. For long runs of many particles; several runs
                side by side with one thread each waste less
  --set /POINTER=VALUE  a value of all scenes, for example /fluid/kernel=quartic_spline; may be given several times. Give
                such runs a folder of their own: runs of other settings in it count as those of another version
  --beside DIR  the report begins with its errors and costs against those in DIR, an --out of this command with other
                settings
  --again       repeats runs that are complete
  --list        lists the cases and ends
A run that is complete and whose program and scenes are still the same is not repeated, so that the command goes on where
it was stopped. The program counts by its bytes without the commit that it names: a commit, or changes not yet committed,
repeat runs only if they change what is computed. tests/validation/report has the runs of its report, so that
--out tests/validation/report goes on with it (without the curves of spheric2, which hold measured series). Exit code 1: a run failed, or a value is above its threshold and not among
the known failures. Exit code 2: wrong options; 130, 143: interrupted.

Columns of validation.csv, a line a metric: case, model; spacing_m; particles; metric, value, unit; threshold; pass, yes or no
(also of a known failure), empty if the metric is only reported; wall_s and cpu_s of the solver; reference, what it is
compared with.

Environment: WADE_SPHERIC2_DATA names a folder with spheric_test2_50Hz_boxavg.csv, the measured series of SPHERIC test 2;
the case spheric2 then compares with the whole series instead of a short table. Its runs are repeated when it changes.
HELP

"$root/tools/install_dependencies.sh" || exit 1
build_with_tests validate || { echo "validate.sh: the build failed" >&2; exit 1; }
exec /usr/bin/python3 "$root/tools/validation/validate.py" --program "$build/validate" "$@"
