// Free-running readers: they get the newest whole frame, count what they missed, and never hold the producer up.

#include <catch2/catch.hpp>
#include <cmath>
#include <csignal>
#include <stdexcept>
#include <thread>
#include <vector>

#include "segment_bytes.hpp"
#include "shm_protocol/latest_reader.hpp"
#include "support.hpp"

using namespace wade::shm;
using namespace wade::shm::test;

namespace {

JoinOptions joining() {
    return {.scene_hash = test_scene, .waiting = patient()};
}

void publish(Publisher& publisher, int frames) {
    for (int i = 0; i < frames; ++i) publish_next(publisher);
}

// Waits for the reader: a producer without waiting could end before its reader joins.
void await_first_consumer(const Session& session) {
    Bytes bytes(session.path());
    const auto& entry = bytes.as<ConsumerEntry>(consumers_offset);
    while (__atomic_load_n(&entry.state, __ATOMIC_ACQUIRE) != consumer_joined) std::this_thread::yield();
}

struct ReaderPair {
    explicit ReaderPair(std::uint32_t stride = 1)
        : publisher(session.name(), test_info(1, 2), patient()), reader(session.name(), "viewer", joining(), stride) {}
    std::uint64_t polled() {
        const auto frame = reader.poll();
        if (!frame) return 0;
        CHECK(is_as_filled(*frame));
        return frame->frame;
    }
    Session session;
    Publisher publisher;
    LatestReader reader;
};

// Runs a producer without waiting in a process of its own, and a reader that checks every value.
void read_freely(std::uint32_t slots, bool hashed, std::uint64_t frames) {
    CAPTURE(slots, hashed);
    const Session session;
    StreamInfo info = test_info(1, slots);
    info.hash_frames = hashed;
    Child producer([&] {
        Publisher publisher(session.name(), info, patient());
        await_first_consumer(session);
        for (std::uint64_t f = 1; f <= frames; ++f) publish_next(publisher, f == frames);
        publisher.close();
        return 0;
    });
    LatestReader reader(session.name(), "viewer", joining());
    std::uint64_t first = 0;
    std::uint64_t last = 0;
    std::uint64_t taken = 0;
    bool sound = true;
    while (const auto frame = reader.next()) {
        sound = sound && frame->frame > last && is_as_filled(*frame);
        last = frame->frame;
        if (first == 0) first = last;
        ++taken;
    }
    CHECK(producer.wait() == 0);
    CHECK(sound);
    CHECK(last == frames);
    CHECK(first - 1 + taken + reader.dropped_frames() == frames);
}

}  // namespace

TEST_CASE("a producer never waits for a free-running reader, which gets the newest frame") {
    ReaderPair pair;
    CHECK_FALSE(pair.reader.poll());
    publish(pair.publisher, 100);  // would wait for ever if it waited
    CHECK(pair.polled() == 100);
    CHECK_FALSE(pair.reader.poll());  // nothing newer
    CHECK_FALSE(pair.reader.ended());
}

TEST_CASE("frames missed between two that were taken are counted, those before the first are not") {
    ReaderPair pair;
    Bytes bytes(pair.session.path());
    const auto& entry = bytes.as<ConsumerEntry>(consumers_offset);
    CHECK(entry.mode == mode_latest);
    publish(pair.publisher, 7);
    CHECK(pair.polled() == 7);
    CHECK(pair.reader.dropped_frames() == 0);
    publish(pair.publisher, 1);
    CHECK(pair.polled() == 8);
    CHECK(pair.reader.dropped_frames() == 0);
    publish(pair.publisher, 5);
    CHECK(pair.polled() == 13);
    CHECK(pair.reader.dropped_frames() == 4);
    CHECK(entry.dropped_frames == 4);
    CHECK(entry.acknowledged_frame == 13);
}

TEST_CASE("with a stride of n at most every n-th frame is taken, and what the stride leaves out is not missed") {
    ReaderPair pair(4);
    CHECK(Bytes(pair.session.path()).as<ConsumerEntry>(consumers_offset).stride == 4);
    publish(pair.publisher, 1);
    CHECK(pair.polled() == 1);
    publish(pair.publisher, 3);
    CHECK(pair.polled() == 0);  // frame 4 is too near
    publish(pair.publisher, 1);
    CHECK(pair.polled() == 5);
    CHECK(pair.reader.dropped_frames() == 0);
    publish(pair.publisher, 15);
    CHECK(pair.polled() == 20);
    CHECK(pair.reader.dropped_frames() == 11);  // wanted from frame 9 on
    CHECK_THROWS_AS(LatestReader(pair.session.name(), "viewer", joining(), 0), std::invalid_argument);
}

TEST_CASE("a frame that was taken is a copy, which the producer cannot change any more") {
    ReaderPair pair;
    publish(pair.publisher, 3);
    const auto frame = pair.reader.next();
    REQUIRE(frame);
    publish(pair.publisher, 20);
    CHECK(frame->frame == 3);
    CHECK(is_as_filled(*frame));
}

TEST_CASE("the last frame is taken, then the stream is over") {
    ReaderPair pair;
    publish(pair.publisher, 2);
    publish_next(pair.publisher, true);
    pair.publisher.close();
    const auto last = pair.reader.next();
    REQUIRE(last);
    CHECK(last->frame == 3);
    CHECK(last->final);
    CHECK(last->hash == expected_chain(3));
    CHECK_FALSE(pair.reader.next());
    CHECK(pair.reader.ended());
}

TEST_CASE("a reader waits for a newer frame and is woken by it") {
    ReaderPair pair;
    std::uint64_t seen = 0;
    std::thread reading([&] {
        if (const auto frame = pair.reader.next()) seen = frame->frame;
    });
    publish_next(pair.publisher);
    reading.join();
    CHECK(seen == 1);
}

TEST_CASE("a producer that gives up is reported after the newest frame, with its reason") {
    ReaderPair pair;
    publish(pair.publisher, 4);
    pair.publisher.abort(9, "the solver diverged");
    CHECK(pair.polled() == 4);
    const Caught caught = catch_error([&] { (void)pair.reader.poll(); });
    CHECK(caught.failure == Failure::peer_aborted);
    CHECK(contains(caught.text, "gave up at frame 5: the solver diverged"));
}

TEST_CASE("a producer killed while it writes is reported as dead, after the newest frame if a slot still holds it") {
    for (const std::uint32_t slots : {1U, 2U}) {
        for (const bool wait : {true, false}) {
            CAPTURE(slots, wait);
            const Session session;
            Child producer([&] {
                Publisher publisher(session.name(), test_info(1, slots), patient());
                await_first_consumer(session);
                publish(publisher, 5);
                (void)publisher.begin_frame();
                raise(SIGKILL);
                return 0;
            });
            LatestReader reader(session.name(), "viewer", joining());
            CHECK(producer.wait() == 128 + SIGKILL);
            std::vector<std::uint64_t> seen;
            const Caught caught = catch_error([&] {
                while (const auto frame = wait ? reader.next() : reader.poll()) seen.push_back(frame->frame);
            });
            CHECK(caught.failure == Failure::peer_dead);
            CHECK(contains(caught.text, "died at frame 6"));
            CHECK(seen == (slots == 1 ? std::vector<std::uint64_t>{} : std::vector<std::uint64_t>{5}));
        }
    }
}

TEST_CASE("a reader whose every copy is overtaken runs into its time-out") {
    const Session session;
    Publisher publisher(session.name(), test_info(1, 1), patient());
    Waiting waiting = patient();
    waiting.step_timeout_s = 0.05;
    LatestReader reader(session.name(), "viewer", {.waiting = waiting});
    publish_next(publisher);
    REQUIRE(publisher.begin_frame());  // the only slot is being written and stays so
    CHECK_FALSE(reader.poll());
    const Caught caught = catch_error([&] { (void)reader.next(); });
    CHECK(caught.failure == Failure::step_timeout);
    CHECK(contains(caught.text, "copies were overtaken"));
}

TEST_CASE("no frame is torn while a producer runs freely, whatever the number of slots and with or without a hash") {
    for (const std::uint32_t slots : {1U, 2U, 3U})
        for (const bool hashed : {true, false}) read_freely(slots, hashed, 20'000);
}

TEST_CASE("no frame is torn while a producer runs freely for long", "[.long]") {
    for (const std::uint32_t slots : {1U, 2U, 3U})
        for (const bool hashed : {true, false}) read_freely(slots, hashed, 1'000'000);
}

TEST_CASE("two threads over one mapping: the free-running reader sees whole frames only") {
    constexpr std::uint64_t frames = 3000;
    const Session session;
    Publisher publisher(session.name(), test_info(1, 2), patient());
    LatestReader reader = LatestReader::in_process(publisher, "thread", joining());
    bool sound = true;
    std::uint64_t last = 0;
    std::thread reading([&] {
        while (const auto frame = reader.next()) {
            sound = sound && is_as_filled(*frame);
            last = frame->frame;
        }
    });
    for (std::uint64_t f = 1; f <= frames; ++f) publish_next(publisher, f == frames);
    publisher.close();
    reading.join();
    CHECK(sound);
    CHECK(last == frames);
}

TEST_CASE("a free-running reader beside a lockstep consumer changes nothing for that one") {
    const Session session;
    Publisher publisher(session.name(), test_info(), patient());
    LatestReader reader(session.name(), "viewer", joining());
    Child crowd([&] { return consume(session.name(), 300); });
    publisher.wait_for_consumers(1);
    for (std::uint64_t f = 1; f <= 300; ++f) {
        publish_next(publisher, f == 300);
        const auto newest = f % 7 == 0 ? reader.poll() : std::nullopt;
        if (newest) CHECK(newest->hash == publisher.frame_hash());
    }
    publisher.close();
    CHECK(crowd.wait() == 0);
}

TEST_CASE("a free-running reader is not one of the consumers that a producer waits for") {
    const Session session;
    Waiting waiting = patient();
    waiting.attach_timeout_s = 0.05;
    Publisher publisher(session.name(), test_info(), waiting);
    const LatestReader reader(session.name(), "viewer", joining());
    CHECK(catch_error([&] { publisher.wait_for_consumers(1); }).failure == Failure::attach_timeout);
}

TEST_CASE(
    "free-running readers may leave, die or be given a bad frame without harm, and their entries are used again") {
    const Session session;
    Publisher publisher(session.name(), test_info(), patient());
    for (std::uint32_t i = 0; i < 3 * max_consumers; ++i) {
        Child viewer([&] {
            LatestReader reader(session.name(), "viewer", joining());
            (void)reader.poll();
            if (i % 2 == 0) raise(SIGKILL);
            return 0;
        });
        CHECK(viewer.wait() == (i % 2 == 0 ? 128 + SIGKILL : 0));
        publish_next(publisher);
    }
    LatestReader reader(session.name(), "viewer", joining());
    publish_next(publisher);
    Bytes(session.path()).descriptor(publisher.published_frames()).hash ^= 1;
    CHECK(catch_error([&] { (void)reader.poll(); }).failure == Failure::protocol_violation);
    CHECK_NOTHROW(publish(publisher, 5));
}

TEST_CASE("a newest frame that lies is refused by a free-running reader") {
    const auto refusal = [](auto&& change, bool sealed = true) {
        ReaderPair pair;
        const auto fields = pair.publisher.begin_frame();
        fill(*fields, test_count(1));
        pair.publisher.end_frame(test_count(1));
        Bytes bytes(pair.session.path());
        change(bytes.descriptor(1), *fields);
        if (sealed) bytes.reseal(1);
        const Caught caught = catch_error([&] { (void)pair.reader.poll(); });
        CHECK(caught.failure == Failure::protocol_violation);
        CHECK_NOTHROW(publish(pair.publisher, 3));
        return caught.text;
    };
    using Descriptor = SlotDescriptor;
    using Fields = FrameFields;
    CHECK(contains(refusal([](Descriptor& d, const Fields&) { d.count = 0xFFFFFFFF; }), "the capacity is"));
    CHECK(contains(refusal([](Descriptor& d, const Fields&) { d.frame = 9; }), "descriptor of frame 9"));
    CHECK(contains(refusal([](Descriptor& d, const Fields&) { d.hash += 1; }), "hash"));
    CHECK(contains(refusal([](Descriptor& d, const Fields&) { d.tick += 1; }, false), "damaged descriptor"));
    CHECK(contains(refusal([](Descriptor&, const Fields& f) { f.px[2] += 1; }), "hash"));
    CHECK(contains(refusal([](Descriptor& d, const Fields& f) { d.hash = 0, f.vy[17] = std::nanf(""); }),
                   "particle 17, field vy"));
}
