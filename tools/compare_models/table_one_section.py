"""The table of the report on the scenes of Table 1."""

import paths  # noqa: F401  it says where the modules of the other suites are

import bands
from drawings import model_words
from phrases import seconds
from words import arrived_of, markdown_table, shown, time_of


def ending(time, arrived):
    """"63 s; all", "nobody"."""
    return "nobody" if time == "-" else f"{time} s; {'all' if arrived in ('50', '50.0') else arrived}"


def ending_of(result):
    if result is None:
        return "not run"
    arrived = "50" if result.arrived[0] == 50 else arrived_of(result)
    return ending(time_of(result), arrived)


def cost_words(runs):
    """"0.05", least and most of its waters; wall time where CPU time was not taken."""
    cpu = [cost.cpu for cost in runs.costs.values() if cost.cpu is not None]
    wall = [cost.solver_wall for cost in runs.costs.values() if cost.solver_wall is not None]
    values, unit = (cpu, "") if cpu else (wall, " (wall, solver)")
    if not values:
        return "-"
    low, high = seconds(min(values)), seconds(max(values))
    return (low if low == high else f"{low} to {high}") + unit


def table1_section(of_set, paper, picture):
    """of_set: [ModelRuns] of one set of scenes."""
    lines = []
    for name, row in paper.items():
        results = [runs.results.get(name) for runs in of_set]
        if any(results):
            cells = [name, shown(row["tau"], 1), shown(row["v_f_m_s"], 1)]
            cells.append(ending(shown(row["time_s"]), shown(row["arrived"])))
            lines.append(cells + [ending_of(result) for result in results])
    head = ["", "tau", "v_F", "paper", *(model_words(runs.model) for runs in of_set)]
    facts = []
    for runs in of_set:
        judged = [bands.judge_scenario(name, result) for name, result in runs.results.items()]
        seeds = " or ".join(map(str, sorted({len(result.runs) for result in runs.results.values()})))
        facts.append([model_words(runs.model), seeds, bands.count_in_words(judged), cost_words(runs),
                      ", ".join(runs.commits), runs.source or "made here"])
    scene_set = of_set[0].set
    text = (
        f"## Table 1, set {scene_set} ({of_set[0].set_up})\n\n`configs/{scene_set}` with another `/fluid/model`. Time of the"
        " last arrival, s, and how many of 50 arrive: means over the seeds\nwith intervals of 95 % (those of"
        " arrivals of all or nobody are in `models_table1.csv`).\n\n"
    ) + markdown_table(head, lines)
    facts_head = ["model", "seeds", "bands of the paper met", "CPU s of the server a simulated s", "programs of commit"]
    facts_head.append("runs")
    text += "\n" + markdown_table(facts_head, facts)
    return text + (f"\n![Table 1, {scene_set}]({picture})\n" if picture else "")
