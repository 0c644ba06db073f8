// The producer's part of libwade_shm.so for Node: a thin N-API addon. JavaScript sees
//
//   open(session, { capacity, depth, producerName, sceneHash, particleRadius, columnWidth, attachTimeoutS, stepTimeoutS })
//       -> publisher
//   columnStream(grid) -> { capacity, columnWidth } of open for depth-averaged water on this grid
//   columns(publisher, grid) -> count, once the columns of the grid stand in the frame that was begun last
//   waitForConsumers(publisher, n)
//   beginFrame(publisher) -> { frame, mass, vx, vy, vz, px, py, pz } or null when the stream should end
//   endFrame(publisher, count, final, account), close(publisher), abort(publisher, code, text), frameHash(publisher)
//   joinPeople(session, { attachTimeoutS, stepTimeoutS }) -> people, coupling_lag in people.lag
//   takePeople(people) -> { count, px, pz, jx, jz, submerged, spread }, the last four null if no agent pushes, or null
//                         when the crowd has ended
//   leavePeople(people)
//   catchSignals(), receivedSignal()
//
// grid: { xMin, zMin, cellX, cellZ, nx, nz, depth, u, v, bed }, as wade_grid; the last four Float64Arrays, bed may be missing.
// account: null, or [taken x, taken z, missing x, missing z] by people since the start, N s.
// The arrays of a frame are Float32Arrays over the shared memory itself; close and abort detach them. Waits block the
// event loop: a solver that also serves requests belongs in a worker thread. A failure throws an Error with the
// exit code of the contract as exitCode.
#define NAPI_VERSION 8
#include <node_api.h>
#include <signal.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "wade_shm.h"

enum { max_slots = 64, field_count = 7 };
static const char* const field_names[field_count] = {"mass", "vx", "vy", "vz", "px", "py", "pz"};

enum { publisher_tag = 1, people_tag = 2 };
struct publisher {
    unsigned tag;
    wade_publisher* stream;
    wade_slot slot;               // that was begun last
    unsigned slots;               // known so far
    float* addresses[max_slots];  // of the first array of a slot
    napi_ref frames[max_slots];   // the object with its arrays, made once
};

static volatile sig_atomic_t signal_received;

static void remember_signal(int number) {
    signal_received = number;
    wade_interrupt();
}

static napi_value throw_failure(napi_env env, int code, const char* text) {
    napi_value error, message, number;
    napi_create_string_utf8(env, text, NAPI_AUTO_LENGTH, &message);
    napi_create_error(env, NULL, message, &error);
    napi_create_int32(env, code, &number);
    napi_set_named_property(env, error, "exitCode", number);
    napi_throw(env, error);
    return NULL;
}
static napi_value done(napi_env env, int result) {
    return result == WADE_OK ? NULL : throw_failure(env, result, wade_last_error());
}

// Arguments of a call, the first one a publisher that is still open. False: an error was thrown.
static bool read_call(napi_env env, napi_callback_info info, size_t count, napi_value* arguments,
                      struct publisher** p) {
    size_t given = count;
    napi_get_cb_info(env, info, &given, arguments, NULL, NULL);
    napi_valuetype type = napi_undefined;
    if (given >= count) napi_typeof(env, arguments[0], &type);
    if (type == napi_external && napi_get_value_external(env, arguments[0], (void**)p) == napi_ok &&
        (*p)->tag == publisher_tag && (*p)->stream != NULL)
        return true;
    throw_failure(env, WADE_USAGE, "The first argument must be a publisher that is open; the others are required.");
    return false;
}

// Frees the stream; nothing can reach its memory any more through arrays that JavaScript still holds.
static void free_stream(napi_env env, struct publisher* p) {
    for (unsigned s = 0; s < p->slots; ++s) {
        napi_value frame, array, buffer;
        if (napi_get_reference_value(env, p->frames[s], &frame) != napi_ok || frame == NULL) continue;
        for (unsigned i = 0; i < field_count; ++i) {
            if (napi_get_named_property(env, frame, field_names[i], &array) == napi_ok &&
                napi_get_typedarray_info(env, array, NULL, NULL, NULL, &buffer, NULL) == napi_ok)
                napi_detach_arraybuffer(env, buffer);
        }
        napi_delete_reference(env, p->frames[s]);
    }
    p->slots = 0;
    wade_publisher_free(p->stream);
    p->stream = NULL;
}
static void finalize(napi_env env, void* data, void* hint) {
    (void)env, (void)hint;
    struct publisher* const p = data;
    if (p->stream != NULL) wade_publisher_free(p->stream);
    free(p);
}

static double number_property(napi_env env, napi_value object, const char* name, double otherwise) {
    napi_value value;
    double number = otherwise;
    if (napi_get_named_property(env, object, name, &value) == napi_ok) napi_get_value_double(env, value, &number);
    return number;
}

// columnWidth: [x, z], m.
static void read_column_width(napi_env env, napi_value options, double width[2]) {
    napi_value array, value;
    bool is_array = false;
    if (napi_get_named_property(env, options, "columnWidth", &array) != napi_ok ||
        napi_is_array(env, array, &is_array) != napi_ok || !is_array)
        return;
    for (uint32_t i = 0; i < 2; ++i)
        if (napi_get_element(env, array, i, &value) == napi_ok) napi_get_value_double(env, value, &width[i]);
}

static napi_value open_publisher(napi_env env, napi_callback_info info) {
    size_t count = 2;
    napi_value arguments[2], property, result;
    napi_get_cb_info(env, info, &count, arguments, NULL, NULL);
    wade_stream stream;
    wade_waiting waiting;
    wade_stream_defaults(&stream);
    wade_waiting_defaults(&waiting);
    char session[256];
    if (count < 2 || napi_get_value_string_utf8(env, arguments[0], session, sizeof session, NULL) != napi_ok)
        return throw_failure(env, WADE_USAGE, "open(session, options): a name and an object are required.");
    if (napi_get_named_property(env, arguments[1], "producerName", &property) == napi_ok)
        napi_get_value_string_utf8(env, property, stream.producer_name, sizeof stream.producer_name, NULL);
    bool lossless;
    if (napi_get_named_property(env, arguments[1], "sceneHash", &property) == napi_ok)
        napi_get_value_bigint_uint64(env, property, &stream.scene_hash, &lossless);
    stream.capacity = (uint32_t)number_property(env, arguments[1], "capacity", stream.capacity);
    stream.depth = (uint32_t)number_property(env, arguments[1], "depth", stream.depth);
    stream.rest_density = 1000;
    stream.particle_radius = number_property(env, arguments[1], "particleRadius", 0);
    read_column_width(env, arguments[1], stream.column_width);
    waiting.attach_timeout_s = number_property(env, arguments[1], "attachTimeoutS", waiting.attach_timeout_s);
    waiting.step_timeout_s = number_property(env, arguments[1], "stepTimeoutS", waiting.step_timeout_s);

    struct publisher* const p = calloc(1, sizeof *p);
    if (p == NULL) return throw_failure(env, WADE_UNEXPECTED, "There is no memory left.");
    p->tag = publisher_tag;
    const int failure = wade_publisher_open(session, &stream, &waiting, &p->stream);
    if (failure == WADE_OK && napi_create_external(env, p, finalize, NULL, &result) == napi_ok) return result;
    finalize(env, p, NULL);
    return throw_failure(env, failure != WADE_OK ? failure : WADE_UNEXPECTED, wade_last_error());
}

static napi_value wait_for_consumers(napi_env env, napi_callback_info info) {
    napi_value arguments[2];
    struct publisher* p;
    if (!read_call(env, info, 2, arguments, &p)) return NULL;
    int32_t count = 1;
    napi_get_value_int32(env, arguments[1], &count);
    return done(env, wade_publisher_wait_for_consumers(p->stream, count));
}

// Creates the object of a slot at its first use: a Float32Array for each field, over the shared memory.
static napi_value new_frame(napi_env env, const wade_slot* slot) {
    float* const arrays[field_count] = {slot->mass, slot->vx, slot->vy, slot->vz, slot->px, slot->py, slot->pz};
    napi_value frame, buffer, array;
    napi_create_object(env, &frame);
    for (unsigned i = 0; i < field_count; ++i) {
        if (napi_create_external_arraybuffer(env, arrays[i], slot->capacity * sizeof(float), NULL, NULL, &buffer) !=
                napi_ok ||
            napi_create_typedarray(env, napi_float32_array, slot->capacity, buffer, 0, &array) != napi_ok ||
            napi_set_named_property(env, frame, field_names[i], array) != napi_ok)
            return throw_failure(env, WADE_UNEXPECTED, "This JavaScript engine allows no arrays over shared memory.");
    }
    return frame;
}

static napi_value begin_frame(napi_env env, napi_callback_info info) {
    napi_value argument, frame, number;
    struct publisher* p;
    if (!read_call(env, info, 1, &argument, &p)) return NULL;
    wade_slot slot;
    const int result = wade_publisher_begin_frame(p->stream, &slot);
    p->slot = slot;
    if (result == WADE_END) return napi_get_null(env, &frame) == napi_ok ? frame : NULL;
    if (result != WADE_OK) return done(env, result);
    unsigned s = 0;
    while (s < p->slots && p->addresses[s] != slot.mass) ++s;
    if (s < p->slots) {
        napi_get_reference_value(env, p->frames[s], &frame);
    } else {
        frame = new_frame(env, &slot);
        if (frame == NULL || s == max_slots) return NULL;
        napi_create_reference(env, frame, 1, &p->frames[s]);
        p->addresses[s] = slot.mass;
        p->slots = s + 1;
    }
    napi_create_int64(env, (int64_t)slot.frame, &number);
    napi_set_named_property(env, frame, "frame", number);
    return frame;
}

// NULL where the property is missing or no Float64Array of this length.
static const double* numbers_of(napi_env env, napi_value object, const char* name, size_t length) {
    napi_value array;
    napi_typedarray_type type;
    size_t given = 0;
    void* values = NULL;
    bool is_array = false;
    if (napi_get_named_property(env, object, name, &array) != napi_ok ||
        napi_is_typedarray(env, array, &is_array) != napi_ok || !is_array)
        return NULL;
    napi_get_typedarray_info(env, array, &type, &given, &values, NULL, NULL);
    return type == napi_float64_array && given == length ? values : NULL;
}

static bool has_property(napi_env env, napi_value object, const char* name) {
    napi_value value;
    napi_valuetype type = napi_undefined;
    return napi_get_named_property(env, object, name, &value) == napi_ok && napi_typeof(env, value, &type) == napi_ok &&
           type != napi_undefined && type != napi_null;
}

// The cells of a grid along an axis; 0, which the library refuses, for anything but a whole number.
static uint32_t cells_of(napi_env env, napi_value grid, const char* name) {
    const double number = number_property(env, grid, name, 0);
    return number >= 1 && number <= UINT32_MAX && number == (uint32_t)number ? (uint32_t)number : 0;
}

static wade_grid read_grid(napi_env env, napi_value object) {
    wade_grid grid = {.x_min = number_property(env, object, "xMin", 0),
                      .z_min = number_property(env, object, "zMin", 0),
                      .cell_x = number_property(env, object, "cellX", 0),
                      .cell_z = number_property(env, object, "cellZ", 0),
                      .nx = cells_of(env, object, "nx"),
                      .nz = cells_of(env, object, "nz")};
    const size_t cells = (size_t)grid.nx * grid.nz;
    grid.depth = numbers_of(env, object, "depth", cells);
    grid.u = numbers_of(env, object, "u", cells);
    grid.v = numbers_of(env, object, "v", cells);
    grid.bed = numbers_of(env, object, "bed", cells);
    return grid;
}

static napi_value column_stream(napi_env env, napi_callback_info info) {
    size_t count = 1;
    napi_value argument, result, width, value;
    napi_get_cb_info(env, info, &count, &argument, NULL, NULL);
    const wade_grid grid = read_grid(env, argument);
    wade_stream stream;
    wade_stream_defaults(&stream);
    const int failure = wade_columns_stream(&grid, &stream);
    if (failure != WADE_OK) return done(env, failure);
    napi_create_object(env, &result);
    napi_create_uint32(env, stream.capacity, &value);
    napi_set_named_property(env, result, "capacity", value);
    napi_create_array_with_length(env, 2, &width);
    for (uint32_t i = 0; i < 2; ++i) {
        napi_create_double(env, stream.column_width[i], &value);
        napi_set_element(env, width, i, value);
    }
    napi_set_named_property(env, result, "columnWidth", width);
    return result;
}

static napi_value write_columns(napi_env env, napi_callback_info info) {
    napi_value arguments[2], result;
    struct publisher* p;
    if (!read_call(env, info, 2, arguments, &p)) return NULL;
    const wade_grid grid = read_grid(env, arguments[1]);
    if (grid.depth == NULL || grid.u == NULL || grid.v == NULL ||
        (grid.bed == NULL && has_property(env, arguments[1], "bed")))
        return throw_failure(env, WADE_USAGE,
                             "columns(publisher, grid): depth, u, v and bed must be Float64Arrays of nx * nz values.");
    wade_stream stream;
    uint32_t count = 0;
    int failure = wade_publisher_stream(p->stream, &stream);
    if (failure == WADE_OK) failure = wade_columns(&grid, &stream, &p->slot, &count);
    if (failure != WADE_OK) return done(env, failure);
    napi_create_uint32(env, count, &result);
    return result;
}

// The account of what people took; without one the diagnostics say nothing of them.
static void read_account(napi_env env, napi_value array, wade_diagnostics* d) {
    double* const sums[] = {&d->taken_by_people_x_n_s, &d->taken_by_people_z_n_s, &d->missing_for_people_x_n_s,
                            &d->missing_for_people_z_n_s};
    wade_diagnostics_defaults(d);
    bool is_array = false;
    if (napi_is_array(env, array, &is_array) != napi_ok || !is_array) return;
    for (uint32_t i = 0; i < 4; ++i) {
        napi_value value;
        if (napi_get_element(env, array, i, &value) == napi_ok) napi_get_value_double(env, value, sums[i]);
    }
}

static napi_value end_frame(napi_env env, napi_callback_info info) {
    napi_value arguments[4];
    struct publisher* p;
    if (!read_call(env, info, 4, arguments, &p)) return NULL;
    uint32_t count = 0;
    bool final = false;
    if (napi_get_value_uint32(env, arguments[1], &count) != napi_ok ||
        napi_get_value_bool(env, arguments[2], &final) != napi_ok)
        return throw_failure(env, WADE_USAGE,
                             "endFrame(publisher, count, final, account): a number and a boolean are required.");
    wade_diagnostics diagnostics;
    read_account(env, arguments[3], &diagnostics);
    p->slot = (wade_slot){0};
    return done(env, wade_publisher_end_frame(p->stream, count, &diagnostics, final));
}

static napi_value close_publisher(napi_env env, napi_callback_info info) {
    napi_value argument;
    struct publisher* p;
    if (!read_call(env, info, 1, &argument, &p)) return NULL;
    const int result = wade_publisher_close(p->stream);
    if (result == WADE_OK) free_stream(env, p);
    return done(env, result);
}

static napi_value abort_publisher(napi_env env, napi_callback_info info) {
    napi_value arguments[3];
    struct publisher* p;
    if (!read_call(env, info, 3, arguments, &p)) return NULL;
    int32_t code = WADE_UNEXPECTED;
    char text[512] = "";
    napi_get_value_int32(env, arguments[1], &code);
    napi_get_value_string_utf8(env, arguments[2], text, sizeof text, NULL);
    const int result = wade_publisher_abort(p->stream, code, text);
    free_stream(env, p);
    return done(env, result);
}

static napi_value frame_hash(napi_env env, napi_callback_info info) {
    napi_value argument, result;
    struct publisher* p;
    if (!read_call(env, info, 1, &argument, &p)) return NULL;
    napi_create_bigint_uint64(env, wade_publisher_frame_hash(p->stream), &result);
    return result;
}

// Subscriber of the agents stream of the crowd.
struct people {
    unsigned tag;
    wade_subscriber* stream;
};
static void finalize_people(napi_env env, void* data, void* hint) {
    (void)env, (void)hint;
    struct people* const p = data;
    if (p->stream != NULL) wade_subscriber_free(p->stream);
    free(p);
}

static napi_value join_people(napi_env env, napi_callback_info info) {
    size_t count = 2;
    napi_value arguments[2], stream_of, lag, result;
    napi_get_cb_info(env, info, &count, arguments, NULL, NULL);
    char session[256];
    if (count < 2 || napi_get_value_string_utf8(env, arguments[0], session, sizeof session, NULL) != napi_ok)
        return throw_failure(env, WADE_USAGE, "joinPeople(session, options): a name and an object are required.");
    wade_join join;
    wade_join_defaults(&join);
    join.kind = WADE_AGENTS;
    join.waiting.attach_timeout_s = number_property(env, arguments[1], "attachTimeoutS", join.waiting.attach_timeout_s);
    join.waiting.step_timeout_s = number_property(env, arguments[1], "stepTimeoutS", join.waiting.step_timeout_s);
    struct people* const p = calloc(1, sizeof *p);
    if (p == NULL) return throw_failure(env, WADE_UNEXPECTED, "There is no memory left.");
    p->tag = people_tag;
    wade_stream stream;
    int failure = wade_subscriber_open(session, "producer_node", &join, &p->stream);
    if (failure == WADE_OK) failure = wade_subscriber_stream(p->stream, &stream);
    if (failure == WADE_OK && napi_create_external(env, p, finalize_people, NULL, &stream_of) == napi_ok &&
        napi_create_uint32(env, stream.coupling_lag, &lag) == napi_ok && napi_create_object(env, &result) == napi_ok &&
        napi_set_named_property(env, result, "stream", stream_of) == napi_ok &&
        napi_set_named_property(env, result, "lag", lag) == napi_ok)
        return result;
    finalize_people(env, p, NULL);
    return throw_failure(env, failure != WADE_OK ? failure : WADE_UNEXPECTED, wade_last_error());
}

// The people of a call, which have not left yet; NULL: an error was thrown.
static struct people* read_people(napi_env env, napi_callback_info info) {
    size_t count = 1;
    napi_value argument, stream;
    struct people* p = NULL;
    napi_get_cb_info(env, info, &count, &argument, NULL, NULL);
    if (count == 1 && napi_get_named_property(env, argument, "stream", &stream) == napi_ok &&
        napi_get_value_external(env, stream, (void**)&p) == napi_ok && p->tag == people_tag && p->stream != NULL)
        return p;
    throw_failure(env, WADE_USAGE, "The argument must be what joinPeople gave, and must not have left.");
    return NULL;
}

// Copies, so that the frame can be released at once. false: an error was thrown.
static bool set_array(napi_env env, napi_value object, const char* name, const float* values, uint32_t count) {
    napi_value buffer, array;
    void* bytes;
    if (values == NULL)
        return napi_get_null(env, &array) == napi_ok && napi_set_named_property(env, object, name, array) == napi_ok;
    if (napi_create_arraybuffer(env, count * sizeof(float), &bytes, &buffer) != napi_ok ||
        napi_create_typedarray(env, napi_float32_array, count, buffer, 0, &array) != napi_ok)
        return throw_failure(env, WADE_UNEXPECTED, "There is no memory left.") != NULL;
    memcpy(bytes, values, count * sizeof(float));
    return napi_set_named_property(env, object, name, array) == napi_ok;
}

static napi_value take_people(napi_env env, napi_callback_info info) {
    struct people* const p = read_people(env, info);
    napi_value result, number;
    if (p == NULL) return NULL;
    wade_frame frame;
    wade_frame_impulses push;
    int failure = wade_subscriber_acquire(p->stream, &frame);
    if (failure == WADE_END) return napi_get_null(env, &result) == napi_ok ? result : NULL;
    if (failure == WADE_OK) failure = wade_subscriber_impulses(p->stream, &push);
    if (failure != WADE_OK) return done(env, failure);
    napi_create_object(env, &result);
    napi_create_uint32(env, frame.count, &number);
    napi_set_named_property(env, result, "count", number);
    const bool well =
        set_array(env, result, "px", frame.px, frame.count) && set_array(env, result, "pz", frame.pz, frame.count) &&
        set_array(env, result, "jx", push.jx, frame.count) && set_array(env, result, "jz", push.jz, frame.count) &&
        set_array(env, result, "submerged", push.submerged, frame.count) &&
        set_array(env, result, "spread", push.spread, frame.count);
    if (!well) return NULL;
    failure = wade_subscriber_release(p->stream);
    return failure == WADE_OK ? result : done(env, failure);
}

static napi_value leave_people(napi_env env, napi_callback_info info) {
    struct people* const p = read_people(env, info);
    if (p == NULL) return NULL;
    const int result = wade_subscriber_leave(p->stream);
    wade_subscriber_free(p->stream);
    p->stream = NULL;
    return done(env, result);
}

static napi_value catch_signals(napi_env env, napi_callback_info info) {
    (void)env, (void)info;
    struct sigaction action = {.sa_handler = remember_signal};
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    return NULL;
}
static napi_value received_signal(napi_env env, napi_callback_info info) {
    (void)info;
    napi_value number;
    napi_create_int32(env, signal_received, &number);
    return number;
}

NAPI_MODULE_INIT() {
    const napi_property_descriptor functions[] = {
        {"open", NULL, open_publisher, NULL, NULL, NULL, napi_enumerable, NULL},
        {"waitForConsumers", NULL, wait_for_consumers, NULL, NULL, NULL, napi_enumerable, NULL},
        {"beginFrame", NULL, begin_frame, NULL, NULL, NULL, napi_enumerable, NULL},
        {"columnStream", NULL, column_stream, NULL, NULL, NULL, napi_enumerable, NULL},
        {"columns", NULL, write_columns, NULL, NULL, NULL, napi_enumerable, NULL},
        {"endFrame", NULL, end_frame, NULL, NULL, NULL, napi_enumerable, NULL},
        {"close", NULL, close_publisher, NULL, NULL, NULL, napi_enumerable, NULL},
        {"abort", NULL, abort_publisher, NULL, NULL, NULL, napi_enumerable, NULL},
        {"frameHash", NULL, frame_hash, NULL, NULL, NULL, napi_enumerable, NULL},
        {"joinPeople", NULL, join_people, NULL, NULL, NULL, napi_enumerable, NULL},
        {"takePeople", NULL, take_people, NULL, NULL, NULL, napi_enumerable, NULL},
        {"leavePeople", NULL, leave_people, NULL, NULL, NULL, napi_enumerable, NULL},
        {"catchSignals", NULL, catch_signals, NULL, NULL, NULL, napi_enumerable, NULL},
        {"receivedSignal", NULL, received_signal, NULL, NULL, NULL, napi_enumerable, NULL}};
    napi_define_properties(env, exports, sizeof functions / sizeof *functions, functions);
    return exports;
}
