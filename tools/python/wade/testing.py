"""tools/wade test: builds programs and tests and runs them with ctest."""

import os

from wade import UsageError
from wade.building import bring_up_to_date, install, look_again
from wade.outside import works
from wade.paths import BUILD
from wade.run.arguments import asks_for_help
from wade.terminal import say_error
from wade.view import install_modules

HELP = """\
Usage: tools/wade test [--all] [options of ctest]

Installs missing packages, builds the release preset with its tests, and runs the quick set, which
leaves out the tests with the label `long`. Its exit code is that of ctest.

  --all  all tests; installs a browser for the viewer, engines for tools/wade many, and readers of
         exported files such as Blender, and a cross compiler for arm64, too
Other options go to ctest, for example -R unit -V. Where they choose tests (-R, -L, -LE, -I,
--rerun-failed), long ones are not left out. As most tests wait for other processes, two run at once
for each processor; CTEST_PARALLEL_LEVEL is another number."""
CHOICES = ("-R", "--tests-regex", "-L", "--label-regex", "-LE", "--label-exclude", "-I", "--tests-information",
           "--rerun-failed")


def ctest_options(arguments):
    """The options for ctest of a command line."""
    chosen = any(word.partition("=")[0] in CHOICES for word in arguments)
    quick = [] if chosen or "--all" in arguments else ["-LE", "^long$"]
    return ["--test-dir", str(BUILD), "--output-on-failure", *quick, *(word for word in arguments if word != "--all")]


def install_browser():
    """What the page of the viewer is tested with; without it that test is skipped and says so."""
    try:
        if install("viewer"):
            install_modules(with_tests=True)
    except UsageError as error:
        say_error(f"wade test: {error}")


def main(arguments):
    """tools/wade test."""
    if asks_for_help(arguments):
        print(HELP)
        return 0
    install("build", "pictures", "tests")
    if "--all" in arguments:
        install_browser()
        install("readers")
        if install("engines"):  # without them their tests are skipped and say so
            look_again("MPI_CXX_HEADER_DIR")
        install("builds")
        os.environ["WADE_ALL"] = "1"  # a test that lacks its programs fails
    elif works("chromium", "npm"):  # the quick test of the page runs wherever it can
        os.environ.setdefault("npm_config_fetch_retries", "0")  # without a network it says so at once
        try:
            install_modules(with_tests=True)
        except UsageError as error:
            say_error(f"wade test: {error}")
    bring_up_to_date((), with_tests=True)
    os.environ.setdefault("CTEST_PARALLEL_LEVEL", str(2 * len(os.sched_getaffinity(0))))
    return os.execvp("ctest", ["ctest", *ctest_options(arguments)])
