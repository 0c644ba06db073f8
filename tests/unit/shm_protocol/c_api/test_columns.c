/* wade_columns() against the table that all languages share, and what the table does not hold: units, axes, wrong calls. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "shm_protocol/c_api/wade_shm.h"

enum { most = 16 };

#define CHECK(ok)                                                                                                   \
    do {                                                                                                            \
        if (!(ok)) {                                                                                                \
            fprintf(stderr, "%s:%d: not so in '%s': %s (%s)\n", __FILE__, __LINE__, title, #ok, wade_last_error()); \
            exit(99);                                                                                               \
        }                                                                                                           \
    } while (0)

static char title[200] = "";

struct water {
    double depth[most], u[most], v[most], bed[most];
    wade_grid grid;
};
struct particles {
    float mass[most], vx[most], vy[most], vz[most], px[most], py[most], pz[most];
};

static wade_slot slot_of(struct particles* p, uint64_t capacity) {
    const wade_slot slot = {1, capacity, p->mass, p->vx, p->vy, p->vz, p->px, p->py, p->pz, NULL, NULL, NULL};
    return slot;
}

/* The next line that is neither empty nor a comment; 0 at the end. */
static int next_line(FILE* file, char* line, int room) {
    while (fgets(line, room, file) != NULL) {
        line[strcspn(line, "\n")] = 0;
        if (line[0] != 0 && line[0] != '#') return 1;
    }
    return 0;
}

static void read_water(FILE* file, struct water* w) {
    char line[200];
    wade_grid* g = &w->grid;
    CHECK(next_line(file, line, sizeof line));
    CHECK(sscanf(line, "grid %lf %lf %lf %lf %u %u", &g->x_min, &g->z_min, &g->cell_x, &g->cell_z, &g->nx, &g->nz) ==
          6);
    CHECK(g->nx * g->nz <= most);
    for (unsigned k = 0; k < g->nx * g->nz; ++k) {
        CHECK(next_line(file, line, sizeof line));
        CHECK(sscanf(line, "cell %lf %lf %lf %lf", &w->depth[k], &w->u[k], &w->v[k], &w->bed[k]) == 4);
    }
    g->depth = w->depth;
    g->u = w->u;
    g->v = w->v;
    g->bed = w->bed;
}

static void check_refused(const struct water* w, const char* words) {
    struct particles p;
    const wade_slot slot = slot_of(&p, most);
    wade_stream stream;
    uint32_t count = 0;
    wade_stream_defaults(&stream);
    int result = wade_columns_stream(&w->grid, &stream);
    if (result == WADE_OK) result = wade_columns(&w->grid, &stream, &slot, &count);
    CHECK(result == WADE_USAGE);
    CHECK(strstr(wade_last_error(), words) != NULL);
}

static void check_columns(FILE* file, const struct water* w, const char* line) {
    double width[2];
    unsigned capacity, expected;
    uint32_t count = 99;
    struct particles p;
    wade_stream stream;
    char row[200];
    CHECK(sscanf(line, "columns %lf %lf %u %u", &width[0], &width[1], &capacity, &expected) == 4);
    wade_stream_defaults(&stream);
    CHECK(wade_columns_stream(&w->grid, &stream) == WADE_OK);
    CHECK(stream.column_width[0] == width[0] && stream.column_width[1] == width[1]);
    CHECK(stream.capacity == capacity && stream.rest_density == 1000);
    const wade_slot slot = slot_of(&p, capacity);
    CHECK(wade_columns(&w->grid, &stream, &slot, &count) == WADE_OK && count == expected);
    for (unsigned k = 0; k < expected; ++k) {
        float e[7];
        CHECK(next_line(file, row, sizeof row));
        CHECK(sscanf(row, "particle %f %f %f %f %f %f %f", &e[0], &e[1], &e[2], &e[3], &e[4], &e[5], &e[6]) == 7);
        CHECK(p.mass[k] == e[0] && p.vx[k] == e[1] && p.vy[k] == e[2] && p.vz[k] == e[3]);
        CHECK(p.px[k] == e[4] && p.py[k] == e[5] && p.pz[k] == e[6]);
    }
}

static void the_table_holds(const char* path) {
    FILE* const file = fopen(path, "r");
    char line[200];
    int cases = 0;
    CHECK(file != NULL);
    while (next_line(file, line, sizeof line)) {
        struct water w;
        CHECK(strncmp(line, "case ", 5) == 0);
        strcpy(title, line + 5);
        read_water(file, &w);
        CHECK(next_line(file, line, sizeof line));
        if (strncmp(line, "refused ", 8) == 0)
            check_refused(&w, line + 8);
        else
            check_columns(file, &w, line);
        ++cases;
    }
    fclose(file);
    strcpy(title, "the table");
    CHECK(cases > 10);
}

static struct water one_cell(void) {
    struct water w;
    memset(&w, 0, sizeof w);
    w.grid.cell_x = w.grid.cell_z = 1;
    w.grid.nx = w.grid.nz = 1;
    w.depth[0] = 0.5;
    w.u[0] = 2;
    w.v[0] = -1;
    return w;
}

/* The grid is in world metres; the slot in the units and axes of the stream. */
static void a_stream_may_have_units_and_axes_of_its_own(void) {
    strcpy(title, "units and axes");
    struct water w = one_cell();
    w.grid.depth = w.depth;
    w.grid.u = w.u;
    w.grid.v = w.v;
    struct particles p;
    const wade_slot slot = slot_of(&p, 1);
    wade_stream stream;
    uint32_t count = 0;
    wade_stream_defaults(&stream);
    const int32_t axes[3] = {-3, 2, 1}; /* z up to the left: stored z is -x, stored x is z */
    memcpy(stream.axes, axes, sizeof axes);
    stream.metres_per_unit = 0.5;
    stream.origin[0] = 10;
    stream.rest_density = 1024;
    CHECK(wade_columns_stream(&w.grid, &stream) == WADE_OK && stream.rest_density == 1024);
    CHECK(wade_columns(&w.grid, &stream, &slot, &count) == WADE_OK && count == 1);
    CHECK(p.mass[0] == 512 && p.pz[0] == 19 && p.vz[0] == -4 && p.py[0] == 0.5F && p.px[0] == 1 && p.vx[0] == -2);
}

static void wrong_calls_are_refused(void) {
    strcpy(title, "wrong calls");
    struct water w = one_cell();
    struct particles p;
    wade_slot slot = slot_of(&p, 1);
    wade_stream stream;
    uint32_t count = 0;
    wade_stream_defaults(&stream);
    CHECK(wade_columns_stream(NULL, &stream) == WADE_USAGE && wade_columns_stream(&w.grid, NULL) == WADE_USAGE);
    CHECK(wade_columns(&w.grid, &stream, &slot, &count) == WADE_USAGE); /* its arrays are NULL */
    w.grid.depth = w.depth;
    w.grid.u = w.u;
    w.grid.v = w.v;
    CHECK(wade_columns(&w.grid, &stream, &slot, &count) == WADE_USAGE);
    CHECK(strstr(wade_last_error(), "call wade_columns_stream() before") != NULL);
    CHECK(wade_columns_stream(&w.grid, &stream) == WADE_OK);
    slot.capacity = 0;
    CHECK(wade_columns(&w.grid, &stream, &slot, &count) == WADE_USAGE);
    CHECK(strstr(wade_last_error(), "room for 0 columns") != NULL);
    w.grid.nx = w.grid.nz = 65536; /* 2^32 columns */
    CHECK(wade_columns_stream(&w.grid, &stream) == WADE_USAGE);
    CHECK(strstr(wade_last_error(), "nx * nz = 4294967296") != NULL);
}

int main(int argc, char** argv) {
    if (argc != 2) return 2;
    the_table_holds(argv[1]);
    a_stream_may_have_units_and_axes_of_its_own();
    wrong_calls_are_refused();
    return 0;
}
