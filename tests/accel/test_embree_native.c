/* SPDX-License-Identifier: Apache-2.0 */
/* accel/embree, mode=native: agrees with brute except at edges, and a difference is a margin. Skipped without
 * Embree. */
#include "embree_testing.h"

#include "verify/failure.h"

static RtScene make_triangles(uint32_t count) {
    RtRandom random = rt_random(7, 2);
    RtScene scene = begin_scene();
    for (uint32_t i = 0; i < count; i++) add_triangle(&scene, &random, 1, 0.3f);
    assert_ok(rt_scene_finish(&scene, error));
    return scene;
}

/* Rays between random points, past edges and corners at ordinary distances; dir short and long. */
static Rays make_plain_rays(size_t count, float size) {
    Rays r = {rt_alloc(count, sizeof(RtRay)), count};
    assert_non_null(r.rays);
    RtRandom random = rt_random(3, 3);
    for (size_t i = 0; i < count; i++) {
        RtVec3 from = rt_narrow(rt_scaled(rt_random_direction(&random), 3 * (double)size));
        RtVec3 to = rt_random_point(&random, size);
        r.rays[i] = (RtRay){.org = from, .dir = rt_sub(to, from), .tmax = INFINITY};
        if (i % 2) r.rays[i].dir = rt_scale(r.rays[i].dir, i % 4 == 1 ? 1e30f : 1e-30f);
    }
    return r;
}

/* Native mode may hit another object at edges; hence 99.9 %. */
RT_TEST(native_mode_agrees_with_brute_on_triangles) {
    static const char *const specs[] = {
        "embree",           "embree:query=8",  "embree:query=16",     "embree:query=stream",
        "embree:robust=on", "embree:isa=sse2", "embree:quality=high", "embree:quality=low",
    };
    OWNED_SCENE scene = make_triangles(500);
    OWNED_RAYS rays = make_plain_rays(20000, 1);
    OWNED_ANSWERS right = ask(&scene, "brute", rays, false);
    for (size_t s = 0; s < sizeof specs / sizeof specs[0]; s++) {
        if (!embree_has(specs[s])) continue;
        OWNED_ANSWERS got = ask(&scene, specs[s], rays, s % 2 == 1);
        size_t agree = 0, hits = 0;
        for (size_t i = 0; i < rays.count; i++) {
            RtHit g = got.hits[i], r = right.hits[i];
            bool same_t = fabsf(g.t - r.t) <= 1e-5f * r.t;
            agree += (g.object == r.object || same_t) && got.blocked[i] == right.blocked[i];
            if (g.object == r.object && r.object != RT_NO_OBJECT) assert_true(same_t);
            hits += r.object != RT_NO_OBJECT;
        }
        assert_true(hits > rays.count / 4);
        if (agree < rays.count / 1000 * 999)
            fail_msg("%s: only %zu of %zu agree", specs[s], agree, rays.count);
    }
}

RT_TEST(native_mode_sees_every_shape) {
    OWNED_SCENE scene = make_soup(80, 1, 10);
    OWNED_RAYS rays = make_plain_rays(20000, 10);
    Answers right = ask(&scene, "brute", rays, false), got = ask(&scene, "embree", rays, false);
    size_t seen[RT_SHAPE_COUNT] = {0}, agreed[RT_SHAPE_COUNT] = {0};
    for (size_t i = 0; i < rays.count; i++) {
        uint32_t object = right.hits[i].object;
        if (object == RT_NO_OBJECT) continue;
        RtShape shape = rt_ref_shape(scene.geometry.objects[object]);
        seen[shape]++;
        agreed[shape] += got.hits[i].object == object;
    }
    for (size_t s = 0; s < RT_SHAPE_COUNT; s++) {
        assert_true(seen[s] > 100);
        if ((double)agreed[s] < 0.999 * (double)seen[s])
            fail_msg("%s: only %zu of %zu agree", rt_shape_name((RtShape)s), agreed[s], seen[s]);
    }
    forget(&right);
    forget(&got);
}

/* Embree asserts its assumptions, and aborts if one fails. */
RT_TEST(native_mode_takes_every_valid_ray) {
    static const char *const specs[] = {"embree",
                                        "embree:query=8",
                                        "embree:query=16",
                                        "embree:query=stream",
                                        "embree:query=8,robust=on",
                                        "embree:query=stream,isa=avx"};
    OWNED_SCENE scene = make_soup(60, 2, 10);
    OWNED_RAYS rays = make_rays(&scene, 50000, 10, 3);
    for (size_t s = 0; s < sizeof specs / sizeof specs[0]; s++) {
        if (!embree_has(specs[s])) continue;
        OWNED_ANSWERS got = ask(&scene, specs[s], rays, false);
        for (size_t i = 0; i < rays.count; i++)
            assert_true(got.hits[i].object == RT_NO_OBJECT ? isinf(got.hits[i].t) : isfinite(got.hits[i].t));
    }
}

/* ---- margins that verify found ---- */

static RtAnswer ask_native(const char *scene_spec, const char *spec, RtRay ray) {
    RtScene scene;
    RtAnswer answer;
    RtError error;
    RtFailure failure = {.spec = spec, .rays = &ray, .count = 1, .stream = 1};
    failure.occluded = ray.kind == RT_RAY_OCCLUSION;
    assert_int_equal(rt_scene_open(scene_spec, &scene, &error), RT_OK);
    RtStatus status = rt_failure_ask(&failure, &scene, &answer, &error);
    rt_scene_clear(&scene);
    if (status == RT_NOT_AVAILABLE) RT_SKIP(error.message);
    assert_int_equal(status, RT_OK);
    return answer;
}

/* Along faces of boxes of a CSG tree, and off them by a component of 2^-130, which Embree does not see: a
 * margin. */
RT_TEST(a_component_that_embree_drops_is_a_margin) {
    RtAnswer answer = ask_native("family:kind=csg-coincident,seed=1", "embree:mode=native",
                                 (RtRay){.org = {{-0.125f, -0x1.d991ccp-1f, 0.0625f}},
                                         .dir = {{-0x1p-130f, 1, -0.0f}},
                                         .tmax = INFINITY,
                                         .kind = RT_RAY_RANDOM});
    assert_true(answer.expected.object != answer.got.object);
    assert_false(answer.wrong);
}

/* A needle seen edge on, which Embree without fused operations says is hit outside its box: a fault that
 * tests/verify/faults.tsv lists. */
RT_TEST(a_needle_seen_edge_on_and_hit_outside_its_box_is_wrong) {
    RtAnswer answer = ask_native("family:kind=slivers,seed=1", "embree:isa=sse2",
                                 (RtRay){.org = {{-0.709930062f, 0.908542037f, 0.687071741f}},
                                         .dir = {{2.6491189f, -5.61743689f, 3.32413292f}},
                                         .tmax = 1,
                                         .kind = RT_RAY_SHADOW});
    assert_int_equal(answer.expected.object, RT_NO_OBJECT);
    assert_true(answer.wrong);
}

/* A triangle of 2^39, 2^54 away: the dot product of its corner and its normal, 2^134, is beyond float32. */
RT_TEST(where_products_overflow_is_a_margin_and_no_hit_at_infinity) {
    RtAnswer answer = ask_native("family:kind=slivers-scaled,seed=16", "embree",
                                 (RtRay){.org = {{0x1.d29b58p+53f, -0x1.469a9ap+53f, -0x1.cc3184p+51f}},
                                         .dir = {{-0x1.9b2646p-1f, 0x1.1fcc8cp-1f, 0x1.95666cp-3f}},
                                         .tmax = INFINITY,
                                         .kind = RT_RAY_RANDOM});
    assert_int_equal(answer.expected.object, 95);
    assert_int_equal(answer.got.object, RT_NO_OBJECT);
    assert_false(answer.wrong);
}

/* A dir so short that t is beyond float32 where something is hit. */
RT_TEST(what_is_hit_at_infinity_blocks_nothing) {
    RtAnswer answer = ask_native("balls:size=2", "embree",
                                 (RtRay){.org = {{-17.0314159f, -28.8662663f, 5.64897966f}},
                                         .dir = {{5.03687372e-38f, 8.50490862e-38f, -1.51539765e-38f}},
                                         .tmax = INFINITY,
                                         .kind = RT_RAY_OCCLUSION});
    assert_int_equal(answer.expected.object, RT_NO_OBJECT);
    assert_false(answer.blocked);
}

/* A dir so long that every t is 0: which object is nearest float32 cannot tell. */
RT_TEST(where_no_t_can_be_told_from_another_any_hit_is_a_margin) {
    RtAnswer answer = ask_native("family:kind=mixed-tiny,seed=1", "embree",
                                 (RtRay){.org = {{-5.36500289e-10f, 8.30262317e-11f, -2.80551304e-10f}},
                                         .dir = {{7.46290349e+37f, -2.50058786e+37f, 6.16864084e+37f}},
                                         .tmax = INFINITY,
                                         .kind = RT_RAY_RANDOM});
    assert_true(answer.expected.object != answer.got.object);
    assert_false(answer.wrong);
}

RT_TEST_GROUP(embree_native) {
    if (!embree_is_built_in()) return RT_TEST_SKIPPED;
    return RT_RUN_TESTS("embree_native", NULL, NULL);
}
