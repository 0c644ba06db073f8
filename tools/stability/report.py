"""The report: what each case is, what held, the largest stable CFL factor and tolerance."""

import platform

import plots
import results
import settings
from run_folder import write_whole

RULES = """Rules: no particle is lost (outside the solids, or missing from the count, recycling included), all numbers are
finite, compression <= 1 % as mean over the particles at every step, kinetic and potential energy <= 1.05 of what was there at
the start or was put in since (emitter, drive, slope), kinetic energy <= 1.05 of what of it can become motion (at least that of
waves half a spacing high), no particle moves half a spacing in a step, the same bits in one
thread and two (at the default settings; below 3072 particles the solver works in one thread anyway). Some cases have rules of
their own. Single particles may be compressed more than their mean.
"""


RULE = "Stable: no particle lost, all numbers finite, the rules on compression, energy and way in a step hold."
STABLE = {
    "cfl": RULE + " From a factor of 0.9 on it sets no step any more: the solver's own limits do, 0.5 d / sqrt(g depth) and\n"
    "0.4 d / largest speed.",
    "tolerance": RULE,
}


def cell(text):
    return str(text).replace("|", "\\|").replace("\n", " ")


def machine():
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as info:
            return next(line.split(":")[1].strip() for line in info if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.machine()


def case_table(cases, found):
    yield "| case | what goes wrong elsewhere | particles | steps | compression: mean, single | energy | step, d | verdict |"
    yield "|---|---|---|---|---|---|---|---|"
    for case in cases:
        run = found.get((case.name, "default"))
        if run is None:
            yield f"| {case.name} | {cell(case.trouble)} | | | | | | not run |"
            continue
        compression = f"{results.percent(run['mean_density_error'])}, {results.percent(run['max_density_error'])}"
        numbers = f"{run['particles']} | {run['steps']} | {compression} | {results.number(run['energy_ratio'])}"
        step = results.number(run["max_displacement_over_spacing"])
        yield f"| {case.name} | {cell(case.trouble)} | {numbers} | {step} | {plots.LABELS[run['verdict']]} |"


def own_rules(cases, found):
    yield "| case | measure | value | rule |"
    yield "|---|---|---|---|"
    common = {"given_up", "nonfinite", "lost_particles", "mean_density_error", "energy_ratio", "displacement"}
    for case in cases:
        run = found.get((case.name, "default"))
        for check in run["checks"] if run else []:
            same_bits = check["name"] == "bits_differ_between_threads" and check["pass"]
            if check["name"] not in common and not same_bits:
                rule = check["rule"] or "reported"
                mark = "" if check["pass"] else ", known failure" if check["known"] else ", **broken**"
                yield f"| {case.name} | {check['name']} | {results.number(check['value'])} | {rule}{mark} |"


def broken_table(found):
    yield "| case | setting | what is broken |"
    yield "|---|---|---|"
    for (case, name), run in found.items():
        if not run["pass"] and name in settings.SETTINGS:
            yield f"| {case} | {name} | {cell(results.remark(run))} |"


def sweep_table(found, sweep, what):
    yield f"| case | largest stable {what} | what breaks beyond |"
    yield "|---|---|---|"
    for case in settings.SWEPT_CASES:
        answer = results.largest_stable(found, case, sweep)
        if answer is None:
            continue
        largest, beyond = answer
        text = "nothing up to the largest allowed" if beyond is None else f"{beyond[0]}: {results.remark(beyond[1])}"
        yield f"| {case} | {largest or 'none'} | {cell(text)} |"


def write(cases, found, known, form, fingerprint, folder):
    plots.draw_map(cases, found, folder / "verdicts.png")
    lines = ["# Stability", "", RULES]
    lines += [f"Form: {form}. Program and scenes: {fingerprint}. Machine: {machine()}.", ""]
    lines += ["![Verdicts](verdicts.png)", "", "## Cases at the default settings", "", *case_table(cases, found), ""]
    lines += ["Rules of single cases:", "", *own_rules(cases, found), ""]
    lines += ["## What is broken", "", *broken_table(found), ""]
    passing = [f"* {line}" for line in results.now_pass(found, known)]
    lines += [*passing, ""] if passing else []
    for sweep, what, label in (("cfl", "CFL factor", "fluid.cfl"), ("tolerance", "tolerance", "density tolerance")):
        if not any(key[1].startswith(f"sweep_{sweep}_") for key in found):
            continue
        plots.draw_sweep(found, sweep, label, folder / f"sweep_{sweep}.png")
        lines += [f"## Sweep of the {what}", ""]
        lines += [STABLE[sweep], ""]
        lines += [*sweep_table(found, sweep, what), "", f"![Sweep](sweep_{sweep}.png)", ""]
        lines += ["A cross marks a run that breaks a rule; dotted: the rules.", ""]
    write_whole(folder / "report.md", "\n".join(lines))
