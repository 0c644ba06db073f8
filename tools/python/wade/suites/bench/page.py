"""The page that --out writes: rates beside errors, the profile of a step, and the distance from the machine's bounds."""

from wade.reports.files import write_whole
from wade.reports.machine import machine_text
from wade.reports.plots import pyplot, save
from wade.reports.tables import count, document, markdown, section
from wade.suites.bench.results import larger_is_faster, speed_up

# Name, size, threads, goal, whether it is a least ("at least") or a most.
GOALS = (
    ("fluid/dam_break", 8_000, 1, 1.5e6, "at least"),
    ("fluid/dam_break", 8_000, 2, 3e6, "at least"),
    ("fluid/river", 21_600, 2, 4e6, "at least"),
    ("fluid/river", 100_000, 2, 3e6, "at least"),
    ("fluid/river", 1_000_000, 2, 2e6, "at least"),
    ("kernels/list_build", 100_000, 1, 100, "at most"),
    ("kernels/pressure_sweep", 100_000, 1, 45, "at most"),
    ("crowd/open_plane", 1_000, 1, 4e6, "at least"),
    ("crowd/open_plane", 100_000, 1, 4e6, "at least"),
    ("crowd/open_plane bodies fast", 1_000, 1, 2.5e6, "at least"),
    ("crowd/open_plane bodies human", 1_000, 1, 2.5e6, "at least"),
    ("shallow_water/river", 10_800, 1, 30e6, "at least"),
    ("end_to_end/s05", None, 2, 5, "at least"),
    ("end_to_end/fine", None, 2, 0.4, "at least"),
    ("end_to_end/people_5000", None, 2, 1, "at least"),
    ("end_to_end/town", None, 2, 1, "at least"),
    ("end_to_end/beside_busy_programs", None, 2, 0.8, "at least"),
    ("end_to_end/pairs_at_once", None, 2, 0.8, "at least"),
    ("coupling/two_way", None, 1, 10, "at most"),
    ("coupling/measured", None, 1, 2, "at most"),
)
STAGE = "_ns_per_particle_step"
ALONE = ("machine/fma_peak", "machine/stream")
SWEEPS = ("kernels/pressure_sweep", "kernels/rate_sweep", "kernels/kernel_sweep")

# Least number of vector operations a lane for a pair in a pressure or rate loop over neighbours: three differences of
# positions; the factor widened from 16 bits, moved to its lane (two) and turned into a number; its product with the
# scalar; three multiply-adds.
OPERATIONS_OF_A_PAIR = 11
# What a loop over neighbours reads and writes of a particle beside the lists: position, scalar or velocity, sums; each
# number has 4 bytes.
BYTES_OF_A_PARTICLE = 28


def named(results, name, threads=1):
    """Those with one thread, unless another number is asked for."""
    return [r for r in results if r["name"] == name and r["threads"] == threads]


def figure_of(results, name):
    found = named(results, name)
    return found[0]["median"] if found else None


def table(heads, rows):
    """"" without rows."""
    return markdown(heads, rows) if rows else ""


def label(result):
    return f"{result['name']} {count(result['size'])}, {result['threads']} thr."


def rates(results):
    """What every benchmark gave."""
    return table(("name", "size", "threads", "median", "least to most", "unit"), [
        (r["name"], count(r["size"]), r["threads"], count(r["median"]), f"{count(r['min'])} to {count(r['max'])}",
         r["unit"])
        for r in results])


def errors(results):
    """Work and error of a step of the water."""
    heads = ("name", "particles", "threads", "particle-steps/s", "iterations, divergence + density", "sweeps", "pairs",
             "bytes a particle", "density error, mean %", "most %")
    return table(heads, [(r["name"], count(r["size"]), r["threads"], count(r["median"]),
                          f"{r['divergence_iterations_per_step']:.2f} + {r['density_iterations_per_step']:.2f}",
                          count(r["sweeps_per_step"]), count(r["pairs_per_particle"]), count(r["bytes_per_particle"]),
                          f"{r['mean_density_error_percent']:.3g}", f"{r['max_density_error_percent']:.3g}")
                         for r in results if "mean_density_error_percent" in r
                         and "divergence_iterations_per_step" in r])


def bounds(results):
    """Kernels beside what the core and the memory allow, from the figures of machine/... of the same run."""
    peak, stream = figure_of(results, "machine/fma_peak"), figure_of(results, "machine/stream")
    if not peak or not stream:
        return ""
    lane_operations = 1e9 * peak / 2  # a multiply-add counts as two
    pairs_at_most = lane_operations / OPERATIONS_OF_A_PAIR
    rows = []
    for r in [r for name in SWEEPS for r in named(results, name)]:
        nanoseconds, pairs = r["median"], r["pairs_per_particle"]
        lanes = r["lanes_in_use_percent"] / 100
        moved = r["list_bytes_per_particle"] + BYTES_OF_A_PARTICLE
        useful = 1e9 * pairs / nanoseconds
        rows.append((r["name"], count(r["size"]), f"{nanoseconds:.1f}", count(useful / 1e6), f"{100 * lanes:.0f} %",
                     f"{100 * useful / pairs_at_most:.0f} %", f"{100 * useful / lanes / pairs_at_most:.0f} %",
                     count(moved), f"{100 * moved / nanoseconds / stream:.0f} %"))
    text = (
        f"One core makes {peak:.0f} GFLOP/s of multiply-adds in registers and moves {stream:.1f} GB/s. A pair costs a "
        f"sweep at least {OPERATIONS_OF_A_PAIR} vector operations a lane, so that no core makes more than "
        f"{pairs_at_most / 1e6:,.0f} M pairs/s. A lane whose particle is too far away works for nothing: the last two "
        "columns of shares count useful pairs, and all lanes. Shares of the bandwidth hold for sizes that no cache "
        "holds.\n\n")
    heads = ("sweep", "particles", "ns a particle", "useful M pairs/s", "lanes in use", "of the bound",
             "of the bound, all lanes", "bytes a particle", "of the bandwidth")
    return text + table(heads, rows)


def stages_of(result):
    return {k[: -len(STAGE)]: v for k, v in result.items() if k.endswith(STAGE)}


def profile(results):
    rows = []
    staged = [r for r in results if stages_of(r)]
    names = list(stages_of(staged[0])) if staged else []
    for r in staged:
        stages = stages_of(r)
        total = sum(stages.values())
        shares = [f"{v:.0f} ({100 * v / total:.0f} %)" for v in stages.values()]
        rows.append((r["name"], count(r["size"]), r["threads"], f"{total:.0f}", *shares))
    text = table(("name", "particles", "threads", "all", *(n.replace("_", " ") for n in names)), rows)
    return text + "\n![profile](profile.png)\n" if rows else ""


def growth(results):
    """What an item costs in a large case, over what it costs in the smallest of the same kind."""
    rows = []
    for r in results:
        if not r["name"].startswith(("fluid/growth", "crowd/open_plane")) or not r["unit"].endswith("steps_per_s"):
            continue
        same = [s for s in results if (s["name"], s["threads"]) == (r["name"], r["threads"]) and s["size"] >= 1000]
        smallest = min(same, key=lambda s: s["size"], default=None)
        if smallest is None or r["size"] <= smallest["size"]:
            continue
        rows.append((r["name"], count(smallest["size"]), count(r["size"]), r["threads"],
                     f"{smallest['median'] / r['median']:.2f}"))
    return table(("name", "from", "to", "threads", "cost of an item, times"), rows)


def second_processor(results):
    """What two threads gain, beside what two programs gain that need not wait for each other."""
    rows = []
    for one in [r for r in results if r["threads"] == 1]:
        for two in named(results, one["name"], 2):
            if two["size"] == one["size"] and (larger_is_faster(one["unit"]) or one["unit"].startswith("ns_per_")):
                free = "they share nothing" if one["name"] in ALONE else "they wait for nothing" if one["name"] in SWEEPS else ""
                rows.append((one["name"], count(one["size"]), f"{speed_up(one, two):.2f}", free))
    text = (
        "Work in the same time with two threads, times that with one. The first rows bound the others: where two "
        "copies that need not wait for each other do not do twice as much, the two processors share something, such as "
        "a core or its clock.\n\n")
    return text + table(("name", "size", "times", ""), rows) if rows else ""


def goals_of(results):
    """The goals of speed beside what was measured."""
    rows = []
    for name, size, threads, goal, side in GOALS:
        r = next((r for r in named(results, name, threads) if size in (None, r["size"])), None)
        if r is None:
            continue
        best = r["max"] if side == "at least" else r["min"]
        reached = [value >= goal if side == "at least" else value <= goal for value in (r["median"], best)]
        words = "yes" if reached[0] else "in the best round" if reached[1] else f"no, {r['median'] / goal:.2f} of it"
        rows.append((name, count(r["size"]), threads, f"{side} {count(goal)}", count(r["median"]), count(best),
                     r["unit"], words))
    text = "Goals set for two cores of 2.5 GHz before anything was built, judged by the median.\n\n"
    return text + table(("name", "size", "threads", "goal", "median", "best", "unit", "reached"), rows) if rows else ""


def draw_profile(results, file):
    staged = [r for r in results if stages_of(r)]
    if not staged:
        return
    figure, axes = pyplot.subplots(figsize=(10, 0.8 + 0.45 * len(staged)), layout="constrained")
    left = [0.0] * len(staged)
    for k, name in enumerate(stages_of(staged[0])):
        widths = [stages_of(r).get(name, 0) for r in staged]
        axes.barh(range(len(staged)), widths, left=left, label=name.replace("_", " "), color=pyplot.cm.tab10(k))
        left = [a + b for a, b in zip(left, widths)]
    axes.set_yticks(range(len(staged)), [label(r) for r in staged])
    axes.invert_yaxis()
    axes.set_xlabel("wall time of a particle-step, ns")
    axes.legend(loc="center left", bbox_to_anchor=(1.01, 0.5))
    axes.grid(False)
    save(figure, file)


BUSY = "**Other programs used the machine: times are too long, only ratios within a program mean something.**"


def write(folder, machine, results, quick):
    """report.md and its picture."""
    draw_profile(results, folder / "profile.png")
    sections = (
        ("Goals", goals_of),
        ("All figures", rates),
        ("Work and error of the water", errors),
        ("Profile of a step, ns of wall time a particle-step", profile),
        ("Sweeps beside the bounds of the machine", bounds),
        ("What a second processor gains", second_processor),
        ("Growth with size", growth),
    )
    written = f"Written by `tools/wade bench --out`{', with `--quick`' if quick else ''}. {machine_text(machine)}."
    parts = [section("Benchmarks", written, BUSY if machine["busy"] else "", level=1)]
    for title, text_of in sections:
        if text := text_of(results):
            parts.append(section(title, text))
    write_whole(folder / "report.md", document(*parts))
