#include <catch2/catch.hpp>
#include <iterator>

#include "shm_protocol/inside/frame_check.hpp"
#include "support.hpp"

using namespace wade::shm;
using namespace wade::shm::test;

namespace {

StreamInfo info_of(StreamKind kind, std::uint64_t ticks_per_frame) {
    StreamInfo info = test_info();
    info.kind = kind;
    info.ticks_per_frame = ticks_per_frame;
    return info;
}

// Returns the fault of frame f + `frames` with a tick `ticks` above that of frame f.
std::string fault(std::uint64_t ticks_per_frame, std::uint64_t ticks, std::uint64_t frames = 1, bool final = false,
                  StreamKind kind = stream_fluid) {
    return tick_fault(info_of(kind, ticks_per_frame), {7 + frames, 1000 + ticks}, final, FrameTick{7, 1000});
}

}  // namespace

TEST_CASE("a frame lasts from a thousandth of a frame time to eight of them") {
    CHECK(fault(100'000, 100'000).empty());
    CHECK(fault(100'000, 100).empty());
    CHECK(fault(100'000, 800'000).empty());
    CHECK(contains(fault(100'000, 99), "has tick 1099, frame 7 before it has 1000; at 100000 ticks a frame"));
    CHECK(contains(fault(100'000, 800'001), "lasts at most 8 times as long"));
    CHECK(fault(1, 1).empty());
    CHECK(contains(fault(1, 33), "at most 8 times"));  // milliseconds at 30 frames a second
    CHECK(contains(fault(1, std::uint64_t{1} << 40), "at most 8 times"));
    CHECK(contains(fault(1'000'000, 1), "at least 1/1000"));  // frames instead of microseconds
    CHECK(contains(fault(1, 0), "frame 7 before it has 1000"));
}

TEST_CASE("frames that were missed had their time, too") {
    CHECK(fault(10, 800, 10).empty());
    CHECK_FALSE(fault(10, 801, 10).empty());
    CHECK(fault(~std::uint64_t{0}, ~std::uint64_t{0} - 2000, 1).empty());
}

TEST_CASE("the final frame may be cut short") {
    CHECK(fault(100'000, 1, 1, true).empty());
    CHECK_FALSE(fault(100'000, 800'001, 1, true).empty());
}

TEST_CASE("agents have the ticks of their water, whatever they are, but they go on") {
    CHECK(fault(100'000, 1, 1, false, stream_agents).empty());
    CHECK(fault(100'000, 1'000'000'000, 1, false, stream_agents).empty());
    CHECK_FALSE(fault(100'000, 0, 1, false, stream_agents).empty());
}

TEST_CASE("a stream may begin at any tick that a double can hold") {
    const StreamInfo info = info_of(stream_fluid, 1);
    CHECK(tick_fault(info, {1, 0}, false, {}).empty());
    CHECK(tick_fault(info, {1, std::uint64_t{1} << 53}, false, {}).empty());
    CHECK_FALSE(tick_fault(info, {1, (std::uint64_t{1} << 53) + 1}, false, {}).empty());
}

TEST_CASE("the check of a descriptor covers all but its sequence") {
    SlotDescriptor d{};
    d.frame = 3;
    const std::uint32_t crc = descriptor_crc(d);
    d.sequence = 6;
    d.crc32c = crc;
    CHECK(descriptor_crc(d) == crc);
    d.diagnostics.reserved[std::size(d.diagnostics.reserved) - 1] = 1;
    CHECK(descriptor_crc(d) != crc);
}
