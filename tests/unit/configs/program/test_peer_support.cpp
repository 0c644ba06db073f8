#include <catch2/catch.hpp>
#include <functional>
#include <new>

#include "configs/program/peer_support.hpp"
#include "configs/scene/scene_frames.hpp"

using namespace wade;

namespace {

// Shaped as the protocol's.
struct MadeUpWaiting {
    double attach_timeout_s = 0;
    double step_timeout_s = 0;
    std::function<bool()> interrupted;
    std::function<void(const std::string&)> warn;
};

class MadeUpError : public std::runtime_error {
 public:
    explicit MadeUpError(int code) : std::runtime_error("made up"), code_(code) {}
    [[nodiscard]] int exit_code() const { return code_; }

 private:
    int code_;
};

int code_of(const std::exception& error) {
    return exit_code_of<MadeUpError>(error);
}

Scene lasting(double duration, double frame_rate) {
    Scene scene;
    scene.duration = duration;
    scene.frame_rate = frame_rate;
    return scene;
}

}  // namespace

TEST_CASE("an error of the peer, of the run or of a library gives the exit code of its own") {
    CHECK(code_of(RunError(ExitCode::numerical_failure, "")) == 9);
    CHECK(code_of(ConfigurationError("")) == 2);
    CHECK(code_of(MadeUpError(4)) == 4);
    CHECK(code_of(MadeUpError(8)) == 8);
    CHECK(code_of(std::invalid_argument("")) == 2);
    CHECK(code_of(std::bad_alloc()) == 1);
    CHECK(code_of(std::runtime_error("")) == 1);
}

TEST_CASE("an interrupted wait gives the exit code of the signal") {
    CHECK(code_of(MadeUpError(130)) == exit_code_of_signal());
}

TEST_CASE("the time-outs of the command line are those of the wait") {
    RunOptions options;
    options.attach_timeout = 3;
    options.step_timeout = 7;
    Console console("test");
    const auto waiting = waiting_of<MadeUpWaiting>(options, console);
    CHECK(waiting.attach_timeout_s == 3);
    CHECK(waiting.step_timeout_s == 7);
    CHECK_FALSE(waiting.interrupted());
    CHECK(waiting.warn);
}

TEST_CASE("a scene lasts for its duration, rounded to whole frames, and for one frame at least") {
    CHECK(frames_of(lasting(400, 30)) == 12000);
    CHECK(frames_of(lasting(10, 29.97)) == 300);
    CHECK(frames_of(lasting(0.1, 30)) == 3);
    CHECK(frames_of(lasting(0.1, 0.01)) == 1);
}
