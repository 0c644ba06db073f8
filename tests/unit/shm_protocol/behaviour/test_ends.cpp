// Ends of a stream while both processes live: the final frame, a consumer that leaves, an abort, a time-out.

#include <unistd.h>

#include <catch2/catch.hpp>
#include <csignal>
#include <limits>
#include <stdexcept>
#include <thread>
#include <vector>

#include "segment_bytes.hpp"
#include "shm_protocol/latest_reader.hpp"
#include "support.hpp"

using namespace wade::shm;
using namespace wade::shm::test;

namespace {

// A pair in one process, one frame ahead at most, so that a single thread can play both parts.
struct Pair {
    Pair()
        : publisher(session.name(), test_info(), patient()),
          subscriber(session.name(), "crowd", {.waiting = patient()}) {
        publisher.wait_for_consumers(1);
    }
    void publish(bool final = false) {
        const auto fields = publisher.begin_frame();
        REQUIRE(fields);
        fill(*fields, test_count(fields->frame));
        publisher.end_frame(test_count(fields->frame), {}, final);
    }
    void receive() {
        REQUIRE(subscriber.acquire());
        subscriber.release();
    }
    Session session;
    Publisher publisher;
    Subscriber subscriber;
};

}  // namespace

TEST_CASE("after the end nothing is left in /dev/shm") {
    Pair pair;
    pair.publish(true);
    pair.receive();
    pair.publisher.close();
    CHECK(access(pair.session.path().c_str(), F_OK) != 0);
    CHECK_FALSE(pair.subscriber.acquire());
}

TEST_CASE("a stream closed without a final frame ends after its last one") {
    Pair pair;
    pair.publish();
    pair.receive();
    pair.publisher.close();
    CHECK_FALSE(pair.subscriber.acquire());
}

TEST_CASE("a stream may end without any frame") {
    Pair pair;
    pair.publisher.close();
    CHECK_FALSE(pair.subscriber.acquire());
}

TEST_CASE("closing waits until the final frame was acknowledged") {
    Pair pair;
    pair.publish(true);
    REQUIRE(pair.subscriber.acquire());
    std::thread closing([&] { pair.publisher.close(); });
    CHECK(access(pair.session.path().c_str(), F_OK) == 0);  // cannot be gone: the frame is held
    pair.subscriber.release();
    closing.join();
    CHECK(access(pair.session.path().c_str(), F_OK) != 0);
}

TEST_CASE("when the consumer has left, the producer is told by an empty frame and closes well") {
    Pair pair;
    pair.publish();
    pair.receive();
    pair.subscriber.leave();
    CHECK_FALSE(pair.publisher.begin_frame());
    CHECK_NOTHROW(pair.publisher.close());
}

TEST_CASE("a consumer that leaves while it holds a frame frees the producer") {
    Pair pair;
    pair.publish();
    REQUIRE(pair.subscriber.acquire());
    pair.subscriber.leave();
    CHECK_FALSE(pair.publisher.begin_frame());
}

TEST_CASE("a consumer's reason for giving up reaches the producer") {
    Pair pair;
    pair.publish();
    REQUIRE(pair.subscriber.acquire());
    pair.subscriber.abort(9, "the disk is full");
    const Caught caught = catch_error([&] { pair.publisher.begin_frame(); });
    CHECK(caught.failure == Failure::peer_aborted);
    CHECK(contains(caught.text, "Consumer 'crowd'"));
    CHECK(contains(caught.text, "gave up at frame 1: the disk is full"));
}

TEST_CASE("a consumer that is destroyed before the end counts as having given up") {
    const Session session;
    Publisher publisher(session.name(), test_info(), patient());
    {
        const Subscriber subscriber(session.name(), "crowd", {.waiting = patient()});
        publisher.wait_for_consumers(1);
    }
    const Caught caught = catch_error([&] { publisher.begin_frame(); });
    CHECK(caught.failure == Failure::peer_aborted);
}

TEST_CASE("a producer's reason for giving up reaches the consumer after the complete frames") {
    Pair pair;
    pair.publish();
    pair.publisher.abort(9, "the solver diverged");
    CHECK(access(pair.session.path().c_str(), F_OK) != 0);
    pair.receive();
    const Caught caught = catch_error([&] { pair.subscriber.acquire(); });
    CHECK(caught.failure == Failure::peer_aborted);
    CHECK(contains(caught.text, "Producer 'tester'"));
    CHECK(contains(caught.text, "gave up at frame 2: the solver diverged"));
}

TEST_CASE("a producer that is destroyed before the end counts as having given up") {
    const Session session;
    std::vector<Subscriber> subscriber;
    {
        const Publisher publisher(session.name(), test_info(), patient());
        subscriber.emplace_back(session.name(), "crowd", JoinOptions{.waiting = patient()});
    }
    const Caught caught = catch_error([&] { subscriber.front().acquire(); });
    CHECK(caught.failure == Failure::peer_aborted);
    CHECK(contains(caught.text, "without closing"));
    CHECK(access(session.path().c_str(), F_OK) != 0);
}

TEST_CASE("the reason of one consumer reaches the others by way of the producer") {
    const Session session;
    Subscriber* other = nullptr;
    std::vector<Subscriber> keep;
    {
        Publisher publisher(session.name(), test_info(), patient());
        keep.emplace_back(session.name(), "bystander", JoinOptions{.waiting = patient()});
        other = &keep.back();
        Subscriber failing(session.name(), "failing", {.waiting = patient()});
        publisher.wait_for_consumers(2);
        failing.abort(9, "out of ink");
        CHECK(catch_error([&] { publisher.begin_frame(); }).failure == Failure::peer_aborted);
    }
    const Caught caught = catch_error([&] { other->acquire(); });
    CHECK(caught.failure == Failure::peer_aborted);
    CHECK(contains(caught.text, "out of ink"));
}

TEST_CASE("an overlong reason is cut, not refused") {
    Pair pair;
    pair.publisher.abort(9, std::string(5000, 'x'));
    const Caught caught = catch_error([&] { pair.subscriber.acquire(); });
    CHECK(contains(caught.text, std::string(reason_bytes - 1, 'x')));
    CHECK_FALSE(contains(caught.text, std::string(reason_bytes, 'x')));
}

TEST_CASE("waiting can be interrupted on both sides, and the peer learns of it") {
    const Session session;
    Waiting impatient = patient();
    impatient.interrupted = [] { return true; };
    Publisher publisher(session.name(), test_info(), impatient);
    CHECK(catch_error([&] { publisher.wait_for_consumers(1); }).failure == Failure::interrupted);
    Subscriber subscriber(session.name(), "crowd", {.waiting = impatient});
    CHECK(catch_error([&] { subscriber.acquire(); }).failure == Failure::interrupted);
    const Caught caught = catch_error([&] { publisher.wait_for_consumers(1); });
    CHECK(caught.failure == Failure::peer_aborted);
    CHECK(contains(caught.text, "Interrupted"));
}

TEST_CASE("a living but silent peer leads to one warning and then to the step time-out") {
    const Session session;
    std::vector<std::string> warnings;
    Waiting waiting = patient();
    waiting.step_warning_s = 0.05;
    waiting.step_timeout_s = 0.2;
    waiting.warn = [&](const std::string& text) { warnings.push_back(text); };
    Publisher publisher(session.name(), test_info(), waiting);
    Subscriber subscriber(session.name(), "crowd", {.waiting = waiting});
    publisher.wait_for_consumers(1);
    REQUIRE(publisher.begin_frame());
    publisher.end_frame(0);
    const Caught behind = catch_error([&] { publisher.begin_frame(); });
    CHECK(behind.failure == Failure::step_timeout);
    CHECK(contains(behind.text, "consumer 'crowd'"));
    CHECK(contains(behind.text, "to release frame 1"));
    CHECK(warnings.size() == 1);
    REQUIRE(subscriber.acquire());
    subscriber.release();
    const Caught silent = catch_error([&] { subscriber.acquire(); });
    CHECK(silent.failure == Failure::step_timeout);
    CHECK(contains(silent.text, "frame 2 of producer 'tester'"));
    CHECK(warnings.size() == 2);
}

TEST_CASE("no consumer and no producer lead to the attach time-out") {
    const Session session;
    Waiting waiting;
    waiting.attach_timeout_s = 0.05;
    const Caught alone = catch_error([&] { Subscriber(session.name(), "crowd", {.waiting = waiting}); });
    CHECK(alone.failure == Failure::attach_timeout);
    CHECK(contains(alone.text, "there is no shared-memory segment /" + session.name() + "-fluid"));
    Publisher publisher(session.name(), test_info(), waiting);
    const Caught lonely = catch_error([&] { publisher.wait_for_consumers(1); });
    CHECK(lonely.failure == Failure::attach_timeout);
    CHECK(contains(lonely.text, session.name()));
}

TEST_CASE("a consumer that comes too late to take part is told so") {
    const Session session;
    Publisher publisher(session.name(), test_info(), patient());
    Subscriber early(session.name(), "early", {.waiting = patient()});
    publisher.wait_for_consumers(1);
    REQUIRE(publisher.begin_frame());
    publisher.end_frame(0);
    Subscriber late(session.name(), "late", {.waiting = patient()});
    early.leave();
    publisher.close();
    CHECK(catch_error([&] { late.acquire(); }).failure == Failure::attach_timeout);
}

TEST_CASE("calls in the wrong order are errors of the program") {
    Pair pair;
    CHECK_THROWS_AS(pair.publisher.end_frame(0), std::logic_error);
    CHECK_THROWS_AS(pair.subscriber.release(), std::logic_error);
    REQUIRE(pair.publisher.begin_frame());
    CHECK_THROWS_AS(pair.publisher.begin_frame(), std::logic_error);
    CHECK_THROWS_AS(pair.publisher.end_frame(test_capacity + 1), std::invalid_argument);
    pair.publisher.end_frame(0);
    CHECK_THROWS_AS(pair.publisher.wait_for_consumers(1), std::logic_error);
    REQUIRE(pair.subscriber.acquire());
    CHECK_THROWS_AS(pair.subscriber.acquire(), std::logic_error);
    pair.subscriber.release();
    REQUIRE(pair.publisher.begin_frame());
    CHECK_THROWS_AS(pair.publisher.end_frame(0, {}, false, 1), std::invalid_argument);  // frame 1 had tick 1
    pair.publisher.abort(0, "done");
    CHECK_THROWS_AS(pair.publisher.begin_frame(), std::logic_error);
}

TEST_CASE("an entry that was left rests until the next frame is published") {
    const Session session;
    Publisher publisher(session.name(), test_info(), patient());
    Bytes bytes(session.path());
    const auto name_of = [&](std::size_t i) {
        return std::string(bytes.as<ConsumerEntry>(consumers_offset + i * page_bytes).name);
    };
    Subscriber(session.name(), "first", {.waiting = patient()}).leave();
    Subscriber(session.name(), "second", {.waiting = patient()}).leave();
    CHECK(name_of(0) == "first");
    CHECK(name_of(1) == "second");  // the producer may not have seen the first one join yet
    publish_next(publisher);
    const Subscriber third(session.name(), "third", {.waiting = patient()});
    CHECK(name_of(0) == "third");
}

TEST_CASE("a time-out that is negative or no number is refused") {
    const Session session;
    for (const double wrong : {-1.0, std::numeric_limits<double>::quiet_NaN()}) {
        Waiting waiting = patient();
        waiting.attach_timeout_s = wrong;
        CHECK_THROWS_AS(Publisher(session.name(), test_info(), waiting), std::invalid_argument);
        CHECK_THROWS_AS(Subscriber(session.name(), "crowd", {.waiting = waiting}), std::invalid_argument);
    }
}

TEST_CASE("a failure is final and comes again, so that nobody takes it for the end of the stream") {
    Pair pair;
    pair.publisher.abort(9, "the water boils");
    for (int i = 0; i < 3; ++i)
        CHECK(catch_error([&] { (void)pair.subscriber.acquire(); }).failure == Failure::peer_aborted);
}

TEST_CASE("no frame follows the final one") {
    const Session session;
    Publisher publisher(session.name(), test_info(), patient());
    REQUIRE(publisher.begin_frame());
    publisher.end_frame(0, {}, true);
    CHECK_THROWS_AS(publisher.begin_frame(), std::logic_error);
}

TEST_CASE("a free-running reader of another scene does not end a stream that waits for its crowd") {
    const Session session;
    StreamInfo info = test_info();
    info.scene_hash = 1;
    Publisher publisher(session.name(), info, patient());
    CHECK_THROWS_AS(LatestReader(session.name(), "viewer", {.scene_hash = 2, .waiting = patient()}), Error);
    const Subscriber crowd(session.name(), "crowd", {.scene_hash = 1, .waiting = patient()});
    CHECK_NOTHROW(publisher.wait_for_consumers(1));
}
