"""When people arrive, lose their feet, die: curves over time with bands of 95 % by resampling whole runs, and the FN curve.

Bands are pointwise. Greenwood's formula, over people, covers 0.67 instead of 0.95 where runs differ.
"""

from dataclasses import dataclass

import numpy as np

from wade.statistics.ensemble import has_feet
from wade.statistics.shares import FEWEST_RUNS, RESAMPLES, SEED, expanded_level, share_of_runs

AT_A_TIME = 50  # resamples, for the memory's sake


@dataclass(frozen=True)
class Curve:
    """A share over time. low, high: None with fewer than 10 runs."""

    times: np.ndarray  # s
    share: np.ndarray
    low: np.ndarray | None
    high: np.ndarray | None
    runs: int
    people: int

    def at(self, time):
        """(share, low, high) at a time, ends None without a band."""
        k = int(np.searchsorted(self.times, time, side="right")) - 1
        return tuple(None if values is None else float(values[k]) for values in (self.share, self.low, self.high))


@dataclass(frozen=True)
class Lives:
    """People of an ensemble: the run of each, numbered from 0, when it ended, s, and how: 0 censored, else a cause from 1."""

    run: np.ndarray
    time: np.ndarray
    cause: np.ndarray

    @property
    def runs(self):
        return int(self.run.max()) + 1 if len(self.run) else 0

    def counts(self):
        """(times of events, {cause: number by run and time}, number at risk just before, by run and time)."""
        times = np.unique(self.time[self.cause > 0])
        shape = (self.runs, len(times) + 1)
        place = np.searchsorted(times, self.time)  # the first event not before the end
        leaves = np.zeros(shape)
        after = np.searchsorted(times, self.time, side="right")  # at risk in all events up to its own end
        np.add.at(leaves, (self.run, after), 1)
        size = np.bincount(self.run, minlength=self.runs)
        at_risk = size[:, None] - np.cumsum(leaves, axis=1)[:, :-1]
        events = {}
        for cause in np.unique(self.cause[self.cause > 0]):
            number = np.zeros(shape)
            of = self.cause == cause
            np.add.at(number, (self.run[of], place[of]), 1)
            events[int(cause)] = number[:, :-1]
        return times, events, at_risk


def survival(events, at_risk):
    """The product-limit estimate (Kaplan and Meier 1958) after each event; of sums over runs, along the last axis."""
    hazard = np.divide(events, at_risk, out=np.zeros_like(events), where=at_risk > 0)
    return np.cumprod(1 - hazard, axis=-1)


def incidence(of_cause, of_all, at_risk):
    """The cumulative incidence of a cause among several (Aalen and Johansen 1978): sum of S(t-) dN / Y."""
    left = survival(of_all, at_risk)
    before = np.concatenate([np.ones_like(left[..., :1]), left[..., :-1]], axis=-1)
    hazard = np.divide(of_cause, at_risk, out=np.zeros_like(of_cause), where=at_risk > 0)
    return np.cumsum(before * hazard, axis=-1)


def band(estimate, matrices, runs):
    """Ends of `estimate` of sums over runs drawn with replacement; None with fewer than 10 runs."""
    if runs < FEWEST_RUNS:
        return None, None
    random = np.random.default_rng(SEED)
    drawn = []
    for _ in range(RESAMPLES // AT_A_TIME):
        weights = random.multinomial(runs, np.full(runs, 1 / runs), size=AT_A_TIME).astype(float)
        drawn.append(estimate(*(weights @ matrix for matrix in matrices)).astype(np.float32))
    tail = (1 - expanded_level(runs)) / 2
    return np.quantile(np.concatenate(drawn), [tail, 1 - tail], axis=0)


def curve_of(lives, times, estimate, matrices):
    """A curve from t = 0 on."""
    start = estimate(*(np.zeros(1) for _ in matrices))
    share = np.concatenate([start, estimate(*(matrix.sum(axis=0) for matrix in matrices))])
    low, high = band(estimate, matrices, lives.runs) if len(times) else (None, None)
    ends = [None if end is None else np.concatenate([start, end]) for end in (low, high)]
    return Curve(np.concatenate([[0.0], times]), share, *ends, lives.runs, len(lives.run))


def staying(lives):
    """Returns the share of people without an event over time, by Kaplan-Meier over the people still at risk."""
    times, events, at_risk = lives.counts()
    return curve_of(lives, times, survival, (sum(events.values(), np.zeros_like(at_risk)), at_risk))


def incidences(lives, causes):
    """Returns {cause: share of people over time with this cause as their first event}, by Aalen-Johansen."""
    times, events, at_risk = lives.counts()
    every = sum(events.values(), np.zeros_like(at_risk))
    nothing = np.zeros_like(at_risk)
    return {cause: curve_of(lives, times, incidence, (events.get(cause, nothing), every, at_risk)) for cause in causes}


ARRIVED, DIED, LOST_FEET = 1, 2, 3


def lives_of(case, with_feet=False):
    """Lives that end with arrival, also at a shelter, death and, with_feet, also where the feet are first lost."""
    people = case.people
    time = people["time_s"]
    cause = np.where(people["safe"], ARRIVED, np.where(people["dead"], DIED, 0))
    if with_feet:
        lost = ~np.isnan(people["off_feet_s"])
        time, cause = np.where(lost, people["off_feet_s"], time), np.where(lost, LOST_FEET, cause)
    return Lives(people["run"], time, cause)


def curves_of(case):
    """Returns {name: Curve} of a case; curves of the feet only if at least one person lost them."""
    ends = incidences(lives_of(case), (ARRIVED, DIED))
    curves = {"arrived": ends[ARRIVED], "died": ends[DIED]}
    if has_feet(case):
        lives = lives_of(case, with_feet=True)
        first = incidences(lives, (ARRIVED, LOST_FEET))
        fallen = Lives(lives.run, lives.time, (lives.cause >= DIED).astype(int))
        curves |= {"lost their feet": first[LOST_FEET], "arrived without": first[ARRIVED],
                   "on their feet, of who is under way": staying(fallen)}
    return curves


def fn_curve(deaths):
    """[(N, share of runs with N dead or more, its exact interval)] from N = 1 on; deaths: a number a run."""
    deaths, runs = np.asarray(deaths), len(deaths)
    rows = []
    for number in sorted({1, *deaths[deaths > 0].tolist()}):
        count = int((deaths >= number).sum())
        rows.append((int(number), count / runs, *share_of_runs(count, runs)))
    return rows
