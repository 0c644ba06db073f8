"""What the runs of a plan came to, read from their folders alone."""

from wade.ensembles.folder import FAILURE, read_json, status_of, why_incomplete

COUNTS = ("agents", "arrived", "dead", "active", "standing", "last_arrival_s", "sim_time_s")
OF_SITES = ("sheltered", "indoors", "upper_floor")  # where runs say them
NO_FOLDER = "no folder: it was not done, or its worker was lost"


def gathered(ensemble, plan, fingerprints):
    """A row a run, {column: value}.

    fingerprints: {(scene, settings as words): (fingerprint or None, why the scene is refused or None)}.
    """
    return [row_of(ensemble.run(run.index), run, *fingerprints[run.scene, run.settings_text]) for run in plan]


def row_of(folder, run, fingerprint, refusal):
    row = {"index": run.index, "scene": run.scene, "seed": run.seed, **run.settings}
    if refusal is not None:
        return {**row, "status": "refused", "reason": refusal}
    row["status"] = status_of(folder, fingerprint, run.seed)
    failure = read_json(folder / FAILURE) or {}
    if row["status"] == "not_run":
        return {**row, "reason": NO_FOLDER}
    if row["status"] == "stale":
        return {**row, "reason": "of another scene or of other settings"}
    outcome = read_json(folder / "outcome.json") or {}
    manifest = read_json(folder / "manifest.json") or {}
    row.update({key: outcome.get(key) for key in COUNTS})
    row.update({key: outcome[key] for key in OF_SITES if key in outcome})
    row.update({f"state_{state}": number for state, number in outcome.get("states", {}).items()})
    row.update(frame_hash=outcome.get("frame_hash"), host=manifest.get("host"), wall_time_s=outcome.get("wall_time_s"))
    if row["status"] != "completed":
        row["reason"] = failure.get("reason", why_incomplete(folder) or "incomplete")
    row["commit"] = manifest.get("git_hash")
    return row


def said_of_sites(rows):
    """Returns the columns of a row that count people of a site by where they are."""
    return [key for key in OF_SITES if any(key in row for row in rows)]


def columns_of(rows, varied):
    """The columns of runs.csv."""
    states = dict.fromkeys(key for row in rows for key in row if key.startswith("state_"))
    return ["index", "scene", "seed", *varied, "status", *COUNTS, *said_of_sites(rows), *states, "frame_hash", "host",
            "wall_time_s", "reason"]
