#pragma once
// What can go wrong between a producer and its consumers; each outcome has the exit code of its own.

#include <stdexcept>
#include <string>

namespace wade::shm {

enum class Failure {
    attach_timeout = 3,      // the other side did not show up in time
    peer_dead = 4,           // the other side's process ended without a goodbye
    peer_aborted = 5,        // the other side gave up and said why
    protocol_violation = 6,  // the other side speaks another version, has another scene or broke a rule
    step_timeout = 7,        // the other side lives but did not go on in time
    name_in_use = 8,         // a living producer has this session name
    interrupted = 130        // Waiting::interrupted returned true
};

// what() is a full sentence for the user. A bad argument of a caller is a std::invalid_argument instead, a call at
// the wrong moment a std::logic_error, a refusal of the operating system a std::system_error.
class Error : public std::runtime_error {
 public:
    Error(Failure failure, const std::string& message) : std::runtime_error(message), failure_(failure) {}
    [[nodiscard]] Failure failure() const { return failure_; }
    [[nodiscard]] int exit_code() const { return static_cast<int>(failure_); }

 private:
    Failure failure_;
};

}  // namespace wade::shm
