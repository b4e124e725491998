/* SPDX-License-Identifier: Apache-2.0 */
/* End-point overlap and leaf-count variability of hierarchies small enough to compute them by hand. */
#include "accel_testing.h"

/* Three standard errors of 4096 points and 8192 lines. */
static const double CLOSE = 0.03;

/* A triangle whose box is a unit cube from x on: the part of it below x + 1/2 is a quarter. */
static void add_triangle(RtScene *scene, float x) {
    const RtVec3 vertices[3] = {{x, 0, 0}, {x + 1, 1, 0}, {x + 1, 0, 1}};
    assert_ok(rt_scene_add_triangle(scene, 0, vertices, NULL, error));
}

/* Two of them. */
static RtScene make_pair(float x0, float x1) {
    RtScene scene = begin_scene();
    add_triangle(&scene, x0);
    add_triangle(&scene, x1);
    assert_ok(rt_scene_finish(&scene, error));
    return scene;
}

static const char *const specs[] = {"bvh:max_leaf_size=1", "clusters:method=ploc", "wide:max_leaf_size=1"};

RT_TEST(overlap_is_the_cost_of_leaves_that_hold_a_point_of_another_object) {
    static const struct {
        float at;
        double overlap;
    } rows[] = {{5, 0}, {0, 1}, {0.5f, 0.5 * 0.75 + 0.5 * 0.25}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        OWNED_SCENE scene = make_pair(0, rows[i].at);
        for (size_t s = 0; s < sizeof specs / sizeof specs[0]; s++) {
            double overlap = describe_spec(&scene, specs[s]).end_point_overlap;
            assert_true(fabs(overlap - rows[i].overlap) < (i == 2 ? CLOSE : 1e-9));
        }
        assert_true(describe_spec(&scene, "wide").end_point_overlap < 1e-9 || rows[i].at > 0);
    }
}

/* Of four in one place, halved twice, a point is in one inner node that is not above its object, and in three
 * leaves. */
RT_TEST(an_inner_node_overlaps_at_its_own_cost) {
    OWNED_SCENE scene = begin_scene();
    for (int i = 0; i < 4; i++) add_triangle(&scene, 0);
    assert_ok(rt_scene_finish(&scene, error));
    double overlap = describe_spec(&scene, "bvh:max_leaf_size=1,traversal_cost=7").end_point_overlap;
    assert_true(fabs(overlap - (7 + 3)) < 1e-9);
    rt_scene_clear(&scene);

    scene = begin_scene(); /* the last one is a speck, whose leaf hardly any point is in */
    for (int i = 0; i < 3; i++) add_triangle(&scene, 0);
    const float lo = 0.5f - 0x1p-20f, hi = 0.5f + 0x1p-20f;
    const RtVec3 speck[3] = {{lo, lo, lo}, {hi, hi, lo}, {hi, lo, hi}};
    assert_ok(rt_scene_add_triangle(&scene, 0, speck, NULL, error));
    assert_ok(rt_scene_finish(&scene, error));
    overlap = describe_spec(&scene, "bvh:max_leaf_size=1,traversal_cost=7").end_point_overlap;
    assert_true(fabs(overlap - (7 + 2)) < CLOSE);
}

/* Two cubes side by side: of the lines that meet their box, 3/5 meet each and 1/5 both, so that a line meets
 * 6/5 of them on average, and the variance is 4/5 + 4 * 1/5 - 36/25. */
RT_TEST(leaves_met_vary_as_the_areas_of_two_cubes_say) {
    OWNED_SCENE scene = make_pair(0, 1);
    for (size_t s = 0; s < sizeof specs / sizeof specs[0]; s++)
        assert_true(fabs(describe_spec(&scene, specs[s]).leaf_count_variability - 0.4) < CLOSE);
    assert_true(describe_spec(&scene, "bvh:max_leaf_size=8,traversal_cost=100").leaf_count_variability <
                1e-9);
}

RT_TEST(what_is_no_triangle_has_no_overlap_and_what_is_no_hierarchy_no_quality) {
    OWNED_SCENE scene = make_row(2, 9);
    RtDescription description = describe_spec(&scene, "bvh:max_leaf_size=1");
    assert_true(isnan(description.end_point_overlap));
    assert_true(description.leaf_count_variability > 0);
    const char *others[] = {"brute", "grid", "kd", "octree", "extents"};
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++) {
        description = describe_spec(&scene, others[i]);
        assert_true(isnan(description.end_point_overlap));
        assert_true(isnan(description.leaf_count_variability));
    }
}

/* The leaf of a part contains the points of that part. */
RT_TEST(parts_of_split_objects_are_distinguished) {
    OWNED_SCENE scene = make_pair(0, 0);
    const char *spec = "bvh:build=spatial,max_leaf_size=1,budget=4,alpha=0";
    RtDescription description = describe_spec(&scene, spec);
    assert_true(isfinite(description.end_point_overlap));
    assert_true(isfinite(description.leaf_count_variability));
}

RT_TESTS(quality, NULL, NULL)
