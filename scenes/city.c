/* SPDX-License-Identifier: Apache-2.0 */
/* city: size x size blocks of houses and towers: faces along the axes, most of which share their planes with
 * many others (walls of neighbours, floors of windows, pavements), beside cylinders and spheres.
 *
 * Hard for structures that split space by planes: cells become flat, and the choice of the split plane
 * matters a lot. Lengths are in metres. Block (i, j) depends only on random stream (i, j); towers are
 * likely, and tall, near the middle. As an instance, a block is one of a few, which are in the order of their
 * towers; half of them are turned by 180 degrees. Each piece of a block stands at the origin of b->transform,
 * with its front, if it has one, towards -y; quads are polygons. */
#include "scenes/builtin.h"

#define PARAMS(X)                                                                                            \
    X(SIZE, "size", RT_INT("9", 1, 150, "1|3"),                                                              \
      "blocks along each edge of the city, of about 600 objects each", "tens of thousands of objects")       \
    X(SEED, RT_BUILTIN_SEED)                                                                                 \
    X(INSTANCES, RT_BUILTIN_INSTANCES)                                                                       \
    X(PARTS, RT_BUILTIN_PARTS("blocks"))

enum { PARAMS(RT_PARAM_INDEX) };
static const RtParam params[] = {PARAMS(RT_PARAM_ENTRY)};

static const double block = 72, street = 18, kerb = 0.2, pavement = 4;

enum { LOTS_ALONG = 3, LAMPS = 3, DASHES = 6, STREET_CARS = 3, STRIPES = 6 };

enum {
    ASPHALT,
    PAVING,
    PAINT,
    WALLS, /* the first of WALL_COUNT */
    WALL_COUNT = 6,
    GLASS = WALLS + WALL_COUNT,
    TILES,
    ROOF,
    METAL,
    LIGHT,
    GRASS,
    LEAVES,
    BARK,
    WATER,
    CARS, /* the first of CAR_COUNT */
    CAR_COUNT = 4,
    MATERIALS = CARS + CAR_COUNT
};

#define WALL(red, green, blue)      RT_MATTE("wall", red, green, blue)
#define CAR_PAINT(red, green, blue) RT_MATTE("car paint", red, green, blue)

static const RtMaterial materials[MATERIALS] = {
    [ASPHALT] = RT_MATTE("asphalt", 0.22f, 0.22f, 0.23f),
    [PAVING] = RT_MATTE("paving", 0.52f, 0.5f, 0.47f),
    [PAINT] = RT_MATTE("paint", 0.85f, 0.85f, 0.82f),
    [WALLS] = WALL(0.55f, 0.26f, 0.18f),
    [WALLS + 1] = WALL(0.72f, 0.62f, 0.45f),
    [WALLS + 2] = WALL(0.8f, 0.76f, 0.68f),
    [WALLS + 3] = WALL(0.45f, 0.47f, 0.5f),
    [WALLS + 4] = WALL(0.66f, 0.4f, 0.28f),
    [WALLS + 5] = WALL(0.62f, 0.66f, 0.66f),
    [GLASS] = RT_MATERIAL("glass", 0.1f, 0.16f, 0.22f, 0.12f, 0.6f, 0.5f, 60, 0.3f),
    [TILES] = RT_MATTE("tiles", 0.5f, 0.2f, 0.13f),
    [ROOF] = RT_MATTE("roof", 0.4f, 0.39f, 0.37f),
    [METAL] = RT_MATTE("metal", 0.5f, 0.52f, 0.55f),
    [LIGHT] = RT_MATERIAL("light", 1, 0.95f, 0.8f, 0.7f, 0.3f, 0, 1, 0),
    [GRASS] = RT_MATTE("grass", 0.2f, 0.42f, 0.14f),
    [LEAVES] = RT_MATTE("leaves", 0.14f, 0.36f, 0.1f),
    [BARK] = RT_MATTE("bark", 0.3f, 0.2f, 0.13f),
    [WATER] = RT_MATERIAL("water", 0.1f, 0.3f, 0.4f, 0.12f, 0.6f, 0, 1, 0.3f),
    [CARS] = CAR_PAINT(0.7f, 0.08f, 0.06f),
    [CARS + 1] = CAR_PAINT(0.85f, 0.85f, 0.85f),
    [CARS + 2] = CAR_PAINT(0.08f, 0.15f, 0.4f),
    [CARS + 3] = CAR_PAINT(0.9f, 0.7f, 0.1f),
};

/* ---- in the street ---- */

static void add_car(RtSceneBuilder *b, RtRandom *random) {
    b->material = CARS + rt_random_below(random, CAR_COUNT);
    rt_build_box(b, rt_vec3d(0, -0.9, 0.35), rt_vec3d(4.4, 0.9, 0.95), RT_SIDES_ALL);
    b->material = GLASS;
    rt_build_box(b, rt_vec3d(0.9, -0.8, 0.95), rt_vec3d(3.4, 0.8, 1.5), RT_SIDES_STANDING);
    b->material = ASPHALT;
    for (int i = 0; i < 4; i++) {
        double x = i < 2 ? 0.85 : 3.5, y = i % 2 ? 0.7 : -0.95;
        rt_build_cone(b, rt_vec3d(x, y, 0.33), 0.33, rt_vec3d(x, y + 0.25, 0.33), 0.33);
    }
}

static void add_lamp(RtSceneBuilder *b) {
    const RtVec3d foot = {0, 0, 0}, top = {0, 0, 6}, end = {0, -1.8, 6.4};
    b->material = METAL;
    rt_build_cone(b, foot, 0.12, top, 0.07);
    rt_build_cone(b, top, 0.07, end, 0.05);
    b->material = LIGHT;
    rt_build_sphere(b, end, 0.35);
}

static void add_tree(RtSceneBuilder *b, RtRandom *random) {
    double height = rt_random_betweend(random, 2.5, 4.5), crown = rt_random_betweend(random, 1.3, 2.2);
    RtVec3d fork = {0, 0, height}, left = {-0.5 * crown, 0.3 * crown, height + 0.6 * crown};
    RtVec3d right = {0.4 * crown, -0.3 * crown, height + 1.2 * crown};
    b->material = BARK;
    rt_build_cone(b, rt_vec3d(0, 0, 0), 0.25, fork, 0.15);
    b->material = LEAVES;
    rt_build_sphere(b, left, crown);
    rt_build_sphere(b, right, 0.9 * crown);
}

enum { PARK_TREES = 40, BASIN_SIDES = 24 };

/* A square `edge` long, with the origin in its lower left corner. */
static void add_park(RtSceneBuilder *b, RtRandom *random, double edge) {
    RtTransform place = b->transform;
    RtVec3d middle = {edge / 2, edge / 2, 0};
    b->material = GRASS;
    rt_build_box(b, rt_vec3d(0, 0, 0), rt_vec3d(edge, edge, 0.1), RT_SIDES_STANDING);
    b->material = PAVING;
    rt_build_box(b, rt_vec3d(middle.x - 2, 0, 0), rt_vec3d(middle.x + 2, edge, 0.13), RT_SIDE_TOP);
    rt_build_box(b, rt_vec3d(0, middle.y - 2, 0), rt_vec3d(edge, middle.y + 2, 0.13), RT_SIDE_TOP);
    /* A fountain: a basin, a column and a bowl. */
    const RtVec3d rim = {middle.x, middle.y, 0.9}, water = {middle.x, middle.y, 0.7};
    const RtVec3d top = {middle.x, middle.y, 3}, bowl = {middle.x, middle.y, 3.6};
    rt_build_cone(b, middle, 7, rim, 7);
    rt_build_cone(b, middle, 6.6, rim, 6.6);
    rt_build_cone(b, rim, 6.6, rt_vec3d(rim.x, rim.y, 0.91), 7);
    rt_build_cone(b, middle, 0.4, top, 0.3);
    rt_build_cone(b, top, 0.3, bowl, 2);
    b->material = WATER;
    rt_build_disc(b, water, 6.6, BASIN_SIDES);
    rt_build_disc(b, rt_vec3d(bowl.x, bowl.y, 3.5), 1.8, BASIN_SIDES);
    for (int i = 0; i < PARK_TREES; i++) {
        /* In the four lawns between the paths. */
        double lawn = edge / 2 - 12, x = rt_random_betweend(random, 2, lawn),
               y = rt_random_betweend(random, 2, lawn);
        RtVec3d at = {i & 1 ? edge - x : x, i & 2 ? edge - y : y, 0};
        b->transform = place;
        rt_build_origin(b, rt_transform_pointd(&place, at), 0);
        add_tree(b, random);
    }
}

/* ---- buildings ---- */

/* Ground to build on: width along the street, depth away from it. */
typedef struct Lot {
    RtSceneBuilder *b;
    RtRandom *random;
    RtVec3d corner; /* left in front, in the scene */
    int quarters;   /* turns, counter-clockwise, that bring its front from -y to where it looks */
    double width, depth;
    double downtown; /* 0 at the edge of the city to 1 in the middle */
} Lot;

static const double storey = 3.4;

static double between(const Lot *lot, double lo, double hi) {
    return rt_random_betweend(lot->random, lo, hi);
}

/* The next parts have their origin at (x, y, z) of the lot and are turned by `quarters`. */
static void stand(const Lot *lot, double x, double y, double z, int quarters) {
    rt_build_origin(lot->b, lot->corner, lot->quarters);
    RtVec3d at = rt_transform_pointd(&lot->b->transform, rt_vec3d(x, y, z));
    rt_build_origin(lot->b, at, lot->quarters + quarters);
}

/* Windows slightly in front of a wall at y = 0, from x0 to x1 and from z0 upwards. */
static void add_windows(RtSceneBuilder *b, double x0, double x1, double z0, uint32_t storeys, uint32_t bays) {
    double bay = (x1 - x0) / bays, pier = bays == 1 ? 0.3 : 0.22 * bay;
    b->material = GLASS;
    for (uint32_t i = 0; i < storeys; i++) {
        for (uint32_t j = 0; j < bays; j++) {
            RtVec3d lo = {x0 + bay * j + pier, -0.05, z0 + storey * i + 0.9};
            RtVec3d hi = {x0 + bay * (j + 1) - pier, 0, z0 + storey * i + 2.7};
            rt_build_box(b, lo, hi, RT_SIDE_FRONT);
        }
    }
}

/* A water tank on legs, as on roofs. */
static void add_tank(RtSceneBuilder *b) {
    b->material = METAL;
    for (int i = 0; i < 4; i++) {
        double x = i & 1 ? 1 : -1, y = i & 2 ? 1 : -1;
        rt_build_cone(b, rt_vec3d(x, y, 0), 0.1, rt_vec3d(x, y, 2), 0.1);
    }
    const RtVec3d bottom = {0, 0, 2}, top = {0, 0, 4.6}, tip = {0, 0, 5.7};
    b->material = BARK;
    rt_build_disc(b, bottom, 1.7, 16);
    rt_build_cone(b, bottom, 1.7, top, 1.7);
    b->material = ROOF;
    rt_build_cone(b, top, 1.9, tip, 0);
}

/* A parapet around a flat roof, and what stands on it. */
static void add_flat_roof(const Lot *lot, double height) {
    RtSceneBuilder *b = lot->b;
    double w = lot->width, d = lot->depth, t = 0.4;
    const RtVec3d lo[4] = {{0, 0, 0}, {0, d - t, 0}, {0, t, 0}, {w - t, t, 0}};
    const RtVec3d hi[4] = {{w, t, 1}, {w, d, 1}, {t, d - t, 1}, {w, d - t, 1}};
    stand(lot, 0, 0, height, 0);
    for (int i = 0; i < 4; i++) rt_build_box(b, lo[i], hi[i], RT_SIDES_STANDING);
    b->material = METAL;
    for (uint32_t i = rt_random_below(lot->random, 3); i > 0; i--) {
        double x = between(lot, 2, w - 5), y = between(lot, 2, d - 5);
        rt_build_box(b, rt_vec3d(x, y, 0), rt_vec3d(x + 2.5, y + 1.5, 1.4), RT_SIDES_STANDING);
    }
    if (rt_random_below(lot->random, 3) != 0) return;
    double x = between(lot, 3, w - 3), y = between(lot, 3, d - 3);
    stand(lot, x, y, height, 0);
    add_tank(b);
}

/* A ridge along the street, and chimneys. */
static void add_gable(const Lot *lot, double height) {
    RtSceneBuilder *b = lot->b;
    double w = lot->width, d = lot->depth, rise = between(lot, 4, 7);
    const RtVec3d corners[6] = {{0, 0, 0}, {w, 0, 0},        {w, d, 0},
                                {0, d, 0}, {0, d / 2, rise}, {w, d / 2, rise}};
    const RtVec3d left[3] = {corners[0], corners[4], corners[3]},
                  right[3] = {corners[1], corners[2], corners[5]};
    stand(lot, 0, 0, height, 0);
    rt_build_polygon(b, left, 3);
    rt_build_polygon(b, right, 3);
    const RtVec3d front[4] = {corners[0], corners[1], corners[5], corners[4]};
    const RtVec3d back[4] = {corners[2], corners[3], corners[4], corners[5]};
    b->material = TILES;
    rt_build_quad(b, front);
    rt_build_quad(b, back);
    b->material = WALLS;
    double x = between(lot, 2, w - 3), top = rise + 1.2;
    rt_build_box(b, rt_vec3d(x, 0.6 * d, 0), rt_vec3d(x + 1.2, 0.6 * d + 1, top), RT_SIDES_STANDING);
}

static void add_house(const Lot *lot) {
    RtSceneBuilder *b = lot->b;
    uint32_t storeys = 3 + rt_random_below(lot->random, 4), bays = 4 + rt_random_below(lot->random, 3);
    uint32_t wall = WALLS + rt_random_below(lot->random, WALL_COUNT);
    double height = storey * storeys + 0.6, w = lot->width, d = lot->depth;
    stand(lot, 0, 0, 0, 0);
    b->material = wall;
    rt_build_box(b, rt_vec3d(0, 0, 0), rt_vec3d(w, d, height), RT_SIDES_STANDING);
    /* A cornice, a shop with an awning, windows above. */
    rt_build_box(b, rt_vec3d(0, -0.4, height - 0.5), rt_vec3d(w, 0, height), RT_SIDES_ALL);
    const RtVec3d awning[4] = {{1, -1.6, 2.6}, {w - 1, -1.6, 2.6}, {w - 1, 0, 3.2}, {1, 0, 3.2}};
    b->material = CARS + rt_random_below(lot->random, CAR_COUNT);
    rt_build_quad(b, awning);
    b->material = GLASS;
    rt_build_box(b, rt_vec3d(1, -0.05, 0.4), rt_vec3d(w - 1, 0, 2.6), RT_SIDE_FRONT);
    add_windows(b, 0.5, w - 0.5, storey, storeys - 1, bays);
    b->material = wall;
    if (rt_random_below(lot->random, 2))
        add_flat_roof(lot, height);
    else
        add_gable(lot, height);
}

/* A shaft about the middle of the lot from `foot` up, a band of windows to each storey and side. */
static void add_shaft(const Lot *lot, double half, double foot, uint32_t storeys, uint32_t wall) {
    RtSceneBuilder *b = lot->b;
    RtVec3d lo = {-half, -half, 0}, hi = {half, half, storey * storeys};
    stand(lot, lot->width / 2, lot->depth / 2, foot, 0);
    b->material = wall;
    rt_build_box(b, lo, hi, RT_SIDES_STANDING);
    for (int side = 0; side < 4; side++) {
        stand(lot, lot->width / 2, lot->depth / 2, foot, side);
        RtVec3d out = rt_transform_pointd(&b->transform, rt_vec3d(0, -half, 0));
        rt_build_origin(b, out, lot->quarters + side);
        add_windows(b, -half, half, 0, storeys, 1);
    }
}

static void add_mast(RtSceneBuilder *b) {
    const RtVec3d bottom = {0, 0, 0}, top = {0, 0, 14};
    b->material = METAL;
    rt_build_cone(b, bottom, 0.5, top, 0.1);
    b->material = LIGHT;
    rt_build_sphere(b, top, 0.5);
}

/* Shafts that step back over a base. */
static void add_tower(const Lot *lot) {
    uint32_t wall = WALLS + rt_random_below(lot->random, WALL_COUNT);
    uint32_t shafts = 1 + rt_random_below(lot->random, 3);
    double half = 9.5, height = 0;
    for (uint32_t i = 0; i < shafts; i++) {
        uint32_t storeys = 4 + (uint32_t)(between(lot, 0.2, 1) * (4 + 16 * lot->downtown));
        add_shaft(lot, half, height, storeys, wall);
        height += storey * storeys;
        half *= 0.78;
    }
    stand(lot, lot->width / 2, lot->depth / 2, height, 0);
    if (rt_random_below(lot->random, 2))
        add_mast(lot->b);
    else
        add_tank(lot->b);
}

/* A cylinder with a ring of glass to each storey under a dome. */
static void add_round_tower(const Lot *lot) {
    RtSceneBuilder *b = lot->b;
    const double radius = 8.5;
    uint32_t storeys = 5 + (uint32_t)(between(lot, 0.3, 1) * (6 + 20 * lot->downtown));
    RtVec3d foot = {0, 0, 0}, top = {0, 0, storey * storeys + 1};
    stand(lot, lot->width / 2, lot->depth / 2, 0, 0);
    b->material = WALLS + rt_random_below(lot->random, WALL_COUNT);
    rt_build_cone(b, foot, radius, top, radius);
    rt_build_disc(b, top, radius, 32);
    b->material = GLASS;
    for (uint32_t i = 0; i < storeys; i++) {
        RtVec3d lo = {0, 0, storey * i + 0.9}, hi = {0, 0, storey * i + 2.8};
        rt_build_cone(b, lo, radius + 0.05, hi, radius + 0.05);
    }
    b->material = METAL;
    rt_build_sphere(b, top, 0.7 * radius);
}

/* A house that fills its lot up to the walls of its neighbours, or a tower. */
static void add_building(const Lot *lot) {
    double die = between(lot, 0, 1);
    if (die < 0.06 + 0.7 * lot->downtown)
        add_tower(lot);
    else if (die < 0.1 + 0.8 * lot->downtown)
        add_round_tower(lot);
    else
        add_house(lot);
}

/* ---- blocks and streets ---- */

/* Four quarter turns around the middle of the block bring the parts of one street to all sides. */
static void turn_block(RtSceneBuilder *b, RtVec3d corner, int quarters) {
    static const double x[4] = {0, 1, 1, 0}, y[4] = {0, 0, 1, 1};
    RtVec3d at = {corner.x + block * x[quarters], corner.y + block * y[quarters], corner.z};
    rt_build_origin(b, at, quarters);
}

/* Along the street in front of the block, at y < 0: marks, a crossing, cars, lamps and trees. */
static void add_street(RtSceneBuilder *b, RtRandom *random, RtVec3d corner, int quarters) {
    RtVec3d ground = {corner.x, corner.y, 0};
    turn_block(b, ground, quarters);
    b->material = PAINT;
    for (int i = 0; quarters % 2 == 0 && i < DASHES;
         i++) { /* in the middle of the street: for one side only */
        double x = block * (i + 0.3) / DASHES;
        rt_build_box(b, rt_vec3d(x, -street / 2 - 0.1, 0), rt_vec3d(x + 5, -street / 2 + 0.1, 0.02),
                     RT_SIDE_TOP);
    }
    for (int i = 0; i < STRIPES; i++) {
        double y = -street / 2 + 0.6 + 1.4 * i;
        rt_build_box(b, rt_vec3d(0.5, y, 0), rt_vec3d(3.5, y + 0.7, 0.02), RT_SIDE_TOP);
    }
    for (int i = 0; i < STREET_CARS; i++) {
        double x = 8 + block * (i + rt_random_betweend(random, 0, 0.6)) / STREET_CARS,
               y = i == 1 ? -6.6 : -2.4;
        turn_block(b, ground, quarters);
        RtVec3d at = rt_transform_pointd(&b->transform, rt_vec3d(x, y, 0));
        rt_build_origin(b, at, quarters);
        add_car(b, random);
    }
    for (int i = 0; i < LAMPS; i++) {
        turn_block(b, corner, quarters);
        double x = block * (i + 0.25) / LAMPS;
        RtVec3d lamp = rt_transform_pointd(&b->transform, rt_vec3d(x, 0.6, 0));
        RtVec3d tree = rt_transform_pointd(&b->transform, rt_vec3d(x + 11, 1.6, 0));
        rt_build_origin(b, lamp, quarters);
        add_lamp(b);
        rt_build_origin(b, tree, quarters);
        add_tree(b, random);
    }
}

/* Two rows of lots, back to back. */
static void add_lots(RtSceneBuilder *b, RtRandom *random, RtVec3d corner, double downtown) {
    double inner = block - 2 * pavement, width = inner / LOTS_ALONG;
    for (int row = 0; row < 2; row++) {
        double step = row ? -width : width, from = row ? block - pavement : pavement;
        for (int i = 0; i < LOTS_ALONG; i++) {
            Lot lot = {.b = b,
                       .random = random,
                       .corner = {corner.x + from + step * i, corner.y + from, corner.z},
                       .quarters = 2 * row,
                       .width = width,
                       .depth = inner / 2,
                       .downtown = downtown};
            add_building(&lot);
        }
    }
}

/* 0 at the edge of the city to 1 in the middle. */
static double downtown_at(int64_t i, int64_t j, int64_t size) {
    double middle = (double)(size - 1) / 2, reach = 0.5 * (double)size;
    double off_x = ((double)i - middle) / reach, off_y = ((double)j - middle) / reach;
    double away = off_x * off_x + off_y * off_y;
    return away < 1 ? (1 - away) * (1 - away) : 0;
}

static void add_block(RtSceneBuilder *b, RtRandom random, RtVec3d corner, double downtown) {
    rt_build_origin(b, rt_vec3d(corner.x, corner.y, 0), 0);
    b->material = PAVING;
    rt_build_box(b, rt_vec3d(0, 0, 0), rt_vec3d(block, block, kerb), RT_SIDES_STANDING);
    for (int quarters = 0; quarters < 4; quarters++) add_street(b, &random, corner, quarters);
    if (rt_random_below(&random, 8) != 0) {
        add_lots(b, &random, corner, downtown);
    } else {
        rt_build_origin(b, rt_vec3d(corner.x + pavement, corner.y + pavement, corner.z), 0);
        add_park(b, &random, block - 2 * pavement);
    }
}

/* ---- blocks as instances ---- */

#define PART_STREAM (UINT64_C(1) << 63)

static void make_parts(RtSceneBuilder *b, uint64_t seed, uint32_t parts) {
    for (uint32_t i = 0; i < parts; i++) {
        double share = (i + 0.5) / parts;
        rt_build_begin_part(b);
        rt_build_materials(b, materials, MATERIALS);
        add_block(b, rt_random(seed, PART_STREAM | i), rt_vec3d(0, 0, kerb), share * share);
        rt_build_end_part(b);
    }
}

static void add_instance(RtSceneBuilder *b, RtRandom random, RtVec3d corner, double downtown) {
    double share = 0.6 * downtown + rt_random_betweend(&random, 0, 0.4), half = block / 2;
    double sign = rt_random_below(&random, 2) ? -1 : 1; /* about the middle of the block */
    const RtTransform to_world = {{{sign, 0, 0, corner.x + half - sign * half},
                                   {0, sign, 0, corner.y + half - sign * half},
                                   {0, 0, 1, 0}}};
    rt_build_instance(b, (uint32_t)(share * b->part_count), &to_world);
}

static void generate(RtSceneBuilder *b, const RtValue *values) {
    int64_t size = values[SIZE].i;
    double end = (block + street) * (double)size, away = end + 60;
    RtScene *scene = b->scene;
    scene->camera.from = rt_narrow(rt_vec3d(end / 2 - 0.5 * away, -0.3 * away, 0.3 * away));
    scene->camera.at = rt_narrow(rt_vec3d(end / 2, 0.45 * end, 0.03 * end));
    scene->camera.fov = 40;
    scene->background = rt_vec3(0.5f, 0.68f, 0.9f);
    rt_build_light(b, rt_vec3d(-2 * end, -0.6 * end, 2.2 * end), rt_vec3(0.8f, 0.76f, 0.66f));
    rt_build_light(b, rt_vec3d(2 * end, -2.5 * end, 3 * end), rt_vec3(0.25f, 0.27f, 0.32f));
    b->transformed = true;
    rt_build_materials(b, materials, MATERIALS);
    b->polygons = true;
    b->material = ASPHALT;
    rt_build_box(b, rt_vec3d(-street, -street, 0), rt_vec3d(end, end, 0), RT_SIDE_TOP);
    const uint64_t seed = (uint64_t)values[SEED].i;
    const bool instances = values[INSTANCES].choice != RT_INSTANCES_OFF;
    b->flattened = values[INSTANCES].choice == RT_INSTANCES_FLATTENED;
    if (instances) make_parts(b, seed, (uint32_t)values[PARTS].i);
    for (int64_t j = 0; j < size; j++) {
        for (int64_t i = 0; i < size; i++) {
            const RtRandom random = rt_random(seed, (uint64_t)i << 32 | (uint64_t)j);
            const RtVec3d corner = {(block + street) * (double)i, (block + street) * (double)j, kerb};
            (instances ? add_instance : add_block)(b, random, corner, downtown_at(i, j, size));
        }
    }
}

const RtBuiltin rt_builtin_city = {
    .name = "city",
    .summary = "blocks of houses and towers: faces along the axes that share planes; cylinders and spheres",
    .source = "made to be hard for structures that divide space by planes",
    RT_PARAMS_OF(params),
    .generate = generate,
};
