// Both sides of a stream as threads over one mapping, for ThreadSanitizer, which follows addresses: a process of its own
// for each side would have addresses of its own, and no race would be seen. Ends with 0 if every frame was whole; the
// sanitizer ends it otherwise.
//
// Two consumers in lockstep, one of them a follower, and a reader of the latest frame beside them, at depth 1 to 3.

#include <sanitizer/common_interface_defs.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstdio>
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

void produce(shm::Publisher& publisher) {
    publisher.wait_for_consumers(2);
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

void watch(shm::Publisher& publisher, bool& all_whole) {
    shm::LatestReader reader = shm::LatestReader::in_process(publisher, "viewer");
    while (const auto frame = reader.next()) all_whole = all_whole && is_whole(*frame);
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
    bool viewer = true;
    {
        const std::jthread reader([&] { watch(publisher, viewer); });
        const std::jthread first([&] { consume(publisher, false, crowd); });
        const std::jthread second([&] { consume(publisher, true, recorder); });
        produce(publisher);
    }
    std::printf("depth %u: %llu and %llu of %llu frames whole, the latest ones %s\n", depth,
                static_cast<unsigned long long>(crowd), static_cast<unsigned long long>(recorder),
                static_cast<unsigned long long>(frames), viewer ? "too" : "not");
    return crowd == frames && recorder == frames && viewer;
}

}  // namespace

int main() {
    __sanitizer_set_death_callback(remove_segment);
    bool good = true;
    for (const std::uint32_t depth : {1U, 2U, 3U}) good = run(depth) && good;
    return good ? 0 : 1;
}
