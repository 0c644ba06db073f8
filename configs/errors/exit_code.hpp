#pragma once
// Exit codes of the programs and the errors that lead to them. Libraries throw; only main prints and exits.

#include <stdexcept>
#include <string>

namespace wade {

enum class ExitCode {
    ok = 0,
    unexpected = 1,
    bad_configuration = 2,
    attach_timeout = 3,
    peer_dead = 4,
    peer_aborted = 5,
    protocol_violation = 6,
    step_timeout = 7,
    name_in_use = 8,
    numerical_failure = 9,
    interrupted = 130,  // SIGINT; SIGTERM gives 143
    terminated = 143
};

// An error that ends the run with a code of its own; what() is a complete sentence for the user.
class RunError : public std::runtime_error {
 public:
    RunError(ExitCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
    [[nodiscard]] ExitCode code() const { return code_; }

 private:
    ExitCode code_;
};

// Bad input: a scene file, an option or a value in them.
class ConfigurationError : public RunError {
 public:
    explicit ConfigurationError(const std::string& message) : RunError(ExitCode::bad_configuration, message) {}
};

}  // namespace wade
