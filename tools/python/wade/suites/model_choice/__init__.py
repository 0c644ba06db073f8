"""How often the model that "auto" chooses keeps the error that was asked for, in scenes its table does not know.

Runs fifteen scenes (configs/model_choice) that were not used to measure the table of the choice:
rivers, fronts, blocks, emitters, a slope. Each with /fluid/model "auto" and a max_impulse_error of
0.05, 0.1 and 0.3, with the default settings, and with a fine spacing as the truth. About ten
minutes; a run that is there, of the same scene and settings, is not repeated: after a change of a
solver take another DIR.
"""

import sys

from wade import progress
from wade.paths import ROOT
from wade.reports import options
from wade.reports.files import publish, say, write_whole
from wade.reports.tables import write_csv
from wade.suites.model_choice import report, runs, table

HEADER = (
    "scene,demand,kind,chosen,pilot,went_up,estimated_median,estimated_p95,actual_median,actual_p95,held,default_median,"
    "particle_steps,cpu_s_per_sim_s,cost_over_default,choice_cpu_s,refused"
).split(",")


def cost(document):
    return document["solver_cpu_s"] / document["simulated_s"]


def row_of(name, demand, truth, default, choice, get):
    """A line of the table; None if the run is not there."""
    default_median, _ = runs.median_and_p95(runs.standing_of(default), truth)
    row = {"scene": name, "demand": f"{demand:g}", "default_median": f"{default_median:.4g}"}
    if "refused" in choice:
        return row | {"refused": choice["refused"]}
    document = get(runs.file_of(name), choice["overrides"])
    if document is None:
        return None
    if "error" in document:
        raise SystemExit(f"model-choice: {name} as chosen: {document['error']}")
    median, p95 = runs.median_and_p95(runs.standing_of(document), truth)
    return row | {key: choice[key] for key in ("kind", "chosen", "pilot")} | {
        "went_up": "yes" if choice["went_up"] else "no",
        "estimated_median": f"{choice['estimated_median']:.4g}", "estimated_p95": f"{choice['estimated_p95']:.4g}",
        "actual_median": f"{median:.4g}", "actual_p95": f"{p95:.4g}", "held": "yes" if median <= demand else "no",
        "particle_steps": f"{document['particle_steps']:.6g}", "cpu_s_per_sim_s": f"{cost(document):.4g}",
        "cost_over_default": f"{cost(document) / cost(default):.3g}", "choice_cpu_s": f"{choice['cpu_s']:.2g}",
    }


def rows_of(name, get):
    """The lines of a scene; `get` answers a run, or None if it is not there. Demands with the same choice share a run."""
    scene = runs.file_of(name)
    finest, default = get(scene, runs.finest_overrides(name)), get(scene, [])
    if finest is None or default is None:
        return []
    for document in (finest, default):
        if "error" in document:
            raise SystemExit(f"model-choice: {scene}: {document['error']}")
    truth = runs.standing_of(finest)
    rows = [row_of(name, d, truth, default, runs.choose(scene, d), get) for d in runs.demands(name)]
    return [row for row in rows if row is not None]


def main(arguments):
    parser = options.parser_of("model-choice", "model_choice", __doc__, "model_choice.csv")
    parser.add_argument("--report-only", action="store_true", help="run nothing: the report of the runs that are there")
    parser.add_argument("--table", choices=("write", "check"),
                        help="only write fluid_server/model_choice/table.csv from its "
                        "measurements, or check that it is what they give")
    parser.add_argument("--measure", action="store_true",
                        help="only measure anew, in DIR, what the table is made of beside speed-vs-error")
    chosen = parser.parse_args(arguments)
    if chosen.measure:
        table.measure(chosen.out / "runs")
        return 0
    if chosen.table == "write":
        write_whole(table.TABLE, table.table_text())
        return 0
    if chosen.table == "check":
        same = table.TABLE.exists() and table.TABLE.read_text() == table.table_text()
        say(f"{table.TABLE.relative_to(ROOT)}: {'as' if same else 'not what'} the measurements give"
            f"{'' if same else '; tools/wade model-choice --table write'}")
        return 0 if same else 1
    rows = []
    names = runs.QUICK if chosen.quick else list(runs.FINEST)
    for name in progress.over(names, "runs the scenes"):
        rows += rows_of(name, lambda scene, overrides: runs.run(scene, overrides, chosen.out / "runs",
                                                                only_stored=chosen.report_only))
        if rows:
            write_csv(chosen.out / "model_choice.csv", HEADER, rows)
            report.write(rows, names, chosen.out)
    if not rows:
        sys.exit(f"model-choice: no runs in {chosen.out / 'runs'}")
    say(chosen.out / "report.md")
    if chosen.publish:
        publish(chosen.out, "model_choice", "model_choice.csv")
    return 0
