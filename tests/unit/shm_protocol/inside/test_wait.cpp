#include <catch2/catch.hpp>
#include <cstdint>

#include "shm_protocol/error.hpp"
#include "shm_protocol/inside/wait.hpp"

namespace wade::shm {
namespace {

TEST_CASE("A wait that is over when it is interrupted ends well, another one by the interruption") {
    const bool comes = GENERATE(true, false);
    std::uint32_t sequence = 0, waiting = 0, paused = 0;
    bool came = false;
    Waiting options;
    options.interrupted = [&] {
        came = comes;  // the peer's last word, and its end
        return true;
    };
    WaitTask task;
    task.ready = [&] { return came; };
    task.after_slice = [] {};
    task.what = [] { return "a peer"; };
    const auto wait = [&] { wait_for_peer({sequence, waiting, paused}, options, task); };
    if (comes) {
        CHECK_NOTHROW(wait());
    } else {
        CHECK_THROWS_AS(wait(), Error);
    }
    CHECK(waiting == 0);
}

}  // namespace
}  // namespace wade::shm
