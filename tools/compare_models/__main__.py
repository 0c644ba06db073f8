#!/usr/bin/env python3
"""Compares all models of the water; see tools/compare_models.sh."""

import argparse
import json
import subprocess
import sys
from pathlib import Path

from paths import ROOT

import runs
from case_runs import LevelRunner, run_cases, water_cases
from ensembles import Programs
from machine import machine_of
from pair_processes import Pair
from recorded import read_recorded
from results import Judge
from run_folder import end_children_on_signals, exit_code, say
from store import StoreError
from table1 import read_paper
from table_one import SETS, run_table

VALIDATION = ROOT / "tests" / "validation"
DEFAULT_MODELS = ("dfsph", "mixed", "shallow_water", "steering", "kinematic")
PARTS = ("cases", "table1")


def known_models():
    schema = json.loads((ROOT / "configs" / "scene.schema.json").read_text(encoding="utf-8"))
    return schema["properties"]["fluid"]["properties"]["model"]["enum"]


def one_of(option, text, allowed):
    """The words of a list; exits with code 2 and what is allowed if one is not known."""
    words = [word.strip() for word in text.split(",") if word.strip()]
    for word in words:
        if word not in allowed:
            fail(f'{option} {word}: not known; allowed: {", ".join(allowed)}')
    return words or fail(f'{option}: nothing named; allowed: {", ".join(allowed)}')


def fail(text):
    print(f"compare_models.sh: {text}", file=sys.stderr)
    sys.exit(2)


def further_values(words, models):
    """{model: ((JSON pointer, value), ...)} of MODEL:/POINTER=VALUE."""
    found = {}
    for word in words:
        model, colon, change = word.partition(":")
        pointer, equals, text = change.partition("=")
        if not colon or not equals or not pointer.startswith("/") or model not in models:
            fail(f"--set {word}: allowed: MODEL:/POINTER=VALUE with a model that is compared ({', '.join(models)})")
        try:
            value = json.loads(text)
        except ValueError:
            value = text
        found[model] = (*found.get(model, ()), (pointer, value))
    return found


def positive(kind):
    def read(text):
        try:
            value = kind(text)
        except ValueError:
            value = 0
        if not value > 0:
            numbers = "whole numbers" if kind is int else "numbers"
            raise argparse.ArgumentTypeError(f'"{text}" is out of range; allowed: {numbers} above 0')
        return value

    return read


def parse(arguments):
    parser = argparse.ArgumentParser(prog="compare_models.sh", usage="compare_models.sh --help", allow_abbrev=False)
    parser.add_argument("--programs", type=lambda name: Path(name).resolve(), required=True)
    parser.add_argument("--out", type=lambda name: Path(name).resolve(), default=ROOT / "runs" / "compare_models")
    parser.add_argument("--report-to", type=lambda name: Path(name).resolve())
    for name in ("--models", "--cases", "--levels", "--parts", "--set-of-scenes"):
        parser.add_argument(name, default="")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--report-only", action="store_true")
    parser.add_argument("--seeds", type=positive(int))
    parser.add_argument("--time-limit", type=positive(float), default=600.0)
    parser.add_argument("--until-s", type=positive(float))
    parser.add_argument("--dfsph-campaign", type=lambda name: Path(name).resolve())
    parser.add_argument("--validation-csv", default=str(ROOT / "docs" / "reports" / "validation" / "validation.csv"))
    parser.add_argument("--set", action="append", default=[])
    options = parser.parse_args(arguments)
    options.models = one_of("--models", options.models or ",".join(DEFAULT_MODELS), known_models())
    options.further = further_values(options.set, options.models)
    options.parts = one_of("--parts", options.parts or ",".join(PARTS), PARTS)
    options.sets = one_of("--set-of-scenes", options.set_of_scenes or ",".join(SETS[:1] if options.quick else SETS), SETS)
    options.seeds = options.seeds or (1 if options.quick else 3)
    options.levels = options.levels or ("" if options.quick else "coarse,medium")
    if options.dfsph_campaign and not options.dfsph_campaign.is_dir():
        fail(f"--dfsph-campaign {options.dfsph_campaign}: no such folder")
    if options.validation_csv != "none" and not Path(options.validation_csv).is_file():
        allowed = 'a validation.csv of tools/validate.sh, or "none"'
        fail(f"--validation-csv {options.validation_csv}: no such file; allowed: {allowed}")
    return options


def compare_cases(options):
    """[Outcome], the commits of what was read, and its file in words."""
    program = options.programs / "validate"
    cases = water_cases(runs.list_cases(program))
    try:
        plan = runs.plan(cases, options.cases, options.levels, options.quick, False)
    except ValueError as error:
        fail(error)
    runs.tell_left_out(options.cases, plan)
    recorded, commits, file = {}, [], ""
    if options.validation_csv != "none":
        file = Path(options.validation_csv).resolve()
        recorded, commits = read_recorded(file, cases)
        file = file.relative_to(ROOT) if file.is_relative_to(ROOT) else file.name
    runner = LevelRunner(program, options.out / "cases", 1, options.time_limit)
    runner.report_only, runner.further = options.report_only, options.further
    return run_cases(plan, options.models, recorded, runner, options.time_limit), commits, file


def compare_table1(options):
    """{set: [ModelRuns]}, failures in words, exit code of a signal."""
    programs, place = Programs(options.programs, options.until_s), options.out / "table1"
    found, failures, interrupted = run_table(programs, place, Pair(), options.sets, options.models, options)
    by_set = {}
    for model_runs in found:
        by_set.setdefault(model_runs.set, []).append(model_runs)
    return by_set, failures, interrupted


def command_words(options):
    words = ["tools/compare_models.sh", "--models", ",".join(options.models)]
    words += [word for change in options.set for word in ("--set", change)]
    words += ["--quick"] if options.quick else []
    words += ["--cases", options.cases] if options.cases else []
    words += ["--parts", ",".join(options.parts)] if len(options.parts) < len(PARTS) else []
    words += ["--set-of-scenes", ",".join(options.sets)] if len(options.sets) < len(SETS) else []
    words += ["--until-s", f"{options.until_s:g}"] if options.until_s else []
    words += ["--dfsph-campaign", "DIR"] if options.dfsph_campaign else []
    words += ["--report-only"] if options.report_only else []
    return " ".join(words)


def main():
    options = parse(sys.argv[1:])
    end_children_on_signals()
    judge = Judge(VALIDATION / "thresholds.csv", VALIDATION / "known_failures.csv")
    paper = read_paper(ROOT / "tools" / "paper" / "table1.csv")
    options.out.mkdir(parents=True, exist_ok=True)
    outcomes, commits, file, table1, failures, interrupted = [], [], "", {}, [], 0
    try:
        if "cases" in options.parts:
            outcomes, commits, file = compare_cases(options)
        if "table1" in options.parts:
            table1, failures, interrupted = compare_table1(options)
    except StoreError as error:
        fail(error)
    except KeyboardInterrupt as interrupt:
        say("interrupted; the same command goes on from here", sys.stderr)
        return exit_code(interrupt)
    except subprocess.CalledProcessError as error:
        fail(f"{error.cmd[0]}: exit code {error.returncode}")
    import write_report  # with matplotlib, which takes a second

    folder = options.report_to or options.out
    write_report.write(folder, command_words(options), outcomes, options.models, judge, table1, paper, failures,
                       machine_of(), commits, file)
    say(f"{folder / 'report.md'}, {folder / 'models.csv'}")
    if interrupted:
        say("interrupted; the same command goes on from here", sys.stderr)
        return interrupted
    return 1 if failures or any(outcome.status == "failed" for outcome in outcomes) else 0


if __name__ == "__main__":
    sys.exit(main())
