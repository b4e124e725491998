/* SPDX-License-Identifier: Apache-2.0 */
/* Shared by tests of accel/embree: soups of all shapes, rays that graze boxes, and answers next to those of
 * brute. */
#ifndef RT_TESTS_EMBREE_TESTING_H
#define RT_TESTS_EMBREE_TESTING_H

#include "accel_testing.h"
#include "random_testing.h"

#include "scenes/random_tree.h"

/* Prints why not; then the tests are skipped. */
static inline bool embree_is_built_in(void) {
    const RtAccelOps *ops;
    RtError error = {RT_OK, ""};
    if (rt_accel_find("embree", &ops, &error) == RT_OK) return true;
    printf("skipped: needs Embree: %s\n", error.message);
    return false;
}

/* Whether this processor and this Embree support the spec: Embree 4 has no streams. Any other refusal fails
 * the test. */
static inline bool embree_has(const char *text) {
    RtSpec spec;
    RtError why = {RT_OK, ""};
    assert_ok(rt_spec_parse(text, &spec, error));
    if (rt_spec_available(&spec, &why) == RT_OK) return true;
    char isa[16] = "?", missing[32];
    const char *at = strstr(text, "isa=");
    if (at) sscanf(at, "isa=%15[^,]", isa);
    snprintf(missing, sizeof missing, "has no %s;", isa);
    bool lacks_streams = strstr(text, "query=stream") && strstr(why.message, "Embree 4 has no streams;");
    if (!lacks_streams && !strstr(why.message, missing)) fail_msg("%s is refused: %s", text, why.message);
    return false;
}

/* ---- scenes and rays ---- */

static inline void add_triangle(RtScene *scene, RtRandom *random, float size, float edge) {
    RtVec3 corner = rt_random_point(random, size), v[3] = {corner};
    for (int i = 1; i < 3; i++) v[i] = rt_add(corner, rt_random_point(random, edge));
    assert_ok(rt_scene_add_triangle(scene, 0, v, NULL, error));
}

/* A rectangle, in the plane z = const for every other one. */
static inline void add_polygon(RtScene *scene, RtRandom *random, float size, float edge, bool flat) {
    RtVec3 corner = rt_random_point(random, size);
    RtVec3 a = rt_random_point(random, edge), b = rt_random_point(random, edge);
    if (flat) a.z = b.z = 0;
    RtVec3 v[4] = {corner, rt_add(corner, a), rt_add(rt_add(corner, a), b), rt_add(corner, b)};
    assert_ok(rt_scene_add_polygon(scene, 0, v, 4, error));
}

static inline void add_csg(RtScene *scene, RtRandom *random, RtVec3 center, float radius) {
    RtTransform move = rt_transform_identity();
    RtTreeRecipe recipe = {1 + rt_random_below(random, 8), false};
    OWNED_BUILDER trees = {0};
    RtCsgTerm root;
    assert_ok(rt_transform_scale(&move, rt_vec3(radius, radius, radius), error));
    assert_ok(rt_transform_translate(&move, center, error));
    assert_ok(rt_random_tree(&trees, random, &recipe, 1, &root, error));
    assert_ok(rt_csg_move(&trees, root, &move, &root, error));
    assert_ok(rt_scene_add_csg(scene, &trees, root, true, error));
}

/* `copies` times the same soup of all shapes: every hit of a second copy is a tie. */
static inline RtScene make_soup(uint32_t count, uint32_t copies, float size) {
    RtScene scene = begin_scene();
    for (uint32_t copy = 0; copy < copies; copy++) {
        RtRandom random = rt_random(7, 1);
        for (uint32_t i = 0; i < count; i++) {
            float edge = size * 0.2f, radius = size * rt_random_between(&random, 0.01f, 0.1f);
            RtVec3 center = rt_random_point(&random, size);
            switch (i % 5) {
            case 0: assert_ok(rt_scene_add_sphere(&scene, 0, center, radius, error)); break;
            case 1: add_polygon(&scene, &random, size, edge, i % 8 == 1); break;
            case 2: add_triangle(&scene, &random, size, edge); break;
            case 3: {
                RtVec3 apex = rt_add(center, rt_random_point(&random, edge));
                assert_ok(rt_scene_add_cone(&scene, 0, center, radius, apex, radius * 0.5f, error));
                break;
            }
            default: add_csg(&scene, &random, center, radius);
            }
        }
    }
    assert_ok(rt_scene_finish(&scene, error));
    return scene;
}

/* Of four directions one is parallel to an axis and one to a coordinate plane, or nearly. */
static inline RtVec3 direction(RtRandom *random) {
    RtVec3 d = rt_narrow(rt_random_direction(random));
    uint32_t bits = rt_random_bits(random);
    uint32_t axis = bits % 3, style = bits / 3 % 4;
    for (uint32_t a = 0; a < 3; a++) {
        static const float small[] = {0.0f, -0.0f, 1e-19f, -1e-19f};
        if (style == 0 && a != axis) d.at[a] = small[bits >> 8 & 3];
        if (style == 1 && a == axis) d.at[a] = small[bits >> 8 & 3];
    }
    if (d.x == 0 && d.y == 0 && d.z == 0) d.at[axis] = 1;
    return d;
}

/* Towards a point of the box of an object: a corner, or anything within; so that rays graze boxes. */
static inline RtVec3 target(const RtScene *scene, RtRandom *random) {
    const RtGeometry *g = &scene->geometry;
    const RtBox *box = &g->boxes[rt_random_below(random, g->object_count)];
    uint32_t bits = rt_random_bits(random);
    RtVec3 p;
    for (int a = 0; a < 3; a++) {
        float between = rt_random_between(random, box->lo.at[a], box->hi.at[a]);
        p.at[a] = bits & 8 ? between : bits >> a & 1 ? box->lo.at[a] : box->hi.at[a];
    }
    return p;
}

typedef struct Rays {
    RtRay *rays;
    size_t count;
} Rays;

static inline void free_rays(Rays *r) {
    rt_free(r->rays);
}

#define OWNED_RAYS OWNED(free_rays) Rays

/* Rays through a target each, from `distance` scene sizes away at most, with dir of every length and with and
 * without bounds; kinds in runs, so that packets are coherent and not. */
static inline Rays make_rays(const RtScene *scene, size_t count, float size, float distance) {
    Rays r = {rt_alloc(count, sizeof(RtRay)), count};
    assert_non_null(r.rays);
    RtRandom random = rt_random(11, 0);
    for (size_t i = 0; i < count; i++) {
        static const float lengths[] = {1, 1, 0.01f, 100, 1e-6f, 1e-30f, 1e18f, 1e30f};
        uint32_t bits = rt_random_bits(&random);
        float length = lengths[bits % 8];
        RtVec3 dir = direction(&random);
        float far = rt_random_between(&random, 0, distance) * size, back = far / length;
        RtRay *ray = &r.rays[i];
        *ray = (RtRay){.tmax = INFINITY, .kind = (uint32_t)(i / 100 % RT_RAY_KIND_COUNT)};
        ray->org = rt_sub(target(scene, &random), rt_scale(dir, far));
        ray->dir = rt_scale(dir, length);
        if ((bits >> 4) % 4 == 1) ray->tmin = rt_minf(back * 0.9f, FLT_MAX);
        if ((bits >> 6) % 4 == 1) ray->tmax = back * 1.2f;
        assert_true(rt_ray_is_valid(ray));
    }
    return r;
}

/* ---- answers ---- */

typedef struct Answers {
    RtHit *hits;
    bool *blocked;
    RtTally tallies[RT_RAY_KIND_COUNT]; /* of the nearest hits */
} Answers;

static inline Answers ask(const RtScene *scene, const char *spec, Rays rays, bool counted) {
    Answers a = {rt_alloc(rays.count, sizeof(RtHit)), rt_alloc(rays.count, sizeof(bool)), {{0}}};
    OWNED_ACCEL RtAccel *accel = open_valid(scene, spec);
    OWNED_QUERY query = open_query(accel);
    rt_nearest(&query, rays.rays, rays.count, a.hits, counted ? a.tallies : NULL);
    RtTally apart[RT_RAY_KIND_COUNT] = {{0}};
    rt_occluded(&query, rays.rays, rays.count, a.blocked, counted ? apart : NULL);
    return a;
}

static inline void forget(Answers *a) {
    rt_free(a->hits);
    rt_free(a->blocked);
}

#define OWNED_ANSWERS OWNED(forget) Answers

static inline void assert_same(const Answers *got, const Answers *right, Rays rays, const char *spec) {
    for (size_t i = 0; i < rays.count; i++) {
        RtHit g = got->hits[i], r = right->hits[i];
        if (g.object == r.object && memcmp(&g.t, &r.t, sizeof g.t) == 0 &&
            got->blocked[i] == right->blocked[i]) {
            continue;
        }
        const RtRay *ray = &rays.rays[i];
        fail_msg(
            "%s, ray %zu (%a %a %a) + t (%a %a %a) in %g..%g: object %u at %a, blocked %d; brute says %u "
            "at %a, %d",
            spec, i, (double)ray->org.x, (double)ray->org.y, (double)ray->org.z, (double)ray->dir.x,
            (double)ray->dir.y, (double)ray->dir.z, (double)ray->tmin, (double)ray->tmax, g.object,
            (double)g.t, got->blocked[i], r.object, (double)r.t, right->blocked[i]);
    }
}

/* Tests the specs that are available here. */
static inline void compare_with_brute(const RtScene *scene, Rays rays, const char *const *specs,
                                      size_t count) {
    OWNED_ANSWERS right = ask(scene, "brute", rays, false);
    for (size_t i = 0; i < count; i++) {
        if (!embree_has(specs[i])) continue;
        OWNED_ANSWERS got = ask(scene, specs[i], rays, i % 2 == 1);
        assert_same(&got, &right, rays, specs[i]);
    }
}

#endif
