#include "tools/shm/tool_arguments.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <sstream>

#include "configs/errors/exit_code.hpp"
#include "configs/errors/nearest_name.hpp"
#include "configs/program/help_format.hpp"
#include "configs/program/peer_support.hpp"
#include "configs/program/version.hpp"

namespace wade {
namespace {

std::string short_number(double value) {
    std::ostringstream text;
    text.precision(15);
    text << value;
    return text.str();
}

CLI::Validator within(NumberRange range, bool whole) {
    const auto check = [range, whole](const std::string& text) -> std::string {
        double value = 0;
        if (CLI::detail::lexical_cast(text, value) && range.lo <= value && value <= range.hi &&
            (!whole || value == std::floor(value))) {
            return "";
        }
        return text + " is not allowed; allowed: " + (whole ? "whole numbers from " : "") + short_number(range.lo) +
               " to " + short_number(range.hi);
    };
    return {check, "", ""};
}

CLI::Validator one_of(const std::vector<std::string>& choices) {
    const auto check = [choices](const std::string& text) -> std::string {
        if (std::find(choices.begin(), choices.end(), text) != choices.end()) return "";
        std::string allowed;
        for (const std::string& choice : choices) allowed += (allowed.empty() ? "" : ", ") + choice;
        return text + " is not allowed; allowed: " + allowed;
    };
    return {check, "", ""};
}

}  // namespace

struct ToolArguments::Insides {
    CLI::App app;
};

ToolArguments::ToolArguments(const std::string& program, const std::string& purpose)
    : insides_(std::make_unique<Insides>()) {
    CLI::App& app = insides_->app;
    app.name(program);
    app.description(purpose);
    app.set_version_flag("--version",
                         program + " " + std::string(version()) + " (git " + std::string(git_hash()) + ", " +
                             std::string(compiler()) + ")\n",
                         "Print version, git hash and compiler, and end");
    app.formatter(std::make_shared<HelpFormat>());
    app.allow_extras();  // what is left over is refused below, with the nearest option
    app.option_defaults()->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
}

ToolArguments::~ToolArguments() = default;

void ToolArguments::positional(const std::string& name, std::string& value, const std::string& help, bool required) {
    insides_->app.add_option(name, value, help)->option_text(" ")->required(required);
}

void ToolArguments::flag(const std::string& name, bool& value, const std::string& help) {
    insides_->app.add_flag(name, value, help);
}

void ToolArguments::number(const std::string& name, double& value, const std::string& help,
                           const std::string& placeholder, NumberRange range, Whole whole) {
    insides_->app.add_option(name, value, help + " [" + short_number(value) + "]")
        ->check(within(range, whole == Whole::yes))
        ->option_text(placeholder);
}

void ToolArguments::word(const std::string& name, std::string& value, const std::string& help, const Word& word) {
    const std::string preset = value.empty() ? "" : " [" + value + "]";
    CLI::Option* const option = insides_->app.add_option(name, value, help + preset)->option_text(word.placeholder);
    if (!word.choices.empty()) option->check(one_of(word.choices));
}

void ToolArguments::waiting(shm::Waiting& value) {
    number("--attach-timeout-s", value.attach_timeout_s, "How long to wait for the other side to appear, s", "T",
           {0, 86400});
    number("--step-timeout-s", value.step_timeout_s, "How long to wait for the other side's next step, s; 0: for ever",
           "T", {0, 86400});
}

std::string ToolArguments::program() const {
    return insides_->app.get_name();
}

std::optional<std::string> ToolArguments::parse(int argc, const char* const* argv) {
    CLI::App& app = insides_->app;
    const std::string see_help = " (" + program() + " --help shows the options).";
    try {
        app.parse(argc, argv);
    } catch (const CLI::CallForHelp&) {
        return app.help();
    } catch (const CLI::CallForVersion& call) {
        return call.what();
    } catch (const CLI::ArgumentMismatch& error) {
        const std::string text = error.what();  // begins with the option's name and a colon
        throw ConfigurationError(text.substr(0, text.find(':')) + ": a value is missing" + see_help);
    } catch (const CLI::ParseError& error) {
        throw ConfigurationError(std::string(error.what()) + see_help);
    }
    if (const std::vector<std::string> leftovers = app.remaining(); !leftovers.empty()) {
        const std::string& first = leftovers.front();
        if (first.front() != '-') throw ConfigurationError("unexpected argument \"" + first + "\"" + see_help);
        std::vector<std::string> known;
        for (const CLI::Option* option : app.get_options()) {
            for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
        }
        throw ConfigurationError("unknown option \"" + first + "\"; the nearest is \"" +
                                 nearest_name(first.substr(0, first.find('=')), known) + "\"" + see_help);
    }
    return std::nullopt;
}

void connect(shm::Waiting& waiting, Console& console) {
    waiting.interrupted = [] { return received_signal() != 0; };
    waiting.warn = [&console](const std::string& text) { console.warning(text); };
}

int run_tool(ToolArguments& arguments, int argc, char** argv, const std::function<int(Console&)>& work) {
    Console console(arguments.program());
    try {
        if (const auto answer = arguments.parse(argc, argv)) {
            std::cout << *answer;
            return 0;
        }
        return work(console);
    } catch (const std::exception& error) {
        console.line(error.what());
        return exit_code_of<shm::Error>(error);
    }
}

}  // namespace wade
