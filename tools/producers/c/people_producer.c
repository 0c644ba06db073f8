// people_producer: plays the known stream of tools/producers/README.md through libwade_shm.so and lets people push it: with
// --take-people it takes the agents of the crowd, and its water loses what they got from it. To make it yours, replace
// fill_frame(); take_impulse() works on any particles.
#define _POSIX_C_SOURCE 200809L  // sigaction
#include <math.h>
#include <signal.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "wade_shm.h"

enum { frames, particles, depth, speed, attach_timeout_s, step_timeout_s, option_count };
static struct {
    const char* name;
    double value, lowest, highest;
} options[option_count] = {
    {"--frames", 60, 1, 1e9},    {"--particles", 2000, 1, 1e7},        {"--depth", 1, 1, 63},
    {"--speed", 1.5, -100, 100}, {"--attach-timeout-s", 10, 0, 86400}, {"--step-timeout-s", 60, 0, 86400}};
static const char* session;
static uint64_t scene_hash;
static bool take_people;

static volatile sig_atomic_t signal_received;
static void remember_signal(int number) {
    signal_received = number;
    wade_interrupt();
}

// The known stream: all steps in double precision, each value rounded to float32 once.
static uint32_t fill_frame(const wade_slot* slot) {
    enum { rows = 50 };
    const uint32_t count = (uint32_t)options[particles].value;
    const double spacing = 0.4642, length = 100, travelled = options[speed].value * (double)slot->frame / 30;
    for (uint32_t k = 0; k < count; ++k) {
        const double x = 60 + k / rows * spacing - travelled;
        slot->mass[k] = 100;
        slot->vx[k] = (float)-options[speed].value;
        slot->vy[k] = slot->vz[k] = 0;
        slot->px[k] = (float)(x - length * floor(x / length));
        slot->py[k] = (float)0.23;
        slot->pz[k] = (float)(12 + k % rows * spacing);
    }
    return count;
}

// An agent that pushes the water: position, m; impulse that it got, N s; its depth in the water, m; radius of the cone
// around it, m.
struct person {
    double x, z, jx, jz, submerged, spread;
};

// w = 1 - r / R within the person's column, else 0.
static double weight_at(const struct person* p, const wade_slot* slot, uint32_t k) {
    if (slot->py[k] > p->submerged) return 0;
    const double w = 1 - hypot(slot->px[k] - p->x, slot->pz[k] - p->z) / p->spread;
    return w > 0 ? w : 0;
}

// Applies v -= w J / S with S = sum of w m, so that the water loses J. Adds the loss, after rounding to float32, to the
// account; without a particle in the cone (S = 0) adds J there as missing.
static void take_impulse(const struct person* p, const wade_slot* slot, uint32_t count, wade_diagnostics* account) {
    double sum = 0;
    for (uint32_t k = 0; k < count; ++k) sum += weight_at(p, slot, k) * (double)slot->mass[k];
    if (!(sum > 0)) {
        account->missing_for_people_x_n_s += p->jx;
        account->missing_for_people_z_n_s += p->jz;
        return;
    }
    for (uint32_t k = 0; k < count; ++k) {
        const double share = weight_at(p, slot, k) / sum;
        if (!(share > 0)) continue;
        const float vx = slot->vx[k], vz = slot->vz[k];
        slot->vx[k] = (float)(vx - share * p->jx);
        slot->vz[k] = (float)(vz - share * p->jz);
        account->taken_by_people_x_n_s += (double)slot->mass[k] * ((double)vx - (double)slot->vx[k]);
        account->taken_by_people_z_n_s += (double)slot->mass[k] * ((double)vz - (double)slot->vz[k]);
    }
}

// Applies the impulses of the agents that are due before a frame of the water. Returns WADE_END if the crowd has left.
static int let_people_push(wade_subscriber* people, const wade_slot* slot, uint32_t count, wade_diagnostics* account) {
    wade_frame agents;
    wade_frame_impulses push;
    int result = wade_subscriber_acquire(people, &agents);
    if (result == WADE_OK) result = wade_subscriber_impulses(people, &push);
    if (result != WADE_OK) return result;
    for (uint32_t a = 0; push.jx != NULL && a < agents.count; ++a) {
        const struct person p = {agents.px[a], agents.pz[a], push.jx[a], push.jz[a], push.submerged[a], push.spread[a]};
        if (p.jx != 0 || p.jz != 0) take_impulse(&p, slot, count, account);
    }
    return wade_subscriber_release(people);
}

// With `parallel`, coupling_lag 1, frame f of the water takes agents f - 1; there are none before frame 1.
static int open_people(const wade_waiting* waiting, wade_subscriber** people, uint64_t* lag) {
    wade_join join;
    wade_join_defaults(&join);
    join.kind = WADE_AGENTS;
    join.waiting = *waiting;
    wade_stream stream;
    int result = wade_subscriber_open(session, "people_producer", &join, people);
    if (result == WADE_OK) result = wade_subscriber_stream(*people, &stream);
    *lag = result == WADE_OK ? stream.coupling_lag : 0;
    return result;
}

static int play(wade_publisher* water, const wade_waiting* waiting) {
    wade_subscriber* people = NULL;
    uint64_t lag = 0;
    wade_diagnostics account;
    wade_diagnostics_defaults(&account);
    int result = wade_publisher_wait_for_consumers(water, 1);
    if (result == WADE_OK && take_people) result = open_people(waiting, &people, &lag);
    if (people != NULL) {
        account.taken_by_people_x_n_s = account.taken_by_people_z_n_s = 0;
        account.missing_for_people_x_n_s = account.missing_for_people_z_n_s = 0;
    }
    const uint64_t last = (uint64_t)options[frames].value;
    for (uint64_t frame = 1; frame <= last && result == WADE_OK && signal_received == 0; ++frame) {
        wade_slot slot;
        result = wade_publisher_begin_frame(water, &slot);
        if (result != WADE_OK) break;
        const uint32_t count = fill_frame(&slot);
        if (people != NULL && frame > lag) result = let_people_push(people, &slot, count, &account);
        if (result == WADE_OK) result = wade_publisher_end_frame(water, count, &account, frame == last);
    }
    if (people != NULL) {
        if (result == WADE_OK || result == WADE_END) wade_subscriber_leave(people);
        wade_subscriber_free(people);
    }
    return result;
}

static int refuse(const char* option, const char* value, const char* allowed) {
    fprintf(stderr, "people_producer: %s: %s is not allowed; allowed: %s.\n", option, value, allowed);
    return WADE_USAGE;
}

// Numbers from lowest to highest, whole ones where the name of the option is that of a count.
static int set_option(const char* option, const char* text) {
    char* end = NULL;
    for (unsigned i = 0; i < option_count; ++i) {
        if (strcmp(option, options[i].name) != 0) continue;
        const double value = options[i].value = strtod(text, &end);
        const bool in_range = value >= options[i].lowest && value <= options[i].highest;
        if (end != text && *end == 0 && in_range && (i >= speed || value == floor(value))) return WADE_OK;
        char allowed[80];
        snprintf(allowed, sizeof allowed, "%snumbers from %g to %g", i < speed ? "whole " : "", options[i].lowest,
                 options[i].highest);
        return refuse(option, text, allowed);
    }
    if (strcmp(option, "--session") == 0) {
        session = text;
        return WADE_OK;
    }
    if (strcmp(option, "--scene-hash") != 0) return refuse(option, text, "the options that --help shows");
    scene_hash = strtoull(text, &end, 16);
    if (strspn(text, "0123456789abcdefABCDEF") == strlen(text) && end != text && strlen(text) <= 16) return WADE_OK;
    return refuse(option, text, "1 to 16 hexadecimal digits");
}

static int read_command_line(int argc, char** argv) {
    for (int i = 1, scenes = 0; i < argc; ++i) {
        if (argv[i][0] != '-' && scenes++ == 0) continue;
        if (strcmp(argv[i], "--take-people") == 0) {
            take_people = true;
            continue;
        }
        if (i + 1 == argc) return refuse(argv[i], "nothing", "an option with its value");
        const int result = set_option(argv[i], argv[i + 1]);
        if (result != WADE_OK) return result;
        ++i;
    }
    return session != NULL ? WADE_OK : refuse("--session", "nothing", "a name");
}

int main(int argc, char** argv) {
    if (argc == 2 && strcmp(argv[1], "--help") == 0) {
        puts(
            "Usage: people_producer [SCENE.json] --session NAME [--frames N] [--particles N] [--speed V] [--depth D]\n"
            "       [--scene-hash HEX] [--attach-timeout-s T] [--step-timeout-s T] [--take-people]\n"
            "Plays the known stream of tools/producers/README.md; the scene file is not read.");
        return 0;
    }
    if (read_command_line(argc, argv) != WADE_OK) return WADE_USAGE;
    const struct sigaction action = {.sa_handler = remember_signal};
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    wade_waiting waiting;
    wade_waiting_defaults(&waiting);
    waiting.attach_timeout_s = options[attach_timeout_s].value;
    waiting.step_timeout_s = options[step_timeout_s].value;
    wade_stream stream;
    wade_stream_defaults(&stream);
    strcpy(stream.producer_name, "people_producer");
    stream.capacity = (uint32_t)options[particles].value;
    stream.depth = (uint32_t)options[depth].value;
    stream.scene_hash = scene_hash;
    stream.rest_density = 1000;
    stream.particle_radius = 0.4642 / 2;
    wade_publisher* water = NULL;
    int result = wade_publisher_open(session, &stream, &waiting, &water);
    if (result == WADE_OK) result = play(water, &waiting);
    if (signal_received != 0) result = 128 + signal_received;
    char why[512] = "A signal asked to stop.";
    if (result > 0 && signal_received == 0) snprintf(why, sizeof why, "%s", wade_last_error());
    if (result == WADE_OK || result == WADE_END) result = wade_publisher_close(water);
    if (result > 0 && signal_received == 0) snprintf(why, sizeof why, "%s", wade_last_error());
    if (result > 0) fprintf(stderr, "people_producer: %s\n", why);
    if (result > 0 && water != NULL) wade_publisher_abort(water, result, why);
    wade_publisher_free(water);
    return result;
}
