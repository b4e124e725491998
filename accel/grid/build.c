/* Building a grid: the resolution, the planes, and the lists by a count pass and a fill pass. */
#include "accel/grid/grid.h"

#include "base/memory.h"

#include <assert.h>
#include <string.h>

enum { RULE_CUBIC, RULE_WOO, RULE_HETEROGENEOUS };
enum { MAX_RESOLUTION = 4096 };

/* Above this many bytes of voxels and lists a grid is refused. */
#define MAX_BYTES (UINT64_C(4) << 30)

const RtParam rt_grid_params[RT_GRID_PARAM_COUNT] = {
    [RT_GRID_RULE] =
        {.name = "rule",
         .type = RT_PARAM_CHOICE,
         .standard = "cubic",
         .choices = "cubic|woo|heterogeneous",
         .meaning =
             "how density becomes a resolution: cubic voxels; Woo's by the longest side; Klimaszewski's",
         .source = "Cleary & Wyvill 1988; Woo 1992; Klimaszewski & Sederberg 1997"},
    [RT_GRID_DENSITY] = {.name = "density",
                         .type = RT_PARAM_FLOAT,
                         .standard = "4",
                         .lo = 1e-6,
                         .hi = 1e6,
                         .meaning = "voxels per object that the rule aims at",
                         .source = "between 1 (too coarse) and 20 of Havran & Sixta 1999",
                         .tries = "0.001|1|20"},
    [RT_GRID_RESOLUTION] = {.name = "resolution",
                            .type = RT_PARAM_RESOLUTION,
                            .standard = "auto",
                            .lo = 1,
                            .hi = MAX_RESOLUTION,
                            .meaning = "voxels along x, y, z; auto follows the rule",
                            .source = "this program",
                            .tries = "1x1x1|2x3x5|64x1x64"},
    [RT_GRID_MARGIN] = {.name = "margin",
                        .type = RT_PARAM_FLOAT,
                        .standard = "0",
                        .lo = 0,
                        .hi = 1,
                        .meaning = "how much wider than the scene's box the grid is, as a part of it",
                        .source = "the published scene boxes are a little wider than tight",
                        .tries = "0.01|1"},
    [RT_GRID_MAILBOX] = {.name = "mailbox",
                         .type = RT_PARAM_FLAG,
                         .standard = "on",
                         .meaning = "do not test an object twice for one ray",
                         .source = "Kirk & Arvo 1991"},
};

/* ---- resolution ---- */

static uint32_t clamp_resolution(double n) {
    return n < 1 ? 1 : n > MAX_RESOLUTION ? MAX_RESOLUTION : (uint32_t)n;
}

/* Sizes of the box with no side thinner than 2^-10 of the longest: a flat scene has voxels, too. */
static RtVec3d solid_size(const RtBox *box) {
    RtVec3d s = rt_subd(rt_widen(box->hi), rt_widen(box->lo));
    double longest = fmax(s.x, fmax(s.y, s.z));
    if (longest == 0) return rt_vec3d(1, 1, 1);
    for (int a = 0; a < 3; a++) s.at[a] = fmax(s.at[a], longest * 0x1p-10) / longest;
    return s;
}

/* By Newton's method, because the library's last bit may differ from machine to machine, and counts must not.
 */
static double cube_root(double x) {
    double root = fmax(x, 1), last;
    do {
        last = root;
        root = (2 * root + x / (root * root)) / 3;
    } while (root < last);
    return root;
}

/* Rounds down, but takes what is a whole number up to rounding as that number. */
static double whole(double x) {
    return floor(x * (1 + 1e-12));
}

static void choose_resolution(const RtGrid *grid, uint32_t objects, const RtValue *values, uint32_t n[3]) {
    const uint32_t *given = values[RT_GRID_RESOLUTION].resolution;
    if (given[0] > 0) {
        memcpy(n, given, 3 * sizeof n[0]);
        return;
    }
    RtVec3d s = solid_size(&grid->box); /* in units of the longest side */
    double voxels = values[RT_GRID_DENSITY].f * objects;
    switch (values[RT_GRID_RULE].choice) {
    case RULE_CUBIC: {
        double per_side = cube_root(voxels / (s.x * s.y * s.z));
        for (int a = 0; a < 3; a++) n[a] = clamp_resolution(whole(s.at[a] * per_side + 0.5));
        break;
    }
    case RULE_WOO:
        for (int a = 0; a < 3; a++) n[a] = clamp_resolution(whole(s.at[a] * cube_root(voxels)));
        break;
    case RULE_HETEROGENEOUS:
        n[0] = clamp_resolution(whole(cube_root(voxels * s.x * s.x / (s.y * s.z)) + 0.5));
        n[1] = clamp_resolution(whole(sqrt(voxels * s.y / (n[0] * s.z)) + 0.5));
        n[2] = clamp_resolution(whole(voxels / ((double)n[0] * n[1])));
        break;
    default: assert(false && "no such rule");
    }
}

/* ---- build ---- */

/* The intervals of planes on `axis` that [lo, hi], which meets the grid, touches: first to last. */
static void covered(const RtGrid *grid, int axis, float lo, float hi, uint32_t *first, uint32_t *last) {
    const float *plane = grid->planes[axis];
    uint32_t n = grid->n[axis];
    float width = plane[n] - plane[0];
    float guess = width > 0 ? (lo - plane[0]) / width * (float)n : 0;
    uint32_t i = guess > 0 ? (uint32_t)rt_minf(guess, (float)(n - 1)) : 0;
    while (i > 0 && plane[i] >= lo) i--;
    while (i + 1 < n && plane[i + 1] < lo) i++;
    *first = i;
    while (i + 1 < n && plane[i + 1] <= hi) i++;
    *last = i;
}

/* The range of voxels that an object's box touches, first to last on each axis. */
static void covered_voxels(const RtGrid *grid, const RtBox *box, uint32_t from[3], uint32_t to[3]) {
    for (int a = 0; a < 3; a++) covered(grid, a, box->lo.at[a], box->hi.at[a], &from[a], &to[a]);
}

static uint64_t count_references(const RtGrid *grid) {
    uint64_t sum = 0;
    for (uint32_t id = 0; id < grid->base.scene->geometry.object_count; id++) {
        uint32_t from[3], to[3];
        covered_voxels(grid, &grid->base.scene->geometry.boxes[id], from, to);
        sum += (uint64_t)(to[0] - from[0] + 1) * (to[1] - from[1] + 1) * (to[2] - from[2] + 1);
    }
    return sum;
}

/* Adds 1 to slot[v] for every voxel v an object touches; where `ids` is given, stores the object at the slot
 * before. Called twice: to count the lists, and to fill them. */
static void scatter(const RtGrid *grid, uint32_t *slot, uint32_t *ids) {
    for (uint32_t id = 0; id < grid->base.scene->geometry.object_count; id++) {
        uint32_t from[3], to[3], at[3];
        covered_voxels(grid, &grid->base.scene->geometry.boxes[id], from, to);
        for (at[2] = from[2]; at[2] <= to[2]; at[2]++) {
            for (at[1] = from[1]; at[1] <= to[1]; at[1]++) {
                for (at[0] = from[0]; at[0] <= to[0]; at[0]++) {
                    uint32_t *entry = &slot[rt_grid_voxel_at(grid, at)];
                    if (ids) ids[*entry] = id;
                    ++*entry;
                }
            }
        }
    }
}

static RtStatus make_planes(RtGrid *grid, RtError *error) {
    size_t total = (size_t)grid->n[0] + grid->n[1] + grid->n[2] + 3;
    float *block = rt_alloc(total, sizeof(float));
    if (!block) return rt_fail_memory(error, "the planes of a grid", total * sizeof(float));
    for (int a = 0; a < 3; a++) {
        double lo = (double)grid->box.lo.at[a], width = (double)grid->box.hi.at[a] - lo;
        grid->planes[a] = block;
        for (uint32_t i = 0; i <= grid->n[a]; i++) block[i] = (float)(lo + width * i / grid->n[a]);
        block[grid->n[a]] = grid->box.hi.at[a];
        block += grid->n[a] + 1;
    }
    return RT_OK;
}

static RtStatus refuse_size(const RtGrid *grid, uint64_t references, RtError *error) {
    double voxels = (double)grid->n[0] * grid->n[1] * grid->n[2];
    double bytes = 4 * (voxels + (double)references), most = (double)MAX_BYTES;
    if (bytes <= most) return RT_OK;
    double fits = fmax(floor(cube_root(most / bytes) * fmax(grid->n[0], fmax(grid->n[1], grid->n[2]))), 1);
    return rt_fail(
        error, RT_BAD_INPUT,
        "a grid of %ux%ux%u voxels with %.3g list entries would take %.1f GiB, more than %.0f GiB: a "
        "resolution of at most about %.0f a side would fit",
        grid->n[0], grid->n[1], grid->n[2], (double)references, bytes / 0x1p30, most / 0x1p30, fits);
}

static RtStatus make_lists(RtGrid *grid, RtError *error) {
    RT_TRY(refuse_size(grid, 0, error));
    RT_TRY(make_planes(grid, error));
    uint64_t references = count_references(grid);
    RT_TRY(refuse_size(grid, references, error));
    size_t voxels = rt_grid_voxel_count(grid);
    grid->first = rt_alloc(voxels + 1, sizeof(uint32_t));
    grid->ids = rt_alloc(references, sizeof(uint32_t));
    if (!grid->first || !grid->ids) {
        return rt_fail_memory(error, "the lists of a grid", (voxels + 1 + references) * sizeof(uint32_t));
    }
    /* Count pass; ends of lists; fill pass, after which first[v] is the end of list v: shift by one. */
    scatter(grid, grid->first, NULL);
    uint32_t sum = 0;
    for (size_t v = 0; v <= voxels; v++) {
        uint32_t length = grid->first[v];
        grid->first[v] = sum;
        sum += length;
    }
    scatter(grid, grid->first, grid->ids);
    memmove(grid->first + 1, grid->first, voxels * sizeof(uint32_t));
    grid->first[0] = 0;
    return RT_OK;
}

void rt_grid_destroy(RtAccel *accel) {
    RtGrid *grid = (RtGrid *)accel;
    rt_free(grid->planes[0]);
    rt_free(grid->first);
    rt_free(grid->ids);
    rt_free(grid);
}

RtStatus rt_grid_build(const RtScene *scene, const RtValue *values, RtAccel **out, RtError *error) {
    RtGrid *grid = rt_alloc(1, sizeof(RtGrid));
    if (!grid) return rt_fail_memory(error, "a grid", sizeof(RtGrid));
    grid->base = (RtAccel){.ops = &rt_grid_ops, .scene = scene, .exact = true, .counts = true};
    grid->box = scene->geometry.box;
    grid->mailbox = values[RT_GRID_MAILBOX].flag;
    if (scene->geometry.object_count > 0) {
        grid->box = rt_box_widened(grid->box, values[RT_GRID_MARGIN].f);
        choose_resolution(grid, scene->geometry.object_count, values, grid->n);
        RtStatus status = make_lists(grid, error);
        if (status != RT_OK) {
            rt_grid_destroy(&grid->base);
            return status;
        }
    }
    *out = &grid->base;
    return RT_OK;
}
