#pragma once
// The bytes of a segment, version 1: fixed-width integers, IEEE floats, no pointers, no locks. docs/protocol.md is its prose.
//
//   offset   0      header page      written by the producer before the magic, then never again
//   4 KiB           control page     written by the producer
//   8 KiB           doorbell page    written by every consumer (one word, only to wake the producer)
//   12 KiB          consumer pages   one page for each of 16 consumers, written by that consumer alone
//   76 KiB          descriptors      one for each slot, written by the producer
//   then            slots            one frame each, structure of arrays, page aligned
//
// A change that an old reader could misread raises version_major; new fields in reserved bytes raise version_minor.
// Reserved bytes are zero. Words marked (atomic) are accessed with the memory order that docs/protocol.md states.

#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

namespace wade::shm {

inline constexpr std::uint64_t magic = 0x314D485345444157;  // the bytes "WADESHM1" in a little-endian file
inline constexpr std::uint32_t version_major = 1;
inline constexpr std::uint32_t version_minor = 4;
inline constexpr std::uint32_t minor_with_checks = 2;  // from here on a descriptor has a check of its own
inline constexpr std::uint32_t minor_with_further_hash = 3;
inline constexpr std::uint32_t endian_tag = 0x01020304;
inline constexpr std::uint32_t known_features = 0;  // bits of Header::required_features that this version understands

inline constexpr std::size_t page_bytes = 4096;
inline constexpr std::size_t line_bytes = 64;
inline constexpr std::uint32_t max_consumers = 16;
inline constexpr std::uint32_t max_slots = 64;
inline constexpr std::uint32_t max_fields = 16;
inline constexpr std::size_t name_bytes = 64;     // with the terminating zero
inline constexpr std::size_t reason_bytes = 512;  // with the terminating zero

enum StreamKind : std::uint32_t { stream_fluid = 1, stream_agents = 2 };
enum AgentState : std::uint32_t { agent_walking = 0, agent_arrived = 1, agent_dead = 2 };  // field `state`, as a float
enum FieldType : std::uint32_t { field_float32 = 1 };
enum ProducerState : std::uint32_t {
    producer_init = 0,
    producer_ready = 1,     // consumers may join
    producer_running = 2,   // a frame was begun
    producer_draining = 3,  // published_frame is the last one
    producer_closed = 4,    // every lockstep consumer has acknowledged the last frame
    producer_aborted = 5    // reason_code and reason_text say why
};
enum ConsumerState : std::uint32_t {
    consumer_free = 0,
    consumer_joined = 1,   // takes part from frame Control::admitted_frame[i], once the producer has set it
    consumer_left = 2,     // clean goodbye
    consumer_aborted = 3,  // reason_code and reason_text say why
    consumer_refused = 4   // did not join because of what the header says, reason_text says why
};
enum ConsumerMode : std::uint32_t {
    mode_lockstep = 0,  // the producer waits for its acknowledgements
    mode_latest = 1     // the producer never waits for it
};
enum ConsumerFlag : std::uint32_t {
    consumer_follows = 1,  // the stream ends when only such consumers remain (recorders, loggers)
};
enum FrameFlag : std::uint32_t {
    frame_final = 1,      // the last frame of the stream
    frame_nonfinite = 2,  // holds a NaN or an infinity
};

// Diagnostics of one frame. Not given: 0 for an integer (so a counter at 0 reads "none or not given"), NaN for a
// double.
struct Diagnostics {
    static constexpr double not_given = std::numeric_limits<double>::quiet_NaN();

    std::uint32_t sub_steps = 0;              // time steps of this frame
    std::uint32_t density_iterations = 0;     // of the constant-density solve, summed over the sub-steps
    std::uint32_t divergence_iterations = 0;  // of the divergence-free solve, summed over the sub-steps
    std::uint32_t reserved0 = 0;
    double last_dt_s = not_given;           // length of the last sub-step
    double mean_density_error = not_given;  // max(0, rho/rho0 - 1), mean over particles, then over sub-steps
    double max_density_error = not_given;   // the same fraction, maximum over particles and sub-steps
    std::uint64_t solver_ns = 0;            // wall time spent in the solver for this frame
    double mean_depth_m = not_given;
    double mean_speed_m_s = not_given;  // of the stream, in the direction of flow
    double kinetic_energy_j = not_given;
    double potential_energy_j = not_given;
    double driving_acceleration_m_s2 = not_given;  // body force that holds the bulk speed, mean over the frame
    std::uint64_t position_clamps = 0;             // since the start
    std::uint64_t recycled_particles = 0;          // since the start
    std::uint64_t resident_bytes = 0;              // memory of the producer's process
    // Momentum along x and z since the start: what people took from the water, and what they got of water that was no longer
    // there. 0 in versions before 1.3.
    double taken_by_people_x_n_s = not_given;
    double taken_by_people_z_n_s = not_given;
    double missing_for_people_x_n_s = not_given;
    double missing_for_people_z_n_s = not_given;
    std::uint64_t reserved[6] = {};
};

// One array of a slot: `capacity` values of `type` from `offset` (bytes from the start of the slot) on.
struct FieldEntry {
    char name[16];  // zero-terminated, see required_fields() in header.hpp
    std::uint32_t type;
    std::uint32_t reserved;
    std::uint64_t offset;  // a multiple of 64
};

struct Header {
    std::uint64_t magic;  // (atomic) stored last; 0 = the producer is still at work
    std::uint32_t version_major;
    std::uint32_t version_minor;
    std::uint32_t endian_tag;
    std::uint32_t header_bytes;       // 4096
    std::uint32_t crc32c;             // of the header page with this word taken as 0
    std::uint32_t required_features;  // bits that a reader must understand
    std::uint64_t total_bytes;        // the size of the file
    std::uint64_t session_id;         // random, differs from run to run
    std::uint64_t scene_hash;         // 0 = not given
    std::uint32_t stream_kind;        // StreamKind
    std::uint32_t coupling_lag;       // two-way runs: 0 serial, 1 parallel
    std::uint64_t capacity;           // particles a slot can hold, 1 .. 2^32 - 1
    std::uint32_t slot_count;         // 1 .. 64
    std::uint32_t depth;              // 1 .. slot_count
    std::uint64_t ticks_per_second;
    std::uint64_t ticks_per_frame;
    double metres_per_unit;
    double origin[3];      // in metres
    std::int32_t axes[3];  // world axis i is the stored axis |axes[i]| - 1, mirrored if negative: {1, 2, 3} = as stored
    std::uint32_t field_count;
    double particle_radius;  // m, 0 = not given
    double rest_density;     // kg/m3, 0 = not given
    std::uint64_t control_offset;
    std::uint64_t doorbell_offset;
    std::uint64_t consumers_offset;
    std::uint32_t consumer_stride;
    std::uint32_t consumer_count;
    std::uint64_t descriptors_offset;
    std::uint64_t descriptor_stride;
    std::uint64_t slots_offset;
    std::uint64_t slot_stride;
    char producer_name[name_bytes];
    double column_width[2];  // since 1.4: along world x and z, m, see StreamInfo; 0 = particles are points
    std::uint8_t reserved0[208];
    FieldEntry fields[max_fields];
    std::uint8_t reserved1[3072];
};

struct Control {
    std::uint32_t publish_sequence;  // (atomic) futex word: one more at each publication, admission and change of state
    std::uint32_t state;             // (atomic) ProducerState
    std::uint64_t published_frame;   // (atomic) frames 1 .. published_frame are complete
    std::uint8_t reserved0[48];
    std::uint32_t producer_waiting;  // (atomic) 1 while the producer sleeps or is about to
    std::uint8_t reserved1[60];
    std::uint64_t heartbeat_ns;  // (atomic) CLOCK_MONOTONIC, a sign of life
    std::uint64_t start_time;    // of the process, clock ticks since boot
    std::uint32_t pid;
    std::uint32_t paused;  // (atomic) 1 = pauses on purpose, waiting consumers do not count the time
    std::uint8_t reserved2[40];
    std::uint64_t admitted_frame[max_consumers];  // (atomic) first frame of consumer i; 0 = not admitted
    std::uint8_t reserved3[192];
    std::int32_t reason_code;
    std::uint32_t reserved4;
    char reason_text[reason_bytes];
    std::uint8_t reserved5[3064];
};

struct Doorbell {
    std::uint32_t consumer_sequence;  // (atomic) futex word: one more at each join, acknowledgement, goodbye and abort
    std::uint8_t reserved[4092];
};

struct ConsumerEntry {
    std::uint32_t state;               // (atomic) ConsumerState
    std::uint32_t mode;                // (atomic) ConsumerMode
    std::uint64_t acknowledged_frame;  // (atomic) this and all before are no longer in use; LATEST: the last one taken
    std::uint32_t waiting;             // (atomic) 1 while the consumer sleeps or is about to
    std::uint32_t stride;              // takes every stride-th frame, LATEST mode; 0 = 1
    std::uint64_t dropped_frames;      // (atomic) frames missed beyond those that the stride leaves out, LATEST mode
    std::uint8_t reserved0[32];
    std::uint64_t heartbeat_ns;  // (atomic)
    std::uint64_t start_time;
    std::uint32_t pid;
    std::uint32_t paused;  // (atomic) 1 = pauses on purpose, a producer that waits for it does not count the time
    std::uint32_t flags;   // (atomic) ConsumerFlag
    std::uint32_t reserved1;
    std::uint64_t left_at_frame;  // (atomic) published_frame after the goodbye, 2^64 - 1 before it
    std::uint8_t reserved4[24];
    char name[name_bytes];
    std::int32_t reason_code;
    std::uint32_t reserved2;
    char reason_text[reason_bytes];
    std::uint8_t reserved3[3384];
};

struct SlotDescriptor {
    std::uint64_t sequence;       // (atomic) 2f - 1 while frame f is being written, 2f once it is complete
    std::uint64_t frame;          // from 1 on
    std::uint64_t tick;           // time of the frame, strictly increasing from any first value on
    std::uint32_t count;          // particles
    std::uint32_t flags;          // FrameFlag
    std::uint64_t hash;           // chain over frames 1 .. f (hash.hpp); 0 = not given
    std::uint64_t previous_hash;  // chain over frames 1 .. f - 1; 0 = first frame or not given
    std::uint32_t crc32c;         // of the bytes from `frame` to the end, with this word taken as 0
    std::uint32_t reserved;
    std::uint64_t further_hash;  // from the hash of frame f over its optional fields (header.hpp); 0 = not given
    Diagnostics diagnostics;
};

inline constexpr std::uint64_t control_offset = page_bytes;
inline constexpr std::uint64_t doorbell_offset = 2 * page_bytes;
inline constexpr std::uint64_t consumers_offset = 3 * page_bytes;
inline constexpr std::uint64_t descriptors_offset = consumers_offset + max_consumers * page_bytes;

// Bytes of the file that participants lock (OFD, exclusive) as long as they live.
inline constexpr std::uint64_t producer_lock_byte = 0;
inline constexpr std::uint64_t consumer_lock_byte = 1;  // of consumer 0, consumer i holds the i-th after it

#define WADE_SHM_AT(Type, member, at) static_assert(offsetof(Type, member) == (at), #Type "::" #member)
WADE_SHM_AT(Diagnostics, sub_steps, 0);
WADE_SHM_AT(Diagnostics, density_iterations, 4);
WADE_SHM_AT(Diagnostics, divergence_iterations, 8);
WADE_SHM_AT(Diagnostics, last_dt_s, 16);
WADE_SHM_AT(Diagnostics, mean_density_error, 24);
WADE_SHM_AT(Diagnostics, max_density_error, 32);
WADE_SHM_AT(Diagnostics, solver_ns, 40);
WADE_SHM_AT(Diagnostics, mean_depth_m, 48);
WADE_SHM_AT(Diagnostics, mean_speed_m_s, 56);
WADE_SHM_AT(Diagnostics, kinetic_energy_j, 64);
WADE_SHM_AT(Diagnostics, potential_energy_j, 72);
WADE_SHM_AT(Diagnostics, driving_acceleration_m_s2, 80);
WADE_SHM_AT(Diagnostics, position_clamps, 88);
WADE_SHM_AT(Diagnostics, recycled_particles, 96);
WADE_SHM_AT(Diagnostics, resident_bytes, 104);
WADE_SHM_AT(Diagnostics, taken_by_people_x_n_s, 112);
WADE_SHM_AT(Diagnostics, taken_by_people_z_n_s, 120);
WADE_SHM_AT(Diagnostics, missing_for_people_x_n_s, 128);
WADE_SHM_AT(Diagnostics, missing_for_people_z_n_s, 136);
WADE_SHM_AT(Diagnostics, reserved, 144);
static_assert(sizeof(Diagnostics) == 192);

WADE_SHM_AT(FieldEntry, name, 0);
WADE_SHM_AT(FieldEntry, type, 16);
WADE_SHM_AT(FieldEntry, offset, 24);
static_assert(sizeof(FieldEntry) == 32);

WADE_SHM_AT(Header, magic, 0);
WADE_SHM_AT(Header, version_major, 8);
WADE_SHM_AT(Header, version_minor, 12);
WADE_SHM_AT(Header, endian_tag, 16);
WADE_SHM_AT(Header, header_bytes, 20);
WADE_SHM_AT(Header, crc32c, 24);
WADE_SHM_AT(Header, required_features, 28);
WADE_SHM_AT(Header, total_bytes, 32);
WADE_SHM_AT(Header, session_id, 40);
WADE_SHM_AT(Header, scene_hash, 48);
WADE_SHM_AT(Header, stream_kind, 56);
WADE_SHM_AT(Header, coupling_lag, 60);
WADE_SHM_AT(Header, capacity, 64);
WADE_SHM_AT(Header, slot_count, 72);
WADE_SHM_AT(Header, depth, 76);
WADE_SHM_AT(Header, ticks_per_second, 80);
WADE_SHM_AT(Header, ticks_per_frame, 88);
WADE_SHM_AT(Header, metres_per_unit, 96);
WADE_SHM_AT(Header, origin, 104);
WADE_SHM_AT(Header, axes, 128);
WADE_SHM_AT(Header, field_count, 140);
WADE_SHM_AT(Header, particle_radius, 144);
WADE_SHM_AT(Header, rest_density, 152);
WADE_SHM_AT(Header, control_offset, 160);
WADE_SHM_AT(Header, doorbell_offset, 168);
WADE_SHM_AT(Header, consumers_offset, 176);
WADE_SHM_AT(Header, consumer_stride, 184);
WADE_SHM_AT(Header, consumer_count, 188);
WADE_SHM_AT(Header, descriptors_offset, 192);
WADE_SHM_AT(Header, descriptor_stride, 200);
WADE_SHM_AT(Header, slots_offset, 208);
WADE_SHM_AT(Header, slot_stride, 216);
WADE_SHM_AT(Header, producer_name, 224);
WADE_SHM_AT(Header, column_width, 288);
WADE_SHM_AT(Header, reserved0, 304);
WADE_SHM_AT(Header, fields, 512);
WADE_SHM_AT(Header, reserved1, 1024);
static_assert(sizeof(Header) == page_bytes);

WADE_SHM_AT(Control, publish_sequence, 0);
WADE_SHM_AT(Control, state, 4);
WADE_SHM_AT(Control, published_frame, 8);
WADE_SHM_AT(Control, producer_waiting, 64);
WADE_SHM_AT(Control, heartbeat_ns, 128);
WADE_SHM_AT(Control, start_time, 136);
WADE_SHM_AT(Control, pid, 144);
WADE_SHM_AT(Control, paused, 148);
WADE_SHM_AT(Control, admitted_frame, 192);
WADE_SHM_AT(Control, reason_code, 512);
WADE_SHM_AT(Control, reason_text, 520);
static_assert(sizeof(Control) == page_bytes);

WADE_SHM_AT(Doorbell, consumer_sequence, 0);
static_assert(sizeof(Doorbell) == page_bytes);

WADE_SHM_AT(ConsumerEntry, state, 0);
WADE_SHM_AT(ConsumerEntry, mode, 4);
WADE_SHM_AT(ConsumerEntry, acknowledged_frame, 8);
WADE_SHM_AT(ConsumerEntry, waiting, 16);
WADE_SHM_AT(ConsumerEntry, stride, 20);
WADE_SHM_AT(ConsumerEntry, dropped_frames, 24);
WADE_SHM_AT(ConsumerEntry, heartbeat_ns, 64);
WADE_SHM_AT(ConsumerEntry, start_time, 72);
WADE_SHM_AT(ConsumerEntry, pid, 80);
WADE_SHM_AT(ConsumerEntry, paused, 84);
WADE_SHM_AT(ConsumerEntry, flags, 88);
WADE_SHM_AT(ConsumerEntry, left_at_frame, 96);
WADE_SHM_AT(ConsumerEntry, name, 128);
WADE_SHM_AT(ConsumerEntry, reason_code, 192);
WADE_SHM_AT(ConsumerEntry, reason_text, 200);
static_assert(sizeof(ConsumerEntry) == page_bytes);

WADE_SHM_AT(SlotDescriptor, sequence, 0);
WADE_SHM_AT(SlotDescriptor, frame, 8);
WADE_SHM_AT(SlotDescriptor, tick, 16);
WADE_SHM_AT(SlotDescriptor, count, 24);
WADE_SHM_AT(SlotDescriptor, flags, 28);
WADE_SHM_AT(SlotDescriptor, hash, 32);
WADE_SHM_AT(SlotDescriptor, previous_hash, 40);
WADE_SHM_AT(SlotDescriptor, crc32c, 48);
WADE_SHM_AT(SlotDescriptor, reserved, 52);
WADE_SHM_AT(SlotDescriptor, further_hash, 56);
WADE_SHM_AT(SlotDescriptor, diagnostics, 64);
static_assert(sizeof(SlotDescriptor) == 256);
#undef WADE_SHM_AT

static_assert(std::numeric_limits<float>::is_iec559 && std::numeric_limits<double>::is_iec559);
static_assert(std::is_trivially_copyable_v<Header> && std::is_standard_layout_v<Header>);
static_assert(std::is_trivially_copyable_v<Control> && std::is_standard_layout_v<Control>);
static_assert(std::is_trivially_copyable_v<ConsumerEntry> && std::is_standard_layout_v<ConsumerEntry>);
static_assert(std::is_trivially_copyable_v<SlotDescriptor> && std::is_standard_layout_v<SlotDescriptor>);

}  // namespace wade::shm
