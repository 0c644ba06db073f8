"""Wade and SPlisHSPlasH on the same scenes, in turns, on one thread: errors by one set of measures, and cost.

Each engine is a program that takes a scene of its form and writes frames.bin and cost.json, tools/splishsplash/README.md.
"""

import json
import math
import os
import re
import shutil
import statistics
import subprocess
from dataclasses import dataclass, field
from pathlib import Path

from wade.paths import BUILD, ROOT
from wade.reports import plots
from wade.reports.files import PUBLISHED, complain, say, write_whole
from wade.reports.jobs import Fingerprints, read_result
from wade.reports.machine import machine_line
from wade.reports.tables import markdown, number, section, wrapped, write_csv
from wade.suites.speed_vs_error.beside_truths import measured, read_frames
from wade.suites.speed_vs_error.report import PICTURE, TITLE, with_section

TABLE = "beside_splishsplash.csv"
PEER = "SPlisHSPlasH"
TOLERANCE, DIVERGENCE_TOLERANCE = 5e-4, 1e-3  # of both engines: those of the scenes that SPlisHSPlasH ships
LONGEST_STEP = 5e-3  # s of its model, as there
MEASURES = ("tools/python/wade/suites/speed_vs_error/beside_truths.py",)
MODEL = 0.1  # units of its model in a metre of the paper's river, and seconds in one of ours, as its authors ran it
# Ours: the default, steps as long as the rule allows (from a CFL number of 0.9 on other limits hold), and those with looser
# solves, as their errors stay below the peer's.
VARIANTS = {"default": {}, "cfl 0.9": {"cfl": 0.9},
            "cfl 0.9, div 0.01": {"cfl": 0.9, "divergence_solve": {"tolerance": 1e-2}},
            "cfl 0.9, div 0.03, it 1": {"cfl": 0.9, "divergence_solve": {"tolerance": 3e-2},
                                        "density_solve": {"tolerance": TOLERANCE, "min_iterations": 1}}}


@dataclass
class Scene:
    """A tank with a block of water at its far end of x; m, s. Or a stream from x = length on a dry bed."""

    name: str
    kind: str  # whose truth it is
    spacing: float
    duration: float
    every: float  # between frames
    tank: tuple  # length, height, width
    block: tuple = None  # length along x from the far end, height, width in the middle of the tank
    boxes: list = field(default_factory=list)  # (x0, x1, height, z0, z1) on the bed
    viscosity: float = 0.01  # m2/s
    gravity: float = 9.81
    velocity: float = 0.0  # of the stream; 0: there is none

    def scale(self):
        """Units of the peer's model in a metre: its particles are as large as in its own scenes in the river only."""
        return MODEL if self.velocity else 1.0


def dam_break(name, spacing, duration, every):
    return Scene(name, "dam_break", spacing, duration, every, (4, 3, 1.5), (1, 1, 1))


def collapse(spacing):
    return Scene(f"collapse_{spacing:g}", "collapse", spacing, 0.54, 0.005, (3, 2, 0.5), (0.5, 1, 0.5), viscosity=1e-6)


def spheric2(name, spacing):
    return Scene(name, "spheric2", spacing, 3.01, 0.005, (3.22, 2, 1), (1.228, 0.55, 1),
                 [(0.6635, 0.8245, 0.161, 0.2985, 0.7015)], 1e-6)


SCENES = (
    dam_break("dam_break_8k", 0.05, 3, 0.1), dam_break("dam_break_27k", 1 / 30, 0.6, 0.05),
    dam_break("dam_break_97k", 1 / 46, 0.3, 0.05),
    collapse(0.05), collapse(0.025),
    Scene("column_0.05", "column", 0.05, 4, 1 / 30, (1, 2, 1), (1, 1, 1)),
    spheric2("spheric2_4k", 0.055), spheric2("spheric2_11k", 0.04),
    Scene("river", "river", 0.5, 28, 1, (100, 3, 27), gravity=0.981, velocity=1.5),
)
QUICK = ("dam_break_27k", "collapse_0.05", "river")

# Of each kind: main error first; name -> words.
ERRORS = {
    "dam_break": {"mean_density_error": "mean density error", "max_density_error": "largest density error",
                  "compression": "compression"},
    "collapse": {"front": "RMS error of the front, Martin and Moyce", "mean_density_error": "mean density error",
                 "compression": "compression"},
    "column": {"rms_speed": "RMS speed at rest / sqrt(g H)", "pressure": "RMS error of the pressure / (rho g H)",
               "bed_pressure": "error of the pressure at the bed", "level": "error of the level",
               "mean_density_error": "mean density error", "compression": "compression"},
    "spheric2": {"height": "RMS error of the heights / 0.55 m", "pressure": "RMS error of the pressure / its peak",
                 "peak": "error of the pressure's peak", "mean_density_error": "mean density error",
                 "compression": "compression"},
    "river": {"depth": "error of the depth", "speed": "error of the speed", "mean_density_error": "mean density error"},
}


def wade_scene(scene, variant):
    """Our scene file."""
    length, _, width = scene.tank
    channel = {"x_min_m": 0, "x_max_m": length, "z_min_m": 0, "z_max_m": width, "flow": "closed"}
    if scene.velocity:
        channel.update(flow="emitter", depth_m=1, velocity_m_s=scene.velocity, initial_river="dry")
        most = 24000
    else:
        along, height, across = scene.block
        channel["water_blocks"] = [{"x_min_m": length - along, "x_max_m": length, "z_min_m": (width - across) / 2,
                                    "z_max_m": (width + across) / 2, "depth_m": height}]
        most = math.ceil(1.05 * along * height * across / scene.spacing**3)
    fluid = {"particle_spacing_m": scene.spacing, "max_particles": most, "viscosity_m2_s": scene.viscosity,
             "density_solve": {"tolerance": TOLERANCE}, "divergence_solve": {"tolerance": DIVERGENCE_TOLERANCE}}
    obstacles = [{"x_min_m": b[0], "x_max_m": b[1], "height_m": b[2], "z_min_m": b[3], "z_max_m": b[4]}
                 for b in scene.boxes]
    return {"description": f"{scene.name}, beside SPlisHSPlasH, no agents. Froude number of its kind.",
            "duration_s": scene.duration, "frame_rate_hz": 1 / scene.every,
            "world": {"length_m": length, "width_m": width, "gravity_m_s2": scene.gravity},
            "channel": channel, "obstacles": obstacles, "fluid": {**fluid, **variant}}


def their_block(scene):
    """The block as SPlisHSPlasH fills one: its outermost particles a spacing within, each 0.8 of its cube.

    Nearer to the edges of a wall its volume maps throw them out. Its dam break as it ships it, 5 cm from bed and wall. The
    collapse and SPHERIC 2 in its denser pattern, 8 % under density at first, which starts without a shock; in SPHERIC 2,
    whose truth knows the volume of the water, as high as holds it.
    """
    length, _, width = scene.tank
    along, height, across = scene.block
    d = scene.spacing
    if scene.kind == "spheric2":
        # Of that pattern: round(side / d) - 2 particles along x and z, layers sqrt(3)/2 of a spacing apart.
        row = (round(along / d) - 2) * (round(across / d) - 2) * 0.8 * d**3
        height = (round(along * height * across / row) + 1) * math.sqrt(3) / 2 * d
    return {"denseMode": int(scene.kind in ("collapse", "spheric2")),
            "start": [length - along, 0.0, (width - across) / 2], "end": [length, height, (width + across) / 2],
            "translation": [-0.05, 0.05, 0] if scene.kind == "dam_break" else [0, 0, 0], "scale": [1, 1, 1]}


def splishsplash_scene(scene):
    """The same for SPlisHSPlasH, with the settings of the dam break that it ships; its x and y are ours."""
    unit = scene.scale()
    radius = scene.spacing / 2 * unit
    length, height, width = (side * unit for side in scene.tank)
    cell = 0.1 if scene.kind == "dam_break" else 4 * radius

    def box(x0, x1, top, z0, z1, **more):
        sides = [x1 - x0, top, z1 - z0]
        # Cells of the volume map as in that scene: two particles long, in the dam break 10 cm whatever the spacing.
        return {"geometryFile": "box.obj", "translation": [(x0 + x1) / 2, top / 2, (z0 + z1) / 2], "scale": sides,
                "isDynamic": False, "mapThickness": 0.0,
                "mapResolution": [max(5, round(side / cell)) for side in sides], **more}

    beyond = length / 10 if scene.velocity else 0  # a stream has no wall where we look
    bodies = [box(-beyond, length + beyond, height, 0, width, isWall=True, mapInvert=True)]
    bodies += [box(*(side * unit for side in b), isWall=False, mapInvert=False) for b in scene.boxes]
    document = {
        "Configuration": {
            "particleRadius": radius, "simulationMethod": 4, "gravitation": [0, -9.81, 0], "timeStepSize": LONGEST_STEP,
            "cflMethod": 1, "cflFactor": 1, "cflMaxTimeStepSize": LONGEST_STEP, "boundaryHandlingMethod": 2,
            "DFSPH": {"minIterations": 2, "maxIterations": 100, "maxError": 100 * TOLERANCE, "maxIterationsV": 100,
                      "maxErrorV": 100 * DIVERGENCE_TOLERANCE, "enableDivergenceSolver": True}},
        "Materials": [{"id": "Fluid", "density0": 1000, "viscosityMethod": 1,
                       "Standard viscosity": {"viscosity": scene.viscosity * unit, "viscosityBoundary": 0}}],
        "RigidBodies": bodies}
    if scene.velocity:
        document["Materials"][0]["maxEmitterParticles"] = 40000
        document["Emitters"] = [{"id": "Fluid", "type": 0, "width": round(scene.tank[2] / scene.spacing), "height": 2,
                                 "translation": [length, 2 * radius, width / 2], "rotationAxis": [0, 1, 0],
                                 "rotationAngle": math.pi, "velocity": scene.velocity}]
    else:
        document["FluidBlocks"] = [their_block(scene)]
    return document


def box_mesh():
    """A box of side 1 round the origin, its triangles seen from outside."""
    corners = [f"v {x - 0.5} {y - 0.5} {z - 0.5}" for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    faces = ((1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4))
    triangles = [t for a, b, c, d in faces for t in (f"f {a} {b} {c}", f"f {a} {c} {d}")]
    return "\n".join(corners + triangles) + "\n"


@dataclass
class Point:
    """A scene, an engine or variant of ours, and what its runs said: medians."""

    scene: Scene
    label: str
    runs: list

    def cost(self, name):
        return statistics.median(run["cost"][name] for run in self.runs)

    def error(self, name):
        return self.runs[0]["metrics"].get(name)

    def time_factor(self):
        return 1 / self.scene.scale() if self.label == PEER else 1.0

    def cpu(self):
        """CPU seconds of a simulated second."""
        costs = [r["cost"] for r in self.runs]
        return statistics.median(c["solver_cpu_s"] / c["simulated_s"] for c in costs) / self.time_factor()

    def rate(self):
        """Particle-steps a CPU second."""
        return statistics.median(r["cost"]["particle_steps"] / r["cost"]["solver_cpu_s"] for r in self.runs)

    def step(self):
        return self.time_factor() * self.cost("simulated_s") / self.cost("steps")


def run_engine(scene, label, program, folder):
    """One run: {"cost", "metrics"}. RuntimeError if the program does not do its part."""
    folder.mkdir(parents=True, exist_ok=True)
    is_peer = label == PEER
    unit = scene.scale() if is_peer else 1.0
    file = folder.parent / "scene.json"  # beside which the peer keeps its volume maps
    write_whole(file, scene_text(scene, label))
    command = [program, "--frames", file, folder, scene.every]
    if is_peer:
        write_whole(folder.parent / "box.obj", box_mesh())
        command = [program, file, "--measure", folder, "--until-s", scene.duration * unit, "--frame-s",
                   scene.every * unit, "--log-dir", folder / "log", "--reproducible"]
    done = subprocess.run([str(word) for word in command], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                          env=dict(os.environ, OMP_NUM_THREADS="1"), check=False)
    if done.returncode != 0:
        raise RuntimeError(f"{scene.name}, {label}: exit code {done.returncode}: {done.stderr.strip()[-300:]}")
    cost = json.loads((folder / "cost.json").read_text(encoding="utf-8"))
    volume = cost["particle_mass_kg"] / cost["rest_density_kg_m3"] / unit**3
    frames = read_frames(folder / "frames.bin", 1 / unit, 1 / unit)
    metrics = {name: cost[name] for name in ("mean_density_error", "max_density_error")}
    run = {"cost": cost, "metrics": {**metrics, **measured(scene, frames, volume)}}
    (folder / "frames.bin").unlink()
    return run


def scene_text(scene, label):
    """The scene file of an engine."""
    return json.dumps(splishsplash_scene(scene) if label == PEER else wade_scene(scene, VARIANTS[label]))


def run_all(scenes, labels, programs, folder, repeats):
    """The points of all scenes, engines in turns, and why others failed. What is there and would be the same is kept."""
    points, failures = [Point(scene, label, []) for scene in scenes for label in labels], {}
    for k in range(1, repeats + 1):
        for point in points:
            scene, label = point.scene, point.label
            place = folder / scene.name / re.sub(r"\W+", "_", label) / f"repeat-{k}"
            run, words = read_result(place / "result.json"), (scene_text(scene, label), str(scene))
            mark = Fingerprints([programs[label]], ROOT, MEASURES, words)()
            if not run or run.get("fingerprint") != mark:
                complain(f"  {scene.name}, {label} ({k} of {repeats})")
                try:
                    run = run_engine(scene, label, programs[label], place)
                except RuntimeError as error:  # of looser settings that is a result
                    if label in ("default", PEER):
                        raise
                    run = {"failed": str(error)}
                write_whole(place / "result.json", json.dumps({**run, "fingerprint": mark}))
            if "failed" in run:
                failures[(scene.name, label)] = run["failed"]
            point.runs.append(run)
    return [p for p in points if (p.scene.name, p.label) not in failures], failures


def worse_errors(point, peer):
    """The errors of its kind in which a point is worse than the peer, by words."""
    both = ((name, point.error(name), peer.error(name)) for name in ERRORS[point.scene.kind])
    return [name for name, ours, its in both if None not in (ours, its) and ours > its]


def draw(points, file):
    """A panel a kind: main error over CPU seconds of a simulated second; a line joins the spacings of an engine."""
    panels = [(kind, name) for kind, names in ERRORS.items() for name in list(names)[: 2 if kind == "spheric2" else 1]
              if any(p.scene.kind == kind for p in points)]
    rows, labels = -(-len(panels) // 3), list(dict.fromkeys(p.label for p in points))
    figure, axes = plots.pyplot.subplots(rows, 3, figsize=(12.6, 3.6 * rows), squeeze=False)
    for panel, (kind, name) in zip(axes.flat, panels):
        for k, label in enumerate(labels):
            shown = [(p.cpu(), p.error(name)) for p in points if p.scene.kind == kind and p.label == label]
            panel.plot(*(zip(*sorted(shown)) if shown else ([], [])), linewidth=0.8,
                       label=label if label == PEER else "Wade, " + label, color=plots.COLOURS[k],
                       marker=plots.MARKS[k], markersize=5)
        panel.set(xscale="log", yscale="log", title=kind, xlabel="CPU s a simulated second", ylabel=ERRORS[kind][name])
    for panel in axes.flat[len(panels):]:
        panel.set_axis_off()
    axes.flat[0].legend(fontsize=7)
    figure.tight_layout()
    plots.save(figure, file)


def scene_table(scene, points):
    """The points of a scene, ratios to the peer."""
    mine, names, rows = [p for p in points if p.scene is scene], ERRORS[scene.kind], []
    peer = next(p for p in mine if p.label == PEER)
    for p in mine:
        worse = "" if p is peer else "none" if not worse_errors(p, peer) else ", ".join(worse_errors(p, peer))
        times = ("", "") if p is peer else (f"{p.rate() / peer.rate():.1f}", f"{peer.cpu() / p.cpu():.1f}")
        rows.append((p.label, number(p.cost("particles"), 6), number(1e3 * p.step()), number(p.rate() / 1e6),
                     number(p.cpu()), *times,
                     *("-" if (e := p.error(name)) is None else f"{100 * e:.2g} %" for name in names), worse))
    head = ("", "particles", "step, ms", "M particle-steps a CPU s", "CPU s a simulated s", "times its particle-steps",
            "times its simulated time", *names.values(), "worse in")
    return markdown(head, rows)


NOTE = (
    "Both engines on the same scenes and spacings, one thread, in turns in one run; each figure of cost is the "
    "median of {repeats} runs of processor time within the solver, without set-up, measuring and writing. Both have the "
    "tolerances of the scenes that SPlisHSPlasH ships (mean density error 0.05 %, divergence error 0.1 %), the peer volume "
    "maps, CFL 1 and steps of at most 5 ms (in the river of its model, at 1/10 scale). Errors are those of the same "
    "formulas on the particles of both; mean and largest density error are what each engine finds for itself, of "
    "max(0, rho / rho_0 - 1) over particles and steps; `compression` is the same mean by one sum over the particles away "
    "from walls. A particle of the peer weighs 0.8 of its cube, and its blocks begin a spacing from walls, as its volume maps "
    "throw out what is nearer to edges; so its dam break, as it ships it, and its column are 24 % under density at first; "
    "the collapse and SPHERIC 2 have its denser pattern, SPHERIC 2 as high as holds the volume asked for. The level is "
    "measured against the depth of the water's own volume, the river against what was asked for.")


def report(points, failures, repeats):
    """The section of report.md."""
    engines = sorted({p.runs[0]["cost"]["engine"] for p in points})
    parts = [f"Machine: {machine_line()} Engines: {', '.join(engines)}. What was run: [{TABLE}]({TABLE}).",
             NOTE.format(repeats=repeats), f"![Error over cost of both engines]({PICTURE})"]
    for scene in dict.fromkeys(p.scene.name for p in points):
        mine = [p for p in points if p.scene.name == scene]
        parts += [f"**{scene}**, d = {mine[0].scene.spacing:.4g} m, {mine[0].scene.duration:g} s",
                  scene_table(mine[0].scene, points)]
        parts += [f"* {label} failed: {why}" for (name, label), why in failures.items() if name == scene]
    return wrapped(section(TITLE, *parts))


def write_points(file, points, machine):
    """What was run, a line a point and error; settings in words."""
    head = ("scene", "engine", "setting", "spacing_m", "duration_s", "particles", "steps", "particle_steps", "repeats",
            "cpu_s_per_sim_s", "particle_steps_per_cpu_s", "density_iterations", "divergence_iterations",
            "error_metric", "error", "machine")
    rows = []
    for p in points:
        theirs = (f"volume maps; cfl 1; dt <= {LONGEST_STEP:g} s; maxError {100 * TOLERANCE:g} %; "
                  f"maxErrorV {100 * DIVERGENCE_TOLERANCE:g} %")
        ours = f"tolerance {TOLERANCE:g}; divergence tolerance {DIVERGENCE_TOLERANCE:g}; {p.label}"
        cost = [number(p.cost(name), 8) for name in ("particles", "steps", "particle_steps")]
        for name, value in p.runs[0]["metrics"].items():
            rows.append((p.scene.name, p.runs[0]["cost"]["engine"], theirs if p.label == PEER else ours,
                         number(p.scene.spacing, 6), number(p.scene.duration), *cost, len(p.runs), number(p.cpu(), 4),
                         number(p.rate(), 4), number(p.cost("density_iterations")),
                         number(p.cost("divergence_iterations")), name, number(value, 4, none=""), machine))
    write_csv(file, head, rows)


def main(chosen):
    """`wade speed-vs-error --splishsplash PROGRAM`."""
    peer, ours = Path(chosen.splishsplash).resolve(), BUILD / "tests" / "bench" / "bench_fluid"
    for program, how in ((peer, "see tools/splishsplash/README.md"), (ours, "`ninja bench_fluid` builds it")):
        if not os.access(program, os.X_OK):
            complain(f"speed-vs-error: --splishsplash: {program} is no program; {how}")
            return 2
    wanted = chosen.cases.split(",") if chosen.cases else QUICK if chosen.quick else [s.name for s in SCENES]
    unknown = [name for name in wanted if name not in {s.name for s in SCENES}]
    if unknown:
        allowed = ", ".join(s.name for s in SCENES)
        complain(f'speed-vs-error: --cases: "{unknown[0]}" is not allowed; allowed: {allowed}')
        return 2
    programs = {**dict.fromkeys(VARIANTS, ours), PEER: peer}
    out = chosen.out / "beside_splishsplash"
    try:
        points, failures = run_all([s for s in SCENES if s.name in wanted], list(programs), programs, out, chosen.repeats)
    except (RuntimeError, OSError, KeyError) as error:
        complain(f"speed-vs-error: {error}")
        return 1
    write_points(out / TABLE, points, machine_line())
    draw(points, out / PICTURE)
    write_whole(out / "report.md", report(points, failures, chosen.repeats))
    say(out / "report.md")
    if chosen.publish:
        home = PUBLISHED / "speed_vs_error"
        before, part = ((place / "report.md").read_text(encoding="utf-8") for place in (home, out))
        write_whole(home / "report.md", with_section(before, part))
        for name in (TABLE, PICTURE):
            shutil.copyfile(out / name, home / name)
        say(f"published: {home.relative_to(ROOT)}")
    return 0
