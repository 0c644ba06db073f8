// The bytes of a segment, contract 1.1 (shm_protocol/README.md), for C programs.
//
// Words that both sides use are _Atomic members: using one by name is sequentially consistent in C11, which is at least
// what the contract asks for. They are lock-free, so they also work between processes.
#ifndef WADE_PRODUCERS_LAYOUT_H
#define WADE_PRODUCERS_LAYOUT_H

#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

enum { page = 4096, max_consumers = 16, max_slots = 64, field_count = 7 };
enum producer_state { ready = 1, running, draining, closed, aborted };
enum consumer_state { joined = 1, left, gave_up, refused };
enum consumer_mode { lockstep = 0, latest = 1 };
enum { consumer_follows = 1, frame_final = 1 };  // bit 0 of a consumer's flags, bit 0 of a frame's flags

struct header {
    _Atomic uint64_t magic;
    uint32_t version_major, version_minor, endian_tag, header_bytes, crc32c, required_features;
    uint64_t total_bytes, session_id, scene_hash;
    uint32_t stream_kind, coupling_lag;
    uint64_t capacity;
    uint32_t slot_count, depth;
    uint64_t ticks_per_second, ticks_per_frame;
    double metres_per_unit, origin[3];
    int32_t axes[3];
    uint32_t field_count;
    double particle_radius, rest_density;
    uint64_t control_offset, doorbell_offset, consumers_offset;
    uint32_t consumer_stride, consumer_count;
    uint64_t descriptors_offset, descriptor_stride, slots_offset, slot_stride;
    char producer_name[64], reserved[224];
    struct {
        char name[16];
        uint32_t type, reserved;
        uint64_t offset;
    } fields[16];
    char reserved_end[3072];
};
struct control {
    _Atomic uint32_t publish_sequence, state;
    _Atomic uint64_t published_frame;
    char line0[48];
    _Atomic uint32_t producer_waiting;
    char line1[60];
    _Atomic uint64_t heartbeat_ns;
    uint64_t start_time;
    uint32_t pid;
    _Atomic uint32_t paused;  // this producer never pauses on purpose
    char line2[40];
    _Atomic uint64_t admitted_frame[max_consumers];
    char line3[192];
    int32_t reason_code, reserved;
    char reason_text[512], reserved_end[3064];
};
struct consumer {
    _Atomic uint32_t state, mode;
    _Atomic uint64_t acknowledged_frame;
    _Atomic uint32_t waiting;
    uint32_t stride;
    uint64_t dropped_frames;
    char line0[32];
    _Atomic uint64_t heartbeat_ns;
    uint64_t start_time;
    uint32_t pid;
    _Atomic uint32_t paused, flags;
    char line1[36], name[64];
    int32_t reason_code, reserved;
    char reason_text[512], reserved_end[3384];
};
struct descriptor {
    _Atomic uint64_t sequence;
    uint64_t frame, tick;
    uint32_t count, flags;
    uint64_t hash, previous_hash, reserved[2];
    uint32_t sub_steps, density_iterations, divergence_iterations, reserved0;  // from here on the diagnostics
    double last_dt_s, mean_density_error, max_density_error;
    uint64_t solver_ns;
    double mean_depth_m, mean_speed_m_s, kinetic_energy_j, potential_energy_j, driving_acceleration_m_s2;
    uint64_t position_clamps, recycled_particles, resident_bytes, reserved1[10];
};
struct segment {
    struct header header;
    struct control control;
    struct {
        _Atomic uint32_t consumer_sequence;
        char reserved[4092];
    } doorbell;
    struct consumer consumers[max_consumers];
    struct descriptor descriptors[];  // one for each slot, then, on the next page, the slots
};
_Static_assert(ATOMIC_LLONG_LOCK_FREE == 2 && ATOMIC_INT_LOCK_FREE == 2, "the contract needs lock-free words");
_Static_assert(offsetof(struct header, producer_name) == 224 && offsetof(struct header, fields) == 512, "header");
_Static_assert(offsetof(struct control, admitted_frame) == 192 && offsetof(struct control, reason_code) == 512,
               "control page");
_Static_assert(offsetof(struct consumer, flags) == 88 && offsetof(struct consumer, reason_text) == 200,
               "consumer page");
_Static_assert(offsetof(struct descriptor, sub_steps) == 64 && sizeof(struct descriptor) == 256, "slot descriptor");
_Static_assert(sizeof(struct header) == page && sizeof(struct control) == page && sizeof(struct consumer) == page &&
                   offsetof(struct segment, descriptors) == 19 * page,
               "segment");

static inline uint64_t round_up(uint64_t value, uint64_t to) {
    return (value + to - 1) / to * to;
}

// The header page of a fluid stream of 30 frames a second in world coordinates, without magic, checksum, session id and
// scene. One slot more than the depth, so that a free-running reader finds a frame that is not being written.
static inline struct header new_header(uint64_t capacity, uint32_t depth, const char* producer) {
    static const char* const names[field_count] = {"mass", "vx", "vy", "vz", "px", "py", "pz"};
    const uint64_t array_bytes = round_up(capacity * sizeof(float), 64);
    struct header h = {.version_major = 1, .version_minor = 1, .endian_tag = 0x01020304, .header_bytes = page};
    h.stream_kind = 1;
    h.capacity = capacity;
    h.depth = depth;
    h.slot_count = depth + 1;
    h.ticks_per_second = 30;
    h.ticks_per_frame = 1;
    h.metres_per_unit = 1;
    h.rest_density = 1000;
    h.control_offset = offsetof(struct segment, control);
    h.doorbell_offset = offsetof(struct segment, doorbell);
    h.consumers_offset = offsetof(struct segment, consumers);
    h.consumer_stride = sizeof(struct consumer);
    h.consumer_count = max_consumers;
    h.descriptors_offset = offsetof(struct segment, descriptors);
    h.descriptor_stride = sizeof(struct descriptor);
    h.slots_offset = round_up(h.descriptors_offset + h.slot_count * h.descriptor_stride, page);
    h.slot_stride = round_up(field_count * array_bytes, page);
    h.total_bytes = h.slots_offset + h.slot_count * h.slot_stride;
    for (int32_t i = 0; i < 3; ++i) h.axes[i] = i + 1;
    h.field_count = field_count;
    for (unsigned i = 0; i < field_count; ++i) {
        strncpy(h.fields[i].name, names[i], sizeof h.fields[i].name - 1);
        h.fields[i].type = 1;  // float32
        h.fields[i].offset = i * array_bytes;
    }
    strncpy(h.producer_name, producer, sizeof h.producer_name - 1);
    return h;
}

#endif
