"""The command line of a run: its --help text, and which program each option belongs to."""

import shlex
import textwrap

from wade import UsageError
from wade.run.options import OPTIONS, check_option, nearest

HELP = """\
Usage: tools/wade run [SCENE] [--out DIR] [--no-figure]
                      [--record FILE | --replay FILE | --producer COMMAND]
                      [any option of the programs]

Runs SCENE, a file or a short name such as s05 or river/s05 (tools/wade scenes lists them) [s05]:
starts fluid_server and crowd_client, waits for both, prints the outcome and draws DIR/figure.png.

  --out DIR           run folder [runs/<scene>-<time>/ in the project]; the server's log is
                      DIR/fluid_server.log, that of another producer DIR/producer.log
  --record FILE       shm_record writes the water into FILE, frame by frame; for long runs with
                      --quantised --interval-s 0.2, a fifteenth of the size, other bits
  --replay FILE       shm_replay plays FILE in place of fluid_server; with --any-scene also the
                      water of another scene, which the crowd else refuses
  --producer COMMAND  another producer in place of fluid_server, as in a shell, for example
                      './my_producer --session {session}'; {session}, {scene} and {consumers} stand
                      for what the run has; without {session}, --session NAME is added at the end
  --ranks N           shallow water over N ranks of mpirun, the same bits (docs/clusters.md);
                      --mpirun WORDS are options of it, for example '--hostfile FILE'
  --crowds FILE       many crowds in this water (docs/commands.md): a run folder DIR/<name>/ each,
                      DIR/crowds.csv sums up
  --session NAME      name under which the programs meet [a unique one]
  --from-state FILE   the water goes on from a state that --save-state FILE or a numerical failure
                      has written
  --mode latest       the crowd takes the newest frame and the water waits for nobody; fluid_server
                      gets --consumers 0 and --clock real_time, unless you give them. Not with
                      --consumers 1 and more, --clock fast, --replay
  --view              the run in the browser, at the address that is printed; goes on after the run
                      until Ctrl-C. The run keeps poses, terms and the water more often for it, and
                      takes its commands from the page instead of the terminal
  --view-port N       port of the page at 127.0.0.1 [any that is free]
  --no-figure         do not draw figure.png; nor is it drawn with --no-trajectories, which leaves
                      no paths
  --check             only check the scene and the options of both programs
Other options go to the programs that have them; their --help explains them:
{options}
Started from a terminal, the crowd takes commands typed
there (pause, step, tau ...); SIGUSR1 and SIGUSR2 are passed on to it.

Exit code: 0 if all programs ended well and the picture is drawn, else that of the program that
failed first: 1 unexpected, 2 bad configuration or usage, 3 attach time-out, 4 peer dead,
5 peer aborted, 6 protocol violation, 7 step time-out, 8 name in use, 9 numerical failure,
130/143 interrupted."""


def help_text():
    """What --help prints."""
    lines = [textwrap.fill(" ".join(name for name in options if name not in ("--help", "--version")), 100,
                           initial_indent=f"  {program}: ", subsequent_indent="    ", break_on_hyphens=False)
             for program, options in OPTIONS.items()]
    return HELP.replace("{options}", "\n".join(lines))


# What each option of a run takes, for the error text if a value is missing or wrong.
OWN_VALUES = {
    "--out": "a folder",
    "--session": "1 to 200 letters, digits, '.', '_' and '-'",
    "--record": "a file",
    "--replay": "a recording",
    "--producer": "a command as in a shell",
    "--view-port": "a port, 0 to 65535",
    "--ranks": "a number of ranks, 1 and more",
    "--mpirun": "options of mpirun as in a shell",
}
OWN_SWITCHES = ("--no-figure", "--view")


def asks_for_help(arguments):
    """Whether -h or --help is among the arguments, up to "--"."""
    own = arguments[: arguments.index("--")] if "--" in arguments else arguments
    return "-h" in own or "--help" in own


def is_given(arguments, name):
    """Whether an own option is on the command line."""
    return any(argument == name or argument.startswith(name + "=") for argument in arguments)


def values_of(arguments, name):
    """All values that a program's option has among its arguments, as "NAME VALUE" or "NAME=VALUE"."""
    values = [argument.partition("=")[2] for argument in arguments if argument.startswith(name + "=")]
    return values + [value for argument, value in zip(arguments, arguments[1:]) if argument == name]


def suit_to_latest(theirs):
    """With --mode latest the water waits for no consumer: adds the options for it, refuses options that contradict it.

    theirs: {program: its arguments}. Water that is sent as fast as it comes would be over before the crowd has joined.
    """
    if "latest" not in values_of(theirs["crowd_client"], "--mode"):
        return
    if "shm_replay" in theirs:
        raise UsageError("--mode latest and --replay exclude one another: a replay that waits for nobody is over at once")
    server = theirs.get("fluid_server")
    if server is None:
        return
    consumers, clocks = values_of(server, "--consumers"), values_of(server, "--clock")
    for value in consumers:
        if value.isdigit() and int(value) > 0:
            raise UsageError(f"--mode latest and --consumers {value} exclude one another; allowed is --consumers 0")
    if "fast" in clocks:
        raise UsageError("--mode latest and --clock fast exclude one another; allowed is --clock real_time or variable")
    server += ([] if consumers else ["--consumers", "0"]) + ([] if clocks else ["--clock", "real_time"])


def own_value(name, value):
    """The value of an own option, unless it is empty or, for --producer, no command."""
    wrong = not value or name == "--view-port" and not (value.isdigit() and int(value) < 65536)
    wrong = wrong or name == "--ranks" and not (value.isdigit() and int(value) > 0)
    if name in ("--producer", "--mpirun"):
        try:
            words = shlex.split(value)
            wrong = not words or not words[0]
        except ValueError as error:
            raise UsageError(f"{name}: {value} is not allowed ({error}); allowed: {OWN_VALUES[name]}") from error
    if wrong:
        raise UsageError(f'{name}: "{value}" is not allowed; allowed: {OWN_VALUES[name]}')
    return value


def split_arguments(arguments, programs):
    """Sorts arguments into (scene or None, own options, {program: its arguments}), and checks their values.

    programs: names of programs; an option goes to each one that has it. UsageError.
    """
    takes_value = {name: allowed is not None for program in programs for name, allowed in OPTIONS[program].items()}
    takes_value.update(dict.fromkeys(OWN_VALUES, True))
    takes_value.update(dict.fromkeys(OWN_SWITCHES, False))
    scene, own, theirs = None, {}, {program: [] for program in programs}
    rest = list(arguments)
    while rest:
        argument = rest.pop(0)
        if not argument.startswith("-"):
            if scene is not None:
                raise UsageError(f'unexpected argument "{argument}"; one scene file is allowed')
            scene = argument
            continue
        name, equals, value = argument.partition("=")
        if name not in takes_value:
            raise UsageError(f'unknown option "{argument}"; the nearest is "{nearest(name, takes_value)}"')
        words = [argument]
        if takes_value[name] and not equals:
            if not rest:
                raise UsageError(f"{name}: a value is missing")
            value = rest.pop(0)
            words.append(value)
        if name in OWN_VALUES:
            own[name] = own_value(name, value)
            continue
        if name in OWN_SWITCHES:
            if equals:
                raise UsageError(f"{name}: no value is allowed")
            own[name] = True
            continue
        for program in programs:
            if name in OPTIONS[program]:
                theirs[program] += words
                if takes_value[name]:
                    check_option(name, value, OPTIONS[program][name])
    return scene, own, theirs
