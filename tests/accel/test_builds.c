/* SPDX-License-Identifier: Apache-2.0 */
/* Every accelerator, on any number of threads and at any scale: no array overflows, and the structure does
 * not depend on threads. */
#include "clock_testing.h"
#include "equivalence_testing.h"

#include "core/base/random.h"
#include "verify/verify.h"

/* ---- threads ---- */

/* Triangles in a cube, and a light inside it. */
static RtScene make_triangles(uint32_t count, float from, float size) {
    RtRandom random = rt_random(1, count);
    RtScene scene = begin_scene();
    for (uint32_t i = 0; i < count; i++) {
        RtVec3 v[3];
        for (int a = 0; a < 3; a++) {
            float at = from * (2 * rt_random_unit(&random) - 1);
            for (int k = 0; k < 3; k++) v[k].at[a] = at + size * (2 * rt_random_unit(&random) - 1);
        }
        assert_ok(rt_scene_add_triangle(&scene, 0, v, NULL, error));
    }
    assert_ok(rt_scene_add_light(&scene, rt_vec3(0, 0, 0), rt_vec3(1, 1, 1), error));
    assert_ok(rt_scene_finish(&scene, error));
    return scene;
}

/* False if this machine cannot build it. */
static bool describe(const char *spec, const RtScene *scene, int threads, RtDescription *out) {
    OWNED_ACCEL RtAccel *accel = open_available(scene, spec, threads);
    if (accel) rt_accel_describe(accel, out);
    return accel;
}

/* The structure is the same on each number of threads, up to a 0. */
static void assert_same_on(const char *spec, const RtScene *scene, const int *threads) {
    RtDescription one, many;
    if (!describe(spec, scene, 1, &one)) return;
    for (; *threads > 0 && describe(spec, scene, *threads, &many); threads++) {
        if (memcmp(&one, &many, sizeof one) != 0)
            fail_msg("%s of %u objects is another on %d threads", spec, scene->geometry.object_count,
                     *threads);
    }
}

RT_TEST(few_objects_on_several_threads_make_the_structure_of_one_at_every_setting) {
    static const uint32_t counts[] = {1, 33, 200};
    static const int threads[][2] = {{7, 0}, {3, 0}, {16, 0}};
    for (size_t c = 0; c < sizeof counts / sizeof counts[0]; c++) {
        char spec[RT_MAX_SPEC_CHARS];
        OWNED_SCENE scene = make_triangles(counts[c], 1, 0.05f);
        for (size_t i = 0; i < rt_accel_count(); i++) {
            for (size_t n = 0; rt_spread_spec(rt_accel_at(i), n, spec); n++)
                assert_same_on(spec, &scene, threads[c]);
        }
    }
}

RT_TEST(many_objects_on_many_threads_make_the_structure_of_one) {
    static const char *const specs[] = {"bvh",
                                        "wide",
                                        "bvh:build=spatial",
                                        "kd",
                                        "bvh:bins=64",
                                        "bvh:build=lbvh",
                                        "bvh:build=ploc",
                                        "clusters:method=sah",
                                        "light+bvh",
                                        "item+bvh",
                                        "bvh:build=lbvh,reinsertion=3"};
    static const struct {
        uint32_t objects;
        size_t specs;
        int threads[3];
    } cases[] = {{4097, 11, {65}}, {33000, 11, {255}}, {100000, 2, {128}}};
    for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++) {
        OWNED_SCENE scene = make_triangles(cases[c].objects, 1, 0.005f);
        for (size_t i = 0; i < cases[c].specs; i++) assert_same_on(specs[i], &scene, cases[c].threads);
    }
}

RT_TEST(a_build_on_one_thread_stays_there) {
    OWNED_SCENE scene = make_triangles(30000, 1, 0.005f);
    Labour before = labour_so_far();
    rt_accel_destroy(open_available(&scene, "bvh:build=lbvh,reinsertion=3", 1));
    Labour labour = labour_since(before);
    assert_true(labour.others < 0.05 * labour.own);
}

/* ---- scales ---- */

/* Whether it answers like brute at every scale, and can be built here. */
static bool is_exact(const char *spec, const RtScene *scene) {
    OWNED_ACCEL RtAccel *accel = NULL;
    RtError reason;
    const RtStatus status = rt_accel_open(spec, scene, &accel, &reason);
    if (status == RT_BAD_INPUT && strncmp(spec, "embree", 6) == 0)
        return false; /* the scene is too wide for native mode */
    if (status != RT_OK && status != RT_NOT_AVAILABLE) fail_msg("%s: %s", spec, reason.message);
    return accel && accel->exact;
}

/* Triangles as large as the scene: sums of their areas are the largest there are. */
RT_TEST(scenes_as_large_and_as_small_as_may_be_are_answered_like_brute) {
    static const float scales[] = {4.9e17f, 1e-18f};
    for (size_t s = 0; s < sizeof scales / sizeof scales[0]; s++) {
        OWNED_BENCH bench;
        char spec[RT_MAX_SPEC_CHARS];
        bench.scene = make_triangles(RT_SHARE(2000, 300), 0, scales[s]);
        set_up_rays(&bench, 1, 4);
        for (size_t i = 0; i < rt_accel_count(); i++) {
            for (size_t n = 0; rt_spread_spec(rt_accel_at(i), n, spec); n++) {
                if (n > 0 && !strstr(spec, ":build=") && !strstr(spec, ":method=")) continue;
                if (is_exact(spec, &bench.scene)) assert_gives(&bench.reference, spec);
            }
        }
    }
}

RT_TESTS(builds, NULL, NULL)
