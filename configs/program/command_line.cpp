#include "configs/program/command_line.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include "configs/checks/scene_checks.hpp"
#include "configs/errors/exit_code.hpp"
#include "configs/errors/nearest_name.hpp"
#include "configs/program/help_format.hpp"
#include "configs/program/version.hpp"
#include "configs/scene/crowd.hpp"
#include "configs/scene/fluid.hpp"

namespace wade {

namespace {

constexpr std::size_t longest_session_name = 200;  // a shared memory name has at most 255 characters

void check_session_name(const std::string& name) {
    const bool allowed = !name.empty() && name.size() <= longest_session_name &&
                         name.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._-") ==
                             std::string::npos;
    if (allowed) return;
    throw ConfigurationError("--session: \"" + name + "\" is not allowed; allowed: 1 to " +
                             std::to_string(longest_session_name) + " letters, digits, '.', '_' and '-'.");
}

std::string version_text(const std::string& program) {
    return program + " " + std::string(version()) + " (git " + std::string(git_hash()) + ", " +
           std::string(compiler()) + ")\n";
}

CLI::Validator within(double lo, double hi, bool whole = false) {
    const auto check = [lo, hi, whole](const std::string& text) -> std::string {
        double value = 0;
        if (CLI::detail::lexical_cast(text, value) && lo <= value && value <= hi &&
            (!whole || value == std::floor(value))) {
            return "";
        }
        return text + " is not allowed; allowed: " + (whole ? "whole numbers from " : "") + short_number(lo) + " to " +
               short_number(hi);
    };
    return {check, "", ""};
}

void refuse_leftovers(const CLI::App& app) {
    const std::vector<std::string> leftovers = app.remaining();
    if (leftovers.empty()) return;
    const std::string& first = leftovers.front();
    if (first.front() != '-') {
        throw ConfigurationError(app.get_name() + ": unexpected argument \"" + first +
                                 "\"; one scene file is allowed.");
    }
    std::vector<std::string> known;
    for (const CLI::Option* option : app.get_options()) {
        for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
    }
    const std::string name = first.substr(0, first.find('='));
    throw ConfigurationError(app.get_name() + ": unknown option \"" + first + "\"; the nearest is \"" +
                             nearest_name(name, known) + "\" (" + app.get_name() + " --help shows the options).");
}

void add_word(CLI::App& app, const ProgramOption& extra, std::map<std::string, std::string>& words) {
    const Word& word = *extra.word;
    words[extra.name] = word.preset;
    const std::string preset = word.preset.empty() ? "" : " [" + word.preset + "]";
    CLI::Option* const option =
        app.add_option(extra.name, words[extra.name], extra.help + preset)->option_text(word.placeholder);
    if (word.choices.empty()) {
        const auto demand_text = [placeholder = word.placeholder](const std::string& text) -> std::string {
            return text.empty() ? "the value is empty; allowed: " + placeholder + ", or not to give the option" : "";
        };
        option->check(CLI::Validator(demand_text, "", ""));
        return;
    }
    const auto check = [choices = word.choices](const std::string& text) -> std::string {
        if (std::find(choices.begin(), choices.end(), text) != choices.end()) return "";
        std::string allowed;
        for (const std::string& choice : choices) allowed += (allowed.empty() ? "" : ", ") + choice;
        return text + " is not allowed; allowed: " + allowed;
    };
    option->check(CLI::Validator(check, "", ""));
}

struct Parsed {
    RunOptions options;
    std::optional<std::string> answer;  // of --help or --version
};

Parsed parse(const ProgramDescription& program, int argc, const char* const* argv) {
    Parsed parsed;
    RunOptions& options = parsed.options;
    options.arguments.assign(argv, argv + argc);
    std::string scene_file, out, seed, until;
    std::vector<std::string> assignments;
    std::map<std::string, bool> switches;

    CLI::App app(program.purpose, program.name);
    app.set_version_flag("--version", version_text(program.name), "Print version, git hash and compiler, and end");
    app.formatter(std::make_shared<HelpFormat>());
    app.allow_extras();  // what is left over is refused below, with the nearest option
    app.option_defaults()->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
    app.add_option("SCENE", scene_file, "Scene file (.json)")->option_text(" ");
    app.add_option("--session", options.session,
                   "Name under which the two programs meet [wade-<uid>-<first 8 hex digits of the scene hash>]")
        ->option_text("NAME");
    app.add_option("--out", out, "Run folder [" + program.without_out + "]")->option_text("DIR");
    app.add_flag("--reproducible", options.reproducible, "Write no times and no host names into outputs");
    app.add_option("--threads", options.threads, "Threads, 1 to 1024; 0: one for each processor [0]")
        ->check(within(0, 1024, true))
        ->option_text("N");
    app.add_option("--seed", seed, "Start of all random numbers, a whole number [the scene's]")->option_text("N");
    app.add_option("--until-s", until, "Simulated time at which the run ends, s [the scene's duration_s]")
        ->option_text("T");
    app.add_option("--set", assignments,
                   "Set the scene's value at a JSON pointer, after all that it extends, for example /fluid/cfl=0.3; "
                   "may be repeated")
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
        ->expected(1)
        ->allow_extra_args(false)
        ->option_text("POINTER=VALUE");
    app.add_option("--attach-timeout-s", options.attach_timeout,
                   "How long to wait for the other program to appear, s [10]")
        ->check(within(0, 86400))
        ->option_text("T");
    app.add_option("--step-timeout-s", options.step_timeout,
                   "How long to wait for the other program's next frame, s; 0: for ever [60]")
        ->check(within(0, 86400))
        ->option_text("T");
    app.add_flag("--check", options.check, "Check the scene, print what it holds, and end");
    app.add_flag("--print-config", options.print_config,
                 "Print the resolved scene, itself a valid scene file, and end");
    for (const ProgramOption& extra : program.extras) {
        options.extras[extra.name] = extra.preset;
        if (extra.number) {
            app.add_option(extra.name, options.extras[extra.name], extra.help + " [" + short_number(extra.preset) + "]")
                ->check(within(extra.number->lo, extra.number->hi, extra.number->whole))
                ->option_text("VALUE");
        } else if (extra.word) {
            add_word(app, extra, options.words);
        } else {
            app.add_flag(extra.name, switches[extra.name], extra.help);
        }
    }

    try {
        app.parse(argc, argv);
    } catch (const CLI::CallForHelp&) {
        parsed.answer = app.help();
        return parsed;
    } catch (const CLI::CallForVersion& call) {
        parsed.answer = call.what();
        return parsed;
    } catch (const CLI::ArgumentMismatch& error) {
        const std::string text = error.what();  // begins with the option's name and a colon
        throw ConfigurationError(program.name + ": " + text.substr(0, text.find(':')) + ": a value is missing (" +
                                 program.name + " --help shows the options).");
    } catch (const CLI::ParseError& error) {
        throw ConfigurationError(program.name + ": " + error.what() + " (" + program.name +
                                 " --help shows the options).");
    }

    refuse_leftovers(app);
    if (scene_file.empty()) {
        throw ConfigurationError(program.name + ": a scene file is required (" + program.name +
                                 " --help shows the options).");
    }
    options.scene_file = scene_file;
    if (app.count("--session") > 0) check_session_name(options.session);
    if (app.count("--out") > 0) options.out = out;
    for (const std::string& assignment : assignments) options.overrides.push_back(parse_override(assignment));
    if (app.count("--seed") > 0) options.overrides.push_back({"/seed", seed, "--seed " + seed});
    if (app.count("--until-s") > 0) options.overrides.push_back({"/duration_s", until, "--until-s " + until});
    for (const auto& [name, given] : switches) options.extras[name] = given ? 1 : 0;
    return parsed;
}

std::string check_text(const RunOptions& options, const Scene& scene) {
    std::uint64_t agents = 0;
    for (const AgentGroup& group : scene.crowd->groups) agents += static_cast<std::uint64_t>(group.count);
    std::string particles;  // cells have room of their own
    if (scene.fluid->model != ModelKind::shallow_water) {
        particles = std::to_string(particles_needed(scene)) + " of " + std::to_string(scene.fluid->max_particles) +
                    " particles needed, ";
    }
    return options.scene_file.string() + ": valid; scene " + scene.name + ", " + std::to_string(agents) + " agents, " +
           particles + "hash " + hash_text(scene.hash) + "\n";
}

}  // namespace

std::string default_session_name(std::uint64_t scene_hash) {
    return "wade-" + std::to_string(getuid()) + "-" + hash_text(scene_hash).substr(0, 8);
}

ProgramStart start_program(const ProgramDescription& program, int argc, const char* const* argv) {
    Parsed parsed = parse(program, argc, argv);
    ProgramStart start{std::move(parsed.options), {}, std::move(parsed.answer)};
    if (start.answer) return start;
    start.loaded = load_scene(start.options.scene_file, start.options.overrides);
    if (start.options.session.empty()) start.options.session = default_session_name(start.loaded.scene.hash);
    if (start.options.check) {
        start.answer = check_text(start.options, start.loaded.scene);
    } else if (start.options.print_config) {
        start.answer = start.loaded.canonical_json;
    }
    return start;
}

}  // namespace wade
