/* SPDX-License-Identifier: Apache-2.0 */
/* scene/transform: steps in order, exact quarter turns, normals, uniform scale. */
#include "testing.h"

#include "core/base/transform.h"

static void assert_point(RtVec3 p, float x, float y, float z) {
    if (p.x == x && p.y == y && p.z == z) return;
    fail_msg("(%.9g, %.9g, %.9g) instead of (%g, %g, %g)", (double)p.x, (double)p.y, (double)p.z, (double)x,
             (double)y, (double)z);
}

RT_TEST(steps_are_applied_in_the_order_they_are_made) {
    RtTransform t = rt_transform_identity();
    assert_ok(rt_transform_scale(&t, rt_vec3(2, 2, 2), error));
    assert_ok(rt_transform_translate(&t, rt_vec3(10, 0, 0), error));
    assert_point(rt_transform_point(&t, rt_vec3(1, 0, 0)), 12, 0, 0);
    assert_ok(rt_transform_rotate(&t, rt_vec3(0, 0, 7), 90, error));
    assert_point(rt_transform_point(&t, rt_vec3(1, 0, 0)), 0, 12, 0);
}

RT_TEST(quarter_turns_are_exact_and_follow_the_right_hand) {
    const RtVec3 axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int a = 0; a < 3; a++) {
        RtTransform t = rt_transform_identity();
        RtVec3 next = axes[(a + 1) % 3], after = axes[(a + 2) % 3];
        assert_ok(rt_transform_rotate(&t, axes[a], 90 + 360 * 5, error));
        assert_point(rt_transform_point(&t, next), after.x, after.y, after.z);
        assert_ok(rt_transform_rotate(&t, axes[a], -180, error));
        assert_point(rt_transform_point(&t, next), -after.x, -after.y, -after.z);
    }
}

RT_TEST(a_rotation_keeps_lengths_and_a_squeeze_does_not) {
    RtTransform t = rt_transform_identity();
    assert_ok(rt_transform_rotate(&t, rt_vec3(1, 2, 3), 37.5, error));
    assert_ok(rt_transform_scale(&t, rt_vec3(3, 3, 3), error));
    double scale = rt_transform_uniform_scale(&t);
    assert_true(fabs(scale - 3) < 1e-12);
    assert_ok(rt_transform_scale(&t, rt_vec3(1, 1, 2), error));
    assert_true(rt_transform_uniform_scale(&t) == 0);
}

RT_TEST(a_normal_stays_across_its_squeezed_plane) {
    RtTransform t = rt_transform_identity();
    assert_ok(rt_transform_scale(&t, rt_vec3(4, 1, 1), error));
    RtVec3 normal = rt_transform_normal(&t, rt_vec3(1, 1, 0));
    RtVec3 along =
        rt_sub(rt_transform_point(&t, rt_vec3(1, -1, 0)), rt_transform_point(&t, rt_vec3(0, 0, 0)));
    assert_true(fabsf(rt_dot(normal, along)) < 1e-6f);
    assert_true(normal.x > 0 && normal.y > 0);
}

RT_TEST(a_normal_that_points_out_points_out_of_a_mirror_image) {
    RtTransform t = rt_transform_identity();
    assert_false(rt_transform_mirrors(&t));
    t.m[0][0] = -1;
    assert_true(rt_transform_mirrors(&t));
    const RtVec3d normal = rt_transform_normald(&t, rt_vec3d(1, 2, 3));
    assert_true(normal.x == -1 && normal.y == 2 && normal.z == 3);
}

RT_TEST(steps_that_make_no_sense_are_refused) {
    RtTransform t = rt_transform_identity();
    assert_bad_input(rt_transform_scale(&t, rt_vec3(1, 0, 1), error), "above 0");
    assert_bad_input(rt_transform_scale(&t, rt_vec3(1, -1, 1), error), "above 0");
    assert_bad_input(rt_transform_rotate(&t, rt_vec3(0, 0, 0), 10, error), "length 0");
    assert_bad_input(rt_transform_rotate(&t, rt_vec3(0, 0, 1), (double)NAN, error), "not finite");
    assert_bad_input(rt_transform_translate(&t, rt_vec3(INFINITY, 0, 0), error), "not finite");
    assert_point(rt_transform_point(&t, rt_vec3(1, 2, 3)), 1, 2, 3);
}

RT_TESTS(transform, NULL, NULL)
