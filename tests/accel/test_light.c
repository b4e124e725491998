/* SPDX-License-Identifier: Apache-2.0 */
/* The light buffer: what it counts, counted by hand, and what its cells remember. */
#include "light_testing.h"

#include "scenes/builtin.h"

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
        RtTally tallies[RT_RAY_KIND_COUNT] = {{0}};
        bool blocked;
        OWNED_ACCEL RtAccel *accel = open_accel(scene, rows[i].spec);
        OWNED_QUERY query = open_query(accel);
        rt_occluded(&query, &rows[i].ray, 1, &blocked, tallies);
        if (blocked != rows[i].blocked) fail_msg("row %zu: blocked is %d", i, blocked);
        check_tally(i, &tallies[RT_RAY_SHADOW], &rows[i].expected);
    }
}

#define HIT(tests)                                                                                           \
    { .rays = 1, .hits = 1, .object_tests = tests, .object_hits = 1, .steps = tests }

RT_TEST(it_counts_what_was_counted_by_hand) {
    OWNED_SCENE scene = make_screen();
    RtRay above = shadow_ray(&scene, rt_vec3(0.5f, 0.5f, 6), 0);    /* under the sphere, above the screen */
    RtRay below = shadow_ray(&scene, rt_vec3(0.5f, 0.5f, 3), 0);    /* under both */
    RtRay high = shadow_ray(&scene, rt_vec3(0.5f, 0.5f, 9.02f), 0); /* above both */
    RtRay under = shadow_ray(&scene, rt_vec3(3.5f, 3.5f, 3), 0);    /* under the screen, past the sphere */
    RtRay over = shadow_ray(&scene, rt_vec3(3.5f, 3.5f, 6), 0);     /* above the screen, past the sphere */
    RtRay deepest = shadow_ray(&scene, rt_vec3(3.9f, 3.9f, 0.9f), 0);
    RtRay on_top = shadow_ray(&scene, rt_vec3(3.5f, 3.5f, 5.01f), 0);
    RtRay aside = shadow_ray(&scene, rt_vec3(0.5f, 0.5f, 8.9f), 0);
    RtRay askew = below, foreign = below, longer = below, away = below;
    askew.dir.x *= 1.5f;
    foreign.source = 1;
    longer.tmax = 2;
    away.org.z = -1000;
    away.dir.z = 1010;
    const RtTally passed = {.rays = 1, .hits = 1, .object_tests = 1, .object_hits = 1, .passed_on = 1};
    const Row rows[] = {
        /* One cell a face: the list downwards is sphere 1 (depth 1), polygon 0 (5), sphere 2 (9). */
        {"light:cells=1+brute", above, true, HIT(1)},
        /* No object is less deep than 0.98. */
        {"light:cells=1+brute", high, false, {.rays = 1}},
        /* The sphere in vain, and then the screen; sphere 2 is deeper than the ray, or comes too late. */
        {"light:cells=1,full_occlusion=off+brute", under, true, HIT(2)},
        {"light:cells=1,full_occlusion=off+brute", deepest, true, HIT(2)},
        {"light:cells=1,full_occlusion=off+brute", over, false, {.rays = 1, .object_tests = 1, .steps = 1}},
        /* Right above the screen, which is deeper; sphere 1 is not in the cell. */
        {"light:cells=16+brute", on_top, false, {.rays = 1}},
        /* Right above sphere 1, which begins less deep. */
        {"light:cells=1+brute", aside, false, {.rays = 1, .object_tests = 1, .steps = 1}},
        /* With 16 cells sphere 1 covers the cell around its middle. */
        {"light:cells=16+brute", below, true, HIT(1)},
        /* A list that is cut after one entry: brute goes on, both spheres before the polygon. */
        {"light:cells=1,longest=1+brute",
         under,
         true,
         {.rays = 1, .hits = 1, .object_tests = 4, .object_hits = 1, .steps = 1, .passed_on = 1}},
        /* What is no ray to a light is passed on, where brute tests in order of shape: sphere 1 first. */
        {"light:cells=64+brute", foreign, true, passed},
        {"light:cells=64+brute", longer, true, passed},
        {"light:cells=64+brute", askew, true, passed},
        /* So is one from outside the domain, and any in a scene so small that lists do not pay. */
        {"light:cells=64+brute", away, true, passed},
        {"light+brute", below, true, passed},
    };
    check_rows(&scene, rows, sizeof rows / sizeof rows[0]);
}

/* Down a triangle that slants from depth 1 to 10: 6.9 along the ray, whose point is before it, and then
 * behind. */
RT_TEST(a_slanted_triangle_is_as_deep_in_each_cell_as_its_plane) {
    OWNED_SCENE scene = begin_scene();
    const RtVec3 slanted[3] = {{{-1, 0, -1}}, {{10, -10, -10}}, {{10, 10, -10}}};
    assert_ok(rt_scene_add_light(&scene, rt_vec3(0, 0, 0), rt_vec3(1, 1, 1), error));
    assert_ok(rt_scene_add_triangle(&scene, 0, slanted, NULL, error));
    assert_ok(rt_scene_finish(&scene, error));
    const Row rows[] = {
        {"light:cells=16+brute", shadow_ray(&scene, rt_vec3(2.7f, 0, -3), 0), false, {.rays = 1}},
        {"light:cells=16+brute", shadow_ray(&scene, rt_vec3(8.1f, 0, -9), 0), true, HIT(1)},
    };
    check_rows(&scene, rows, sizeof rows / sizeof rows[0]);
}

/* The light is inside of sphere 0, and so in its box: it is in each cell, before everything else. */
RT_TEST(an_object_around_the_light_is_tested_first) {
    OWNED_SCENE scene = begin_scene();
    assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(0.1f, 0, 0), 1, error));
    assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(0, 0, 3), 1, error));
    assert_ok(rt_scene_add_light(&scene, rt_vec3(0, 0, 0), rt_vec3(1, 1, 1), error));
    assert_ok(rt_scene_finish(&scene, error));
    const Row rows[] = {
        {"light:cells=16+brute", shadow_ray(&scene, rt_vec3(0, 0, 4), 0), true, HIT(1)},
        {"light:cells=16+brute", shadow_ray(&scene, rt_vec3(-0.5f, 0.9f, 3), 0), true, HIT(1)},
    };
    check_rows(&scene, rows, sizeof rows / sizeof rows[0]);
}

/* ---- the domain ---- */

/* Beyond the scene by a 256th of its size, 3 % less or more. */
RT_TEST(rays_from_a_little_off_the_scene_are_served) {
    OWNED_SCENE scene = make_screen();
    OWNED_ACCEL RtAccel *accel = open_accel(&scene, "light:cells=4+brute");
    OWNED_QUERY query = open_query(accel);
    const RtBox *box = &scene.geometry.box;
    const float off = (float)rt_box_longest_side(*box) / 256;
    for (int i = 0; i < 12; i++) {
        RtVec3 from = rt_box_center(*box);
        int axis = i / 4, outside = i % 2;
        float away = off * (outside ? 1.03f : 0.97f);
        from.at[axis] = i & 2 ? box->hi.at[axis] + away : box->lo.at[axis] - away;
        RtRay ray = shadow_ray(&scene, from, 0);
        RtTally tallies[RT_RAY_KIND_COUNT] = {{0}};
        bool blocked;
        rt_occluded(&query, &ray, 1, &blocked, tallies);
        assert_int_equal(tallies[RT_RAY_SHADOW].passed_on, outside);
    }
}

/* ---- the same on all machines ---- */

static void check_same_lists(const RtLightGrid *a, const RtLightGrid *b) {
    const uint32_t cells = a->columns * a->rows;
    assert_int_equal(a->columns, b->columns);
    assert_int_equal(a->rows, b->rows);
    if (cells == 0) return;
    assert_memory_equal(a->first, b->first, (cells + (size_t)1) * sizeof *a->first);
    assert_memory_equal(a->entries, b->entries, a->first[cells] * sizeof *a->entries);
}

static const char *const large_scenes[] = {"hall:size=1", "city:size=3"};

RT_TEST(lists_do_not_depend_on_threads) {
    for (size_t i = 0; i < sizeof large_scenes / sizeof large_scenes[0]; i++) {
        OWNED_SCENE scene;
        RtAccel *one, *three;
        assert_ok(rt_builtin_open(large_scenes[i], &scene, error));
        assert_ok(rt_accel_open_on("light:cells=200+brute", &scene, 1, &one, error));
        assert_ok(rt_accel_open_on("light:cells=200+brute", &scene, 3, &three, error));
        const RtLightCube *a = ((RtLightBuffer *)one)->cubes, *b = ((RtLightBuffer *)three)->cubes;
        for (uint32_t k = 0; k < 6 * scene.light_count; k++)
            check_same_lists(&a[k / 6].grids[k % 6], &b[k / 6].grids[k % 6]);
        rt_accel_destroy(one);
        rt_accel_destroy(three);
    }
}

/* ---- lists that pay ---- */

typedef struct Choice {
    const char *scene, *spec;
    bool serves;
} Choice;

RT_TEST(the_buffer_serves_where_rays_cost_more_below_than_in_lists) {
    const Choice choices[] = {
        {"random:n=5000", "light+wide", true},
        {"random:n=5000", "light+brute", true},
        {"lattice", "light+wide", true},
        /* Large flat surfaces: rays leave wide after a step or two. */
        {"gears", "light+wide", false},
        {"tree", "light+wide", false},
        {"city:size=5", "light+wide", false},
        /* Rays are costly in wide, and no cheaper in lists: known only when they are made. */
        {"shells:size=3", "light+wide", false},
        {"random:n=0", "light+wide", false},
        {"random:n=3", "light+brute", false},
        /* Lists that are asked for are made. */
        {"gears", "light:cells=7+wide", true},
    };
    for (size_t i = 0; i < sizeof choices / sizeof choices[0]; i++) {
        OWNED_SCENE scene;
        assert_ok(rt_builtin_open(choices[i].scene, &scene, error));
        OWNED_ACCEL RtAccel *accel = open_accel(&scene, choices[i].spec);
        const RtLightBuffer *buffer = (const RtLightBuffer *)accel;
        if (buffer->serves != choices[i].serves)
            fail_msg("%s on %s: serves is %d", choices[i].spec, choices[i].scene, buffer->serves);
        for (uint32_t k = 0; k < 6 * scene.light_count; k++) {
            const RtLightGrid *grid = &buffer->cubes[k / 6].grids[k % 6];
            assert_int_equal(grid->first != NULL, buffer->serves && grid->columns > 0);
        }
    }
}

enum { MANY = 4000 };

static void answer(RtAccel *accel, const RtRay *rays, bool *blocked, RtTally *tally) {
    RtTally tallies[RT_RAY_KIND_COUNT] = {{0}};
    OWNED_QUERY query = open_query(accel);
    rt_occluded(&query, rays, MANY, blocked, tallies);
    *tally = tallies[RT_RAY_SHADOW];
}

RT_TEST(every_instruction_set_counts_the_same) {
    static RtRay rays[MANY];
    static bool expected[MANY], blocked[MANY];
    for (size_t i = 0; i < sizeof large_scenes / sizeof large_scenes[0]; i++) {
        OWNED_SCENE scene;
        RtTally by_best, tally;
        assert_ok(rt_builtin_open(large_scenes[i], &scene, error));
        OWNED_ACCEL RtAccel *accel = open_accel(&scene, "light:cells=200+brute");
        RtLightBuffer *buffer = (RtLightBuffer *)accel;
        RtRandom random = rt_random(9, 0);
        for (uint32_t k = 0; k < MANY; k++) {
            const RtBox *box = &scene.geometry.boxes[rt_random_below(&random, scene.geometry.object_count)];
            rays[k] = shadow_ray(&scene, rt_box_center(*box), k % scene.light_count);
        }
        answer(accel, rays, expected, &by_best);
        const RtKernels *best = buffer->isa.kernels;
        for (RtIsa isa = RT_ISA_PORTABLE; isa <= RT_ISA_AVX512; isa++) {
            if (!rt_isa_runs(isa)) continue;
            buffer->isa.kernels = RT_KERNELS_FOR(light, isa);
            answer(accel, rays, blocked, &tally);
            assert_memory_equal(blocked, expected, sizeof blocked);
            assert_memory_equal(&tally, &by_best, sizeof tally);
        }
        buffer->isa.kernels = best;
    }
}

RT_TESTS(light, NULL, assert_nothing_is_kept)
