"""All subcommands of tools/wade, by purpose: what each is for, its module, and the programs that it needs.

A module has main(arguments) -> exit code and answers --help without packages or a build. It finds the programs in
wade.paths.BUILD, runs a pair by wade.paths.module_command("wade.run.pair"), and reads its options with
wade.terminal.Parser. Where the programs depend on the options, the module has programs_for(arguments).
"""

from wade.paths import INSTALLED

PAIR = ("fluid_server", "crowd_client")
BENCHMARKS = tuple(f"bench_{part}" for part in ("fluid", "shallow_water", "steering", "crowd", "coupling", "kernels",
                                                "protocol"))


class Command:
    """A subcommand. meaning: one line of at most 75 columns; module: imported when it is called.

    programs: of the build folder, brought up to date before it starts; with_tests: these are built only together with
    the tests; old_names: of scripts in tools/, without their ending; script: run where there is no module; pictures: it
    draws though it needs no programs; draws_last: only what it starts does, so that programs can be built meanwhile.
    """

    def __init__(self, name, meaning, module="", programs=(), with_tests=False, old_names=(), script="", pictures=False,
                 draws_last=False):
        self.name, self.meaning, self.module, self.script = name, meaning, module, script
        self.programs, self.with_tests, self.pictures = programs, with_tests, pictures or bool(programs)
        self.old_names, self.draws_last = old_names, draws_last
        # Not part of an installation.
        self.needs_sources = with_tests or bool(script) or module in ("wade.testing", "wade.check_protocol")


COMMANDS = {
    "Run scenes": (
        Command("run", "run a scene with both programs and draw its picture", "wade.run.pair", PAIR,
                draws_last=True),
        Command("many", "run many scenes, seeds and settings, on one machine or many", "wade.many", PAIR,
                old_names=("run-many",)),
        Command("run-one", "one run of a plan of `many`, for any engine", "wade.ensembles.one"),
        Command("scenes", "list the scenes by their short names", "wade.scenes"),
        Command("site", "import: terrain and houses of a real site (needs GDAL)", "wade.site", pictures=True,
                old_names=("place",)),
    ),
    "Look at a run": (
        Command("view", "a run in the browser, while it goes on or later", "wade.view",
                ("wade_view_server", "crowd_client")),
        Command("figure", "top view of a run: water, paths, goals, outcome", "wade.pictures.figure", pictures=True),
        Command("danger-map", "danger levels of the water, and whom they met", "wade.pictures.danger_map",
                pictures=True),
        Command("maps", "maps of a site: depth, speed, arrival, danger", "wade.pictures.site_maps", pictures=True),
        Command("film", "a film of a run, from above or of the viewer (needs ffmpeg)", "wade.pictures.film", pictures=True),
        Command("render", "a moment of a run with light and water (needs Blender)", "wade.pictures.render", pictures=True),
        Command("export", "people and water as VTK, PLY, OBJ, USD, glTF, GeoTIFF, CSV, PedPy", "wade.export", pictures=True),
    ),
    "Compare outcomes": (
        Command("paper", "all scenarios of the paper with many seeds, beside the paper", "wade.suites.paper", PAIR,
                old_names=("reproduce-paper",)),
        Command("frame-rates", "how much the outcome depends on the frame rate", "wade.sweeps.frame_rates", PAIR),
        Command("together", "who keeps the feet hand in hand, and who alone", "wade.sweeps.together", PAIR),
        Command("depth-sweep", "who arrives over the plane of depth and velocity", "wade.sweeps.depth_sweep", PAIR),
    ),
    "Say what came out": (
        Command("table", "who arrives, stands, is carried, drowns, with honest intervals", "wade.statistics.table",
                pictures=True),
        Command("report", "a page for who decides: numbers, maps, what was assumed", "wade.statistics.page", pictures=True),
        Command("victims", "where to search: map of the last places over all runs", "wade.statistics.victims", pictures=True),
        Command("sensitivity", "which inputs decide who survives: Morris, then Sobol", "wade.statistics.sensitivity",
                ("crowd_client",)),
    ),
    "Judge the water": (
        Command("validate", "analytic solutions and experiments: errors and orders", "wade.suites.validate",
                ("validate",), True),
        Command("stability", "hard cases with all settings of the solver", "wade.suites.stability", ("stability",), True),
        Command("speed-vs-error", "cost and error of the settings of the water", "wade.suites.speed_vs_error",
                ("validate",), True),
        Command("models", "all models of the water side by side", "wade.suites.models", ("validate",), True,
                ("compare-models",)),
        Command("model-choice", "how often the model that `auto` chooses keeps its error", "wade.suites.model_choice",
                ("fluid_server", "impulse_scene"), True),
        Command("steering", "what the weights of the steering water mean in a fluid", "wade.suites.steering",
                ("steering_map",), True, ("steering-map",)),
    ),
    "Judge the crowd": (
        Command("verify-crowd", "tests of ISO 20414, RiMEA and IMO, doors, counter-flow, water", "wade.suites.verify_crowd",
                ("validate",), True),
        Command("converge", "whether outcomes hang on rates, cells and spacings", "wade.suites.converge", PAIR),
        Command("stability-of-people", "when water takes people off their feet, beside flumes",
                "wade.suites.stability_of_people", (*PAIR, "person_demands"), True),
    ),
    "Measure speed": (
        Command("bench", "what each part costs on this machine", "wade.suites.bench",
                (*PAIR, *BENCHMARKS), True),
    ),
    "Test": (
        Command("test", "build the tests and run the quick set, or --all", "wade.testing"),
        Command("conformance", "a producer of water against the shared-memory contract", "wade.conformance.suite"),
        Command("check-protocol", "models, kills, races, fuzzing and producers, long form", "wade.check_protocol"),
        Command("check-model", "search the SPIN models of the protocol", script="tests/protocol/model/check_model.sh"),
        Command("fuzz", "fuzz what readers do with a header page", script="tests/fuzz/fuzz.sh"),
    ),
}


def commands_by_purpose():
    """Those of COMMANDS that can be called here: of an installation only the commands that need no sources."""
    return {purpose: here for purpose, group in COMMANDS.items()
            if (here := [command for command in group if not (INSTALLED and command.needs_sources)])}


def all_commands():
    return [command for group in COMMANDS.values() for command in group]


def find_command(name):
    """The command of this name or older name, with - or _; None if there is none."""
    name = name.replace("_", "-")
    return next((command for command in all_commands() if name in (command.name, *command.old_names)), None)
