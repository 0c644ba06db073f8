"""The table "What each model can" of docs/models_of_water.md: each cell runs, or is refused by the name of a key or an option."""

import copy
import json
import re
import shutil
import subprocess
import unittest

from harness import ROOT, SERVER, SystemTest

RANKS = SERVER.with_name("fluid_server_ranks")  # optional
PAGE = ROOT / "docs" / "models_of_water.md"
MODELS = {"dfsph": {}, "shallow_water": {}, "mixed": {"/fluid/mixed/x_min_m": 20, "/fluid/mixed/x_max_m": 40}, "kinematic": {},
          "steering": {}, "auto": {"/fluid/max_impulse_error": 0.5}}

BOTH = {
    "duration_s": 1, "frame_rate_hz": 10, "world": {"length_m": 60, "width_m": 24}, "fluid": {"particle_spacing_m": 0.5},
    "crowd": {"goal_radius_m": 1.4, "groups": [{"name": "a", "start": {"x_m": 20, "z_m": 5}, "goal": {"x_m": 30, "z_m": 15}}]},
}
SCENES = {
    "channel": {**BOTH, "channel": {"x_min_m": 5, "x_max_m": 55, "z_min_m": 2, "z_max_m": 22, "flow": "emitter", "depth_m": 1,
                                    "velocity_m_s": 1, "initial_river": "filled"}},
    "site": {**BOTH, "site": {"ground": {"level_m": 0}, "water": [{"level_m": 1}]}},
}

POLYGON = [[24, 8], [28, 8], [28, 12], [24, 12]]
WAY_BACK = {"/coupling/agents_stream": "serial"}
COMMON = {
    "two-way coupling": {"/coupling/two_way": True, **WAY_BACK},
    "columns near people only": {"/fluid/publish": "near_agents", **WAY_BACK},
    "routes by travel time": {"/crowd/navigation/rule": "travel_time"},
    "routes round crowds": {"/crowd/navigation/crowding": 1},
    "saved states": ["--save-state", "water.state"],
    "several ranks": ["mpirun", "--allow-run-as-root", "--oversubscribe", "-n", "2"],
}
# What a feature sets, or the words of the command that it adds.
FEATURES = {
    "channel": {
        "emitter": {},
        "recirculating": {"/channel/flow": "recirculating"},
        "periodic": {"/channel/flow": "periodic"},
        "closed, with blocks of water": {
            "/channel/flow": "closed", "/channel/velocity_m_s": 0, "/channel/initial_river": "dry",
            "/channel/water_blocks": [{"x_min_m": 5, "x_max_m": 55, "z_min_m": 2, "z_max_m": 22, "depth_m": 1}]},
        "periodic sides": {"/channel/sides": "periodic"},
        "inflow in time": {"/channel/velocity_history": [{"time_s": 0, "velocity_m_s": 1}, {"time_s": 1, "velocity_m_s": 2}]},
        "lid": {"/channel/top": "wall", "/channel/height_m": 1.5},
        "planes without slip": {"/channel/no_slip": [{"plane": "bed"}], "/fluid/viscosity_m2_s": 1e-6},
        "uneven bed": {"/channel/bed_points": [{"x_m": 10, "y_m": 0.2}, {"x_m": 40, "y_m": 0}]},
        "tilted gravity": {"/channel/slope": 0.001},
        "Manning's n": {"/channel/manning_n": 0.03},
        "boxes": {"/obstacles": [{"x_min_m": 24, "x_max_m": 28, "z_min_m": 8, "z_max_m": 12, "height_m": 2}]},
        "overtopped boxes": {"/obstacles": [{"x_min_m": 24, "x_max_m": 28, "z_min_m": 8, "z_max_m": 12, "height_m": 0.5}]},
        **COMMON,
    },
    "site": {
        "uneven ground": {"/site/ground/slope_x": 0.01},
        "ground with gaps": {"/site/epsg": 0, "/site/ground": {"file": "gaps.asc"}},
        "houses": {"/site/houses": [{"polygon": POLYGON}]},
        "gates": {"/site/gates": [{"line": [[30, 0], [30, 24]], "opens_at_s": 0.5}]},
        "flood walls": {"/site/walls": [{"line": [[20, 0], [20, 24]], "crest_m": 0.6}]},
        "sources": {"/site/sources": [{"line": [[50, 5], [50, 20]], "discharge_m3_s": 3}]},
        "outlets: free": {"/site/outlets": [{"line": [[0, 4], [0, 20]]}]},
        "outlets: stage": {"/site/outlets": [{"line": [[0, 4], [0, 20]], "kind": "stage", "level_m": 1}]},
        "outlets: wave": {"/site/outlets": [{"line": [[0, 4], [0, 20]], "kind": "wave", "level_m": 1}]},
        "rain": {"/site/rain": {"rate_mm_h": 50}},
        "zones of Manning's n": {"/site/manning/zones": [{"polygon": POLYGON, "n": 0.05}]},
        "periodic": {"/world/ends": "periodic"},
        **COMMON,
    },
}
GAPS = "ncols 30\nnrows 12\nxllcorner 0\nyllcorner 0\ncellsize 2\nNODATA_value -9\n" + "\n".join(["0 " * 29 + "-9"] * 12)


def table_of_page():
    """{(scene, feature): {model: "yes" or "no"}}"""
    rows = [[cell.strip() for cell in line.strip("|\n").split("|")] for line in PAGE.read_text().split("## What each model can")[1]
            .split("\n## ")[0].splitlines() if line.startswith("|")]
    names = [re.sub("`", "", cell) for cell in rows[0][2:]]
    return {(row[0], row[1]): dict(zip(names, row[2:])) for row in rows[2:]}


def put(document, pointer, value):
    *parents, last = pointer.strip("/").split("/")
    for name in parents:
        document = document.setdefault(name, {})
    document[last] = value


class Support(SystemTest):
    def answer(self, kind, feature, model):
        """Returns exit code and messages of a check, or of one frame for a feature of the command; None where MPI is missing."""
        scene = copy.deepcopy(SCENES[kind])
        wanted = FEATURES[kind][feature]
        settings = wanted if isinstance(wanted, dict) else {}
        for pointer, value in {"/fluid/model": model, **MODELS[model], **settings}.items():
            put(scene, pointer, value)
        (self.folder / "gaps.asc").write_text(GAPS)
        file = self.folder / "scene.json"
        file.write_text(json.dumps(scene))
        words = [] if isinstance(wanted, dict) else wanted
        on_ranks = words[:1] == ["mpirun"]
        if on_ranks and not (RANKS.exists() and shutil.which("mpirun")):
            return None, ""
        command = [*words, RANKS, file] if on_ranks else [SERVER, file, *(words or ["--check"])]
        run = subprocess.run([*command, "--until-s", "0.1", "--consumers", "0", "--session", self.session], cwd=self.folder,
                             capture_output=True, text=True)
        return run.returncode, " ".join((run.stdout + run.stderr).split())

    def test_page_and_tests_name_the_same_features_and_models(self):
        table = table_of_page()
        self.assertEqual(set(table), {(kind, feature) for kind in FEATURES for feature in FEATURES[kind]})
        self.assertTrue(all(list(row) == list(MODELS) for row in table.values()))

    def test_each_cell_runs_or_is_refused_by_name(self):
        for (kind, feature), row in table_of_page().items():
            for model, word in row.items():
                with self.subTest(scene=kind, feature=feature, model=model):
                    code, text = self.answer(kind, feature, model)
                    if code is None:
                        continue
                    self.assertEqual(code, {"yes": 0, "no": 2}[word], text)
                    if word == "no":
                        self.assertRegex(text, r"(/[a-z_]+/[a-z_/0-9]+|--save-state|ranks).*allowed", text)


if __name__ == "__main__":
    unittest.main()
