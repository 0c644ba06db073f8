"""Which inputs matter: Morris' screening and Sobol indices of what runs give, with intervals.

Points lie in the unit cube; rows are runs, columns inputs. Needs scipy for Sobol's points.
"""

from dataclasses import dataclass

import numpy as np

from wade.statistics.shares import RESAMPLES, SEED

LEVELS = 4  # of Morris' grid; steps of LEVELS / (2 (LEVELS - 1)), so that all levels are met equally often


def trajectories(inputs, count, seed):
    """Returns Morris' one-at-a-time trajectories through the grid (Morris 1991): (count, inputs + 1, inputs)."""
    random = np.random.default_rng(seed)
    step = LEVELS / (2 * (LEVELS - 1))
    ways = np.empty((count, inputs + 1, inputs))
    for way in ways:
        at = random.integers(0, LEVELS // 2, inputs) / (LEVELS - 1)
        up = random.integers(0, 2, inputs) * 2 - 1
        at = np.where(up > 0, at, 1 - at)
        way[0] = at
        for k, one in enumerate(random.permutation(inputs), 1):
            way[k] = way[k - 1]
            way[k, one] += up[one] * step
    return ways


@dataclass(frozen=True)
class Effects:
    """Of each input: mean of the absolute elementary effects, its interval, and their standard deviation."""

    size: np.ndarray  # mu*
    low: np.ndarray
    high: np.ndarray
    spread: np.ndarray  # sigma


def elementary_effects(ways, results):
    """Returns Effects over whole ranges; results: (count, inputs + 1) along trajectories (Campolongo et al. 2007)."""
    changes = np.diff(ways, axis=1)
    which = np.argmax(np.abs(changes), axis=2)
    effects = np.empty(ways.shape[::2])
    for row, (order, differences) in enumerate(zip(which, np.diff(results, axis=1))):
        effects[row, order] = differences / changes[row, np.arange(len(order)), order]
    means = np.abs(effects)[_draws(len(effects))].mean(axis=1)
    low, high = np.quantile(means, [0.025, 0.975], axis=0)
    return Effects(np.abs(effects).mean(axis=0), low, high, effects.std(axis=0, ddof=1))


def _draws(rows):
    return np.random.default_rng(SEED).integers(0, rows, size=(RESAMPLES, rows))


def sobol_points(inputs, count, seed):
    """Saltelli's design (Saltelli et al. 2010) from scrambled Sobol points: (inputs + 2, count, inputs), A, B, then A with
    one column of B each. count: a power of two."""
    from scipy.stats import qmc

    points = qmc.Sobol(2 * inputs, scramble=True, seed=seed).random(count)
    a, b = points[:, :inputs], points[:, inputs:]
    mixed = np.repeat(a[None], inputs, axis=0)
    for one in range(inputs):
        mixed[one, :, one] = b[:, one]
    return np.concatenate([a[None], b[None], mixed])


@dataclass(frozen=True)
class Indices:
    """Of each input: its share of the variance alone (first) and with all others (total), with intervals.

    noise: the share that runs of the same inputs and another seed vary by; nan where none was repeated.
    """

    first: np.ndarray
    first_low: np.ndarray
    first_high: np.ndarray
    total: np.ndarray
    total_low: np.ndarray
    total_high: np.ndarray
    variance: float
    noise: float = float("nan")


def jansen(results):
    """(first, total) by Jansen's estimators (Jansen 1999); results (..., inputs + 2, count) in the order of sobol_points."""
    a, b, mixed = results[..., 0, :], results[..., 1, :], results[..., 2:, :]
    variance = np.concatenate([a, b], axis=-1).var(axis=-1)[..., None]
    with np.errstate(invalid="ignore", divide="ignore"):
        first = 1 - ((b[..., None, :] - mixed) ** 2).mean(axis=-1) / (2 * variance)
        total = ((a[..., None, :] - mixed) ** 2).mean(axis=-1) / (2 * variance)
    return first, total


def sobol_indices(results, repeated=None):
    """Indices with percentiles of a bootstrap over the points. repeated: results at A once more, with other seeds.

    Half the mean square of the difference between a run and its repetition is the variance of chance, which adds to S_T of
    every input unless all runs of a point have the same seed.
    """
    results = np.asarray(results, float)
    first, total = jansen(results)
    draws = _draws(results.shape[1])
    parts = [jansen(np.moveaxis(results[:, chosen], 1, 0)) for chosen in np.array_split(draws, 20)]
    ends = [np.nanquantile(np.concatenate(part), [0.025, 0.975], axis=0) for part in zip(*parts)]
    variance = float(results[:2].var())
    noise = float("nan")
    if repeated is not None and variance > 0:
        noise = float(((results[0] - np.asarray(repeated)) ** 2).mean() / 2 / variance)
    return Indices(first, *ends[0], total, *ends[1], variance, noise)
