/* SPDX-License-Identifier: Apache-2.0 */
/* Which voxels an object goes into: all that its box meets, or (overlap=exact) those of them that its
 * surface comes within `margin` of, found by halving the range of voxels that the box meets.
 *
 * Why surfaces are enough: grid.c proves that the walk visits every voxel, on every level, whose three
 * intervals the thick ray is in at the t of a hit, and accel/surface.h that the voxels of its q are among
 * those and list the object. A test that halves a range says no only for what none of its voxels comes near.
 * With `slack` both boxes and surfaces may be so much farther away, which makes lists longer only. */
#include "accel/grid/grid.h"

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

/* The intervals of planes on `axis` that [lo, hi], which meets the block, takes: first to last. An interval
 * holds its lower plane but not its upper one, unless it is the last. */
static void touched(const RtGridBlock *block, int axis, float lo, float hi, uint32_t *first, uint32_t *last) {
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

RtGridRange rt_grid_touched(const RtGridBlock *block, const RtBox *box) {
    RtGridRange range;
    for (int a = 0; a < 3; a++) {
        touched(block, a, box->lo.at[a], box->hi.at[a], &range.from[a], &range.to[a]);
    }
    return range;
}

/* Halves the range along the axis of most voxels; false for a single voxel. */
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

/* Each halving leaves one range for later; 3 axes of 4096 voxels are halved 36 times. */
enum { MAX_RANGES = 40 };

void rt_grid_place(const RtGrid *grid, const RtGridBlock *block, uint32_t id,
                   void (*take)(void *context, const RtGridRange *range), void *context) {
    RtBox object = rt_grid_object_box(grid, id);
    RtGridRange stack[MAX_RANGES], range = rt_grid_touched(block, &object);
    uint32_t stacked = 0;
    if (!grid->surfaces) {
        take(context, &range);
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
            take(context, &range);
        }
        if (stacked == 0) return;
        range = stack[--stacked];
    }
}
