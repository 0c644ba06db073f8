#include <catch2/catch.hpp>
#include <cstddef>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include "shm_protocol/layout.hpp"

using namespace wade::shm;

namespace {

#define MEMBER(Type, member) \
    { #Type "." #member, offsetof(Type, member) }

const std::map<std::string, std::size_t> offsets{
    MEMBER(Header, magic),
    MEMBER(Header, version_major),
    MEMBER(Header, version_minor),
    MEMBER(Header, endian_tag),
    MEMBER(Header, header_bytes),
    MEMBER(Header, crc32c),
    MEMBER(Header, required_features),
    MEMBER(Header, total_bytes),
    MEMBER(Header, session_id),
    MEMBER(Header, scene_hash),
    MEMBER(Header, stream_kind),
    MEMBER(Header, coupling_lag),
    MEMBER(Header, capacity),
    MEMBER(Header, slot_count),
    MEMBER(Header, depth),
    MEMBER(Header, ticks_per_second),
    MEMBER(Header, ticks_per_frame),
    MEMBER(Header, metres_per_unit),
    MEMBER(Header, origin),
    MEMBER(Header, axes),
    MEMBER(Header, field_count),
    MEMBER(Header, particle_radius),
    MEMBER(Header, rest_density),
    MEMBER(Header, control_offset),
    MEMBER(Header, doorbell_offset),
    MEMBER(Header, consumers_offset),
    MEMBER(Header, consumer_stride),
    MEMBER(Header, consumer_count),
    MEMBER(Header, descriptors_offset),
    MEMBER(Header, descriptor_stride),
    MEMBER(Header, slots_offset),
    MEMBER(Header, slot_stride),
    MEMBER(Header, producer_name),
    MEMBER(Header, column_width),
    MEMBER(Header, fields),
    MEMBER(FieldEntry, name),
    MEMBER(FieldEntry, type),
    MEMBER(FieldEntry, offset),
    MEMBER(Control, publish_sequence),
    MEMBER(Control, state),
    MEMBER(Control, published_frame),
    MEMBER(Control, producer_waiting),
    MEMBER(Control, heartbeat_ns),
    MEMBER(Control, start_time),
    MEMBER(Control, pid),
    MEMBER(Control, paused),
    MEMBER(Control, admitted_frame),
    MEMBER(Control, reason_code),
    MEMBER(Control, reason_text),
    MEMBER(Doorbell, consumer_sequence),
    MEMBER(ConsumerEntry, state),
    MEMBER(ConsumerEntry, mode),
    MEMBER(ConsumerEntry, acknowledged_frame),
    MEMBER(ConsumerEntry, waiting),
    MEMBER(ConsumerEntry, stride),
    MEMBER(ConsumerEntry, dropped_frames),
    MEMBER(ConsumerEntry, heartbeat_ns),
    MEMBER(ConsumerEntry, start_time),
    MEMBER(ConsumerEntry, pid),
    MEMBER(ConsumerEntry, paused),
    MEMBER(ConsumerEntry, flags),
    MEMBER(ConsumerEntry, left_at_frame),
    MEMBER(ConsumerEntry, name),
    MEMBER(ConsumerEntry, reason_code),
    MEMBER(ConsumerEntry, reason_text),
    MEMBER(SlotDescriptor, sequence),
    MEMBER(SlotDescriptor, frame),
    MEMBER(SlotDescriptor, tick),
    MEMBER(SlotDescriptor, count),
    MEMBER(SlotDescriptor, flags),
    MEMBER(SlotDescriptor, hash),
    MEMBER(SlotDescriptor, previous_hash),
    MEMBER(SlotDescriptor, crc32c),
    MEMBER(SlotDescriptor, further_hash),
    MEMBER(SlotDescriptor, diagnostics),
    MEMBER(Diagnostics, sub_steps),
    MEMBER(Diagnostics, density_iterations),
    MEMBER(Diagnostics, divergence_iterations),
    MEMBER(Diagnostics, last_dt_s),
    MEMBER(Diagnostics, mean_density_error),
    MEMBER(Diagnostics, max_density_error),
    MEMBER(Diagnostics, solver_ns),
    MEMBER(Diagnostics, mean_depth_m),
    MEMBER(Diagnostics, mean_speed_m_s),
    MEMBER(Diagnostics, kinetic_energy_j),
    MEMBER(Diagnostics, potential_energy_j),
    MEMBER(Diagnostics, driving_acceleration_m_s2),
    MEMBER(Diagnostics, position_clamps),
    MEMBER(Diagnostics, recycled_particles),
    MEMBER(Diagnostics, resident_bytes),
    MEMBER(Diagnostics, taken_by_people_x_n_s),
    MEMBER(Diagnostics, taken_by_people_z_n_s),
    MEMBER(Diagnostics, missing_for_people_x_n_s),
    MEMBER(Diagnostics, missing_for_people_z_n_s),
};

}  // namespace

TEST_CASE("the byte tables of the contract list every member at the offset it has in the code, and nothing else") {
    std::ifstream contract(WADE_CONTRACT);
    REQUIRE(contract);
    std::map<std::string, std::size_t> listed;
    for (std::string line; std::getline(contract, line);) {
        std::istringstream row(line);
        std::string bar, member;
        std::size_t offset = 0;
        if (!(row >> bar >> offset) || bar != "|") continue;
        if (row >> bar >> member && member.find('.') != std::string::npos)
            listed[member.substr(1, member.size() - 2)] = offset;  // without the backquotes
    }
    CHECK(listed == offsets);
}

TEST_CASE("words of different writers lie on different cache lines and pages") {
    CHECK(offsetof(Control, producer_waiting) / line_bytes != offsetof(Control, publish_sequence) / line_bytes);
    CHECK(offsetof(Control, heartbeat_ns) / line_bytes != offsetof(Control, publish_sequence) / line_bytes);
    CHECK(offsetof(ConsumerEntry, heartbeat_ns) / line_bytes != offsetof(ConsumerEntry, waiting) / line_bytes);
    CHECK(sizeof(ConsumerEntry) % page_bytes == 0);
    CHECK(sizeof(SlotDescriptor) % line_bytes == 0);
    CHECK(doorbell_offset % page_bytes == 0);
    CHECK(consumers_offset % page_bytes == 0);
}

TEST_CASE("diagnostics that are not given can be told from zero") {
    const Diagnostics none;
    CHECK(none.sub_steps == 0);
    CHECK(none.solver_ns == 0);
    CHECK(none.mean_density_error != none.mean_density_error);  // NaN
    CHECK(none.driving_acceleration_m_s2 != none.driving_acceleration_m_s2);
}
