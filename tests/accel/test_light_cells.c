/* SPDX-License-Identifier: Apache-2.0 */
/* The cells of the light buffer: their lists, what covers them, how many fit, and invariants broken. */
#include "light_testing.h"

#include <stdlib.h>

/* ---- lists and covers ---- */

/* A list of the face that looks down, -z, from the first light; its tiles have the same resolution. */
typedef struct List {
    const RtLightEntry *at;
    uint32_t count;
    bool cut;
} List;

static List list_at(const RtLightBuffer *buffer, uint32_t column, uint32_t row) {
    const RtLightCube *cube = &buffer->cubes[0];
    const RtLightGrid *grid = &cube->grids[4];
    uint32_t n = grid->max_resolution,
             tile = cube->tiles[grid->first_tile + row / n * grid->columns + column / n];
    assert_int_equal(rt_light_resolution(tile), n);
    uint32_t cell = grid->first_cell + rt_light_first_cell(tile) + row % n * n + column % n;
    List list = {cube->entries + cube->first[cell], cube->first[cell + 1] - cube->first[cell], false};
    list.cut = list.count > 0 && list.at[list.count - 1].object == RT_LIGHT_BEYOND;
    return list;
}

static float depth_of(const RtLightBuffer *buffer, const RtLightEntry *entry) {
    const RtLightGrid *grid = &buffer->cubes[0].grids[4];
    return grid->depth + (float)(entry->key >> 16) / grid->depth_scale;
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
    assert_true(depth_of(cut, &middle.at[1]) >= 2 && depth_of(cut, &middle.at[1]) < 2.01f);
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
    assert_true(depth_of(buffer, &list.at[2]) > 8.9f); /* of the sphere that is missing */
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

/* A slanted edge: what is beyond it in the cell is told from the cell's parts. */
RT_TEST(a_key_says_which_parts_of_the_cell_an_object_is_seen_in) {
    const RtVec3 corner[3] = {{{-5, -5, 5}}, {{5, -5, 5}}, {{-5, 5, 5}}};
    OWNED_SCENE scene = begin_scene();
    assert_ok(rt_scene_add_triangle(&scene, 0, corner, NULL, error));
    assert_ok(rt_scene_add_light(&scene, rt_vec3(0, 0, 10), rt_vec3(1, 1, 1), error));
    assert_ok(rt_scene_finish(&scene, error));
    OWNED_ACCEL RtLightBuffer *buffer = open_accel(&scene, "light:cells=1+brute");
    List list = list_at(buffer, 0, 0);
    assert_int_equal(list.count, 1);
    assert_int_equal(list.at[0].key & RT_LIGHT_PARTS, 0x37ff); /* on the diagonal, and up to it */
}

/* ---- the size of the bounds ----
 *
 * What is off a cell by 31/32 of the bound on its place is in the cell's list, so the test fails with 15/16.
 */

/* A triangle in lanes, a polygon by its rectangle, and a polygon by the line through its edge. */
typedef enum Beside { TRIANGLE, RECTANGLE, DIAGONAL, BESIDE_COUNT } Beside;

/* A screen at depth 5 from the light, and an object in its plane if `v` is not NULL. */
static RtScene make_floor(const RtVec3 v[4], Beside beside) {
    const RtVec3 square[4] = {{{-4, -4, 5}}, {{4, -4, 5}}, {{4, 4, 5}}, {{-4, 4, 5}}};
    RtScene scene = begin_scene();
    assert_ok(rt_scene_add_polygon(&scene, 0, square, 4, error));
    if (v && beside == TRIANGLE) assert_ok(rt_scene_add_triangle(&scene, 0, v, NULL, error));
    if (v && beside != TRIANGLE)
        assert_ok(rt_scene_add_polygon(&scene, 0, v, beside == DIAGONAL ? 3 : 4, error));
    assert_ok(rt_scene_add_light(&scene, rt_vec3(0, 0, 10), rt_vec3(1, 1, 1), error));
    assert_ok(rt_scene_finish(&scene, error));
    return scene;
}

/* The most that an object at depth 5, near the middle, may be off a cell of width `cell` that lists it, in u
 * (light_project.h, light_footprint.c). */
static double bound_beside(Beside beside, double margin, double cell) {
    if (beside == TRIANGLE) return 0x1p-18 + 4 * 1.25 * margin / 5 + 0x1p-6 * cell;
    return 0x1p-20 + (beside == DIAGONAL ? 4 : 1) * margin / 5 + 0x1p-6 * cell;
}

/* Whether the cell to the left of a border near the middle, and below one, lists an object beyond these. */
static bool is_listed_beside(const char *spec, Beside beside, double part) {
    OWNED_SCENE empty = make_floor(NULL, beside);
    OWNED_ACCEL RtLightBuffer *first = open_accel(&empty, spec);
    const RtLightGrid *grid = &first->cubes[0].grids[4];
    const double cell = 1 / ((double)grid->scale * grid->max_resolution);
    const uint32_t column = (uint32_t)(-(double)grid->u / cell), row = (uint32_t)(-(double)grid->w / cell);
    const double off = part * bound_beside(beside, first->cubes[0].margin, cell);
    const double u = (double)grid->u + column * cell + off, w = (double)grid->w + row * cell;
    double at[4][2] = {{u, w - 0.8 * cell}, {u, w - 0.2 * cell}, {u + cell, w - 0.5 * cell}};
    if (beside == RECTANGLE) at[2][0] = at[3][0] = u + 0.5, at[2][1] = at[1][1], at[3][1] = at[0][1];
    if (beside == DIAGONAL) {
        at[0][0] = u + 0.5, at[0][1] = w + off - 0.5;
        at[1][0] = u - 0.5, at[1][1] = w + off + 0.5;
        at[2][0] = at[2][1] = 0.7;
    }
    RtVec3 v[4];
    for (int i = 0; i < 4; i++) v[i] = rt_vec3((float)(5 * at[i][0]), (float)(5 * at[i][1]), 5);
    OWNED_SCENE scene = make_floor(v, beside);
    OWNED_ACCEL RtLightBuffer *buffer = open_accel(&scene, spec);
    assert_memory_equal(&buffer->cubes[0].grids[4], grid, offsetof(RtLightGrid, first_tile));
    List list = list_at(buffer, column - 1, row - 1);
    bool listed = false;
    for (uint32_t i = 0; i < list.count; i++) listed |= list.at[i].object == scene.geometry.objects[1];
    return listed;
}

/* By large cells, of which 2^-6 is most of the bound, and by small ones, for which the margin is. */
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

/* As if there were `more` cells before the first one, of which nothing is ever asked. */
static void number_cells_from(RtLightCube *cube, uint32_t more) {
    uint32_t *first = rt_alloc_unset((size_t)more + cube->cell_count + 1, sizeof *first);
    assert_non_null(first);
    memcpy(first + more, cube->first, ((size_t)cube->cell_count + 1) * sizeof *first);
    rt_free(cube->first);
    cube->first = first;
    cube->cell_count += more;
    for (int face = 0; face < 6; face++) cube->grids[face].first_cell += more;
}

RT_TEST(cells_behind_the_first_67_million_are_found) {
    enum { RAYS = 500 };
    RtCellView cells[RAYS], cell;
    RtRay rays[RAYS];
    bool blocked[RAYS], again[RAYS];
    uint32_t more = UINT32_C(1) << 26, found = 0;
    RtRandom random = rt_random(3, 0);
    OWNED_SCENE scene = make_awkward(0);
    OWNED_ACCEL RtAccel *accel = open_accel(&scene, "light:cells=64+brute");
    for (uint32_t i = 0; i < RAYS; i++) {
        rays[i] = shadow_ray(&scene, random_point(&random, 5), 0);
        cells[i].number = 0;
        found += rt_light_find_cell(accel, &rays[i], &cells[i]) && cells[i].length > 0;
    }
    assert_true(found > RAYS / 2);
    OWNED_QUERY query = open_query(accel);
    RtTally before[RT_RAY_KIND_COUNT] = {{0}}, after[RT_RAY_KIND_COUNT] = {{0}};
    rt_occluded(&query, rays, RAYS, blocked, before);
    number_cells_from(&((RtLightBuffer *)accel)->cubes[0], more);
    rt_occluded(&query, rays, RAYS, again, after);
    assert_memory_equal(blocked, again, sizeof blocked);
    assert_memory_equal(before, after, sizeof before);
    for (uint32_t i = 0; i < RAYS; i++) {
        if (!rt_light_find_cell(accel, &rays[i], &cell)) continue;
        assert_int_equal(cell.number, cells[i].number + more);
        assert_int_equal(cell.object, cells[i].object);
    }
}

static unsigned number_that_fits(const RtError *error) {
    const char *cells = strstr(error->message, ": cells=");
    assert_non_null(cells);
    return (unsigned)strtoul(cells + strlen(": cells="), NULL, 10);
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

static bool starts_with_a_triangle(const RtLightCube *cube, uint32_t cell) {
    const RtLightEntry *list = &cube->entries[cube->first[cell]];
    if (cube->first[cell + 1] - cube->first[cell] < 2 || list[0].key >> 16 == list[1].key >> 16) return false;
    return rt_ref_shape(list[0].object) == RT_SHAPE_TRIANGLE &&
           __builtin_popcount(list[0].key & RT_LIGHT_PARTS) > 8;
}

RT_TEST(each_broken_invariant_is_named) {
    OWNED_SCENE scene = make_awkward(0);
    OWNED_ACCEL RtAccel *accel = open_valid(&scene, "light:cells=64,full_occlusion=off+brute");
    RtLightBuffer *buffer = (RtLightBuffer *)accel;
    RtLightCube *cube = &buffer->cubes[4], *first = &buffer->cubes[0];
    uint32_t cell = 0; /* with a triangle in most of it, and something deeper */
    while (!starts_with_a_triangle(cube, cell)) cell++;
    RtLightEntry *list = &cube->entries[cube->first[cell]], kept = list[0];
    list[0] = list[1];
    list[1] = kept;
    assert_broken(accel, "is not in order");
    list[1] = list[0];
    assert_broken(accel, "lacks object");
    list[0] = kept;
    assert_broken_by(accel, list[0].key, list[1].key, "lacks object");
    assert_broken_by(accel, list[0].key, list[0].key & ~RT_LIGHT_PARTS, "lacks object");
    assert_broken_by(accel, list[0].object, RT_LIGHT_BEYOND, "is not in order");
    assert_broken_by(accel, cube->first[cell + 1], cube->first[cell] - 1, "ends before it begins");

    assert_true(first->near_count > 0); /* the first light is inside a sphere */
    assert_broken_by(accel, first->near[0], first->near[0] ^ 1, "near list of light 0");
    assert_broken_by(accel, first->near_count, first->near_count - 1, "near list of light 0");
}

/* A screen over 2 x 2 tiles: an entry is spoilt in each. */
RT_TEST(validate_looks_at_all_tiles_of_an_object) {
    static const uint32_t places[2] = {4, 59};
    OWNED_SCENE scene = make_floor(NULL, TRIANGLE);
    OWNED_ACCEL RtLightBuffer *buffer = open_valid(&scene, "light:cells=64+brute");
    for (int i = 0; i < 4; i++) {
        List list = list_at(buffer, places[i & 1], places[i >> 1]);
        assert_int_equal(list.count, 1);
        RtLightEntry *entry = &buffer->cubes[0].entries[list.at - buffer->cubes[0].entries];
        assert_broken_by(&buffer->isa.base, entry->key, entry->key & ~RT_LIGHT_PARTS, "lacks object");
    }
}

RT_TESTS(light_cells, NULL, assert_nothing_is_kept)
