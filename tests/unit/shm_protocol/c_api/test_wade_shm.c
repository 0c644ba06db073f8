/* A producer and its consumers in two processes over the C ABI, compiled as C. */
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "shm_protocol/c_api/wade_shm.h"

enum { frames = 200, particles = 300 };

#define CHECK(ok)                                                                                    \
    do {                                                                                             \
        if (!(ok)) {                                                                                 \
            fprintf(stderr, "%s:%d: not so: %s (%s)\n", __FILE__, __LINE__, #ok, wade_last_error()); \
            exit(99);                                                                                \
        }                                                                                            \
    } while (0)

static float value(uint64_t frame, int k) {
    return (float)(frame * 3 + (uint64_t)k);
}

static wade_publisher* open_publisher(const char* session, uint32_t kind) {
    wade_stream stream;
    wade_stream_defaults(&stream);
    strcpy(stream.producer_name, "plain c");
    stream.kind = kind;
    stream.capacity = particles;
    stream.scene_hash = 77;
    wade_publisher* p = NULL;
    if (kind == WADE_AGENTS) {
        CHECK(wade_publisher_open_with_impulses(session, &stream, NULL, &p) == WADE_OK);
    } else {
        CHECK(wade_publisher_open_with_impulses(session, &stream, NULL, &p) == WADE_USAGE);  // water has none
        CHECK(wade_publisher_open(session, &stream, NULL, &p) == WADE_OK);
    }
    return p;
}

static void fill(const wade_slot* slot) {
    float* const fields[] = {slot->mass, slot->vx, slot->vy,     slot->vz,     slot->px,
                             slot->py,   slot->pz, slot->radius, slot->height, slot->state};
    for (int i = 0; i < 10; ++i)
        for (int k = 0; fields[i] != NULL && k < particles; ++k) fields[i][k] = value(slot->frame, k + i);
}

static void check(const wade_frame* f) {
    const float* const fields[] = {f->mass, f->vx, f->vy, f->vz, f->px, f->py, f->pz, f->radius, f->height, f->state};
    CHECK(f->count == particles);
    for (int i = 0; i < 10; ++i)
        for (int k = 0; fields[i] != NULL && k < particles; ++k) CHECK(fields[i][k] == value(f->frame, k + i));
}

static void push(wade_publisher* p, uint32_t kind) {
    wade_slot_impulses i;
    CHECK(wade_publisher_impulses(p, &i) == WADE_OK && (i.jx != NULL) == (kind == WADE_AGENTS));
    for (int k = 0; i.jx != NULL && k < particles; ++k) {
        i.jx[k] = value(1, k);
        i.jz[k] = value(2, k);
        i.submerged[k] = value(3, k);
        i.spread[k] = value(4, k);
    }
}

static void check_push(const wade_subscriber* s, uint32_t kind) {
    wade_frame_impulses i;
    CHECK(wade_subscriber_impulses(s, &i) == WADE_OK && (i.spread != NULL) == (kind == WADE_AGENTS));
    for (int k = 0; i.jx != NULL && k < particles; ++k)
        CHECK(i.jx[k] == value(1, k) && i.jz[k] == value(2, k) && i.submerged[k] == value(3, k) &&
              i.spread[k] == value(4, k));
}

static int produce(const char* session, uint32_t kind) {
    wade_publisher* p = open_publisher(session, kind);
    wade_diagnostics diagnostics;
    wade_diagnostics_defaults(&diagnostics);
    CHECK(isnan(diagnostics.mean_depth_m));
    diagnostics.sub_steps = 4;
    CHECK(wade_publisher_wait_for_consumers(p, 1) == WADE_OK);
    wade_slot slot;
    int result = WADE_OK;
    for (uint64_t f = 1; f <= frames && result == WADE_OK; ++f) {
        result = wade_publisher_begin_frame(p, &slot);
        CHECK(result == WADE_OK && slot.frame == f && slot.capacity == particles);
        CHECK((slot.radius != NULL) == (kind == WADE_AGENTS));
        fill(&slot);
        push(p, kind);
        CHECK(wade_publisher_set_paused(p, f % 2 == 0) == WADE_OK && wade_publisher_heartbeat(p) == WADE_OK);
        if (kind == WADE_AGENTS)
            CHECK(wade_publisher_end_frame_at(p, particles, &diagnostics, f == frames, 10 * f) == WADE_OK);
        else
            CHECK(wade_publisher_end_frame(p, particles, &diagnostics, f == frames) == WADE_OK);
    }
    CHECK(wade_publisher_close(p) == WADE_OK);
    CHECK(wade_publisher_published_frames(p) == frames && wade_publisher_frame_hash(p) != 0);
    wade_publisher_free(p);
    return 0;
}

static pid_t start(int (*work)(const char*, uint32_t), const char* session, uint32_t kind) {
    const pid_t pid = fork();
    CHECK(pid >= 0);
    if (pid == 0) _exit(work(session, kind));
    return pid;
}

static int exit_code_of(pid_t pid) {
    int status = 0;
    CHECK(waitpid(pid, &status, 0) == pid);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

static void every_frame_crosses(const char* session, uint32_t kind) {
    const pid_t producer = start(produce, session, kind);
    wade_join join;
    wade_join_defaults(&join);
    join.kind = kind;
    join.scene_hash = 77;
    wade_subscriber* s = NULL;
    wade_latest* r = NULL;
    CHECK(wade_subscriber_open(session, "reader", &join, &s) == WADE_OK);
    CHECK(wade_latest_open(session, "viewer", &join, 1, &r) == WADE_OK);
    wade_stream stream;
    CHECK(wade_subscriber_stream(s, &stream) == WADE_OK);
    CHECK(strcmp(stream.producer_name, "plain c") == 0 && stream.kind == kind && stream.session_id != 0);
    wade_frame frame;
    uint64_t seen = 0;
    uint64_t polled = 0;
    int result;
    while ((result = wade_subscriber_acquire(s, &frame)) == WADE_OK) {
        CHECK(frame.frame == ++seen && frame.final == (seen == frames) && frame.diagnostics.sub_steps == 4);
        CHECK(frame.tick == (kind == WADE_AGENTS ? 10 * seen : seen));
        check(&frame);
        check_push(s, kind);
        wade_frame newest;
        if (wade_latest_poll(r, &newest) == WADE_OK) {
            check(&newest);
            CHECK(newest.frame == seen && newest.hash == frame.hash);
            ++polled;
        }
        CHECK(wade_subscriber_set_paused(s, 0) == WADE_OK && wade_subscriber_heartbeat(s) == WADE_OK);
        CHECK(wade_subscriber_release(s) == WADE_OK);
    }
    CHECK(result == WADE_END && seen == frames);
    CHECK(polled + wade_latest_dropped_frames(r) == frames);  // depth 1: the frame held is the newest
    CHECK(wade_latest_next(r, &frame) == WADE_END && wade_latest_poll(r, &frame) == WADE_END);
    wade_subscriber_free(s);
    wade_latest_free(r);
    CHECK(exit_code_of(producer) == 0);
}

static int abort_at_once(const char* session, uint32_t kind) {
    wade_publisher* p = open_publisher(session, kind);
    CHECK(wade_publisher_wait_for_consumers(p, 1) == WADE_OK);
    CHECK(wade_publisher_abort(p, 9, "the solver diverged") == WADE_OK);
    wade_publisher_free(p);
    return 0;
}

static void a_reason_crosses(const char* session) {
    const pid_t producer = start(abort_at_once, session, WADE_FLUID);
    wade_subscriber* s = NULL;
    wade_frame frame;
    CHECK(wade_subscriber_open(session, "reader", NULL, &s) == WADE_OK);
    CHECK(wade_subscriber_acquire(s, &frame) == WADE_PEER_ABORTED);
    CHECK(strstr(wade_last_error(), "the solver diverged") != NULL);
    wade_subscriber_free(s);
    CHECK(exit_code_of(producer) == 0);
}

static int abort_as_consumer(const char* session, uint32_t kind) {
    wade_subscriber* s = NULL;
    (void)kind;
    CHECK(wade_subscriber_open(session, "reader", NULL, &s) == WADE_OK);
    CHECK(wade_subscriber_abort(s, 9, NULL) == WADE_OK);
    wade_subscriber_free(s);
    return 0;
}

static void a_consumer_may_give_up(const char* session) {
    const pid_t consumer = start(abort_as_consumer, session, WADE_FLUID);
    wade_publisher* p = open_publisher(session, WADE_FLUID);
    // The publisher may see the consumer between its joining and its giving up; it then waits for one more.
    int answer = wade_publisher_wait_for_consumers(p, 1);
    if (answer == WADE_OK) answer = wade_publisher_wait_for_consumers(p, 2);
    CHECK(answer == WADE_PEER_ABORTED);
    wade_publisher_free(p);
    CHECK(exit_code_of(consumer) == 0);
}

static void misuse_is_refused(const char* session) {
    wade_publisher* p = open_publisher(session, WADE_FLUID);
    wade_publisher* second = p;
    wade_stream stream;
    CHECK(wade_publisher_stream(p, &stream) == WADE_OK);
    CHECK(wade_publisher_open(session, &stream, NULL, &second) == WADE_NAME_IN_USE && second == NULL);
    CHECK(strstr(wade_last_error(), "is in use by a living producer") != NULL);
    CHECK(wade_publisher_open("a/b", &stream, NULL, &second) == WADE_USAGE);
    stream.capacity = 0;
    CHECK(wade_publisher_open("any", &stream, NULL, &second) == WADE_USAGE);
    memset(stream.producer_name, 'x', sizeof stream.producer_name);
    CHECK(wade_publisher_open("any", &stream, NULL, &second) == WADE_USAGE);
    CHECK(wade_publisher_open(NULL, &stream, NULL, &second) == WADE_USAGE);
    CHECK(wade_publisher_open("any", &stream, NULL, NULL) == WADE_USAGE);
    CHECK(wade_publisher_end_frame(p, 0, NULL, 0) == WADE_USAGE);
    CHECK(wade_publisher_begin_frame(NULL, NULL) == WADE_USAGE);
    wade_latest* r = NULL;
    CHECK(wade_latest_open(session, "viewer", NULL, 0, &r) == WADE_USAGE && r == NULL);
    CHECK(wade_latest_poll(NULL, NULL) == WADE_USAGE);
    wade_publisher_free(p);
    wade_publisher_free(NULL);
}

static int count_to_three(void* calls) {
    return ++*(int*)calls >= 3;
}

static void waits_can_be_interrupted(const char* session) {
    wade_waiting waiting;
    wade_waiting_defaults(&waiting);
    CHECK(waiting.step_timeout_s == 60 && waiting.attach_timeout_s == 10);
    waiting.attach_timeout_s = 120;
    int calls = 0;
    waiting.interrupted = count_to_three;
    waiting.context = &calls;
    wade_stream stream;
    wade_stream_defaults(&stream);
    strcpy(stream.producer_name, "plain c");
    stream.capacity = 1;
    wade_publisher* p = NULL;
    CHECK(wade_publisher_open(session, &stream, &waiting, &p) == WADE_OK);
    CHECK(wade_publisher_wait_for_consumers(p, 1) == WADE_INTERRUPTED && calls == 3);
    wade_publisher_free(p);
    wade_interrupt();
    p = open_publisher(session, WADE_FLUID);
    CHECK(wade_publisher_wait_for_consumers(p, 1) == WADE_INTERRUPTED);
    wade_publisher_free(p);
    wade_clear_interrupt();
}

int main(void) {
    char session[64];
    snprintf(session, sizeof session, "wade-test-%d-c", (int)getpid());
    CHECK(wade_abi_version() == WADE_ABI_VERSION);
    every_frame_crosses(session, WADE_FLUID);
    every_frame_crosses(session, WADE_AGENTS);
    a_reason_crosses(session);
    a_consumer_may_give_up(session);
    misuse_is_refused(session);
    waits_can_be_interrupted(session);
    return 0;
}
