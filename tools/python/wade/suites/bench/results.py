"""Results of benchmarks: lists of {name, size, threads, median, min, max, unit, further measures}; and bench_kernels, a program of
Google Benchmark: how it is called, and its results in the form of the others.
"""

import json
import os
import re

from wade.reports.files import write_whole
from wade.reports.tables import count, plain, write_csv

FASTER_IF_LARGER = ("_per_s", "_per_wall_s", "gflops", "gb_s")
ERROR = "mean_density_error_percent"
COLUMNS = ("name", "size", "threads", "median", "min", "max", "unit")


def key_of(result):
    return result["name"], result["size"], result["threads"]


def larger_is_faster(unit):
    return unit.endswith(FASTER_IF_LARGER)


def read(path):
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def write(path, machine, results):
    """Leaves a complete file or the one that was there."""
    write_whole(path, json.dumps({"machine": machine, "results": results}, indent=2) + "\n")


def write_table(path, results):
    write_csv(path, COLUMNS, results)


def summary(results):
    return plain(COLUMNS, [(r["name"], count(r["size"]), r["threads"],
                            *(count(r[key]) for key in ("median", "min", "max")), r["unit"]) for r in results])


def speed_up(before, now):
    """How many times as fast, from the medians."""
    if not before["median"] or not now["median"]:
        return None
    ratio = now["median"] / before["median"]
    return ratio if larger_is_faster(now["unit"]) else 1 / ratio


def comparison(before, now):
    """Two lists of results side by side; what only one of them has is named at the end."""
    old = {key_of(r): r for r in before}
    rows = []
    for r in now:
        o = old.pop(key_of(r), None)
        if o is None or o["unit"] != r["unit"]:
            continue
        ratio = speed_up(o, r)
        errors = f"{count(o.get(ERROR))} -> {count(r.get(ERROR))}" if ERROR in r or ERROR in o else ""
        rows.append((r["name"], count(r["size"]), r["threads"], count(o["median"]), count(r["median"]), r["unit"],
                     "-" if ratio is None else f"{ratio:.3f}", errors))
    heads = ("name", "size", "threads", "before", "now", "unit", "times as fast", "density error %")
    missing = sorted({name for name, _size, _threads in old})
    text = plain(heads, rows) if rows else "nothing in common"
    return text + (f"\nonly before: {', '.join(missing)}" if missing else "")


# Name: (unit, counter that holds the figure). The kernels give the processor time of a particle or an agent.
FIGURES = {"machine/fma_peak": ("gflops", "gflops"), "machine/stream": ("gb_s", "gb_s")}
OF_AGENTS = ("kernels/contacts", "kernels/dry_crowd_step")
NO_MEASURE = {
    "name", "family_index", "per_family_instance_index", "run_name", "run_type", "repetitions", "repetition_index",
    "threads", "iterations", "real_time", "cpu_time", "time_unit", "ns_per_item",
}  # fmt: skip


def kernel_command(program, file, only, quick):
    if quick:
        os.environ["WADE_BENCH_QUICK"] = "1"
    words = [program, f"--benchmark_out={file}", "--benchmark_out_format=json",
             "--benchmark_display_aggregates_only=true"]
    words += [f"--benchmark_repetitions={3 if quick else 7}", f"--benchmark_min_time={0.1 if quick else 0.5}"]
    return words + ([f"--benchmark_filter=^{re.escape(only)}"] if only else [])


def median(values):
    return sorted(values)[len(values) // 2]


def kernel_results(found):
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
