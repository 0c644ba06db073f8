"""The long form of what the tests show about the protocol: model checking, random kills, ThreadSanitizer, fuzzing, and the
conformance of every producer, one after another. About twenty minutes, with --quick some minutes.
"""

import subprocess
import sys

from wade.building import bring_up_to_date
from wade.paths import BUILD, ROOT, WADE
from wade.terminal import Parser


def parts(quick):
    """(title, command) of each part."""
    kills, runs, rounds = ("60", "200000", "2") if quick else ("500", "3000000", "20")
    ctest = ["ctest", "--test-dir", BUILD, "--output-on-failure"]
    kill_test = [sys.executable, ROOT / "tests" / "protocol" / "kills" / "kill_test.py"]
    return (
        ("Model checking", [WADE, "check-model", *(["--quick"] if quick else [])]),
        (f"{kills} random kills", [*kill_test, "--peer", BUILD / "tests/protocol/kills/kill_peer", "--runs", kills]),
        (f"Races, and mutants that must be caught ({rounds} rounds)",
         [*ctest, "-R", "protocol_races", "--repeat", f"until-fail:{rounds}"]),
        ("Fuzzing", [WADE, "fuzz", "--runs", runs]),
        ("The latest frame, long form", [BUILD / "tests/unit/shm_protocol/test_shm_protocol", "[long]"]),
        ("Conformance of every producer", [*ctest, "-R", "conformance"]),
    )


def main(arguments):
    """tools/wade check-protocol."""
    parser = Parser("check-protocol", __doc__)
    parser.add_argument("--quick", action="store_true", help="fewer kills, inputs and rounds, no long searches")
    options = parser.parse_args(arguments)
    bring_up_to_date((), with_tests=True)
    failed = []
    for title, command in parts(options.quick):
        print(f"\n== {title}", flush=True)
        # Runs on after a failure, so that one report shows all; 77 stands for what is not installed.
        if subprocess.run(command).returncode not in (0, 77):
            failed.append(title)
    print(f"\nFAILED: {', '.join(failed)}" if failed else "\nAll of it holds.")
    return 1 if failed else 0
