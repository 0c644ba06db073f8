"""bench_kernels, a program of Google Benchmark: how it is called, and its results in the form of the others."""

import os
import re

# Name: (unit, counter that holds the figure). The kernels give the processor time of a particle or an agent.
FIGURES = {"machine/fma_peak": ("gflops", "gflops"), "machine/stream": ("gb_s", "gb_s")}
OF_AGENTS = ("kernels/contacts", "kernels/dry_crowd_step")
NO_MEASURE = {
    "name", "family_index", "per_family_instance_index", "run_name", "run_type", "repetitions", "repetition_index",
    "threads", "iterations", "real_time", "cpu_time", "time_unit", "ns_per_item",
}  # fmt: skip


def command(program, file, only, quick):
    if quick:
        os.environ["WADE_BENCH_QUICK"] = "1"
    words = [program, f"--benchmark_out={file}", "--benchmark_out_format=json",
             "--benchmark_display_aggregates_only=true"]
    words += [f"--benchmark_repetitions={3 if quick else 7}", f"--benchmark_min_time={0.1 if quick else 0.5}"]
    return words + ([f"--benchmark_filter=^{re.escape(only)}"] if only else [])


def median(values):
    return sorted(values)[len(values) // 2]


def results_of(found):
    """A result for each benchmark, of the medians over its repetitions."""
    runs = {}
    for run in found["benchmarks"]:
        if run["run_type"] == "iteration":
            runs.setdefault(run["run_name"], []).append(run)
    results = []
    for full_name, repetitions in runs.items():
        room, kernel, *more = full_name.split("/")
        size = [word for word in more if word.isdigit()]
        name = f"{room}/{kernel}"
        items = "ns_per_agent" if name in OF_AGENTS else "ns_per_particle"
        unit, counter = FIGURES.get(name, (items, "ns_per_item"))
        series = sorted(run[counter] for run in repetitions)
        extra = {k: median([r[k] for r in repetitions]) for k in repetitions[0] if k not in NO_MEASURE and k != counter}
        results.append({
            "name": name, "size": int(size[0]) if size else 0, "threads": repetitions[0]["threads"],
            "median": median(series), "min": series[0], "max": series[-1], "unit": unit, "repetitions": len(series),
            **extra,
        })  # fmt: skip
    return results
