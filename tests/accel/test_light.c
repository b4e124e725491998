/* SPDX-License-Identifier: Apache-2.0 */
/* The light buffer: what it counts, counted by hand, and what its cells remember. */
#include "light_testing.h"

/* ---- counted by hand ---- */

typedef struct Row {
    const char *spec;
    RtRay ray;
    bool blocked;
    RtTally expected;
} Row;

static void check_tally(size_t row, const RtTally *tally, const RtTally *expected) {
    for (size_t c = 0; c < RT_TALLY_COUNTER_COUNT; c++) {
        uint64_t got = rt_tally_get(tally, c), hand = rt_tally_get(expected, c);
        if (got != hand) fail_msg("row %zu, %s: %d, by hand %d", row, rt_tally_name(c), (int)got, (int)hand);
    }
}

static void check_rows(const RtScene *scene, const Row *rows, size_t count) {
    for (size_t i = 0; i < count; i++) {
        RtAccel *accel;
        RtQuery query;
        RtTally tallies[RT_RAY_KIND_COUNT] = {{0}};
        bool blocked;
        assert_ok(rt_accel_open(rows[i].spec, scene, &accel, error));
        assert_ok(rt_query_init(&query, accel, error));
        rt_occluded(&query, &rows[i].ray, 1, &blocked, tallies);
        if (blocked != rows[i].blocked) fail_msg("row %zu: blocked is %d", i, blocked);
        check_tally(i, &tallies[RT_RAY_SHADOW], &rows[i].expected);
        rt_query_clear(&query);
        rt_accel_destroy(accel);
    }
}

RT_TEST(it_counts_what_was_counted_by_hand) {
    RtScene scene;
    make_screen(&scene);
    RtRay above = shadow_ray(&scene, rt_vec3(0.5f, 0.5f, 6), 0);    /* under the sphere, above the screen */
    RtRay below = shadow_ray(&scene, rt_vec3(0.5f, 0.5f, 3), 0);    /* under both */
    RtRay high = shadow_ray(&scene, rt_vec3(0.5f, 0.5f, 9.02f), 0); /* above both */
    RtRay askew = below, foreign = below, longer = below, away = below;
    askew.dir.x *= 1.5f;
    foreign.source = 1;
    longer.tmax = 2;
    away.org.z = -1000;
    away.dir.z = 1010;
    const Row rows[] = {
        /* One cell a face: the list downwards is sphere 1 (depth 1), polygon 0 (5), sphere 2 (9). */
        {"light:cells=1+brute",
         above,
         true,
         {.rays = 1, .hits = 1, .object_tests = 1, .object_hits = 1, .extent_tests = 1, .steps = 1}},
        {"light:cells=1,extents=off+brute",
         above,
         true,
         {.rays = 1, .hits = 1, .object_tests = 1, .object_hits = 1, .steps = 1}},
        /* No object is less deep than 0.98. */
        {"light:cells=1+brute", high, false, {.rays = 1}},
        /* With 16 cells sphere 1 covers the cell around its middle: it is what hides the depths. */
        {"light:cells=16+brute",
         below,
         true,
         {.rays = 1, .hits = 1, .object_tests = 1, .object_hits = 1, .extent_tests = 1, .steps = 1}},
        /* What is no ray to a light is passed on, where brute tests in order of shape: sphere 1 first. */
        {"light+brute",
         foreign,
         true,
         {.rays = 1, .hits = 1, .object_tests = 1, .object_hits = 1, .passed_on = 1}},
        {"light+brute",
         longer,
         true,
         {.rays = 1, .hits = 1, .object_tests = 1, .object_hits = 1, .passed_on = 1}},
        {"light+brute",
         askew,
         true,
         {.rays = 1, .hits = 1, .object_tests = 1, .object_hits = 1, .passed_on = 1}},
        /* Nor is one from outside the domain. */
        {"light+brute",
         away,
         true,
         {.rays = 1, .hits = 1, .object_tests = 1, .object_hits = 1, .passed_on = 1}},
    };
    check_rows(&scene, rows, sizeof rows / sizeof rows[0]);
    rt_scene_clear(&scene);
}

/* ---- what a cell remembers ---- */

RT_TEST(a_cell_remembers_what_blocked_its_last_ray) {
    RtScene scene;
    make_screen(&scene);
    /* One cell a face, its list sphere 1 (depth 1), polygon 0 (5), sphere 2 (9). The first ray passes through
     * the box of sphere 1 and misses it, as the second does, which is from above the screen. */
    RtRay under = shadow_ray(&scene, rt_vec3(3.5f, 3.5f, 3), 0);
    RtRay over = shadow_ray(&scene, rt_vec3(3.5f, 3.5f, 6), 0);
    RtRay shaded = shadow_ray(&scene, rt_vec3(0.5f, 0.5f, 6), 0);
    const RtTally from_the_start = {.rays = 1,
                                    .hits = 1,
                                    .object_tests = 2,
                                    .object_hits = 1,
                                    .extent_tests = 3, /* two boxes, and the plane of the polygon */
                                    .steps = 2};
    const struct {
        RtRay ray;
        bool begin;
        RtTally expected;
    } rows[] = {
        {under, false, from_the_start},
        /* The polygon, remembered, comes first; */
        {under,
         false,
         {.rays = 1, .hits = 1, .object_tests = 1, .object_hits = 1, .extent_tests = 2, .steps = 1}},
        /* but not where it is deeper than the origin. What misses changes nothing. */
        {over, false, {.rays = 1, .object_tests = 1, .extent_tests = 1, .steps = 1}},
        {under,
         false,
         {.rays = 1, .hits = 1, .object_tests = 1, .object_hits = 1, .extent_tests = 2, .steps = 1}},
        /* Now sphere 1 is remembered, */
        {shaded,
         false,
         {.rays = 1, .hits = 1, .object_tests = 1, .object_hits = 1, .extent_tests = 1, .steps = 1}},
        /* and tried in vain, once. */
        {under, false, from_the_start},
        /* A new beginning: the polygon is forgotten. */
        {under, true, from_the_start},
    };
    RtAccel *accel;
    RtQuery query;
    assert_ok(rt_accel_open("light:cells=1,full_occlusion=off+brute", &scene, &accel, error));
    assert_ok(rt_query_init(&query, accel, error));
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        RtTally tallies[RT_RAY_KIND_COUNT] = {{0}};
        bool blocked;
        if (rows[i].begin) rt_query_begin(&query);
        rt_occluded(&query, &rows[i].ray, 1, &blocked, tallies);
        check_tally(i, &tallies[RT_RAY_SHADOW], &rows[i].expected);
    }
    /* Where epochs have been used up, what an old one has left behind is not mistaken for new. */
    RtLightMemory *memory = query.scratch[0].own;
    memory[0].epoch = UINT32_MAX;
    memory[1].epoch = 1;
    rt_query_begin(&query);
    for (size_t i = 1; i <= 6; i++) assert_int_not_equal(memory[i].epoch, memory[0].epoch);
    rt_query_clear(&query);
    rt_accel_destroy(accel);
    rt_scene_clear(&scene);
}

RT_TESTS(light, NULL, assert_nothing_is_kept)
