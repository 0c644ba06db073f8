"""The report: what each case is, what held, the largest stable CFL factor and tolerance."""

from wade.reports import plots
from wade.reports.files import write_whole
from wade.reports.machine import processor
from wade.reports.plots import pyplot
from wade.reports.tables import document, markdown, section
from wade.suites.stability import results

COLOURS = {"pass": "#2a7f3f", "known": "#d9a400", "fail": "#c0392b", None: "#dddddd"}
LABELS = {"pass": "all rules hold", "known": "known failure", "fail": "fails", None: "not run"}

RULES = """Rules: no particle is lost (outside the solids, or missing from the count, recycling included), all numbers are
finite, compression <= 1 % as mean over the particles at every step, kinetic and potential energy <= 1.05 of what was there at
the start or was put in since (emitter, drive, slope), kinetic energy <= 1.05 of what of it can become motion (at least that of
waves half a spacing high), no particle moves half a spacing in a step, the same bits in one
thread and two (at the default settings; below 3072 particles the solver works in one thread anyway). Some cases have rules of
their own. Single particles may be compressed more than their mean."""
STABLE = "Stable: no particle lost, all numbers finite, the rules on compression, energy and way in a step hold."
CFL = """ From a factor of 0.9 on it sets no step any more: the solver's own limits do, 0.5 d / sqrt(g depth) and
0.4 d / largest speed."""


def draw_map(cases, found, file):
    """Cases against settings, the verdict as colour."""
    names = [name for name in results.SETTINGS if any(key[1] == name for key in found)]
    figure, axes = pyplot.subplots(figsize=(2.8 + 0.75 * len(names), 1.6 + 0.26 * len(cases)), layout="constrained")
    verdicts = {(row, column): found.get((case.name, name), {}).get("verdict")
                for row, case in enumerate(cases) for column, name in enumerate(names)}
    for (row, column), verdict in verdicts.items():
        axes.add_patch(pyplot.Rectangle((column, row), 0.94, 0.9, color=COLOURS[verdict]))
    axes.set(xlim=(0, len(names)), ylim=(len(cases), 0))
    axes.grid(False)
    axes.set_xticks([k + 0.47 for k in range(len(names))], names, rotation=35, ha="right", fontsize=8)
    axes.set_yticks([k + 0.45 for k in range(len(cases))], [case.name for case in cases], fontsize=8)
    axes.tick_params(length=0)
    axes.spines[:].set_visible(False)
    used = set(verdicts.values())
    handles = [pyplot.Rectangle((0, 0), 1, 1, color=COLOURS[v], label=LABELS[v]) for v in COLOURS if v in used]
    axes.legend(handles=handles, loc="lower left", bbox_to_anchor=(0, 1.0), fontsize=8)
    plots.save(figure, file, dpi=90)


def case_table(cases, found):
    rows = []
    for case in cases:
        run = found.get((case.name, "default"))
        if run is None:
            rows.append([case.name, case.trouble, "", "", "", "", "", "not run"])
            continue
        compression = f"{results.percent(run['mean_density_error'])}, {results.percent(run['max_density_error'])}"
        rows.append([case.name, case.trouble, run["particles"], run["steps"], compression,
                     results.number(run["energy_ratio"]),
                     results.number(run["max_displacement_over_spacing"]), LABELS[run["verdict"]]])
    head = ("case", "what goes wrong elsewhere", "particles", "steps", "compression: mean, single", "energy", "step, d",
            "verdict")
    return markdown(head, rows)


def own_rules(cases, found):
    rows = []
    for case in cases:
        for check in found.get((case.name, "default"), {}).get("checks", ()):
            same_bits = check["name"] == "bits_differ_between_threads" and check["pass"]
            if check["name"] not in results.STABILITY_RULES and not same_bits:
                mark = "" if check["pass"] else ", known failure" if check["known"] else ", **broken**"
                value = results.number(check["value"])
                rows.append([case.name, check["name"], value, (check["rule"] or "reported") + mark])
    return markdown(("case", "measure", "value", "rule"), rows)


def broken_table(found):
    rows = [[case, name, results.remark(run)] for (case, name), run in found.items()
            if not run["pass"] and name in results.SETTINGS]
    return markdown(("case", "setting", "what is broken"), rows)


def sweep_table(found, sweep, what):
    rows = []
    for case in results.SWEPT_CASES:
        if answer := results.largest_stable(found, case, sweep):
            largest, beyond = answer
            text = f"{beyond[0]}: {results.remark(beyond[1])}" if beyond else "nothing up to the largest allowed"
            rows.append([case, largest or "none", text])
    return markdown(("case", f"largest stable {what}", "what breaks beyond"), rows)


def write(cases, found, known, form, fingerprint, folder):
    draw_map(cases, found, folder / "verdicts.png")
    sweeps = []
    for sweep, what in (("cfl", "CFL factor"), ("tolerance", "tolerance")):
        if any(key[1].startswith(f"sweep_{sweep}_") for key in found):
            sweeps.append(section(f"Sweep of the {what}", STABLE + (CFL if sweep == "cfl" else ""),
                                  sweep_table(found, sweep, what)))
    made = f"Form: {form}. Program and scenes: {fingerprint}. Machine: {processor()}."
    passing = "\n".join(f"* {line}" for line in results.now_pass(found, known))
    write_whole(folder / "report.md", document(
        section("Stability", RULES, made, "![Verdicts](verdicts.png)", level=1),
        section("Cases at the default settings", case_table(cases, found), "Rules of single cases:",
                own_rules(cases, found)),
        section("What is broken", broken_table(found), passing), *sweeps))
