#pragma once
// The command line that both programs share.
//
//   const wade::ProgramStart start = wade::start_program({"fluid_server", "Simulates the water."}, argc, argv);
//   if (start.answer) {  // of --help, --version, --check or --print-config
//       std::cout << *start.answer;
//       return 0;
//   }
//   ... start.options, start.loaded.scene ...

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "configs/loading/scene_loader.hpp"

namespace wade {

struct RunOptions {
    std::filesystem::path scene_file;
    std::string session;                       // name of the shared memory segment, without a leading slash
    std::optional<std::filesystem::path> out;  // run folder; none: the program's own choice
    bool reproducible = false;                 // no times or host names in outputs
    int threads = 0;                           // 0: as many as there are processors
    double attach_timeout = 10;                // s, how long to wait for the peer to appear
    double step_timeout = 60;                  // s, how long to wait for the peer's next frame; 0 waits for ever
    bool check = false;
    bool print_config = false;
    std::vector<SceneOverride> overrides;      // --set, --seed and --until-s, in this order
    std::map<std::string, double> extras;      // the program's own options; a switch is 1 if given, else 0
    std::map<std::string, std::string> words;  // those that take a word
    std::vector<std::string> arguments;        // argv as it was, for the manifest

    // Value of one of the program's own options; the name must be one of its description.
    [[nodiscard]] double extra(const std::string& name) const { return extras.at(name); }
    [[nodiscard]] bool has(const std::string& name) const { return extra(name) != 0; }
    [[nodiscard]] const std::string& word(const std::string& name) const { return words.at(name); }
};

// An option that only one of the programs has: a switch, a number with a range, or a word.
//   {"--no-figure", "Do not draw figure.png"}
//   {"--water-every-s", "Interval of the stored water, s", NumberRange{0.1, 1000}, 5}
//   {.name = "--clock", .help = "Pace of the run", .word = Word{"MODE", "fast", {"fast", "real_time"}}}
struct NumberRange {
    double lo = 0;
    double hi = 0;
    bool whole = false;  // whole numbers only
};
struct Word {
    std::string placeholder;                // in --help
    std::string preset = {};                // value if the option is not given
    std::vector<std::string> choices = {};  // none: any text
};
struct ProgramOption {
    std::string name;
    std::string help;
    std::optional<NumberRange> number = std::nullopt;
    double preset = 0;  // of a number, if the option is not given
    std::optional<Word> word = std::nullopt;
};

struct ProgramDescription {
    std::string name;
    std::string purpose;  // one sentence, shown by --help
    std::vector<ProgramOption> extras = {};
    std::string without_out = "runs/<scene>-<time>/";  // shown by --help: where outputs go without --out
};

struct ProgramStart {
    RunOptions options;
    LoadedScene loaded;                 // empty if `answer` is that of --help or --version
    std::optional<std::string> answer;  // text for stdout; the program then ends with exit code 0
};

// Reads the command line and the scene that it names; answers --help, --version, --check and --print-config.
// Throws ConfigurationError (exit code 2) for wrong usage and for a wrong scene. Once a scene is loaded,
// options.session is set, by --session or to the default.
[[nodiscard]] ProgramStart start_program(const ProgramDescription& program, int argc, const char* const* argv);

// wade-<uid>-<first 8 hexadecimal digits of the scene hash>, so that two programs with the same scene meet.
[[nodiscard]] std::string default_session_name(std::uint64_t scene_hash);

}  // namespace wade
