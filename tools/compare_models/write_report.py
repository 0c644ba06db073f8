"""report.md, models.csv, models_table1.csv and the pictures."""

import paths  # noqa: F401  it says where the modules of the other suites are

import conclusions
import drawings
import rules
import sections
import table_one_section
from machine import machine_line
from run_folder import write_whole
from tables import write_models, write_table1
from water_models import FOLLOWS_PEOPLE

HEAD = """# Models of the water in one comparison

Written by
`{command}`.
Each validation case that a model can run, with its limits of `tests/validation/thresholds.csv`, and the scenes of Table 1
of the paper, with nothing changed but `/fluid/model`. `models.csv` and `models_table1.csv` hold the numbers.
"""

FOLLOWS = """
Mixed water follows the people of one crowd: in Table 1 each of its crowds has a run of the water of its own, while those of
the other models share one.
"""


def machine_section(machine, outcomes, commits, recorded_file, command):
    own = sorted({o.commit for o in outcomes if not o.source and o.commit})
    text = "## Machine and programs\n\n"
    text += f"* {machine_line(machine)}\n"
    if own:
        text += f"* Validation cases that were run here: programs of commit {', '.join(own)}.\n"
    if any(o.source for o in outcomes):
        text += f"* Validation cases of DFSPH are those of `{recorded_file}`, programs of commit"
        text += f" {', '.join(commits) or 'unknown'}: their CPU times\n  were taken at another time on a machine of the same"
        text += " kind, so that a factor of cost below two or so says little.\n"
    text += "* CPU times of cases are of the solver, one thread, without set-up and measurement; those of Table 1 of the whole"
    text += " server, looked up\n  twice a second. They grow with what else the machine does.\n"
    return text


def write(folder, command, outcomes, models, judge, table1, paper, failures, machine, commits, recorded_file):
    """judge: a results.Judge; table1: {set: [ModelRuns]}."""
    limits, reasons = judge.thresholds, judge.reasons
    graded = rules.limits_of_people(outcomes, limits, reasons)
    folder.mkdir(parents=True, exist_ok=True)
    parts = [HEAD.format(command=command)]
    if table1 and any(model in FOLLOWS_PEOPLE for model in models):
        parts.append(FOLLOWS.lstrip())
    if outcomes or table1:
        parts.append(conclusions.words_section(outcomes, models, graded, reasons, table1))
    if outcomes:
        write_models(folder / "models.csv", outcomes, limits)
        parts.append(sections.cheapest_section(outcomes, models, graded, reasons))
        if drawings.error_over_cost(folder / "error_over_cost.png", outcomes, models, limits):
            parts.append(PLOT)
        parts.append(sections.cases_section(outcomes, models, limits))
        picture = drawings.impulse_errors(folder / "impulse.png", outcomes, models)
        parts.append(sections.impulse_section(outcomes, models, picture))
    if table1:
        write_table1(folder / "models_table1.csv", [runs for of_set in table1.values() for runs in of_set], paper)
    for scene_set, of_set in table1.items():
        picture = f"table1_{scene_set}.png"
        drawings.table1_picture(folder / picture, paper, of_set)
        parts.append(table_one_section.table1_section(of_set, paper, picture))
    parts.append(sections.refusals_section(outcomes, models))
    parts.append(sections.missing_section(outcomes, failures))
    parts.append(machine_section(machine, outcomes, commits, recorded_file, command))
    write_whole(folder / "report.md", "\n".join(part for part in parts if part))


PLOT = """## Error over cost

A panel a case that at least two models can run. Up: of all errors that have a limit, the one that is largest against its
limit, over that limit (below 0.001 drawn at 0.001, above 30 or not measured at 30); the dashed line is the limit. Left is
cheap, below is exact.

![error over cost](error_over_cost.png)
"""
