#pragma once
// --help in lines of at most 100 columns, for all programs that read their options with CLI11.

#include <CLI/CLI.hpp>
#include <string>

#include "configs/program/console_text.hpp"

namespace wade {

class HelpFormat : public CLI::Formatter {
 public:
    HelpFormat() { column_width(28); }

    std::string make_description(const CLI::App* app) const override {
        return wrapped(CLI::Formatter::make_description(app), 0);
    }
    std::string make_usage(const CLI::App* app, std::string name) const override {
        return wrapped(CLI::Formatter::make_usage(app, name));
    }
    // Name and value in the left column, what it means in the right one, from the next line on if the name is long.
    std::string make_option(const CLI::Option* option, bool is_positional) const override {
        const std::string name = "  " + make_option_name(option, is_positional) + make_option_opts(option);
        const std::size_t left = column_width_;
        const std::string begin =
            name.size() < left ? name + std::string(left - name.size(), ' ') : name + "\n" + std::string(left, ' ');
        return wrapped(begin + make_option_desc(option), left) + "\n";
    }
};

}  // namespace wade
