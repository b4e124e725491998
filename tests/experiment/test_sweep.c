/* SPDX-License-Identifier: Apache-2.0 */
/* Specs that stand for several. */
#include "testing.h"

#include "experiment/experiment.h"

/* All that `text` stands for, with blanks between; or what is wrong with it. */
static const char *expand_by_manifest(const char *text, bool scene, const json_t *manifest) {
    static char all[8192];
    static RtExperiment e;
    RtError error = {RT_OK, ""};
    const RtWorkload workload = {.depth = 1};
    RtCandidate candidate = {.ray_stride = 1};
    rt_experiment_init(&e);
    e.manifest = manifest;
    strcpy(candidate.spec, text);
    RtStatus status = scene ? rt_experiment_add_scenes(&e, &workload, text, "", &error)
                            : rt_experiment_add_accels(&e, &candidate, &error);
    if (status != RT_OK) return strcpy(all, error.message);
    all[0] = '\0';
    for (uint32_t i = 0; i < e.workload_count + e.candidate_count; i++) {
        size_t used = strlen(all);
        snprintf(all + used, sizeof all - used, "%s%s", i ? " " : "",
                 scene ? e.workloads[i].spec : e.candidates[i].spec);
    }
    return all;
}

static const char *expand(const char *text, bool scene) {
    return expand_by_manifest(text, scene, NULL);
}

RT_TEST(a_range_is_linear_or_logarithmic_and_a_list_holds_words_and_ranges) {
    const char *const cases[][2] = {
        {"bvh", "bvh"},
        {"grid:density=4", "grid:density=4"},
        {"grid:density=1e+06", "grid:density=1e+06"},
        {"grid:density=1|4|16", "grid:density=1 grid:density=4 grid:density=16"},
        {"grid:density=1..9+4", "grid:density=1 grid:density=5 grid:density=9"},
        {"grid:density=.1...3+.1", "grid:density=0.1 grid:density=0.2 grid:density=0.3"},
        {"grid:density=1e-1..1e+1*10", "grid:density=0.1 grid:density=1 grid:density=10"},
        {"grid:density=1..100*10|7", "grid:density=1 grid:density=10 grid:density=100 grid:density=7"},
        {"bvh:build=binned|sweep", "bvh:build=binned bvh:build=sweep"},
        {"grid:density=1|2,depth=1|2",
         "grid:density=1,depth=1 grid:density=1,depth=2 grid:density=2,depth=1 grid:density=2,depth=2"},
        {"grid:depth=1..2+1,density=3", "grid:depth=1,density=3 grid:depth=2,density=3"},
        {"light:cells=16|32+bvh", "light:cells=16+bvh light:cells=32+bvh"},
        {"light+grid:density=1..3+2", "light+grid:density=1 light+grid:density=3"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
        assert_string_equal(expand(cases[i][0], false), cases[i][1]);
    assert_string_equal(expand("random:n=1e2..1e4*10", true), "random:n=100 random:n=1000 random:n=10000");
    assert_string_equal(expand("../scenes/a=1|2.obj", true), "../scenes/a=1|2.obj");
}

/* 1, 1.5, 2.25, 3.375, 5.0625 */
RT_TEST(whole_numbers_are_rounded_and_none_comes_twice) {
    assert_string_equal(expand("balls:size=1..5.1*1.5", true),
                        "balls:size=1 balls:size=2 balls:size=3 balls:size=5");
    assert_string_equal(expand("grid:density=1..2.3*1.5", false),
                        "grid:density=1 grid:density=1.5 grid:density=2.25");
}

/* Of accelerators that need not be here. */
RT_TEST(whole_numbers_of_results_are_told_by_their_manifest) {
    json_auto_t *kept =
        json_pack("{s:[{s:s}, {s:s}, {s:s}, {s:s}]}", "accelerators", "accel", "mine:leaf=1,part=.5", "accel",
                  "mine:part=1,leaf=2", "accel", "light+mine:leaf=3", "accel", "other:leaf=0.5");
    assert_string_equal(expand_by_manifest("mine:leaf=1..2.3*1.5", false, kept), "mine:leaf=1 mine:leaf=2");
    assert_string_equal(expand_by_manifest("light+mine:leaf=1..2.3*1.5", false, kept),
                        "light+mine:leaf=1 light+mine:leaf=2");
    assert_string_equal(expand_by_manifest("mine:part=1..1.6*1.5", false, kept), "mine:part=1 mine:part=1.5");
    assert_string_equal(expand_by_manifest("other:leaf=1..1.6*1.5", false, kept),
                        "other:leaf=1 other:leaf=1.5");
}

RT_TEST(what_is_no_range_is_refused_with_what_would_be) {
    const char *const cases[][2] = {
        {"grid:density=1..9", "'1..9' is not a range: write LOW..HIGH+STEP"},
        {"grid:density=9..1+2", "is not a range"},
        {"grid:density=1..9+0", "is not a range"},
        {"grid:density=1..9*1", "is not a range"},
        {"grid:density=0..9*2", "LOW above 0"},
        {"grid:density=1..x*2", "is not a range"},
        {"grid:density=1..inf*2", "is not a range"},
        {"grid:density=1|", "not a value for a list"},
        {"grid:density=1..1e9+1", "more than 256 values"},
        {"grid:density=1|2+grid:density=1|2", "sweeps density twice"},
        {"a:a=1|2,b=1|2,c=1|2,d=1|2,e=1|2", "more than 4 parameters"},
        {"a:a=1..250+1,b=1..250+1,c=1..250+1", "stands for more than 65535"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const char *says = expand(cases[i][0], false);
        if (!strstr(says, cases[i][1])) fail_msg("%s: %s", cases[i][0], says);
    }
}

RT_TEST(values_that_rise_by_a_factor_want_a_logarithmic_axis) {
    const double twofold[] = {1, 2, 4, 8}, steps[] = {1, 3, 5, 7, 9}, rounded[] = {1, 2, 3, 5, 8, 11},
                 zero[] = {0, 1, 10};
    const double apart[] = {1, 100}, near[] = {1, 2};
    assert_true(rt_swept_logarithmic(twofold, 4));
    assert_false(rt_swept_logarithmic(steps, 5));
    assert_true(rt_swept_logarithmic(rounded, 6));
    assert_false(rt_swept_logarithmic(zero, 3));
    assert_true(rt_swept_logarithmic(apart, 2));
    assert_false(rt_swept_logarithmic(near, 2));
}

/* Two accelerators, and a scene, have parameters of one name. */
RT_TEST(what_is_swept_has_a_label_a_base_and_a_column) {
    OWNED_MEMORY RtExperiment *e = rt_alloc(1, sizeof *e);
    RtCandidate octree = {.ray_stride = 1, .spec = "octree:margin=0|0.1", .label = "oct"},
                grid = {.ray_stride = 1, .spec = "grid:margin=0|0.1,nest=4"};
    RtWorkload scene = {.depth = 3};
    RtSweptKey keys[RT_MAX_SWEPT_KEYS];
    char where[RT_MAX_LABEL];
    assert_non_null(e);
    rt_experiment_init(e);
    assert_ok(rt_experiment_add_scenes(e, &scene, "random:n=10|20", "", error));
    assert_ok(rt_experiment_add_accels(e, &octree, error));
    assert_ok(rt_experiment_add_accels(e, &grid, error));
    assert_int_equal(e->workload_count, 2);
    assert_int_equal(e->candidate_count, 4);
    assert_string_equal(e->workloads[1].label, "random:n=20");
    assert_string_equal(e->workloads[1].stem, "random");
    assert_string_equal(e->candidates[1].label, "oct:margin=0.1");
    assert_string_equal(e->candidates[1].stem, "oct");
    assert_string_equal(e->candidates[2].label, "grid:margin=0,nest=4");
    assert_string_equal(e->candidates[2].stem, "grid:nest=4");
    assert_int_equal(rt_experiment_swept(e, keys), 2);
    assert_true(keys[0].scene && keys[0].number && !keys[1].scene);
    assert_string_equal(rt_swept_of(e, &keys[0], 1, 0), "20");
    assert_string_equal(rt_swept_of(e, &keys[1], 1, 3), "0.1");
    strcpy(e->name, "test");
    assert_ok(rt_experiment_check(e, where, error));
}

RT_TESTS(sweep, NULL, NULL)
