"""Wade and SPlisHSPlasH on the cases of tests/validation/beside_cases.py, in turns, on one thread: error and cost.

Each engine is a program that takes a scene of its form and writes frames.bin and cost.json, tools/splishsplash/README.md.
"""

import json
import os
import re
import shutil
import statistics
import subprocess
from dataclasses import dataclass
from pathlib import Path

from beside_cases import (DIVERGENCE_TOLERANCE, ERRORS, LONGEST_STEP, QUICK, SCENES, TOLERANCE, Scene, box_mesh, measured,
                          read_frames, splishsplash_scene, wade_scene)
from wade import plain_file
from wade.paths import BUILD, ROOT
from wade.reports import plots
from wade.reports.files import PUBLISHED, complain, say, write_whole
from wade.reports.jobs import Fingerprints, read_result
from wade.reports.machine import machine_line
from wade.reports.tables import markdown, number, section, wrapped, write_csv
from wade.suites.speed_vs_error.report import PICTURE, TITLE, with_section

TABLE = "beside_splishsplash.csv"
PEER = "SPlisHSPlasH"
MEASURES = ("tests/validation/beside_cases.py",)
# Ours: the default, steps as long as the rule allows (from a CFL number of 0.9 on other limits hold), and those with looser
# solves, as their errors stay below the peer's.
VARIANTS = {"default": {}, "cfl 0.9": {"cfl": 0.9},
            "cfl 0.9, div 0.01": {"cfl": 0.9, "divergence_solve": {"tolerance": 1e-2}},
            "cfl 0.9, div 0.03, it 1": {"cfl": 0.9, "divergence_solve": {"tolerance": 3e-2},
                                        "density_solve": {"tolerance": TOLERANCE, "min_iterations": 1}}}


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
    cost = plain_file.read_json(folder / "cost.json")
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
    """Returns the names of the errors that are larger for a point than for the peer."""
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
