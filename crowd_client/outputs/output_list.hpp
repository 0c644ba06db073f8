#pragma once
// All outputs of a run.

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <string_view>

#include "crowd_client/results/output_writer.hpp"

namespace wade::crowd {

// Order of finishing; outputs are made in the reverse order.
enum class Turn {
    growing,  // files that grow with the run; closing them may take space that is not reserved
    results,  // tables of what came out
    report    // how the run ended; written again if something fails later
};

struct RegisteredOutput {
    Turn turn;
    std::array<std::string_view, 4> files;  // all files that it may leave; files of an earlier run are removed
    std::size_t kept_open;                  // how many files it keeps open until it is finished
    bool (*wanted)(const Scene&, const Record&);
    std::unique_ptr<OutputWriter> (*make)(const OutputPlace&);  // throws OutputError
};

[[nodiscard]] std::span<const RegisteredOutput> outputs();

// An output of every run.
[[nodiscard]] inline bool always(const Scene&, const Record&) {
    return true;
}

template <typename Writer>
[[nodiscard]] std::unique_ptr<OutputWriter> made(const OutputPlace& place) {
    return std::make_unique<Writer>(place);
}

}  // namespace wade::crowd
