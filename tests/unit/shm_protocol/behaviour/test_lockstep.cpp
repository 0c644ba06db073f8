// Round trips: the same frames arrive, in order, whole, at every depth and whoever comes first.

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include <atomic>
#include <catch2/catch.hpp>
#include <csignal>
#include <fstream>
#include <sstream>
#include <thread>

#include "support.hpp"

using namespace wade::shm;
using namespace wade::shm::test;

namespace {
constexpr std::uint64_t frames_sent = 300;

// Whether an address lies in a mapping of the segment, by the kernel's own account.
bool lies_in_segment(const void* address, const std::string& path) {
    std::ifstream maps("/proc/self/maps");
    const auto a = reinterpret_cast<std::uintptr_t>(address);
    for (std::string line; std::getline(maps, line);) {
        std::istringstream text(line);
        std::uintptr_t begin = 0;
        std::uintptr_t end = 0;
        char dash = 0;
        text >> std::hex >> begin >> dash >> end;
        if (begin <= a && a < end) return contains(line, path);
    }
    return false;
}
}  // namespace

TEST_CASE("two processes exchange all frames in order with the same hash at depth 1, 2 and 3") {
    for (const std::uint32_t depth : {1U, 2U, 3U}) {
        CAPTURE(depth);
        const Session session;
        Child producer([&] { return produce(session.name(), frames_sent, depth); });
        CHECK(consume(session.name(), frames_sent) == 0);
        CHECK(producer.wait() == 0);
    }
}

TEST_CASE("two threads over one mapping exchange all frames in order at depth 1, 2 and 3") {
    for (const std::uint32_t depth : {1U, 2U, 3U}) {
        CAPTURE(depth);
        const Session session;
        Publisher publisher(session.name(), test_info(depth), patient());
        Subscriber subscriber =
            Subscriber::in_process(publisher, "thread", {.scene_hash = test_scene, .waiting = patient()});
        std::uint64_t seen = 0;
        std::uint64_t chain = 0;
        bool whole = true;
        std::thread consumer([&] {
            while (const auto frame = subscriber.acquire()) {
                whole = whole && frame->frame == ++seen && is_as_filled(*frame);
                chain = frame->hash;
                subscriber.release();
            }
        });
        publisher.wait_for_consumers(1);
        for (std::uint64_t f = 1; f <= frames_sent; ++f) {
            const auto fields = publisher.begin_frame();
            if (!fields) break;
            fill(*fields, test_count(f));
            publisher.end_frame(test_count(f), {}, f == frames_sent);
        }
        publisher.close();
        consumer.join();
        CHECK(whole);
        CHECK(seen == frames_sent);
        CHECK(chain == expected_chain(frames_sent));
        CHECK(publisher.frame_hash() == chain);
    }
}

TEST_CASE("the producer is never further ahead than the depth") {
    for (const std::uint32_t depth : {1U, 2U, 3U}) {
        CAPTURE(depth);
        const Session session;
        Publisher publisher(session.name(), test_info(depth, 4), patient());
        Subscriber subscriber = Subscriber::in_process(publisher, "slow", {.waiting = patient()});
        publisher.wait_for_consumers(1);
        std::atomic<std::uint64_t> begun{0};
        std::thread producer([&] {
            for (std::uint64_t f = 1; f <= frames_sent; ++f) {
                if (!publisher.begin_frame()) return;
                begun = f;
                publisher.end_frame(0, {}, f == frames_sent);
            }
            publisher.close();
        });
        bool within = true;
        while (const auto frame = subscriber.acquire()) {
            // Frame f is held, so f - 1 is the last one acknowledged and f - 1 + depth the last one that may begin.
            within = within && begun <= frame->frame - 1 + depth;
            subscriber.release();
        }
        producer.join();
        CHECK(within);
    }
}

TEST_CASE("the consumer may come first") {
    const Session session;
    Child consumer([&] { return consume(session.name(), frames_sent); });
    CHECK(produce(session.name(), frames_sent, 1) == 0);
    CHECK(consumer.wait() == 0);
}

TEST_CASE("frames are written and read in place in the shared memory, and the reader cannot write") {
    const Session session;
    Publisher publisher(session.name(), test_info(), patient());
    Subscriber subscriber(session.name(), "reader", {.waiting = patient()});
    const auto fields = publisher.begin_frame();
    REQUIRE(fields);
    CHECK(fields->px.size() == test_capacity);
    CHECK(lies_in_segment(fields->px.data(), session.path()));
    CHECK(reinterpret_cast<std::uintptr_t>(fields->px.data()) % line_bytes == 0);
    fill(*fields, test_count(1));
    publisher.end_frame(test_count(1));
    const auto frame = subscriber.acquire();
    REQUIRE(frame);
    CHECK(lies_in_segment(frame->px.data(), session.path()));
    CHECK(frame->px.data() != fields->px.data());  // a mapping of its own
    CHECK(is_as_filled(*frame));
    Child intruder([&] {
        const_cast<float&>(frame->px[0]) = 1;
        return 0;
    });
    CHECK(intruder.wait() != 0);
    subscriber.leave();
}

TEST_CASE("the segment is for its owner alone") {
    const Session session;
    const Publisher publisher(session.name(), test_info(), patient());
    struct stat about {};
    REQUIRE(stat(session.path().c_str(), &about) == 0);
    CHECK((about.st_mode & 0777) == 0600);
}

TEST_CASE("diagnostics, ticks and the final mark travel with their frame") {
    const Session session;
    StreamInfo info = test_info(2);
    info.ticks_per_frame = 3;
    Publisher publisher(session.name(), info, patient());
    Subscriber subscriber(session.name(), "reader", {.waiting = patient()});
    CHECK(subscriber.info().ticks_per_frame == 3);
    Diagnostics d;
    d.sub_steps = 4;
    d.mean_density_error = 0;
    d.solver_ns = 123;
    d.position_clamps = 7;
    REQUIRE(publisher.begin_frame());
    publisher.end_frame(0, d);
    REQUIRE(publisher.begin_frame());
    publisher.end_frame(0, {}, true, 10);
    auto frame = subscriber.acquire();
    REQUIRE(frame);
    CHECK(frame->tick == 3);
    CHECK_FALSE(frame->final);
    CHECK(frame->count == 0);
    CHECK(frame->diagnostics.sub_steps == 4);
    CHECK(frame->diagnostics.mean_density_error == 0);
    CHECK(frame->diagnostics.max_density_error != frame->diagnostics.max_density_error);  // not given
    CHECK(frame->diagnostics.solver_ns == 123);
    CHECK(frame->diagnostics.position_clamps == 7);
    subscriber.release();
    frame = subscriber.acquire();
    REQUIRE(frame);
    CHECK(frame->tick == 10);
    CHECK(frame->final);
    subscriber.release();
    CHECK_FALSE(subscriber.acquire());
    publisher.close();
}

TEST_CASE("several consumers in lockstep all see every frame") {
    const Session session;
    Child first([&] { return consume(session.name(), frames_sent); });
    Child second([&] { return consume(session.name(), frames_sent); });
    Publisher publisher(session.name(), test_info(2), patient());
    publisher.wait_for_consumers(2);
    for (std::uint64_t f = 1; f <= frames_sent; ++f) {
        const auto fields = publisher.begin_frame();
        REQUIRE(fields);
        fill(*fields, test_count(f));
        publisher.end_frame(test_count(f), {}, f == frames_sent);
    }
    publisher.close();
    CHECK(first.wait() == 0);
    CHECK(second.wait() == 0);
}

TEST_CASE("a consumer that comes late takes part from the next frame on, and an entry is used again after a goodbye") {
    const Session session;
    Publisher publisher(session.name(), test_info(), patient());
    std::uint64_t chain = 0;
    const auto first = publisher.begin_frame();
    REQUIRE(first);
    fill(*first, test_count(1));
    publisher.end_frame(test_count(1));
    for (std::uint64_t round = 0; round < 40; ++round) {  // more often than there are entries
        Subscriber late(session.name(), "late", {.waiting = patient()});
        const auto fields = publisher.begin_frame();
        REQUIRE(fields);
        fill(*fields, test_count(fields->frame));
        publisher.end_frame(test_count(fields->frame));
        const auto frame = late.acquire();
        REQUIRE(frame);
        CHECK(frame->frame == round + 2);
        CHECK(is_as_filled(*frame));
        chain = frame->hash;
        late.release();
        late.leave();
    }
    CHECK(chain == expected_chain(41));
}

TEST_CASE("stopping and continuing either side changes nothing") {
    const auto stop_sometimes = [](Stage stage, std::uint64_t f) {
        if (f % 60 == 7 * (static_cast<std::uint64_t>(stage) + 1)) raise(SIGSTOP);
    };
    for (const bool stop_producer : {true, false}) {
        CAPTURE(stop_producer);
        const Session session;
        Child child([&] {
            return stop_producer ? produce(session.name(), frames_sent, 2, stop_sometimes)
                                 : consume(session.name(), frames_sent, stop_sometimes);
        });
        int code = -1;
        std::thread watcher([&] { code = child.wait_continuing_stops(); });
        const int own = stop_producer ? consume(session.name(), frames_sent) : produce(session.name(), frames_sent, 2);
        watcher.join();
        CHECK(own == 0);  // order, content and hash chain
        CHECK(code == 0);
    }
}
