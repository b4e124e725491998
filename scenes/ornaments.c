/* SPDX-License-Identifier: Apache-2.0 */
#include "scenes/ornaments.h"

#define COUNT_OF(array) (uint32_t)(sizeof(array) / sizeof(array)[0])

static void add_lathe(RtSceneBuilder *b, const RtVec3d *profile, uint32_t count, uint32_t steps,
                      uint32_t sides) {
    const RtLathe lathe = {.profile = profile, .count = count, .steps = steps, .sides = sides};
    rt_build_lathe(b, &lathe);
}

/* ---- columns ---- */

enum { FLUTES = 24, SHAFT_ROWS = 6, LEAVES = 8, LEAF_COLUMNS = 4 };

/* From the ridge between two flutes, at column 0, over the ground of the flute to the next. */
static RtVec3d shaft_point(const void *of, uint32_t column, uint32_t row) {
    uint32_t steps = *(const uint32_t *)of;
    double across = (double)(column % steps) / steps, up = (double)row / SHAFT_ROWS;
    double radius = 0.43 - 0.07 * up * (0.4 + 0.6 * up); /* entasis: it tapers more towards the top */
    double depth = row == 0 || row == SHAFT_ROWS ? 0 : 4 * across * (1 - across);
    RtVec3d turn = rt_scaled(rt_on_circle(column, FLUTES * steps), radius * (1 - 0.11 * depth));
    /* Flutes end shortly before the shaft does. */
    double z = row == 0 ? 0 : row == SHAFT_ROWS ? 1 : 0.02 + 0.96 * (row - 1) / (SHAFT_ROWS - 2);
    return rt_vec3d(turn.x, turn.y, 0.55 + 3.55 * z);
}

static void add_shaft(RtSceneBuilder *b, uint32_t size) {
    uint32_t steps = size / 2 + 1; /* of a flute */
    rt_build_grid_mesh(b, &(RtGridMesh){.columns = FLUTES * steps,
                                        .rows = SHAFT_ROWS,
                                        .wrapped = true,
                                        .point = shaft_point,
                                        .of = &steps});
}

typedef struct Leaf {
    RtVec3d out, across; /* unit */
    double foot, height, radius;
    uint32_t rows;
} Leaf;

/* Along a stem that leans on the bell and curls away from it, pointed at the tip. */
static RtVec3d leaf_point(const void *of, uint32_t column, uint32_t row) {
    const Leaf *leaf = of;
    double up = (double)row / leaf->rows, side = 2.0 * column / LEAF_COLUMNS - 1;
    double curl = up * up * up, width = 0.15 * (1 - curl) * (0.7 + up);
    double fold = 0.03 * side * side;
    double out = leaf->radius + 0.05 * up + 0.13 * curl - fold;
    double z = leaf->foot + leaf->height * (up - 0.35 * curl * up);
    RtVec3d p = rt_add_scaledd(rt_scaled(leaf->out, out), leaf->across, width * side);
    return rt_vec3d(p.x, p.y, z);
}

static void add_leaves(RtSceneBuilder *b, uint32_t size) {
    for (uint32_t i = 0; i < 2 * LEAVES; i++) {
        RtVec3d out = rt_on_circle(i, 2 * LEAVES);
        bool upper = i % 2;
        Leaf leaf = {.out = out,
                     .across = rt_vec3d(-out.y, out.x, 0),
                     .foot = upper ? 4.3 : 4.2,
                     .height = upper ? 0.52 : 0.36,
                     .radius = upper ? 0.37 : 0.4,
                     .rows = size + 1};
        rt_build_grid_mesh(b, &(RtGridMesh){.columns = LEAF_COLUMNS,
                                            .rows = leaf.rows,
                                            .last_pole = true,
                                            .smooth = true,
                                            .point = leaf_point,
                                            .of = &leaf});
    }
}

void rt_ornament_column(RtSceneBuilder *b, uint32_t size) {
    static const RtVec3d base[] = {{0.6, 0, 0.18},  {0.62, 0, 0.24}, {0.58, 0, 0.31},
                                   {0.5, 0, 0.34},  {0.48, 0, 0.39}, {0.52, 0, 0.43},
                                   {0.52, 0, 0.48}, {0.45, 0, 0.51}, {0.43, 0, 0.55}};
    static const RtVec3d bell[] = {{0.36, 0, 4.1}, {0.4, 0, 4.13},  {0.4, 0, 4.17}, {0.36, 0, 4.2},
                                   {0.36, 0, 4.4}, {0.42, 0, 4.58}, {0.56, 0, 4.7}};

    rt_build_box(b, rt_vec3d(-0.62, -0.62, 0), rt_vec3d(0.62, 0.62, 0.18), RT_SIDES_STANDING);
    add_lathe(b, base, COUNT_OF(base), size + 4, 6 * size);
    add_shaft(b, size);
    add_lathe(b, bell, COUNT_OF(bell), size + 2, 6 * size);
    add_leaves(b, size);
    rt_build_box(b, rt_vec3d(-0.6, -0.6, 4.7), rt_vec3d(0.6, 0.6, RT_COLUMN_HEIGHT), RT_SIDES_ALL);
}

/* ---- vases and balusters ---- */

void rt_ornament_vase(RtSceneBuilder *b, uint32_t size, uint32_t kind) {
    /* From the middle of the foot up the outside, over the lip and down inside. */
    enum { POINTS = 10 };
    static const RtVec3d amphora[POINTS] = {{0, 0, 0},       {0.24, 0, 0},   {0.22, 0, 0.08}, {0.1, 0, 0.2},
                                            {0.36, 0, 0.55}, {0.42, 0, 0.8}, {0.2, 0, 1.08},  {0.3, 0, 1.3},
                                            {0.17, 0, 1.1},  {0, 0, 0.4}};
    static const RtVec3d jar[POINTS] = {{0, 0, 0},      {0.2, 0, 0},     {0.17, 0, 0.06}, {0.3, 0, 0.3},
                                        {0.4, 0, 0.6},  {0.33, 0, 0.85}, {0.14, 0, 1.05}, {0.2, 0, 1.3},
                                        {0.11, 0, 1.1}, {0, 0, 0.3}};
    static const RtVec3d goblet[POINTS] = {{0, 0, 0},       {0.26, 0, 0},    {0.12, 0, 0.1}, {0.09, 0, 0.3},
                                           {0.2, 0, 0.5},   {0.48, 0, 0.75}, {0.5, 0, 1.0},  {0.56, 0, 1.3},
                                           {0.46, 0, 1.05}, {0, 0, 0.62}};
    static const RtVec3d *const profiles[RT_VASE_KINDS] = {amphora, jar, goblet};
    add_lathe(b, profiles[kind % RT_VASE_KINDS], POINTS, 5 * size, 6 * size);
}

void rt_ornament_baluster(RtSceneBuilder *b, uint32_t size) {
    static const RtVec3d profile[] = {{0.09, 0, 0},   {0.09, 0, 0.06}, {0.04, 0, 0.1}, {0.1, 0, 0.28},
                                      {0.08, 0, 0.4}, {0.035, 0, 0.6}, {0.06, 0, 0.7}, {0.09, 0, 0.8}};
    add_lathe(b, profile, COUNT_OF(profile), size + 2, size + 2);
}

/* ---- chandeliers ---- */

enum { CANDLES = 12, SPOKES = 6 };

static void add_candle(RtSceneBuilder *b, RtVec3d at, uint32_t size) {
    static const RtVec3d profile[] = {{0, 0, -0.02},   {0.1, 0, 0.02},  {0.11, 0, 0.05}, {0.035, 0, 0.05},
                                      {0.03, 0, 0.1},  {0.03, 0, 0.28}, {0.01, 0, 0.29}, {0.018, 0, 0.32},
                                      {0.01, 0, 0.36}, {0, 0, 0.4}};
    const RtLathe lathe = {.center = at,
                           .profile = profile,
                           .count = COUNT_OF(profile),
                           .steps = 2 * (COUNT_OF(profile) - 1),
                           .sides = size + 2};
    rt_build_lathe(b, &lathe);
}

static void add_chain(RtSceneBuilder *b, uint32_t size, uint32_t links) {
    for (uint32_t i = 0; i < links; i++) {
        const RtTorus link = {.center = {0, 0, 0.5 + 0.12 * i},
                              .axis = (int)(i % 2),
                              .radius = 0.065,
                              .tube = 0.014,
                              .around = size / 2 + 4,
                              .sides = 4};
        rt_build_torus(b, &link);
    }
}

void rt_ornament_chandelier(RtSceneBuilder *b, uint32_t size, uint32_t links) {
    static const RtVec3d hub[] = {{0, 0, -0.35},   {0.06, 0, -0.3}, {0.02, 0, -0.2}, {0.14, 0, -0.05},
                                  {0.14, 0, 0.05}, {0.04, 0, 0.2},  {0.06, 0, 0.4},  {0, 0, 0.45}};
    const RtTorus ring = {.axis = 2, .radius = 1, .tube = 0.05, .around = 6 * size, .sides = size + 2};
    rt_build_torus(b, &ring);
    add_lathe(b, hub, COUNT_OF(hub), 3 * size, 2 * size + 2);
    for (uint32_t i = 0; i < SPOKES; i++) {
        RtVec3d out = rt_on_circle(i, SPOKES), high = {0, 0, 0.3};
        rt_build_prism(b, rt_scaled(out, 0.1), 0.025, out, 0.025, size);
        rt_build_prism(b, high, 0.012, out, 0.012, size);
    }
    for (uint32_t i = 0; i < CANDLES; i++) {
        RtVec3d at = rt_scaled(rt_on_circle(2 * i + 1, 2 * CANDLES), 1.02);
        at.z = 0.05;
        add_candle(b, at, size);
    }
    add_chain(b, size, links);
}
