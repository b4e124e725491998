/* SPDX-License-Identifier: Apache-2.0 */
/* city: size x size blocks of houses and towers: faces along the axes, most of which share their planes with
 * many others (walls of neighbours, floors of windows, pavements), beside cylinders and spheres.
 *
 * Hard for structures that split space by planes: cells become flat, and the choice of the split plane
 * matters a lot. Lengths are in metres. Block (i, j) depends only on random stream (i, j); towers are
 * likely, and tall, near the middle. This file lays out blocks and streets; city_parts.c builds what
 * stands in them. */
#include "scenes/builtin.h"
#include "scenes/city_parts.h"

#define PARAMS(X)                                                                                            \
    X(SIZE, "size", RT_INT("9", 1, 150, "1|3"),                                                              \
      "blocks along each edge of the city, of about 600 objects each", "tens of thousands of objects")       \
    X(SEED, RT_BUILTIN_SEED)

enum { PARAMS(RT_PARAM_INDEX) };
static const RtParam params[] = {PARAMS(RT_PARAM_ENTRY)};

static const double block = 72, street = 18, kerb = 0.2, pavement = 4;

enum { LOTS_ALONG = 3, LAMPS = 3, DASHES = 6, CARS = 3, STRIPES = 6 };

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
    b->material = RT_CITY_PAINT;
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
    for (int i = 0; i < CARS; i++) {
        double x = 8 + block * (i + rt_random_betweend(random, 0, 0.6)) / CARS, y = i == 1 ? -6.6 : -2.4;
        turn_block(b, ground, quarters);
        RtVec3d at = rt_transform_pointd(&b->transform, rt_vec3d(x, y, 0));
        rt_build_origin(b, at, quarters);
        rt_city_car(b, random);
    }
    for (int i = 0; i < LAMPS; i++) {
        turn_block(b, corner, quarters);
        double x = block * (i + 0.25) / LAMPS;
        RtVec3d lamp = rt_transform_pointd(&b->transform, rt_vec3d(x, 0.6, 0));
        RtVec3d tree = rt_transform_pointd(&b->transform, rt_vec3d(x + 11, 1.6, 0));
        rt_build_origin(b, lamp, quarters);
        rt_city_lamp(b);
        rt_build_origin(b, tree, quarters);
        rt_city_tree(b, random);
    }
}

/* Two rows of lots, back to back. */
static void add_lots(RtSceneBuilder *b, RtRandom *random, RtVec3d corner, double downtown) {
    double inner = block - 2 * pavement, width = inner / LOTS_ALONG;
    for (int row = 0; row < 2; row++) {
        double step = row ? -width : width, from = row ? block - pavement : pavement;
        for (int i = 0; i < LOTS_ALONG; i++) {
            RtCityLot lot = {.b = b,
                             .random = random,
                             .corner = {corner.x + from + step * i, corner.y + from, corner.z},
                             .quarters = 2 * row,
                             .width = width,
                             .depth = inner / 2,
                             .downtown = downtown};
            rt_city_building(&lot);
        }
    }
}

static void add_block(RtSceneBuilder *b, uint64_t seed, int64_t i, int64_t j, int64_t size) {
    RtRandom random = rt_random(seed, (uint64_t)i << 32 | (uint64_t)j);
    double middle = (double)(size - 1) / 2, reach = 0.5 * (double)size;
    double off_x = ((double)i - middle) / reach, off_y = ((double)j - middle) / reach;
    double away = off_x * off_x + off_y * off_y, downtown = away < 1 ? (1 - away) * (1 - away) : 0;
    RtVec3d corner = {(block + street) * (double)i, (block + street) * (double)j, kerb};

    rt_build_origin(b, rt_vec3d(corner.x, corner.y, 0), 0);
    b->material = RT_CITY_PAVING;
    rt_build_box(b, rt_vec3d(0, 0, 0), rt_vec3d(block, block, kerb), RT_SIDES_STANDING);
    for (int quarters = 0; quarters < 4; quarters++) add_street(b, &random, corner, quarters);
    if (rt_random_below(&random, 8) != 0) {
        add_lots(b, &random, corner, downtown);
    } else {
        rt_build_origin(b, rt_vec3d(corner.x + pavement, corner.y + pavement, corner.z), 0);
        rt_city_park(b, &random, block - 2 * pavement);
    }
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
    rt_build_materials(b, rt_city_materials, RT_CITY_MATERIALS);
    b->polygons = true;
    b->material = RT_CITY_ASPHALT;
    rt_build_box(b, rt_vec3d(-street, -street, 0), rt_vec3d(end, end, 0), RT_SIDE_TOP);
    for (int64_t j = 0; j < size; j++) {
        for (int64_t i = 0; i < size; i++) add_block(b, (uint64_t)values[SEED].i, i, j, size);
    }
}

const RtBuiltin rt_builtin_city = {
    .name = "city",
    .summary = "blocks of houses and towers: faces along the axes that share planes; cylinders and spheres",
    .source = "made to be hard for structures that divide space by planes",
    RT_PARAMS_OF(params),
    .generate = generate,
};
