/* SPDX-License-Identifier: Apache-2.0 */
/* The voxels of a grid: its resolution, the voxels of an object, and the memory that both imply.
 *
 * An object goes into all voxels that its box meets, or with overlap=exact into those of them that its
 * surface comes within `margin` of, found by bisecting the range of voxels that the box meets. Why surfaces
 * suffice: grid.c proves that the walk visits every voxel, on every level, whose three intervals contain the
 * thick ray at the t of a hit; accel/clipping.h, that the voxels of its q are among those and list the
 * object. A range is rejected only if none of its voxels comes near. `slack` adds to both distances, which
 * only lengthens lists. */
#include "accel/grid/grid.h"

#include "core/base/elementary.h"

#include <assert.h>
#include <string.h>

/* ---- resolution ---- */

static uint32_t clamp_resolution(double n) {
    return n < 1 ? 1 : n > RT_GRID_MAX_RESOLUTION ? RT_GRID_MAX_RESOLUTION : (uint32_t)n;
}

/* The size of the box relative to its longest side, at least 2^-10: a flat scene has voxels, too. */
static RtVec3d solid_size(const RtBox *box) {
    RtVec3d s = rt_subd(rt_widen(box->hi), rt_widen(box->lo));
    double longest = fmax(s.x, fmax(s.y, s.z));
    if (longest == 0) return rt_vec3d(1, 1, 1);
    for (int a = 0; a < 3; a++) s.at[a] = fmax(s.at[a], longest * 0x1p-10) / longest;
    return s;
}

/* Rounds down, allowing for rounding errors just below an integer. */
static double whole(double x) {
    return floor(x * (1 + 1e-12));
}

void rt_grid_choose_resolution(const RtBox *box, uint32_t objects, const RtValue *values, uint32_t n[3]) {
    RtVec3d s = solid_size(box);
    double voxels = values[RT_GRID_DENSITY].f * objects;
    switch (values[RT_GRID_RULE].choice) {
    case RT_GRID_CUBIC: {
        double per_side = rt_cube_root(voxels / (s.x * s.y * s.z));
        for (int a = 0; a < 3; a++) n[a] = clamp_resolution(whole(s.at[a] * per_side + 0.5));
        break;
    }
    case RT_GRID_WOO:
        for (int a = 0; a < 3; a++) n[a] = clamp_resolution(whole(s.at[a] * rt_cube_root(voxels)));
        break;
    case RT_GRID_HETEROGENEOUS:
        n[0] = clamp_resolution(whole(rt_cube_root(voxels * s.x * s.x / (s.y * s.z)) + 0.5));
        n[1] = clamp_resolution(whole(sqrt(voxels * s.y / (n[0] * s.z)) + 0.5));
        n[2] = clamp_resolution(whole(voxels / ((double)n[0] * n[1]) + 0.5));
        break;
    case RT_GRID_REGULAR:
        n[0] = n[1] = n[2] = clamp_resolution(ceil(rt_cube_root(voxels) * (1 - 1e-12)));
        break;
    default: assert(false && "no such rule");
    }
}

/* ---- the voxels of an object ---- */

RtBox rt_grid_object_box(const RtGrid *grid, uint32_t id) {
    RtBox box = grid->base.scene->geometry.boxes[id];
    for (int a = 0; a < 3; a++) {
        box.lo.at[a] = rt_float_below((double)box.lo.at[a] - grid->slack);
        box.hi.at[a] = rt_float_above((double)box.hi.at[a] + grid->slack);
    }
    return box;
}

RtBox rt_grid_range_box(const RtGridBlock *block, const RtGridRange *range) {
    RtBox box;
    for (int a = 0; a < 3; a++) {
        box.lo.at[a] = block->planes[a][range->from[a]];
        box.hi.at[a] = block->planes[a][range->to[a] + 1];
    }
    return box;
}

bool rt_grid_surface_meets(const RtGrid *grid, const RtOutline *outline, const RtBox *box) {
    return rt_outline_meets_box(outline, box, grid->slack + grid->served.margin);
}

/* The first and last interval of planes on `axis` that [lo, hi], which meets the block, overlaps. An interval
 * contains its lower plane but not its upper one, unless it is the last. */
static void find_touched(const RtGridBlock *block, int axis, float lo, float hi, uint32_t *first,
                         uint32_t *last) {
    const float *plane = block->planes[axis];
    uint32_t n = block->n[axis];
    float width = plane[n] - plane[0];
    float guess = width > 0 ? (lo - plane[0]) / width * (float)n : 0;
    uint32_t i = guess > 0 ? (uint32_t)rt_minf(guess, (float)(n - 1)) : 0;
    while (i > 0 && plane[i] > lo) i--;
    while (i + 1 < n && plane[i + 1] <= lo) i++;
    *first = i;
    while (i + 1 < n && plane[i + 1] <= hi) i++;
    *last = i;
}

/* The range of voxels that a box overlaps, which must meet the block's. */
static RtGridRange find_range(const RtGridBlock *block, const RtBox *box) {
    RtGridRange range;
    for (int a = 0; a < 3; a++)
        find_touched(block, a, box->lo.at[a], box->hi.at[a], &range.from[a], &range.to[a]);
    return range;
}

/* Halves the range along its longest axis; false for a single voxel. */
static bool halve(RtGridRange *range, RtGridRange *other) {
    int axis = 0;
    for (int a = 1; a < 3; a++) {
        if (range->to[a] - range->from[a] > range->to[axis] - range->from[axis]) axis = a;
    }
    uint32_t middle = (range->from[axis] + range->to[axis]) / 2;
    if (range->from[axis] == range->to[axis]) return false;
    *other = *range;
    range->to[axis] = middle;
    other->from[axis] = middle + 1;
    return true;
}

/* Each halving pushes one range; 3 axes of 4096 voxels are halved 36 times. */
enum { MAX_RANGES = 40 };

void rt_grid_each_range(const RtGrid *grid, const RtGridBlock *block, uint32_t id,
                        void (*visit)(void *context, const RtGridRange *range), void *context) {
    RtBox object = rt_grid_object_box(grid, id);
    RtGridRange stack[MAX_RANGES], range = find_range(block, &object);
    uint32_t stacked = 0;
    if (!grid->surfaces) {
        visit(context, &range);
        return;
    }
    RtOutline outline = rt_object_outline(&grid->base.scene->geometry, id);
    for (;;) {
        RtBox box = rt_grid_range_box(block, &range);
        if (rt_grid_surface_meets(grid, &outline, &box)) {
            if (halve(&range, &stack[stacked])) {
                stacked++;
                continue;
            }
            visit(context, &range);
        }
        if (stacked == 0) return;
        range = stack[--stacked];
    }
}

/* ---- memory ---- */

/* Upper bound on the intervals of n along an axis that a box touches: planes are rounded. */
static double bound_touched(const RtBox *block, const RtBox *box, int axis, uint32_t n) {
    double lo = (double)block->lo.at[axis], hi = (double)block->hi.at[axis], width = hi - lo;
    if (!(width > 0)) return n;
    double slack = 1e-9 * n + n * 0x1p-23 * fmax(fabs(lo), fabs(hi)) / width;
    double first = floor(((double)box->lo.at[axis] - lo) / width * n - slack);
    double last = floor(((double)box->hi.at[axis] - lo) / width * n + slack);
    return fmin(last, n - 1.0) - fmax(first, 0) + 1;
}

double rt_grid_estimate(const RtGrid *grid, const RtBox *box, const uint32_t n[3], const uint32_t *ids,
                        uint32_t count) {
    double sum = (double)n[0] * n[1] * n[2] + 1;
    for (uint32_t i = 0; i < count; i++) {
        RtBox object = rt_grid_object_box(grid, ids[i]);
        double product = 1;
        for (int a = 0; a < 3; a++) product *= bound_touched(box, &object, a, n[a]);
        sum += product;
    }
    return sum * sizeof(uint32_t);
}

static void clamp_each(const uint32_t n[3], uint32_t most, uint32_t out[3]) {
    for (int a = 0; a < 3; a++) out[a] = n[a] < most ? n[a] : most;
}

RtStatus rt_grid_check_limit(const RtGrid *grid, const uint32_t n[3], const uint32_t *ids, uint32_t count,
                             uint64_t limit, RtError *error) {
    double bytes = rt_grid_estimate(grid, &grid->box, n, ids, count), most = (double)limit;
    if (bytes <= most) return RT_OK;
    /* Bisection: `fits` voxels a side fit, or it is 1; `excess` do not. */
    uint32_t fits = 1, excess = 1, smaller[3];
    for (int a = 0; a < 3; a++) excess = n[a] > excess ? n[a] : excess;
    while (fits + 1 < excess) {
        uint32_t middle = (fits + excess) / 2;
        clamp_each(n, middle, smaller);
        if (rt_grid_estimate(grid, &grid->box, smaller, ids, count) <= most)
            fits = middle;
        else
            excess = middle;
    }
    clamp_each(n, fits, smaller);
    return rt_fail(error, RT_BAD_INPUT,
                   "a grid of %ux%ux%u voxels would take up to %.3g GiB, more than %.3g GiB: "
                   "resolution=%ux%ux%u would fit",
                   n[0], n[1], n[2], bytes / 0x1p30, most / 0x1p30, smaller[0], smaller[1], smaller[2]);
}
