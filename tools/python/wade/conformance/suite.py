"""Runs a producer through the contract of docs/protocol.md; see --help."""

import argparse
import json
import platform
import signal
import sys
import time
import traceback
from pathlib import Path

from wade.conformance import (checks_consumers, checks_ends, checks_frames, checks_object, checks_plausible,
                              checks_repeat, checks_sampling)
from wade.conformance.bench import Bench, CannotStart
from wade.conformance.expectation import PATIENCE_S, NotApplicable, Violation
from wade.conformance.layout import KINDS
from wade.reports.files import write_whole
from wade.terminal import Parser, harmless, say_error, wrapped

CHECKS = (checks_object.FIRST + checks_frames.ALL + checks_plausible.ALL + checks_sampling.ALL + checks_consumers.ALL +
          checks_repeat.ALL + checks_ends.ALL + checks_object.LAST)

DESCRIPTION = """Runs a producer through the contract of docs/protocol.md, each check with a fresh run of it.

COMMAND starts the producer. {session} in its words becomes the session name; without it, --session NAME is appended.
The command publishes a stream of at least 40 frames, the same in every run, and ends by itself. Prints a line for each
check: pass, FAIL or skip, its name, what it shows, numbers."""

EPILOG = """examples:
  tools/wade conformance build/release/fluid_server tests/system/scenes/small.json --until-s 3
  tools/wade conformance --only lockstep --only end -- ./my_producer --name {session}

exit codes: 0 every check that ran passed, 1 a check failed, 2 usage."""


def parse(arguments):
    parser = Parser("conformance", DESCRIPTION, EPILOG, usage="tools/wade conformance [options] [--] COMMAND ...")
    parser.add_argument("command", nargs=argparse.REMAINDER, help=argparse.SUPPRESS)
    parser.add_argument("--list", action="store_true", help="list the checks and end")
    parser.add_argument("--only", metavar="CHECK", action="append", help="make this check; may be repeated")
    parser.add_argument("--skip", metavar="CHECK", action="append", help="leave this check out; may be repeated")
    parser.add_argument("--nondeterministic", action="store_true", help="leave out the checks for the same bits")
    parser.add_argument("--keep-going", action="store_true", help="go on after a check that failed")
    parser.add_argument("--report", metavar="FILE", help="write the results as JSON")
    parser.add_argument("--kind", choices=sorted(KINDS), default="fluid", help="kind of the stream [fluid]")
    parser.add_argument("--scene", metavar="FILE",
                        help="the scene whose channel the particles fill [the first .json file in COMMAND]")
    parser.add_argument("--attach-timeout-option", metavar="OPTION", default="",
                        help="the producer's option for its attach time-out in seconds; it shortens nobody_comes")
    parser.add_argument("--step-timeout-option", metavar="OPTION", default="",
                        help="the producer's option for its step time-out in seconds; two checks need it")
    parser.add_argument("--patience-s", type=float, metavar="T", default=PATIENCE_S,
                        help="when to give up on a producer that does nothing [60]")
    options = parser.parse_args(arguments)
    if options.command[:1] == ["--"]:
        options.command.pop(0)
    known = {check.__name__ for check in CHECKS}
    for name in (options.only or []) + (options.skip or []):
        if name not in known:
            parser.error(f"there is no check '{name}'; --list names them all")
    if not options.list and not options.command:
        parser.error("the COMMAND that starts the producer is missing")
    if not options.patience_s > 0:
        parser.error(f"--patience-s {options.patience_s:g} is not allowed: above 0")
    if platform.machine() != "x86_64":
        parser.error(f"the suite runs on x86_64, this machine is {platform.machine()}")
    return options


def judge(check, bench):
    """Makes a check; (verdict, detail)."""
    try:
        return "pass", check(bench)
    except NotApplicable as reason:
        return "skip", str(reason)
    except Violation as violation:
        return "FAIL", str(violation)
    except CannotStart as error:
        say_error(f"wade conformance: error: {error}")
        sys.exit(2)
    except Exception as error:  # the suite itself met something it does not know
        traceback.print_exc(file=sys.stderr)
        return "FAIL", f"the suite could not go on: {type(error).__name__}: {error}"
    finally:
        bench.close()


def main(arguments):
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # so that no producer is left behind
    options = parse(arguments)
    if options.list:
        for check in CHECKS:
            print(wrapped(f"{check.__name__:22} {check.__doc__}", indent=23 * " "))
        return 0
    bench = Bench(options.command, options.kind, options.patience_s, options.attach_timeout_option,
                  options.step_timeout_option, options.nondeterministic, options.scene)
    results = []
    for check in CHECKS:
        name = check.__name__
        if options.only and name not in options.only:
            continue
        began = time.monotonic()
        verdict, detail = ("skip", "--skip") if name in (options.skip or []) else judge(check, bench)
        seconds = time.monotonic() - began
        told = f"({detail})" if verdict == "pass" else detail
        print(wrapped(harmless(f"{verdict} {name} - {check.__doc__} {told}")), flush=True)
        results.append({"check": name, "verdict": verdict, "detail": detail, "seconds": round(seconds, 3)})
        if verdict == "FAIL" and not options.keep_going:
            break
    return conclude(options, results)


def conclude(options, results):
    counts = {verdict: sum(r["verdict"] == verdict for r in results) for verdict in ("pass", "FAIL", "skip")}
    print(f"{counts['pass']} passed, {counts['FAIL']} failed, {counts['skip']} skipped")
    if options.report:
        write_whole(Path(options.report), json.dumps({"command": options.command, "checks": results}, indent=2) + "\n")
    return 1 if counts["FAIL"] or not counts["pass"] else 0
