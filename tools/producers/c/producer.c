// c_producer: plays the known stream of tools/producers/README.md. Plain C11 and libc in one file, written from
// docs/protocol.md ("the contract"). To make it yours, replace fill_frame() and the options.
//
//   cc -std=c11 -O2 producer.c -o c_producer -lm
//
// First the bytes of a segment, then the producer.
#define _GNU_SOURCE  // F_OFD_SETLK
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <limits.h>
#include <linux/futex.h>
#include <math.h>
#include <sched.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

// The bytes of a segment, contract 1.2.
//
// Words that both sides use are _Atomic members: using one by name is sequentially consistent in C11, which is at least
// what the contract asks for, on every machine that has lock-free atomics (x86-64, aarch64, ...); lock-free ones also
// work between processes.
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
    uint64_t hash, previous_hash;
    uint32_t crc32c, reserved[3];                                              // of all from `frame` on
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
_Static_assert(offsetof(struct descriptor, crc32c) == 48 && offsetof(struct descriptor, sub_steps) == 64 &&
                   sizeof(struct descriptor) == 256,
               "slot descriptor");
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
    struct header h = {.version_major = 1, .version_minor = 2, .endian_tag = 0x01020304, .header_bytes = page};
    h.stream_kind = 1;
    h.capacity = capacity;
    h.depth = depth;
    h.slot_count = depth + 1;
    h.ticks_per_second = 30;
    h.ticks_per_frame = 1;
    h.metres_per_unit = 1;
    h.particle_radius = 0.4642 / 2;
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

enum exit_code { unexpected = 1, usage, attach_timeout, peer_dead, peer_aborted, violation, step_timeout, name_in_use };
static const int64_t slice_ns = 50000000, spin_ns = 30000;

enum option { frames, particles, depth, speed, attach_timeout_s, step_timeout_s, option_count };
static struct {
    const char* name;
    double value, lowest, highest;
} options[option_count] = {
    {"--frames", 60, 1, 1e9},    {"--particles", 2000, 1, 1e7},        {"--depth", 1, 1, 63},
    {"--speed", 1.5, -100, 100}, {"--attach-timeout-s", 10, 0, 86400}, {"--step-timeout-s", 60, 0, 86400}};
static const char* session;
static uint64_t scene_hash;

static char name[256];  // of the shared-memory object
static int fd = -1;
static struct segment* segment;  // NULL while there is none
static uint64_t published, chain;
// What a consumer's words were at its admission; admitted = 0: it takes no part.
static struct {
    uint64_t admitted;
    uint32_t mode, flags;
} members[max_consumers];
static bool had_leader;
static volatile sig_atomic_t signal_received;

static void remember_signal(int number) {
    signal_received = number;
}
static uint64_t larger(uint64_t a, uint64_t b) {
    return a > b ? a : b;
}
static int64_t now_ns(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (int64_t)t.tv_sec * 1000000000 + t.tv_nsec;
}

// Notifies the consumers of a change: increments the futex word, then wakes them if any consumer sleeps on it.
static void ring(void) {
    segment->control.publish_sequence++;
    for (int i = 0; i < max_consumers; ++i) {
        if (segment->consumers[i].waiting == 0) continue;
        syscall(SYS_futex, &segment->control.publish_sequence, FUTEX_WAKE, INT_MAX, NULL, NULL, 0);
        return;
    }
}
static void enter(enum producer_state state) {
    segment->control.state = state;
    ring();
}

static bool still_named(void) {
    struct stat mine, named;
    char path[300];
    snprintf(path, sizeof path, "/dev/shm%s", name);
    return fstat(fd, &mine) == 0 && lstat(path, &named) == 0 && mine.st_ino == named.st_ino;
}
static void unlink_segment(void) {
    if (still_named()) shm_unlink(name);
}

// Ends the program; consumers that are attached learn why.
__attribute__((noreturn, format(printf, 2, 3))) static void fail(int code, const char* format, ...) {
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    for (char* c = text; *c != 0; ++c)
        if ((unsigned char)*c < 0x20 || (unsigned char)*c > 0x7E) *c = '?';  // names and reasons of others are in it
    fprintf(stderr, "c_producer: %s\n", text);
    if (segment != NULL) {
        segment->control.reason_code = code;
        memcpy(segment->control.reason_text, text, sizeof text);
        enter(aborted);
        unlink_segment();
    }
    exit(code);
}

// F_OFD_SETLK: takes the exclusive lock of one byte. The kernel drops it when its owner dies, for whatever reason.
// F_OFD_GETLK: returns true if no other process holds it.
static bool lock(int command, uint64_t byte) {
    struct flock range = {.l_type = F_WRLCK, .l_whence = SEEK_SET, .l_start = (off_t)byte, .l_len = 1};
    return fcntl(fd, command, &range) == 0 && (command == F_OFD_SETLK || range.l_type == F_UNLCK);
}

// Creates the object exclusively and locks it before it sets the size. Unlinks an older object if its producer is dead.
static void create_segment(uint64_t bytes) {
    for (int round = 0; round < 100; ++round) {  // each lost round means that another process made progress
        if (fd >= 0) close(fd);
        fd = shm_open(name, O_CREAT | O_EXCL | O_RDWR, 0600);
        if (fd >= 0) {
            if (!lock(F_OFD_SETLK, 0) || !still_named()) continue;
            int error = EINTR;
            while (error == EINTR) error = posix_fallocate(fd, 0, (off_t)bytes);
            if (error == 0) return;
            unlink_segment();
            fail(unexpected, "Cannot allocate %" PRIu64 " bytes for %s: %s; see 'df /dev/shm'.", bytes, name,
                 strerror(error));
        }
        if (errno != EEXIST) fail(unexpected, "Cannot create %s: %s.", name, strerror(errno));
        fd = shm_open(name, O_RDWR | O_NONBLOCK, 0);  // it may be a FIFO
        if (fd < 0 && errno == ENOENT) continue;
        if (fd < 0 && errno != EACCES) fail(name_in_use, "Cannot open %s: %s.", name, strerror(errno));
        struct stat about;
        if (fd >= 0 && fstat(fd, &about) == 0 && !S_ISREG(about.st_mode))
            fail(name_in_use, "The name %s leads to no plain file; choose another session name.", name);
        if (fd < 0 || fstat(fd, &about) != 0 || about.st_uid != geteuid())
            fail(name_in_use, "The segment %s belongs to another user; choose another session name.", name);
        if (lock(F_OFD_SETLK, 0))
            unlink_segment();
        else if (still_named())
            fail(name_in_use, "The segment %s is in use by a living producer; choose another session name.", name);
    }
    fail(name_in_use, "The name %s is fought over by other producers.", name);
}

static uint32_t crc32c(const void* bytes, size_t count) {
    uint32_t crc = 0xFFFFFFFF;
    for (size_t i = 0; i < count; ++i) {
        crc ^= ((const unsigned char*)bytes)[i];
        for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (0x82F63B78 & (0U - (crc & 1)));
    }
    return ~crc;
}

// Field 22 of /proc/self/stat; the program's name, field 2, may hold spaces and parentheses.
static uint64_t process_start_time(void) {
    char line[1024];
    FILE* file = fopen("/proc/self/stat", "r");
    const size_t bytes = file != NULL ? fread(line, 1, sizeof line - 1, file) : 0;
    if (file != NULL) fclose(file);
    line[bytes] = 0;
    const char* place = strrchr(line, ')');
    for (int spaces = 0; place != NULL && spaces < 20; ++spaces) place = strchr(place + 1, ' ');
    return place != NULL ? strtoull(place, NULL, 10) : 0;
}

static void open_stream(void) {
    snprintf(name, sizeof name, "/%s-fluid", session);
    struct header h = new_header((uint64_t)options[particles].value, (uint32_t)options[depth].value, "c_producer");
    h.scene_hash = scene_hash;
    while (h.session_id == 0 && (getrandom(&h.session_id, sizeof h.session_id, 0) >= 0 || errno == EINTR)) continue;
    uint64_t magic;
    memcpy(&magic, "WADESHM1", sizeof magic);
    h.magic = magic;  // the checksum is that of the finished page
    h.crc32c = crc32c(&h, sizeof h);
    h.magic = 0;

    create_segment(h.total_bytes);
    void* const base = mmap(NULL, h.total_bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_POPULATE, fd, 0);
    if (base == MAP_FAILED) {
        unlink_segment();
        fail(unexpected, "Cannot map %s: %s.", name, strerror(errno));
    }
    segment = base;
    segment->control.pid = (uint32_t)getpid();
    segment->control.start_time = process_start_time();
    segment->control.heartbeat_ns = (uint64_t)now_ns();
    segment->control.state = ready;
    memcpy(base, &h, sizeof h);
    segment->header.magic = magic;  // last: from now on others read the page
}

// What the consumers allow.
struct census {
    int leaders;       // admitted, in lockstep, and not merely following
    uint64_t slowest;  // frame that all in lockstep have released
    bool paused;       // one that is behind pauses on purpose
};

// Reads all consumer pages. Admits consumers that ask to join at frame admit_at (0: none).
static struct census survey(uint64_t admit_at, uint64_t owed) {
    struct census census = {.slowest = UINT64_MAX};
    for (int i = 0; i < max_consumers; ++i) {
        struct consumer* const c = &segment->consumers[i];
        const uint32_t state = c->state;
        const bool member = members[i].admitted != 0;
        const uint32_t mode = member ? members[i].mode : c->mode;
        const bool admit = state == joined && mode <= latest && !member && admit_at != 0;
        // A goodbye counts once the lock is free, because any process may have written the state. The producer does not
        // wait for a free-running reader, and the end of such a reader is a goodbye, whatever its reason.
        const bool goodbye = state == left || (state == gave_up && mode == latest);
        const bool gone = member && goodbye && lock(F_OFD_GETLK, 1 + (uint64_t)i);
        if (admit || gone) {
            members[i].admitted = admit ? admit_at : 0;  // 0: the page may be taken again
            members[i].mode = mode;
            members[i].flags = c->flags;
            segment->control.admitted_frame[i] = members[i].admitted;
            ring();
        }
        if (mode != lockstep || gone) continue;
        if (member && (c->mode != mode || c->flags != members[i].flags || state < joined || state > gave_up))
            fail(violation, "The page of consumer '%.63s' (process %u) was overwritten: state %u, mode %u, flags %u.",
                 c->name, c->pid, state, c->mode, c->flags);
        const bool before_start = published == 0 && !had_leader;
        if ((state == gave_up && (member || before_start)) || (state == refused && before_start))
            fail(peer_aborted, "Consumer '%.63s' (process %u) gave up: %.300s", c->name, c->pid, c->reason_text);
        if (members[i].admitted == 0) continue;
        const uint64_t acknowledged = c->acknowledged_frame, released = larger(acknowledged, members[i].admitted - 1);
        if (acknowledged > published)
            fail(violation, "Consumer '%.63s' (process %u) acknowledged frame %" PRIu64 ", only %" PRIu64 " exist.",
                 c->name, c->pid, acknowledged, published);
        if ((members[i].flags & consumer_follows) == 0) ++census.leaders;
        if (released < census.slowest) census.slowest = released;
        if (released < owed && c->paused != 0) census.paused = true;
    }
    had_leader = had_leader || census.leaders > 0;
    return census;
}

// Fails if a consumer in lockstep has died: its lock is free, it said no goodbye and has not released frame `owed`.
static void check_alive(uint64_t owed) {
    for (int i = 0; i < max_consumers; ++i) {
        struct consumer* const c = &segment->consumers[i];
        if (members[i].admitted == 0 || members[i].mode != lockstep || !lock(F_OFD_GETLK, 1 + (uint64_t)i)) continue;
        if (c->state != joined) continue;  // a goodbye comes before the lock is dropped
        const uint64_t next = larger(c->acknowledged_frame + 1, members[i].admitted);
        if (next <= owed)
            fail(peer_dead, "Consumer '%.63s' (process %u) died at frame %" PRIu64 ".", c->name, c->pid, next);
    }
}

static void check_signal(void) {
    if (signal_received != 0)
        fail(128 + signal_received, "Interrupted by signal %d after frame %" PRIu64 ".", signal_received, published);
}

// Waits until all in lockstep have released frame `owed`; before the start (owed = 0) until there is one that leads.
// Spins briefly (not at all on one CPU), then sleeps on the doorbell in slices and looks around after each.
static struct census wait_for_consumers(bool start, uint64_t admit_at, uint64_t owed) {
    const double limit_s = start ? options[attach_timeout_s].value : options[step_timeout_s].value;
    double spent_s = 0;
    cpu_set_t cpus;
    const bool alone = sched_getaffinity(0, sizeof cpus, &cpus) == 0 && CPU_COUNT(&cpus) == 1;
    const int64_t begin = now_ns();
    struct census census;
    do {
        census = survey(admit_at, owed);
        if (start ? census.leaders > 0 : census.slowest >= owed) return census;
    } while (!alone && now_ns() - begin < spin_ns);

    segment->control.producer_waiting = 1;  // flag, futex word, another look, sleep: this order loses no wake-up
    for (int64_t last = now_ns();;) {
        const uint32_t seen = segment->doorbell.consumer_sequence;
        census = survey(admit_at, owed);
        if (start ? census.leaders > 0 : census.slowest >= owed) break;
        const struct timespec slice = {0, slice_ns};
        const long woken = syscall(SYS_futex, &segment->doorbell.consumer_sequence, FUTEX_WAIT, seen, &slice, NULL, 0);
        const bool changed = woken == 0 || errno == EAGAIN;
        const int64_t passed = now_ns() - last;
        check_signal();
        if (changed && passed < slice_ns) continue;
        last += passed;
        segment->control.heartbeat_ns = (uint64_t)last;
        check_alive(start ? admit_at : owed);
        // Time does not count while this process is stopped or a consumer that it waits for pauses.
        if (!census.paused) spent_s += 1e-9 * (double)(passed > 4 * slice_ns ? slice_ns : passed);
        if (limit_s <= 0 || spent_s < limit_s) continue;
        if (start) fail(attach_timeout, "Waited %g s in vain for a consumer of session '%s'.", limit_s, session);
        fail(step_timeout, "Waited %g s in vain for the consumers to release frame %" PRIu64 ".", limit_s, owed);
    }
    segment->control.producer_waiting = 0;
    return census;
}

static uint64_t mix(uint64_t z) {
    z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9;
    z = (z ^ z >> 27) * 0x94D049BB133111EB;
    return z ^ z >> 31;
}
static uint64_t chain_hash(uint64_t previous, uint64_t frame, uint32_t count, float* const* fields) {
    uint64_t h = mix(mix(mix(previous + 0x9E3779B97F4A7C15) ^ frame) ^ count);
    for (int i = 0; i < field_count; ++i) {
        uint64_t sum = 0;
        for (uint32_t k = 0; k < count; ++k) {
            uint32_t w;
            memcpy(&w, &fields[i][k], sizeof w);
            sum += (uint64_t)(w + 0x9E3779B1 * (k + 1)) * ((w << 16 | w >> 16) ^ 0x85EBCA77 * (k + 1));
        }
        h = mix(h ^ sum);
    }
    return h != 0 ? h : 1;
}

// The known stream: all steps in double precision, each value rounded to float32 once.
static uint32_t fill_frame(uint64_t frame, float* const* fields) {
    enum { rows = 50 };
    const uint32_t count = (uint32_t)options[particles].value;
    const double spacing = 0.4642, length = 100, travelled = options[speed].value * (double)frame / 30;
    for (uint32_t k = 0; k < count; ++k) {
        const double x = 60 + k / rows * spacing - travelled;
        fields[0][k] = 100;                                      // mass, kg
        fields[1][k] = (float)-options[speed].value;             // vx, m/s
        fields[2][k] = fields[3][k] = 0;                         // vy, vz
        fields[4][k] = (float)(x - length * floor(x / length));  // px, m
        fields[5][k] = (float)0.23;                              // py
        fields[6][k] = (float)(12 + k % rows * spacing);         // pz
    }
    return count;
}

// One frame, the left column of "One frame" in the contract. False: only followers are left, the stream ends.
static bool publish_frame(void) {
    const struct header* const h = &segment->header;
    const uint64_t frame = published + 1, slot = (frame - 1) % h->slot_count;
    segment->control.heartbeat_ns = (uint64_t)now_ns();
    if (frame == 1) enter(running);
    if (wait_for_consumers(false, frame, frame > h->depth ? frame - h->depth : 0).leaders == 0) return false;

    struct descriptor* const d = &segment->descriptors[slot];
    d->sequence = 2 * frame - 1;
    atomic_thread_fence(memory_order_release);  // a free-running reader that sees what follows sees this word, too
    float* fields[field_count];
    for (int i = 0; i < field_count; ++i)
        fields[i] = (void*)((char*)segment + h->slots_offset + slot * h->slot_stride + h->fields[i].offset);
    d->frame = d->tick = frame;
    d->count = fill_frame(frame, fields);
    d->flags = frame == (uint64_t)options[frames].value ? frame_final : 0;
    d->previous_hash = chain;
    d->hash = chain = chain_hash(chain, frame, d->count, fields);
    d->last_dt_s = d->mean_density_error = d->max_density_error = d->mean_depth_m = d->mean_speed_m_s = NAN;
    d->kinetic_energy_j = d->potential_energy_j = d->driving_acceleration_m_s2 = NAN;  // not given
    d->crc32c = 0;
    d->crc32c = crc32c(&d->frame, sizeof *d - offsetof(struct descriptor, frame));
    d->sequence = 2 * frame;
    segment->control.published_frame = published = frame;
    segment->control.heartbeat_ns = (uint64_t)now_ns();
    if (d->flags == frame_final) segment->control.state = draining;
    ring();
    return true;
}

// Numbers from lowest to highest, whole ones where the name of the option is that of a count.
static bool set_option(const char* option, const char* text) {
    char* end = NULL;
    for (unsigned i = 0; i < option_count; ++i) {
        if (strcmp(option, options[i].name) != 0) continue;
        const double value = options[i].value = strtod(text, &end);
        const bool in_range = value >= options[i].lowest && value <= options[i].highest;
        if (end != text && *end == 0 && in_range && (i >= speed || value == floor(value))) return true;
        fail(usage, "%s: %s is not allowed; allowed: %snumbers from %g to %g.", option, text, i < speed ? "whole " : "",
             options[i].lowest, options[i].highest);
    }
    if (strcmp(option, "--scene-hash") == 0) {
        scene_hash = strtoull(text, &end, 16);
        if (strspn(text, "0123456789abcdefABCDEF") == strlen(text) && end != text && strlen(text) <= 16) return true;
        fail(usage, "--scene-hash: %s is not allowed; allowed: 1 to 16 hexadecimal digits.", text);
    }
    if (strcmp(option, "--session") == 0) session = text;
    return session == text;
}

static void read_command_line(int argc, char** argv) {
    for (int i = 1, scenes = 0; i < argc; ++i) {
        if (strcmp(argv[i], "--help") == 0) {
            puts(
                "Usage: c_producer [SCENE.json] --session NAME [--frames N] [--particles N] [--speed V] [--depth D]\n"
                "       [--scene-hash HEX] [--attach-timeout-s T] [--step-timeout-s T]\n"
                "Plays the known stream of tools/producers/README.md; the scene file is not read.");
            exit(0);
        }
        if (argv[i][0] != '-' && scenes++ == 0) continue;
        if (i + 1 == argc || !set_option(argv[i], argv[i + 1]))
            fail(usage, "%s: unknown, or its value is missing (--help shows the options).", argv[i]);
        ++i;
    }
    const char* const allowed = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-";
    if (session == NULL || *session == 0 || strlen(session) > 200 || strspn(session, allowed) != strlen(session))
        fail(usage, "--session: \"%s\" is not allowed; allowed: 1 to 200 letters, digits, '.', '_' and '-'.",
             session == NULL ? "" : session);
}

int main(int argc, char** argv) {
    read_command_line(argc, argv);
    struct sigaction action = {.sa_handler = remember_signal};
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    signal(SIGXFSZ, SIG_IGN);  // a segment larger than 'ulimit -f' allows is an error of the allocation
    open_stream();
    wait_for_consumers(true, 1, 0);
    while (published < (uint64_t)options[frames].value && publish_frame()) check_signal();
    enter(draining);
    wait_for_consumers(false, 0, published);
    enter(closed);
    unlink_segment();
    return 0;
}
