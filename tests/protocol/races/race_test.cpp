// Both sides of a stream as threads over one mapping, for ThreadSanitizer, which follows addresses: a process of its own
// for each side would have addresses of its own, and no race would be seen. Ends with 0 if every frame was whole; the
// sanitizer ends it otherwise.
//
// Two consumers in lockstep, one of them a follower, and a reader of the latest frame beside them, at depth 1 to 3. The
// latter may miss any frame but the last.

#include <sanitizer/common_interface_defs.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstdio>
#include <latch>
#include <string>
#include <thread>

#include "shm_protocol/latest_reader.hpp"
#include "shm_protocol/publisher.hpp"
#include "shm_protocol/subscriber.hpp"

namespace {

using namespace wade;

constexpr std::uint64_t frames = 400;
constexpr std::uint32_t particles = 64;

float value_of(std::uint64_t frame, std::size_t k) {
    return static_cast<float>(frame) + static_cast<float>(k) / particles;
}

bool is_whole(const shm::Frame& frame) {
    for (const auto& array : {frame.mass, frame.vx, frame.vy, frame.vz, frame.px, frame.py, frame.pz})
        for (std::size_t k = 0; k < array.size(); ++k)
            if (array[k] != value_of(frame.frame, k)) return false;
    return true;
}

void produce(shm::Publisher& publisher, std::latch& viewer_has_joined) {
    publisher.wait_for_consumers(2);
    viewer_has_joined.wait();  // the publisher waits for no free-running reader
    for (std::uint64_t f = 1; f <= frames; ++f) {
        const auto slot = publisher.begin_frame();
        if (!slot) break;
        for (const auto& array : {slot->mass, slot->vx, slot->vy, slot->vz, slot->px, slot->py, slot->pz})
            for (std::size_t k = 0; k < array.size(); ++k) array[k] = value_of(f, k);
        shm::Diagnostics diagnostics;
        diagnostics.sub_steps = static_cast<std::uint32_t>(f);
        publisher.end_frame(particles, diagnostics, f == frames);
    }
    publisher.close();
}

void consume(shm::Publisher& publisher, bool follows, std::uint64_t& whole) {
    shm::JoinOptions join;
    join.follows = follows;
    shm::Subscriber subscriber = shm::Subscriber::in_process(publisher, follows ? "recorder" : "crowd", join);
    while (const auto frame = subscriber.acquire()) {
        if (is_whole(*frame) && frame->diagnostics.sub_steps == frame->frame) ++whole;
        subscriber.release();
    }
}

// What a free-running reader has got.
struct Seen {
    std::uint64_t whole = 0, torn = 0;
    std::uint64_t last = 0;  // frame
};

void watch(shm::Publisher& publisher, std::latch& has_joined, Seen& seen) {
    shm::LatestReader reader = shm::LatestReader::in_process(publisher, "viewer");
    has_joined.count_down();
    while (const auto frame = reader.next()) {
        ++(is_whole(*frame) ? seen.whole : seen.torn);
        seen.last = frame->frame;
    }
}

// The sanitizer ends the process without a goodbye.
std::string segment_at_work;
void remove_segment() {
    shm_unlink(segment_at_work.c_str());
}

bool run(std::uint32_t depth) {
    shm::StreamInfo info;
    info.producer_name = "race_test";
    info.capacity = particles;
    info.depth = depth;
    const std::string session = "wade-race-" + std::to_string(getpid()) + "-" + std::to_string(depth);
    segment_at_work = shm::segment_name(session, shm::stream_fluid);
    shm::Publisher publisher(session, info);
    std::uint64_t crowd = 0, recorder = 0;
    Seen viewer;
    std::latch viewer_has_joined(1);
    {
        const std::jthread reader([&] { watch(publisher, viewer_has_joined, viewer); });
        const std::jthread first([&] { consume(publisher, false, crowd); });
        const std::jthread second([&] { consume(publisher, true, recorder); });
        produce(publisher, viewer_has_joined);
    }
    std::printf("depth %u, %llu frames: %llu and %llu whole in lockstep; latest: %llu whole, %llu torn, last %llu\n",
                depth, static_cast<unsigned long long>(frames), static_cast<unsigned long long>(crowd),
                static_cast<unsigned long long>(recorder), static_cast<unsigned long long>(viewer.whole),
                static_cast<unsigned long long>(viewer.torn), static_cast<unsigned long long>(viewer.last));
    return crowd == frames && recorder == frames && viewer.torn == 0 && viewer.last == frames;
}

}  // namespace

int main() {
    __sanitizer_set_death_callback(remove_segment);
    bool good = true;
    for (const std::uint32_t depth : {1U, 2U, 3U}) good = run(depth) && good;
    return good ? 0 : 1;
}
