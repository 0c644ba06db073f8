#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>

#include "shm_protocol/inside/header.hpp"
#include "support.hpp"

using namespace wade::shm;
using namespace wade::shm::test;

namespace {

// A header with one lie in it and a CRC that covers the lie up.
template <typename Lie>
Caught read_with(Lie&& lie) {
    Header h = make_header(test_info(2), 77);
    const std::uint64_t size = h.total_bytes;
    lie(h);
    h.crc32c = header_crc(h);
    return catch_error([&] { (void)read_header(h, size); });
}

void check_header_refused(const Caught& caught, const std::string& part) {
    CAPTURE(caught.text);
    CHECK(caught.failure == Failure::protocol_violation);
    CHECK(contains(caught.text, part));
}

template <typename Change>
std::string argument_error(Change&& change) {
    StreamInfo info = test_info();
    change(info);
    try {
        (void)make_header(info, 1);
    } catch (const std::invalid_argument& error) {
        return error.what();
    }
    return "";
}

}  // namespace

TEST_CASE("what a producer says about its stream arrives unchanged") {
    StreamInfo info = test_info(2, 5);
    info.ticks_per_second = 60;
    info.ticks_per_frame = 2;
    info.metres_per_unit = 10;
    info.origin = {1, -2, 3};
    info.axes = {1, 2, -3};
    info.coupling_lag = 1;
    const Header header = make_header(info, 77);
    const SegmentMap map = read_header(header, header.total_bytes);
    CHECK(map.info.producer_name == "tester");
    CHECK(map.info.capacity == test_capacity);
    CHECK(map.info.depth == 2);
    CHECK(map.info.slots == 5);
    CHECK(map.info.ticks_per_second == 60);
    CHECK(map.info.ticks_per_frame == 2);
    CHECK(map.info.metres_per_unit == 10);
    CHECK(map.info.origin == info.origin);
    CHECK(map.info.axes == info.axes);
    CHECK(map.info.scene_hash == test_scene);
    CHECK(map.info.particle_radius == 0.25);
    CHECK(map.info.rest_density == 1000);
    CHECK(map.info.coupling_lag == 1);
    CHECK(map.info.session_id == 77);
    CHECK_FALSE(map.info.in_world_coordinates());
    CHECK(test_info().in_world_coordinates());
}

TEST_CASE("fields are aligned to cache lines, slots to pages, and a million particles fit as well as one") {
    for (const std::uint32_t capacity : {1U, 15U, 16U, 17U, 1000U, 1'000'000U}) {
        StreamInfo info = test_info();
        info.capacity = capacity;
        const Header header = make_header(info, 1);
        const SegmentMap map = read_header(header, header.total_bytes);
        CAPTURE(capacity);
        CHECK(map.slots % page_bytes == 0);
        CHECK(map.slot_stride % page_bytes == 0);
        for (std::size_t i = 0; i < map.fields.size(); ++i) {
            CHECK(map.fields[i] % line_bytes == 0);
            const std::uint64_t end = i + 1 < map.fields.size() ? map.fields[i + 1] : map.slot_stride;
            CHECK(end - map.fields[i] >= capacity * sizeof(float));
        }
        CHECK(map.total_bytes == map.slots + 2 * map.slot_stride);
    }
}

TEST_CASE("without a wish the stream gets one slot more than its depth") {
    CHECK(make_header(test_info(1), 1).slot_count == 2);
    CHECK(make_header(test_info(3), 1).slot_count == 4);
    CHECK(make_header(test_info(64), 1).slot_count == 64);
}

TEST_CASE("a producer's argument out of range is refused by name, value and range") {
    CHECK(contains(argument_error([](auto& i) { i.capacity = 0; }), "StreamInfo::capacity = 0"));
    CHECK(contains(argument_error([](auto& i) { i.depth = 0; }), "StreamInfo::depth = 0"));
    CHECK(contains(argument_error([](auto& i) { i.depth = 3, i.slots = 2; }), "1 to slots"));
    CHECK(contains(argument_error([](auto& i) { i.slots = 65; }), "StreamInfo::slots = 65"));
    CHECK(contains(argument_error([](auto& i) { i.depth = 65; }), "StreamInfo::depth = 65"));
    CHECK(contains(argument_error([](auto& i) { i.producer_name = ""; }), "producer_name"));
    CHECK(contains(argument_error([](auto& i) { i.producer_name = std::string(64, 'x'); }), "1 to 63 bytes"));
    CHECK(contains(argument_error([](auto& i) { i.ticks_per_second = 0; }), "ticks_per_second"));
    CHECK(contains(argument_error([](auto& i) { i.ticks_per_frame = 0; }), "ticks_per_frame"));
    CHECK(contains(argument_error([](auto& i) { i.metres_per_unit = -1; }), "metres_per_unit = -1"));
    CHECK(contains(argument_error([](auto& i) { i.origin[1] = INFINITY; }), "origin = inf"));
    CHECK(contains(argument_error([](auto& i) { i.axes = {1, 1, 3}; }), "axes = 1,1,3"));
    CHECK(contains(argument_error([](auto& i) { i.axes = {0, 2, 3}; }), "axes"));
    CHECK(contains(argument_error([](auto& i) { i.particle_radius = -0.1; }), "particle_radius"));
    CHECK(contains(argument_error([](auto& i) { i.rest_density = NAN; }), "rest_density"));
    CHECK(contains(argument_error([](auto& i) { i.coupling_lag = 2; }), "coupling_lag"));
    CHECK(argument_error([](auto&) {}).empty());
}

TEST_CASE("session names of other characters are refused, as is an empty or an endless one") {
    CHECK(segment_name("a.B_c-9", stream_fluid) == "/a.B_c-9-fluid");
    CHECK(segment_name("x", stream_agents) == "/x-agents");
    CHECK_THROWS_AS(segment_name("", stream_fluid), std::invalid_argument);
    CHECK_THROWS_AS(segment_name("a/b", stream_fluid), std::invalid_argument);
    CHECK_THROWS_AS(segment_name("a b", stream_fluid), std::invalid_argument);
    CHECK_THROWS_AS(segment_name(std::string("a\0b", 3), stream_fluid), std::invalid_argument);
    CHECK_THROWS_AS(segment_name(std::string(201, 'a'), stream_fluid), std::invalid_argument);
}

TEST_CASE("any single changed bit of the header page is noticed") {
    Header header = make_header(test_info(), 77);
    unsigned char bytes[sizeof header];
    for (std::size_t at = 0; at < sizeof header; ++at)
        for (const int bit : {0, 3, 7}) {
            std::memcpy(bytes, &header, sizeof header);
            bytes[at] = static_cast<unsigned char>(bytes[at] ^ (1U << bit));
            Header changed;
            std::memcpy(&changed, bytes, sizeof header);
            const Caught caught = catch_error([&] { (void)read_header(changed, header.total_bytes); });
            CAPTURE(at, bit);
            REQUIRE(caught.failure == Failure::protocol_violation);
        }
}

TEST_CASE("a header with a valid checksum is still not believed") {
    check_header_refused(read_with([](Header& h) { h.magic ^= 1; }), "magic");
    check_header_refused(read_with([](Header& h) { h.version_major = 2; }), "version 2.4, this program version 1.4");
    check_header_refused(read_with([](Header& h) { h.endian_tag = 0x04030201; }), "byte order");
    check_header_refused(read_with([](Header& h) { h.header_bytes = 8192; }), "header_bytes");
    check_header_refused(read_with([](Header& h) { h.required_features = 4; }), "features");
    check_header_refused(read_with([](Header& h) { h.total_bytes += 4096; }), "total_bytes");
    check_header_refused(read_with([](Header& h) { h.capacity = 0; }), "capacity = 0");
    check_header_refused(read_with([](Header& h) { h.capacity = std::uint64_t{1} << 63; }),
                         "capacity = 9223372036854775808");
    check_header_refused(read_with([](Header& h) { h.capacity = 0xFFFFFFFF; }), "overlaps");
    check_header_refused(read_with([](Header& h) { h.slot_count = 0; }), "slot_count = 0");
    check_header_refused(read_with([](Header& h) { h.slot_count = 65; }), "slot_count = 65");
    check_header_refused(read_with([](Header& h) { h.slot_count = 64; }), "overlaps");
    check_header_refused(read_with([](Header& h) { h.depth = 0; }), "depth = 0");
    check_header_refused(read_with([](Header& h) { h.depth = 4; }), "depth = 4");
    check_header_refused(read_with([](Header& h) { h.slot_stride = ~std::uint64_t{0} - 4095; }),
                         "which no file can hold");
    check_header_refused(read_with([](Header& h) { h.slot_stride = 4097; }), "slot_stride");
    check_header_refused(read_with([](Header& h) { h.slots_offset = 0; }), "overlaps");
    check_header_refused(read_with([](Header& h) { h.slots_offset = ~std::uint64_t{0} - 4095; }), "outside");
    check_header_refused(read_with([](Header& h) { h.slots_offset += 1; }), "offset");
    check_header_refused(read_with([](Header& h) { h.control_offset = h.doorbell_offset; }), "overlaps");
    check_header_refused(read_with([](Header& h) { h.consumer_count = 17; }), "consumer_count = 17");
    check_header_refused(read_with([](Header& h) { h.consumer_stride = 64; }), "consumer_stride");
    check_header_refused(read_with([](Header& h) { h.descriptor_stride = 0; }), "descriptor_stride");
    check_header_refused(read_with([](Header& h) { h.field_count = 0; }), "field_count = 0");
    check_header_refused(read_with([](Header& h) { h.field_count = 17; }), "field_count = 17");
    check_header_refused(read_with([](Header& h) { h.field_count = 6; }), "no field 'pz'");
    check_header_refused(read_with([](Header& h) { h.fields[1].offset = h.fields[2].offset; }), "'vx'");
    check_header_refused(read_with([](Header& h) { h.fields[6].offset = h.slot_stride - 64; }), "'pz'");
    check_header_refused(read_with([](Header& h) { h.fields[3].offset = 1; }), "a multiple of 64");
    check_header_refused(read_with([](Header& h) { h.fields[3].type = 9; }), "float32");
    check_header_refused(read_with([](Header& h) { std::memset(h.fields[0].name, 'x', 16); }), "has no end");
    check_header_refused(read_with([](Header& h) { std::memset(h.producer_name, 'x', name_bytes); }), "has no end");
    check_header_refused(read_with([](Header& h) { h.ticks_per_second = 0; }), "ticks_per_second");
    check_header_refused(read_with([](Header& h) { h.metres_per_unit = std::nan(""); }), "metres_per_unit");
    check_header_refused(read_with([](Header& h) { h.stream_kind = 3; }), "stream_kind");
    CHECK_FALSE(read_with([](Header&) {}).failure);
}

TEST_CASE("a header of a later minor version is accepted") {
    const Caught caught = read_with([](Header& h) {
        h.version_minor = 7;
        h.reserved1[100] = 5;
    });
    CHECK_FALSE(caught.failure);
}
