"""tools/wade: finds the subcommand, brings the programs that it needs up to date, and calls its module."""

import importlib
import os
import sys

from wade.building import BuildError, bring_up_to_date, install_pictures, installing_pictures
from wade.commands import all_commands, commands_by_purpose, find_command
from wade import UsageError, interrupts
from wade.paths import CONFIGS, INSTALLED, ROOT
from wade.progress import Teller
from wade.run.arguments import asks_for_help
from wade.terminal import open_standard_streams, say_error


# Commands that wait for others, or with programs that tell how far they are.
TELL_THEMSELVES = ("run", "run-one", "many", "view", "scenes", "test", "conformance")


def overview():
    """The text of tools/wade --help."""
    lines = ["Usage: tools/wade SUBCOMMAND [--help] ...", ""]
    for purpose, commands in commands_by_purpose().items():
        lines += [purpose, *(f"  {command.name:15} {command.meaning}" for command in commands), ""]
    builds = "" if INSTALLED else "Each installs and builds what it needs. "
    lines.append(f"{builds}tools/wade SUBCOMMAND --help tells its options.")
    return "\n".join(lines)


def unknown(name):
    import difflib  # only where something is wrong, as it takes its time

    near = difflib.get_close_matches(name, [command.name for command in all_commands()], 3)
    meant = f"; did you mean {' or '.join(near)}?" if near else ""
    raise UsageError(f'there is no subcommand "{name}"{meant} (tools/wade --help lists them)')


def carry_out(command, arguments):
    """Builds what a subcommand needs, unless it is only asked for help, and calls it; returns its exit code."""
    runs = not asks_for_help(arguments)
    if runs and command.pictures and not command.draws_last:
        install_pictures()
    module = importlib.import_module(command.module)
    if runs and command.programs:
        try:
            programs = getattr(module, "programs_for", lambda _: command.programs)(arguments)
        except UsageError as error:  # before anything is installed or built
            say_error(f"wade {command.name}: {error} (tools/wade {command.name} --help shows the options)")
            return 2
        if command.draws_last:
            bring_up_to_date(programs, command.with_tests, installing_pictures)
            install_pictures()
        else:
            bring_up_to_date(programs, command.with_tests)
    if not runs or command.name in TELL_THEMSELVES:
        return module.main(arguments)
    with Teller(command.name):
        return module.main(arguments)


def main(arguments):
    """Carries out a command line; returns the exit code."""
    open_standard_streams()
    os.environ.setdefault("WADE_CONFIGS", str(CONFIGS))  # for short names in /extends, wherever the programs lie
    try:
        code = call(arguments)
        sys.stdout.flush()  # here, where a reader that has gone is expected
        return code
    except UsageError as error:
        say_error(f"wade: {error}")
        return 2
    except BuildError:
        say_error("wade: the build failed; the messages above say why")
        return 1
    except KeyboardInterrupt as interrupt:
        if arguments[:1] != ["--module"]:  # a part of a command, which tells of it
            say_error(f"wade{''.join(f' {name}' for name in arguments[:1])}: {interrupts.words(interrupt)}")
        return interrupts.exit_code(interrupt)
    except BrokenPipeError:  # whoever read what is printed has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        return 141


def call(arguments):
    """Calls what the first argument names."""
    if not arguments or arguments[0] in ("-h", "--help", "help"):
        print(overview())
        return 0 if arguments else 2
    name, *rest = arguments
    if name == "--module":  # of a process that one of these modules has started: wade.paths.module_command
        return importlib.import_module(rest[0]).main(rest[1:])
    command = find_command(name)
    if command is None:
        unknown(name)
    if INSTALLED and command.needs_sources:
        raise UsageError(f"{command.name} is not part of an installation; it is called in the sources of Wade")
    if command.script:
        script = ROOT / command.script
        os.execv(script, [str(script), *rest])
    return carry_out(command, rest)
