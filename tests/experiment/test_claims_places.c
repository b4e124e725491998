/* SPDX-License-Identifier: Apache-2.0 */
/* Claims that compare places, rank accelerators or count cells, and how figures are written. */
#include "claims_testing.h"

/* Times: bvh 100 to 104 ns on n=10, twice as much on each next scene; grids 200 to 215, 220, 225. */
RT_TEST(a_ratio_compares_cells_of_different_scenes_kinds_and_parameters) {
    set_all();
    rt_cell_at(&results, 3, 2, RT_RAY_SHADOW)->tally.object_tests = 20000; /* 20 a ray, of 5 */
    shows("ratio of object_tests of bvh on balls to bvh on random:n=10 for primary rays",
          "1.15 (bvh on balls to bvh on random:n=10)");
    shows("ratio of object_tests of bvh at largest n to bvh at smallest n for shadow rays",
          "1.10 (bvh on random:n=1000 to bvh on random:n=10)");
    shows("ratio of object_tests of grid for shadow rays to grid for primary rays on balls",
          "1.00 (grid:density=1 on balls, shadow rays to grid:density=1 on balls, primary rays); 4.00 "
          "(grid:density=2 on "
          "balls, shadow rays to grid:density=2 on balls, primary rays); 1.00");
    holds("ratio of object_tests of grid at density=1 to grid at density=4 > 3", "3.03");
    holds("ratio of object_tests of grid on balls to bvh on random:n=10 at density=1 >= 5", "5.00");
    for (uint32_t k = 0; k < 2; k++) rt_cell_at(&results, 3, 0, (RtRayKind)k)->tally.steps = 4600;
    holds("ratio of object_tests of bvh to steps of bvh on balls <= 0.5", "0.50");
}

/* 800 / 104 to 832 / 100. */
RT_TEST(a_ratio_of_times_of_different_scenes_has_the_ends_of_both_intervals) {
    set_all();
    holds("ratio of time of bvh on balls to bvh on random:n=10 > 7.6",
          "8.0 [7.7, 8.3] (bvh on balls, primary rays to bvh on random:n=10, primary rays)");
    is_undecided("ratio of time of bvh on balls to bvh on random:n=10 > 7.7", "");
    uint32_t count;
    strcpy(e->claims[0], "ratio of time of bvh on balls to bvh on random:n=10 > 7.6");
    e->claim_count = 1;
    rt_claims_coverage(&results, &count);
    assert_int_equal(count, 4); /* two kinds of rays, two intervals each */
}

RT_TEST(an_accelerator_is_fastest_if_no_other_is_better_in_any_cell) {
    set_all();
    holds("bvh is fastest on random:n=10", "(bvh to grid:density=");
    is_false("bvh is fastest", "3.9");
    is_false("grid:density=4 is fastest on random:n=10",
             "(grid:density=4 to bvh on random:n=10, primary rays)");
    is_undecided("bvh is fastest on random:n=100", ""); /* 200 to 208 against 200 to 215 */
    set(0, 2, 50, 50, 51);
    is_false("bvh is fastest on random:n=10", "(bvh to grid:density=2 on random:n=10");
    rt_cell_at(&results, 0, 2, RT_RAY_SHADOW)->seconds = (RtEstimate){300e-9, 300e-9, 300e-9, 300e-9};
    holds("bvh is fastest on random:n=10 for shadow rays", "");
    holds("bvh has least object_tests", "0.");
    set(0, 3, 20, 100, 100);
    holds("bvh has least object_tests", "1.00"); /* another has as few */
    set(0, 3, 19, 100, 100);
    is_false("bvh has least object_tests", "1.05 (bvh to grid:density=4 on random:n=10");
}

RT_TEST(an_accelerator_that_refuses_the_scene_is_not_compared_and_one_that_was_left_out_is) {
    set_all();
    for (uint32_t k = 0; k < 2; k++)
        *rt_cell_at(&results, 0, 2, (RtRayKind)k) = (RtCell){.left_out = "too slow"};
    is_undecided("bvh is fastest on random:n=10", "2 of 6 values are unknown");
    rt_build_at(&results, 0, 2)->refused = true;
    holds("bvh is fastest on random:n=10", "");
    rt_build_at(&results, 0, 2)->refused = false;
}

RT_TEST(the_yardstick_is_not_compared) {
    RtCandidate ideal = {.spec = "ideal", .ray_stride = 1};
    rt_results_clear(&results);
    assert_ok(rt_experiment_add_accels(e, &ideal, error));
    assert_ok(rt_results_init(&results, e, error));
    for (uint32_t t = 0; t < 4; t++) results.workloads[t].rays[0] = results.workloads[t].rays[1] = 1000;
    set_all();
    for (uint32_t t = 0; t < 4; t++) set(t, 4, 1, 1, 1);
    holds("bvh is fastest on random:n=10", "");
    shows("least object_tests on random:n=10 for primary rays", "bvh (random:n=10)");
    tear_down(NULL);
    set_up(NULL);
}

static void says(const char *claim, const char *value) {
    RtClaimResult result;
    assert_ok(rt_claim_judge_text(&results, claim, false, &result, error));
    assert_string_equal(result.value, value);
}

RT_TEST(the_fastest_are_named_with_those_that_are_level) {
    set_all();
    shows("fastest on random:n=10", "bvh (random:n=10, primary rays); bvh (random:n=10, shadow rays)");
    says("fastest on random:n=10", "bvh");
    says("fastest on random:n=100 for primary rays", "bvh, grid:density=1, grid:density=2, grid:density=4");
    says("least object_tests", "bvh");
}

RT_TEST(cells_are_counted_in_which_a_claim_holds) {
    set_all();
    shows("count of time of bvh < 300", "4 of 8");
    shows("count of time of bvh < 203", "2 of 8, 2 undecided");
    shows("count of bvh is fastest", "2 of 8, 2 undecided");
    shows("count of object_tests of grid falls with density", "8 of 8");
    set(0, 2, 50, 50, 51); /* one of several rivals is faster */
    shows("count of bvh is fastest on random:n=10", "0 of 2");
}

/* 100, 200, 400 and 800 ns: the square root of 200 * 400. */
RT_TEST(a_geometric_mean_is_over_the_cells_of_each_kind_of_rays) {
    set_all();
    shows("geometric mean of time of bvh", "288 [283, 294] ns over 4 values (primary rays); 288");
    shows("geometric mean of object_tests of grid on balls for primary rays",
          "5.48 over 3 values"); /* 10, 5 and 3.3 */
    holds("geometric mean of ratio of time of bvh to grid:density=1 > 1.3",
          "1.39 [1.32, 1.47] over 4 values");
    is_undecided("geometric mean of ratio of time of bvh to grid:density=1 > 1.36", "");
    shows("geometric mean of ratio of object_tests of all to bvh on balls for primary rays",
          "2.38 over 3 values"); /* 10, 5 and 3.3 of 2.3: without bvh itself */
    rt_cell_at(&results, 0, 0, RT_RAY_SHADOW)->timed = false;
    is_undecided("geometric mean of time of bvh < 1000", "1 of 8 values are unknown");
}

RT_TEST(frames_sets_scenes_and_structures_have_measures) {
    set_all();
    for (uint32_t k = 0; k < 2; k++) results.workloads[0].whole_rays[k] = k ? 3000000 : 1000000;
    rt_cell_at(&results, 0, 0, RT_RAY_PRIMARY)->tally.hits = 250;
    results.workloads[3].known = true;
    results.workloads[3].objects = 7382;
    *rt_build_at(&results, 0, 1) = (RtBuildResult){
        .known = true,
        .structure = {.interior = 7, .leaves = 8, .empty_leaves = 2, .references = 40, .depth = 3}};
    shows("frame_time of bvh on random:n=10", "0.408 [0.400, 0.416] s (bvh on random:n=10)");
    shows("ratio of frame_time of bvh to grid:density=1 on random:n=10", "0.49");
    shows("rays on random:n=10", "1000000 (random:n=10, primary rays); 3000000 (random:n=10, shadow rays)");
    shows("rays on random:n=10 for all rays as millions", "4.00 million (random:n=10)");
    shows("share on random:n=10 for shadow rays as percent", "75.0 % (random:n=10)");
    shows("ratio of rays for shadow rays to rays for primary rays on random:n=10", "3");
    shows("hits on random:n=10 for primary rays", "0.250 (random:n=10)");
    shows("objects on balls", "7382 (balls)");
    shows("interior of grid:density=1 on random:n=10", "7");
    shows("empty_leaves of grid:density=1 on random:n=10", "2");
    shows("ratio of references of grid:density=1 to leaves of grid:density=1 on random:n=10", "5.00");
    shows("depth of grid:density=1 on random:n=10", "3.00");
}

RT_TEST(figures_are_written_in_the_format_asked_for) {
    set_all();
    says("time of bvh on random:n=10 for primary rays", "102 [100, 104] ns");
    says("time of bvh on random:n=10 for primary rays as plain us", "0.102 us");
    says("time of bvh for primary rays", "102 to 816 ns");
    says("ratio of object_tests of bvh to grid:density=1 on random:n=10 for primary rays as percent less",
         "80.0 % less");
    says("ratio of object_tests of bvh to grid:density=1 for primary rays as percent less",
         "77.0 to 80.0 % less");
    says("ratio of object_tests of grid:density=1 to bvh on random:n=10 for primary rays as times",
         "5.00 times");
    says("ratio of object_tests of grid:density=1 to bvh on random:n=10 for primary rays as percent more",
         "400 % more");
    says("ratio of time of bvh to grid:density=1 on random:n=10 for primary rays as percent",
         "49 [47, 52] %");
    says("ratio of time of bvh to grid:density=1 on random:n=10 for primary rays as plain", "0.492");
    says("bytes of bvh on balls as MB", "unknown");
}

RT_TESTS(claims_places, set_up, tear_down)
