/* SPDX-License-Identifier: Apache-2.0 */
/* The parameters of a grid, and how they become a resolution. */
#include "accel/grid/grid.h"

#include "core/base/elementary.h"

#include <assert.h>
#include <string.h>

const RtParam rt_grid_params[RT_GRID_PARAM_COUNT] = {RT_GRID_PARAMS(RT_PARAM_ENTRY)};

static uint32_t clamp_resolution(double n) {
    return n < 1 ? 1 : n > RT_GRID_MAX_RESOLUTION ? RT_GRID_MAX_RESOLUTION : (uint32_t)n;
}

/* Sizes of the box with no side thinner than 2^-10 of the longest: a flat scene has voxels, too. */
static RtVec3d solid_size(const RtBox *box) {
    RtVec3d s = rt_subd(rt_widen(box->hi), rt_widen(box->lo));
    double longest = fmax(s.x, fmax(s.y, s.z));
    if (longest == 0) return rt_vec3d(1, 1, 1);
    for (int a = 0; a < 3; a++) s.at[a] = fmax(s.at[a], longest * 0x1p-10) / longest;
    return s;
}

/* Rounds down, but takes what is a whole number up to rounding as that number. */
static double whole(double x) {
    return floor(x * (1 + 1e-12));
}

void rt_grid_choose_resolution(const RtBox *box, uint32_t objects, const RtValue *values, uint32_t n[3]) {
    RtVec3d s = solid_size(box); /* in units of the longest side */
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
