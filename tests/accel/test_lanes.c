/* SPDX-License-Identifier: Apache-2.0 */
/* accel/brute and accel/extents: what they do in lanes is what they do one record after the other, by every
 * instruction set that this machine has: the hits and the occluders bit for bit, and the counts, whatever the
 * length of a stream. Of `brute` that is what rt_test_all does. And accel/wide: spheres that it tests in
 * pairs with rays are hit as by rt_sphere_hit. */
#include "equivalence_testing.h"
#include "random_testing.h"

#include "accel/batch.h"
#include "accel/extents/extents.h"
#include "accel/kernel.h"
#include "accel/watertight.h"

RT_DECLARE_KERNELS(brute);

/* What is asked, and what is answered, timed and counted. */
typedef struct Asked {
    const RtRay *rays;
    size_t count;
    RtHit *hits;
    uint32_t *occluders;
    RtTally nearest[RT_RAY_KIND_COUNT], occluded[RT_RAY_KIND_COUNT];
} Asked;

static void clear(Asked *asked) {
    rt_free(asked->hits);
    rt_free(asked->occluders);
}

static Asked begin_asking(const RtRay *rays, size_t count) {
    Asked asked = {.rays = rays, .count = count};
    asked.hits = rt_alloc(count, sizeof(RtHit));
    asked.occluders = rt_alloc(count, sizeof(uint32_t));
    assert_true(asked.hits && asked.occluders);
    return asked;
}

/* One ray, one object after the other. */
static void by_definition(const RtQuery *query, Asked *asked) {
    const RtGeometry *geometry = &query->accel->scene->geometry;
    RtHitMemory *hit_memory = rt_query_hit_memory(query);
    for (size_t i = 0; i < asked->count; i++) {
        const RtRay *ray = &asked->rays[i];
        RtPreparedRay prepared;
        RtHit first = RT_MISS;
        rt_hit_ray(&prepared, geometry, ray, hit_memory);
        asked->hits[i] = RT_MISS;
        rt_test_all(geometry, &prepared, false, &asked->hits[i], &asked->nearest[ray->kind]);
        rt_test_all(geometry, &prepared, true, &first, &asked->occluded[ray->kind]);
        asked->occluders[i] = first.object;
        rt_count_answer(asked->hits[i].object != RT_NO_OBJECT, &asked->nearest[ray->kind]);
        rt_count_answer(first.object != RT_NO_OBJECT, &asked->occluded[ray->kind]);
    }
}

static void assert_same(const Asked *right, const Asked *got, bool counted, const char *who, size_t stream) {
    for (size_t i = 0; i < right->count; i++) {
        if (memcmp(&right->hits[i], &got->hits[i], sizeof(RtHit)) != 0 ||
            right->occluders[i] != got->occluders[i]) {
            fail_msg("%s, streams of %zu, counted %d: ray %zu is answered %u at %a, blocked by %u, not "
                     "%u at %a, %u",
                     who, stream, counted, i, got->hits[i].object, (double)got->hits[i].t, got->occluders[i],
                     right->hits[i].object, (double)right->hits[i].t, right->occluders[i]);
        }
    }
    if (!counted) return;
    assert_memory_equal(right->nearest, got->nearest, sizeof right->nearest);
    assert_memory_equal(right->occluded, got->occluded, sizeof right->occluded);
}

static void by_kernels(const RtKernels *kernels, const RtQuery *query, Asked *asked, size_t stream,
                       bool counted) {
    for (size_t first = 0; first < asked->count; first += stream) {
        size_t left = asked->count - first, n = left < stream ? left : stream;
        const RtRay *rays = asked->rays + first;
        (counted ? kernels->nearest_counted : kernels->nearest)(query->accel, query->scratch, rays, n,
                                                                asked->hits + first, NULL, asked->nearest);
        (counted ? kernels->occluded_counted : kernels->occluded)(query->accel, query->scratch, rays, n, NULL,
                                                                  asked->occluders + first, asked->occluded);
    }
}

/* Timed and counted. */
static void assert_kernels_are_right(const RtKernels *kernels, const RtQuery *query, const Asked *right,
                                     const char *who, size_t stream) {
    for (int counted = 0; counted < 2; counted++) {
        OWNED(clear) Asked got = begin_asking(right->rays, right->count);
        by_kernels(kernels, query, &got, stream, counted);
        assert_same(right, &got, counted, who, stream);
    }
}

static const RtKernels *brute_kernels(RtIsa isa) {
    return RT_KERNELS_FOR(brute, isa);
}

static const RtKernels *extents_kernels(RtIsa isa) {
    return RT_KERNELS_FOR(extents, isa);
}

/* `spec`, which is in lanes, by the kernels of every instruction set. */
static void assert_lanes_are_right(const char *spec, const RtKernels *(*kernels)(RtIsa), const RtScene *scene,
                                   const Asked *right) {
    const size_t streams[] = {1, 5, 128, right->count};
    OWNED_ACCEL RtAccel *lanes = open_accel(scene, spec);
    OWNED_QUERY query = open_query(lanes);
    char who[RT_MAX_SPEC_CHARS];
    assert_ptr_equal(query.accel->kernels, kernels(rt_isa_best()));
    for (RtIsa isa = RT_ISA_PORTABLE; isa <= RT_ISA_AVX512; isa++) {
        if (!rt_isa_runs(isa)) continue;
        snprintf(who, sizeof who, "%s by instruction set %d", spec, isa);
        for (size_t s = 0; s < sizeof streams / sizeof streams[0]; s++)
            assert_kernels_are_right(kernels(isa), &query, right, who, streams[s]);
    }
}

static void assert_lanes_change_nothing(const RtScene *scene, const RtRay *rays, size_t count) {
    OWNED(clear) Asked by_tests = begin_asking(rays, count), by_boxes = begin_asking(rays, count);
    OWNED_ACCEL RtAccel *brute = open_accel(scene, "brute:lanes=1");
    OWNED_ACCEL RtAccel *extents = open_accel(scene, "extents:lanes=1");
    OWNED_QUERY of_brute = open_query(brute), of_extents = open_query(extents);
    by_definition(&of_brute, &by_tests);
    assert_kernels_are_right(brute->kernels, &of_brute, &by_tests, "brute:lanes=1", count);
    assert_lanes_are_right("brute", brute_kernels, scene, &by_tests);
    by_kernels(extents->kernels, &of_extents, &by_boxes, count, true);
    assert_lanes_are_right("extents", extents_kernels, scene, &by_boxes);
}

/* By rays of every family. */
static void assert_lanes_change_nothing_in(const RtScene *scene, uint64_t seed, size_t rays) {
    size_t families = rt_ray_family_count();
    OWNED_MEMORY RtRay *all = rt_alloc(families * rays, sizeof(RtRay));
    OWNED_ACCEL RtAccel *bvh = open_accel(scene, "bvh");
    OWNED_QUERY query = open_query(bvh);
    assert_non_null(all);
    for (size_t f = 0; f < families; f++) rt_ray_family_fill(f, &query, seed, 0, rays, all + f * rays);
    assert_lanes_change_nothing(scene, all, families * rays);
}

RT_TEST(every_family_of_scenes_is_answered_and_counted_in_lanes_as_without) {
    for (size_t family = 0; family < rt_family_count(); family++) {
        for (uint64_t seed = 1; seed <= RT_SHARE(3, 1); seed++) {
            OWNED_SCENE scene = open_family(family, seed);
            assert_lanes_change_nothing_in(&scene, seed, 40);
        }
    }
}

RT_TEST(every_shape_and_every_remainder_of_lanes_is_answered_and_counted_as_without) {
    const char *specs[] = {"random:n=300,shape=mixed",
                           "random:n=1,shape=triangle",
                           "random:n=15,shape=triangle",
                           "random:n=17,shape=triangle",
                           "random:n=271,shape=triangle",
                           "random:n=3,shape=sphere",
                           "random:n=257,shape=sphere",
                           "random:n=0",
                           "tetra:size=4",
                           "balls:size=2",
                           "mount:size=4",
                           "teapot:size=3"};
    for (size_t i = 0; i < sizeof specs / sizeof specs[0]; i++) {
        OWNED_SCENE scene = open_scene(specs[i]);
        assert_lanes_change_nothing_in(&scene, i, 60);
    }
}

/* ---- extremes ---- */

/* From up to 2^24 times `size` away to somewhere within it, perhaps along an axis or in a plane of two; of
 * any length that float32 bears. */
static RtRay far_ray(RtRandom *random, float size) {
    RtRay ray;
    do {
        RtVec3 from = rt_random_point(random, ldexpf(size, (int)rt_random_below(random, 25)));
        RtVec3 dir = rt_sub(rt_random_point(random, size), from);
        uint32_t flat = rt_random_below(random, 16);
        int length = rt_random_below(random, 4) == 0 ? (int)rt_random_below(random, 250) - 140 : 0;
        for (int a = 0; a < 3; a++)
            dir.at[a] = flat >> a & 1 && flat < 8 ? 0 : ldexpf(dir.at[a] / size, length);
        ray = (RtRay){from, 0, dir, INFINITY, RT_RAY_RANDOM, 0};
    } while (!rt_ray_is_valid(&ray));
    return ray;
}

/* A point of the ray, about where it is nearest to `to`. */
static RtVec3d point_near(const RtRay *ray, RtVec3 to) {
    RtVec3d dir = rt_widen(ray->dir), way = rt_subd(rt_widen(to), rt_widen(ray->org));
    return rt_add_scaledd(rt_widen(ray->org), dir, rt_dotd(way, dir) / rt_dotd(dir, dir));
}

/* A sphere that the ray touches, but for rounding. */
static RtSphere touched_sphere(RtRandom *random, const RtRay *ray, float size) {
    float radius = ldexpf(size * (rt_random_unit(random) + 0.01f), -(int)rt_random_below(random, 20));
    RtVec3d across = rt_normalized(rt_crossd(rt_widen(ray->dir), rt_random_direction(random)));
    RtVec3d at = point_near(ray, rt_random_point(random, size));
    return (RtSphere){rt_narrow(rt_add_scaledd(at, across, (double)radius)), radius};
}

/* A triangle of which the ray meets an edge, or a vertex, but for rounding. */
static void touched_triangle(RtRandom *random, const RtRay *ray, float size, RtVec3 v[3]) {
    double small = ldexp((double)size, -(int)rt_random_below(random, 20));
    RtVec3d at = point_near(ray, rt_random_point(random, size));
    for (int i = 0; i < 3; i++) v[i] = rt_narrow(rt_add_scaledd(at, rt_random_direction(random), small));
    if (rt_random_below(random, 2) == 0)
        v[1] = rt_narrow(rt_add_scaledd(rt_scaled(at, 2), rt_widen(v[0]), -1));
    else
        v[0] = rt_narrow(at);
}

static void add_touched(RtScene *scene, RtRandom *random, const RtRay *ray, float size) {
    RtError refusal; /* beyond the largest coordinate: there are others */
    RtSphere sphere = touched_sphere(random, ray, size);
    RtVec3 v[3];
    touched_triangle(random, ray, size, v);
    if (rt_scene_add_sphere(scene, 0, sphere.center, sphere.radius, &refusal) != RT_OK) return;
    (void)rt_scene_add_triangle(scene, 0, v, NULL, &refusal);
}

RT_TEST(objects_of_every_magnitude_that_rays_touch_are_answered_in_lanes_as_without) {
    const float sizes[] = {1, 1e-30f, 1e-22f, 1e-12f, 1e6f, 1e16f, 4e17f};
    enum { RAYS = 500 };
    static RtRay rays[RAYS];
    for (size_t s = 0; s < sizeof sizes / sizeof sizes[0]; s++) {
        RtRandom random = rt_random(s, 7);
        OWNED_SCENE scene = begin_scene();
        for (int i = 0; i < RAYS; i++) {
            rays[i] = far_ray(&random, sizes[s]);
            add_touched(&scene, &random, &rays[i], sizes[s]);
        }
        assert_ok(rt_scene_finish(&scene, error));
        assert_true(scene.geometry.triangle_count > RAYS / 4);
        assert_lanes_change_nothing(&scene, rays, RAYS);
    }
}

/* ---- accel/sphere_pairs.h ---- */

enum { TOUCHING = 500, TURNS = 6 };

/* Spheres that rays touch, and such rays: as they are, from within a sphere, and beginning or ending at what
 * they hit, or a little after or before it. */
static void make_touching(RtScene *scene, float size, RtRay *rays, RtHit *hits) {
    RtRandom random = rt_random((uint64_t)(size < 1), 9);
    RtError refusal; /* beyond the largest coordinate: there are others */
    for (int i = 0; i < TOUCHING; i++) {
        RtRay *ray = &rays[i];
        do *ray = far_ray(&random, size);
        while (fabsf(ray->org.x) > size * 0x1p20f);
        RtSphere sphere = touched_sphere(&random, ray, size);
        (void)rt_scene_add_sphere(scene, 0, sphere.center, sphere.radius, &refusal);
        if (i % 4 == 0) ray->org = rt_add(sphere.center, rt_random_point(&random, 0.5f * sphere.radius));
        if (!rt_ray_is_valid(ray)) *ray = far_ray(&random, size);
    }
    assert_ok(rt_scene_finish(scene, error));
    OWNED_ACCEL RtAccel *brute = open_accel(scene, "brute:lanes=1");
    OWNED_QUERY query = open_query(brute);
    rt_nearest(&query, rays, TOUCHING, hits, NULL);
    for (int i = TOUCHING; i < TURNS * TOUCHING; i++) {
        float t = hits[i % TOUCHING].t;
        rays[i] = rays[i % TOUCHING];
        if (!isfinite(t)) continue;
        if (i / TOUCHING == 1) rays[i].tmin = rays[i].tmax = t;
        if (i / TOUCHING == 2) rays[i].tmin = t;
        if (i / TOUCHING == 3) rays[i].tmin = nextafterf(t, INFINITY);
        if (i / TOUCHING == 4) rays[i].tmax = nextafterf(t, 0);
        if (i / TOUCHING == 5) rays[i].tmin = t * (1 + 0x1p-12f);
        if (!rt_ray_is_valid(&rays[i])) rays[i] = rays[i % TOUCHING];
    }
    rt_nearest(&query, rays, TURNS * TOUCHING, hits, NULL);
}

/* `wide` in all its ways answers like brute. */
static void assert_wide_hits(const RtScene *scene, const RtRay *rays, size_t count, const RtHit *right) {
    const char *const sets[] = {"portable", "avx2", "avx512"};
    const char *const ways[] = {"packets=0", "sharing=0", "in_flight=1", "max_leaf_size=8,block_cost=0",
                                "max_leaf_size=8,block_cost=0,sharing=0"};
    static RtHit hits[TURNS * TOUCHING];
    static bool blocked[TURNS * TOUCHING];
    for (size_t k = 0; k < 15; k++) {
        char spec[RT_MAX_SPEC_CHARS];
        snprintf(spec, sizeof spec, "wide:isa=%s,%s", sets[k / 5], ways[k % 5]);
        OWNED_ACCEL RtAccel *wide = open_available(scene, spec, 0);
        if (!wide) continue;
        OWNED_QUERY query = open_query(wide);
        rt_nearest(&query, rays, count, hits, NULL);
        rt_occluded(&query, rays, count, blocked, NULL);
        for (size_t i = 0; i < count; i++) {
            if (memcmp(&hits[i], &right[i], sizeof *hits) == 0 && blocked[i] == isfinite(right[i].t))
                continue;
            fail_msg("%s: ray %zu hits %u at %a, blocked %d, not %u at %a", spec, i, hits[i].object,
                     (double)hits[i].t, blocked[i], right[i].object, (double)right[i].t);
        }
    }
}

RT_TEST(spheres_of_every_magnitude_that_rays_touch_are_hit_by_wide_as_by_brute) {
    const float sizes[] = {1, 1e-30f, 1e-22f, 1e-18f, 1e-12f, 1e6f, 1e11f};
    static RtRay rays[TURNS * TOUCHING];
    static RtHit right[TURNS * TOUCHING];
    for (size_t s = 0; s < sizeof sizes / sizeof sizes[0]; s++) {
        OWNED_SCENE scene = begin_scene();
        make_touching(&scene, sizes[s], rays, right);
        assert_wide_hits(&scene, rays, TURNS * TOUCHING, right);
    }
}

/* By hand: the ray touches the sphere at t, its two roots are one, and org is so close to the sphere that
 * their product is lost to rounding. */
RT_TEST(a_ray_that_begins_just_before_it_touches_a_sphere_hits_it_there) {
    RtRay rays[40];
    RtHit right[40];
    OWNED_SCENE_OF(scene, sphere, rt_vec3(0, 0, 0), 1);
    for (int i = 0; i < 40; i++) {
        float t = ldexpf(1.3f, -10 - i);
        rays[i] = (RtRay){{.x = -t, .y = 1}, 0, {.x = 1}, INFINITY, RT_RAY_RANDOM, 0};
        right[i] = (RtHit){t, 0};
    }
    assert_wide_hits(&scene, rays, 40, right);
}

/* ---- accel/batch.h ---- */

/* A sphere that passes needlessly would be rejected if its radius were less by a small part of its distance.
 */
static void check_lane(const RtSphere *sphere, const RtPreparedRay *ray, bool passed, uint32_t *hits,
                       uint32_t *misses) {
    RtBox box = rt_sphere_box(sphere);
    RtVec3d org = rt_widen(rt_vec3_load(ray->org)), dir = rt_widen(rt_vec3_load(ray->dir));
    RtVec3d o = rt_subd(rt_widen(sphere->center), org), u = rt_normalized(dir);
    double distance = rt_lengthd(rt_crossd(o, u));
    float t;
    bool hit = rt_sphere_hit(sphere, &box, ray, &t);
    assert_true(passed || !hit);
    if (passed) assert_true(distance <= (double)sphere->radius * 1.002 + rt_lengthd(o) * 0x1p-15);
    *hits += hit;
    *misses += !passed;
}

RT_TEST(spheres_that_may_be_hit_pass_the_prefilter_and_hardly_any_other) {
    RtRandom random = rt_random(5, 5);
    uint32_t hits = 0, misses = 0;
    for (int round = 0; round < RT_SHARE(20000, 4000) * 16 / RT_LANES; round++) {
        RtRay ray = far_ray(&random, 1);
        RtPreparedRay prepared = rt_ray_prepare(&ray, &RT_EMPTY_BOX);
        RtSphereLine line = rt_sphere_line(&prepared);
        float rows[4][RT_LANES];
        RtSphere spheres[RT_LANES];
        for (int i = 0; i < RT_LANES; i++) {
            spheres[i] = touched_sphere(&random, &ray, 1);
            if (i % 4 == 3) spheres[i].radius *= 0.997f;
            for (int a = 0; a < 3; a++) rows[a][i] = spheres[i].center.at[a];
            rows[3][i] = spheres[i].radius;
        }
        uint32_t passed = rt_sphere_prefilter(rows[0], RT_LANES, &line);
        for (int i = 0; i < RT_LANES; i++)
            check_lane(&spheres[i], &prepared, passed >> i & 1, &hits, &misses);
        rows[round % 4][round / 4 % RT_LANES] = NAN;
        assert_int_equal(rt_sphere_prefilter(rows[0], RT_LANES, &line),
                         passed & ~(1u << round / 4 % RT_LANES));
    }
    assert_true(hits > RT_SHARE(10000, 2000) && misses > RT_SHARE(10000, 2000));
}

/* Whether a hit at t, near an end of the interval in which the ray is in the triangle's box, is one, and at
 * which t. */
RT_TEST(hits_are_admitted_to_boxes_of_triangles_in_lanes_as_one_by_one) {
    RtRandom random = rt_random(21, 0);
    int admitted = 0;
    for (int i = 0; i < 20000; i++) {
        RtVec3 v[3], org = rt_random_point(&random, i % 2 ? 1 : 100);
        RtBox box = RT_EMPTY_BOX;
        RtLaneRays rays = {.tmin = rt_all(0), .tmax = rt_all(FLT_MAX)};
        RtFloats at[3][3];
        for (int k = 0; k < 3; k++) {
            v[k] = rt_random_point(&random, 1);
            box = rt_box_add_point(box, v[k]);
            for (int a = 0; a < 3; a++) at[k][a] = rt_all(v[k].at[a]);
        }
        RtRay ray = {.org = org, .dir = rt_sub(v[i % 3], org), .tmax = INFINITY};
        if (i % 8 == 7) ray.dir.at[i / 8 % 3] = i % 16 == 7 ? 0.0f : -0.0f;
        if (i % 64 == 63) ray.org.at[i / 8 % 3] = box.hi.at[i / 8 % 3];
        RtPreparedRay prepared = rt_ray_prepare(&ray, &box);
        for (int a = 0; a < 3; a++) {
            rays.org[a] = rt_all(ray.org.at[a]);
            rays.inv[a] = 1 / rt_all(ray.dir.at[a]);
            rays.negative[a] = rt_all_ints(-(int)prepared.negative[a]);
        }
        float near, far;
        rt_box_own_span(&box, &prepared, &near, &far);
        const RtFloats lo[3] = {rt_all(box.lo.x), rt_all(box.lo.y), rt_all(box.lo.z)};
        const RtFloats hi[3] = {rt_all(box.hi.x), rt_all(box.hi.y), rt_all(box.hi.z)};
        RtFloats from, to;
        rt_own_span(&rays, lo, hi, &from, &to);
        assert_memory_equal(&near, &from, sizeof near);
        assert_memory_equal(&far, &to, sizeof far);
        float t = (i & 4 ? near : far) * (1 + rt_random_between(&random, -0x1p-18f, 0x1p-18f)),
              lanes[RT_LANES];
        RtFloats all = rt_all(t);
        bool one = rt_box_admit(&box, &prepared, &t), many = rt_admit(&rays, at, 1, &all) & 1;
        rt_store(lanes, all);
        assert_int_equal(one, many);
        if (one) assert_memory_equal(&t, &lanes[0], sizeof t);
        admitted += one;
    }
    assert_in_range(admitted, 1000, 19999);
}

RT_TESTS(lanes, NULL, assert_nothing_is_kept)
