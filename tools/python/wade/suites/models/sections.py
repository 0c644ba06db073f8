"""The tables of the report."""

from wade.reports.tables import markdown, number, section
from wade.suites.models import rules
from wade.suites.models.drawings import IMPULSE_ERRORS, model_words
from wade.suites.models.outcomes import COMPLETED, FAILED, LEFT_OUT, REFUSED, missed, worst


GUARDS = ("\\*: the limits of the case only guard against a broken coupling; the model is held against the"
          " [impulse on people](#impulse-on-people) instead: its median error must not be larger than"
          f" {rules.SAME_AS:g} times that of DFSPH at the same resolution.")


def code(name):
    return f"`{name}`"


def metric_words(judged):
    if judged.value is None:
        return f"{judged.name} not measured"
    value = number(judged.value)
    if judged.ratio > 1 and value == number(judged.limit):  # missed by a hair
        value = number(judged.value, 5)
    return f"{judged.name} {value} of {number(judged.limit)}"


def grades_section(outcomes, models, limits, reasons):
    """What each model is good for: its cases by how near its best resolution comes to their limits."""

    def words(run, its):
        mark = " \\*" if rules.only_guarded(run.case, reasons) else ""
        return f"{code(run.case)}{mark}" + (f" ({metric_words(its)})" if its.ratio > 1 else "")

    cases = list(dict.fromkeys(o.case for o in outcomes))
    lines = []
    for model in models:
        graded = rules.by_grade(outcomes, model, cases, limits)
        lines.append([model_words(model),
                      *(f"{len(found)}: {', '.join(words(*pair) for pair in found)}" if found else "0"
                                            for found in graded.values()), len(rules.refusals(outcomes, model))])
    text = (
        "Of each case the resolution counts at which the model is nearest to the limits. Good enough: it keeps all of "
        f"them; near: it misses one by a factor of {rules.NEAR:g} at most; useless: by more. {GUARDS}")
    head = ("model", rules.GOOD, rules.CLOSE, rules.USELESS, "[cannot run](#what-a-model-cannot-run)")
    return section("What each model is good for", text, markdown(head, lines)) if outcomes else ""


def seconds(value):
    return "-" if value is None else f"{value:.0f}" if value >= 100 else f"{value:.3g}"


def percent(value):
    if value is None:
        return "-"
    return f"{100 * value:.0f} %" if value >= 1 else f"{100 * value:.2g} %"


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
    text = (
        "met or **missed**: all limits of the case at this resolution, and of the errors that have one the one that is "
        "nearest to it or furthest above it, as error of limit; then the CPU time of the solver for the whole run. A "
        "grid has cells as large as the particles are apart. `cannot`: the case refuses the model "
        "([why](#what-a-model-cannot-run)).")
    return section("Case by model", text, markdown(["case", "resolution", *map(model_words, models)], lines))


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
    text = f"Over the models and resolutions that were run; DFSPH costs: at the same resolution. {GUARDS}"
    return section("The cheapest model that keeps the limits", text, markdown(head, lines))


def impulse_section(outcomes):
    lines = []
    for o in outcomes:
        if o.status == COMPLETED and o.value(rules.IMPULSE) is not None:
            factor = rules.factor_to(o, outcomes, rules.IMPULSE)
            cells = [code(o.case), f"{o.level}, {o.spacing:g} m", model_words(o.model)]
            cells += [percent(o.value(name)) for name in (*IMPULSE_ERRORS, "outcome_changed")]
            lines.append([*cells, "-" if factor is None or o.model == "dfsph" else f"{factor:.2g}", seconds(o.cpu)])
    if not lines:
        return ""
    head = ["case", "resolution", "model", "median", "95 % of people", "another outcome", "median over DFSPH's",
            "CPU s"]
    text = (
        "The time integral of the momentum of the water that touches a person who stands; the error is relative to our "
        "own finest run of DFSPH, which is no truth. Another outcome: share of those who walk and end otherwise than "
        "there.")
    return section("Impulse on people", text, markdown(head, lines))


def refusals_section(outcomes, models):
    lines = []
    for model in models:
        by_reason = {}
        for case, reason in rules.refusals(outcomes, model).items():
            by_reason.setdefault(reason, []).append(code(case))
        for reason, cases in by_reason.items():
            lines.append([model_words(model), ", ".join(cases), reason])
    if not lines:
        return ""
    return section("What a model cannot run", "As the programs say it.", markdown(["model", "cases", "why"], lines))


def missing_section(outcomes):
    lines = [f"* {code(o.case)} {o.level}, {model_words(o.model)}: {o.status}, {o.remark}." for o in outcomes
             if o.status in (FAILED, LEFT_OUT)]
    return section("Failed or left out", "\n".join(lines))
