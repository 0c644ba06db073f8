#include <catch2/catch.hpp>
#include <cstdint>

#include "shm_protocol/error.hpp"
#include "shm_protocol/inside/wait.hpp"

namespace wade::shm {
namespace {

TEST_CASE("A wait that is over when it is interrupted ends well, another one by the interruption") {
    const bool comes = GENERATE(true, false);
    const bool readable = GENERATE(true, false) || comes;
    std::uint32_t sequence = 0, waiting = 0, paused = 0;
    bool came = false, was_interrupted = false;
    Waiting options;
    options.interrupted = [&] {
        was_interrupted = true;
        came = comes;  // the peer's last word, and its end
        return true;
    };
    WaitTask task;
    task.ready = [&] {
        if (was_interrupted && !readable) throw Error(Failure::protocol_violation, "The page has changed.");
        return came;
    };
    task.after_slice = [] {};
    task.what = [] { return "a peer"; };
    const auto wait = [&] { wait_for_peer({sequence, waiting, paused}, options, task); };
    if (comes) {
        CHECK_NOTHROW(wait());
    } else {
        CHECK_THROWS_WITH(wait(), Catch::StartsWith("Interrupted"));
    }
    CHECK(waiting == 0);
}

}  // namespace
}  // namespace wade::shm
