/* SPDX-License-Identifier: Apache-2.0 */
/* rt_best_specs: names for the fastest of several settings. */
#include "accel_testing.h"

static char specs[RT_MAX_BEST][RT_MAX_SPEC_CHARS];

/* The number of combinations of choices in "a=1|2,b=3|4|5". */
static size_t combinations(const char *settings) {
    size_t product = 1, choices = 1;
    for (const char *c = settings;; c++) {
        choices += *c == '|';
        if (*c != ',' && *c) continue;
        product *= choices;
        choices = 1;
        if (!*c) return product;
    }
}

RT_TEST(every_name_stands_for_different_specs_that_can_be_built) {
    OWNED_SCENE scene;
    rt_scene_init(&scene);
    assert_ok(rt_scene_finish(&scene, error));
    for (size_t i = 0; i < rt_accel_count(); i++) {
        const RtAccelOps *ops = rt_accel_at(i);
        for (size_t b = 0; b < ops->best_count; b++) {
            char text[RT_MAX_NAME * 2];
            size_t count = 0, all = 0;
            snprintf(text, sizeof text, "%s:%s", ops->name, ops->bests[b].name);
            assert_true(rt_best_is(text));
            assert_ok(rt_best_specs(text, specs, &count, &all, error));
            assert_true(count > 0 && count <= all && all <= RT_MAX_BEST);
            assert_int_equal(all, combinations(ops->bests[b].settings));
            for (size_t n = 0; n < count; n++) {
                RtAccel *accel;
                assert_ok(rt_accel_open(specs[n], &scene, &accel, error));
                assert_true(accel->ops == ops);
                rt_accel_destroy(accel);
                for (size_t k = 0; k < n; k++) assert_string_not_equal(specs[n], specs[k]);
            }
        }
    }
}

/* Embree's, if it is built in: packets and both builds, not robust; and the part with single rays. */
RT_TEST(the_best_of_embree_is_of_all_queries_and_one_of_single_rays) {
    size_t best = 0, one = 0, all = 0;
    RtError why;
    if (rt_best_specs("embree:best", specs, &best, &all, &why) == RT_NOT_AVAILABLE) return;
    assert_true(best == 16 || best == 8 || best == 12 || best == 6); /* streams and AVX-512 may be missing */
    assert_string_equal(specs[0], "embree:query=1,quality=medium,isa=avx2");
    assert_string_equal(specs[1], "embree:query=8,quality=medium,isa=avx2");
    for (size_t i = 0; i < all; i++) assert_null(strstr(specs[i], "robust"));
    assert_ok(rt_best_specs("embree:one", specs, &one, &all, error));
    assert_true(one == 2 || one == 4);
    for (size_t i = 0; i < one; i++) assert_non_null(strstr(specs[i], "query=1,"));
}

RT_TEST(what_is_no_such_name_is_refused) {
    static const char *const none[] = {"bvh", "bvh:", ":best", "bvh:build=sweep", "light+bvh:best"};
    size_t count = 0, all = 0;
    for (size_t i = 0; i < sizeof none / sizeof none[0]; i++) assert_false(rt_best_is(none[i]));
    assert_true(rt_best_is("bvh:best"));
    assert_bad_input(rt_best_specs("bvh:best", specs, &count, &all, error), "'bvh:best'");
    assert_bad_input(rt_best_specs("gird:best", specs, &count, &all, error), "did you mean 'grid'");
}

RT_TESTS(best, NULL, NULL)
