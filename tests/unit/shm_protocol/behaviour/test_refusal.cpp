// What is refused, and why: names, versions, scenes, damaged segments and frames.

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>

#include "segment_bytes.hpp"
#include "shm_protocol/inside/header.hpp"
#include "shm_protocol/inside/liveness.hpp"
#include "shm_protocol/inside/segment.hpp"
#include "support.hpp"

using namespace wade::shm;
using namespace wade::shm::test;

namespace {

Caught try_to_join(const Session& session, std::uint64_t scene = 0) {
    return catch_error([&] { Subscriber(session.name(), "crowd", {.scene_hash = scene, .waiting = hasty()}).leave(); });
}

// Publishes frame 1, lets `change` spoil it, and returns what the subscriber says.
template <typename Change>
Caught receive_spoiled_frame(Change&& change, bool hashed = true) {
    const Session session;
    StreamInfo info = test_info();
    info.hash_frames = hashed;
    Publisher publisher(session.name(), info, patient());
    Subscriber subscriber(session.name(), "crowd", {.waiting = patient()});
    publisher.wait_for_consumers(1);
    const auto fields = publisher.begin_frame();
    fill(*fields, test_count(1));
    publisher.end_frame(test_count(1));
    Bytes bytes(session.path());
    change(bytes, *fields);
    Caught caught = catch_error([&] { subscriber.acquire(); });
    if (caught.failure) {
        const Caught told = catch_error([&] { publisher.begin_frame(); });
        CHECK(told.failure == Failure::peer_aborted);
        CHECK(contains(told.text, caught.text));
    } else {
        subscriber.leave();
    }
    return caught;
}

void check_refused(const Caught& caught, const std::string& part) {
    CAPTURE(caught.text);
    CHECK(caught.failure == Failure::protocol_violation);
    CHECK(contains(caught.text, part));
}

}  // namespace

TEST_CASE("a name whose producer is alive is refused, and that producer is not disturbed") {
    const Session session;
    Child producer([&] { return produce(session.name(), 50, 1); });
    Subscriber subscriber(session.name(), "reader", {.waiting = patient()});
    REQUIRE(subscriber.acquire());
    const Caught caught = catch_error([&] { Publisher(session.name(), test_info(), patient()); });
    CHECK(caught.failure == Failure::name_in_use);
    CHECK(contains(caught.text, "process " + std::to_string(producer.pid())));
    subscriber.release();
    while (subscriber.acquire()) subscriber.release();
    CHECK(producer.wait() == 0);
}

TEST_CASE("a producer of another version is refused at once, with both versions") {
    const Session session;
    const Publisher publisher(session.name(), test_info(), patient());
    Bytes bytes(session.path());
    bytes.as<Header>(0).version_major = 9;
    check_refused(try_to_join(session), "version 9.4, this program version 1.4");
}

TEST_CASE("another scene is refused at once on both sides, with both hashes") {
    const Session session;
    Publisher publisher(session.name(), test_info(), patient());
    const Caught consumer = try_to_join(session, 0x1111222233334444);
    check_refused(consumer, "different scenes");
    CHECK(contains(consumer.text, "1111222233334444"));
    CHECK(contains(consumer.text, "abcdef0123456789"));
    const Caught producer = catch_error([&] { publisher.wait_for_consumers(1); });
    CHECK(producer.failure == Failure::peer_aborted);
    CHECK(contains(producer.text, "different scenes"));
}

TEST_CASE("a consumer that refuses tells the producer at once, and why") {
    const Session session;
    Publisher publisher(session.name(), test_info(), patient());
    Subscriber::refuse(session.name(), "crowd", {.scene_hash = test_scene, .waiting = hasty()}, 1,
                       "There is no room left for /runs/s05.");
    const Caught caught = catch_error([&] { publisher.wait_for_consumers(1); });
    CHECK(caught.failure == Failure::peer_aborted);
    CHECK(contains(caught.text, "Consumer 'crowd'"));
    CHECK(contains(caught.text, "refused the stream: There is no room left for /runs/s05."));
}

TEST_CASE("a consumer refuses a producer that comes later, and gives up where none comes") {
    const Session session;
    const Caught alone =
        catch_error([&] { Subscriber::refuse(session.name(), "crowd", {.waiting = hasty()}, 1, "no"); });
    CHECK(alone.failure == Failure::attach_timeout);
    Child consumer([&] {
        Subscriber::refuse(session.name(), "crowd", {.waiting = patient()}, 1, "no");
        return 0;
    });
    Publisher publisher(session.name(), test_info(), patient());
    CHECK(catch_error([&] { publisher.wait_for_consumers(1); }).failure == Failure::peer_aborted);
    CHECK(consumer.wait() == 0);
}

TEST_CASE("who will not or may not come does not disturb a stream that runs") {
    const Session session;
    Publisher publisher(session.name(), test_info(), patient());
    Subscriber subscriber(session.name(), "crowd", {.scene_hash = test_scene, .waiting = patient()});
    publisher.wait_for_consumers(1);
    REQUIRE(publisher.begin_frame());
    publisher.end_frame(0);
    check_refused(try_to_join(session, 42), "different scenes");
    Subscriber::refuse(session.name(), "crowd", {.scene_hash = test_scene, .waiting = hasty()}, 2, "a full disk");
    REQUIRE(subscriber.acquire());
    subscriber.release();
    CHECK(publisher.begin_frame());
    subscriber.leave();
}

TEST_CASE("an unknown scene on either side is accepted") {
    const Session session;
    StreamInfo info = test_info();
    info.scene_hash = 0;
    const Publisher publisher(session.name(), info, patient());
    CHECK_FALSE(try_to_join(session, 42).failure);
    CHECK_FALSE(try_to_join(session, 0).failure);
}

TEST_CASE("each byte of the header page, flipped in a living segment, leads to a refusal and never to a crash") {
    const Session session;
    const Publisher publisher(session.name(), test_info(), patient());
    Bytes bytes(session.path());
    for (std::size_t at = 0; at < page_bytes; ++at) {
        bytes[at] ^= 0xFF;
        const Caught caught = try_to_join(session);
        bytes[at] ^= 0xFF;
        CAPTURE(at, caught.text);
        REQUIRE(caught.failure == Failure::protocol_violation);
    }
    CHECK_FALSE(try_to_join(session).failure);
}

TEST_CASE("a segment that is cut off, empty or unfinished is refused or waited for") {
    const Session session;
    const int fd = open(session.path().c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    REQUIRE(fd >= 0);
    REQUIRE(lock_byte(fd, producer_lock_byte));
    const auto outcome = [&] { return try_to_join(session); };
    CHECK(contains(outcome().text, "has not sized its segment yet"));
    REQUIRE(ftruncate(fd, 100) == 0);
    check_refused(outcome(), "cut off");
    REQUIRE(ftruncate(fd, 4096) == 0);
    CHECK(contains(outcome().text, "has not finished its header yet"));
    const Header header = make_header(test_info(), 1);
    REQUIRE(pwrite(fd, &header, sizeof header, 0) == static_cast<ssize_t>(sizeof header));
    check_refused(outcome(), "total_bytes");
    close(fd);
    CHECK(contains(outcome().text, "left by a producer that is dead"));
}

TEST_CASE("more consumers than entries have to wait for one") {
    const Session session;
    Publisher publisher(session.name(), test_info(), patient());
    std::vector<Subscriber> all;
    for (std::uint32_t i = 0; i < max_consumers; ++i)
        all.emplace_back(session.name(), "crowd", JoinOptions{.waiting = patient()});
    const Caught caught = try_to_join(session);
    CHECK(caught.failure == Failure::attach_timeout);
    CHECK(contains(caught.text, "all consumer entries"));
    all.back().leave();
    publish_next(publisher);
    CHECK_FALSE(try_to_join(session).failure);
}

TEST_CASE("a frame with a NaN or an infinity is refused by particle and field, hashed or not") {
    const Session session;
    for (const bool hashed : {true, false}) {
        StreamInfo info = test_info();
        info.hash_frames = hashed;
        Publisher publisher(session.name(), info, patient());
        Subscriber subscriber(session.name(), "crowd", {.waiting = patient()});
        publisher.wait_for_consumers(1);
        const auto fields = publisher.begin_frame();
        fill(*fields, 30);
        fields->vy[17] = hashed ? std::numeric_limits<float>::quiet_NaN() : std::numeric_limits<float>::infinity();
        fields->px[3] = std::numeric_limits<float>::quiet_NaN();
        publisher.end_frame(30);
        const Caught caught = catch_error([&] { subscriber.acquire(); });
        CHECK(caught.failure == Failure::protocol_violation);
        CHECK(caught.text == "Frame 1 from 'tester' holds non-finite values (first: particle 17, field vy).");
    }
}

TEST_CASE("a non-finite value beyond the count is nobody's business") {
    const Caught caught = receive_spoiled_frame(
        [](Bytes&, const FrameFields& fields) { fields.px[test_count(1)] = std::numeric_limits<float>::quiet_NaN(); });
    CHECK_FALSE(caught.failure);
}

TEST_CASE("a frame that was changed after its publication does not match its hash") {
    check_refused(receive_spoiled_frame([](Bytes&, const FrameFields& fields) { fields.vz[5] += 1; }), "hash");
    CHECK_FALSE(receive_spoiled_frame([](Bytes&, const FrameFields& fields) { fields.vz[5] += 1; }, false).failure);
}

TEST_CASE("a descriptor that lies is refused") {
    const auto lie = [](auto change) {
        return receive_spoiled_frame([change](Bytes& b, const FrameFields&) {
            change(b.descriptor(1));
            b.reseal(1);
        });
    };
    check_refused(lie([](SlotDescriptor& d) { d.count = test_capacity + 1; }), "the capacity is");
    check_refused(lie([](SlotDescriptor& d) { d.count = 0xFFFFFFFF; }), "the capacity is");
    check_refused(lie([](SlotDescriptor& d) { d.frame = 2; }), "not complete");
    check_refused(lie([](SlotDescriptor& d) { d.sequence = 1; }), "not complete");
    check_refused(lie([](SlotDescriptor& d) { d.count -= 1; }), "hash");
    check_refused(lie([](SlotDescriptor& d) { d.tick = std::uint64_t{1} << 54; }), "the first one may be 2^53 at most");
}

TEST_CASE("each bit of a descriptor, changed after its publication, leads to a refusal") {
    const Session session;
    Publisher publisher(session.name(), test_info(), patient());
    publish_next(publisher);
    Bytes bytes(session.path());
    const StreamInfo& info = publisher.info();
    const SlotDescriptor sound = bytes.descriptor(1);
    FrameHistory history;
    history.check_descriptor = true;
    CHECK_NOTHROW(check_descriptor(info, 1, sound, history));
    for (std::size_t bit = 8 * offsetof(SlotDescriptor, frame); bit < 8 * sizeof sound; ++bit) {
        unsigned char changed[sizeof sound];
        std::memcpy(changed, &sound, sizeof sound);
        changed[bit / 8] = static_cast<unsigned char>(changed[bit / 8] ^ (1U << bit % 8));
        SlotDescriptor descriptor;
        std::memcpy(&descriptor, changed, sizeof changed);
        CAPTURE(bit);
        REQUIRE(catch_error([&] { check_descriptor(info, 1, descriptor, history); }).failure ==
                Failure::protocol_violation);
    }
    check_refused(
        receive_spoiled_frame([](Bytes& b, const FrameFields&) { b.descriptor(1).tick |= std::uint64_t{1} << 40; }),
        "damaged descriptor");
}

TEST_CASE("a producer of version 1.1, whose descriptors have no check, is accepted") {
    for (const std::uint32_t minor : {0U, 1U, 2U}) {
        const Session session;
        Publisher publisher(session.name(), test_info(), patient());
        Bytes bytes(session.path());
        bytes.as<Header>(0).version_minor = minor;
        bytes.as<Header>(0).crc32c = header_crc(bytes.as<Header>(0));
        Subscriber subscriber(session.name(), "crowd", {.waiting = patient()});
        publisher.wait_for_consumers(1);
        publish_next(publisher);
        bytes.descriptor(1).crc32c = 0;
        const Caught caught = catch_error([&] { (void)subscriber.acquire(); });
        CAPTURE(minor, caught.text);
        CHECK(caught.failure.has_value() == (minor == 2));
        if (!caught.failure) subscriber.release();
        if (!caught.failure) subscriber.leave();
    }
}

TEST_CASE("a frame with a mass that is not above 0 is refused by particle") {
    for (const float mass : {0.0F, -0.0F, -100.0F}) {
        const Session session;
        Publisher publisher(session.name(), test_info(), patient());
        Subscriber subscriber(session.name(), "crowd", {.waiting = patient()});
        publisher.wait_for_consumers(1);
        const auto fields = publisher.begin_frame();
        fill(*fields, 30);
        fields->mass[11] = mass;
        publisher.end_frame(30);
        check_refused(catch_error([&] { subscriber.acquire(); }), "without mass (first: particle 11 of ");
    }
}

TEST_CASE("a frame whose time does not go on is refused") {
    const Session session;
    Publisher publisher(session.name(), test_info(), patient());
    Subscriber subscriber(session.name(), "crowd", {.waiting = patient()});
    publisher.wait_for_consumers(1);
    REQUIRE(publisher.begin_frame());
    publisher.end_frame(0, {}, false, 5);
    REQUIRE(subscriber.acquire());
    subscriber.release();
    REQUIRE(publisher.begin_frame());
    publisher.end_frame(0, {}, false, 6);
    Bytes bytes(session.path());
    bytes.descriptor(2).tick = 5;
    bytes.reseal(2);
    check_refused(catch_error([&] { subscriber.acquire(); }), "has tick 5, frame 1 before it has 5");
}

TEST_CASE("a producer that runs away from its consumer is refused") {
    const Session session;
    Publisher publisher(session.name(), test_info(), patient());
    Subscriber subscriber(session.name(), "crowd", {.waiting = patient()});
    publisher.wait_for_consumers(1);
    publish_next(publisher);
    Bytes(session.path()).control().published_frame = 5;
    check_refused(catch_error([&] { (void)subscriber.acquire(); }), "before frame 1 was released");
}

TEST_CASE("a producer that overwrites a frame in use is refused") {
    const Session session;
    Publisher publisher(session.name(), test_info(), patient());
    Subscriber subscriber(session.name(), "crowd", {.waiting = patient()});
    publisher.wait_for_consumers(1);
    REQUIRE(publisher.begin_frame());
    publisher.end_frame(0);
    REQUIRE(subscriber.acquire());
    Bytes bytes(session.path());
    bytes.descriptor(1).sequence = 5;
    check_refused(catch_error([&] { subscriber.release(); }), "overwrote frame 1");
}

TEST_CASE("a consumer that acknowledges what was never published is refused") {
    const Session session;
    Publisher publisher(session.name(), test_info(), patient());
    Subscriber subscriber(session.name(), "crowd", {.waiting = patient()});
    publisher.wait_for_consumers(1);
    Bytes bytes(session.path());
    bytes.as<ConsumerEntry>(consumers_offset).acknowledged_frame = 3;
    check_refused(catch_error([&] { publisher.begin_frame(); }), "acknowledged frame 3");
}

TEST_CASE("more shared memory than there is leads to an error, not to a crash, and leaves nothing behind") {
    const Session session;
    StreamInfo info = test_info();
    info.capacity = 0xFFFFFFFF;
    info.slots = 64;  // 7.7 TB
    try {
        const Publisher publisher(session.name(), info, patient());
        FAIL("this machine has more shared memory than the test expects");
    } catch (const std::system_error& error) {
        CHECK(contains(error.what(), "bytes of shared memory"));
    }
    CHECK(access(session.path().c_str(), F_OK) != 0);
}

TEST_CASE("a consumer's name has to fit") {
    const Session session;
    CHECK_THROWS_AS(Subscriber(session.name(), "", {.waiting = hasty()}), std::invalid_argument);
    CHECK_THROWS_AS(Subscriber(session.name(), std::string(64, 'x'), {.waiting = hasty()}), std::invalid_argument);
}

TEST_CASE("a consumer that checks no values takes the producer's word for the hash") {
    const Session session;
    Publisher publisher(session.name(), test_info(), patient());
    JoinOptions trusting{.waiting = patient()};
    trusting.check_values = false;
    Subscriber subscriber(session.name(), "viewer", trusting);
    publisher.wait_for_consumers(1);
    publish_next(publisher);
    Bytes bytes(session.path());
    bytes.descriptor(1).hash ^= 1;  // a checking consumer refuses this frame
    bytes.reseal(1);
    const auto frame = subscriber.acquire();
    REQUIRE(frame);
    CHECK(frame->hash == (publisher.frame_hash() ^ 1));
    subscriber.release();
}
