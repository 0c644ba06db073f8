"""Shares of people, from runs: intervals of 95 % over runs, never over people, and none where it cannot hold.

The people of a run share its water and push one another. Their fates are not independent, so the run is the unit.
The same numbers give the same intervals. Coverage, by simulation: docs/survival.md.
"""

import functools
import math
import statistics
from collections import Counter
from dataclasses import dataclass

import numpy as np
from scipy import special

LEVEL = 0.95
FEWEST_RUNS = 10      # with fewer, t-Wilson covers 77 to 92 % where people of a run are alike
FEWEST_WITH_ANY = 5   # runs with at least one case, and runs with at least one person that is no case
FEWEST_EFFECTIVE = 12  # independent cases of the rarer outcome; with fewer, over 7 % of ensembles get a wrong interval
RAREST_GIVEN = 0.02   # coverage is kept wherever this share of ensembles gets an interval; see level_of()
RESAMPLES = 1000      # bootstrap draws; their chance moves the ends of an interval by about 4 % of its width
SEED = 20201016


@dataclass(frozen=True)
class Share:
    """A share estimated from runs. low, high: its interval, or None with the reason in `refused`."""

    runs: int
    people: int
    mean: float  # of all people
    low: float | None
    high: float | None
    runs_with_any: int
    runs_with_other: int  # runs with at least one person that is no case
    refused: str = ""

    @property
    def limit(self):
        """Returns the one-sided bound of 95 % if no people or all people of all runs are cases, else None.

        The share of people is at most the share of runs with any case, and 1 - 0.05^(1 / runs) is its exact bound.
        """
        if self.people == 0 or (self.runs_with_any and self.runs_with_other):
            return None
        bound = 1 - (1 - LEVEL) ** (1 / self.runs)
        return 1 - bound if self.runs_with_any else bound

    @property
    def width(self):
        return None if self.low is None else self.high - self.low


@functools.lru_cache(maxsize=4096)
def t_quantile(degrees, level=LEVEL):
    """t with P(|T| <= t) = level, T of Student's distribution."""
    return float(special.stdtrit(degrees, (1 + level) / 2))


def wilson(successes, trials, quantile=None):
    """Wilson's score interval (Wilson 1927) of a share, with the normal quantile or a given one; (0, 1) without trials."""
    if trials <= 0:
        return 0.0, 1.0
    z = statistics.NormalDist().inv_cdf((1 + LEVEL) / 2) if quantile is None else quantile
    share = successes / trials
    scale = 1 + z * z / trials
    middle = (share + z * z / (2 * trials)) / scale
    half = z / scale * math.sqrt(share * (1 - share) / trials + z * z / (4 * trials * trials))
    low = 0.0 if successes == 0 else max(0.0, middle - half)
    high = 1.0 if successes == trials else min(1.0, middle + half)
    return low, high


def design_effect(counts, people):
    """Variance of what runs count over that of independent people, at least 1 (Kish 1965).

    counts, people: a number a run. With runs of unequal size that of the ratio estimator, residuals counts - share people.
    """
    runs, total = len(counts), sum(people)
    if runs < 2 or total == 0:
        return 1.0
    share = sum(counts) / total
    expected = total * share * (1 - share) / runs
    if expected <= 0:
        return 1.0
    residuals = sum((count - share * size) ** 2 for count, size in zip(counts, people)) / (runs - 1)
    return max(1.0, residuals / expected)


def why_not(counts, people, effect):
    """Returns the reason why no interval can be given; "" if one can."""
    runs = len(counts)
    if runs < FEWEST_RUNS:
        return f"fewer than {FEWEST_RUNS} runs"
    with_any = sum(count > 0 for count in counts)
    if with_any < FEWEST_WITH_ANY:
        return f"in {with_any} of {runs} runs only, {FEWEST_WITH_ANY} needed" if with_any else f"in none of {runs} runs"
    with_other = sum(count < size for count, size in zip(counts, people))
    if with_other < FEWEST_WITH_ANY:
        but = f"but {with_other} " if with_other else ""
        return f"everybody in all {but}of {runs} runs" + (f", {FEWEST_WITH_ANY} needed" if with_other else "")
    share = sum(counts) / sum(people)
    effective = sum(people) / effect * min(share, 1 - share)
    if effective < FEWEST_EFFECTIVE:
        return f"worth {effective:.0f} independent cases, {FEWEST_EFFECTIVE} needed"
    return ""


def level_of(effective, runs):
    """Returns the nominal level of an interval, so that 95 % of the intervals that are not refused hold.

    effective: estimated number of independent cases of the rarer outcome, at least FEWEST_EFFECTIVE. An ensemble that
    just passes that rule often has more cases than usual, by chance. Let p be the probability of getting an interval at
    all. If an interval misses the truth with probability 0.05 p, 5 % of the given ones are wrong, whatever the truth
    (the conditional level of Weinstein, Fithian and Benjamini, 2013). p is taken for the smallest true number of cases
    that these runs may come from: the quantile RAREST_GIVEN of a normal log(effective). Its variance is that of a
    design effect, from chi-square with runs - 1 degrees of freedom, plus that of the number of cases.
    """
    deviation = math.sqrt(2 / (runs - 1) + 1 / effective)
    normal = statistics.NormalDist()
    passes = normal.cdf(math.log(effective / FEWEST_EFFECTIVE) / deviation + normal.inv_cdf(RAREST_GIVEN))
    return 1 - (1 - LEVEL) * math.floor(passes * 200) / 200  # in steps, so that few quantiles are computed


def interval(share, people, runs):
    """Returns the t-Wilson interval of a share of `people` independent people, at the level of level_of()."""
    effective = people * min(share, 1 - share)
    return wilson(share * people, people, t_quantile(runs - 1, level_of(effective, runs)))


def share_of(counts, people):
    """Returns the Share of cases, t-Wilson with the design effect of runs. counts, people: cases and people a run."""
    total = sum(people)
    if total == 0:
        return Share(len(counts), 0, math.nan, None, None, 0, 0, "nobody")
    effect = design_effect(counts, people)
    refused = why_not(counts, people, effect)
    low, high = (None, None) if refused else interval(sum(counts) / total, total / effect, len(counts))
    some = sum(count > 0 for count in counts), sum(count < size for count, size in zip(counts, people))
    return Share(len(counts), total, sum(counts) / total, low, high, *some, refused)


def share_of_runs(successes, runs):
    """Exact interval (Clopper and Pearson 1934) of a share of runs, which are independent; one-sided of none and of all."""
    others = runs - successes
    tail = (1 - LEVEL) / (2 if successes and others else 1)
    low = 0.0 if successes == 0 else float(special.betaincinv(successes, others + 1, tail))
    high = 1.0 if others == 0 else float(special.betaincinv(successes + 1, others, 1 - tail))
    return low, high


def arrival_interval(arrived, agents):
    """Returns (mean, low, high) of the arrivals a run, of `agents`; low and high None where no interval holds."""
    share = share_of(arrived, [agents] * len(arrived))
    ends = (None, None) if share.refused else (agents * share.low, agents * share.high)
    return statistics.fmean(arrived), *ends


def expanded_level(runs):
    """Returns the percentile level for 95 % coverage of a bootstrap over few runs (Hesterberg 2015, expanded ones)."""
    quantile = t_quantile(runs - 1) * math.sqrt(runs / (runs - 1))
    return 2 * statistics.NormalDist().cdf(quantile) - 1


def bootstrap_mean(values):
    """(mean, low, high) by the bootstrap over runs (Efron 1979), expanded percentiles; the ends are None for less than two."""
    mean = statistics.fmean(values)
    if len(values) < 2:
        return mean, None, None
    if min(values) == max(values):
        return mean, mean, mean
    numbers = np.asarray(values, dtype=float)
    draws = np.random.default_rng(SEED).integers(0, len(numbers), size=(4 * RESAMPLES, len(numbers)))
    tail = (1 - expanded_level(len(numbers))) / 2
    low, high = np.quantile(numbers[draws].mean(axis=1), [tail, 1 - tail])
    return mean, float(low), float(high)


def mean_of_alike(values, most=1.0):
    """(low, high) of a mean of values within -most to most where nearly all runs give one value; None with 5 unlike it or more.

    Runs that are all alike have no spread, and t and bootstrap would claim a certainty. The share q of runs with another value
    than the commonest m is below the exact one-sided bound of 95 % (Clopper and Pearson 1934; of 0 in n runs 1 - 0.05^(1 / n),
    the rule of three). These may have any value, so that the mean lies between m - q (most + m) and m + q (most - m).
    """
    commonest, alike = Counter(round(value, 12) for value in values).most_common(1)[0]
    unlike = len(values) - alike
    if unlike >= FEWEST_WITH_ANY:
        return None
    q = float(special.betaincinv(unlike + 1, alike, LEVEL))
    return commonest - q * (most + commonest), commonest + q * (most - commonest)


# When there are enough runs.

FIRST_LOOK = 20  # runs; a first look at 3 runs stops too early: coverage 0.80 where people of a run are alike
MAX_WIDTH = 0.1  # of a share; of a mean time half of the narrowest band that is judged, +- 10 %


def runs_needed(counts, people, width=MAX_WIDTH):
    """Returns how many runs, of the same size and spread, make the interval of the share at most `width` wide.

    Returns None for fewer than 20 runs, and where no interval can be given.
    """
    runs, total = len(counts), sum(people)
    if runs < FIRST_LOOK or total == 0:
        return None
    effect, share = design_effect(counts, people), sum(counts) / total
    if why_not(counts, people, effect):
        return None

    def width_of(n):
        low, high = interval(share, total / runs * n / effect, n)
        return high - low

    if width_of(runs) <= width:
        return runs
    many = runs
    while width_of(many) > width and many < 10_000_000:
        many *= 2
    few = many // 2
    while many - few > 1:
        middle = (few + many) // 2
        few, many = (middle, many) if width_of(middle) > width else (few, middle)
    return many


def precise_enough(arrived, agents, times):
    """Returns true from 20 runs on if the intervals are at most a tenth wide, of the agents and of the mean time.

    times: last arrivals, s, of the runs with arrivals. If no agent or every agent arrives in all runs, the share
    needs no interval.
    """
    if len(arrived) < FIRST_LOOK:
        return False
    share = share_of(arrived, [agents] * len(arrived))
    alike = min(arrived) == max(arrived) and arrived[0] in (0, agents)
    if not alike and (share.width is None or share.width > MAX_WIDTH):
        return False
    if len(times) < 2:
        return not times
    mean, early, late = bootstrap_mean(times)
    return late - early <= MAX_WIDTH * mean


# Two ensembles, paired by seed.


@dataclass(frozen=True)
class Comparison:
    """Difference of the second ensemble from the first; per: number of people for one more case, with its interval."""

    pairs: int
    people: int
    first: float
    second: float
    difference: float
    low: float | None
    high: float | None
    per: float | None
    per_low: float | None
    per_high: float | None
    refused: str = ""


def compared(first, second, people):
    """Paired t over runs of the difference of shares; mean_of_alike() of nearly equal ones. Counts of the same seeds, people a run.

    None where the share of both together would get no interval: differences of rare outcomes are as skewed as these.

    The number needed to warn (treat; Cook and Sackett 1995) is 1 over the difference, and has no interval where that of the
    difference holds 0: it would go through infinity.
    """
    shares = [(a / n, b / n) for a, b, n in zip(first, second, people) if n > 0]
    count, total = len(shares), sum(people)
    if count == 0:
        return Comparison(0, 0, math.nan, math.nan, math.nan, None, None, None, None, None, "no pairs")
    means = [statistics.fmean(side) for side in zip(*shares)]
    differences = [b - a for a, b in shares]
    mean = statistics.fmean(differences)
    per = 1 / abs(mean) if mean else None
    unlike = sum(difference != 0 for difference in differences)
    refused = ""
    if count < FEWEST_RUNS:
        refused = f"fewer than {FEWEST_RUNS} pairs"
    elif unlike < FEWEST_WITH_ANY:
        refused = f"unlike in {unlike} of {count} pairs only, {FEWEST_WITH_ANY} needed"
    both, sizes = [a + b for a, b in zip(first, second)], [2 * n for n in people]
    effect, share = design_effect(both, sizes), sum(both) / sum(sizes)
    refused = refused or why_not(both, sizes, effect)
    if refused:
        return Comparison(count, total, *means, mean, None, None, per, None, None, refused)
    low, high = mean_of_alike(differences) or (None, None)
    if low is None:
        level = level_of(sum(sizes) / effect * min(share, 1 - share), count)
        half = t_quantile(count - 1, level) * statistics.stdev(differences) / math.sqrt(count)
        low, high = mean - half, mean + half
    if low <= 0 <= high:
        return Comparison(count, total, *means, mean, low, high, per, None, None, "difference may be 0")
    ends = sorted((1 / abs(low), 1 / abs(high)))
    return Comparison(count, total, *means, mean, low, high, per, *ends)
