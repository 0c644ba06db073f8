"""The scenes of the check, none of which is in the table, and the spacing of the finest run of each, m."""

DEMANDS = (0.05, 0.1, 0.3)
# Left out where the chosen run would take longer than the finest.
LEFT_OUT = {("block_small", 0.05), ("block_large", 0.05), ("block_large", 0.1)}
# Added after the last change of table and rules.
UNSEEN = ("river_brisk", "river_calm")
QUICK = ("river_shallow", "front_low", "block_front")

FINEST = {
    "river_shallow": 0.0625,
    "river_deep": 0.14,
    "river_fast": 0.125,
    "river_wide": 0.16,
    "slope": 0.125,
    "river_brisk": 0.09,
    "river_calm": 0.13,
    "front_low": 0.06,
    "front_high": 0.09,
    "front_wet": 0.1,
    "block_small": 0.08,
    "block_large": 0.125,
    "block_front": 0.09,
    "emitter_history": 0.1,
    "emitter_filled": 0.125,
}
ROOM = 100000  # max_particles of the finest runs


def demands(name):
    return [demand for demand in DEMANDS if (name, demand) not in LEFT_OUT]


def file_of(name):
    return f"configs/model_choice/{name}.json"


def finest_overrides(name):
    return ["/fluid/model=dfsph", f"/fluid/particle_spacing_m={FINEST[name]:g}", f"/fluid/max_particles={ROOM}"]
