/* SPDX-License-Identifier: Apache-2.0 */
/* csg-field: n random CSG trees of 8 to 64 solids each, on a jittered grid, to measure the cost of a tree.
 *
 * Tree i depends only on random stream i. Its solids (spheres, boxes, cones, cylinders, tori, rotated at
 * random) lie in a ball and are joined as a balanced binary tree: unions near the root, so that no single
 * operation empties it, and any operation below. */
#include "scenes/builtin.h"

#define PARAMS(X)                                                                                            \
    X(N, "n", RT_INT("1000", 1, 1e6, "1|27"), "trees", "the size that experiments use")                      \
    X(LEAST, "least", RT_INT("8", 1, 4096, "1|8"), "minimum number of solids in a tree",                     \
      "a simple machine part")                                                                               \
    X(MOST, "most", RT_INT("64", 1, 4096, "64"), "maximum number of solids in a tree; at least `least`",     \
      "a complicated machine part")                                                                          \
    X(EXTENTS, "extents", RT_FLAG("on"), "trees skip inner nodes whose box a ray misses", "Roth 1982")       \
    X(SEED, RT_BUILTIN_SEED)

enum { PARAMS(RT_PARAM_INDEX) };
static const RtParam params[] = {PARAMS(RT_PARAM_ENTRY)};

typedef struct Field {
    RtCsgBuilder builder;
    RtRandom random; /* of the current tree */
    RtVec3d center;
    double radius; /* of the ball around its solids */
    RtError *error;
} Field;

static double between(Field *f, double lo, double hi) {
    return rt_random_betweend(&f->random, lo, hi);
}

/* ---- solids ---- */

static RtStatus add_turned_box(Field *f, RtVec3d center, double size, uint32_t *index) {
    RtVec3 half;
    for (int a = 0; a < 3; a++) half.at[a] = (float)(size * between(f, 0.3, 1));
    RtTransform place = rt_transform_identity();
    RtVec3 axis = rt_narrow(rt_random_direction(&f->random));
    uint32_t standing;
    RT_TRY(rt_solid_add_box(&f->builder.set, rt_scale(half, -1), half, &standing, f->error));
    RT_TRY(rt_transform_rotate(&place, axis, 15 * (double)(rt_random_below(&f->random, 24)), f->error));
    RT_TRY(rt_transform_translate(&place, rt_narrow(center), f->error));
    return rt_solid_add_moved(&f->builder.set, &f->builder.set, standing, &place, index, f->error);
}

static RtStatus add_solid(Field *f, uint32_t *index) {
    double away = f->radius * between(f, 0, 0.7);
    RtVec3d center = rt_add_scaledd(f->center, rt_random_direction(&f->random), away);
    RtVec3d axis = rt_random_direction(&f->random);
    double size = f->radius * between(f, 0.12, 0.3);
    RtVec3 base = rt_narrow(rt_add_scaledd(center, axis, -size));
    RtVec3 apex = rt_narrow(rt_add_scaledd(center, axis, size));
    RtSolidSet *set = &f->builder.set;
    float radius = (float)size;
    switch (rt_random_below(&f->random, 5)) {
    case 0:
        return rt_solid_add_ellipsoid(set, rt_narrow(center), rt_vec3(radius, radius, radius), index,
                                      f->error);
    case 1: return add_turned_box(f, center, size, index);
    case 2:
        radius = (float)(size * between(f, 0.3, 0.8));
        return rt_solid_add_frustum(set, base, radius, apex, radius, index, f->error);
    case 3:
        return rt_solid_add_frustum(set, base, radius, apex, (float)(size * between(f, 0, 0.9)), index,
                                    f->error);
    default:
        return rt_solid_add_ring(set, rt_narrow(center), rt_narrow(axis), (float)(size * 0.8),
                                 (float)(size * between(f, 0.15, 0.35)), index, f->error);
    }
}

/* ---- trees ---- */

static RtCsgOp choose_op(Field *f, uint32_t level) {
    uint32_t die = rt_random_below(&f->random, 8);
    if (level < 2 || die < 4) return RT_CSG_UNION;
    return die < 7 ? RT_CSG_DIFFERENCE : RT_CSG_INTERSECTION;
}

static RtStatus add_tree(Field *f, uint32_t solids, uint32_t level, RtCsgTerm *term) {
    if (solids == 1) {
        uint32_t index;
        RT_TRY(add_solid(f, &index));
        return rt_csg_solid(&f->builder, index, rt_random_below(&f->random, RT_STUDIO_MATERIALS), term,
                            f->error);
    }
    RtCsgTerm left, right;
    RtCsgOp op = choose_op(f, level);
    RT_TRY(add_tree(f, solids - solids / 2, level + 1, &left));
    RT_TRY(add_tree(f, solids / 2, level + 1, &right));
    return rt_csg_combine(&f->builder, op, left, right, term, f->error);
}

static void add_object(RtSceneBuilder *b, uint64_t i, const RtValue *values) {
    uint64_t edge = 1; /* trees along it */
    while (edge * edge * edge < (uint64_t)values[N].i) edge++;
    double spacing = 2 / (double)edge;
    Field f = {.random = rt_random((uint64_t)values[SEED].i, i), .radius = 0.55 * spacing, .error = b->error};
    uint64_t place[3] = {i % edge, i / edge % edge, i / edge / edge};
    for (int a = 0; a < 3; a++) f.center.at[a] = ((double)place[a] + between(&f, 0.4, 0.6)) * spacing - 1;
    uint32_t least = (uint32_t)values[LEAST].i, most = (uint32_t)values[MOST].i;
    if (most < least) most = least;
    RtCsgTerm root;
    RtStatus status = add_tree(&f, least + rt_random_below(&f.random, most - least + 1), 0, &root);
    if (status == RT_OK)
        status = rt_scene_add_csg(b->scene, &f.builder, root, values[EXTENTS].flag, b->error);
    rt_build_check(b, status);
    rt_csg_builder_clear(&f.builder);
}

static uint64_t object_count(const RtValue *values) {
    return (uint64_t)values[N].i;
}

static uint64_t object_bytes(const RtValue *values) {
    return RT_BUILTIN_OBJECT_BYTES + 1024 * (uint64_t)values[MOST].i; /* a solid and its node in the tree */
}

static void generate(RtSceneBuilder *b, const RtValue *values) {
    rt_build_studio(b, false);
    for (uint64_t i = 0; i < (uint64_t)values[N].i && b->status == RT_OK; i++) add_object(b, i, values);
}

const RtBuiltin rt_builtin_csg_field = {
    .name = "csg-field",
    .summary = "n CSG trees of 8 to 64 random solids, in four materials",
    .source = "made to measure CSG",
    RT_PARAMS_OF(params),
    .object_count = object_count,
    .object_bytes = object_bytes,
    .generate = generate,
};
