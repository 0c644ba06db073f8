"""People adrift: how their drifts ended, and how many are lost at other hazards of drowning than the one that acted.

The hazard of drowning is assumed and acts on the exposure x of a person adrift (docs/people_in_water.md#drowning). The
exposure of a drowned person is known up to death only. A run with the hazard lambda gives the lost at another hazard if
nothing reacts to the dead:

  larger    lost people count 1, each other person 1 - exp(-(larger - lambda) x)
  smaller   lost people count 1, except people drowned adrift. Each of these counts a fraction of the people not
            drowned adrift with exposures of at least x: those lost below the exposure lambda x / smaller, or with at
            least that exposure. Weights exp(lambda x): so many people met that exposure (Horvitz and Thompson 1952)
  under     the rule of earlier versions, an upper bound: people adrift for at least the air budget die, swimmers never.
            All drifts of a person count as one, and all people drowned adrift are lost

The weights have no variance where lambda times the mean exposure exceeds 1. So smaller hazards are told of runs with the best hazard
or a smaller one alone.
"""

from dataclasses import dataclass

import numpy as np

from wade.statistics.shares import FEWEST_RUNS, RESAMPLES, SEED, expanded_level

HAZARDS = (0.002, 0.006, 0.02)  # 1/s: low, best, high [A]
SWEPT_DEAD = (0.20, 0.45)  # of people swept off their feet, reports of floods
STILL_ADRIFT = 0.10  # of the people that drifted: above, the lost are counted too low
ENDS = {"feet_down": "feet down", "got_up": "sat or knelt up", "held": "held by a rope, a line or a person",
        "pinned": "pinned on a solid or on others", "arrived": "came to the goal", "drowned": "drowned",
        "swept_away": "left the map with the water", "adrift": "still adrift at the end"}


@dataclass(frozen=True)
class Drifts:
    """Of all people of a case. ends: {how: people}; times: median and 90 % of the time adrift, s."""

    people: int
    off_feet: int
    drifted: int
    ends: dict
    times: tuple
    drowned_adrift: int
    held_under: int
    dead: int  # of the people that drifted

    @property
    def still(self):
        """The share of drifted people that is adrift at the end."""
        return self.ends.get("adrift", 0) / self.drifted


def drifts_of(case):
    """Drifts; None without drifts or where agents.csv is older."""
    people = case.people
    ends = people["drift_end"].astype(str)
    there = ends != ""
    if not there.any():
        return None
    drowned = people["fate"] == "drowned"
    adrift = drowned & (ends == "drowned")
    counts = {how: int((ends == how).sum()) for how in ENDS}
    return Drifts(len(ends), int((~np.isnan(people["off_feet_s"])).sum()), int(there.sum()), counts,
                  tuple(np.quantile(people["adrift_s"][there], [0.5, 0.9])), int(adrift.sum()), int((drowned & ~adrift).sum()),
                  int((people["dead"] & there).sum()))


def acting(case):
    """The hazard of a case, 1/s; None with the rule `under` or in older runs."""
    hazard = case.manifest()["resolved_scene"]["crowd"].get("drift_hazard_per_s")
    return hazard[1] if isinstance(hazard, list) else hazard if isinstance(hazard, (int, float)) else None


def air_of(case):
    """How long air lasts for a mouth under water, s."""
    crowd = case.manifest()["resolved_scene"]["crowd"]
    temperature, budget = crowd.get("water_temperature_c"), crowd.get("air_budget_s", 60)
    return budget if temperature is None else min(budget, 15.01 + 0.92 * temperature)


def _lost(case, rule):
    """The probability of each person to be lost; rule: a hazard, 1/s, or "under"."""
    people, acts = case.people, acting(case)
    x, lost = np.nan_to_num(people["exposure_s"]), people["dead"].astype(float)
    if rule == "under":
        return np.where((people["adrift_s"] >= air_of(case)) & (people["can_swim"] != 1), 1.0, lost)
    if rule >= acts:
        return np.where(people["dead"], 1.0, -np.expm1(-(rule - acts) * x))
    drowned = (people["fate"] == "drowned") & (people["drift_end"] == "drowned")
    order = np.argsort(x[~drowned])
    others, weight = x[~drowned][order], np.exp(acts * x[~drowned][order])
    dies = weight * lost[~drowned][order]

    def beyond(values, least):
        """Sums of the values of others with exposures of at least so much."""
        sums = np.append(np.cumsum(values[::-1])[::-1], 0)
        return sums[np.searchsorted(others, least)]

    longer = beyond(weight, x[drowned])
    reach = acts / rule * x[drowned] if rule > 0 else np.full(drowned.sum(), np.inf)
    # Lost otherwise before that exposure, or with that exposure.
    share = beyond(dies, x[drowned]) - beyond(dies, reach) + beyond(weight, reach)
    lost[drowned] = np.divide(share, longer, out=np.ones_like(share), where=longer > 0)
    return lost


def lost_at(case, rule):
    """(share lost, low, high) of 95 % over runs; the ends None with fewer than 10 runs or where all are alike."""
    runs = len(case.runs)
    above, below = np.bincount(case.people["run"], _lost(case, rule), runs), np.bincount(case.people["run"], minlength=runs)
    share = float(above.sum() / below.sum())
    if runs < FEWEST_RUNS:
        return share, None, None
    draws = np.random.default_rng(SEED).integers(0, runs, size=(4 * RESAMPLES, runs))
    tail = (1 - expanded_level(runs)) / 2
    low, high = np.quantile(above[draws].sum(axis=1) / below[draws].sum(axis=1), [tail, 1 - tail])
    return (share, float(low), float(high)) if low < high else (share, None, None)  # no spread is no certainty


def lost_by_rules(case):
    """[(name, rule, (share, low, high))] of low, best, high and the earlier rule, as far as they can be told; [] where none acted."""
    acts = acting(case)
    if acts is None or drifts_of(case) is None:
        return []
    rules = [*zip(("low", "best", "high"), HAZARDS), *([("as run", acts)] if acts not in HAZARDS else []), ("earlier rule", "under")]
    return [(name, rule, lost_at(case, rule)) for name, rule in rules
            if rule == "under" or acts <= HAZARDS[1] or rule >= acts]
