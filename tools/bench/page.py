"""The page that --out writes: rates beside errors, the profile of a step, and the distance from the machine's bounds."""

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

import goals  # noqa: E402
from machine import machine_text  # noqa: E402
from results import larger_is_faster, number, speed_up  # noqa: E402

STAGE = "_ns_per_particle_step"
ALONE = ("machine/fma_peak", "machine/stream")
SWEEPS = ("kernels/pressure_sweep", "kernels/rate_sweep", "kernels/kernel_sweep")

# A pair costs a pressure or rate sweep this many vector operations a lane at least: three differences of places, the factor
# widened from 16 bits, moved to its lane (two) and turned into a number, its product with the scalar, three multiply-adds.
OPERATIONS_OF_A_PAIR = 11
# What a sweep reads and writes of a particle beside the lists: place, scalar or velocity, sums; 4 bytes each.
BYTES_OF_A_PARTICLE = 28


def named(results, name, threads=1):
    """Those with one thread, unless another number is asked for."""
    return [r for r in results if r["name"] == name and r["threads"] == threads]


def figure_of(results, name):
    found = named(results, name)
    return found[0]["median"] if found else None


def markdown(heads, rows):
    lines = ["| " + " | ".join(heads) + " |", "|" + "---|" * len(heads)]
    return lines + ["| " + " | ".join(str(c) for c in row) + " |" for row in rows]


def label(result):
    return f"{result['name']} {number(result['size'])}, {result['threads']} thr."


def rates(results):
    """Lines: what every benchmark gave."""
    rows = [
        (r["name"], number(r["size"]), r["threads"], number(r["median"]), f"{number(r['min'])} to {number(r['max'])}", r["unit"])
        for r in results
    ]
    return markdown(("name", "size", "threads", "median", "least to most", "unit"), rows)


def errors(results):
    """Lines: work and error of a step of the water."""
    rows = []
    for r in results:
        if "mean_density_error_percent" not in r or "divergence_iterations_per_step" not in r:
            continue
        rows.append(
            (
                r["name"],
                number(r["size"]),
                r["threads"],
                number(r["median"]),
                f"{r['divergence_iterations_per_step']:.2f} + {r['density_iterations_per_step']:.2f}",
                number(r["sweeps_per_step"]),
                number(r["pairs_per_particle"]),
                number(r["bytes_per_particle"]),
                f"{r['mean_density_error_percent']:.3g}",
                f"{r['max_density_error_percent']:.3g}",
            )
        )
    heads = ("name", "particles", "threads", "particle-steps/s", "iterations, divergence + density", "sweeps", "pairs",
             "bytes a particle", "density error, mean %", "most %")  # fmt: skip
    return markdown(heads, rows) if rows else []


def bounds(results):
    """Lines: kernels beside what the core and the memory allow, from the figures of machine/... of the same run."""
    peak, stream = figure_of(results, "machine/fma_peak"), figure_of(results, "machine/stream")
    if not peak or not stream:
        return []
    lane_operations = 1e9 * peak / 2  # a multiply-add counts as two
    pairs_at_most = lane_operations / OPERATIONS_OF_A_PAIR
    rows = []
    for r in [r for name in SWEEPS for r in named(results, name)]:
        nanoseconds, pairs = r["median"], r["pairs_per_particle"]
        lanes = r["lanes_in_use_percent"] / 100
        moved = r["list_bytes_per_particle"] + BYTES_OF_A_PARTICLE
        useful = 1e9 * pairs / nanoseconds
        rows.append(
            (
                r["name"],
                number(r["size"]),
                f"{nanoseconds:.1f}",
                number(useful / 1e6),
                f"{100 * lanes:.0f} %",
                f"{100 * useful / pairs_at_most:.0f} %",
                f"{100 * useful / lanes / pairs_at_most:.0f} %",
                number(moved),
                f"{100 * moved / nanoseconds / stream:.0f} %",
            )
        )
    text = [
        f"One core makes {peak:.0f} GFLOP/s of multiply-adds in registers and moves {stream:.1f} GB/s. A pair costs a sweep at "
        f"least {OPERATIONS_OF_A_PAIR} vector operations a lane, so that no core makes more than {pairs_at_most / 1e6:,.0f} M pairs/s. "
        "A lane whose particle is too far away works for nothing: the last two columns of shares count useful pairs, and all lanes. "
        "Shares of the bandwidth hold for sizes that no cache holds.",
        "",
    ]
    heads = ("sweep", "particles", "ns a particle", "useful M pairs/s", "lanes in use", "of the bound", "of the bound, all lanes",
             "bytes a particle", "of the bandwidth")  # fmt: skip
    return text + markdown(heads, rows)


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
        rows.append((r["name"], number(r["size"]), r["threads"], f"{total:.0f}", *shares))
    return markdown(("name", "particles", "threads", "all", *(n.replace("_", " ") for n in names)), rows) if rows else []


def bytes_of_steps(results):
    """Lines: what the sweeps of a step move, beside the bandwidth that the measured rate then takes."""
    stream = figure_of(results, "machine/stream")
    rows = []
    for r in results:
        if not stream or not r.get("sweeps_per_step"):
            continue
        moved = r["sweeps_per_step"] * (r["list_bytes_per_particle"] + BYTES_OF_A_PARTICLE)
        taken = 1e-9 * moved * r["median"]
        rows.append(
            (r["name"], number(r["size"]), r["threads"], number(r["list_bytes_per_particle"]), number(moved), f"{taken:.1f}",
             f"{100 * taken / stream / r['threads']:.0f} %")  # fmt: skip
        )
    heads = ("name", "particles", "threads", "list bytes a particle", "bytes a particle-step", "GB/s", "of the bandwidth")
    return markdown(heads, rows) if rows else []


def growth(results):
    """Lines: what an item costs in a large case, over what it costs in the smallest of the same kind."""
    rows = []
    for r in results:
        if not r["name"].startswith(("fluid/growth", "crowd/open_plane")) or not r["unit"].endswith("steps_per_s"):
            continue
        same = [s for s in results if (s["name"], s["threads"]) == (r["name"], r["threads"]) and s["size"] >= 1000]
        smallest = min(same, key=lambda s: s["size"], default=None)
        if smallest is None or r["size"] <= smallest["size"]:
            continue
        rows.append((r["name"], number(smallest["size"]), number(r["size"]), r["threads"], f"{smallest['median'] / r['median']:.2f}"))
    return markdown(("name", "from", "to", "threads", "cost of an item, times"), rows) if rows else []


def second_processor(results):
    """Lines: what two threads gain, beside what two programs gain that need not wait for each other."""
    rows = []
    for one in [r for r in results if r["threads"] == 1]:
        for two in named(results, one["name"], 2):
            if two["size"] == one["size"] and (larger_is_faster(one["unit"]) or one["unit"].startswith("ns_per_")):
                free = "they share nothing" if one["name"] in ALONE else "they wait for nothing" if one["name"] in SWEEPS else ""
                rows.append((one["name"], number(one["size"]), f"{speed_up(one, two):.2f}", free))
    if not rows:
        return []
    text = [
        "Work in the same time with two threads, times that with one. The first rows bound the others: where two copies that need not wait for each other do not do twice as "
        "much, the two processors share something, such as a core or its clock.",
        "",
    ]
    return text + markdown(("name", "size", "times", ""), rows)


def goals_of(results):
    rows = goals.rows_of(results, OPERATIONS_OF_A_PAIR)
    if not rows:
        return []
    text = [
        "Goals set for two cores of 2.5 GHz before anything was built, judged by the median. The last column: particle-steps a second if each sweep of the two solves took only what "
        f"{OPERATIONS_OF_A_PAIR} operations a lane cost a core that makes multiply-adds at its peak, all else as measured.",
        "",
    ]
    heads = ("name", "size", "threads", "goal", "median", "best", "unit", "reached", "with the solves at the bound")
    return text + markdown(heads, rows)


def features(results):
    rows = [
        (r["name"].split("/")[1].replace("_", " "), f"{r['median']:.3f}", f"{r['min']:.3f} to {r['max']:.3f}", r["pairs"],
         r["counted"], f"{r['cpu_s_without']:.2f}")  # fmt: skip
        for r in results
        if r["name"].startswith("features/")
    ]
    if not rows:
        return []
    text = [
        "Processor time with the feature over that without, medians of pairs of runs that take turns. `off` sets the feature to "
        "what it is without a word (viscosity to 0, where it is 0.01 without); how far its interval lies from 1 is how exactly this machine can tell. A feature that is off is a "
        "test a step in the same program, so that no build without it stands beside.",
        "",
    ]
    return text + markdown(("feature", "times", "interval", "pairs", "time of", "s without"), rows)


def draw_profile(results, file):
    staged = [r for r in results if stages_of(r)]
    if not staged:
        return False
    figure, axes = plt.subplots(figsize=(10, 0.8 + 0.45 * len(staged)), layout="constrained")
    left = [0.0] * len(staged)
    for k, name in enumerate(stages_of(staged[0])):
        widths = [stages_of(r).get(name, 0) for r in staged]
        axes.barh(range(len(staged)), widths, left=left, label=name.replace("_", " "), color=plt.cm.tab10(k))
        left = [a + b for a, b in zip(left, widths)]
    axes.set_yticks(range(len(staged)), [label(r) for r in staged])
    axes.invert_yaxis()
    axes.set_xlabel("wall time of a particle-step, ns")
    axes.legend(loc="center left", bbox_to_anchor=(1.01, 0.5), frameon=False)
    figure.savefig(file, dpi=110)
    plt.close(figure)
    return True


def draw_roofline(results, file):
    peak, stream = figure_of(results, "machine/fma_peak"), figure_of(results, "machine/stream")
    sweeps = [r for name in SWEEPS for r in named(results, name)]
    if not peak or not stream or not sweeps:
        return False
    at_most = 1e3 * peak / 2 / OPERATIONS_OF_A_PAIR  # M pairs/s
    figure, axes = plt.subplots(figsize=(8, 5.2), layout="constrained")
    intensities = [10 ** (-2.5 + 0.05 * k) for k in range(71)]  # pairs a byte
    axes.loglog(intensities, [min(at_most, 1e3 * stream * i) for i in intensities], color="black", label="bound of one core")
    for k, name in enumerate(SWEEPS):
        for r in named(results, name):
            moved = r["list_bytes_per_particle"] + BYTES_OF_A_PARTICLE
            rate = 1e3 * r["pairs_per_particle"] / r["median"]
            lanes = r["lanes_in_use_percent"] / 100
            x = r["pairs_per_particle"] / moved
            first = r is named(results, name)[0]
            # The lanes that work for nothing count as pairs, too: more of them a second, and more a byte.
            axes.plot([x, x / lanes], [rate, rate / lanes], color=plt.cm.tab10(k), alpha=0.5)
            axes.plot(x, rate, "o", color=plt.cm.tab10(k), label=f"{name.split('/')[1].replace('_', ' ')}, useful pairs" if first else None)
            axes.plot(x / lanes, rate / lanes, "^", mfc="white", color=plt.cm.tab10(k), label="the same, all lanes" if first else None)
            # Sizes to the left, where no line is; each sweep has a column of its own, as sweeps may be equally fast.
            axes.annotate(number(r["size"]), (x, rate), xytext=(-6 - 45 * k, -3), textcoords="offset points", ha="right", fontsize=8, color=plt.cm.tab10(k))
    axes.set_xlim(1e-2, 3)
    axes.set_ylim(50, 3 * at_most)
    axes.set_xlabel("pairs a byte read or written")
    axes.set_ylabel("million pairs a second and core")
    axes.grid(alpha=0.3, which="both")
    axes.legend(fontsize=8)
    figure.savefig(file, dpi=110)
    plt.close(figure)
    return True


def write_page(folder, machine, results, quick):
    folder.mkdir(parents=True, exist_ok=True)
    lines = ["# Benchmarks", "", f"Written by `tools/bench.sh --out`{', with `--quick`' if quick else ''}. {machine_text(machine)}."]
    if machine["busy"]:
        lines += ["", "**Other programs used the machine: times are too long, only ratios within a program mean something.**"]
    sections = (
        ("Goals", goals_of(results), None, None),
        ("All figures", rates(results), None, None),
        ("Work and error of the water", errors(results), None, None),
        ("Profile of a step, ns of wall time a particle-step", profile(results), draw_profile, "profile.png"),
        ("Sweeps beside the bounds of the machine", bounds(results), draw_roofline, "roofline.png"),
        ("Bytes of a step", bytes_of_steps(results), None, None),
        ("What a second processor gains", second_processor(results), None, None),
        ("Growth with size", growth(results), None, None),
        ("Features that are off and on", features(results), None, None),
    )
    for title, text, draw, picture in sections:
        if not text:
            continue
        lines += ["", f"## {title}", "", *text]
        if draw and draw(results, folder / picture):
            lines += ["", f"![{title}]({picture})"]
    (folder / "bench.md").write_text("\n".join(lines) + "\n", encoding="utf-8")
