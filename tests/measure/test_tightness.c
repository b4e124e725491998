/* SPDX-License-Identifier: Apache-2.0 */
/* measure/extents_table.h: known ratios of projected areas are found, within their intervals. By Cauchy the
 * mean projected area of a convex body is a quarter of its surface; of a flat one half its area. */
#include "testing.h"

#include "measure/extents_table.h"

#define PI 3.14159265358979323846

/* Choices with slabs of every number. */
enum { BOX, SPHERE, OBB, SLABS_3, SLABS_13 = 13, CHOICES, LINES = 100000 };

/* Counts for one shape, or all of several, of `geometry`, which is finished here and cleared. */
static void count(RtGeometry *geometry, RtShape shape, RtTightness *out) {
    RtExtentsTable table;
    size_t i = 0;
    assert_ok(rt_geometry_finish(geometry, error));
    assert_ok(rt_extents_table(&table, &(RtScene){.geometry = *geometry}, true, LINES, 1, error));
    assert_int_equal(table.choice_count, CHOICES);
    while (table.shapes[i].shape != shape) assert_true(++i < table.shape_count);
    memcpy(out, table.shapes[i].tightness, CHOICES * sizeof *out);
    rt_geometry_clear(geometry);
}

/* Within the interval, which is narrow. */
static void assert_ratio(const RtTightness *found, double expected) {
    assert_int_equal(found->lines, LINES);
    if (!(found->low <= expected && expected <= found->high) || found->high > 1.05 * found->low) {
        fail_msg("%.4f in [%.4f, %.4f], not %.4f", found->ratio, found->low, found->high, expected);
    }
}

/* What misses its object does so by the pad of the extent test alone. */
static void assert_tight(const RtTightness *found) {
    assert_true(found->object_hits > LINES / 20 && found->ratio >= 1 && found->ratio < 1.0005);
}

static void add_sphere(RtGeometry *g, float x, float radius) {
    assert_ok(rt_geometry_add_sphere(g, rt_vec3(x, 0, 0), radius, error));
}

/* A square in a plane x = const., standing on a corner; its diagonals have the length 2 `half`. */
static void add_square(RtGeometry *g, float x, float half) {
    const RtVec3 v[4] = {{x, half, 0}, {x, 0, half}, {x, -half, 0}, {x, 0, -half}};
    assert_ok(rt_geometry_add_polygon(g, v, 4, error));
}

RT_TEST(a_box_about_a_sphere_has_six_over_pi_of_its_area) {
    RtGeometry g = {0};
    RtTightness found[CHOICES];
    add_sphere(&g, 5, 2);
    count(&g, RT_SHAPE_SPHERE, found);
    assert_ratio(&found[BOX], 6 / PI);
    assert_ratio(&found[OBB], 6 / PI);
    assert_ratio(&found[SLABS_3], 6 / PI);
    assert_tight(&found[SPHERE]);
    /* The scene is this box; a line that meets the sphere about it meets the box as the areas have it. */
    assert_true(fabs(found[BOX].met - 6 / (3 * PI)) < 0.01);
}

RT_TEST(more_slabs_are_never_looser) {
    RtGeometry g = {0};
    RtTightness found[CHOICES];
    const RtVec3 v[3] = {{0, 0, 0}, {1, 2, 3}, {-1, 1, 0.5f}};
    add_sphere(&g, 1, 1);
    assert_ok(rt_geometry_add_triangle(&g, v, NULL, error));
    assert_ok(rt_geometry_add_cone(&g, v[0], 1, v[1], 0.1f, error));
    count(&g, RT_SHAPE_COUNT, found);
    for (int c = SLABS_3; c < SLABS_13; c++) assert_true(found[c].extent_hits >= found[c + 1].extent_hits);
    assert_true(found[SLABS_3].extent_hits > found[SLABS_13].extent_hits);
    assert_true(found[SLABS_13].extent_hits > found[SLABS_13].object_hits);
    for (int c = 0; c < CHOICES; c++) assert_int_equal(found[c].object_hits, found[BOX].object_hits);
}

RT_TEST(extents_about_squares_and_a_triangle_are_as_calculated) {
    RtGeometry on_its_corner = {0}, along_the_axes = {0}, right = {0};
    RtTightness found[CHOICES];
    const RtVec3 square[4] = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}},
                 triangle[3] = {{0, 0, 1}, {3, 0, 1}, {0, 3, 1}};
    add_square(&on_its_corner, 3, 0.5f);
    count(&on_its_corner, RT_SHAPE_POLYGON, found);
    assert_ratio(&found[BOX], 2);
    assert_ratio(&found[SPHERE], PI);
    assert_tight(&found[OBB]);
    assert_tight(&found[SLABS_13]); /* its edges run along two of the plane sets */
    assert_ok(rt_geometry_add_polygon(&along_the_axes, square, 4, error));
    count(&along_the_axes, RT_SHAPE_POLYGON, found);
    assert_ratio(&found[SPHERE], PI); /* it sticks out of the box on four sides */
    assert_tight(&found[BOX]);
    assert_ok(rt_geometry_add_triangle(&right, triangle, NULL, error));
    count(&right, RT_SHAPE_TRIANGLE, found);
    assert_ratio(&found[BOX], 2);
    assert_ratio(&found[OBB], 2);
    assert_ratio(&found[SPHERE], 2 * PI);
}

/* The areas are added up before they are divided, however different the sizes. */
RT_TEST(many_objects_count_by_their_areas) {
    RtGeometry g = {0};
    RtTightness found[CHOICES];
    double sphere = 0, square = 0;
    for (int i = 0; i < 50; i++) {
        float size = i == 0 ? 4 : 0.1f * (float)(1 + i % 7);
        add_sphere(&g, (float)(10 * i), size);
        add_square(&g, (float)(10 * i + 5), 3 * size);
        sphere += PI * (double)(size * size);
        square += (double)(9 * size * size);
    }
    count(&g, RT_SHAPE_COUNT, found);
    assert_ratio(&found[BOX], (sphere * 6 / PI + square * 2) / (sphere + square));
    assert_ratio(&found[SPHERE], (sphere + square * PI) / (sphere + square));
}

RT_TEST(only_the_objects_of_the_shape_count) {
    RtGeometry g = {0};
    RtTightness found[CHOICES];
    add_square(&g, 0, 1);
    add_sphere(&g, 0, 1);
    add_square(&g, 1, 1);
    count(&g, RT_SHAPE_SPHERE, found);
    assert_ratio(&found[BOX], 6 / PI);
}

RT_TEST(an_object_that_is_never_met_has_no_tightness_but_a_bound) {
    RtGeometry g = {0};
    RtTightness found[CHOICES];
    const RtVec3 line[3] = {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}, point[3] = {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}};
    assert_ok(rt_geometry_add_triangle(&g, line, NULL, error));
    assert_ok(rt_geometry_add_triangle(&g, point, NULL, error));
    count(&g, RT_SHAPE_TRIANGLE, found);
    assert_int_equal(found[BOX].object_hits, 0);
    assert_true(isnan(found[BOX].ratio) && isinf(found[BOX].high) && found[BOX].low > 1000);
}

RT_TEST(the_same_seed_counts_the_same) {
    RtTightness found[2][CHOICES];
    for (int i = 0; i < 2; i++) {
        RtGeometry g = {0};
        add_sphere(&g, 0, 1);
        add_square(&g, 1, 2);
        count(&g, RT_SHAPE_COUNT, found[i]);
    }
    assert_memory_equal(found[0], found[1], sizeof found[0]);
}

RT_TESTS(tightness, NULL, NULL)
