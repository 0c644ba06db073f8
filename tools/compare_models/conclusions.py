"""What the report concludes in words: sentences that follow from the numbers by the rules of rules.py."""

import paths  # noqa: F401  it says where the modules of the other suites are

import bands
import rules
from drawings import model_words
from outcomes import worst
from phrases import code, listed, metric_words

NOT_PUSHED = ("S1", "S2", "S3")  # of Table 1: tau 0, so that they are the same in all water


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


def grades_sentences(model, outcomes, limits, reasons):
    """What a model is good for, in a few lines."""

    def starred(case):
        return code(case) + (" \\*" if rules.only_guarded(case, reasons) else "")

    cases = list(dict.fromkeys(o.case for o in outcomes))
    graded = rules.by_grade(outcomes, model, cases, limits)
    of_grade = {g: [f"{starred(run.case)} ({metric_words(its)})" for run, its in pairs] for g, pairs in graded.items()}
    total = sum(map(len, graded.values()))
    if total == 0:
        return f"* **{model_words(model)}**: no case with a limit was run.\n"
    text = f"* **{model_words(model)}** keeps the limits of {len(graded[rules.GOOD])} of {total} cases that it can run"
    names = [starred(run.case) for run, _ in graded[rules.GOOD]]
    text += f": {listed(names)}.\n" if names else ".\n"
    if of_grade[rules.CLOSE]:
        text += f"  Near, by a factor of {rules.NEAR:g} at most: {listed(of_grade[rules.CLOSE])}.\n"
    if of_grade[rules.USELESS]:
        text += f"  Useless, further off: {listed(of_grade[rules.USELESS])}.\n"
    refused = rules.refusals(outcomes, model)
    if refused:
        text += f"  Cannot run {len(refused)} other cases ([why](#what-a-model-cannot-run)).\n"
    return text + beaten_sentence(model, outcomes, cases, limits)


def beaten_sentence(model, outcomes, cases, limits):
    """In how many cases a model has no resolution at which no other model is better."""
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
    if not compared:
        return ""
    by = [f"{model_words(name)} in {len(found)}" for name, found in sorted(beaten.items(), key=lambda b: -len(b[1]))]
    text = f"  Another model is at most as dear and at most as wrong in {len(lost) or 'none'} of {compared} cases"
    return text + " that both can run" + (f" ({', '.join(by)}).\n" if by else ".\n")


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
    text = f"* Impulse on people by **{model_words(model)}**, median error over that of DFSPH at the same resolution:"
    text += f" as small ({rules.SAME_AS:g} at most) in {listed(same)}" if same else " nowhere as small"
    return text + (f"; larger in {listed(worse)}.\n" if worse else ".\n")


def cheapest_impulse_sentence(outcomes):
    parts = []
    for case in dict.fromkeys(o.case for o in outcomes):
        run = rules.cheapest_as_exact(outcomes, case, "impulse_median")
        if run is not None:
            parts.append(f"{code(case)} {model_words(run.model)} ({run.level})")
    if not parts:
        return ""
    return f"* The cheapest whose impulse is as exact as that of DFSPH at the same resolution: {listed(parts)}.\n"


def table1_sentences(of_set):
    """Which models end the scenarios as DFSPH does."""
    reference = next((runs for runs in of_set if runs.model == "dfsph"), None)
    text = ""
    for runs in of_set:
        judged = {name: bands.judge_scenario(name, result).holds for name, result in runs.results.items()}
        bad = [name for name, holds in judged.items() if not holds]
        text += f"* Table 1, set {runs.set}, **{model_words(runs.model)}**: {len(judged) - len(bad)} of {len(judged)} bands"
        text += " of the paper"
        text += f" met (missed: {', '.join(bad)})" if bad else " met"
        if reference and runs is not reference:
            pushed = {name: result for name, result in runs.results.items() if name not in NOT_PUSHED}
            verdicts = {name: rules.agrees(result, reference.results.get(name)) for name, result in pushed.items()}
            known = {name: verdict for name, verdict in verdicts.items() if verdict is not None}
            other = [name for name, verdict in known.items() if not verdict]
            text += f"; ends as by DFSPH, within a tenth of time and people, in {len(known) - len(other)} of {len(known)}"
            text += " in which water pushes"
            text += f" (not {', '.join(other)})" if other else ""
        text += ".\n"
    return text
