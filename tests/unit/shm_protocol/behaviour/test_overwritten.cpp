// A foreign write to words of a segment while the stream runs: an error on both sides, never an early end.

#include <catch2/catch.hpp>

#include "segment_bytes.hpp"
#include "support.hpp"

using namespace wade::shm;
using namespace wade::shm::test;

namespace {

// A stream after its first frame was taken and released.
struct Stream {
    explicit Stream(bool follows = false)
        : publisher(session.name(), test_info(), hurried()),
          subscriber(session.name(), "crowd", {.waiting = hurried(), .follows = follows}),
          bytes(session.path()) {
        if (follows) leader.emplace(session.name(), "leader", JoinOptions{.waiting = hurried()});
        publisher.wait_for_consumers(follows ? 2 : 1);
        publish_next(publisher);
        for (Subscriber* const s : {&subscriber, leader ? &*leader : nullptr}) {
            if (s == nullptr) continue;
            REQUIRE(s->acquire());
            s->release();
        }
    }

    // A wait that leads to no verdict of its own ends as a time-out, which no test here expects.
    static Waiting hurried() {
        Waiting waiting = patient();
        waiting.step_timeout_s = 20;
        return waiting;
    }

    Session session;
    Publisher publisher;
    Subscriber subscriber;
    std::optional<Subscriber> leader;
    Bytes bytes;
};

void check(const Caught& caught, Failure failure, const std::string& part) {
    CAPTURE(caught.text);
    CHECK(caught.failure == failure);
    CHECK(contains(caught.text, part));
}

}  // namespace

TEST_CASE("a producer refuses a consumer whose mode or flags changed") {
    Stream mode;
    mode.bytes.consumer(0).mode = mode_latest;
    check(catch_error([&] { mode.publisher.begin_frame(); }), Failure::protocol_violation, "its page says mode = 1");
    Stream flags;
    flags.bytes.consumer(0).flags = consumer_follows;
    check(catch_error([&] { flags.publisher.begin_frame(); }), Failure::protocol_violation, "its page says flags = 1");
    Stream leads(true);
    leads.bytes.consumer(0).flags = 0;
    check(catch_error([&] { leads.publisher.begin_frame(); }), Failure::protocol_violation, "its page says flags = 0");
}

TEST_CASE("a producer refuses a consumer whose state cannot follow on the one before") {
    for (const std::uint32_t state : {0U, 4U, 5U, 0xFFFFFFFFU}) {
        Stream stream;
        stream.bytes.consumer(0).state = state;
        check(catch_error([&] { stream.publisher.begin_frame(); }), Failure::protocol_violation,
              "its page says state = " + std::to_string(state));
    }
}

TEST_CASE("a goodbye that the consumer did not say ends no stream: the consumer finds it and gives up") {
    Stream stream;
    stream.bytes.consumer(0).state = consumer_left;

    publish_next(stream.publisher);  // the lock is held, so this was no goodbye
    check(catch_error([&] { stream.subscriber.acquire(); }), Failure::protocol_violation, "state is 2, it was 1");
    check(catch_error([&] { stream.publisher.begin_frame(); }), Failure::peer_aborted, "Another process has written");
}

TEST_CASE("a consumer refuses to go on with a page that it did not write") {
    struct Case {
        const char* word;
        void (*overwrite)(ConsumerEntry&);
    };
    for (const Case& c : {Case{"mode is 1", [](ConsumerEntry& e) { e.mode = mode_latest; }},
                          Case{"flags is 9", [](ConsumerEntry& e) { e.flags = 9; }},
                          Case{"state is 0", [](ConsumerEntry& e) { e.state = consumer_free; }},
                          Case{"state is 7", [](ConsumerEntry& e) { e.state = 7; }},
                          Case{"acknowledged_frame is 0", [](ConsumerEntry& e) { e.acknowledged_frame = 0; }}}) {
        Stream stream;
        c.overwrite(stream.bytes.consumer(0));
        check(catch_error([&] { stream.subscriber.acquire(); }), Failure::protocol_violation, c.word);
    }
}

TEST_CASE("a producer refuses to go on with a control page that it did not write") {
    for (const std::uint32_t state : {0U, 1U, 3U, 4U, 5U}) {
        Stream stream;
        stream.bytes.control().state = state;
        check(catch_error([&] { stream.publisher.begin_frame(); }), Failure::protocol_violation, "control page");
    }
    Stream stream;
    stream.bytes.control().published_frame = 0;
    check(catch_error([&] { stream.publisher.begin_frame(); }), Failure::protocol_violation, "published_frame 0");
}

TEST_CASE("what a free-running reader writes ends no stream") {
    Stream stream;
    Subscriber viewer(stream.session.name(), "viewer", {.waiting = patient()});
    stream.bytes.consumer(1).mode = mode_latest;  // as a reader would have joined
    publish_next(stream.publisher);
    stream.bytes.consumer(1).mode = mode_lockstep;
    stream.bytes.consumer(1).flags = 77;
    REQUIRE(stream.subscriber.acquire());
    stream.subscriber.release();
    publish_next(stream.publisher);
    REQUIRE(stream.subscriber.acquire());
    stream.subscriber.release();
    stream.subscriber.leave();
    CHECK_FALSE(stream.publisher.begin_frame());
}
