/* SPDX-License-Identifier: Apache-2.0 */
/* accel/brute: what it does in lanes is what rt_test_all does, by every instruction set that this machine has: the
 * hits and the blockers bit for bit, and the counts, whatever the length of a stream. */
#include "equivalence_testing.h"

#include "accel/brute/brute.h"
#include "accel/kernel.h"
#include "accel/lanes.h"
#include "accel_testing.h"
#include "base/random.h"

/* What is asked, and what is answered, timed and counted. */
typedef struct Asked {
    const RtRay *rays;
    size_t count;
    RtHit *hits;
    uint32_t *blockers;
    RtTally nearest[RT_RAY_KIND_COUNT], occluded[RT_RAY_KIND_COUNT];
} Asked;

static void clear(Asked *asked) {
    rt_free(asked->hits);
    rt_free(asked->blockers);
}

static Asked begin_asking(const RtRay *rays, size_t count) {
    Asked asked = {.rays = rays, .count = count};
    asked.hits = rt_alloc(count, sizeof(RtHit));
    asked.blockers = rt_alloc(count, sizeof(uint32_t));
    assert_true(asked.hits && asked.blockers);
    return asked;
}

/* One ray, one object after the other. */
static void by_definition(const RtGeometry *geometry, Asked *asked) {
    RtCrossing *room;
    assert_ok(rt_hit_room(geometry, &room, error));
    for (size_t i = 0; i < asked->count; i++) {
        const RtRay *ray = &asked->rays[i];
        RtPreparedRay prepared;
        RtHit first = RT_MISS;
        rt_hit_ray(&prepared, geometry, ray, room);
        asked->hits[i] = RT_MISS;
        rt_test_all(geometry, &prepared, false, &asked->hits[i], &asked->nearest[ray->kind]);
        rt_test_all(geometry, &prepared, true, &first, &asked->occluded[ray->kind]);
        asked->blockers[i] = first.object;
        asked->nearest[ray->kind].rays++;
        asked->nearest[ray->kind].hits += asked->hits[i].object != RT_NO_OBJECT;
        asked->occluded[ray->kind].rays++;
        asked->occluded[ray->kind].hits += first.object != RT_NO_OBJECT;
    }
    rt_free(room);
}

static void assert_same(const Asked *right, const Asked *got, bool counted, RtIsa isa, size_t stream) {
    for (size_t i = 0; i < right->count; i++) {
        if (memcmp(&right->hits[i], &got->hits[i], sizeof(RtHit)) != 0 || right->blockers[i] != got->blockers[i]) {
            fail_msg("isa %d, streams of %zu, counted %d: ray %zu is answered %u at %a, blocked by %u, not %u at %a, %u",
                     (int)isa, stream, counted, i, got->hits[i].object, (double)got->hits[i].t, got->blockers[i],
                     right->hits[i].object, (double)right->hits[i].t, right->blockers[i]);
        }
    }
    if (!counted) return;
    assert_memory_equal(right->nearest, got->nearest, sizeof right->nearest);
    assert_memory_equal(right->occluded, got->occluded, sizeof right->occluded);
}

static void by_kernels(const RtBruteKernels *kernels, const RtQuery *query, Asked *asked, size_t stream, bool counted) {
    for (size_t first = 0; first < asked->count; first += stream) {
        size_t left = asked->count - first, n = left < stream ? left : stream;
        const RtRay *rays = asked->rays + first;
        if (counted) {
            kernels->nearest_counted(query->accel, query->scratch, rays, n, asked->hits + first, asked->nearest);
            kernels->occluded_counted(query->accel, query->scratch, rays, n, asked->blockers + first,
                                      asked->occluded);
        } else {
            kernels->nearest(query->accel, query->scratch, rays, n, asked->hits + first);
            kernels->occluded(query->accel, query->scratch, rays, n, asked->blockers + first);
        }
    }
}

static void assert_is_the_definition(const RtScene *scene, const RtRay *rays, size_t count) {
    const size_t streams[] = {1, 5, 128, count};
    Asked right = begin_asking(rays, count);
    RtAccel *accel;
    RtQuery query;
    by_definition(&scene->geometry, &right);
    assert_ok(rt_accel_open("brute", scene, &accel, error));
    assert_ok(rt_query_init(&query, accel, error));
    for (int isa = RT_ISA_PORTABLE; isa <= (int)rt_isa_best(); isa++) {
        for (size_t s = 0; s < sizeof streams / sizeof streams[0]; s++) {
            for (int counted = 0; counted < 2; counted++) {
                Asked got = begin_asking(rays, count);
                by_kernels(rt_brute_kernels((RtIsa)isa), &query, &got, streams[s], counted);
                assert_same(&right, &got, counted, (RtIsa)isa, streams[s]);
                clear(&got);
            }
        }
    }
    rt_query_clear(&query);
    rt_accel_destroy(accel);
    clear(&right);
}

/* By rays of every family. */
static void assert_scene_is_the_definition(const RtScene *scene, uint64_t seed, size_t rays) {
    size_t families = rt_ray_family_count();
    RtAccel *bvh;
    RtQuery query;
    RtRay *all = rt_alloc(families * rays, sizeof(RtRay));
    assert_non_null(all);
    assert_ok(rt_accel_open("bvh", scene, &bvh, error));
    assert_ok(rt_query_init(&query, bvh, error));
    for (size_t f = 0; f < families; f++) rt_ray_family_fill(f, &query, seed, 0, rays, all + f * rays);
    rt_query_clear(&query);
    rt_accel_destroy(bvh);
    assert_is_the_definition(scene, all, families * rays);
    rt_free(all);
}

RT_TEST(every_family_of_scenes_is_answered_and_counted_as_defined) {
    for (size_t family = 0; family < rt_family_count(); family++) {
        for (uint64_t seed = 1; seed <= 3; seed++) {
            RtScene scene;
            open_family(family, seed, &scene);
            assert_scene_is_the_definition(&scene, seed, 40);
            rt_scene_clear(&scene);
        }
    }
}

RT_TEST(every_shape_and_every_remainder_of_lanes_is_answered_and_counted_as_defined) {
    const char *specs[] = {
        "random:n=300,shape=mixed",   "random:n=1,shape=triangle",   "random:n=15,shape=triangle", "random:n=17,shape=triangle",
        "random:n=271,shape=triangle", "random:n=3,shape=sphere",    "random:n=257,shape=sphere",  "random:n=0",
        "tetra:size=4",               "balls:size=2",                "mount:size=4",               "teapot:size=3"};
    for (size_t i = 0; i < sizeof specs / sizeof specs[0]; i++) {
        RtScene scene;
        assert_ok(rt_scene_open(specs[i], &scene, error));
        assert_scene_is_the_definition(&scene, i, 60);
        rt_scene_clear(&scene);
    }
}

RT_TESTS(brute, NULL, assert_nothing_is_kept)
