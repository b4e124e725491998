/* SPDX-License-Identifier: Apache-2.0 */
/* The best of several settings: which are its members, by which rays it chooses, and what is timed. */
#include "experiment_testing.h"

#include "results/result_tables.h"

static const RtWorkloadOptions options = {.threads = 1, .timing = 1};

static void add(RtExperiment *e, const char *spec, const char *settings, const char *label, uint64_t stride) {
    RtCandidate like = {.ray_stride = stride};
    strcpy(like.spec, spec);
    strcpy(like.best_of, settings);
    strcpy(like.label, label);
    assert_ok(rt_experiment_add_accels(e, &like, error));
}

/* An accelerator, the same on every seventh ray, and grid:best of these settings, for primary rays of
 * size x size pixels; not checked yet. */
static RtExperiment *experiment_of(const char *spec, const char *settings, const char *scene, uint32_t size,
                                   const char *baseline) {
    const RtWorkload like = {.depth = 1, .width = size, .height = size};
    RtExperiment *e = primary_experiment("chosen");
    add(e, spec, "", "", 1);
    add(e, spec, "", "some", 7);
    add(e, "grid:best", settings, "", 1);
    assert_ok(rt_experiment_add_scenes(e, &like, scene, "", error));
    rt_experiment_set_baseline(e, baseline);
    return e;
}

/* One voxel makes a grid hundreds of times slower than the other setting: no noise hides that. */
static RtExperiment *measure_grids(const char *baseline, RtResults *results) {
    RtExperiment *e = experiment_of("bvh", "grid:resolution=1x1x1|20x20x20", "random:n=3000", 32, baseline);
    char where[RT_MAX_LABEL];
    assert_ok(rt_experiment_check(e, where, error));
    assert_ok(rt_results_init(results, e, error));
    assert_ok(rt_workloads_run(results, &options, error));
    return e;
}

static uint32_t find(const RtResults *results, const char *label) {
    return rt_candidate_find(results->experiment, label, 0);
}

static RtCell *cell_of(const RtResults *results, uint32_t candidate) {
    return rt_cell_at(results, 0, candidate, RT_RAY_PRIMARY);
}

RT_TEST(a_best_of_chooses_the_faster_setting_on_other_rays_and_times_only_that) {
    RtResults results;
    OWNED_MEMORY RtExperiment *e = measure_grids("bvh", &results);
    const uint32_t best = find(&results, "grid:best"), slow = find(&results, "grid-1x1x1"),
                   fast = find(&results, "grid-20x20x20");
    assert_true(e->candidates[slow].tried && rt_candidate_is_member(e, best, slow));
    assert_int_equal(rt_results_candidate(&results, 0, best, RT_RAY_PRIMARY), fast);
    assert_true(cell_of(&results, slow)->counted && !cell_of(&results, slow)->timed);
    assert_true(cell_of(&results, fast)->counted && cell_of(&results, fast)->timed);
    assert_true(rt_workload_is_done(&results, 0, &options));
    assert_true(rt_results_time_ratio(&results, 0, best, fast, RT_RAY_PRIMARY, 0.95).median == 1);
    RtResultRow row = {.results = &results};
    const RtTable counts = rt_result_table(RT_COUNTS, &row);
    for (size_t i = 0; i < counts.row_count; i++) {
        if (counts.row(counts.context, i)) assert_int_not_equal(row.candidate, best);
    }
    rt_results_clear(&results);
}

/* The null run repeats the first setting, which is timed for it even where another is chosen. */
RT_TEST(a_best_of_as_baseline_is_what_it_chose_and_its_null_run_compares_equal_structures) {
    RtResults results;
    OWNED_MEMORY RtExperiment *e = measure_grids("grid:best", &results);
    const RtCell *null = cell_of(&results, e->candidate_count);
    assert_string_equal(e->again, "grid-1x1x1 (again)");
    assert_int_equal(cell_of(&results, find(&results, "bvh"))->baseline, find(&results, "grid-20x20x20"));
    assert_int_equal(null->baseline, find(&results, "grid-1x1x1"));
    assert_true(0.5 < null->ratio.median &&
                null->ratio.median < 2); /* the other is hundreds of times faster */
    rt_results_clear(&results);
}

RT_TEST(a_setting_that_is_listed_too_is_measured_once) {
    OWNED_MEMORY RtExperiment *e = experiment_of("grid", "grid:density=4|9", "random:n=300", 8, NULL);
    const uint32_t listed = e->candidate_count;
    char where[RT_MAX_LABEL];
    assert_ok(rt_experiment_check(e, where, error));
    assert_int_equal(e->candidate_count, listed + 1); /* density 9 */
    const RtCandidate *best = &e->candidates[listed - 1];
    assert_int_equal(best->member_count, 2);
    assert_string_equal(e->candidates[best->members[0]].label, "grid");
    assert_false(e->candidates[best->members[0]].tried);
}

RT_TEST(a_best_of_more_than_eight_settings_is_refused) {
    OWNED_MEMORY RtExperiment *e = experiment_of("grid", "grid:density=1..9+1", "random:n=300", 8, NULL);
    char where[RT_MAX_LABEL];
    assert_bad_input(rt_experiment_check(e, where, error), "chooses from 9 settings: at most 8");
}

/* Choosing must not depend on what is measured. */
RT_TEST(other_rays_differ_from_those_that_are_measured) {
    OWNED_MEMORY RtExperiment *e = experiment_of("bvh", "grid:density=4|9", "random:n=300", 16, NULL);
    OWNED_SCENE scene;
    RtRaySet sets[RT_RAY_KIND_COUNT] = {0}, others[RT_RAY_KIND_COUNT] = {0};
    uint64_t whole[RT_RAY_KIND_COUNT] = {0};
    RtAccel *reference;
    assert_ok(rt_workload_open_scene(&e->workloads[0], &scene, error));
    assert_ok(rt_workload_record(e, 0, 1, &scene, &reference, sets, others, whole, error));
    for (uint32_t k = 0; k < e->kind_count; k++) {
        const RtRayKind kind = e->kinds[k];
        assert_true(sets[kind].count == 0 || sets[kind].fingerprint != others[kind].fingerprint);
    }
    assert_int_equal(sets[RT_RAY_PRIMARY].count, 16 * 16);
    assert_int_equal(others[RT_RAY_PRIMARY].count, 17 * 17);
    assert_false(scene.sampling.corners);
    for (int k = 0; k < RT_RAY_KIND_COUNT; k++) {
        rt_rayset_clear(&sets[k]);
        rt_rayset_clear(&others[k]);
    }
    rt_accel_destroy(reference);
}

RT_TESTS(best_of, NULL, NULL)
