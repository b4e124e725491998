/* SPDX-License-Identifier: Apache-2.0 */
/* The cells of the light buffer: their lists, what covers them, how many fit, and invariants broken. */
#include "light_testing.h"

#include <stdlib.h>

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
        assert_broken_by(&buffer->isa.base, entry->depth, 6, "lacks object");
    }
}

RT_TESTS(light_cells, NULL, assert_nothing_is_kept)
