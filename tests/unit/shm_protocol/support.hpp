#pragma once
// What the tests of the protocol share: sessions that clean up after themselves, child processes, and a stream with
// content that follows from the frame number alone.

#include <sys/types.h>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "shm_protocol/publisher.hpp"
#include "shm_protocol/subscriber.hpp"

namespace wade::shm::test {

// A session name of its own. No segment of it stays in /dev/shm, however the test ends.
class Session {
 public:
    Session();
    ~Session();
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;
    [[nodiscard]] const std::string& name() const { return name_; }
    [[nodiscard]] std::string path() const { return "/dev/shm/" + name_ + "-fluid"; }

 private:
    std::string name_;
};

// A forked process; it never returns into the test runner. What `work` throws becomes its exit code: that of a
// shm::Error, 99 for anything else. Ended and collected by the destructor at the latest.
class Child {
 public:
    explicit Child(const std::function<int()>& work);
    ~Child();
    Child(const Child&) = delete;
    Child& operator=(const Child&) = delete;

    [[nodiscard]] pid_t pid() const { return pid_; }
    void kill(int signal) const;
    int wait();                   // exit code, or 128 + signal
    int wait_continuing_stops();  // the same, and sends SIGCONT whenever the process stops

 private:
    pid_t pid_;
    std::optional<int> status_;
};

inline constexpr std::uint32_t test_capacity = 500;
inline constexpr std::uint64_t test_scene = 0xABCDEF0123456789;

StreamInfo test_info(std::uint32_t depth = 1, std::uint32_t slots = 0);

// Long enough that only a hang exhausts it, on the slowest machine and under any sanitizer.
Waiting patient();

// Gives up at once if no peer comes.
Waiting hasty();

// Content of frame f as a function of f, the field and the particle; the number of particles changes too.
std::uint32_t test_count(std::uint64_t frame);
float test_value(std::uint64_t frame, int field, std::uint32_t particle);
void fill(const FrameFields& fields, std::uint32_t count);
bool is_as_filled(const Frame& frame);

// Publishes the next test frame. Errors: std::runtime_error if the stream has ended.
void publish_next(Publisher& publisher, bool final = false);

// The hash chain after `frames` test frames, computed without any segment.
std::uint64_t expected_chain(std::uint64_t frames);

// Publishes `frames` test frames for one consumer, calling at(stage, frame) around each; the code of the exit.
enum class Stage { before, writing, after };
using AtStage = std::function<void(Stage, std::uint64_t)>;
int produce(const std::string& session, std::uint64_t frames, std::uint32_t depth, const AtStage& at = {});

// Receives all frames, checks each; 0 if `frames` came, in order, with the right content and chain.
int consume(const std::string& session, std::uint64_t frames, const AtStage& at = {});

// The failure and the text of the Error that `work` throws.
struct Caught {
    std::optional<Failure> failure;
    std::string text;
};
Caught catch_error(const std::function<void()>& work);
bool contains(const std::string& text, const std::string& part);

}  // namespace wade::shm::test
