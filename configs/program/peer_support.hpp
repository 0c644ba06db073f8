#pragma once
// What both programs do alike when they deal with their peer: how long they wait, and what exit code an error gives.
//
// The protocol's types come in as template parameters, so that this room does not know the protocol:
//   waiting_of<shm::Waiting>(options, console)      exit_code_of<shm::Error>(error)

#include <exception>
#include <stdexcept>
#include <string>

#include "configs/errors/exit_code.hpp"
#include "configs/program/command_line.hpp"
#include "configs/program/program.hpp"

namespace wade {

// The time-outs of the command line; a signal interrupts, warnings go to the console, which must live longer.
template <class Waiting>
[[nodiscard]] Waiting waiting_of(const RunOptions& options, Console& console) {
    Waiting waiting;
    waiting.attach_timeout_s = options.attach_timeout;
    waiting.step_timeout_s = options.step_timeout;
    waiting.interrupted = [] { return received_signal() != 0; };
    waiting.warn = [&console](const std::string& text) { console.warning(text); };
    return waiting;
}

// Exit code of a program that this error ends: the code of a RunError or of the protocol's PeerError, where an
// interruption becomes the code of the signal received; 2 for an argument that a library refused; else 1.
template <class PeerError>
[[nodiscard]] int exit_code_of(const std::exception& error) {
    if (const auto* run = dynamic_cast<const RunError*>(&error)) {
        return static_cast<int>(run->code());
    }
    if (const auto* peer = dynamic_cast<const PeerError*>(&error)) {
        const int code = peer->exit_code();
        return code == static_cast<int>(ExitCode::interrupted) ? exit_code_of_signal() : code;
    }
    const bool usage = dynamic_cast<const std::invalid_argument*>(&error) != nullptr;
    return static_cast<int>(usage ? ExitCode::bad_configuration : ExitCode::unexpected);
}

}  // namespace wade
