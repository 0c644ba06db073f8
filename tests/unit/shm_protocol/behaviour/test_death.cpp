// One side is killed without warning: the other one always notices, says so, and never uses a torn frame.

#include <unistd.h>

#include <catch2/catch.hpp>
#include <csignal>
#include <random>

#include "support.hpp"

using namespace wade::shm;
using namespace wade::shm::test;

namespace {

constexpr int kills = 12;  // of each side; each costs a process and up to one slice of waiting
constexpr std::uint64_t all_frames = 40;

struct Moment {
    Stage stage;
    std::uint64_t frame;
    std::uint32_t depth;
};

Moment random_moment(std::mt19937& random) {
    const auto pick = [&](unsigned n) { return static_cast<std::uint32_t>(random() % n); };
    return {static_cast<Stage>(pick(3)), 1 + pick(all_frames - 1), 1 + pick(3)};
}

AtStage kill_at(const Moment& moment) {
    return [moment](Stage stage, std::uint64_t frame) {
        if (stage == moment.stage && frame == moment.frame) raise(SIGKILL);
    };
}

}  // namespace

TEST_CASE("a killed producer is noticed by the consumer, which has seen whole frames only") {
    std::mt19937 random(20240601);
    for (int k = 0; k < kills; ++k) {
        const Moment moment = random_moment(random);
        CAPTURE(static_cast<int>(moment.stage), moment.frame, moment.depth);
        const Session session;
        Child producer([&] { return produce(session.name(), all_frames, moment.depth, kill_at(moment)); });
        Subscriber subscriber(session.name(), "reader", {.scene_hash = test_scene, .waiting = patient()});
        std::uint64_t seen = 0;
        bool whole = true;
        const Caught caught = catch_error([&] {
            while (const auto frame = subscriber.acquire()) {
                whole = whole && frame->frame == ++seen && is_as_filled(*frame);
                subscriber.release();
            }
        });
        CHECK(producer.wait() == 128 + SIGKILL);
        CHECK(whole);
        // Frames that were complete when it died are still delivered.
        CHECK(seen == (moment.stage == Stage::after ? moment.frame : moment.frame - 1));
        CHECK(caught.failure == Failure::peer_dead);
        CHECK(contains(caught.text, "died at frame " + std::to_string(seen + 1)));
    }
}

TEST_CASE("a killed consumer is noticed by the producer, with the frame at which it died") {
    std::mt19937 random(20240602);
    for (int k = 0; k < kills; ++k) {
        const Moment moment = random_moment(random);
        CAPTURE(static_cast<int>(moment.stage), moment.frame, moment.depth);
        const Session session;
        Child consumer([&] { return consume(session.name(), all_frames, kill_at(moment)); });
        const Caught caught = catch_error([&] { (void)produce(session.name(), all_frames, moment.depth); });
        CHECK(consumer.wait() == 128 + SIGKILL);
        CHECK(caught.failure == Failure::peer_dead);
        const std::uint64_t at = moment.stage == Stage::after ? moment.frame + 1 : moment.frame;
        CHECK(contains(caught.text, "Consumer 'reader'"));
        CHECK(contains(caught.text, "died at frame " + std::to_string(at)));
        CHECK(access(session.path().c_str(), F_OK) != 0);  // the survivor has cleaned up
    }
}

TEST_CASE("a consumer killed while the producer drains is noticed too") {
    const Session session;
    Child consumer([&] { return consume(session.name(), all_frames, kill_at({Stage::writing, all_frames, 1})); });
    const Caught caught = catch_error([&] { (void)produce(session.name(), all_frames, 3); });
    CHECK(consumer.wait() == 128 + SIGKILL);
    CHECK(caught.failure == Failure::peer_dead);
}

TEST_CASE("a consumer killed after its last acknowledgement does no harm") {
    const Session session;
    Child consumer([&] { return consume(session.name(), all_frames, kill_at({Stage::after, all_frames, 1})); });
    CHECK(produce(session.name(), all_frames, 1) == 0);
    CHECK(consumer.wait() == 128 + SIGKILL);
}

TEST_CASE("a peer that is killed while stopped is dead, not slow") {
    const Session session;
    Child producer([&] {
        return produce(session.name(), all_frames, 1, [](Stage stage, std::uint64_t f) {
            if (stage == Stage::before && f == 5) raise(SIGSTOP);
        });
    });
    Subscriber subscriber(session.name(), "reader", {.waiting = patient()});
    const Caught caught = catch_error([&] {
        while (const auto frame = subscriber.acquire()) {
            const bool last = frame->frame == 4;
            subscriber.release();
            if (last) producer.kill(SIGKILL);
        }
    });
    CHECK(caught.failure == Failure::peer_dead);
    CHECK(contains(caught.text, "died at frame 5"));
}

TEST_CASE("a segment left by a killed producer is taken over, by consumers of the new one too") {
    const Session session;
    Child killed([&] {
        const Publisher publisher(session.name(), test_info(), patient());
        raise(SIGKILL);
        return 0;
    });
    CHECK(killed.wait() == 128 + SIGKILL);
    REQUIRE(access(session.path().c_str(), F_OK) == 0);

    const Caught stale = catch_error([&] { Subscriber(session.name(), "crowd", {.waiting = hasty()}); });
    CHECK(stale.failure == Failure::attach_timeout);
    CHECK(contains(stale.text, "left by a producer that is dead"));

    Child consumer([&] { return consume(session.name(), all_frames); });
    CHECK(produce(session.name(), all_frames, 1) == 0);
    CHECK(consumer.wait() == 0);
}

TEST_CASE("of many producers that want one stale name at once exactly one gets it") {
    const Session session;
    Child killed([&] {
        const Publisher publisher(session.name(), test_info(), patient());
        raise(SIGKILL);
        return 0;
    });
    killed.wait();
    int ready[2];
    int go[2];
    REQUIRE(pipe(ready) == 0);
    REQUIRE(pipe(go) == 0);
    const auto contend = [&] {
        close(go[1]);
        char c = 0;
        int code = 0;
        std::optional<Publisher> publisher;
        try {
            publisher.emplace(session.name(), test_info(), patient());
        } catch (const Error& error) {
            code = error.exit_code();
        }
        if (write(ready[1], "x", 1) != 1) return 98;
        if (read(go[0], &c, 1) != 0) return 98;  // end of file once all have tried
        return code;
    };
    Child a(contend);
    Child b(contend);
    Child c(contend);
    char token = 0;
    for (int i = 0; i < 3; ++i) REQUIRE(read(ready[0], &token, 1) == 1);
    close(go[1]);
    int winners = 0;
    int losers = 0;
    for (Child* child : {&a, &b, &c}) {
        const int code = child->wait();
        winners += code == 0 ? 1 : 0;
        losers += code == static_cast<int>(Failure::name_in_use) ? 1 : 0;
    }
    for (const int fd : {ready[0], ready[1], go[0]}) close(fd);
    CHECK(winners == 1);
    CHECK(losers == 2);
}
