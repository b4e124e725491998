/* Building a grid: the resolution, the planes, and the lists by a count pass and a fill pass. */
#include "accel/grid/grid.h"

#include "base/memory.h"

#include <assert.h>
#include <string.h>

enum { OVERLAP_BOX, OVERLAP_EXACT };
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
    [RT_GRID_OVERLAP] = {.name = "overlap",
                         .type = RT_PARAM_CHOICE,
                         .standard = "box",
                         .choices = "box|exact",
                         .meaning = "an object goes into the voxels that its box, or its surface, meets",
                         .source = "boxes: Havran & Sixta 1999; exact: Akenine-Möller 2001"},
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

/* Where the lists grow: adds 1 to slot[v] for every voxel v taken, and stores the object at the slot before
 * where there are `ids`. Used twice: to count the lists, and to fill them. */
typedef struct Lists {
    const RtGrid *grid;
    uint32_t *slot, *ids;
    uint32_t id;
} Lists;

static void take(void *context, const RtGridRange *range) {
    const Lists *lists = context;
    uint32_t at[3];
    for (at[2] = range->from[2]; at[2] <= range->to[2]; at[2]++) {
        for (at[1] = range->from[1]; at[1] <= range->to[1]; at[1]++) {
            for (at[0] = range->from[0]; at[0] <= range->to[0]; at[0]++) {
                uint32_t *entry = &lists->slot[rt_grid_voxel_at(lists->grid, at)];
                if (lists->ids) lists->ids[*entry] = lists->id;
                ++*entry;
            }
        }
    }
}

static void scatter(const RtGrid *grid, uint32_t *slot, uint32_t *ids) {
    Lists lists = {grid, slot, ids, 0};
    for (; lists.id < grid->base.scene->geometry.object_count; lists.id++) {
        rt_grid_place(grid, lists.id, take, &lists);
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

static RtStatus make_lists(RtGrid *grid, uint64_t limit, RtError *error) {
    RT_TRY(rt_grid_refuse(grid, limit, error));
    RT_TRY(make_planes(grid, error));
    size_t voxels = rt_grid_voxel_count(grid);
    grid->first = rt_alloc(voxels + 1, sizeof(uint32_t));
    if (!grid->first) return rt_fail_memory(error, "the voxels of a grid", (voxels + 1) * sizeof(uint32_t));
    /* Count pass; ends of lists; fill pass, after which first[v] is the end of list v: shift by one. */
    scatter(grid, grid->first, NULL);
    uint32_t sum = 0;
    for (size_t v = 0; v <= voxels; v++) {
        uint32_t length = grid->first[v];
        grid->first[v] = sum;
        sum += length;
    }
    grid->ids = rt_alloc(sum, sizeof(uint32_t));
    if (!grid->ids) return rt_fail_memory(error, "the lists of a grid", sum * sizeof(uint32_t));
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

RtStatus rt_grid_build_within(uint64_t limit, const RtScene *scene, const RtValue *values, RtAccel **out,
                              RtError *error) {
    RtAccel *accel;
    RT_TRY(rt_accel_new(&rt_grid_ops, scene, sizeof(RtGrid), &accel, error));
    RtGrid *grid = (RtGrid *)accel;
    grid->box = scene->geometry.box;
    grid->mailbox = values[RT_GRID_MAILBOX].flag;
    grid->surfaces = values[RT_GRID_OVERLAP].choice == OVERLAP_EXACT;
    if (scene->geometry.object_count > 0) {
        grid->box = rt_box_widened(grid->box, values[RT_GRID_MARGIN].f);
        choose_resolution(grid, scene->geometry.object_count, values, grid->n);
        rt_grid_choose_margin(grid);
        RtStatus status = make_lists(grid, limit, error);
        if (status != RT_OK) {
            rt_grid_destroy(accel);
            return status;
        }
    }
    *out = accel;
    return RT_OK;
}

RtStatus rt_grid_build(const RtScene *scene, const RtValue *values, RtAccel **out, RtError *error) {
    return rt_grid_build_within(MAX_BYTES, scene, values, out, error);
}
