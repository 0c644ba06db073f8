#pragma once
// User commands to a running program: pause, single steps, another tau, the end.
//
//   signals   SIGUSR1 pauses or resumes, SIGUSR2 lets a paused run do one step (a running one pauses after it)
//   lines     of a terminal, a pipe or a FIFO:  pause | resume | step [N] | tau VALUE [agent ID | group NAME] | quit
//             an empty line pauses or resumes
//
//   RunControl control(commands);               // after catch_signals()
//   while (...) {
//       control.wait_while_paused(hooks);        // returns at once unless paused
//       for (const TauCommand& c : control.take_tau_commands()) ...
//   }

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace wade {

// Another tau for one agent, one group or, if neither is named, for all.
struct TauCommand {
    double tau = 0;
    std::optional<int> agent;
    std::optional<std::string> group;
};

// One line, understood. Exactly one of the members counts, that which `kind` names.
struct Command {
    enum class Kind { pause, resume, toggle, step, tau, quit } kind = Kind::pause;
    std::uint64_t steps = 1;
    TauCommand tau;
};

// Understands one line. Throws ConfigurationError that names the line and what is allowed.
[[nodiscard]] Command parse_command(std::string_view line);

// Lines from a file descriptor, without ever waiting for them.
class CommandLines {
 public:
    CommandLines() = default;
    // "": the terminal if stdin is one, else nothing. "-": stdin, whatever it is. Else a FIFO, created if it is absent
    // and then removed at the end. Throws ConfigurationError if it cannot be made or read.
    explicit CommandLines(const std::string& place);
    CommandLines(CommandLines&&) noexcept;
    CommandLines& operator=(CommandLines&&) noexcept;
    ~CommandLines();

    // The complete lines that have come since the last call.
    [[nodiscard]] std::vector<std::string> take();
    // Whether they have come to their end since the last call.
    [[nodiscard]] bool have_ended();
    // To poll for lines; -1 while there are none, and while another program has the terminal.
    [[nodiscard]] int fd() const;

 private:
    int fd_ = -1;
    bool ended_ = false;
    std::filesystem::path own_fifo_;
    std::string begun_;
};

class RunControl {
 public:
    struct Hooks {
        std::function<void(bool)> paused;   // told when a pause begins and ends, and 20 times a second in it
        std::function<bool()> interrupted;  // ends the pause
        std::function<void(const std::string&)> message;  // one sentence for the user
    };

    // Signals are taken from now on. Throws as CommandLines.
    explicit RunControl(const std::string& commands);

    // Takes the commands received and holds the caller while the run is paused; a step command lets it go once. A line
    // that is not understood becomes a message. The end of the command input ends a pause, because no further line
    // could.
    void wait_while_paused(const Hooks& hooks);

    // Whether the run is to end here.
    [[nodiscard]] bool quit_asked() const { return quit_; }

    // The commands for tau that have come, in their order.
    [[nodiscard]] std::vector<TauCommand> take_tau_commands();

 private:
    void take_all(const Hooks& hooks);
    void obey(const Command& command);

    CommandLines lines_;  // made after the signal handlers: users may signal once they see the FIFO
    bool paused_ = false;
    bool quit_ = false;
    std::uint64_t steps_left_ = 0;
    std::vector<TauCommand> tau_commands_;
};

}  // namespace wade
