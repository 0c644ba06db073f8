"""Intervals of 95 % for what repeated runs of a scenario give, and when there are enough runs.

The same numbers give the same intervals: the resampling has a fixed seed.
"""

import math
import statistics

import numpy as np

Z = 1.959963984540054  # 97.5 % point of the normal distribution
RESAMPLES = 4000  # moves the ends of an interval by about 2 % of its width
SEED = 20201016


def wilson(successes, trials):
    """Wilson score interval (Wilson 1927) of a proportion; (0, 1) without trials. Numbers may be fractions."""
    if trials <= 0:
        return 0.0, 1.0
    share = successes / trials
    scale = 1 + Z * Z / trials
    middle = (share + Z * Z / (2 * trials)) / scale
    half = Z / scale * math.sqrt(share * (1 - share) / trials + Z * Z / (4 * trials * trials))
    low = 0.0 if successes == 0 else max(0.0, middle - half)
    high = 1.0 if successes == trials else min(1.0, middle + half)
    return low, high


def design_effect(arrived, agents):
    """Variance of the arrivals of whole runs over that of independent agents, at least 1 (Kish 1965).

    arrived: of each run; agents: in each run. The agents of a run share its water and push one another, so that their
    fates are not independent; the effective number of agents is their number over this.
    """
    if len(arrived) < 2:
        return 1.0
    share = statistics.fmean(arrived) / agents
    expected = agents * share * (1 - share)
    return max(1.0, statistics.variance(arrived) / expected) if expected > 0 else 1.0


def arrival_interval(arrived, agents):
    """(mean, low, high) of the number of agents that arrive, Wilson with the design effect."""
    trials = len(arrived) * agents
    effect = design_effect(arrived, agents)
    low, high = wilson(sum(arrived) / effect, trials / effect)
    return statistics.fmean(arrived), agents * low, agents * high


def bootstrap_mean(values):
    """(mean, low, high) by the percentile bootstrap over runs (Efron 1979); the ends are None for less than two."""
    mean = statistics.fmean(values)
    if len(values) < 2:
        return mean, None, None
    if min(values) == max(values):
        return mean, mean, mean
    numbers = np.asarray(values, dtype=float)
    draws = np.random.default_rng(SEED).integers(0, len(numbers), size=(RESAMPLES, len(numbers)))
    low, high = np.percentile(numbers[draws].mean(axis=1), [2.5, 97.5])
    return mean, float(low), float(high)


MAX_ARRIVAL_WIDTH = 0.1  # of the agents: 5 of 50
MAX_TIME_WIDTH = 0.1  # of the mean: half of the narrowest band that is judged, +- 10 %


def precise_enough(arrived, agents, times):
    """The rule when to stop: both intervals are narrower than a tenth, of the agents and of the mean time.

    times: last arrivals of the runs in which somebody arrived.
    """
    if len(arrived) < 2:
        return False
    _, low, high = arrival_interval(arrived, agents)
    if high - low > MAX_ARRIVAL_WIDTH * agents:
        return False
    if len(times) < 2:
        return not times
    mean, early, late = bootstrap_mean(times)
    return late - early <= MAX_TIME_WIDTH * mean
