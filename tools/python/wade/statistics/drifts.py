"""People adrift: how their drifts ended, and how many are lost at other hazards of drowning than the one that acted.

The hazard of drowning is assumed and acts on the exposure x of a person adrift (docs/people_in_water.md#drowning). The drowned
show x up to their death only. A run with the hazard lambda tells of another one where nothing reacts to the dead:

  larger    all that are lost, and of each other person 1 - exp(-(larger - lambda) x)
  smaller   of each person not drowned adrift, lost otherwise or not, 1 - exp(-smaller x), with the weight exp(lambda x), as so many
            met that exposure (Horvitz and Thompson 1952)
  under     the rule of earlier versions, with the same weights: death after the air budget adrift, never of swimmers

The weights have no variance where lambda times the mean exposure exceeds 1. So smaller hazards and the earlier rule are told of runs
with the best hazard or a smaller one alone.
"""

from dataclasses import dataclass

import numpy as np

from wade.statistics.shares import FEWEST_RUNS, RESAMPLES, SEED, expanded_level

HAZARDS = (0.002, 0.006, 0.02)  # 1/s: low, best, high [A]
SWEPT_DEAD = (0.20, 0.45)  # of people swept off their feet, reports of floods
STILL_ADRIFT = 0.10  # of those who drifted: above, the lost are counted too low
ENDS = {"feet_down": "feet down", "got_up": "sat or knelt up", "held": "held by a rope, a line or a person",
        "arrived": "came to the goal", "drowned": "drowned", "swept_away": "left the map with the water",
        "adrift": "still adrift at the end"}


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
    dead: int  # of those who drifted

    @property
    def still(self):
        """The share of those who drifted that is adrift at the end."""
        return self.ends.get("adrift", 0) / self.drifted


def drifts_of(case):
    """Drifts; None where nobody drifted or agents.csv is older."""
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


def _shares(case, rule):
    """(numerator, denominator) of the share lost, by run; rule: a hazard, 1/s, or "under"."""
    people, acts = case.people, acting(case)
    x, dead = np.nan_to_num(people["exposure_s"]), people["dead"]
    adrift = (people["fate"] == "drowned") & (people["drift_end"] == "drowned")

    def by_run(values):
        return np.bincount(people["run"], values, len(case.runs))

    if rule != "under" and rule >= acts:
        lost = np.where(dead, 1.0, -np.expm1(-(rule - acts) * x))
        return by_run(lost), by_run(np.ones(len(x)))
    weight = np.where(adrift, 0.0, np.exp(acts * x))
    if rule == "under":
        drowns = ((people["adrift_s"] >= air_of(case)) & (people["can_swim"] != 1)).astype(float)
    else:
        drowns = -np.expm1(-rule * x)
    return by_run(weight * np.where(dead, 1.0, drowns)), by_run(weight)


def lost_at(case, rule):
    """(share lost, low, high) of 95 % over runs; the ends None with fewer than 10 runs."""
    above, below = _shares(case, rule)
    share, runs = float(above.sum() / below.sum()), len(above)
    if runs < FEWEST_RUNS:
        return share, None, None
    draws = np.random.default_rng(SEED).integers(0, runs, size=(4 * RESAMPLES, runs))
    tail = (1 - expanded_level(runs)) / 2
    low, high = np.quantile(above[draws].sum(axis=1) / below[draws].sum(axis=1), [tail, 1 - tail])
    return share, float(low), float(high)


def lost_by_rules(case):
    """[(name, rule, (share, low, high))] of low, best, high and the earlier rule, as far as they can be told; [] where none acted."""
    acts = acting(case)
    if acts is None or drifts_of(case) is None:
        return []
    rules = [*zip(("low", "best", "high"), HAZARDS), *([("as run", acts)] if acts not in HAZARDS else []), ("earlier rule", "under")]
    return [(name, rule, lost_at(case, rule)) for name, rule in rules
            if acts <= HAZARDS[1] or (rule != "under" and rule >= acts)]
