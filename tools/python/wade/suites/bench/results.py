"""Results of benchmarks: lists of {name, size, threads, median, min, max, unit, further measures}."""

import json

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
    return plain(COLUMNS,
                 [(r["name"], count(r["size"]), r["threads"], *(count(r[key]) for key in ("median", "min", "max")),
                            r["unit"]) for r in results])


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
