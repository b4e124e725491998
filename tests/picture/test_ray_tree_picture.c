/* SPDX-License-Identifier: Apache-2.0 */
/* picture/pictures.h and picture/section.h: what is cut, and what is drawn. */
#define PICTURE_FILE RT_BINARY_DIR "/test_ray_tree_picture.png"
#include "accel_testing.h"

#include "picture/picture_testing.h"
#include "picture/pictures.h"
#include "picture/section.h"

static const RtColor reflection = {{0, 114, 178}}, transmission = {{0, 158, 115}}, lit = {{230, 159, 0}},
                     blocked = {{213, 94, 0}};

/* The extents of the outline of object 0 in the plane z = `at`, 100 pixels a unit around (200, 200). */
static void outline(const RtScene *scene, double at, double extents[4]) {
    const RtSection section = {.on = {{0, 0, at}},
                               .right = {{1, 0, 0}},
                               .up = {{0, 1, 0}},
                               .normal = {{0, 0, 1}},
                               .origin = {200, 200},
                               .scale = 100};
    cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, 400, 400);
    cairo_t *cairo = cairo_create(surface);
    RtHitMemory *hit_memory;
    assert_ok(rt_hit_memory_alloc(&scene->geometry, &hit_memory, error));
    rt_section_add_object(&section, cairo, &scene->geometry, 0, hit_memory);
    cairo_path_extents(cairo, &extents[0], &extents[1], &extents[2], &extents[3]);
    rt_free(hit_memory);
    cairo_destroy(cairo);
    cairo_surface_destroy(surface);
}

static void assert_outline(const RtScene *scene, double at, double half_width, double half_height) {
    double extents[4];
    outline(scene, at, extents);
    const double expected[4] = {200 - 100 * half_width, 200 - 100 * half_height, 200 + 100 * half_width,
                                200 + 100 * half_height};
    for (int i = 0; i < 4; i++) {
        if (fabs(extents[i] - expected[i]) > 3) fail_msg("side %d: %g, not %g", i, extents[i], expected[i]);
    }
}

RT_TEST(a_plane_cuts_a_sphere_in_a_circle_and_a_cylinder_in_a_rectangle) {
    OWNED_SCENE ball = begin_scene(), cylinder = begin_scene();
    assert_ok(rt_scene_add_sphere(&ball, 0, rt_vec3(0, 0, 0), 1, error));
    assert_ok(rt_scene_add_cone(&cylinder, 0, rt_vec3(0, -1.5f, 0), 1, rt_vec3(0, 1.5f, 0), 1, error));
    assert_ok(rt_scene_finish(&ball, error));
    assert_ok(rt_scene_finish(&cylinder, error));
    assert_outline(&ball, 0, 1, 1);
    assert_outline(&ball, 0.6, 0.8, 0.8);
    assert_outline(&cylinder, 0, 1, 1.5);
    assert_outline(&cylinder, 0.6, 0.8, 1.5);
    double extents[4];
    outline(&cylinder, 1.1, extents);
    assert_true(extents[0] == extents[2]);
}

static RtImage draw_lecture(uint32_t column, uint32_t row, uint32_t depth) {
    OWNED_SCENE scene = open_scene(RT_SOURCE_DIR "/scenes/lecture.yaml");
    RtRayTree tree;
    assert_ok(rt_scene_sample(&scene, 80, 60, 1, false, error));
    OWNED_ACCEL RtAccel *accel = open_accel(&scene, "bvh");
    assert_ok(rt_ray_trees_trace(&tree, accel, &(RtSample){column, row}, 1, depth, error));
    assert_ok(rt_ray_tree_draw(&tree, &scene, "title", PICTURE_FILE, error));
    rt_ray_tree_clear(&tree);
    return read_picture();
}

/* Each colour has a key; rays of a kind add to it. */
RT_TEST(each_kind_of_ray_has_its_color) {
    OWNED_IMAGE one = draw_lecture(42, 42, 1), three = draw_lecture(42, 42, 3); /* the glass ball */
    assert_true(count_color(&three, reflection) > count_color(&one, reflection) + 100);
    assert_true(count_color(&three, transmission) > count_color(&one, transmission) + 100);
    assert_true(count_color(&one, lit) > 50);
    assert_true(count_color(&three, blocked) > count_color(&one, blocked));
}

RT_TEST(a_ray_that_hits_nothing_is_drawn_past_the_scene) {
    OWNED_IMAGE image = draw_lecture(40, 0, 1);
    assert_true(count_color(&image, RT_BLACK) > 1000); /* 2 pixels wide, over most of the picture */
}

RT_TESTS(ray_tree_picture, NULL, assert_nothing_is_kept)
