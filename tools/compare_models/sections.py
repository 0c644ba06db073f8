"""The sections of the report: tables, and sentences that follow from them by the rules of rules.py."""

import paths  # noqa: F401  it says where the modules of the other suites are

import bands
import rules
from drawings import IMPULSE_ERRORS, words
from outcomes import COMPLETED, FAILED, LEFT_OUT, REFUSED, missed, worst
from words import arrived_of, markdown_table, shown, time_of

NOT_PUSHED = ("S1", "S2", "S3")  # of Table 1: tau 0, so that they are the same in all water


def short(value):
    return "-" if value is None else f"{value:.3g}"


def seconds(value):
    return "-" if value is None else f"{value:.0f}" if value >= 100 else f"{value:.3g}"


def listed(parts):
    parts = list(parts)
    return parts[0] if len(parts) == 1 else f"{', '.join(parts[:-1])} and {parts[-1]}" if parts else "none"


def code(name):
    return f"`{name}`"


def metric_words(judged):
    if judged.value is None:
        return f"{judged.name} not measured"
    return f"{judged.name} {short(judged.value)} of {short(judged.limit)}"


def cell_of(outcome, limits):
    """One cell of the table case by model."""
    if outcome is None:
        return ""
    if outcome.status == REFUSED:
        return "cannot"
    if outcome.status == LEFT_OUT:
        return "not run"
    if outcome.status == FAILED:
        return "**failed**"
    its = worst(outcome, limits)
    if its is None:
        return f"no limit; {seconds(outcome.cpu)} s"
    verdict = "**missed**" if missed(outcome, limits) else "met"
    return f"{verdict}: {metric_words(its)}; {seconds(outcome.cpu)} s"


def cases_section(outcomes, models, limits):
    by_run = {(o.case, o.level, o.model): o for o in outcomes}
    runs = list(dict.fromkeys((o.case, o.level, o.spacing) for o in outcomes))
    order = list(dict.fromkeys(o.case for o in outcomes))
    runs.sort(key=lambda run: order.index(run[0]))
    lines = []
    for case, level, spacing in runs:
        cells = [by_run.get((case, level, model)) for model in models]
        if any(o is not None and o.status in (COMPLETED, FAILED) for o in cells):
            lines.append([code(case), f"{level}, {spacing:g} m", *(cell_of(o, limits) for o in cells)])
    return (
        "## Case by model\n\nmet or **missed**: all limits of the case at this resolution, and of the errors that have one"
        " the one that is nearest to it or furthest\nabove it, as error of limit; then the CPU time of the solver for the"
        " whole run. A grid has cells as large as the particles are apart.\n`cannot`: the case refuses the model"
        " ([why](#what-a-model-cannot-run)).\n\n"
    ) + markdown_table(["case", "resolution", *map(words, models)], lines)


def cheapest_section(outcomes, models, limits, reasons):
    lines = []
    for case in dict.fromkeys(o.case for o in outcomes):
        able = [m for m in models if any(worst(o, limits) for o in rules.complete(outcomes, case, m))]
        if not able:
            continue
        winner = rules.cheapest(outcomes, case, limits)
        if winner:
            reference = next((o for o in rules.complete(outcomes, case, "dfsph") if o.level == winner.level), None)
            cheaper = ""
            if reference and reference.cost and winner.model != "dfsph" and winner.cost:
                cheaper = f"{reference.cost / winner.cost:.2g}"
            cells = [words(winner.model), winner.level, seconds(winner.cost), cheaper]
        else:
            run, its = rules.nearest(outcomes, case, models, limits)
            cells = [f"none; nearest {words(run.model)}, {metric_words(its)}", run.level, seconds(run.cost), ""]
        mark = " \\*" if rules.only_guarded(case, reasons) else ""
        lines.append([code(case) + mark, *cells, ", ".join(map(words, able))])
    if not lines:
        return ""
    head = ["case", "cheapest that keeps all limits", "resolution", "CPU s a simulated s", "DFSPH costs, times", "models that run"]
    return (
        "## The cheapest model that keeps the limits\n\nOver the models and resolutions that were run; DFSPH costs: at the"
        " same resolution.\n\\*: its limits only guard against a broken coupling; see [the impulse](#impulse-on-people).\n\n"
    ) + markdown_table(head, lines)


def grades_sentences(model, outcomes, limits, reasons):
    """What a model is good for, in a few lines."""

    def starred(case):
        return code(case) + (" \\*" if rules.only_guarded(case, reasons) else "")

    cases = list(dict.fromkeys(o.case for o in outcomes))
    graded = rules.by_grade(outcomes, model, cases, limits)
    of_grade = {g: [f"{starred(run.case)} ({metric_words(its)})" for run, its in pairs] for g, pairs in graded.items()}
    total = sum(map(len, graded.values()))
    if total == 0:
        return f"* **{words(model)}**: no case with a limit was run.\n"
    text = f"* **{words(model)}** keeps the limits of {len(graded[rules.GOOD])} of {total} cases that it can run"
    names = [starred(run.case) for run, _ in graded[rules.GOOD]]
    text += f": {listed(names)}.\n" if names else ".\n"
    if of_grade[rules.CLOSE]:
        text += f"  Near, by a factor of {rules.NEAR:g} at most: {listed(of_grade[rules.CLOSE])}.\n"
    if of_grade[rules.USELESS]:
        text += f"  Useless, further off: {listed(of_grade[rules.USELESS])}.\n"
    refused = rules.refusals(outcomes, model)
    if refused:
        text += f"  Cannot run {len(refused)} other cases ([why](#what-a-model-cannot-run)).\n"
    beaten = {}
    compared = 0
    for case in cases:
        runs = [o for o in rules.complete(outcomes, case, model) if worst(o, limits) and o.cost is not None]
        others = [o for o in rules.complete(outcomes, case) if o.model != model and worst(o, limits)]
        if runs and others:
            compared += 1
            better = [rules.beaten_by(run, outcomes, limits) for run in runs]
            if all(better):
                for name in {o.model for found in better for o in found}:
                    beaten.setdefault(name, []).append(case)
    lost = sorted({case for found in beaten.values() for case in found}, key=cases.index)
    if compared:
        by = ", ".join(f"{words(name)} in {len(found)}" for name, found in sorted(beaten.items(), key=lambda b: -len(b[1])))
        text += f"  Another model is at most as dear and at most as wrong in {len(lost) or 'none'} of {compared} cases that both can run"
        text += f" ({by}).\n" if by else ".\n"
    return text


def words_section(outcomes, models, limits, reasons, table1):
    text = (
        f"## In words\n\nBy rule, from the tables below. Of each case the resolution counts at which the model is nearest to"
        f" the limits. Good enough: it keeps all of them; near: it\nmisses one by less than a factor of {rules.NEAR:g};"
        " useless: by more. Limits of cases with \\* only guard against a broken coupling: for people see"
        " [the impulse](#impulse-on-people).\n\n"
    )
    for model in models if outcomes else ():
        text += grades_sentences(model, outcomes, limits, reasons)
    for model in models:
        text += impulse_sentence(model, outcomes)
    text += cheapest_impulse_sentence(outcomes)
    for of_set in table1.values():
        text += table1_sentences(of_set)
    return text


def impulse_sentence(model, outcomes):
    if model == "dfsph":
        return ""
    same, worse = [], []
    for o in rules.complete(outcomes, model=model):
        factor = rules.factor_to(o, outcomes, "impulse_median")
        if factor is not None:
            (same if factor <= rules.SAME_AS else worse).append(f"{code(o.case)} {o.level} ({factor:.2g})")
    if not same and not worse:
        return ""
    text = f"* Impulse on people by **{words(model)}**, median error over that of DFSPH at the same resolution:"
    text += f" as small ({rules.SAME_AS:g} at most) in {listed(same)}" if same else " nowhere as small"
    return text + (f"; larger in {listed(worse)}.\n" if worse else ".\n")


def cheapest_impulse_sentence(outcomes):
    parts = []
    for case in dict.fromkeys(o.case for o in outcomes):
        run = rules.cheapest_as_exact(outcomes, case, "impulse_median")
        if run is not None:
            parts.append(f"{code(case)} {words(run.model)} ({run.level})")
    if not parts:
        return ""
    return f"* The cheapest whose impulse is as exact as that of DFSPH at the same resolution: {listed(parts)}.\n"


def impulse_section(outcomes, models, picture):
    lines = []
    for o in outcomes:
        if o.status == COMPLETED and o.value("impulse_median") is not None:
            factor = rules.factor_to(o, outcomes, "impulse_median")
            cells = [code(o.case), f"{o.level}, {o.spacing:g} m", words(o.model)]
            cells += [percent(o.value(name)) for name in (*IMPULSE_ERRORS, "outcome_changed")]
            lines.append([*cells, "-" if factor is None or o.model == "dfsph" else f"{factor:.2g}", seconds(o.cpu)])
    if not lines:
        return ""
    head = ["case", "resolution", "model", "median", "95 % of people", "another outcome", "median over DFSPH's", "CPU s"]
    text = (
        "## Impulse on people\n\nThe time integral of the momentum of the water that touches a person who stands; the error"
        " is relative to our own finest run of DFSPH, which is no truth.\nAnother outcome: share of those who walk and end"
        " otherwise than there.\n\n"
    ) + markdown_table(head, lines)
    return text + ("\n![impulse](impulse.png)\n" if picture else "")


def percent(value):
    return "-" if value is None else f"{100 * value:.2g} %"


def cost_words(runs):
    """"0.05", least and most of its waters; wall time where CPU time was not taken."""
    cpu = [cost.cpu for cost in runs.costs.values() if cost.cpu is not None]
    wall = [cost.solver_wall for cost in runs.costs.values() if cost.solver_wall is not None]
    values, unit = (cpu, "") if cpu else (wall, " (wall, solver)")
    if not values:
        return "-"
    low, high = seconds(min(values)), seconds(max(values))
    return (low if low == high else f"{low} to {high}") + unit


def ending(time, arrived):
    """"63 s; all", "nobody"."""
    return "nobody" if time == "-" else f"{time} s; {'all' if arrived in ('50', '50.0') else arrived}"


def ending_of(result):
    if result is None:
        return "not run"
    arrived = "50" if result.arrived[0] == 50 else arrived_of(result)
    return ending(time_of(result), arrived)


def table1_section(of_set, paper, picture):
    """of_set: [ModelRuns] of one set of scenes."""
    lines = []
    for name, row in paper.items():
        results = [runs.results.get(name) for runs in of_set]
        if any(results):
            cells = [name, shown(row["tau"], 1), shown(row["v_f_m_s"], 1), ending(shown(row["time_s"]), shown(row["arrived"]))]
            lines.append(cells + [ending_of(result) for result in results])
    head = ["", "tau", "v_F", "paper", *(words(runs.model) for runs in of_set)]
    judged = {runs.model: [bands.judge_scenario(name, result) for name, result in runs.results.items()] for runs in of_set}
    seeds = {runs.model: sorted({len(result.runs) for result in runs.results.values()}) for runs in of_set}
    facts = []
    for runs in of_set:
        counts = " or ".join(map(str, seeds[runs.model]))
        facts.append([words(runs.model), counts, bands.count_in_words(judged[runs.model]), cost_words(runs),
                      ", ".join(runs.commits), runs.source or "made here"])
    scene_set = of_set[0].set
    text = (
        f"## Table 1, set {scene_set} ({of_set[0].set_up})\n\n`configs/{scene_set}` with another `/fluid/model`. Time of the"
        " last arrival, s, and how many of 50 arrive: means over the seeds\nwith intervals of 95 % (those of arrivals of all or nobody are in"
        " `models_table1.csv`).\n\n"
    ) + markdown_table(head, lines)
    facts_head = ["model", "seeds", "bands of the paper met", "CPU s of the server a simulated s", "programs of commit", "runs"]
    text += "\n" + markdown_table(facts_head, facts)
    return text + (f"\n![Table 1, {scene_set}]({picture})\n" if picture else "")


def table1_sentences(of_set):
    """Which models end the scenarios as DFSPH does."""
    reference = next((runs for runs in of_set if runs.model == "dfsph"), None)
    text = ""
    for runs in of_set:
        judged = {name: bands.judge_scenario(name, result).holds for name, result in runs.results.items()}
        bad = [name for name, holds in judged.items() if not holds]
        text += f"* Table 1, set {runs.set}, **{words(runs.model)}**: {len(judged) - len(bad)} of {len(judged)} bands of the paper"
        text += f" met (missed: {', '.join(bad)})" if bad else " met"
        if reference and runs is not reference:
            verdicts = {name: rules.agrees(result, reference.results.get(name)) for name, result in runs.results.items()}
            known = {name: verdict for name, verdict in verdicts.items() if verdict is not None and name not in NOT_PUSHED}
            other = [name for name, verdict in known.items() if not verdict]
            text += f"; ends as by DFSPH, within a tenth of time and people, in {len(known) - len(other)} of {len(known)} in which"
            text += " water pushes"
            text += f" (not {', '.join(other)})" if other else ""
        text += ".\n"
    return text


def refusals_section(outcomes, models):
    lines = []
    for model in models:
        by_reason = {}
        for case, reason in rules.refusals(outcomes, model).items():
            by_reason.setdefault(reason, []).append(code(case))
        lines += [[words(model), ", ".join(cases), reason.replace("|", "\\|")] for reason, cases in by_reason.items()]
    if not lines:
        return ""
    return "## What a model cannot run\n\nAs the programs say it.\n\n" + markdown_table(["model", "cases", "why"], lines)


def missing_section(outcomes, failures):
    lines = [f"* {code(o.case)} {o.level}, {words(o.model)}: {o.status}, {o.remark}." for o in outcomes
             if o.status in (FAILED, LEFT_OUT)]
    lines += [f"* Table 1: {failure}." for failure in failures]
    return "## Failed or left out\n\n" + "\n".join(lines) + "\n" if lines else ""
