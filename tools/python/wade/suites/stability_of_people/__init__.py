"""At what speed of the water people lose their footing: the equations of the response `measured` beside measured formulas.

Three comparisons. Calibration: friction mu and arm lambda fitted to each data set, over its own bodies
and depths; a fit, no forecast. Prediction: children with the constants of that set's adults. Flume:
both programs with people of these constants in a stream that speeds up until they slip or topple, beside the
equations. --quick: the flume at one depth, with fewer bodies. All of it takes about a minute.

Exit code 1: a goal is missed.
"""

from wade import progress
from wade.reports import options
from wade.reports.files import publish, say
from wade.reports.tables import write_csv
from wade.suites.stability_of_people import calibration, flume, report
from wade.suites.stability_of_people.calibration import CHILDREN, SETS

DEPTHS = (0.45, 0.7, 1.0)  # m, within the measured range of all sets
COLUMNS = ("set", "height_m", "mass_kg", "depth_m", "published_m_s", "fitted_m_s", "flume_m_s")


def run_flume(folder, constants, depths, all_bodies):
    """Returns rows (data, height, mass, depth, speed by the equations, flume speed); all bodies or every fifth."""
    people = [(data, *body) for data in SETS for body in data.bodies[:: 1 if all_bodies else 5]]
    rows = []
    for depth in progress.over(depths, "runs the flume, depth by depth"):
        expected = [float(calibration.critical(calibration.demands([(height, mass, depth)]), constants[data.name])[0])
                    for data, height, mass in people]
        found = flume.failures(folder / f"flume_{depth:g}", [(*constants[data.name], *body) for data, *body in people], depth,
                               expected)
        rows += [(*person, depth, *speeds) for person, *speeds in zip(people, expected, found)]
    return rows


def table(constants, in_flume):
    """The rows of the table: each point of each set, then each person of the flume."""
    for data in SETS:
        for row in calibration.points_of(data, data.bodies + (CHILDREN if data.children else ())):
            fitted = float(calibration.critical(calibration.demands([row]), constants[data.name])[0])
            yield (data.name, *row, data.critical(*row), fitted, None)
    for data, *row, expected, found in in_flume:
        yield (data.name, *row, data.critical(*row), expected, found)


def main(arguments):
    chosen = options.parser_of("stability-of-people", "stability_of_people", __doc__,
                               "stability_of_people.csv").parse_args(arguments)
    constants = {data.name: calibration.fitted(data) for data in SETS}
    in_flume = run_flume(chosen.out / "runs", constants, DEPTHS[1:2] if chosen.quick else DEPTHS, not chosen.quick)
    write_csv(chosen.out / "stability_of_people.csv", COLUMNS, table(constants, in_flume))
    missed = report.write(chosen.out, constants, in_flume)
    say(f"report: {chosen.out / 'report.md'}, table: {chosen.out / 'stability_of_people.csv'}")
    for text in missed:
        say(f"missed: {text}")
    if chosen.publish:
        publish(chosen.out, "stability_of_people", "stability_of_people.csv")
    return 1 if missed else 0
