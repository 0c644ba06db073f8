"""What the report concludes, by rule. The numbers here were chosen before the first comparison was made."""

from wade.suites.models.outcomes import COMPLETED, REFUSED, missed, worst

NEAR = 2.0  # a limit missed by less than this factor is near: what one halving of the spacing mends at first order
SAME_AS = 1.1  # an error that is at most so many times another one is as small: chance moves errors by about as much

IMPULSE = "impulse_median"
GOOD, CLOSE, USELESS = "good enough", "near", "useless"


def grade(ratio):
    """In words, of the largest ratio of an error to its limit."""
    return GOOD if ratio <= 1 else CLOSE if ratio <= NEAR else USELESS


def complete(outcomes, case=None, model=None):
    return [o for o in outcomes if o.status == COMPLETED and case in (None, o.case) and model in (None, o.model)]


def judged(outcomes, case, limits):
    """Runs of a case that have an error with a limit, and a cost."""
    return [o for o in complete(outcomes, case) if o.cost is not None and worst(o, limits)]


def best(outcomes, case, model, limits):
    """The run of a model that is nearest to the limits of a case, with its worst metric; (None, None) without."""
    pairs = [(o, worst(o, limits)) for o in complete(outcomes, case, model)]
    pairs = [(o, w) for o, w in pairs if w is not None]
    return min(pairs, key=lambda pair: (pair[1].ratio, pair[0].cost or 0), default=(None, None))


def cheapest(outcomes, case, limits):
    """The run that costs least a simulated second among those that keep all limits of a case; None if none does."""
    kept = [o for o in judged(outcomes, case, limits) if not missed(o, limits)]
    return min(kept, key=lambda o: o.cost, default=None)


def nearest(outcomes, case, models, limits):
    """(run, worst metric) of the model that misses the limits of a case by least."""
    pairs = [best(outcomes, case, model, limits) for model in models]
    pairs = [pair for pair in pairs if pair[0] is not None]
    return min(pairs, key=lambda pair: pair[1].ratio, default=(None, None))


def by_grade(outcomes, model, cases, limits):
    """{grade: [(run, worst metric)]} of a model, the best run of each case."""
    graded = {GOOD: [], CLOSE: [], USELESS: []}
    for case in cases:
        run, its = best(outcomes, case, model, limits)
        if run is not None:
            graded[grade(its.ratio)].append((run, its))
    return graded


def refusals(outcomes, model):
    """{case: why} of the cases that a model cannot run."""
    return {o.case: o.remark for o in outcomes if o.model == model and o.status == REFUSED}


def factor_to(outcome, outcomes, metric, model="dfsph"):
    """How many times the error of another model at the same resolution a run has; None where one of both is missing."""
    own = outcome.value(metric)
    other = next((o for o in complete(outcomes, outcome.case, model) if o.level == outcome.level), None)
    its = other.value(metric) if other else None
    if own is None or its is None or its == 0:
        return None
    return own / its


def only_guarded(case, reasons):
    """Whether all limits of a case are only guards against something broken. reasons: {(case, metric): words}."""
    of_case = [reason for (owner, _), reason in reasons.items() if owner == case and not reason.startswith("reported")]
    return bool(of_case) and all(reason.startswith("a guard") for reason in of_case)


def limits_of_people(outcomes, limits, reasons):
    """Returns the limits for grading the models. A case with guards only has a limit from DFSPH at the same
    resolution: 1.1 times its median error of the impulse, which allows for chance, or the guard if that is smaller."""
    graded = dict(limits)
    for o in complete(outcomes, model="dfsph"):
        error = o.value(IMPULSE)
        if only_guarded(o.case, reasons) and error is not None:
            guard = limits.get((o.case, IMPULSE, o.level))
            graded[o.case, IMPULSE, o.level] = SAME_AS * error if guard is None else min(guard, SAME_AS * error)
    return graded
