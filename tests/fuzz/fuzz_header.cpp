// libFuzzer on read_header(): whatever it accepts, a reader can use without leaving the file.

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "shm_protocol/inside/pages.hpp"
#include "tests/fuzz/header_input.hpp"

namespace {

using namespace wade::shm;
using Wide = unsigned __int128;  // no sum or product of this file overflows it

void demand(bool ok, const char* what) {
    if (ok) return;
    std::fprintf(stderr, "fuzz_header: broken expectation: %s\n", what);
    std::abort();
}

struct Position {
    Wide begin;
    Wide bytes;
};

void demand_inside_and_apart(const std::vector<Position>& places, Wide room) {
    for (const Position& place : places) demand(place.begin + place.bytes <= room, "regions lie inside of their room");
    for (std::size_t i = 0; i < places.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
            demand(places[i].begin + places[i].bytes <= places[j].begin ||
                       places[j].begin + places[j].bytes <= places[i].begin,
                   "regions are apart");
}

void check_places(const SegmentMap& map) {
    const StreamInfo& info = map.info;
    for (const std::uint64_t at : {map.control, map.doorbell, map.consumers, map.descriptors, map.slots})
        demand(at % page_bytes == 0, "regions begin at pages");
    demand(map.consumer_stride % page_bytes == 0 && map.consumer_stride >= page_bytes, "consumer pages are pages");
    demand(map.descriptor_stride % line_bytes == 0 && map.descriptor_stride >= sizeof(SlotDescriptor),
           "descriptors are apart");
    demand(map.slot_stride % page_bytes == 0 && map.slot_stride > 0, "slots are pages");
    demand_inside_and_apart({{0, page_bytes},
                             {map.control, page_bytes},
                             {map.doorbell, page_bytes},
                             {map.consumers, Wide{map.consumer_stride} * map.consumer_count},
                             {map.descriptors, Wide{map.descriptor_stride} * info.slots},
                             {map.slots, Wide{map.slot_stride} * info.slots}},
                            map.total_bytes);
    std::vector<Position> arrays;
    for (const std::uint64_t at : map.fields) {
        demand(at % line_bytes == 0, "arrays begin at cache lines");
        arrays.push_back({at, Wide{info.capacity} * sizeof(float)});
    }
    demand_inside_and_apart(arrays, map.slot_stride);
}

void check_info(const StreamInfo& info) {
    demand(info.capacity >= 1, "capacity is at least 1");
    demand(info.slots >= 1 && info.slots <= max_slots, "1 to 64 slots");
    demand(info.depth >= 1 && info.depth <= info.slots, "1 <= depth <= slots");
    demand(info.ticks_per_second >= 1 && info.ticks_per_frame >= 1, "time goes on");
    demand(std::isfinite(info.metres_per_unit) && info.metres_per_unit > 0, "lengths are positive");
    for (const double v : info.origin) demand(std::isfinite(v), "the origin is finite");
    int seen = 0;
    for (const std::int32_t axis : info.axes) {
        demand(axis >= -3 && axis <= 3 && axis != 0, "an axis is 1, 2 or 3");
        seen |= 1 << std::abs(axis);
    }
    demand(seen == 0b1110, "the axes are different");
    demand(std::isfinite(info.particle_radius) && info.particle_radius >= 0, "the radius is given or 0");
    demand(std::isfinite(info.rest_density) && info.rest_density >= 0, "the density is given or 0");
    demand(info.kind == stream_fluid || info.kind == stream_agents, "the kind is known");
    demand(info.coupling_lag <= 1, "the lag is 0 or 1");
}

void check_text(const std::string& text, std::size_t room) {
    demand(text.size() < room, "a text ends in its room");
    for (const char c : text) demand(static_cast<unsigned char>(c) >= 0x20 && c != 0x7F, "a text is printable");
}

// Touches the first and the last byte of everything, in memory of exactly the file's size: AddressSanitizer looks.
void touch(const SegmentMap& map) {
    constexpr std::uint64_t small = 1 << 18;
    if (map.total_bytes > small) return;
    struct Free {
        void operator()(std::byte* p) const { std::free(p); }
    };
    const std::unique_ptr<std::byte, Free> file(
        static_cast<std::byte*>(std::aligned_alloc(page_bytes, map.total_bytes / page_bytes * page_bytes)));
    if (!file || map.total_bytes % page_bytes != 0) return;
    const Pages<std::byte> pages(file.get(), map);
    const auto write = [](void* at, std::size_t bytes) {
        static_cast<volatile std::uint8_t*>(at)[0] = 1;
        static_cast<volatile std::uint8_t*>(at)[bytes - 1] = 1;
    };
    write(&pages.control(), sizeof(Control));
    write(&pages.doorbell(), sizeof(Doorbell));
    for (std::uint32_t i = 0; i < map.consumer_count; ++i) write(&pages.consumer(i), sizeof(ConsumerEntry));
    for (std::uint64_t frame = 1; frame <= map.info.slots; ++frame) {
        write(&pages.descriptor(frame), sizeof(SlotDescriptor));
        for (std::size_t i = 0; i < map.fields.size(); ++i)
            write(pages.field(frame, i), map.info.capacity * sizeof(float));
    }
}

// A producer with these values would fill a header that a reader accepts.
void check_round_trip(StreamInfo info) {
    if (info.producer_name.empty()) info.producer_name = "nameless";  // which only a reader allows
    const Header again = make_header(info, 1);
    const SegmentMap map = read_header(again, again.total_bytes);
    demand(map.info.capacity == info.capacity && map.info.slots == info.slots && map.info.depth == info.depth,
           "make_header and read_header agree");
}

void check_text_functions(const std::uint8_t* data, std::size_t size) {
    const std::size_t room = std::min<std::size_t>(size, name_bytes);
    if (room == 0) return;
    const std::vector<char> raw(data, data + room);  // of exactly this size, for AddressSanitizer
    const std::string text = printable(raw.data(), room);
    check_text(text, room + 1);
    std::vector<char> field(room, 'x');
    store_text(field.data(), room, text);
    demand(field.back() == 0, "a stored text ends");
    const std::string stored = printable(field.data(), room);
    demand(text.starts_with(stored), "a stored text is the beginning of the text");
    demand(stored.size() + 3 >= std::min(text.size(), room - 1), "and all of it that fits, up to a whole character");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    check_text_functions(data, size);
    const wade::fuzz::HeaderInput input = wade::fuzz::read_input(data, size);
    try {
        const SegmentMap map = read_header(input.header, input.file_bytes);
        demand(map.total_bytes == input.file_bytes, "the file is as long as its header says");
        demand(map.consumer_count >= 1 && map.consumer_count <= max_consumers, "1 to 16 consumers");
        demand(map.fields.size() == required_fields(map.info.kind).size(), "every required field has its place");
        check_info(map.info);
        check_places(map);
        check_text(map.info.producer_name, name_bytes);
        touch(map);
        if ((data[0] & wade::fuzz::also_round_trip) != 0) check_round_trip(map.info);
    } catch (const Error& error) {
        demand(error.failure() == Failure::protocol_violation, "a refusal is a protocol violation");
        check_text(error.what(), std::numeric_limits<std::size_t>::max());
    }
    return 0;
}

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

// Half of the mutations give one member a value from the edge of what may be there, the others are libFuzzer's own.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned seed) {
    std::minstd_rand random(seed);
    const auto pick = [&](std::size_t n) { return random() / 7 % n; };
    if (size < 2 || max_size < 1 + sizeof(Header) || pick(2) == 0) return LLVMFuzzerMutate(data, size, max_size);
    wade::shm::Header h{};
    std::memcpy(&h, data + 1, std::min(size - 1, sizeof h));
    struct Member {
        std::size_t offset, bytes;
    };
    static constexpr std::array<Member, 27> members{
        {{8, 4},   {12, 4},  {16, 4},  {20, 4},  {28, 4},  {32, 8},  {48, 8},  {56, 4},  {60, 4},
         {64, 8},  {72, 4},  {76, 4},  {80, 8},  {88, 8},  {96, 8},  {104, 8}, {128, 4}, {140, 4},
         {144, 8}, {160, 8}, {168, 8}, {176, 8}, {184, 4}, {188, 4}, {192, 8}, {200, 8}, {208, 8}}};
    static constexpr std::array<std::uint64_t, 20> edges{0,
                                                         1,
                                                         2,
                                                         63,
                                                         64,
                                                         65,
                                                         256,
                                                         4032,
                                                         4095,
                                                         4096,
                                                         4097,
                                                         8192,
                                                         0x7FFFFFFF,
                                                         0xFFFFFFFF,
                                                         0x100000000,
                                                         0x4000000000000000,
                                                         0x7FF0000000000000,
                                                         0x7FFFFFFFFFFFF000,
                                                         0x8000000000000000,
                                                         0xFFFFFFFFFFFFF000};
    std::size_t offset = 216, bytes = 8;  // slot_stride
    if (const std::size_t which = pick(members.size() + 9); which < members.size()) {
        offset = members[which].offset;
        bytes = members[which].bytes;
    } else if (which > members.size()) {
        offset = offsetof(Header, fields) + pick(max_fields) * sizeof(FieldEntry) + (pick(4) == 0 ? 16 : 24);
    }
    auto* const page = reinterpret_cast<std::uint8_t*>(&h);
    std::uint64_t value = 0;
    std::memcpy(&value, page + offset, bytes);
    switch (pick(4)) {
        case 0:
            value = edges[pick(edges.size())];
            break;
        case 1:
            value += edges[pick(edges.size())];
            break;
        case 2:
            value -= edges[pick(edges.size())];
            break;
        default:
            value ^= std::uint64_t{1} << pick(bytes * 8);
    }
    std::memcpy(page + offset, &value, bytes);
    const auto changed = wade::fuzz::write_input(pick(8) == 0 ? static_cast<std::uint8_t>(pick(16)) : data[0], h);
    std::memcpy(data, changed.data(), changed.size());
    return changed.size();
}
