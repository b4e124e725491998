/* SPDX-License-Identifier: Apache-2.0 */
/* The light buffer: what it counts, counted by hand, what its cells remember; their lists, what covers them,
 * how many fit, and invariants broken. */
#include "light_testing.h"

#include "scenes/builtin.h"

#include <stdlib.h>

/* ---- counted by hand ---- */

typedef struct Row {
    const char *spec;
    RtRay ray;
    bool blocked;
    RtTally expected;
} Row;

static void check_rows(const RtScene *scene, const Row *rows, size_t count) {
    for (size_t i = 0; i < count; i++) {
        RtTally tallies[RT_RAY_KIND_COUNT] = {{0}};
        bool blocked;
        OWNED_ACCEL RtAccel *accel = open_accel(scene, rows[i].spec);
        OWNED_QUERY query = open_query(accel);
        rt_occluded(&query, &rows[i].ray, 1, &blocked, tallies);
        if (blocked != rows[i].blocked) fail_msg("row %zu: blocked is %d", i, blocked);
        assert_tally(rows[i].spec, &tallies[RT_RAY_SHADOW], &rows[i].expected);
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
        RtRandom random = rt_random(9, 0);
        for (uint32_t k = 0; k < MANY; k++) {
            const RtBox *box = &scene.geometry.boxes[rt_random_below(&random, scene.geometry.object_count)];
            rays[k] = shadow_ray(&scene, rt_box_center(*box), k % scene.light_count);
        }
        answer(accel, rays, expected, &by_best);
        const RtKernels *best = accel->kernels;
        for (RtIsa isa = RT_ISA_PORTABLE; isa <= RT_ISA_AVX512; isa++) {
            if (!rt_isa_runs(isa)) continue;
            accel->kernels = RT_KERNELS_FOR(light, isa);
            answer(accel, rays, blocked, &tally);
            assert_memory_equal(blocked, expected, sizeof blocked);
            assert_memory_equal(&tally, &by_best, sizeof tally);
        }
        accel->kernels = best;
    }
}

/* ---- lists and covers ---- */

/* A list of the face that looks down, -z, from the first light. */
typedef struct List {
    const RtLightEntry *at;
    uint32_t count;
    bool cut;
} List;

static List list_at(const RtLightBuffer *buffer, uint32_t column, uint32_t row) {
    const RtLightGrid *grid = &buffer->cubes[0].grids[4];
    const uint32_t cell = row * grid->columns + column;
    List list = {grid->entries + grid->first[cell], grid->first[cell + 1] - grid->first[cell], false};
    list.cut = list.count > 0 && list.at[list.count - 1].object == RT_LIGHT_BEYOND;
    return list;
}

RT_TEST(full_occlusion_ends_lists_at_what_covers_a_cell) {
    OWNED_SCENE scene = make_screen();
    OWNED_ACCEL RtLightBuffer *cut = open_valid(&scene, "light:cells=16+brute");
    OWNED_ACCEL RtLightBuffer *whole = open_valid(&scene, "light:cells=16,full_occlusion=off+brute");
    /* The middle of the face is under the sphere, the cell at u = w = 0.7 beside it, over the
     * screen. */
    List middle = list_at(cut, 8, 8), all = list_at(whole, 8, 8), beside = list_at(cut, 13, 13);
    assert_int_equal(all.count, 3);
    assert_false(all.cut);
    assert_int_equal(middle.count, 2);
    assert_true(middle.cut);
    assert_int_equal(middle.at[0].object, scene.geometry.objects[1]);
    assert_true(middle.at[1].depth >= 3 && middle.at[1].depth < 3.01f); /* it ends there */
    assert_int_equal(beside.count, 1); /* nothing is behind the screen there */
    assert_int_equal(beside.at[0].object, scene.geometry.objects[0]);
    assert_false(beside.cut);
    /* Where the screen ends nothing is seen: its rim is at u = 0.8. */
    for (uint32_t i = 0; i < 16; i++) assert_int_equal(list_at(cut, i, 15).count, 0);
}

RT_TEST(a_list_is_cut_where_it_would_be_too_long) {
    OWNED_SCENE scene = make_screen();
    OWNED_ACCEL RtLightBuffer *buffer =
        open_valid(&scene, "light:cells=16,full_occlusion=off,longest=2+brute");
    List list = list_at(buffer, 8, 8);
    assert_int_equal(list.count, 3);
    assert_true(list.cut);
    assert_true(list.at[2].depth > 8.9f); /* of the sphere that is missing */
}

RT_TEST(nothing_is_cut_behind_the_notch_of_a_concave_polygon) {
    /* A square with a notch down to its middle, and one behind it. */
    const RtVec3 notched[5] = {{{-8, -8, 5}}, {{8, -8, 5}}, {{8, 8, 5}}, {{0, 0, 5}}, {{-8, 8, 5}}};
    const RtVec3 behind[4] = {{{-8, -8, 0}}, {{8, -8, 0}}, {{8, 8, 0}}, {{-8, 8, 0}}};
    OWNED_SCENE scene = begin_scene();
    assert_ok(rt_scene_add_polygon(&scene, 0, notched, 5, error));
    assert_ok(rt_scene_add_polygon(&scene, 0, behind, 4, error));
    assert_ok(rt_scene_add_light(&scene, rt_vec3(0, 0, 10), rt_vec3(1, 1, 1), error));
    assert_ok(rt_scene_finish(&scene, error));
    OWNED_ACCEL RtLightBuffer *buffer = open_accel(&scene, "light:cells=16+brute");
    List notch = list_at(buffer, 8, 12);
    assert_false(notch.cut);
    assert_int_equal(notch.at[notch.count - 1].object, scene.geometry.objects[1]);
}

/* ---- the size of the bounds ----
 *
 * What is off a cell by 31/32 of the bound on its place is in the cell's list, so the test fails with 15/16.
 */

/* A polygon by its rectangle, and one by the line through its edge. */
typedef enum Beside { RECTANGLE, DIAGONAL, BESIDE_COUNT } Beside;

/* A screen at depth 5 from the light, and an object in its plane if `v` is not NULL. */
static RtScene make_floor(const RtVec3 v[4], Beside beside) {
    const RtVec3 square[4] = {{{-4, -4, 5}}, {{4, -4, 5}}, {{4, 4, 5}}, {{-4, 4, 5}}};
    RtScene scene = begin_scene();
    assert_ok(rt_scene_add_polygon(&scene, 0, square, 4, error));
    if (v) assert_ok(rt_scene_add_polygon(&scene, 0, v, beside == DIAGONAL ? 3 : 4, error));
    assert_ok(rt_scene_add_light(&scene, rt_vec3(0, 0, 10), rt_vec3(1, 1, 1), error));
    assert_ok(rt_scene_finish(&scene, error));
    return scene;
}

/* The most that an object at depth 5, near the middle, may be off a cell that lists it, in u
 * (light_project.c). */
static double bound_beside(Beside beside, double margin) {
    return 0x1p-20 + (beside == DIAGONAL ? 4 : 1) * margin / 5;
}

/* Whether the cell to the left of a border near the middle, and below one, lists an object beyond these. */
static bool is_listed_beside(const char *spec, Beside beside, double part) {
    OWNED_SCENE empty = make_floor(NULL, beside);
    OWNED_ACCEL RtLightBuffer *first = open_accel(&empty, spec);
    const RtLightGrid *grid = &first->cubes[0].grids[4];
    const double cell = 1 / (double)grid->scale;
    const uint32_t column = (uint32_t)(-(double)grid->u / cell), row = (uint32_t)(-(double)grid->w / cell);
    const double off = part * bound_beside(beside, first->cubes[0].margin);
    const double u = (double)grid->u + column * cell + off, w = (double)grid->w + row * cell;
    double at[4][2] = {
        {u, w - 0.8 * cell}, {u, w - 0.2 * cell}, {u + 0.5, w - 0.2 * cell}, {u + 0.5, w - 0.8 * cell}};
    if (beside == DIAGONAL) {
        at[0][0] = u + 0.5, at[0][1] = w + off - 0.5;
        at[1][0] = u - 0.5, at[1][1] = w + off + 0.5;
        at[2][0] = at[2][1] = 0.7;
    }
    RtVec3 v[4];
    for (int i = 0; i < 4; i++) v[i] = rt_vec3((float)(5 * at[i][0]), (float)(5 * at[i][1]), 5);
    OWNED_SCENE scene = make_floor(v, beside);
    OWNED_ACCEL RtLightBuffer *buffer = open_accel(&scene, spec);
    assert_memory_equal(&buffer->cubes[0].grids[4], grid, offsetof(RtLightGrid, first));
    List list = list_at(buffer, column - 1, row - 1);
    bool listed = false;
    for (uint32_t i = 0; i < list.count; i++) listed |= list.at[i].object == scene.geometry.objects[1];
    return listed;
}

RT_TEST(objects_beside_a_cell_are_listed_within_the_bound) {
    static const char *const specs[] = {"light:cells=16,full_occlusion=off+brute",
                                        "light:cells=2048,full_occlusion=off+brute"};
    for (Beside beside = 0; beside < BESIDE_COUNT; beside++) {
        for (int i = 0; i < 2; i++) {
            if (!is_listed_beside(specs[i], beside, 31.0 / 32))
                fail_msg("sort %d: %s: within", (int)beside, specs[i]);
            if (is_listed_beside(specs[i], beside, 33.0 / 32))
                fail_msg("sort %d: %s: beyond", (int)beside, specs[i]);
        }
    }
}

/* ---- limits and invariants ---- */

static unsigned number_that_fits(const RtError *error) {
    const char *cells = strstr(error->message, ": try cells=");
    assert_non_null(cells);
    return (unsigned)strtoul(cells + strlen(": try cells="), NULL, 10);
}

RT_TEST(too_many_cells_are_refused_with_a_number_that_fits) {
    OWNED_SCENE scene = make_awkward(0);
    RtAccel *accel;
    RtError error = {RT_OK, ""};
    assert_int_equal(rt_accel_open("light:cells=4096+bvh", &scene, &accel, &error), RT_BAD_INPUT);
    /* 8 lights x 6 faces x 20 bytes a cell in 4 GiB: 2115 if all faces saw the scene all over, less than a
     * tile more. */
    assert_in_range(number_that_fits(&error), 2080, 4095);
}

RT_TEST(each_broken_invariant_is_named) {
    OWNED_SCENE scene = make_awkward(0);
    OWNED_ACCEL RtAccel *accel = open_valid(&scene, "light:cells=64,full_occlusion=off+brute");
    RtLightGrid *grid = &((RtLightBuffer *)accel)->cubes[4].grids[4];
    uint32_t cell = 0; /* of two objects or more, the second of which is deeper */
    while (grid->first[cell + 1] - grid->first[cell] < 2 ||
           grid->entries[grid->first[cell]].depth == grid->entries[grid->first[cell] + 1].depth)
        cell++;
    RtLightEntry *list = &grid->entries[grid->first[cell]], kept = list[0];
    list[0] = list[1];
    list[1] = kept;
    assert_broken(accel, "is not in order");
    list[1] = list[0];
    assert_broken(accel, "lacks object");
    list[0] = kept;
    assert_broken_by(accel, list[0].depth, list[1].depth, "lacks object");
    assert_broken_by(accel, list[0].depth, -1, "is not in order");
    assert_broken_by(accel, list[0].object, RT_LIGHT_BEYOND, "is not in order");
    assert_broken_by(accel, grid->first[cell + 1], grid->first[cell] - 1, "ends before it begins");
}

/* An entry is spoilt in each corner of a screen. */
RT_TEST(validate_looks_at_all_cells_of_an_object) {
    static const uint32_t places[2] = {4, 59};
    OWNED_SCENE scene = make_floor(NULL, RECTANGLE);
    OWNED_ACCEL RtLightBuffer *buffer = open_valid(&scene, "light:cells=64+brute");
    for (int i = 0; i < 4; i++) {
        List list = list_at(buffer, places[i & 1], places[i >> 1]);
        assert_int_equal(list.count, 1);
        RtLightGrid *grid = &buffer->cubes[0].grids[4];
        RtLightEntry *entry = &grid->entries[list.at - grid->entries];
        assert_broken_by(&buffer->base, entry->depth, 6, "lacks object");
    }
}

RT_TESTS(light, NULL, assert_nothing_is_kept)
