#pragma once
// The command line of a small program that works on a session rather than on a scene.
//
//   ToolArguments arguments("shm_record", "Records a session into a file.");
//   arguments.positional("SESSION", session, "Name of the session");
//   arguments.number("--frames", frames, "Leave after N frames; 0: never", "N", {0, 1e15}, Whole::yes);
//   return run_tool(arguments, argc, argv, [&](Console& console) { return record(session, frames, console); });

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "configs/program/command_line.hpp"
#include "configs/program/program.hpp"
#include "shm_protocol/stream.hpp"

namespace wade {

enum class Whole { no, yes };

// The variables keep their values unless the option is given; the values they have now are shown as presets.
class ToolArguments {
 public:
    ToolArguments(const std::string& program, const std::string& purpose);
    ~ToolArguments();
    ToolArguments(const ToolArguments&) = delete;
    ToolArguments& operator=(const ToolArguments&) = delete;

    void positional(const std::string& name, std::string& value, const std::string& help, bool required = true);
    void flag(const std::string& name, bool& value, const std::string& help);
    void number(const std::string& name, double& value, const std::string& help, const std::string& placeholder,
                NumberRange range, Whole whole = Whole::no);
    void word(const std::string& name, std::string& value, const std::string& help, const Word& word);
    // --attach-timeout-s and --step-timeout-s, as the programs of a run have them.
    void waiting(shm::Waiting& value);

    // Fills the variables; the text of --help or --version if one of them is asked for.
    // Throws ConfigurationError for wrong usage.
    [[nodiscard]] std::optional<std::string> parse(int argc, const char* const* argv);
    [[nodiscard]] std::string program() const;

 private:
    struct Insides;
    std::unique_ptr<Insides> insides_;
};

// Makes a wait end at a signal and warn on the console, which must live longer.
void connect(shm::Waiting& waiting, Console& console);

// Does all of main(): answers --help and --version, or fills the variables, runs `work` and returns its result as exit
// code. Prints an exception as a line on the console and returns its exit code.
int run_tool(ToolArguments& arguments, int argc, char** argv, const std::function<int(Console&)>& work);

}  // namespace wade
