"""`python3 tools/python` is tools/wade: a folder that is run is where its modules are looked for."""

import sys

from wade.cli import main

sys.exit(main(sys.argv[1:]))
