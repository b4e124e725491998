/* SPDX-License-Identifier: Apache-2.0 */
/* The parameters of a grid, and how they become a resolution. */
#include "accel/grid/grid.h"

#include "base/elementary.h"

#include <assert.h>
#include <string.h>

enum { MAX_RESOLUTION = 4096 };

const RtParam rt_grid_params[RT_GRID_PARAM_COUNT] = {
    [RT_GRID_RULE] =
        {.name = "rule",
         .type = RT_PARAM_CHOICE,
         .standard = "cubic",
         .choices = "cubic|woo|heterogeneous|regular",
         .meaning = "how density becomes a resolution: cubic voxels; Woo's by the longest side; "
                    "Klimaszewski's; as many along each axis",
         .source = "Cleary & Wyvill 1988; Woo 1992; Klimaszewski & Sederberg 1997; Jevans & Wyvill 1989"},
    [RT_GRID_DENSITY] = {.name = "density",
                         .type = RT_PARAM_FLOAT,
                         .standard = "4",
                         .lo = 1e-6,
                         .hi = 1e6,
                         .meaning = "voxels per object that the rule aims at",
                         .source = "between 1 (too coarse) and 20 of Havran & Sixta 1999",
                         .test_values = "0.001|1|20"},
    [RT_GRID_RESOLUTION] = {.name = "resolution",
                            .type = RT_PARAM_RESOLUTION,
                            .standard = "auto",
                            .lo = 1,
                            .hi = MAX_RESOLUTION,
                            .meaning = "voxels along x, y, z, of the outermost grid; auto follows the rule",
                            .source = "this program",
                            .test_values = "1x1x1|2x3x5|64x1x64"},
    [RT_GRID_DEPTH] = {.name = "depth",
                       .type = RT_PARAM_INT,
                       .standard = "1",
                       .lo = 1,
                       .hi = RT_GRID_MAX_LEVELS,
                       .meaning =
                           "levels of grids; from 2 on a voxel may hold a grid of its own, by the rule",
                       .source = "one grid; nested ones are Jevans & Wyvill 1989",
                       .test_values = "2|3"},
    [RT_GRID_NEST] =
        {.name = "nest",
         .type = RT_PARAM_INT,
         .standard = "8",
         .lo = 1,
         .hi = 1e6,
         .meaning = "depth=2 and more: most objects of a voxel that holds no grid, above the last level",
         .source = "the only number that gives the integers of Havran & Sixta 1999",
         .test_values = "1|30"},
    [RT_GRID_MARGIN] = {.name = "margin",
                        .type = RT_PARAM_FLOAT,
                        .standard = "0",
                        .lo = 0,
                        .hi = 1,
                        .meaning = "how much wider than the scene's box the grid is, as a part of it",
                        .source = "the published scene boxes are a little wider than tight",
                        .test_values = "0.01|1"},
    [RT_GRID_FLAT] = {.name = "flat",
                      .type = RT_PARAM_FLOAT,
                      .standard = "0",
                      .lo = 0,
                      .hi = 1e9,
                      .meaning = "by how much the grid's box reaches beyond objects without thickness",
                      .source = "0.02 comes nearest to the integers of Havran & Sixta 1999",
                      .test_values = "0.5"},
    [RT_GRID_SLACK] = {.name = "slack",
                       .type = RT_PARAM_FLOAT,
                       .standard = "0",
                       .lo = 0,
                       .hi = 1e9,
                       .meaning = "objects also go into the voxels that come so close, in units of the scene",
                       .source = "0.01 gives the integers of Havran & Sixta 1999 for nested grids",
                       .test_values = "0.1"},
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
