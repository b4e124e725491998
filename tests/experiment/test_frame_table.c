/* SPDX-License-Identifier: Apache-2.0 */
/* What whole frames cost, of results that are made by hand. */
#include "testing.h"

#include "core/base/memory.h"
#include "results/result_tables.h"

/* A scene with 100 primary, 300 shadow and 100 reflection rays; and one with primary rays alone. */
static RtExperiment *e;
static RtResults results;
enum { BRUTE, GRID, CLUSTERS, LIGHT, WIDE, IDEAL };

static void add(const char *spec, const char *group) {
    RtCandidate candidate = {.ray_stride = 1};
    strcpy(candidate.spec, spec);
    strcpy(candidate.group, group);
    assert_ok(rt_experiment_add_accels(e, &candidate, error));
}

/* One ray of each kind takes `ns` and `tests`; `shadow` ns a shadow ray. */
static void set(uint32_t t, uint32_t c, const char *spec, double ns, double shadow, uint64_t tests) {
    RtBuildResult *build = rt_build_at(&results, t, c);
    *build = (RtBuildResult){.known = true, .counts = true, .seconds = {0.002, 0.002, 0.002, 0.002}};
    strcpy(build->spec, spec);
    for (uint32_t k = 0; k < RT_RAY_KIND_COUNT; k++) {
        const RtRayKind kind = (RtRayKind)k;
        const double time = 1e-9 * (kind == RT_RAY_SHADOW ? shadow : ns);
        if (results.workloads[t].rays[k] == 0) continue;
        *rt_cell_at(&results, t, c, kind) = (RtCell){.counted = true,
                                                     .timed = true,
                                                     .tally = {.rays = 10, .object_tests = 10 * tests},
                                                     .seconds = {time, time, time, time}};
    }
}

/* Results of all accelerators of set_up. */
static void fill(void) {
    assert_ok(rt_results_init(&results, e, error));
    for (uint32_t t = 0; t < 2; t++) {
        results.workloads[t].known = true;
        results.workloads[t].width = results.workloads[t].height = 10;
        results.workloads[t].rays[RT_RAY_PRIMARY] = 100;
    }
    results.workloads[0].rays[RT_RAY_SHADOW] = 300;
    results.workloads[0].rays[RT_RAY_REFLECTION] = 100;
    results.workloads[0].rays[RT_RAY_RANDOM] = 1000; /* not of a frame */
    for (uint32_t t = 0; t < 2; t++) {
        set(t, BRUTE, "brute:lanes=1", 8000, 8000, 600);
        set(t, GRID, "grid:density=4", 80, 400, 20);
        set(t, CLUSTERS, "clusters:extent=box", 160, 160, 3);
        set(t, LIGHT, "light:cells=0+wide:width=8", 40, 10, 2);
        set(t, WIDE, "wide:width=8", 40, 40, 6);
        set(t, IDEAL, "ideal", 1, 1, 1);
    }
}

static int set_up(void **state) {
    (void)state;
    RtWorkload scene = {.depth = 1};
    char where[RT_MAX_LABEL];
    e = rt_alloc(1, sizeof *e);
    if (!e) return -1;
    rt_experiment_init(e);
    strcpy(e->name, "frames");
    strcpy(e->frame.without, "brute");
    strcpy(e->frame.among, "the six");
    assert_ok(rt_experiment_add_scenes(e, &scene, "balls", "", error));
    assert_ok(rt_experiment_add_scenes(e, &scene, "tetra", "", error));
    add("brute", "none");
    add("grid", "the six");
    add("clusters", "the six");
    add("light+wide", "the six");
    add("wide", "newer");
    add("ideal", "least");
    assert_ok(rt_experiment_check(e, where, error));
    fill();
    return 0;
}

static int tear_down(void **state) {
    (void)state;
    rt_results_clear(&results);
    rt_free(e);
    return 0;
}

#define FRAME_TEST(name) RT_TEST_WITH(name, set_up, tear_down)

static void expect_frame(uint32_t t, uint32_t c, uint32_t winner, double faster, double fewer) {
    RtFrameRow row = {.results = &results, .one = true, .workload = t};
    const RtTable table = rt_frame_table(&row);
    assert_non_null(table.row(table.context, c));
    assert_int_equal(row.winner, winner);
    const RtCost *cost = &row.cost[RT_FRAME_ALL], *without = &row.without[RT_FRAME_ALL];
    assert_true(fabs(without->seconds.median / cost->seconds.median / faster - 1) < 1e-9);
    assert_true(fabs(without->object_tests / cost->object_tests / fewer - 1) < 1e-9);
}

/* Frames take 4 ms, 0.136, 0.08, 0.011 and 0.02 ms. */
FRAME_TEST(a_frame_weighs_each_kind_of_ray_by_its_set) {
    expect_frame(0, CLUSTERS, CLUSTERS, 50, 200);
    expect_frame(0, GRID, CLUSTERS, 4 / 0.136, 30);
    expect_frame(0, LIGHT, CLUSTERS, 4 / 0.011, 300);
    expect_frame(1, GRID, GRID, 100, 30);
}

FRAME_TEST(an_accelerator_without_one_kind_of_ray_has_no_frame_and_does_not_win) {
    rt_cell_at(&results, 0, CLUSTERS, RT_RAY_REFLECTION)->timed = false;
    expect_frame(0, GRID, GRID, 4 / 0.136, 30);
}

FRAME_TEST(a_best_of_takes_part_by_what_it_chose_and_its_members_do_not) {
    e->candidates[GRID].tried = true;
    e->candidates[CLUSTERS].members[0] = GRID;
    e->candidates[CLUSTERS].member_count = 1;
    for (uint32_t k = 0; k < RT_RAY_KIND_COUNT; k++)
        *rt_cell_at(&results, 0, CLUSTERS, (RtRayKind)k) = (RtCell){.chosen = true, .choice = GRID};
    rt_build_at(&results, 0, CLUSTERS)->known = false;
    expect_frame(0, CLUSTERS, CLUSTERS, 4 / 0.136, 30);
    RtFrameRow row = {.results = &results, .one = true};
    const RtTable table = rt_frame_table(&row);
    assert_null(table.row(table.context, GRID));
}

static bool is_unknown(double value) {
    return isnan(value) ? true : false;
}

FRAME_TEST(what_is_not_timed_has_no_interval) {
    RtFrameRow row = {.results = &results};
    const RtTable table = rt_frame_table(&row);
    rt_cell_at(&results, 0, GRID, RT_RAY_SHADOW)->timed = false;
    assert_non_null(table.row(table.context, GRID));
    assert_int_equal(row.winner, CLUSTERS);
    assert_true(is_unknown(row.cost[RT_FRAME_ALL].seconds.low) &&
                is_unknown(row.cost[RT_FRAME_ALL].seconds.high));
    assert_false(is_unknown(row.cost[RT_FRAME_PRIMARY].seconds.low));
}

FRAME_TEST(where_nothing_is_timed_object_tests_decide) {
    e->count_only = true;
    expect_frame(1, CLUSTERS, CLUSTERS, 50, 200);
}

/* 100 primary, 900 of 2700 shadow and 100 reflection rays. */
FRAME_TEST(a_frame_weighs_each_kind_of_ray_by_its_whole_set) {
    RtFrameRow row = {.results = &results};
    const RtTable table = rt_frame_table(&row);
    RtWorkloadResult *w = &results.workloads[0];
    char text[RT_MAX_FRAME_TEXT];
    memcpy(w->whole_rays, w->rays, sizeof w->rays);
    w->whole_rays[RT_RAY_SHADOW] = 2700;
    assert_non_null(table.row(table.context, GRID));
    assert_true(row.cost[RT_FRAME_ALL].weight == 2900);
    assert_true(row.cost[RT_FRAME_ALL].object_tests == 2900 * 20);
    assert_true(fabs(row.cost[RT_FRAME_ALL].seconds.median - 1e-9 * (200 * 80 + 2700 * 400)) < 1e-15);
    assert_true(fabs(row.without[RT_FRAME_SHADOW].seconds.median - 1e-9 * 2700 * 8000) < 1e-15);
    rt_frame_title(&results, 0, text);
    assert_string_equal(text, "0 objects, a frame of 10x10: 100 primary, 2700 shadow and 100 secondary rays; "
                              "of 2900 rays, 500 measured");
}

static void refused(const char *why) {
    char where[RT_MAX_LABEL];
    assert_bad_input(rt_experiment_check(e, where, error), why);
    assert_string_equal(where, "frame");
}

FRAME_TEST(a_frame_needs_its_accelerator_its_group_and_its_kinds_of_rays) {
    strcpy(e->frame.without, "none");
    refused("'none' is not the label of an accelerator");
    strcpy(e->frame.without, "brute");
    strcpy(e->frame.among, "nobody");
    refused("'nobody' is not the group");
    strcpy(e->frame.among, "the six");
    e->kind_count = 1;
    refused("a frame also has shadow rays");
}

RT_TESTS(frame_table, NULL, NULL)
