// Streams of agents, and the time of a stream's first frame.

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "segment_bytes.hpp"
#include "shm_protocol/inside/bytes/hash.hpp"
#include "shm_protocol/inside/header.hpp"
#include "support.hpp"

using namespace wade::shm;
using namespace wade::shm::test;

namespace {

constexpr std::uint32_t agents = 60;

StreamInfo agents_info() {
    StreamInfo info = test_info();
    info.kind = stream_agents;
    info.ticks_per_frame = 4;
    return info;
}

JoinOptions to_agents() {
    return {.waiting = patient(), .kind = stream_agents};
}

std::array<std::span<float>, 10> all_fields(const FrameFields& f) {
    return {f.mass, f.vx, f.vy, f.vz, f.px, f.py, f.pz, f.radius, f.height, f.state};
}

std::array<std::span<const float>, 10> all_fields(const Frame& f) {
    return {f.mass, f.vx, f.vy, f.vz, f.px, f.py, f.pz, f.radius, f.height, f.state};
}

void fill_agents(const FrameFields& fields) {
    int i = 0;
    for (const auto& field : all_fields(fields)) {
        for (std::uint32_t k = 0; k < agents; ++k) field[k] = test_value(fields.frame, i, k);
        ++i;
    }
}

void fill_impulses(const FrameFields& fields) {
    int i = 20;
    for (const auto& field : {fields.jx, fields.jz, fields.submerged, fields.spread}) {
        for (std::uint32_t k = 0; k < agents; ++k) field[k] = test_value(fields.frame, i, k);
        ++i;
    }
}

// Publishes one frame, lets `change` spoil it, and returns what the subscriber says.
template <typename Change>
Caught receive_spoiled(Change&& change, bool hashed, bool impulses = false) {
    const Session session;
    StreamInfo info = agents_info();
    info.hash_frames = hashed;
    info.impulses = impulses;
    Publisher publisher(session.name(), info, patient());
    Subscriber subscriber(session.name(), "fluid", to_agents());
    publisher.wait_for_consumers(1);
    const auto fields = publisher.begin_frame();
    fill_agents(*fields);
    if (impulses) fill_impulses(*fields);
    publisher.end_frame(agents);
    change(*fields);
    return catch_error([&] { subscriber.acquire(); });
}

}  // namespace

TEST_CASE("agents arrive with radius, height and state, hashed over all ten fields in their order") {
    const Session session;
    Publisher publisher(session.name(), agents_info(), patient());
    Subscriber subscriber(session.name(), "fluid", to_agents());
    publisher.wait_for_consumers(1);
    CHECK(subscriber.info().kind == stream_agents);
    std::uint64_t chain = 0;
    for (std::uint64_t f = 1; f <= 3; ++f) {
        const auto slot = publisher.begin_frame();
        REQUIRE(slot);
        CHECK(slot->state.size() == test_capacity);
        fill_agents(*slot);
        publisher.end_frame(agents);
        const auto frame = subscriber.acquire();
        REQUIRE(frame);
        const auto fields = all_fields(*frame);
        for (int i = 0; i < 10; ++i) {
            const auto& field = fields[static_cast<std::size_t>(i)];
            REQUIRE(field.size() == agents);
            bool same = true;
            for (std::uint32_t k = 0; k < agents; ++k) same = same && field[k] == test_value(f, i, k);
            CHECK(same);
        }
        chain = chain_hash(chain, f, fields);
        CHECK(frame->hash == chain);
        subscriber.release();
    }
    CHECK(publisher.frame_hash() == chain);
    subscriber.leave();
}

TEST_CASE("a fluid stream has no radius, height and state") {
    const Session session;
    Publisher publisher(session.name(), test_info(), patient());
    Subscriber subscriber(session.name(), "crowd", {.waiting = patient()});
    const auto slot = publisher.begin_frame();
    REQUIRE(slot);
    CHECK((slot->radius.empty() && slot->height.empty() && slot->state.empty()));
    fill(*slot, 5);
    publisher.end_frame(5);
    const auto frame = subscriber.acquire();
    REQUIRE(frame);
    CHECK((frame->radius.empty() && frame->height.empty() && frame->state.empty()));
    subscriber.leave();
}

TEST_CASE("impulses arrive as they were given, and the chain is that of a stream without them") {
    StreamInfo info = agents_info();
    std::uint64_t hashes[2] = {};
    for (const bool impulses : {false, true}) {
        const Session session;
        info.impulses = impulses;
        Publisher publisher(session.name(), info, patient());
        Subscriber subscriber(session.name(), "fluid", to_agents());
        publisher.wait_for_consumers(1);
        CHECK(subscriber.info().impulses == impulses);
        const auto slot = publisher.begin_frame();
        REQUIRE(slot);
        fill_agents(*slot);
        CHECK(slot->jx.size() == (impulses ? test_capacity : 0));
        if (impulses) fill_impulses(*slot);
        publisher.end_frame(agents);
        const auto frame = subscriber.acquire();
        REQUIRE(frame);
        hashes[impulses ? 1 : 0] = frame->hash;
        int i = 20;
        for (const auto& field : {frame->jx, frame->jz, frame->submerged, frame->spread}) {
            REQUIRE(field.size() == (impulses ? agents : 0));
            for (std::uint32_t k = 0; k < field.size(); ++k) REQUIRE(field[k] == test_value(1, i, k));
            ++i;
        }
        subscriber.leave();
    }
    CHECK(hashes[0] == hashes[1]);
}

TEST_CASE("a spoiled or non-finite impulse is noticed; a stream of water has none") {
    const Caught changed = receive_spoiled([](const FrameFields& f) { f.jz[3] += 1; }, true, true);
    CHECK(changed.failure == Failure::protocol_violation);
    CHECK(contains(changed.text, "impulses were changed"));
    const Caught nan = receive_spoiled([](const FrameFields& f) { f.spread[7] = std::nanf(""); }, false, true);
    CHECK(contains(nan.text, "particle 7, field spread"));
    StreamInfo water = test_info();
    water.impulses = true;
    CHECK_THROWS_AS(make_header(water, 1), std::invalid_argument);
}

TEST_CASE("a stream of an older version, or with some of the impulses only, has none for this reader") {
    StreamInfo info = agents_info();
    info.impulses = true;
    Header some = make_header(info, 1);
    CHECK(read_header(some, some.total_bytes).fields.size() == 14);
    some.field_count = 13;
    some.crc32c = header_crc(some);
    const SegmentMap map = read_header(some, some.total_bytes);
    CHECK_FALSE(map.info.impulses);
    CHECK(map.fields.size() == 10);
    Header old = make_header(agents_info(), 1);
    old.version_minor = 2;
    old.crc32c = header_crc(old);
    CHECK_FALSE(read_header(old, old.total_bytes).has_further_hash);
}

TEST_CASE("an agents frame holds the state before its interval, so the first one is at tick 0") {
    const Session session;
    Publisher publisher(session.name(), agents_info(), patient());
    Subscriber subscriber(session.name(), "fluid", to_agents());
    publisher.wait_for_consumers(1);
    for (const std::uint64_t tick : {0U, 4U, 8U}) {
        REQUIRE(publisher.begin_frame());
        publisher.end_frame(0);
        const auto frame = subscriber.acquire();
        REQUIRE(frame);
        CHECK(frame->tick == tick);
        subscriber.release();
    }
    subscriber.leave();
}

TEST_CASE("the first frame of any stream may have tick 0, the second may not") {
    const Session session;
    Publisher publisher(session.name(), test_info(), patient());
    Subscriber subscriber(session.name(), "crowd", {.waiting = patient()});
    publisher.wait_for_consumers(1);
    REQUIRE(publisher.begin_frame());
    publisher.end_frame(0, {}, false, 0);
    const auto frame = subscriber.acquire();
    REQUIRE(frame);
    CHECK(frame->tick == 0);
    subscriber.release();
    REQUIRE(publisher.begin_frame());
    CHECK_THROWS_AS(publisher.end_frame(0, {}, false, 0), std::invalid_argument);
    publisher.end_frame(0, {}, false, 1);
    subscriber.leave();
}

TEST_CASE("a spoiled state or a NaN in a height is noticed as in any other field") {
    const Caught changed = receive_spoiled([](const FrameFields& f) { f.state[3] += 1; }, true);
    CHECK(changed.failure == Failure::protocol_violation);
    CHECK(contains(changed.text, "hash"));
    const Caught nan = receive_spoiled([](const FrameFields& f) { f.height[7] = std::nanf(""); }, false);
    CHECK(nan.failure == Failure::protocol_violation);
    CHECK(contains(nan.text, "particle 7, field height"));
}

TEST_CASE("the water and the agents of one session do not get in each other's way") {
    const Session session;
    Publisher water(session.name(), test_info(), patient());
    Publisher people(session.name(), agents_info(), patient());
    Subscriber crowd(session.name(), "crowd", {.waiting = patient()});
    Subscriber fluid(session.name(), "fluid", to_agents());
    CHECK(crowd.info().kind == stream_fluid);
    CHECK(fluid.info().kind == stream_agents);
    CHECK(crowd.info().session_id != fluid.info().session_id);
}

TEST_CASE("a stream under the name of another kind is refused") {
    const Session session;
    const Publisher water(session.name(), test_info(), patient());
    Bytes bytes(session.path());
    Header& header = bytes.as<Header>(0);
    // As an agents stream the header is sound: ten fields, which happen to overlap in none.
    header.stream_kind = stream_agents;
    const std::array<const char*, 3> further{"radius", "height", "state"};
    header.capacity = 16;
    for (std::uint32_t i = 0; i < 10; ++i) {
        header.fields[i].type = field_float32;
        header.fields[i].offset = 64 * i;
    }
    for (std::uint32_t i = 0; i < 3; ++i) std::strcpy(header.fields[7 + i].name, further[i]);
    header.field_count = 10;
    header.crc32c = header_crc(header);
    const Caught caught = catch_error([&] { Subscriber(session.name(), "crowd", {.waiting = hasty()}).leave(); });
    CHECK(caught.failure == Failure::protocol_violation);
    CHECK(contains(caught.text, "holds a stream of kind 2, its name stands for 1"));
}

TEST_CASE("an agents stream without a state is refused, a fluid stream with further fields is not") {
    Header short_of_one = make_header(agents_info(), 1);
    short_of_one.field_count = 9;
    short_of_one.crc32c = header_crc(short_of_one);
    const Caught caught = catch_error([&] { (void)read_header(short_of_one, short_of_one.total_bytes); });
    CHECK(contains(caught.text, "no field 'state'"));

    Header rich = make_header(test_info(), 1);
    rich.fields[7].offset = rich.slot_stride;
    rich.fields[7].type = field_float32;
    std::strcpy(rich.fields[7].name, "pressure");
    rich.field_count = 8;
    rich.slot_stride += page_bytes;
    rich.total_bytes += rich.slot_count * page_bytes;
    rich.crc32c = header_crc(rich);
    CHECK(read_header(rich, rich.total_bytes).fields.size() == 7);
}
