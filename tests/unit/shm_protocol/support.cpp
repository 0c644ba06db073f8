#include "support.hpp"

#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <system_error>
#include <vector>

#include "shm_protocol/inside/bytes/hash.hpp"

namespace wade::shm::test {

namespace {

// A test process that was killed could not clean up; the next one does it, by the process number in the name.
bool sweep_leftovers() {
    const std::string prefix = "wade-test-";
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator("/dev/shm", ignored)) {
        const std::string name = entry.path().filename().string();
        if (!name.starts_with(prefix)) continue;
        const int pid = std::atoi(name.c_str() + prefix.size());
        if (pid > 0 && ::kill(pid, 0) != 0 && errno == ESRCH) shm_unlink(("/" + name).c_str());
    }
    return true;
}

}  // namespace

Session::Session() {
    static const bool swept = sweep_leftovers();
    (void)swept;
    static std::atomic<int> counter{0};
    name_ = "wade-test-" + std::to_string(getpid()) + "-" + std::to_string(counter++);
}

Session::~Session() {
    shm_unlink(("/" + name_ + "-fluid").c_str());
    shm_unlink(("/" + name_ + "-agents").c_str());
}

Child::Child(const std::function<int()>& work) : pid_(fork()) {
    if (pid_ < 0) throw std::runtime_error("fork failed");
    if (pid_ > 0) return;
    prctl(PR_SET_PDEATHSIG, SIGKILL);  // no child outlives a test that crashed
    for (const int signal : {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL, SIGTERM, SIGINT}) std::signal(signal, SIG_DFL);
    int code = 99;
    try {
        code = work();
    } catch (const Error& error) {
        code = error.exit_code();
    } catch (...) {
    }
    _exit(code);
}

Child::~Child() {
    if (status_) return;
    kill(SIGKILL);
    wait();
}

void Child::kill(int signal) const {
    ::kill(pid_, signal);
}

int Child::wait() {
    if (!status_) {
        int status = 0;
        while (waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
        }
        status_ = status;
    }
    return WIFEXITED(*status_) ? WEXITSTATUS(*status_) : 128 + WTERMSIG(*status_);
}

int Child::wait_continuing_stops() {
    int status = 0;
    while (!status_) {
        if (waitpid(pid_, &status, WUNTRACED) != pid_) continue;
        if (WIFSTOPPED(status))
            kill(SIGCONT);
        else
            status_ = status;
    }
    return wait();
}

StreamInfo test_info(std::uint32_t depth, std::uint32_t slots) {
    StreamInfo info;
    info.producer_name = "tester";
    info.capacity = test_capacity;
    info.depth = depth;
    info.slots = slots;
    info.scene_hash = test_scene;
    info.particle_radius = 0.25;
    info.rest_density = 1000;
    return info;
}

Waiting patient() {
    Waiting waiting;
    waiting.attach_timeout_s = 120;
    waiting.step_timeout_s = 120;
    return waiting;
}

Waiting hasty() {
    Waiting waiting;
    waiting.attach_timeout_s = 0.02;
    return waiting;
}

std::uint32_t test_count(std::uint64_t frame) {
    return static_cast<std::uint32_t>((frame * 37) % (test_capacity + 1));
}

float test_value(std::uint64_t frame, int field, std::uint32_t particle) {
    const float least = field == 0 ? 1 : -100;  // a mass is above 0
    return least +
           static_cast<float>((frame * 131 + static_cast<std::uint64_t>(field) * 17 + particle * 7) % 1009) * 0.25F;
}

void fill(const FrameFields& f, std::uint32_t count) {
    const std::array<std::span<float>, 7> fields{f.mass, f.vx, f.vy, f.vz, f.px, f.py, f.pz};
    for (int i = 0; i < 7; ++i)
        for (std::uint32_t k = 0; k < count; ++k) fields[static_cast<std::size_t>(i)][k] = test_value(f.frame, i, k);
}

void publish_next(Publisher& publisher, bool final) {
    const auto fields = publisher.begin_frame();
    if (!fields) throw std::runtime_error("the stream has ended");
    const std::uint32_t count = test_count(fields->frame);
    fill(*fields, count);
    publisher.end_frame(count, {}, final);
}

bool is_as_filled(const Frame& f) {
    if (f.count != test_count(f.frame)) return false;
    const std::array<std::span<const float>, 7> fields{f.mass, f.vx, f.vy, f.vz, f.px, f.py, f.pz};
    for (int i = 0; i < 7; ++i) {
        const auto& field = fields[static_cast<std::size_t>(i)];
        if (field.size() != f.count) return false;
        for (std::uint32_t k = 0; k < f.count; ++k)
            if (field[k] != test_value(f.frame, i, k)) return false;
    }
    return true;
}

std::uint64_t expected_chain(std::uint64_t frames) {
    std::uint64_t chain = 0;
    std::vector<float> values(7UL * test_capacity);
    for (std::uint64_t f = 1; f <= frames; ++f) {
        HashedFields fields;
        for (int i = 0; i < 7; ++i) {
            const auto index = static_cast<std::size_t>(i);
            for (std::uint32_t k = 0; k < test_count(f); ++k) values[index * test_capacity + k] = test_value(f, i, k);
            fields[index] = {values.data() + index * test_capacity, test_count(f)};
        }
        chain = chain_hash(chain, f, fields);
    }
    return chain;
}

int produce(const std::string& session, std::uint64_t frames, std::uint32_t depth, const AtStage& at) {
    Publisher publisher(session, test_info(depth), patient());
    publisher.wait_for_consumers(1);
    for (std::uint64_t f = 1; f <= frames; ++f) {
        if (at) at(Stage::before, f);
        const auto fields = publisher.begin_frame();
        if (!fields || fields->frame != f) return 90;
        fill(*fields, test_count(f));
        if (at) at(Stage::writing, f);
        publisher.end_frame(test_count(f), {}, f == frames);
        if (at) at(Stage::after, f);
    }
    publisher.close();
    return publisher.frame_hash() == expected_chain(frames) ? 0 : 91;
}

int consume(const std::string& session, std::uint64_t frames, const AtStage& at) {
    Subscriber subscriber(session, "reader", {.scene_hash = test_scene, .waiting = patient()});
    std::uint64_t seen = 0;
    std::uint64_t chain = 0;
    for (;;) {
        if (at) at(Stage::before, seen + 1);
        const auto frame = subscriber.acquire();
        if (!frame) break;
        if (frame->frame != ++seen || !is_as_filled(*frame)) return 92;
        chain = frame->hash;
        if (at) at(Stage::writing, seen);
        subscriber.release();
        if (at) at(Stage::after, seen);
    }
    return seen == frames && chain == expected_chain(frames) ? 0 : 93;
}

Caught catch_error(const std::function<void()>& work) {
    try {
        work();
    } catch (const Error& error) {
        return {error.failure(), error.what()};
    }
    return {};
}

bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

}  // namespace wade::shm::test
