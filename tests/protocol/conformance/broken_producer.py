"""A producer with one defect: broken_producer.py --session NAME [--defect NAME], --list names them.

Each defect is a class that overrides a rule of the sound producer; `caught_by` is the check that is made for it.
"""

import argparse
import sys

import defects_consumers
import defects_frames
from python_producer import Failure, Publisher


def dashed(name):
    """MagicFirst -> magic-first."""
    return "".join("-" + c.lower() if c.isupper() else c for c in name).lstrip("-")


DEFECTS = {
    dashed(name): value
    for module in (defects_frames, defects_consumers)
    for name, value in vars(module).items()
    if hasattr(value, "caught_by")
}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--session", default="broken")
    parser.add_argument("--defect", choices=sorted(DEFECTS))
    parser.add_argument("--kind", choices=("fluid", "agents"), default="fluid")
    parser.add_argument("--list", action="store_true")
    parser.add_argument("--frames", type=int, default=60)
    parser.add_argument("--particles", type=int, default=50)
    parser.add_argument("--depth", type=int, default=1, choices=range(1, 16))
    parser.add_argument("--attach-timeout-s", type=float, default=10)
    parser.add_argument("--step-timeout-s", type=float, default=60)
    options = parser.parse_args()
    if options.list:
        for name, defect in DEFECTS.items():
            print(f"{name:32} {defect.caught_by}")
        return 0
    try:
        publisher = DEFECTS.get(options.defect, Publisher)(options)
    except Failure as failure:
        print(failure, file=sys.stderr)
        return failure.code
    return publisher.play()


if __name__ == "__main__":
    sys.exit(main())
