/* SPDX-License-Identifier: Apache-2.0 */
/* Shared by tests of CSG trees: short notation for terms, the hits along a ray, random rays. */
#ifndef RT_TESTS_CSG_TESTING_H
#define RT_TESTS_CSG_TESTING_H

#include "crossings_testing.h"
#include "testing.h"

#include "core/shape/geometry.h"
#include "rays/rayset.h"
#include "scenes/build.h"

#define MAX_HITS 512

#define OWNED_TREES(builder, forest)                                                                         \
    OWNED_BUILDER builder = {0};                                                                             \
    OWNED_FOREST forest = {0}

static const RtVec3 along_x = {1, 0, 0};

/* Where the line of a ray goes in and out of a tree, for t >= tmin. */
typedef struct Hits {
    uint32_t count;
    float t[MAX_HITS];
} Hits;

static inline RtPreparedRay prepare(const RtRay *ray, const RtCsg *tree) {
    RtPreparedRay prepared = rt_ray_prepare(ray, &tree->box);
    prepared.crossings = hit_memory_of_tests();
    return prepared;
}

static inline Hits hits_of(const RtCsgForest *forest, const RtCsg *tree, const RtRay *ray) {
    Hits hits = {.count = 0};
    RtRay rest = *ray;
    RtPreparedRay prepared = prepare(&rest, tree);
    while (hits.count < MAX_HITS && rt_csg_hit(forest, tree, &prepared, &hits.t[hits.count], NULL)) {
        rest.tmin = nextafterf(hits.t[hits.count++], INFINITY);
        prepared = prepare(&rest, tree);
    }
    return hits;
}

static inline bool same_hits(const Hits *a, const Hits *b) {
    return a->count == b->count && memcmp(a->t, b->t, a->count * sizeof(float)) == 0;
}

static inline RtCsg compile(RtCsgForest *forest, const RtCsgBuilder *builder, RtCsgTerm root) {
    RtCsg tree;
    assert_ok(rt_csg_compile(forest, builder, root, true, &tree, error));
    return tree;
}

/* A copy of a tree of any forest, moved by `move` (NULL: in place). */
static inline RtCsg copied(RtCsgForest *forest, const RtCsgForest *from, const RtCsg *tree,
                           const RtTransform *move) {
    OWNED_BUILDER builder = {0};
    RtCsgTerm root;
    assert_ok(rt_csg_recover(&builder, from, tree, &root, error));
    if (move) assert_ok(rt_csg_move(&builder, root, move, &root, error));
    return compile(forest, &builder, root);
}

static inline RtCsgTerm combine(RtCsgBuilder *builder, RtCsgOp op, RtCsgTerm left, RtCsgTerm right) {
    RtCsgTerm term;
    assert_ok(rt_csg_combine(builder, op, left, right, &term, error));
    return term;
}

static inline RtCsgTerm join(RtCsgBuilder *b, RtCsgTerm left, RtCsgTerm right) {
    return combine(b, RT_CSG_UNION, left, right);
}

static inline RtCsgTerm meet(RtCsgBuilder *b, RtCsgTerm left, RtCsgTerm right) {
    return combine(b, RT_CSG_INTERSECTION, left, right);
}

static inline RtCsgTerm cut(RtCsgBuilder *b, RtCsgTerm left, RtCsgTerm right) {
    return combine(b, RT_CSG_DIFFERENCE, left, right);
}

/* A term for a solid just added. */
static inline RtCsgTerm term_of(RtCsgBuilder *b, uint32_t solid) {
    RtCsgTerm term;
    assert_ok(rt_csg_solid(b, solid, 0, &term, error));
    return term;
}

static inline void add_tree(RtGeometry *g, const RtCsgBuilder *b, RtCsgTerm root) {
    assert_ok(rt_geometry_add_csg(g, b, root, true, error));
}

static inline RtCsgTerm box(RtCsgBuilder *builder, RtVec3 lo, RtVec3 hi, uint32_t material) {
    RtCsgTerm term;
    assert_ok(rt_add_box(builder, (RtBox){lo, hi}, material, &term, error));
    return term;
}

static inline RtCsgTerm ball(RtCsgBuilder *builder, RtVec3 center, float radius, uint32_t material) {
    RtTransform place = rt_transform_identity();
    uint32_t solid;
    RtCsgTerm term;
    assert_ok(rt_transform_scale(&place, rt_vec3(radius, radius, radius), error));
    assert_ok(rt_transform_translate(&place, center, error));
    assert_ok(rt_solid_add_sphere(&builder->set, &place, &solid, error));
    assert_ok(rt_csg_solid(builder, solid, material, &term, error));
    return term;
}

static inline RtCsgTerm random_term(RtCsgBuilder *builder, RtRandom *random, uint32_t most, bool coarse) {
    RtTreeRecipe recipe = {1 + rt_random_below(random, most), coarse};
    RtCsgTerm term;
    assert_ok(rt_random_tree(builder, random, &recipe, 4, &term, error));
    return term;
}

/* Boxes at halves, under random operations: all arithmetic on them is exact. */
static inline RtCsgTerm random_boxes(RtCsgBuilder *builder, RtRandom *random, uint32_t count) {
    RtCsgTerm term = 0;
    for (uint32_t i = 0; i < count; i++) {
        RtVec3 lo, hi;
        for (int a = 0; a < 3; a++) {
            lo.at[a] = 0.5f * (float)(rt_random_below(random, 8)) - 3;
            hi.at[a] = lo.at[a] + 0.5f * (float)(1 + rt_random_below(random, 8));
        }
        RtCsgTerm next = box(builder, lo, hi, i);
        term = i == 0 ? next : combine(builder, (RtCsgOp)(rt_random_below(random, 3)), term, next);
    }
    return term;
}

/* Random chords; every other one from a point and towards a point of a grid of halves, so that it meets edges
 * and corners, runs along faces, and starts on them or inside. */
static inline RtRay tree_ray(RtRandom *random, uint32_t i) {
    const RtBall around = {{0, 0, 0}, 9};
    if (i % 2) return rt_sphere_chord(&around, random);
    RtRay ray = {.tmax = INFINITY};
    for (int a = 0; a < 3; a++) {
        ray.org.at[a] = 0.5f * (float)(rt_random_below(random, 25)) - 6;
        ray.dir.at[a] = 0.5f * (float)(rt_random_below(random, 9)) - 2;
    }
    if (ray.dir.x == 0 && ray.dir.y == 0 && ray.dir.z == 0) ray.dir.x = 1;
    return ray;
}

static inline void assert_hits(const RtCsgForest *forest, const RtCsg *tree, RtRay ray, uint32_t count,
                               const float *t) {
    Hits hits = hits_of(forest, tree, &ray);
    assert_int_equal(hits.count, count);
    for (uint32_t i = 0; i < count; i++) {
        if (hits.t[i] != t[i]) fail_msg("hit %u: %.9g, not %.9g", i, (double)hits.t[i], (double)t[i]);
    }
}

static inline RtCsgFacet facet_at(const RtCsgForest *forest, const RtCsg *tree, const RtRay *ray, float t) {
    RtPreparedRay prepared = prepare(ray, tree);
    return rt_csg_facet(forest, tree, &prepared, t);
}

#endif
