"""The tables of the report on the validation cases."""

import paths  # noqa: F401  it says where the modules of the other suites are

import rules
from conclusions import GUARDS
from drawings import IMPULSE_ERRORS, model_words
from outcomes import COMPLETED, FAILED, LEFT_OUT, REFUSED, missed, worst
from phrases import code, metric_words, percent, seconds
from words import markdown_table


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
    if not lines:
        return ""
    return (
        "## Case by model\n\nmet or **missed**: all limits of the case at this resolution, and of the errors that have one"
        " the one that is nearest to it or furthest\nabove it, as error of limit; then the CPU time of the solver for the"
        " whole run. A grid has cells as large as the particles are apart.\n`cannot`: the case refuses the model"
        " ([why](#what-a-model-cannot-run)).\n\n"
    ) + markdown_table(["case", "resolution", *map(model_words, models)], lines)


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
                factor = reference.cost / winner.cost
                cheaper = f"{factor:.0f}" if factor >= 10 else f"{factor:.2g}"
            cells = [model_words(winner.model), winner.level, seconds(winner.cost), cheaper]
        else:
            run, its = rules.nearest(outcomes, case, models, limits)
            cells = [f"none; nearest {model_words(run.model)}, {metric_words(its)}", run.level, seconds(run.cost), ""]
        mark = " \\*" if rules.only_guarded(case, reasons) else ""
        lines.append([code(case) + mark, *cells, ", ".join(map(model_words, able))])
    if not lines:
        return ""
    head = ["case", "cheapest that keeps all limits", "resolution", "CPU s a simulated s", "DFSPH costs, times"]
    head.append("models that run")
    return (
        "## The cheapest model that keeps the limits\n\nOver the models and resolutions that were run; DFSPH costs: at the"
        " same resolution.\n" + GUARDS + "\n\n"
    ) + markdown_table(head, lines)


def impulse_section(outcomes, models, picture):
    lines = []
    for o in outcomes:
        if o.status == COMPLETED and o.value(rules.IMPULSE) is not None:
            factor = rules.factor_to(o, outcomes, rules.IMPULSE)
            cells = [code(o.case), f"{o.level}, {o.spacing:g} m", model_words(o.model)]
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


def refusals_section(outcomes, models):
    lines = []
    for model in models:
        by_reason = {}
        for case, reason in rules.refusals(outcomes, model).items():
            by_reason.setdefault(reason, []).append(code(case))
        for reason, cases in by_reason.items():
            lines.append([model_words(model), ", ".join(cases), reason.replace("|", "\\|")])
    if not lines:
        return ""
    return "## What a model cannot run\n\nAs the programs say it.\n\n" + markdown_table(["model", "cases", "why"], lines)


def missing_section(outcomes, failures):
    lines = [f"* {code(o.case)} {o.level}, {model_words(o.model)}: {o.status}, {o.remark}." for o in outcomes
             if o.status in (FAILED, LEFT_OUT)]
    lines += [f"* Table 1: {failure}." for failure in failures]
    return "## Failed or left out\n\n" + "\n".join(lines) + "\n" if lines else ""
