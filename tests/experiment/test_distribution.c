/* SPDX-License-Identifier: Apache-2.0 */
/* measure/statistics.h: bins, percentiles, JSON; and that what is distributed is what was counted. */
#include "testing.h"

#include "core/base/random.h"
#include "run/workload.h"

/* ---- bins ---- */

RT_TEST(bins_follow_one_another_and_are_no_wider_than_an_eighth_of_where_they_begin) {
    for (uint32_t bin = 0; bin < RT_HISTOGRAM_BINS; bin++) {
        uint64_t low = rt_histogram_low(bin), end = rt_histogram_low(bin + 1);
        assert_true(low < end && (end - low == 1 || 8 * (end - low) <= low));
        assert_int_equal(rt_histogram_bin(low), bin);
        assert_int_equal(rt_histogram_bin(end - 1), bin);
    }
    assert_int_equal(rt_histogram_low(0), 0);
    assert_int_equal(rt_histogram_low(RT_HISTOGRAM_BINS), UINT64_C(1) << 32);
}

/* ---- percentiles ---- */

static RtDistribution distribute(const uint64_t *values, size_t count) {
    RtOccurrences occurrences = {0};
    for (size_t i = 0; i < count; i++) assert_ok(rt_occurrences_add(&occurrences, values[i], error));
    RtDistribution d = rt_distribution_of(&occurrences);
    rt_occurrences_clear(&occurrences);
    return d;
}

static uint64_t count_up_to(const uint64_t *values, size_t count, uint64_t most) {
    uint64_t n = 0;
    for (size_t i = 0; i < count; i++) n += values[i] <= most;
    return n;
}

/* By the definition: that many do not exceed it, and fewer do not exceed the value before it. */
static void assert_percentile(const uint64_t *values, size_t count, uint64_t value, uint64_t thousandths) {
    assert_true(1000 * count_up_to(values, count, value) >= thousandths * count);
    if (value > 0) assert_true(1000 * count_up_to(values, count, value - 1) < thousandths * count);
}

RT_TEST(percentiles_are_the_least_values_that_so_many_do_not_exceed) {
    RtRandom random = rt_random(1, 0);
    for (size_t count = 1; count < 3000; count = count * 3 / 2 + 1) {
        uint64_t values[3000], sum = 0, most = 0, in_bins = 0;
        for (size_t i = 0; i < count; i++) {
            values[i] = rt_random_bits(&random) >> (12 + rt_random_bits(&random) % 20);
            sum += values[i];
            most = values[i] > most ? values[i] : most;
        }
        RtDistribution d = distribute(values, count);
        assert_int_equal(d.count, count);
        assert_int_equal(d.sum, sum);
        assert_int_equal(d.most, most);
        assert_percentile(values, count, d.median, 500);
        assert_percentile(values, count, d.p90, 900);
        assert_percentile(values, count, d.p99, 990);
        assert_percentile(values, count, d.p999, 999);
        for (uint32_t bin = 0; bin < RT_HISTOGRAM_BINS; bin++) {
            uint64_t below =
                rt_histogram_low(bin) ? count_up_to(values, count, rt_histogram_low(bin) - 1) : 0;
            assert_int_equal(d.bins[bin], count_up_to(values, count, rt_histogram_low(bin + 1) - 1) - below);
            in_bins += d.bins[bin];
        }
        assert_int_equal(in_bins, count);
    }
}

RT_TEST(of_equal_values_each_percentile_is_that_value_and_of_none_all_are_zero) {
    const uint64_t values[] = {7, 7, 7};
    RtDistribution same = distribute(values, 3), none = distribute(values, 0);
    assert_true(same.median == 7 && same.p90 == 7 && same.p99 == 7 && same.p999 == 7 && same.most == 7);
    assert_true(none.count == 0 && none.median == 0 && none.most == 0);
}

RT_TEST(a_distribution_that_does_not_fit_into_memory_is_refused) {
    OWNED(rt_occurrences_clear) RtOccurrences occurrences = {0};
    RtError error;
    rt_alloc_fail_at(1);
    assert_int_equal(rt_occurrences_add(&occurrences, 1, &error), RT_NO_MEMORY);
    rt_alloc_fail_at(0);
    assert_int_equal(rt_occurrences_add(&occurrences, UINT64_C(1) << 40, &error), RT_BROKEN);
}

/* ---- JSON ---- */

RT_TEST(distributions_come_back_from_json_as_they_were) {
    const uint64_t few[] = {0, 1, 1, 300}, many[] = {5, 1000000, 70000};
    RtDistribution out[2], all[2] = {distribute(few, 4), distribute(many, 3)};
    json_auto_t *object = rt_distributions_json(all, RT_RAY_QUANTITY_COUNT, 2);
    assert_non_null(json_object_get(object, "leaf_size"));
    assert_true(rt_distributions_take(out, RT_RAY_QUANTITY_COUNT, 2, object));
    assert_memory_equal(out, all, sizeof all);
    assert_false(rt_distributions_take(out, 0, 2, object)); /* those over rays are not there */
    json_array_append_new(json_object_get(json_object_get(object, "leaf_size"), "bins"),
                          json_pack("[i, i]", (int)RT_HISTOGRAM_BINS, 1));
    assert_false(rt_distributions_take(out, RT_RAY_QUANTITY_COUNT, 2, object));
}

/* ---- of a workload ---- */

static const char *const counted[] = {"brute", "grid", "octree", "kd", "clusters", "cache+bvh", "bvh"};
enum { COUNTED = sizeof counted / sizeof counted[0] };

/* A cloud and these accelerators, with distributions, counted. */
static void count_cloud(RtExperiment *e, RtResults *results) {
    const RtWorkload scene = {.depth = 2, .width = RT_SHARE(64, 24), .height = RT_SHARE(64, 24)};
    const RtWorkloadOptions options = {.threads = 2, .timing = 1, .count_only = true};
    char where[RT_MAX_LABEL];
    rt_experiment_init(e);
    strcpy(e->name, "spread");
    e->distributions = true;
    e->candidate_count = COUNTED;
    for (uint32_t c = 0; c < COUNTED; c++) {
        e->candidates[c] = (RtCandidate){.ray_stride = c == 0 ? 3 : 1};
        strcpy(e->candidates[c].spec, counted[c]);
        strcpy(e->candidates[c].label, counted[c]);
    }
    e->baseline = COUNTED - 1;
    assert_ok(rt_experiment_add_scenes(e, &scene, "random:n=300", "", error));
    assert_ok(rt_experiment_check(e, where, error));
    assert_ok(rt_results_init(results, e, error));
    assert_ok(rt_workloads_run(results, &options, error));
}

/* None of these has rays share what they do. */
RT_TEST(sums_over_rays_are_the_counts_and_leaves_are_those_of_the_structure) {
    OWNED_MEMORY RtExperiment *e = rt_alloc(1, sizeof(RtExperiment));
    OWNED_RESULTS results;
    count_cloud(e, &results);
    for (uint32_t c = 0; c < COUNTED; c++) {
        const RtBuildResult *build = rt_build_at(&results, 0, c);
        for (uint32_t k = 0; k < e->kind_count; k++) {
            const RtCell *cell = rt_cell_at(&results, 0, c, e->kinds[k]);
            if (!results.workloads[0].rays[e->kinds[k]]) continue;
            assert_non_null(cell->distributions);
            assert_int_equal(cell->distributions[RT_QUANTITY_object_tests].count, cell->tally.rays);
            assert_int_equal(cell->distributions[RT_QUANTITY_object_tests].sum, cell->tally.object_tests);
            assert_int_equal(cell->distributions[RT_QUANTITY_extent_tests].sum, cell->tally.extent_tests);
            assert_int_equal(cell->distributions[RT_QUANTITY_steps].sum, cell->tally.steps);
        }
        assert_true(!build->leaves == (c == 0)); /* brute has none */
        if (!build->leaves) continue;
        assert_int_equal(build->leaves[RT_QUANTITY_leaf_size].count, build->structure.leaves);
        assert_int_equal(build->leaves[RT_QUANTITY_leaf_size].sum, build->structure.references);
        assert_int_equal(build->leaves[RT_QUANTITY_leaf_depth].most, build->structure.depth);
    }
}

RT_TESTS(distribution, NULL, assert_nothing_is_kept)
