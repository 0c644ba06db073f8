#include "shm_protocol/inside/header.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <optional>
#include <span>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "shm_protocol/inside/bytes/crc32c.hpp"

namespace wade::shm {
namespace {

constexpr std::uint64_t round_up(std::uint64_t value, std::uint64_t to) {
    return (value + to - 1) / to * to;
}

std::string number(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%g", value);
    return text;
}

void require_argument(bool ok, const char* member, const std::string& value, const char* range) {
    if (!ok)
        throw std::invalid_argument(std::string("StreamInfo::") + member + " = " + value +
                                    " is out of range: " + range + ".");
}

bool is_axes(const std::int32_t* axes) {
    unsigned seen = 0;
    for (int i = 0; i < 3; ++i) {
        if (axes[i] == 0 || axes[i] < -3 || axes[i] > 3) return false;
        seen |= 1U << (axes[i] < 0 ? -axes[i] : axes[i]);
    }
    return seen == 0b1110U;
}

bool is_positive(double v) {
    return std::isfinite(v) && v > 0;
}
bool is_not_negative(double v) {
    return std::isfinite(v) && v >= 0;
}

// Wider columns would reach people from beyond the 2 m cells into which a crowd sorts the water.
constexpr double widest_column = 2;  // m
constexpr const char* allowed_column_widths = "both 0, or both above 0 and at most 2 m; split wider cells";
bool is_column_width(const double* width) {
    const bool none = width[0] == 0 && width[1] == 0;
    return none || (width[0] > 0 && width[0] <= widest_column && width[1] > 0 && width[1] <= widest_column);
}

void check_arguments(const StreamInfo& info) {
    require_argument(!info.producer_name.empty() && info.producer_name.size() < name_bytes, "producer_name",
                     "'" + info.producer_name + "'", "1 to 63 bytes");
    require_argument(info.capacity >= 1, "capacity", std::to_string(info.capacity), "at least 1");
    require_argument(info.slots >= 1 && info.slots <= max_slots, "slots", std::to_string(info.slots), "1 to 64");
    require_argument(info.depth >= 1 && info.depth <= info.slots, "depth", std::to_string(info.depth), "1 to slots");
    require_argument(info.ticks_per_second >= 1, "ticks_per_second", "0", "at least 1");
    require_argument(info.ticks_per_frame >= 1, "ticks_per_frame", "0", "at least 1");
    require_argument(is_positive(info.metres_per_unit), "metres_per_unit", number(info.metres_per_unit), "above 0");
    for (const double v : info.origin) require_argument(std::isfinite(v), "origin", number(v), "finite");
    require_argument(
        is_axes(info.axes.data()), "axes",
        std::to_string(info.axes[0]) + "," + std::to_string(info.axes[1]) + "," + std::to_string(info.axes[2]),
        "1, 2 and 3 in any order, negative where mirrored");
    require_argument(is_not_negative(info.particle_radius), "particle_radius", number(info.particle_radius),
                     "0 or more");
    require_argument(is_not_negative(info.rest_density), "rest_density", number(info.rest_density), "0 or more");
    require_argument(is_column_width(info.column_width.data()), "column_width",
                     number(info.column_width[0]) + ", " + number(info.column_width[1]), allowed_column_widths);
    require_argument(info.kind == stream_fluid || info.kind == stream_agents, "kind", std::to_string(info.kind),
                     "stream_fluid or stream_agents");
    require_argument(!info.impulses || info.kind == stream_agents, "impulses", "true", "false for a stream of water");
    require_argument(info.coupling_lag <= 1, "coupling_lag", std::to_string(info.coupling_lag), "0 or 1");
}

[[noreturn]] void refuse(const std::string& why) {
    throw Error(Failure::protocol_violation, why);
}

void demand(bool ok, const std::string& member, const std::string& value, const char* range) {
    if (!ok) refuse("The header says " + member + " = " + value + ", allowed is: " + range + ".");
}

void demand(bool ok, const std::string& member, std::uint64_t value, const char* range) {
    demand(ok, member, std::to_string(value), range);
}

struct Region {
    std::string name;
    std::uint64_t begin;
    std::uint64_t bytes;
};

// count * stride without overflow, refused when it exceeds what 63 bits can hold.
std::uint64_t extent(const std::string& name, std::uint64_t count, std::uint64_t stride) {
    std::uint64_t bytes = 0;
    if (__builtin_mul_overflow(count, stride, &bytes) || bytes >> 63)
        refuse("The header describes " + name + " of " + std::to_string(count) + " times " + std::to_string(stride) +
               " bytes, which no file can hold.");
    return bytes;
}

// Regions lie inside [0, limit) and apart from one another.
void demand_apart(std::vector<Region> regions, std::uint64_t limit) {
    std::sort(regions.begin(), regions.end(), [](const Region& a, const Region& b) { return a.begin < b.begin; });
    for (std::size_t i = 0; i < regions.size(); ++i) {
        const Region& r = regions[i];
        const std::uint64_t end = i + 1 < regions.size() ? regions[i + 1].begin : limit;
        if (r.begin > end || r.bytes > end - r.begin)
            refuse("The header places " + r.name + " (" + std::to_string(r.bytes) + " bytes from " +
                   std::to_string(r.begin) + " on) so that it overlaps or ends outside of its room.");
    }
}

void check_identity(const Header& h) {
    if (h.magic != magic) refuse("The segment does not begin with the magic number of this protocol.");
    if (h.version_major != version_major)
        refuse("The producer speaks protocol version " + std::to_string(h.version_major) + "." +
               std::to_string(h.version_minor) + ", this program version " + std::to_string(version_major) + "." +
               std::to_string(version_minor) + ".");
    if (h.endian_tag != endian_tag) refuse("The producer's byte order is not the one of this machine.");
    demand(h.header_bytes == page_bytes, "header_bytes", h.header_bytes, "4096");
    if (const std::uint32_t crc = header_crc(h); crc != h.crc32c)
        refuse("The header page is damaged: its CRC-32C is " + std::to_string(crc) + ", it says " +
               std::to_string(h.crc32c) + ".");
    if (const std::uint32_t unknown = h.required_features & ~known_features; unknown != 0)
        refuse("The producer requires features that this program does not know (bits " + std::to_string(unknown) +
               ").");
}

void check_values(const Header& h, std::uint64_t file_bytes) {
    demand(h.total_bytes == file_bytes, "total_bytes", h.total_bytes,
           ("the size of the segment, " + std::to_string(file_bytes)).c_str());
    demand(h.stream_kind == stream_fluid || h.stream_kind == stream_agents, "stream_kind", h.stream_kind, "1 or 2");
    demand(h.coupling_lag <= 1, "coupling_lag", h.coupling_lag, "0 or 1");
    demand(h.capacity >= 1 && h.capacity <= 0xFFFFFFFFU, "capacity", h.capacity, "1 to 4294967295");
    demand(h.slot_count >= 1 && h.slot_count <= max_slots, "slot_count", h.slot_count, "1 to 64");
    demand(h.depth >= 1 && h.depth <= h.slot_count, "depth", h.depth, "1 to slot_count");
    demand(h.ticks_per_second >= 1, "ticks_per_second", h.ticks_per_second, "at least 1");
    demand(h.ticks_per_frame >= 1, "ticks_per_frame", h.ticks_per_frame, "at least 1");
    demand(is_positive(h.metres_per_unit), "metres_per_unit", number(h.metres_per_unit), "above 0");
    for (const double v : h.origin) demand(std::isfinite(v), "origin", number(v), "finite");
    demand(is_axes(h.axes), "axes",
           std::to_string(h.axes[0]) + "," + std::to_string(h.axes[1]) + "," + std::to_string(h.axes[2]),
           "1, 2 and 3 in any order, negative where mirrored");
    demand(is_not_negative(h.particle_radius), "particle_radius", number(h.particle_radius), "0 or more");
    demand(is_not_negative(h.rest_density), "rest_density", number(h.rest_density), "0 or more");
    demand(is_column_width(h.column_width), "column_width",
           number(h.column_width[0]) + ", " + number(h.column_width[1]), allowed_column_widths);
    demand(h.field_count >= 1 && h.field_count <= max_fields, "field_count", h.field_count, "1 to 16");
    demand(h.consumer_count >= 1 && h.consumer_count <= max_consumers, "consumer_count", h.consumer_count, "1 to 16");
    demand(h.consumer_stride >= sizeof(ConsumerEntry) && h.consumer_stride % page_bytes == 0, "consumer_stride",
           h.consumer_stride, "a multiple of 4096");
    demand(h.descriptor_stride >= sizeof(SlotDescriptor) && h.descriptor_stride % line_bytes == 0, "descriptor_stride",
           h.descriptor_stride, "a multiple of 64, at least 256");
    demand(h.slot_stride >= page_bytes && h.slot_stride % page_bytes == 0, "slot_stride", h.slot_stride,
           "a multiple of 4096");
    for (const std::uint64_t at :
         {h.control_offset, h.doorbell_offset, h.consumers_offset, h.descriptors_offset, h.slots_offset})
        demand(at % page_bytes == 0, "offset", at, "a multiple of 4096");
    if (std::memchr(h.producer_name, 0, name_bytes) == nullptr) refuse("The producer's name has no end.");
}

void check_regions(const Header& h) {
    demand_apart(
        {{"the header page", 0, page_bytes},
         {"the control page", h.control_offset, sizeof(Control)},
         {"the doorbell page", h.doorbell_offset, sizeof(Doorbell)},
         {"the consumer pages", h.consumers_offset, extent("consumer pages", h.consumer_count, h.consumer_stride)},
         {"the descriptors", h.descriptors_offset, extent("descriptors", h.slot_count, h.descriptor_stride)},
         {"the slots", h.slots_offset, extent("slots", h.slot_count, h.slot_stride)}},
        h.total_bytes);
    std::vector<Region> arrays;
    for (std::uint32_t i = 0; i < h.field_count; ++i) {
        const FieldEntry& field = h.fields[i];
        if (std::memchr(field.name, 0, sizeof field.name) == nullptr) refuse("The name of a field has no end.");
        const std::string name = "field '" + printable(field.name, sizeof field.name) + "'";
        demand(field.type == field_float32, "the type of " + name, field.type, "1 (float32)");
        demand(field.offset % line_bytes == 0, "the offset of " + name, field.offset, "a multiple of 64");
        arrays.push_back({name, field.offset, extent(name, h.capacity, sizeof(float))});
    }
    demand_apart(arrays, h.slot_stride);
}

std::optional<std::uint64_t> find_field(const Header& h, const char* name) {
    for (std::uint32_t i = 0; i < h.field_count; ++i)
        if (std::strcmp(h.fields[i].name, name) == 0) return h.fields[i].offset;
    return std::nullopt;
}

std::uint64_t field_offset(const Header& h, const char* name) {
    if (const auto offset = find_field(h, name)) return *offset;
    refuse(std::string("The header lists no field '") + name + "'.");
}

bool has_impulses(const Header& h) {
    return h.stream_kind == stream_agents &&
           std::ranges::all_of(impulse_fields(), [&](const char* name) { return find_field(h, name).has_value(); });
}

StreamInfo info_of(const Header& h) {
    StreamInfo info;
    info.producer_name = printable(h.producer_name, name_bytes);
    info.capacity = static_cast<std::uint32_t>(h.capacity);
    info.depth = h.depth;
    info.slots = h.slot_count;
    info.ticks_per_second = h.ticks_per_second;
    info.ticks_per_frame = h.ticks_per_frame;
    info.metres_per_unit = h.metres_per_unit;
    std::copy_n(h.origin, 3, info.origin.begin());
    std::copy_n(h.axes, 3, info.axes.begin());
    info.particle_radius = h.particle_radius;
    info.rest_density = h.rest_density;
    std::copy_n(h.column_width, 2, info.column_width.begin());
    info.scene_hash = h.scene_hash;
    info.kind = static_cast<StreamKind>(h.stream_kind);
    info.coupling_lag = h.coupling_lag;
    info.impulses = has_impulses(h);
    info.session_id = h.session_id;
    return info;
}

}  // namespace

std::span<const char* const> required_fields(StreamKind kind) {
    static constexpr std::array names{"mass", "vx", "vy", "vz", "px", "py", "pz", "radius", "height", "state"};
    return std::span(names).first(kind == stream_agents ? names.size() : names.size() - 3);
}

std::span<const char* const> impulse_fields() {
    static constexpr std::array names{"jx", "jz", "submerged", "spread"};
    return names;
}

std::vector<const char*> fields_of(const StreamInfo& info) {
    const auto required = required_fields(info.kind);
    std::vector<const char*> names(required.begin(), required.end());
    if (info.impulses) names.insert(names.end(), impulse_fields().begin(), impulse_fields().end());
    return names;
}

std::uint32_t header_crc(Header copy) {
    copy.crc32c = 0;
    return crc32c(std::as_bytes(std::span(&copy, 1)));
}

Header make_header(const StreamInfo& given, std::uint64_t session_id) {
    StreamInfo info = given;
    if (info.slots == 0) info.slots = std::min(info.depth, max_slots - 1) + 1;
    check_arguments(info);

    Header h{};
    h.magic = magic;
    h.version_major = version_major;
    h.version_minor = version_minor;
    h.endian_tag = endian_tag;
    h.header_bytes = page_bytes;
    h.session_id = session_id;
    h.scene_hash = info.scene_hash;
    h.stream_kind = info.kind;
    h.coupling_lag = info.coupling_lag;
    h.capacity = info.capacity;
    h.slot_count = info.slots;
    h.depth = info.depth;
    h.ticks_per_second = info.ticks_per_second;
    h.ticks_per_frame = info.ticks_per_frame;
    h.metres_per_unit = info.metres_per_unit;
    std::copy_n(info.origin.begin(), 3, h.origin);
    std::copy_n(info.axes.begin(), 3, h.axes);
    h.particle_radius = info.particle_radius;
    h.rest_density = info.rest_density;
    std::copy_n(info.column_width.begin(), 2, h.column_width);
    h.control_offset = control_offset;
    h.doorbell_offset = doorbell_offset;
    h.consumers_offset = consumers_offset;
    h.consumer_stride = page_bytes;
    h.consumer_count = max_consumers;
    h.descriptors_offset = descriptors_offset;
    h.descriptor_stride = sizeof(SlotDescriptor);
    h.slots_offset = round_up(descriptors_offset + h.slot_count * h.descriptor_stride, page_bytes);
    store_text(h.producer_name, name_bytes, info.producer_name);

    const std::uint64_t array_bytes = round_up(h.capacity * sizeof(float), line_bytes);
    const std::vector<const char*> names = fields_of(info);
    h.field_count = static_cast<std::uint32_t>(names.size());
    for (std::uint32_t i = 0; i < h.field_count; ++i) {
        store_text(h.fields[i].name, sizeof h.fields[i].name, names[i]);
        h.fields[i].type = field_float32;
        h.fields[i].offset = i * array_bytes;
    }
    h.slot_stride = round_up(h.field_count * array_bytes, page_bytes);
    h.total_bytes = h.slots_offset + h.slot_count * h.slot_stride;
    h.crc32c = header_crc(h);
    return h;
}

SegmentMap read_header(const Header& h, std::uint64_t file_bytes) {
    check_identity(h);
    check_values(h, file_bytes);
    check_regions(h);
    SegmentMap map;
    map.info = info_of(h);
    map.total_bytes = h.total_bytes;
    map.control = h.control_offset;
    map.doorbell = h.doorbell_offset;
    map.consumers = h.consumers_offset;
    map.descriptors = h.descriptors_offset;
    map.slots = h.slots_offset;
    map.consumer_stride = h.consumer_stride;
    map.descriptor_stride = h.descriptor_stride;
    map.slot_stride = h.slot_stride;
    map.consumer_count = h.consumer_count;
    map.descriptors_have_checks = h.version_minor >= minor_with_checks;
    map.has_further_hash = h.version_minor >= minor_with_further_hash;
    for (const char* const name : fields_of(map.info)) map.fields.push_back(field_offset(h, name));
    return map;
}

}  // namespace wade::shm
