// Consumers that follow: waited for like any other, but the stream does not go on for them alone.

#include <catch2/catch.hpp>
#include <csignal>
#include <thread>

#include "segment_bytes.hpp"
#include "support.hpp"

using namespace wade::shm;
using namespace wade::shm::test;

namespace {

JoinOptions following() {
    return {.waiting = patient(), .follows = true};
}

}  // namespace

TEST_CASE("a follower says so in its entry, and nobody else does") {
    const Session session;
    const Publisher publisher(session.name(), test_info(), patient());
    const Subscriber recorder(session.name(), "recorder", following());
    const Subscriber crowd(session.name(), "crowd", {.waiting = patient()});
    Bytes bytes(session.path());
    CHECK(bytes.as<ConsumerEntry>(consumers_offset).flags == consumer_follows);
    CHECK(bytes.as<ConsumerEntry>(consumers_offset + page_bytes).flags == 0);
}

TEST_CASE("a stream ends when only followers remain, and they get all of it") {
    const Session session;
    Publisher publisher(session.name(), test_info(2), patient());
    Subscriber recorder(session.name(), "recorder", following());
    Subscriber crowd(session.name(), "crowd", {.waiting = patient()});
    publisher.wait_for_consumers(2);
    publish_next(publisher);
    publish_next(publisher);
    REQUIRE(crowd.acquire());
    crowd.release();
    crowd.leave();
    CHECK_FALSE(publisher.begin_frame());  // although the recorder owes frame 1
    std::thread closing([&] { publisher.close(); });
    std::uint64_t seen = 0;
    while (const auto frame = recorder.acquire()) {
        CHECK(frame->frame == ++seen);
        CHECK(is_as_filled(*frame));
        recorder.release();
    }
    closing.join();
    CHECK(seen == 2);
}

TEST_CASE("a follower counts among the consumers that a producer waits for, but a stream does not start for it alone") {
    const Session session;
    Waiting waiting = patient();
    waiting.attach_timeout_s = 0.05;
    Publisher publisher(session.name(), test_info(), waiting);
    const Subscriber recorder(session.name(), "recorder", following());
    const Caught alone = catch_error([&] { publisher.wait_for_consumers(1); });
    CHECK(alone.failure == Failure::attach_timeout);
    CHECK_THAT(alone.text, Catch::Matchers::Contains("followers only"));
    const Subscriber crowd(session.name(), "crowd", {.waiting = patient()});
    CHECK_FALSE(catch_error([&] { publisher.wait_for_consumers(2); }).failure);
    CHECK(catch_error([&] { publisher.wait_for_consumers(3); }).failure == Failure::attach_timeout);
}

TEST_CASE("the producer waits for a follower as for any other consumer") {
    const Session session;
    Waiting waiting = patient();
    waiting.step_timeout_s = 0.05;
    Publisher publisher(session.name(), test_info(), waiting);
    Subscriber recorder(session.name(), "recorder", following());
    Subscriber crowd(session.name(), "crowd", {.waiting = patient()});
    publisher.wait_for_consumers(2);
    publish_next(publisher);
    REQUIRE(crowd.acquire());
    crowd.release();
    const Caught caught = catch_error([&] { publisher.begin_frame(); });
    CHECK(caught.failure == Failure::step_timeout);
    CHECK(contains(caught.text, "consumer 'recorder'"));
}

TEST_CASE("a stream that never had another consumer goes on for a follower") {
    const Session session;
    Publisher publisher(session.name(), test_info(), patient());
    Subscriber recorder(session.name(), "recorder", following());
    for (int i = 0; i < 3; ++i) {
        publish_next(publisher);
        REQUIRE(recorder.acquire());
        recorder.release();
    }
    recorder.leave();
    CHECK(publisher.begin_frame());
}

TEST_CASE("a follower that dies is a dead peer") {
    const Session session;
    Publisher publisher(session.name(), test_info(), patient());
    Subscriber crowd(session.name(), "crowd", {.waiting = patient()});
    Child recorder([&] {
        Subscriber subscriber(session.name(), "recorder", following());
        (void)subscriber.acquire();
        raise(SIGKILL);
        return 0;
    });
    publisher.wait_for_consumers(2);
    publish_next(publisher);
    REQUIRE(crowd.acquire());
    crowd.release();
    const Caught caught = catch_error([&] { publisher.begin_frame(); });
    CHECK(caught.failure == Failure::peer_dead);
    CHECK(contains(caught.text, "'recorder'"));
    CHECK(recorder.wait() == 128 + SIGKILL);
}
