/* SPDX-License-Identifier: Apache-2.0 */
/* thicket: bushes, balls of small triangles, at the points of a cubic lattice, each turned another way: what
 * do instances cost that overlap, and what would a builder gain that opens their tops?
 *
 * Benthin, Woop, Wald & Afra 2017, "Improved Two-Level BVHs using Partial Re-Braiding", HPG, put upper nodes
 * of parts in place of instances. Here the bush is divided by its triangles' centres into octants: parts. */
#include "scenes/builtin.h"

#define PARAMS(X)                                                                                            \
    X(N, "n", RT_INT("216", 1, 1e6, "1|8"), "bushes", "six along an edge")                                   \
    X(TRIANGLES, "triangles", RT_INT("2000", 1, 1e6, "1|50"), "triangles of a bush", "enough for a part")    \
    X(SPACING, "spacing", RT_FLOAT("0.5", 0, 10, "0.1|1"), "from bush to bush, in diameters of a bush",      \
      "the boxes of 1 touch; here eight bushes share a place")                                               \
    X(OPENED, "opened", RT_INT("0", 0, 2, "0|1"), "how often a bush is divided into eight parts",            \
      "an instance for each bush")                                                                           \
    X(SEED, RT_BUILTIN_SEED)                                                                                 \
    X(INSTANCES, RT_BUILTIN_INSTANCES)

enum { PARAMS(RT_PARAM_INDEX) };
static const RtParam params[] = {PARAMS(RT_PARAM_ENTRY)};

static const RtMaterial leaf = RT_MATTE("leaf", 0.24f, 0.46f, 0.12f);

#define PART_STREAM (UINT64_C(1) << 63)

/* Of 8^opened; the cube has a half edge of 1. */
static uint32_t octant_of(RtVec3d center, int64_t opened) {
    uint32_t octant = 0;
    for (; opened > 0; opened--) {
        for (int a = 0; a < 3; a++) {
            const bool upper = center.at[a] >= 0;
            octant = 2 * octant + upper;
            center.at[a] = 2 * center.at[a] + (upper ? -1 : 1);
        }
    }
    return octant;
}

static RtVec3d in_ball(RtRandom *random) {
    RtVec3d at;
    do at = rt_random_in_cube(random);
    while (rt_dotd(at, at) > 1);
    return at;
}

/* The triangles of a bush whose centres lie in an octant of 8^opened. */
static void add_bush(RtSceneBuilder *b, const RtValue *values, uint64_t stream, int64_t opened,
                     uint32_t octant) {
    RtRandom random = rt_random((uint64_t)values[SEED].i, stream);
    if (b->counting && opened == 0) {
        b->count += (uint64_t)values[TRIANGLES].i;
        return;
    }
    for (int64_t i = 0; i < values[TRIANGLES].i; i++) {
        const RtVec3d center = in_ball(&random), along = rt_scaled(rt_random_direction(&random), 0.06),
                      across = rt_scaled(rt_random_direction(&random), 0.06);
        if (octant_of(center, opened) != octant) continue;
        rt_build_triangle(b, rt_subd(center, along), rt_addd(center, across), rt_addd(center, along));
    }
}

static RtTransform place_of(const RtValue *values, uint64_t i) {
    RtRandom random = rt_random((uint64_t)values[SEED].i, i);
    RtTransform place = rt_transform_identity();
    uint64_t edge = 1;
    while (edge * edge * edge < (uint64_t)values[N].i) edge++;
    const RtVec3d axis = rt_random_direction(&random);
    const double distance = 2 * values[SPACING].f, degrees = rt_random_betweend(&random, 0, 360);
    const uint64_t column = i % edge, row = i / edge % edge, layer = i / edge / edge;
    const RtVec3d at = {(double)column, (double)row, (double)layer};
    rt_transform_rotate(&place, rt_narrow(axis), degrees, NULL);
    rt_transform_translate(&place, rt_narrow(rt_scaled(at, distance)), NULL);
    return place;
}

static void generate(RtSceneBuilder *b, const RtValue *values) {
    const bool instances = values[INSTANCES].choice != RT_INSTANCES_OFF;
    const int64_t opened = instances ? values[OPENED].i : 0;
    const uint32_t octants = 1u << 3 * opened;
    b->transformed = true;
    rt_build_material(b, leaf);
    b->flattened = values[INSTANCES].choice == RT_INSTANCES_FLATTENED;
    for (uint32_t octant = 0; instances && octant < octants; octant++) {
        rt_build_begin_part(b);
        rt_build_material(b, leaf);
        add_bush(b, values, PART_STREAM, opened, octant);
        rt_build_end_part(b);
    }
    for (uint64_t i = 0; i < (uint64_t)values[N].i; i++) {
        const RtTransform place = b->counting ? rt_transform_identity() : place_of(values, i);
        for (uint32_t octant = 0; instances && octant < octants; octant++)
            if (b->part_sizes[octant] > 0) rt_build_instance(b, octant, &place);
        b->transform = place;
        if (!instances) add_bush(b, values, PART_STREAM | i, opened, 0);
    }
}

const RtBuiltin rt_builtin_thicket = {
    .name = "thicket",
    .summary = "bushes that overlap, whole or divided: what do overlapping instances cost?",
    .source = "made to measure instances",
    RT_PARAMS_OF(params),
    .generate = generate,
};
