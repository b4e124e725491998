/* SPDX-License-Identifier: Apache-2.0 */
/* Specs: overlays with '+', and names for the fastest of several; layers, their counts, and the shadow cache.
 */
#include "accel_testing.h"

/* Two spheres, and two lights at x = 8: one behind both, seen along +x, one above them. */
static int set_up(void **state) {
    static RtScene scene;
    scene = begin_two_spheres();
    assert_ok(rt_scene_add_light(&scene, rt_vec3(8, 0.5f, 0.5f), rt_vec3(1, 1, 1), error));
    assert_ok(rt_scene_add_light(&scene, rt_vec3(8, 0.5f, 9), rt_vec3(1, 1, 1), error));
    assert_ok(rt_scene_finish(&scene, error));
    *state = &scene;
    return 0;
}

static int tear_down(void **state) {
    rt_scene_clear(*state);
    return rt_alloc_live() == 0 ? 0 : -1;
}

/* ---- specs ---- */

RT_TEST(a_spec_is_read_from_the_top_down_and_written_as_it_was) {
    RtSpec spec;
    char text[RT_MAX_SPEC_CHARS];
    assert_ok(rt_spec_parse("cache+grid:density=1e+06", &spec, error));
    assert_int_equal(spec.layer_count, 2);
    assert_string_equal(spec.layers[0].ops->name, "cache");
    assert_string_equal(spec.layers[1].ops->name, "grid");
    rt_spec_format(&spec, text);
    assert_memory_equal(text, "cache+grid:", 11);
    RtSpec again;
    assert_ok(rt_spec_parse(text, &again, error));
    assert_true(again.layers[1].values[1].f == 1e6);
}

RT_TEST(a_stack_has_the_colour_of_its_topmost_accelerator_and_all_plugins_share_one) {
    const uint32_t plugin = rt_accel_color("a-plugin");
    for (size_t i = 0; i < rt_accel_count(); i++) {
        uint32_t own = rt_accel_color(rt_accel_at(i)->name);
        assert_int_not_equal(own, plugin);
        for (size_t k = 0; k < i; k++) assert_int_not_equal(own, rt_accel_color(rt_accel_at(k)->name));
    }
    assert_int_equal(rt_accel_color("grid:density=4"), rt_accel_color("grid"));
    assert_int_equal(rt_accel_color("cache+grid"), rt_accel_color("cache"));
    assert_int_equal(rt_accel_color("gri"), plugin);
    assert_int_equal(rt_accel_color("grids"), plugin);
}

RT_TEST(a_wrong_plus_is_refused_with_a_remedy) {
    const struct {
        const char *spec, *says;
    } wrong[] = {
        {"cache", "needs an accelerator below it: write cache+bvh"},
        {"cache+cache", "write cache+cache+bvh"},
        {"grid+bvh", "grid is not an overlay"},
        {"cache+grid+bvh", "grid is not an overlay"},
        {"cache+", "'' is not the spec"},
        {"+bvh", "'+bvh' is not the spec"},
        {"cache++bvh", "'+bvh' is not the spec"},
        {"cash+bvh", "did you mean 'cache'"},
        {"cache:size=1+bvh", "accelerator cache has no parameter"},
        {"cache+cache+cache+cache+bvh", "more than 4"},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        RtSpec spec;
        assert_bad_input(rt_spec_parse(wrong[i].spec, &spec, error), wrong[i].says);
    }
}

/* ---- names for the fastest of several settings ---- */

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
            snprintf(text, sizeof text, "%s:%s%s", ops->name, ops->bests[b].name, ops->kinds ? "+brute" : "");
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

/* The default wins where others are not certainly faster, so it must be among them; Embree's default is the
 * widest instruction set, whichever that is. */
RT_TEST(the_first_setting_of_the_best_is_the_default) {
    for (size_t i = 0; i < rt_accel_count(); i++) {
        const RtAccelOps *ops = rt_accel_at(i);
        char whole[2][RT_MAX_SPEC_CHARS], text[RT_MAX_NAME * 2];
        const char *below = ops->kinds ? "+brute" : "";
        size_t count, all;
        if (ops->best_count != 1) continue;
        snprintf(text, sizeof text, "%s:best%s", ops->name, below);
        assert_ok(rt_best_specs(text, specs, &count, &all, error));
        assert_in_range(all, 2, 8);
        snprintf(text, sizeof text, "%s%s", ops->name, below);
        for (int k = 0; k < 2; k++) {
            RtSpec spec;
            assert_ok(rt_spec_parse(k == 0 ? specs[0] : text, &spec, error));
            rt_spec_format(&spec, whole[k]);
        }
        assert_string_equal(whole[0], whole[1]);
    }
}

RT_TEST(a_layer_of_a_spec_may_be_the_best_of_several) {
    size_t count, all;
    assert_ok(rt_best_specs("cache+grid:best", specs, &count, &all, error));
    assert_string_equal(specs[0], "cache+grid:density=4,depth=1");
    assert_ok(rt_best_specs("light:best+wide", specs, &count, &all, error));
    assert_string_equal(specs[1], "light:cells=256+wide");
}

RT_TEST(what_is_no_such_name_is_refused) {
    static const char *const none[] = {"bvh", "bvh:", ":best", "bvh:build=sweep", "light+bvh:"};
    size_t count = 0, all = 0;
    for (size_t i = 0; i < sizeof none / sizeof none[0]; i++) assert_false(rt_best_is(none[i]));
    assert_true(rt_best_is("brute:best"));
    assert_bad_input(rt_best_specs("brute:best", specs, &count, &all, error), "'brute:best'");
    assert_bad_input(rt_best_specs("gird:best", specs, &count, &all, error), "did you mean 'grid'");
}

/* ---- layers ---- */

static RtStatus refuse(const RtValue *values, RtError *problem) {
    (void)values;
    return rt_fail(problem, RT_NOT_AVAILABLE, "not here");
}

static RtStatus build_all_the_same(RtAccel *accel, const RtBuild *what, RtError *problem) {
    (void)accel, (void)what, (void)problem;
    fail_msg("a layer was built that is not available");
    return RT_OK;
}

RT_TEST(a_stack_is_refused_before_it_is_built_where_a_layer_is_not_available) {
    RtSpec spec;
    RtAccel *accel;
    assert_ok(rt_spec_parse("cache+grid", &spec, error));
    RtAccelOps absent = *spec.layers[0].ops;
    absent.available = refuse;
    absent.build = build_all_the_same;
    spec.layers[0].ops = &absent;
    assert_fails_with(rt_accel_build(&spec, *state, 1, &accel, error), RT_NOT_AVAILABLE, "not here");
    assert_null(accel);
}

RT_TEST(layers_are_described_together) {
    OWNED_ACCEL RtAccel *top = open_valid(*state, "cache+light:cells=2+grid:resolution=3x1x1");
    RtDescription of_base = describe_spec(*state, "grid:resolution=3x1x1"), of_top;
    rt_accel_describe(top, &of_top);
    assert_true(of_top.leaves > 3 + 2 * 2 && of_top.leaves <= 3 + 2 * 6 * 2 * 2); /* voxels, and cells */
    assert_true(of_top.references > of_base.references);
    assert_true(of_top.bytes > of_base.bytes);
    assert_string_equal(rt_accel_base(top)->ops->name, "grid");
}

RT_TEST(a_stack_is_only_as_exact_as_its_base) {
    OWNED_ACCEL RtAccel *accel = open_accel(*state, "cache+bvh");
    assert_true(accel->exact && accel->counts);
    rt_accel_destroy(accel);
    accel = open_available(*state, "cache+embree:mode=native", 0);
    assert_false(accel && (accel->exact || accel->counts));
}

/* ---- the shadow cache ---- */

/* Shadow rays in this order, each with the counts of cache+brute. */
#define HIT .rays = 1, .hits = 1, .object_hits = 1
RT_TEST(the_cache_counts_what_was_counted_by_hand) {
    const RtScene *scene = *state;
    const struct {
        RtVec3 from;
        uint32_t light;
        bool begin, blocked;
        RtTally expected;
    } rows[] = {
        /* The cache is empty: brute's two tests, of which the first hits. */
        {{{-1, 0.5f, 0.5f}}, 0, true, true, {HIT, .object_tests = 1, .passed_on = 1}},
        /* Sphere 0 is cached and occludes again: one test, nothing passed on. */
        {{{-1, 0.4f, 0.5f}}, 0, false, true, {HIT, .object_tests = 1, .steps = 1}},
        /* From between the spheres: the cached one is tested in vain, brute tests both and finds 1. */
        {{{2, 0.5f, 0.5f}}, 0, false, true, {HIT, .object_tests = 3, .steps = 1, .passed_on = 1}},
        /* The other light has an entry of its own, empty yet; nothing is in the way. */
        {{{2, 0.5f, 5}}, 1, false, false, {.rays = 1, .object_tests = 2, .passed_on = 1}},
        /* Sphere 1 is cached for the first light, in vain; a miss leaves the cache unchanged: */
        {{{6, 0.5f, 0.5f}}, 0, false, false, {.rays = 1, .object_tests = 3, .steps = 1, .passed_on = 1}},
        {{{2, 0.5f, 0.5f}}, 0, false, true, {HIT, .object_tests = 1, .steps = 1}},
        /* After rt_query_begin the cache is empty. */
        {{{2, 0.5f, 0.5f}}, 0, true, true, {HIT, .object_tests = 2, .passed_on = 1}},
    };
    OWNED_ACCEL RtAccel *accel = open_accel(scene, "cache+brute");
    OWNED_QUERY query = open_query(accel);
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        RtRay ray = shadow_ray(scene, rows[i].from, rows[i].light);
        RtTally tallies[RT_RAY_KIND_COUNT] = {{0}};
        bool blocked;
        if (rows[i].begin) rt_query_begin(&query);
        rt_occluded(&query, &ray, 1, &blocked, tallies);
        assert_int_equal(blocked, rows[i].blocked);
        assert_tally("cache+brute", &tallies[RT_RAY_SHADOW], &rows[i].expected);
    }
}

RT_TEST(rays_of_other_kinds_pass_an_overlay_uncounted) {
    const RtScene *scene = *state;
    RtTally tallies[RT_RAY_KIND_COUNT] = {{0}};
    RtRay toward = shadow_ray(scene, rt_vec3(-1, 0.5f, 0.5f), 0), rays[3] = {toward, toward, toward};
    rays[1].kind = RT_RAY_DIFFUSE;
    rays[2].source = 7; /* there is no such light */
    bool blocked[3];
    RtHit hits[3];
    OWNED_ACCEL RtAccel *accel = open_accel(scene, "cache+brute");
    OWNED_QUERY query = open_query(accel);
    rt_occluded(&query, rays, 3, blocked, tallies);
    assert_true(blocked[0] && blocked[1] && blocked[2]);
    assert_int_equal(tallies[RT_RAY_DIFFUSE].rays, 1);
    assert_int_equal(tallies[RT_RAY_DIFFUSE].passed_on, 0);
    assert_int_equal(tallies[RT_RAY_SHADOW].rays, 2);
    assert_int_equal(tallies[RT_RAY_SHADOW].passed_on, 2);
    rt_nearest(&query, rays, 3, hits, tallies);
    assert_int_equal(hits[0].object, 0);
    assert_int_equal(tallies[RT_RAY_SHADOW].rays, 4);
    assert_int_equal(tallies[RT_RAY_SHADOW].passed_on, 2);
}

RT_TESTS(overlays, set_up, tear_down)
