"""Results of benchmarks: lists of {name, size, threads, median, min, max, unit, further measures}."""

import json
import os
from pathlib import Path

FASTER_IF_LARGER = ("_per_s", "_per_wall_s", "gflops", "gb_s")
ERROR = "mean_density_error_percent"


def key_of(result):
    return result["name"], result["size"], result["threads"]


def larger_is_faster(unit):
    return unit.endswith(FASTER_IF_LARGER)


def read(path):
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def write(path, machine, results):
    """Leaves a complete file or the one that was there."""
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    draft = path.with_name(path.name + ".part")
    draft.write_text(json.dumps({"machine": machine, "results": results}, indent=2) + "\n", encoding="utf-8")
    os.replace(draft, path)


def number(value):
    """A count with separators, or four digits."""
    if value is None:
        return "-"
    if abs(value) >= 1e4:
        return f"{value:,.0f}"
    return f"{value:.4g}"


def table(rows, heads):
    """Lines of a text table; numbers to the right."""
    cells = [[str(c) for c in row] for row in [heads, *rows]]
    widths = [max(len(row[k]) for row in cells) for k in range(len(heads))]
    return ["  ".join(c.ljust(w) if k == 0 else c.rjust(w) for k, (c, w) in enumerate(zip(row, widths))) for row in cells]


def summary(results):
    rows = [
        (r["name"], number(r["size"]), r["threads"], number(r["median"]), number(r["min"]), number(r["max"]), r["unit"])
        for r in results
    ]
    return table(rows, ("name", "size", "threads", "median", "min", "max", "unit"))


def speed_up(before, now):
    """How many times as fast, from the medians."""
    if not before["median"] or not now["median"]:
        return None
    ratio = now["median"] / before["median"]
    return ratio if larger_is_faster(now["unit"]) else 1 / ratio


def comparison(before, now):
    """Lines that set two lists of results side by side; what only one of them has is named at the end."""
    old = {key_of(r): r for r in before}
    rows = []
    for r in now:
        o = old.pop(key_of(r), None)
        if o is None or o["unit"] != r["unit"]:
            continue
        ratio = speed_up(o, r)
        errors = f"{number(o.get(ERROR))} -> {number(r.get(ERROR))}" if ERROR in r or ERROR in o else ""
        rows.append(
            (
                r["name"],
                number(r["size"]),
                r["threads"],
                number(o["median"]),
                number(r["median"]),
                r["unit"],
                "-" if ratio is None else f"{ratio:.3f}",
                errors,
            )
        )
    heads = ("name", "size", "threads", "before", "now", "unit", "times as fast", "density error %")
    lines = table(rows, heads) if rows else ["nothing in common"]
    missing = sorted({name for name, _size, _threads in old})
    if missing:
        lines.append("only before: " + ", ".join(missing))
    return lines
