"""Measures what the weights of the steering water mean as properties of a fluid, in small scenes of configs/models.

Parts: rest, spacing, density and depth over the radius of separation and the weight of cohesion;
viscosity, apparent viscosity between planes over the weights of cohesion and of the loss; settling,
time until the kinetic energy is 1e-4 of its largest, over the losses; dam, a dam break over a dry
bed, error against Ritter and CPU time beside DFSPH. All of them take about ten minutes.
"""

import subprocess

from wade.paths import BUILD
from wade.reports import options
from wade.reports.files import publish, say
from wade.suites.steering import report

PARTS = ("rest", "viscosity", "settling", "dam")


def main(arguments):
    parser = options.parser_of("steering", "steering", __doc__, "steering.csv")
    parser.add_argument("parts", nargs="*", choices=[[], *PARTS], metavar="PART",
                        help="only these of " + ", ".join(PARTS))
    parser.add_argument("--report-only", action="store_true", help="measure nothing: the report of the tables in DIR")
    chosen = parser.parse_args(arguments)
    chosen.out.mkdir(parents=True, exist_ok=True)
    if not chosen.report_only:
        parts = chosen.parts or (["rest", "dam"] if chosen.quick else [])
        program = next(BUILD.rglob("steering_map"))
        code = subprocess.run([program, chosen.out, *parts]).returncode
        if code != 0:
            return code
    report.write(chosen.out)
    say(f"report: {chosen.out / 'report.md'}, table: {chosen.out / 'steering.csv'}")
    if chosen.publish:
        publish(chosen.out, "steering", "steering.csv")
    return 0
