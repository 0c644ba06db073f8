/* The shared-memory contract for languages that cannot do atomics: a C ABI over the C++ ends (libwade_shm.so).
 *
 *   wade_stream stream;                                       wade_subscriber* s;
 *   wade_stream_defaults(&stream);                            wade_frame f;
 *   strcpy(stream.producer_name, "mine");                     wade_subscriber_open("demo", "crowd", NULL, &s);
 *   stream.capacity = 1000;                                   while (wade_subscriber_acquire(s, &f) == WADE_OK) {
 *   wade_publisher* p;                                            ... read f.px[i] in place ...
 *   wade_slot slot;                                               wade_subscriber_release(s);
 *   wade_publisher_open("demo", &stream, NULL, &p);           }
 *   wade_publisher_wait_for_consumers(p, 1);                  wade_subscriber_free(s);
 *   while (wade_publisher_begin_frame(p, &slot) == WADE_OK) {
 *       ... write slot.px[i] in place ...
 *       wade_publisher_end_frame(p, count, NULL, final);
 *   }
 *   wade_publisher_close(p);
 *   wade_publisher_free(p);
 *
 * Every function that returns int gives WADE_OK, WADE_END, WADE_NOTHING_NEW or the exit code of the failure, whose text
 * is wade_last_error(). A handle is used by one thread at a time. The structs mirror stream.hpp and layout.hpp member
 * by member; docs/protocol.md tells units and ranges. */
#ifndef WADE_SHM_H
#define WADE_SHM_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define WADE_ABI_VERSION 2 /* rises when a struct or a signature changes */

enum wade_result {
    WADE_NOTHING_NEW = -2, /* wade_latest_poll: no newer frame at the moment */
    WADE_END = -1,         /* no frame any more: the stream, or the last consumer's part in it, has ended well */
    WADE_OK = 0,
    WADE_UNEXPECTED = 1, /* for example a full /dev/shm */
    WADE_USAGE = 2,      /* an argument out of range, a call at the wrong moment */
    WADE_ATTACH_TIMEOUT = 3,
    WADE_PEER_DEAD = 4,
    WADE_PEER_ABORTED = 5,
    WADE_PROTOCOL_VIOLATION = 6,
    WADE_STEP_TIMEOUT = 7,
    WADE_NAME_IN_USE = 8,
    WADE_INTERRUPTED = 130
};
enum wade_kind { WADE_FLUID = 1, WADE_AGENTS = 2 };

typedef struct wade_publisher wade_publisher;
typedef struct wade_subscriber wade_subscriber;
typedef struct wade_latest wade_latest;

typedef struct wade_stream { /* StreamInfo */
    char producer_name[64];
    uint32_t kind;
    uint32_t capacity; /* 0 by default, must be set */
    uint32_t depth;
    uint32_t slots; /* 0 = depth + 1 */
    uint64_t ticks_per_second;
    uint64_t ticks_per_frame;
    double metres_per_unit;
    double origin[3];
    int32_t axes[3];
    uint32_t coupling_lag;
    double particle_radius;
    double rest_density;
    uint64_t scene_hash;
    uint64_t session_id;   /* output only */
    uint32_t hash_frames;  /* 1 or 0 */
    uint32_t group_access; /* 0 or 1 */
    /* Depth-averaged water: width of the columns along world x and z, m, at most 2; 0, 0 = points. See wade_columns(). */
    double column_width[2];
} wade_stream;

typedef struct wade_waiting { /* Waiting */
    double attach_timeout_s;
    double step_warning_s;
    double step_timeout_s;
    int (*interrupted)(void* context);             /* polled while waiting, not 0 = stop; may be NULL */
    void (*warn)(const char* text, void* context); /* may be NULL */
    void* context;
} wade_waiting;

typedef struct wade_join { /* JoinOptions */
    uint64_t scene_hash;
    uint32_t kind;
    uint32_t follows;
    uint32_t group_access;
    uint32_t reserved;
    wade_waiting waiting;
} wade_join;

typedef struct wade_diagnostics { /* Diagnostics; not given: 0 for an integer, NaN for a double */
    uint32_t sub_steps, density_iterations, divergence_iterations, reserved0;
    double last_dt_s, mean_density_error, max_density_error;
    uint64_t solver_ns;
    double mean_depth_m, mean_speed_m_s, kinetic_energy_j, potential_energy_j, driving_acceleration_m_s2;
    uint64_t position_clamps, recycled_particles, resident_bytes;
    double taken_by_people_x_n_s, taken_by_people_z_n_s, missing_for_people_x_n_s, missing_for_people_z_n_s;
    uint64_t reserved[6];
} wade_diagnostics;

typedef struct wade_slot { /* arrays of `capacity` values to be filled; the last three for agents only, else NULL */
    uint64_t frame;
    uint64_t capacity;
    float *mass, *vx, *vy, *vz, *px, *py, *pz, *radius, *height, *state;
} wade_slot;

typedef struct wade_frame { /* arrays of `count` values; the last three for agents only, else NULL */
    uint64_t frame;
    uint64_t tick;
    uint64_t hash;
    uint32_t count;
    uint32_t final; /* 1 = no frame follows */
    const float *mass, *vx, *vy, *vz, *px, *py, *pz, *radius, *height, *state;
    wade_diagnostics diagnostics;
} wade_frame;

/* What people do to the water, beside wade_slot or wade_frame: N s of the frame's interval along x and z, how deep they are
 * in the water, over which radius the impulse is spread. All NULL where the stream of agents has none. */
typedef struct wade_slot_impulses {
    float *jx, *jz, *submerged, *spread;
} wade_slot_impulses;

typedef struct wade_frame_impulses {
    const float *jx, *jz, *submerged, *spread;
} wade_frame_impulses;

/* Depth-averaged water of one moment on a regular grid. Values of cell (i, j) stand at j * nx + i; its lower corner is
 * (x_min + i * cell_x, z_min + j * cell_z) in world metres. */
typedef struct wade_grid {
    double x_min, z_min;   /* m */
    double cell_x, cell_z; /* m, above 0; cells wider than 2 m are divided into equal columns */
    uint32_t nx, nz;
    const double* depth; /* m; NaN or at most 0.001 = dry, no column */
    const double *u, *v; /* m/s along world x and z, read where there is water */
    const double* bed;   /* height of the bed, m, read where there is water; NULL = 0 */
} wade_grid;

uint32_t wade_abi_version(void);
const char* wade_last_error(void); /* of this thread, "" = none; valid until its next failure */

/* All waits of this process end with WADE_INTERRUPTED from now on, within 50 ms; may be called by a signal handler. */
void wade_interrupt(void);
void wade_clear_interrupt(void);

void wade_stream_defaults(wade_stream* stream);
void wade_waiting_defaults(wade_waiting* waiting);
void wade_join_defaults(wade_join* join);
void wade_diagnostics_defaults(wade_diagnostics* diagnostics);

/* waiting, join and diagnostics may be NULL for the defaults. On failure *out is NULL. */
int wade_publisher_open(const char* session, const wade_stream* stream, const wade_waiting* waiting,
                        wade_publisher** out);
/* A stream of agents (kind = WADE_AGENTS) with impulses. */
int wade_publisher_open_with_impulses(const char* session, const wade_stream* stream, const wade_waiting* waiting,
                                      wade_publisher** out);
int wade_publisher_stream(const wade_publisher* publisher, wade_stream* out);
int wade_publisher_wait_for_consumers(wade_publisher* publisher, int n);
int wade_publisher_begin_frame(wade_publisher* publisher, wade_slot* out);
/* Of the slot that was begun last. */
int wade_publisher_impulses(const wade_publisher* publisher, wade_slot_impulses* out);
int wade_publisher_end_frame(wade_publisher* publisher, uint32_t count, const wade_diagnostics* diagnostics, int final);
int wade_publisher_end_frame_at(wade_publisher* publisher, uint32_t count, const wade_diagnostics* diagnostics,
                                int final, uint64_t tick);
int wade_publisher_heartbeat(wade_publisher* publisher);
int wade_publisher_set_paused(wade_publisher* publisher, int paused);
/* Sets capacity, column_width and, where it is 0, rest_density of a stream for this grid, before the publisher opens. */
int wade_columns_stream(const wade_grid* grid, wade_stream* stream);
/* Writes the columns of a grid into a slot that was begun; *count = their number, for wade_publisher_end_frame(). */
int wade_columns(const wade_grid* grid, const wade_stream* stream, const wade_slot* slot, uint32_t* count);
uint64_t wade_publisher_published_frames(const wade_publisher* publisher);
uint64_t wade_publisher_frame_hash(const wade_publisher* publisher);
int wade_publisher_close(wade_publisher* publisher);
int wade_publisher_abort(wade_publisher* publisher, int reason_code, const char* text);
void wade_publisher_free(wade_publisher* publisher); /* aborts the stream if it was not closed */

int wade_subscriber_open(const char* session, const char* name, const wade_join* join, wade_subscriber** out);
/* Tells the producer that this consumer will not take part, and why: its wait for consumers ends. */
int wade_subscriber_refuse(const char* session, const char* name, const wade_join* join, int reason_code,
                           const char* text);
int wade_subscriber_stream(const wade_subscriber* subscriber, wade_stream* out);
int wade_subscriber_acquire(wade_subscriber* subscriber, wade_frame* out);
/* Of the frame that was acquired last, valid as long as it is. */
int wade_subscriber_impulses(const wade_subscriber* subscriber, wade_frame_impulses* out);
int wade_subscriber_release(wade_subscriber* subscriber);
int wade_subscriber_heartbeat(wade_subscriber* subscriber);
int wade_subscriber_set_paused(wade_subscriber* subscriber, int paused);
int wade_subscriber_leave(wade_subscriber* subscriber);
int wade_subscriber_abort(wade_subscriber* subscriber, int reason_code, const char* text);
void wade_subscriber_free(wade_subscriber* subscriber); /* counts as giving up before the end */

/* The arrays of a frame are copies, valid until the next call for a frame. */
int wade_latest_open(const char* session, const char* name, const wade_join* join, uint32_t stride, wade_latest** out);
int wade_latest_stream(const wade_latest* reader, wade_stream* out);
int wade_latest_next(wade_latest* reader, wade_frame* out);
int wade_latest_poll(wade_latest* reader, wade_frame* out);
uint64_t wade_latest_dropped_frames(const wade_latest* reader);
int wade_latest_leave(wade_latest* reader);
void wade_latest_free(wade_latest* reader);

#ifdef __cplusplus
}
#endif
#endif
