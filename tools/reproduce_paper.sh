#!/usr/bin/env bash
# Runs the scenarios of the paper with many seeds and writes a report beside it.
set -euo pipefail
# shellcheck source=tools/build.bash
. "$(dirname "${BASH_SOURCE[0]}")/build.bash"

help_if_asked "$@" <<'HELP'
Usage: tools/reproduce_paper.sh [--out DIR] [--seeds N] [--max-seeds N] [--quick] [--parts LIST]
                                [--set-of-scenes observed|paper|river|manning|both|all] [--threads N] [--until-s T]
                                [--keep-all] [--report-only]

Runs the scenarios of the paper with many seeds, in four set-ups: configs/observed (the water of the authors' logs,
kinematic, cheap), configs/paper (as they ran it), configs/river (as the paper describes it) and configs/manning (that
river on a slope with friction, with four layers of particles, about ten times the cost). One run of the fluid
serves all crowds of a water. Writes DIR/report.md, DIR/table1.csv, DIR/readings.csv, DIR/phase.csv, DIR/depth_sweep.csv and
pictures, and prints the report. DIR/runs.jsonl keeps what each run came to, a line each; it and DIR/depth_sweep.csv are
all that going on, or drawing the report again, needs: --out tests/paper/report goes on with the campaign of the repository.

  --out DIR             [runs/reproduce_paper in the project]
  --seeds N             crowds of each scenario, with the seeds 1 to N; the parts phase, depth, push, plane,
                        rules, readings and variations take half as many [10, with --quick 1]
  --max-seeds N         more seeds, N at most, where an interval of 95 % is still wider than a tenth of the agents or of
                        the mean time; each round is a further run of the fluid [3 times --seeds in the set observed,
                        --seeds in the others]
  --quick               only S1, S4, S5 and S8 of Table 1
  --parts LIST          separated by commas [all]:
                          table1      S1 to S12 beside the paper's Table 1
                          others      two groups, obstacle, switch of tau
                          places      the obstacle in other places
                          block       the obstacle in a dry start with faster water (set paper)
                          rules       contact rule of the text, continuous coupling
                          readings    spacings, frame rates, starts, gravity, speed of the emitter
                          particles   ten times the particles
                          phase       who arrives over the plane of tau and v_F (set observed)
                          goal        time of S1 over the goal radius, the one number fitted (set observed)
                          depth       outcomes over the depth of the water (set observed)
                          push        outcomes over the speed with which the water pushes (set observed)
                          plane       who arrives over the plane of depth and v_F (set observed): tools/depth_sweep.py with
                                      one thread, after all else; its cost is not told beforehand
                          variations  500 and 5,000 agents, several goals and groups, a village
                          figures     pictures in the paper's style, at its times
  --set-of-scenes SET   observed, paper, river, manning, both (paper and river) or all [all, with --quick all but
                        manning]
  --threads N           threads of each program [2]
  --until-s T           simulated time at which each run ends, s [the scene's, 400]; such runs are not judged
  --keep-all            keep paths and pictures of the water of all runs, not only those of seed 1 of unchanged scenes and of
                        the obstacle
  --report-only         run nothing: the report of what is complete in DIR, with all seeds that are there, from
                        runs.jsonl and from run folders, which it adds to that file
Tells before it starts what is ahead in particle-steps, every minute how far a water is, after each the time to go at most.
A crowd that is complete, in runs.jsonl or as a folder in DIR, and whose scene is still the same is not run again,
whichever version of the programs ran it; the report marks results of another version than the present one with a star.
An empty DIR has all runs by the present one. Run folders hold what pictures in the paper's style need; without them
such a picture stays as it was drawn before. What was not run has no part in the report. Exit code 1: a run failed, or
the verdict has a no (the bands are reported, they do not count); 2: runs.jsonl or a scene is not valid.
HELP

"$root/tools/install_dependencies.sh" || exit 1
build_programs || { echo "reproduce_paper.sh: the build failed" >&2; exit 1; }
exec /usr/bin/python3 "$root/tools/paper/reproduce.py" --programs "$build" "$@"
