"""The conformance suite passes a sound producer and refuses each broken one by the check that is made for it."""

import json
import os
import subprocess
import sys
import tempfile
import unittest
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from broken_producer import DEFECTS

HERE = Path(__file__).resolve().parent
SUITE = HERE.parents[2] / "tools" / "conformance.sh"
PRODUCER = [sys.executable, "-B", HERE / "broken_producer.py"]
TIMEOUTS = ["--attach-timeout-option=--attach-timeout-s", "--step-timeout-option=--step-timeout-s"]
# The long form tries every defect, the quick one a defect of each check.
EVERY_DEFECT = "WADE_EVERY_DEFECT" in os.environ
# A broken producer often does nothing at all, so that the suite has to give up on it.
PATIENCE_WITH_DEFECTS_S = 2


def conformance(*options, producer=()):
    """Runs the suite; (exit code, {check: (verdict, detail)}, output)."""
    with tempfile.TemporaryDirectory(prefix="wade-conformance-") as folder:
        report = Path(folder) / "report.json"
        words = [SUITE, "--report", report, *TIMEOUTS, *options, "--", *PRODUCER, *producer]
        done = subprocess.run(list(map(str, words)), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                              check=False)
        checks = json.loads(report.read_text())["checks"] if report.exists() else []
    return done.returncode, {c["check"]: (c["verdict"], c["detail"]) for c in checks}, done.stdout


class SoundProducer(unittest.TestCase):
    def test_passes_every_check_at_depth_1(self):
        code, checks, output = conformance("--keep-going")
        not_passed = {name for name, (verdict, _) in checks.items() if verdict != "pass"}
        self.assertEqual(not_passed, {"impulses", "sampling"}, output)  # of agents alone; a row is too narrow
        self.assertEqual(code, 0)

    def test_passes_at_depth_3_what_depends_on_the_depth(self):
        names = ("lockstep", "depth", "write_mark", "wake_up", "late_joiner", "latest", "follower", "repeat", "end",
                 "consumer_killed_at_end")
        code, checks, output = conformance(*(f"--only={name}" for name in names), producer=("--depth", "3"))
        self.assertEqual(set(checks), set(names), output)
        self.assertEqual(code, 0, output)
        self.assertIn("largest lead 3", checks["depth"][1])


    def test_passes_with_a_stream_of_agents(self):
        names = ("header", "frames", "impulses", "hash_chain", "repeat", "end")
        options = [f"--only={name}" for name in names]
        code, _, output = conformance("--kind=agents", *options, producer=("--kind", "agents"))
        self.assertEqual(code, 0, output)
        self.assertIn("6 passed", output)


class BrokenProducer(unittest.TestCase):
    def chosen(self):
        """One defect of each check, or all."""
        if EVERY_DEFECT:
            return DEFECTS.items()
        return {defect.caught_by: (name, defect) for name, defect in reversed(DEFECTS.items())}.values()

    def test_each_defect_is_caught_by_the_check_made_for_it(self):
        def judge(item):
            name, defect = item
            kind = getattr(defect, "kind", "fluid")
            return name, defect.caught_by, conformance(
                f"--only={defect.caught_by}", f"--kind={kind}", f"--patience-s={PATIENCE_WITH_DEFECTS_S}",
                producer=("--kind", kind, "--defect", name),
            )

        # Most of them wait in vain most of the time.
        with ThreadPoolExecutor(6) as pool:
            for name, check, (code, checks, output) in pool.map(judge, self.chosen()):
                with self.subTest(defect=name, check=check):
                    self.assertEqual(checks[check][0], "FAIL", output)
                    self.assertIn("the contract says", checks[check][1])
                    self.assertEqual(code, 1)

    def test_every_check_has_a_defect_made_for_it(self):
        """three_consumers is two_consumers with one more."""
        listed = subprocess.run([SUITE, "--list"], stdout=subprocess.PIPE, text=True, check=True).stdout
        names = {line.split()[0] for line in listed.splitlines() if line[0] != " "}
        self.assertEqual(names - {defect.caught_by for defect in DEFECTS.values()}, {"three_consumers"})


class Suite(unittest.TestCase):
    def test_skipped_checks_are_not_passed(self):
        code, checks, output = conformance("--only=mode", "--only=repeat", "--skip=mode", "--nondeterministic")
        self.assertEqual({verdict for verdict, _ in checks.values()}, {"skip"})
        self.assertIn("0 passed, 0 failed, 2 skipped", output)
        self.assertEqual(code, 1)

    def test_stops_at_the_first_failure_unless_told_to_keep_going(self):
        options = ("--only=mode", "--only=frames", "--patience-s=3")
        _, checks, _ = conformance(*options, producer=("--defect", "readable-by-all"))
        self.assertEqual(list(checks), ["mode"])
        _, checks, _ = conformance(*options, "--keep-going", producer=("--defect", "readable-by-all"))
        self.assertEqual({name: verdict for name, (verdict, _) in checks.items()}, {"mode": "FAIL", "frames": "pass"})

    def test_session_is_put_where_the_command_wants_it(self):
        script = f"exec {sys.executable} -B {PRODUCER[2]} --session {{session}}"
        words = [str(SUITE), "--only=frames", "--", "sh", "-c", script]
        done = subprocess.run(words, stdout=subprocess.PIPE, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stdout)

    def test_usage_errors_end_with_2_and_name_the_mistake(self):
        mistakes = (
            ([], "COMMAND"), (["--only=no_such_check", "x"], "no_such_check"), (["--patience-s=0", "x"], "--patience-s"),
            (["/no/such/program"], "/no/such/program"),
        )
        for words, text in mistakes:
            with self.subTest(words=words):
                done = subprocess.run([SUITE, *words], stderr=subprocess.PIPE, text=True, check=False)
                self.assertEqual(done.returncode, 2)
                self.assertIn(text, done.stderr)

    def test_leaves_nothing_in_shared_memory(self):
        with tempfile.TemporaryDirectory() as folder:
            words = [SUITE, "--only=end", "--patience-s=3", "--", *PRODUCER, "--defect", "leaves-its-object"]
            process = subprocess.Popen(list(map(str, words)), stdout=subprocess.DEVNULL, cwd=folder)
            process.wait()
        self.assertEqual(list(Path("/dev/shm").glob(f"conformance-{process.pid}-*")), [])


if __name__ == "__main__":
    os.chdir(HERE)
    unittest.main()
