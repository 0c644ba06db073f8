// A side that pauses on purpose does not run into the other side's step time-out, but its death is still noticed.
// Waits are counted by the polls of Waiting::interrupted, one for each slice.

#include <catch2/catch.hpp>
#include <csignal>
#include <vector>

#include "segment_bytes.hpp"
#include "support.hpp"

using namespace wade::shm;
using namespace wade::shm::test;

namespace {

constexpr int many_slices = 6;

// A step time-out of one slice, and a stop after many: which of the two ends a wait tells whether time was counted.
struct ShortPatience {
    Waiting waiting() {
        Waiting w = patient();
        w.step_warning_s = 0.01;
        w.step_timeout_s = 0.05;
        w.interrupted = [this] { return ++polls >= many_slices; };
        w.warn = [this](const std::string&) { ++warnings; };
        return w;
    }
    int polls = 0;
    int warnings = 0;
};

}  // namespace

TEST_CASE("a consumer does not count the time while its producer pauses on purpose") {
    const Session session;
    Publisher publisher(session.name(), test_info(), patient());
    for (const bool paused : {true, false}) {
        CAPTURE(paused);
        ShortPatience patience;
        Subscriber subscriber(session.name(), "crowd", {.waiting = patience.waiting()});
        patience.polls = 0;
        publisher.set_paused(paused);
        const Caught caught = catch_error([&] { subscriber.acquire(); });
        CHECK(caught.failure == (paused ? Failure::interrupted : Failure::step_timeout));
        CHECK((patience.polls == many_slices) == paused);
        CHECK(patience.warnings == (paused ? 0 : 1));
    }
}

TEST_CASE("a producer does not count the time while a consumer that it waits for pauses on purpose") {
    for (const bool paused : {true, false}) {
        CAPTURE(paused);
        const Session session;
        ShortPatience patience;
        Publisher publisher(session.name(), test_info(), patience.waiting());
        Subscriber subscriber(session.name(), "crowd", {.waiting = patient()});
        publisher.wait_for_consumers(1);
        publish_next(publisher);
        subscriber.set_paused(paused);
        patience.polls = 0;
        const Caught caught = catch_error([&] { publisher.begin_frame(); });
        CHECK(caught.failure == (paused ? Failure::interrupted : Failure::step_timeout));
        CHECK((patience.polls == many_slices) == paused);
        CHECK(patience.warnings == (paused ? 0 : 1));
    }
}

TEST_CASE("a consumer that pauses while the producer drains is waited for") {
    const Session session;
    ShortPatience patience;
    Publisher publisher(session.name(), test_info(), patience.waiting());
    Subscriber subscriber(session.name(), "crowd", {.waiting = patient()});
    publisher.wait_for_consumers(1);
    publish_next(publisher, true);
    subscriber.set_paused(true);
    CHECK(catch_error([&] { publisher.close(); }).failure == Failure::interrupted);
}

TEST_CASE("a consumer that pauses but owes nothing does not excuse one that is late") {
    const Session session;
    ShortPatience patience;
    Publisher publisher(session.name(), test_info(), patience.waiting());
    Subscriber paused(session.name(), "paused", {.waiting = patient()});
    Subscriber late(session.name(), "late", {.waiting = patient()});
    publisher.wait_for_consumers(2);
    publish_next(publisher);
    REQUIRE(paused.acquire());
    paused.release();
    paused.set_paused(true);
    CHECK(catch_error([&] { publisher.begin_frame(); }).failure == Failure::step_timeout);
}

TEST_CASE("a producer that dies while it pauses is dead, not paused") {
    const Session session;
    Child producer([&] {
        Publisher publisher(session.name(), test_info(), patient());
        publisher.wait_for_consumers(1);
        publisher.set_paused(true);
        raise(SIGKILL);
        return 0;
    });
    Subscriber subscriber(session.name(), "crowd", {.waiting = patient()});
    CHECK(catch_error([&] { subscriber.acquire(); }).failure == Failure::peer_dead);
}

TEST_CASE("a consumer that dies while it pauses is dead, not paused") {
    const Session session;
    Child consumer([&] {
        Subscriber subscriber(session.name(), "crowd", {.waiting = patient()});
        (void)subscriber.acquire();
        subscriber.set_paused(true);
        raise(SIGKILL);
        return 0;
    });
    Publisher publisher(session.name(), test_info(), patient());
    publisher.wait_for_consumers(1);
    publish_next(publisher);
    CHECK(catch_error([&] { publisher.begin_frame(); }).failure == Failure::peer_dead);
}

TEST_CASE("an entry's next owner does not inherit the pause or the following of the one before") {
    const Session session;
    Publisher publisher(session.name(), test_info(), patient());
    Bytes bytes(session.path());
    const auto& entry = bytes.as<ConsumerEntry>(consumers_offset);
    {
        Subscriber first(session.name(), "first", {.waiting = patient(), .follows = true});
        first.set_paused(true);
        CHECK(entry.paused == 1);
        first.leave();
    }
    publish_next(publisher);
    const Subscriber second(session.name(), "second", {.waiting = patient()});
    CHECK(std::string(entry.name) == "second");
    CHECK(entry.paused == 0);
    CHECK(entry.flags == 0);
}
