// kill_peer produce|consume SESSION [--frames N] [--consumers N] [--depth D] [--log FILE]
//           [--kill-after-us T | --kill-when writing|published|reading|released --kill-at-frame F]
//
// One side of a stream of known values, which may be killed at any moment. It keeps a log of the frames that it has
// published or used: a line is written before the frame is acknowledged, so the log holds all that the other side can
// know. --kill-after-us sets a timer that kills the process without any warning; --kill-when kills it at a point that a
// timer would rarely hit.

#include <fcntl.h>
#include <signal.h>
#include <time.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <map>
#include <stdexcept>
#include <string>

#include "shm_protocol/publisher.hpp"
#include "shm_protocol/subscriber.hpp"

namespace {

using namespace wade;

constexpr std::uint32_t particles = 512;  // seven arrays of 2 KiB: a copy is long enough to be interrupted
constexpr int torn = 42;                  // exit code of a consumer that was given a wrong value

float value_of(std::uint64_t frame, std::size_t field, std::size_t k) {
    return 1 + static_cast<float>((frame * 7 + field) % 1021) + static_cast<float>(k % 64) / 64;  // a mass is above 0
}

using Options = std::map<std::string, std::string>;

std::uint64_t number(const Options& options, const std::string& name, std::uint64_t preset) {
    const auto found = options.find(name);
    return found == options.end() ? preset : std::strtoull(found->second.c_str(), nullptr, 10);
}

void kill_myself_after(std::uint64_t microseconds) {
    sigevent event{};
    event.sigev_notify = SIGEV_SIGNAL;
    event.sigev_signo = SIGKILL;
    timer_t timer{};
    itimerspec when{};
    when.it_value.tv_sec = static_cast<time_t>(microseconds / 1'000'000);
    when.it_value.tv_nsec = static_cast<long>(microseconds % 1'000'000) * 1000 + 1;
    if (timer_create(CLOCK_MONOTONIC, &event, &timer) != 0 || timer_settime(timer, 0, &when, nullptr) != 0)
        throw std::runtime_error("the timer cannot be set");
}

// Kills this process if --kill-when names this point of the frame and --kill-at-frame this frame.
void may_die(const Options& options, const std::string& place, std::uint64_t frame) {
    const auto found = options.find("--kill-when");
    if (found != options.end() && found->second == place && frame == number(options, "--kill-at-frame", 0))
        raise(SIGKILL);
}

class Log {
 public:
    explicit Log(const std::string& file)
        : fd_(::open(file.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600)) {}
    void write(const std::string& line) const {
        const std::string text = line + "\n";
        if (::write(fd_, text.data(), text.size()) != static_cast<ssize_t>(text.size()))
            throw std::runtime_error("the log cannot be written");
    }

 private:
    int fd_;
};

shm::Waiting patience() {
    shm::Waiting waiting;
    waiting.attach_timeout_s = 1;
    return waiting;
}

void produce(const std::string& session, const Options& options, const Log& log) {
    shm::StreamInfo info;
    info.producer_name = "kill_peer";
    info.capacity = particles;
    info.depth = static_cast<std::uint32_t>(number(options, "--depth", 1));
    shm::Publisher publisher(session, info, patience());
    log.write("created");
    publisher.wait_for_consumers(static_cast<int>(number(options, "--consumers", 1)));
    const std::uint64_t frames = number(options, "--frames", 100);
    for (std::uint64_t frame = 1; frame <= frames; ++frame) {
        const auto slot = publisher.begin_frame();
        if (!slot) break;
        std::size_t field = 0;
        for (const auto& array : {slot->mass, slot->vx, slot->vy, slot->vz, slot->px, slot->py, slot->pz}) {
            for (std::size_t k = 0; k < array.size(); ++k) array[k] = value_of(frame, field, k);
            if (++field == 4) may_die(options, "writing", frame);
        }
        publisher.end_frame(particles, {}, frame == frames);
        may_die(options, "published", frame);
    }
    publisher.close();
    log.write("closed");
}

bool is_whole(const shm::Frame& frame) {
    std::size_t field = 0;
    for (const auto& array : {frame.mass, frame.vx, frame.vy, frame.vz, frame.px, frame.py, frame.pz}) {
        for (std::size_t k = 0; k < array.size(); ++k)
            if (array[k] != value_of(frame.frame, field, k)) return false;
        ++field;
    }
    return true;
}

void consume(const std::string& session, const Options& options, const Log& log) {
    shm::JoinOptions join;
    join.waiting = patience();
    shm::Subscriber subscriber(session, "kill_peer", join);
    log.write("joined");
    std::uint64_t expected = 1;
    while (const auto frame = subscriber.acquire()) {
        if (frame->frame != expected++ || !is_whole(*frame)) {
            log.write("torn " + std::to_string(frame->frame));
            std::_Exit(torn);
        }
        may_die(options, "reading", frame->frame);
        const std::uint64_t number = frame->frame;
        log.write(std::to_string(number));
        subscriber.release();
        may_die(options, "released", number);
    }
    log.write("ended");
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 3 || argc % 2 == 0) {
        std::fputs("usage: kill_peer produce|consume SESSION [--option VALUE ...]\n", stderr);
        return 2;
    }
    Options options;
    for (int i = 3; i + 1 < argc; i += 2) options[argv[i]] = argv[i + 1];
    try {
        const Log log(options["--log"]);
        if (options.contains("--kill-after-us")) kill_myself_after(number(options, "--kill-after-us", 0));
        if (std::string(argv[1]) == "produce")
            produce(argv[2], options, log);
        else
            consume(argv[2], options, log);
        return 0;
    } catch (const shm::Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return error.exit_code();
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
