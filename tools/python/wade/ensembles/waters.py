"""Groups the runs of a plan that share a water.

Their scenes differ only in the crowd, and neither seed nor people change the water.
"""

import json
import signal
import subprocess
from concurrent.futures import ThreadPoolExecutor

from wade.ensembles.folder import digest, message_of
from wade.paths import BUILD

# Keys of a scene that are the crowd's: crowd_client/session/crowd_list.cpp.
OWN_OF_CROWD = ("/seed", "/name", "/description", "/events", "/crowd", "/coupling")
# Models with the same water for each seed. The others draw particle positions or waves from the seed; `auto` may choose
# one of them, and its choice depends on where people walk.
SEEDLESS = ("dfsph",)
# Models that publish what the response of the crowd integrates over: columns without a seed for `measured`, drifting particles else.
FOR_RESPONSE = ("shallow_water", "mixed")
MOST_KILLS = 20  # of the program that reads a scene, one after the other; more are no accident


def water_of(resolved, seed):
    """What two runs have in common if one water serves both; None where each needs its own."""
    model, coupling = resolved["fluid"]["model"], resolved["coupling"]
    if model == "auto" or coupling["two_way"] or coupling["agents_stream"] != "off":
        return None
    own = {pointer[1:] for pointer in OWN_OF_CROWD}
    response = resolved["crowd"]["response"] if model in FOR_RESPONSE else None
    seedless = model in SEEDLESS or (model == "shallow_water" and response == "measured")
    return digest([{key: value for key, value in resolved.items() if key not in own}, response, None if seedless else seed])


def is_own_of_crowd(pointer):
    return any(pointer == own or pointer.startswith(own + "/") for own in OWN_OF_CROWD)


def resolve(file, words):
    """(the resolved scene, None) or (None, why the program refuses it). A kill says nothing of the scene: it is asked again."""
    for _ in range(MOST_KILLS):
        answer = subprocess.run([BUILD / "crowd_client", file, *words, "--print-config"], capture_output=True, text=True)
        if answer.returncode != -signal.SIGKILL:
            break
    if answer.returncode == 0:
        return json.loads(answer.stdout), None
    return None, message_of(answer.stderr) or f"exit code {answer.returncode}"


def resolve_all(plan, files, options):
    """{(scene, settings as JSON): (resolved, refusal)} of all runs.

    files: {scene: file}; options: of the crowd, for all runs.
    """
    kinds = {(run.scene, run.settings_text): run for run in plan}
    with ThreadPoolExecutor() as pool:
        answers = pool.map(lambda run: resolve(files[run.scene], [*options, *run.words()]), kinds.values())
        return dict(zip(kinds, answers))


def units_of(plan, scenes, most, own_water):
    """Returns lists of runs that are done together: they share a water, at most `most`, in order of first runs.

    scenes: as resolve_all gives them; a run with a refused scene is in no list.
    """
    units, open_units = [], {}
    for run in plan:
        resolved, _ = scenes[run.scene, run.settings_text]
        if resolved is None:
            continue
        water = None if own_water else water_of(resolved, run.seed)
        unit = open_units.get(water) if water else None
        if unit is None or len(unit) >= most:
            unit = []
            units.append(unit)
            open_units[water] = unit
        unit.append(run)
    return units
