/* SPDX-License-Identifier: Apache-2.0 */
/* hall: a nave with two aisles, about 280,000 triangles and nothing else: long thin ones (fluted shafts,
 * mouldings, walls over arches) beside dense small ones (vases, balusters, chains), in a closed room, so that
 * every ray from inside hits something.
 *
 * Like the atria and sibeniks of the papers, but generated. x is across, y along, z up, in metres. The
 * room itself comes first: one closed sheet, a section swept along y and drawn together to a point at
 * either end; everything else stands or hangs inside it or is set into its walls. */
#include "core/base/elementary.h"
#include "scenes/builtin.h"

static const RtParam params[] = {
    {"size", RT_INT("8", 1, 100, "1|2"), "how fine round things are: a vase has 6 size x 5 size cells",
     "about 280,000 triangles, like the halls that papers use"},
};

enum { PLASTER, LIGHT_MARBLE, DARK_MARBLE, STONE, COFFERS, GOLD, CHINA, TERRACOTTA, GLAZE, SKY, MATERIALS };

#define POLISHED(what, red, green, blue, mirrored)                                                           \
    RT_MATERIAL(what, red, green, blue, 0.12f, 0.7f, 0.35f, 40, mirrored)

static const RtMaterial materials[MATERIALS] = {
    [PLASTER] = RT_MATTE("plaster", 0.85f, 0.8f, 0.7f),
    [LIGHT_MARBLE] = POLISHED("light marble", 0.8f, 0.76f, 0.68f, 0.12f),
    [DARK_MARBLE] = POLISHED("dark marble", 0.36f, 0.18f, 0.14f, 0.12f),
    [STONE] = RT_MATTE("stone", 0.8f, 0.74f, 0.62f),
    [COFFERS] = RT_MATTE("coffers", 0.62f, 0.66f, 0.7f),
    [GOLD] = POLISHED("gold", 0.85f, 0.6f, 0.2f, 0.1f),
    [CHINA] = POLISHED("china", 0.9f, 0.9f, 0.92f, 0.1f),
    [TERRACOTTA] = POLISHED("terracotta", 0.7f, 0.33f, 0.18f, 0),
    [GLAZE] = POLISHED("glaze", 0.12f, 0.35f, 0.45f, 0.08f),
    [SKY] = RT_MATERIAL("sky", 0.65f, 0.8f, 1, 0.9f, 0.1f, 0, 1, 0),
};

enum { BAYS = 8, COFFERS_AROUND = 11, COFFERS_ALONG = 34, VASES = 3, CHANDELIERS = 4, CHAIN_LINKS = 66 };

static const double bay = 4, column_x = 5, nave_x = 5.4, aisle_x = 9;
static const double aisle_top = 7.2, spring = 10, chandelier_z = 7;
static const double front_y = -1, back_y = 33, arch_z = 4.9, arch_radius = 1.55;

/* ---- ornaments: each stands on, or hangs at, the origin of b->transform ---- */

#define COUNT_OF(array) (uint32_t)(sizeof(array) / sizeof(array)[0])

static const RtVec3d origin = {0, 0, 0};

static void add_lathe(RtSceneBuilder *b, RtVec3d at, const RtVec3d *profile, uint32_t count, uint32_t steps,
                      uint32_t sides) {
    const RtLathe lathe = {at, profile, count, steps, sides};
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

/* As high as the arches begin, on a plinth of 1.24 by 1.24: mouldings, a fluted shaft (long thin triangles),
 * a capital with two rows of leaves. */
static void add_column(RtSceneBuilder *b, uint32_t size) {
    static const RtVec3d base[] = {{0.6, 0, 0.18},  {0.62, 0, 0.24}, {0.58, 0, 0.31},
                                   {0.5, 0, 0.34},  {0.48, 0, 0.39}, {0.52, 0, 0.43},
                                   {0.52, 0, 0.48}, {0.45, 0, 0.51}, {0.43, 0, 0.55}};
    static const RtVec3d bell[] = {{0.36, 0, 4.1}, {0.4, 0, 4.13},  {0.4, 0, 4.17}, {0.36, 0, 4.2},
                                   {0.36, 0, 4.4}, {0.42, 0, 4.58}, {0.56, 0, 4.7}};

    rt_build_box(b, rt_vec3d(-0.62, -0.62, 0), rt_vec3d(0.62, 0.62, 0.18), RT_SIDES_STANDING);
    add_lathe(b, origin, base, COUNT_OF(base), size + 4, 6 * size);
    add_shaft(b, size);
    add_lathe(b, origin, bell, COUNT_OF(bell), size + 2, 6 * size);
    add_leaves(b, size);
    rt_build_box(b, rt_vec3d(-0.6, -0.6, 4.7), rt_vec3d(0.6, 0.6, arch_z), RT_SIDES_ALL);
}

/* ---- vases and balusters ---- */

/* 1.3 high, on a block; vase `i` of the kinds in turn. */
static void add_vase(RtSceneBuilder *b, RtVec3d at, uint32_t i, uint32_t size) {
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
    static const RtVec3d *const profiles[VASES] = {amphora, jar, goblet};
    static const uint32_t glazes[VASES] = {TERRACOTTA, GLAZE, CHINA};
    rt_build_origin(b, at, 0);
    b->material = DARK_MARBLE;
    rt_build_box(b, rt_vec3d(-0.4, -0.4, 0), rt_vec3d(0.4, 0.4, 1), RT_SIDES_STANDING);
    at.z += 1;
    rt_build_origin(b, at, 0);
    b->material = glazes[i % VASES];
    add_lathe(b, origin, profiles[i % VASES], POINTS, 5 * size, 6 * size);
}

/* A baluster, .8 high and .2 thick. */
static void add_baluster(RtSceneBuilder *b, uint32_t size) {
    static const RtVec3d profile[] = {{0.09, 0, 0},   {0.09, 0, 0.06}, {0.04, 0, 0.1}, {0.1, 0, 0.28},
                                      {0.08, 0, 0.4}, {0.035, 0, 0.6}, {0.06, 0, 0.7}, {0.09, 0, 0.8}};
    add_lathe(b, origin, profile, COUNT_OF(profile), size + 2, size + 2);
}

/* ---- chandeliers ---- */

enum { CANDLES = 12, SPOKES = 6 };

static void add_candle(RtSceneBuilder *b, RtVec3d at, uint32_t size) {
    static const RtVec3d profile[] = {{0, 0, -0.02},   {0.1, 0, 0.02},  {0.11, 0, 0.05}, {0.035, 0, 0.05},
                                      {0.03, 0, 0.1},  {0.03, 0, 0.28}, {0.01, 0, 0.29}, {0.018, 0, 0.32},
                                      {0.01, 0, 0.36}, {0, 0, 0.4}};
    add_lathe(b, at, profile, COUNT_OF(profile), 2 * (COUNT_OF(profile) - 1), size + 2);
}

static void add_chain(RtSceneBuilder *b, uint32_t size) {
    for (uint32_t i = 0; i < CHAIN_LINKS; i++) {
        const RtTorus link = {.center = {0, 0, 0.5 + 0.12 * i},
                              .axis = (int)(i % 2),
                              .radius = 0.065,
                              .tube = 0.014,
                              .around = size / 2 + 4,
                              .sides = 4};
        rt_build_torus(b, &link);
    }
}

/* A chandelier, 2.3 across and hanging by a chain of links of .12 each; the origin is in the middle of its
 * ring. */
static void add_chandelier(RtSceneBuilder *b, uint32_t size) {
    static const RtVec3d hub[] = {{0, 0, -0.35},   {0.06, 0, -0.3}, {0.02, 0, -0.2}, {0.14, 0, -0.05},
                                  {0.14, 0, 0.05}, {0.04, 0, 0.2},  {0.06, 0, 0.4},  {0, 0, 0.45}};
    const RtTorus ring = {.axis = 2, .radius = 1, .tube = 0.05, .around = 6 * size, .sides = size + 2};
    rt_build_torus(b, &ring);
    add_lathe(b, origin, hub, COUNT_OF(hub), 3 * size, 2 * size + 2);
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
    add_chain(b, size);
}

/* ---- the room ---- */

enum { ARC_STEPS = 32, SECTION_POINTS = ARC_STEPS + 7, ROOM_ROWS = 12 };

/* Counter-clockwise seen along -y. */
static RtVec3d section_point(uint32_t i) {
    const RtVec3d right[4] = {
        {-aisle_x, 0, 0}, {aisle_x, 0, 0}, {aisle_x, 0, aisle_top}, {nave_x, 0, aisle_top}};
    if (i < 4) return right[i];
    if (i > ARC_STEPS + 4)
        return i == ARC_STEPS + 5 ? rt_vec3d(-nave_x, 0, aisle_top) : rt_vec3d(-aisle_x, 0, aisle_top);
    RtVec3d turn = rt_on_circle(i - 4, 2 * ARC_STEPS);
    return rt_vec3d(nave_x * turn.x, 0, spring + nave_x * turn.y);
}

/* The ends are drawn together to a point that sees the whole section. */
static RtVec3d room_point(const void *of, uint32_t column, uint32_t row) {
    (void)of;
    bool first = row == 0, last = row == ROOM_ROWS;
    double y = front_y + (back_y - front_y) * (first ? 0 : last ? 1 : (row - 1.0) / (ROOM_ROWS - 2));
    if (first || last) return rt_vec3d(0, y, 3);
    RtVec3d p = section_point(column);
    return rt_vec3d(p.x, y, p.z);
}

static void add_room(RtSceneBuilder *b) {
    b->material = PLASTER;
    rt_build_grid_mesh(b, &(RtGridMesh){.columns = SECTION_POINTS,
                                        .rows = ROOM_ROWS,
                                        .wrapped = true,
                                        .first_pole = true,
                                        .last_pole = true,
                                        .point = room_point});
}

/* ---- floor and vault ---- */

/* A rectangle that shrinks step by step, on levels above a ground: a tile or a coffer. */
typedef struct Panel {
    double lo[2], hi[2];       /* of the rectangle */
    uint32_t steps;            /* along each of its edges */
    const double (*levels)[2]; /* of row i: the remaining fraction of the rectangle, and its height */
} Panel;

/* The position of column and row in the rectangle, and its height: x, y, z. */
static RtVec3d panel_point(const void *of, uint32_t column, uint32_t row) {
    const Panel *panel = of;
    uint32_t edge = column / panel->steps;
    double along = 2.0 * (column % panel->steps) / panel->steps - 1, left = panel->levels[row][0];
    const RtVec3d border[4] = {{along, -1, 0}, {1, along, 0}, {-along, 1, 0}, {-1, -along, 0}};
    RtVec3d p = border[edge % 4];
    double center[2] = {(panel->lo[0] + panel->hi[0]) / 2, (panel->lo[1] + panel->hi[1]) / 2};
    return rt_vec3d(center[0] + left * p.x * (panel->hi[0] - center[0]),
                    center[1] + left * p.y * (panel->hi[1] - center[1]), panel->levels[row][1]);
}

static void add_panel(RtSceneBuilder *b, const Panel *panel, uint32_t rows, RtGridPoint *point) {
    rt_build_grid_mesh(b, &(RtGridMesh){.columns = 4 * panel->steps,
                                        .rows = rows,
                                        .wrapped = true,
                                        .last_pole = true,
                                        .point = point,
                                        .of = panel});
}

static void add_floor(RtSceneBuilder *b) {
    static const double levels[3][2] = {{0.99, 0}, {0.96, 0.01}, {0, 0.01}};
    const double tile = 1;
    for (int i = 0; i < 2 * (int)(aisle_x / tile); i++) {
        for (int j = 0; j < (int)((back_y - front_y) / tile); j++) {
            const Panel panel = {.lo = {i * tile - aisle_x, j * tile + front_y},
                                 .hi = {(i + 1) * tile - aisle_x, (j + 1) * tile + front_y},
                                 .steps = 1,
                                 .levels = levels};
            b->material = (i + j) % 2 ? DARK_MARBLE : LIGHT_MARBLE;
            add_panel(b, &panel, 2, panel_point);
        }
    }
}

/* The rectangle bent round the vault: x is an angle in degrees from the right, z a depth below the vault. */
static RtVec3d coffer_point(const void *of, uint32_t column, uint32_t row) {
    RtVec3d p = panel_point(of, column, row);
    RtTurn turn = rt_turn(p.x);
    double radius = nave_x - p.z;
    return rt_vec3d(radius * turn.cosine, p.y, spring + radius * turn.sine);
}

static void add_boss(RtSceneBuilder *b, double degrees, double y) {
    static const double levels[4][2] = {{1, 0.05}, {0.8, 0.15}, {0.4, 0.2}, {0, 0.22}};
    const Panel panel = {
        .lo = {degrees - 1.8, y - 0.17}, .hi = {degrees + 1.8, y + 0.17}, .steps = 2, .levels = levels};
    b->material = GOLD;
    add_panel(b, &panel, 3, coffer_point);
}

static void add_coffers(RtSceneBuilder *b, uint32_t size) {
    static const double levels[7][2] = {{1, 0.3},   {0.84, 0.3}, {0.78, 0.2}, {0.66, 0.2},
                                        {0.6, 0.1}, {0.5, 0.05}, {0, 0.05}};
    const double width = 180.0 / COFFERS_AROUND, length = (back_y - front_y) / COFFERS_ALONG;
    for (int i = 0; i < COFFERS_AROUND; i++) {
        for (int j = 0; j < COFFERS_ALONG; j++) {
            const Panel panel = {.lo = {i * width, front_y + j * length},
                                 .hi = {(i + 1) * width, front_y + (j + 1) * length},
                                 .steps = (size + 3) / 4,
                                 .levels = levels};
            b->material = COFFERS;
            add_panel(b, &panel, 6, coffer_point);
            add_boss(b, (i + 0.5) * width, front_y + (j + 0.5) * length);
        }
    }
}

/* ---- arcades ---- */

/* The section of a moulded arch: how far in from its radius, and how far along x from the middle. */
static const double moulding[][2] = {{-0.35, 0.36}, {-0.3, 0.42},  {-0.2, 0.42},   {-0.12, 0.36},
                                     {0, 0.34},     {0, -0.34},    {-0.12, -0.36}, {-0.2, -0.42},
                                     {-0.3, -0.42}, {-0.35, -0.36}};

enum { MOULDING_ROWS = sizeof moulding / sizeof moulding[0] - 1 };

static RtVec3d arch_point(const void *of, uint32_t column, uint32_t row) {
    uint32_t steps = *(const uint32_t *)of;
    double radius = arch_radius - moulding[row][0];
    RtVec3d turn = rt_scaled(rt_on_circle(column, 2 * steps), radius);
    return rt_vec3d(moulding[row][1], turn.x, arch_z + turn.y);
}

/* One side of the wall over an arch, at x = .35: from the arch (row 0) to the edge above and beside it. */
static RtVec3d wall_point(const void *of, uint32_t column, uint32_t row) {
    uint32_t steps = *(const uint32_t *)of;
    RtVec3d turn = rt_on_circle(column, 2 * steps);
    if (row == 0) return rt_vec3d(0.35, arch_radius * turn.x, arch_z + arch_radius * turn.y);
    double height = aisle_top - arch_z, half = bay / 2;
    double to_side = fabs(turn.x) > 0 ? half / fabs(turn.x) : 1e9;
    double to_top = turn.y > 0 ? height / turn.y : 1e9;
    double length = to_side < to_top ? to_side : to_top;
    return rt_vec3d(0.35, length * turn.x, arch_z + length * turn.y);
}

static void add_arch(RtSceneBuilder *b, uint32_t size, RtVec3d at) {
    uint32_t steps = 3 * size;
    b->material = STONE;
    rt_build_origin(b, at, 0);
    rt_build_grid_mesh(
        b, &(RtGridMesh){
               .columns = steps, .rows = MOULDING_ROWS, .smooth = true, .point = arch_point, .of = &steps});
    b->material = PLASTER;
    for (int side = 0; side < 2; side++) {
        rt_build_origin(b, at, 2 * side);
        rt_build_grid_mesh(b, &(RtGridMesh){.columns = steps, .rows = 1, .point = wall_point, .of = &steps});
    }
}

static void add_rail(RtSceneBuilder *b, double side, uint32_t size) {
    double x = side * 5, end = back_y - front_y;
    rt_build_origin(b, rt_vec3d(x, front_y, aisle_top), 0);
    b->material = STONE;
    rt_build_box(b, rt_vec3d(-0.45, 0, -0.3), rt_vec3d(0.45, end, 0), RT_SIDES_ALL);
    rt_build_box(b, rt_vec3d(-0.35, 0, 0.8), rt_vec3d(-0.1, end, 0.92), RT_SIDES_ALL);
    for (int i = 0; i < 2 * (int)end; i++) {
        rt_build_origin(b, rt_vec3d(x - side * 0.22, front_y + 0.5 * i + 0.25, aisle_top), 0);
        add_baluster(b, size);
    }
}

/* ---- furniture ---- */

/* A round window in the wall behind `at`, which faces +x turned by `quarters`; its frame is a ring. */
static void add_window(RtSceneBuilder *b, RtVec3d at, int quarters, double radius, uint32_t size) {
    rt_build_origin(b, at, quarters);
    b->material = STONE;
    const RtTorus frame = {
        .axis = 0, .radius = radius, .tube = radius / 6, .around = 4 * size, .sides = size + 2};
    rt_build_torus(b, &frame);
    const RtVec3d middle = {0.03, 0, 0};
    RtVec3d before = {0.03, radius, 0};
    for (uint32_t i = 1; i <= 4 * size; i++) {
        RtVec3d turn = rt_on_circle(i, 4 * size), after = {0.03, radius * turn.x, radius * turn.y};
        b->material = SKY;
        rt_build_triangle(b, middle, before, after);
        b->material = STONE;
        if (i % 4 == 0) rt_build_prism(b, middle, radius / 20, after, radius / 20, 4);
        before = after;
    }
}

static void add_side(RtSceneBuilder *b, double side, uint32_t size) {
    for (uint32_t i = 0; i <= BAYS; i++) {
        rt_build_origin(b, rt_vec3d(side * column_x, bay * i, 0), 0);
        b->material = STONE;
        add_column(b, size);
        RtVec3d half = {0.25, 0.4, 0};
        rt_build_origin(b, rt_vec3d(side * (aisle_x - half.x), bay * i, 0), 0);
        rt_build_box(b, rt_scaled(half, -1), rt_vec3d(half.x, half.y, aisle_top), RT_SIDES_ALL);
    }
    for (uint32_t i = 0; i < BAYS; i++) {
        double y = bay * (i + 0.5);
        add_arch(b, size, rt_vec3d(side * column_x, y, 0));
        add_window(b, rt_vec3d(side * nave_x, y, 9), side > 0 ? 2 : 0, 0.7, size);
        if (i % 4 != 3) add_vase(b, rt_vec3d(side * 7.8, y, 0), i, size);
    }
    add_rail(b, side, size);
}

/* A teapot, as large as it deserves. */
static void add_monument(RtSceneBuilder *b, uint32_t size) {
    rt_build_origin(b, rt_vec3d(0, 15, 0), 0);
    b->material = DARK_MARBLE;
    rt_build_box(b, rt_vec3d(-1.3, -1.3, 0), rt_vec3d(1.3, 1.3, 0.4), RT_SIDES_STANDING);
    b->material = STONE;
    rt_build_box(b, rt_vec3d(-0.9, -0.9, 0.4), rt_vec3d(0.9, 0.9, 1.5), RT_SIDES_STANDING);
    b->material = GOLD;
    b->transform = (RtTransform){{{0.4, 0, 0, 0}, {0, 0.4, 0, 15}, {0, 0, 0.4, 1.5}}};
    rt_build_teapot(b, size);
}

static void generate(RtSceneBuilder *b, const RtValue *values) {
    uint32_t size = (uint32_t)values[0].i;
    b->scene->camera.from = rt_vec3(2.3f, -0.6f, 2.4f);
    b->scene->camera.at = rt_vec3(-0.9f, 15, 4.6f);
    b->scene->camera.fov = 65;
    b->transformed = true;
    rt_build_materials(b, materials, MATERIALS);
    add_room(b);
    add_floor(b);
    add_coffers(b, size);
    add_side(b, -1, size);
    add_side(b, 1, size);
    add_window(b, rt_vec3d(0, back_y, 9.6), 3, 3.4, 3 * size);
    for (uint32_t i = 0; i < CHANDELIERS; i++) {
        RtVec3d at = rt_vec3d(0, (i + 0.5) * bay * BAYS / CHANDELIERS, chandelier_z);
        rt_build_light(b, rt_addd(at, rt_vec3d(0, 0, -0.8)), rt_vec3(0.29f, 0.26f, 0.22f));
        b->material = GOLD;
        rt_build_origin(b, at, 0);
        add_chandelier(b, size);
    }
    add_monument(b, size);
}

const RtBuiltin rt_builtin_hall = {
    .name = "hall",
    .summary = "a closed interior: columns, vault, vases; long thin triangles and small ones close together",
    .source = "modelled on the interiors in papers on hierarchies",
    RT_PARAMS_OF(params),
    .generate = generate,
};
