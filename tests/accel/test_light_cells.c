/* SPDX-License-Identifier: Apache-2.0 */
/* The cells of the light buffer: their lists, what covers them, how many fit, and invariants broken. */
#include "light_testing.h"

#include <stdlib.h>
#include <string.h>

/* ---- lists and covers ---- */

static const RtLightBuffer *open_buffer(const char *spec, const RtScene *scene, RtAccel **accel) {
    assert_ok(rt_accel_open(spec, scene, accel, error));
    return (const RtLightBuffer *)*accel;
}

/* A cell of the face that looks down, -z, from the first light. */
static size_t cell_at(const RtLightBuffer *buffer, uint32_t column, uint32_t row) {
    return rt_light_face(buffer, 0, 4) + (size_t)row * buffer->n + column;
}

RT_TEST(full_occlusion_ends_lists_at_what_covers_a_cell) {
    RtScene scene;
    RtAccel *on, *off;
    make_screen(&scene);
    const RtLightBuffer *cut = open_buffer("light:cells=16+brute", &scene, &on);
    const RtLightBuffer *whole = open_buffer("light:cells=16,full_occlusion=off+brute", &scene, &off);
    /* The middle of the face is under the sphere, the cell at u = w = 0.6 beside it, over the
     * screen. */
    size_t middle = cell_at(cut, 8, 8), beside = cell_at(cut, 12, 12);
    assert_null(whole->covers);
    assert_int_equal(whole->first[middle + 1] - whole->first[middle], 3);
    assert_int_equal(cut->covers[middle].id, 1);
    assert_int_equal(cut->covers[beside].id, 0);
    assert_int_equal(cut->first[middle + 1] - cut->first[middle], 1);
    assert_true(cut->covers[middle].depth >= 3 && cut->covers[middle].depth < 3.01f);
    assert_true(cut->covers[beside].depth >= 5 && cut->covers[beside].depth < 5.01f);
    /* Where the screen ends nothing is covered: its rim is at u = 0.8. */
    for (uint32_t i = 0; i < 16; i++) {
        assert_int_equal(cut->covers[cell_at(cut, i, 15)].id, RT_NO_OBJECT);
    }
    assert_ok(rt_accel_validate(on, error));
    assert_ok(rt_accel_validate(off, error));
    rt_accel_destroy(on);
    rt_accel_destroy(off);
    rt_scene_clear(&scene);
}

RT_TEST(a_concave_polygon_covers_no_cell_of_its_notch) {
    /* A square with a notch down to its middle. */
    const RtVec3 notched[5] = {{{-8, -8, 5}}, {{8, -8, 5}}, {{8, 8, 5}}, {{0, 0, 5}}, {{-8, 8, 5}}};
    RtScene scene;
    RtAccel *accel;
    begin_scene(&scene);
    assert_ok(rt_scene_add_polygon(&scene, 0, notched, 5, error));
    assert_ok(rt_scene_add_light(&scene, rt_vec3(0, 0, 10), rt_vec3(1, 1, 1), error));
    assert_ok(rt_scene_finish(&scene, error));
    const RtLightBuffer *buffer = open_buffer("light:cells=16+brute", &scene, &accel);
    assert_int_equal(buffer->covers[cell_at(buffer, 8, 2)].id, 0);
    assert_int_equal(buffer->covers[cell_at(buffer, 8, 12)].id, RT_NO_OBJECT);
    rt_accel_destroy(accel);
    rt_scene_clear(&scene);
}

/* ---- limits and invariants ---- */

static unsigned number_that_fits(const RtError *error) {
    const char *cells = strstr(error->message, ": cells=");
    assert_non_null(cells);
    return (unsigned)strtoul(cells + strlen(": cells="), NULL, 10);
}

RT_TEST(too_many_cells_are_refused_with_a_number_that_fits) {
    RtScene scene;
    RtAccel *accel;
    RtError error = {RT_OK, ""};
    make_awkward(&scene, 0);
    assert_int_equal(rt_accel_open("light:cells=4096+bvh", &scene, &accel, &error), RT_BAD_INPUT);
    /* 8 lights x 6 faces x 20 bytes a cell in 4 GiB, without any list: 2115. What a cell remembers counts. */
    unsigned fits = number_that_fits(&error);
    assert_in_range(fits, 1000, 2115);
    assert_int_equal(rt_accel_open("light:cells=4096,cache=off+bvh", &scene, &accel, &error), RT_BAD_INPUT);
    assert_in_range(number_that_fits(&error), fits + 1, 2730);
    rt_scene_clear(&scene);
}

RT_TEST(each_broken_invariant_is_named) {
    RtScene scene;
    RtAccel *accel;
    make_awkward(&scene, 0);
    assert_ok(rt_accel_open("light:cells=8+brute", &scene, &accel, error));
    RtLightBuffer *buffer = (RtLightBuffer *)accel;
    assert_ok(rt_accel_validate(accel, error));

    size_t cell = 0;
    while (buffer->first[cell + 1] - buffer->first[cell] < 2) cell++;
    RtLightEntry *list = &buffer->entries[buffer->first[cell]], kept = list[0];
    list[0] = list[1];
    list[1] = kept;
    assert_broken(accel, "lacks object");
    list[1] = list[0];
    list[0] = kept;
    list[0].depth += 1;
    assert_broken(accel, "lacks object");
    list[0] = kept;

    buffer->first[cell + 1] -= 1;
    assert_broken(accel, "lacks object");
    buffer->first[cell + 1] += 1;
    uint32_t end = buffer->first[cell + 1];
    buffer->first[cell + 1] = 0;
    buffer->first[cell] = 1;
    assert_broken(accel, "ends before it begins");
    buffer->first[cell + 1] = end;
    buffer->first[cell] = (uint32_t)(list - buffer->entries);

    size_t covered = 0;
    while (buffer->covers[covered].id == RT_NO_OBJECT) covered++;
    RtLightCover cover = buffer->covers[covered];
    buffer->covers[covered].depth /= 2;
    assert_broken(accel, "is not covered");
    buffer->covers[covered].id ^= 1;
    assert_broken(accel, "is not covered");
    buffer->covers[covered] = cover;

    assert_true(buffer->near_first[1] > 0); /* the first light is inside a sphere */
    buffer->near[0] ^= 1;
    assert_broken(accel, "near list");
    buffer->near[0] ^= 1;
    buffer->near_first[1] += 1; /* one more for the first light, one fewer for the second */
    assert_broken(accel, "near list of light 0");
    buffer->near_first[1] -= 2;
    assert_broken(accel, "near list of light 0");
    buffer->near_first[1] += 1;
    assert_ok(rt_accel_validate(accel, error));
    rt_accel_destroy(accel);
    rt_scene_clear(&scene);
}

RT_TESTS(light_cells, NULL, assert_nothing_is_kept)
