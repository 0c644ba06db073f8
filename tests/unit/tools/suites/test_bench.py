"""Benchmarks: how results are merged and compared, with made-up figures."""

import tempfile
import unittest
from pathlib import Path

from wade.reports.machine import machine, machine_text
from wade.suites.bench import results


def result(median, unit="particle_steps_per_s", name="fluid/river", threads=1, **extra):
    return {"name": name, "size": 10, "threads": threads, "median": median, "min": median, "max": median, "unit": unit,
            **extra}


class Comparison(unittest.TestCase):
    def test_a_rate_that_doubles_and_a_time_that_halves_are_twice_as_fast(self):
        self.assertEqual(results.speed_up(result(1), result(2)), 2)
        self.assertEqual(results.speed_up(result(2, "us"), result(1, "us")), 2)
        self.assertIsNone(results.speed_up(result(0), result(1)))

    def test_only_what_both_have_is_compared_and_the_error_stands_beside(self):
        before = [result(100, mean_density_error_percent=0.04), result(7, threads=2), result(1, name="gone")]
        lines = results.comparison(before,
                                   [result(150, mean_density_error_percent=0.05), result(1, name="new")]).splitlines()
        self.assertIn("1.500", lines[-2])
        self.assertIn("0.04 -> 0.05", lines[-2])
        self.assertIn("only before: fluid/river, gone", lines[-1])


class Files(unittest.TestCase):
    def test_results_are_written_whole_and_read_again(self):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "new" / "bench.json"
            results.write(file, {"model": "m"}, [result(3)])
            self.assertEqual(results.read(file), {"machine": {"model": "m"}, "results": [result(3)]})
            self.assertEqual([p.name for p in file.parent.iterdir()], ["bench.json"])

    def test_the_machine_has_a_line(self):
        self.assertIn("processors", machine_text(machine()))

    def test_repetitions_of_a_kernel_become_a_median(self):
        runs = [
            {"name": "kernels/sort/100", "run_name": "kernels/sort/100", "run_type": kind, "threads": 1,
             "ns_per_item": value, "cpu_time": 1}  # fmt: skip
            for kind, value in (("iteration", 9.0), ("iteration", 5.0), ("iteration", 6.0), ("aggregate", 99.0))
        ]
        (found,) = results.kernel_results({"benchmarks": runs})
        self.assertEqual((found["name"], found["size"], found["unit"]), ("kernels/sort", 100, "ns_per_particle"))
        self.assertEqual((found["median"], found["min"], found["max"]), (6.0, 5.0, 9.0))


if __name__ == "__main__":
    unittest.main()
