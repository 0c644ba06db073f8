"""`python3 tools/python` is tools/wade: a folder that is run is where its modules are looked for."""

import sys

from wade import interrupts

interrupts.raise_on_signals()  # before what takes its time to import
try:
    from wade.cli import main

    code = main(sys.argv[1:])
except KeyboardInterrupt as interrupt:
    print(f"wade: {interrupts.words(interrupt)}", file=sys.stderr)
    code = interrupts.exit_code(interrupt)
sys.exit(code)
