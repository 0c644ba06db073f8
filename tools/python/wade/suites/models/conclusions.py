"""What the report concludes in words: sentences that follow from the numbers by the rules of rules.py."""

from wade.reports.tables import listed, number, section
from wade.suites.models import rules
from wade.suites.models.drawings import model_words
from wade.suites.paper import bands

GUARDS = (
    "\\*: the limits of the case only guard against a broken coupling; the model is held against the"
    " [impulse on people](#impulse-on-people) instead: its median error must not be larger than"
    f" {rules.SAME_AS:g} times that of DFSPH at the same resolution."
)
NOT_PUSHED = ("S1", "S2", "S3")  # of Table 1: tau 0, so that they are the same in all water


def code(name):
    return f"`{name}`"


def metric_words(judged):
    if judged.value is None:
        return f"{judged.name} not measured"
    value = number(judged.value)
    if judged.ratio > 1 and value == number(judged.limit):  # missed by a hair
        value = number(judged.value, 5)
    return f"{judged.name} {value} of {number(judged.limit)}"


def number_of_cases(count):
    return "1 case" if count == 1 else f"{count} cases"


def words_section(outcomes, models, limits, reasons, table1):
    """table1: {set: [ModelRuns]}."""
    text = (
        "By rule, from the tables below. Of each case the resolution counts at which the model is nearest to the limits. Good enough: it"
        f" keeps all of them; near: it misses one by a factor of {rules.NEAR:g} at most; useless: by more. " + GUARDS)
    of_model = {model: list(model_lines(model, outcomes, limits, reasons, table1)) for model in models}
    return section("In words", text, *(section(model_words(model), "\n".join(f"* {line}" for line in lines), level=3)
                                       for model, lines in of_model.items() if lines))


def model_lines(model, outcomes, limits, reasons, table1):
    cases = list(dict.fromkeys(o.case for o in outcomes))
    graded = rules.by_grade(outcomes, model, cases, limits)
    total = sum(map(len, graded.values()))
    if total:
        counts = ", ".join(f"{grade} in {len(found)}" for grade, found in graded.items())
        yield f"Of {number_of_cases(total)} that it can run: {counts}."
    elif outcomes:
        yield "No case with a limit was run."
    for grade, found in graded.items():
        if found:
            yield f"{grade[0].upper()}{grade[1:]}: {listed(graded_words(run, its, reasons) for run, its in found)}."
    yield from beaten_lines(model, outcomes, cases, limits)
    refused = rules.refusals(outcomes, model)
    if refused:
        yield f"Cannot run {number_of_cases(len(refused))} ([why](#what-a-model-cannot-run))."
    yield from impulse_lines(model, outcomes)
    for of_set in table1.values():
        yield from table1_lines(model, of_set)


def graded_words(run, its, reasons):
    mark = " \\*" if rules.only_guarded(run.case, reasons) else ""
    return f"{code(run.case)}{mark} ({metric_words(its)})" if its.ratio > 1 else f"{code(run.case)}{mark}"


def beaten_lines(model, outcomes, cases, limits):
    """In how many cases a model has no resolution at which no other model is better."""
    beaten, compared = {}, 0
    for case in cases:
        runs = [o for o in rules.judged(outcomes, case, limits) if o.model == model]
        if not runs or len(rules.judged(outcomes, case, limits)) == len(runs):
            continue
        compared += 1
        better = [rules.beaten_by(run, outcomes, limits) for run in runs]
        if all(better):
            for name in {o.model for found in better for o in found}:
                beaten.setdefault(name, []).append(case)
    lost = {case for found in beaten.values() for case in found}
    if compared:
        by = [f"{model_words(name)} in {len(found)}" for name, found in sorted(beaten.items(), key=often_first)]
        text = f"Another model is at most as dear and at most as wrong in {len(lost) or 'none'} of {number_of_cases(compared)}"
        yield text + " that both can run" + (f" ({', '.join(by)})." if by else ".")


def often_first(beaten):
    """An order for (model, cases beaten in): many cases first, equal numbers by the model's name."""
    model, cases = beaten
    return -len(cases), model


def impulse_lines(model, outcomes):
    if model == "dfsph":
        return
    same, worse = [], []
    for o in rules.complete(outcomes, model=model):
        factor = rules.factor_to(o, outcomes, rules.IMPULSE)
        if factor is not None:
            (same if factor <= rules.SAME_AS else worse).append(f"{code(o.case)} {o.level} ({factor:.2g})")
    if same or worse:
        text = "Impulse on people, median error over that of DFSPH at the same resolution:"
        text += f" as small ({rules.SAME_AS:g} at most) in {listed(same)}" if same else " nowhere as small"
        yield text + (f"; larger in {listed(worse)}." if worse else ".")


def table1_lines(model, of_set):
    """Whether a model keeps the paper's bands, and ends the scenarios as DFSPH does."""
    reference = next((runs for runs in of_set if runs.model == "dfsph"), None)
    for runs in of_set:
        if runs.model != model:
            continue
        held = {name: bands.judge_scenario(name, result).holds for name, result in runs.results.items()}
        bad = [name for name, holds in held.items() if not holds]
        text = f"Table 1, set {runs.set}: {len(held) - len(bad)} of {len(held)} bands of the paper met"
        text += f" (not {', '.join(bad)})" if bad else ""
        if reference and runs is not reference:
            pushed = {name: result for name, result in runs.results.items() if name not in NOT_PUSHED}
            verdicts = {name: rules.agrees(result, reference.results.get(name)) for name, result in pushed.items()}
            known = {name: verdict for name, verdict in verdicts.items() if verdict is not None}
            other = [name for name, verdict in known.items() if not verdict]
            text += f"; ends as by DFSPH, within a tenth of time and people, in {len(known) - len(other)} of {len(known)}"
            text += " in which water pushes" + (f" (not {', '.join(other)})" if other else "")
        yield text + "."
