/* SPDX-License-Identifier: Apache-2.0 */
/* Pictures of structures: boxes in perspective and in section, levels, leaves; cells of overlays. */
#define PICTURE_FILE RT_BINARY_DIR "/test_structure_picture.png"
#include "render/render_testing.h"

#include "picture/picture_testing.h"
#include "picture/pictures.h"
#include "picture/section.h"
#include "scenes/open.h"

enum { SIDE = 200 };

/* A sphere of radius 1 at the origin, and small ones far apart in a plane; a camera at z = 10. */
static RtScene five_balls(void) {
    RtScene scene = start_scene(rt_default_material());
    scene.camera.fov = 45;
    assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(0, 0, 0), 1, error));
    for (int i = 0; i < 4; i++) {
        RtVec3 center = {{i % 2 ? 2.5f : -2.5f, i / 2 ? 2.5f : -2.5f, 0.5f}};
        assert_ok(rt_scene_add_sphere(&scene, 0, center, 0.5f, error));
    }
    assert_ok(rt_scene_finish(&scene, error));
    assert_ok(rt_scene_sample(&scene, SIDE, SIDE, 1, false, error));
    return scene;
}

/* The picture of a structure over a frame of it. */
static RtStatus draw(const RtScene *scene, const char *spec, RtStructureOptions options, RtImage *image,
                     RtError *error) {
    OWNED_ACCEL RtAccel *accel;
    OWNED_FRAME frame;
    RtFrameOptions how = {.depth = 1, .threads = 1};
    RT_TRY(rt_accel_open(spec, scene, &accel, error));
    RtStatus status = rt_frame_trace(&frame, accel, &how, error);
    if (status == RT_OK) status = rt_structure_draw(PICTURE_FILE, accel, &frame, &options, error);
    if (status == RT_OK) *image = read_picture();
    return status;
}

/* How dark, as the first level is, the darkest of the three pixels around a place in a row is: 0..255. */
static int ink_at(const RtImage *image, int x, int y) {
    int most = 0;
    for (int i = x - 1; i <= x + 1; i++) {
        int ink = 255 - pixel(image, i, y)[1];
        if (ink > most) most = ink;
    }
    return most;
}

static int count_ink(const RtImage *image) {
    int count = 0;
    for (int i = 0; i < SIDE * SIDE; i++) count += pixel(image, i % SIDE, i / SIDE)[1] < 100;
    return count;
}

RT_TEST(the_root_box_is_drawn_where_the_camera_sees_it) {
    OWNED_IMAGE image = {0};
    OWNED_SCENE scene = five_balls();
    assert_ok(draw(&scene, "bvh:max_leaf_size=64", RT_ALL_LEVELS, &image, error));
    /* The near face of the box is x, y in -3..3 at z = 1, 9 in front of the eye. */
    double reach = 3 / 9.0 / tan(45 * 3.14159265358979 / 360) * 100;
    int left = (int)floor(100 - reach);
    assert_true(ink_at(&image, left, 100) > 150);
    assert_int_equal(pixel(&image, left - 3, 100)[0], 255);
    rt_image_clear(&image);
    /* From inside the box, with corners behind the eye: clipped, and no crash. */
    scene.camera.from = rt_vec3(0, 2, 0.5f);
    assert_ok(draw(&scene, "bvh", RT_ALL_LEVELS, &image, error));
}

RT_TEST(boxes_of_parts_are_drawn_in_each_of_their_instances) {
    OWNED_SCENE part = start_scene(rt_default_material()), scene = start_scene(rt_default_material());
    assert_ok(rt_scene_add_sphere(&part, 0, rt_vec3(0, 0, 0), 0.5f, error));
    assert_ok(rt_scene_add_sphere(&part, 0, rt_vec3(2, 0, 0), 0.5f, error));
    assert_ok(rt_scene_add_part(&scene, &part, error));
    for (int i = 0; i < 2; i++) {
        RtTransform place = rt_transform_identity();
        assert_ok(rt_transform_translate(&place, rt_vec3(-1, i ? 2 : -2, 0), error));
        assert_ok(rt_scene_add_instance(&scene, &scene, 0, &place, RT_OWN_MATERIALS, error));
    }
    scene.camera.fov = 45;
    assert_ok(rt_scene_finish(&scene, error));
    assert_ok(rt_scene_sample(&scene, SIDE, SIDE, 1, false, error));
    OWNED_IMAGE image = {0};
    assert_ok(draw(&scene, "extents", RT_ALL_LEVELS, &image, error));
    const double scale = 100 / tan(45 * 3.14159265358979 / 360) / 9.5; /* at the near faces */
    for (int i = 0; i < 4; i++) { /* the outer side of each sphere's box, halfway up */
        const int x = (int)floor(100 + (i % 2 ? 1.5 : -1.5) * scale),
                  y = (int)floor(100 + (i / 2 ? 2 : -2) * scale);
        assert_true(ink_at(&image, x, y) > 100);
    }
    const int inner = (int)floor(100 + 0.5 * scale); /* inside the instances' boxes: from the part alone */
    assert_true(ink_at(&image, inner, (int)floor(100 + 2 * scale)) > 30);
}

RT_TEST(boxes_behind_what_is_seen_are_faint) {
    OWNED_IMAGE image = {0};
    OWNED_SCENE scene = five_balls();
    /* The box of the sphere in the middle: its far face, at z = -1, is behind the sphere. */
    assert_ok(draw(&scene, "extents", RT_ALL_LEVELS, &image, error));
    double scale = 100 / tan(45 * 3.14159265358979 / 360);
    int near = (int)floor(100 - scale / 9), far = (int)floor(100 - scale / 11);
    assert_true(ink_at(&image, near, 100) > 150);
    assert_true(ink_at(&image, far, 100) < 130);
}

/* The lines of a ball's outline: their number, and their least and largest distance from its centre, in
 * radii. */
typedef struct Seen {
    const RtBoxView *view;
    uint32_t lines;
    double least, most;
} Seen;

static void see_line(void *context, RtVec3d from, RtVec3d to) {
    Seen *seen = context;
    const RtBall *ball = &seen->view->extents->balls[seen->view->extent];
    double away = rt_lengthd(rt_subd(rt_scaled(rt_add_scaledd(from, to, 1), 0.5), ball->center));
    seen->least = seen->lines ? fmin(seen->least, away / ball->radius) : away / ball->radius;
    seen->most = fmax(seen->most, away / ball->radius);
    seen->lines++;
}

/* The plane of this z, as it is. */
static RtSection section_at(double z) {
    return (RtSection){{{0, 0, z}}, {{1, 0, 0}}, {{0, 1, 0}}, {{0, 0, 1}}, {0, 0}, 1};
}

static void check_ball(void *context, const RtBoxView *view) {
    Seen seen = {.view = view};
    const RtBall *ball = &view->extents->balls[view->extent];
    rt_outline_edges(view, rt_vec3d(0, 0, 10), (RtLineViewer){see_line, &seen});
    assert_int_equal(seen.lines, 4 * RT_CIRCLE_CORNERS);
    assert_true(seen.least >= 1 && seen.most < 1.01);
    const RtSection within = section_at(ball->center.z + 0.6 * ball->radius);
    const RtSection beside = section_at(ball->center.z + 1.01 * ball->radius);
    assert_true(rt_section_add_extent(&within, NULL, view) && !rt_section_add_extent(&beside, NULL, view));
    ++*(int *)context;
}

RT_TEST(spheres_are_outlined_by_circles_and_cut_in_circles) {
    int count = 0;
    OWNED_SCENE scene = five_balls();
    OWNED_ACCEL RtAccel *accel = open_accel(&scene, "clusters:width=2,extent=sphere");
    accel->ops->each_box(accel, (RtBoxViewer){check_ball, &count});
    assert_int_equal(count, 9);
}

static void count_line(void *context, RtVec3d from, RtVec3d to) {
    (void)from, (void)to;
    ++*(int *)context;
}

/* Its three slabs are the box: the twelve edges of either, and the four corners of a section. */
static void check_polytope(void *context, const RtBoxView *view) {
    RtPoint corners[RT_MAX_CORNERS];
    const RtSection middle = section_at((double)rt_box_center(*view->box).z);
    int lines = 0;
    rt_outline_edges(view, rt_vec3d(0, 0, 10), (RtLineViewer){count_line, &lines});
    assert_int_equal(lines, 12);
    assert_int_equal(rt_section_cut(&middle, view, corners), 4);
    for (int i = 0; i < 4; i++) {
        for (int a = 0; a < 2; a++) {
            double lo = (double)view->box->lo.at[a], hi = (double)view->box->hi.at[a];
            double at = a == 0 ? corners[i].x : -corners[i].y;
            assert_true(fmin(fabs(at - lo), fabs(at - hi)) < 1e-4);
        }
    }
    ++*(int *)context;
}

RT_TEST(three_slabs_and_oriented_boxes_of_spheres_have_the_edges_of_boxes) {
    static const char *const specs[] = {"extents:kind=slabs,slabs=3", "extents:kind=obb"};
    OWNED_SCENE scene = five_balls();
    for (int i = 0; i < 2; i++) {
        OWNED_ACCEL RtAccel *accel = open_accel(&scene, specs[i]);
        int count = 0;
        accel->ops->each_box(accel, (RtBoxViewer){check_polytope, &count});
        assert_int_equal(count, 5);
    }
}

RT_TEST(levels_and_leaves_leave_the_other_boxes_out) {
    OWNED_IMAGE all = {0}, root = {0}, leaves = {0};
    OWNED_SCENE scene = five_balls();
    RtStructureOptions options = RT_ALL_LEVELS;
    assert_ok(draw(&scene, "bvh:max_leaf_size=1", options, &all, error));
    options.leaves = true;
    assert_ok(draw(&scene, "bvh:max_leaf_size=1", options, &leaves, error));
    options = (RtStructureOptions){0, 0, false, false, 0, 0};
    assert_ok(draw(&scene, "bvh:max_leaf_size=1", options, &root, error));
    assert_true(count_ink(&root) > 400);
    assert_true(count_ink(&all) > 400);
    double reach = 3 / 9.0 / tan(45 * 3.14159265358979 / 360) * 100;
    int left = (int)floor(100 - reach); /* a place of the root's box alone */
    assert_true(ink_at(&root, left, 100) > 150);
    assert_true(ink_at(&leaves, left, 100) < 60);
    options.first_level = options.last_level = 60;
    assert_bad_input(draw(&scene, "bvh", options, &all, error), "levels");
}

RT_TEST(a_section_shows_the_boxes_and_outlines_of_what_the_plane_cuts) {
    OWNED_IMAGE image = {0};
    OWNED_SCENE scene = five_balls();
    RtStructureOptions options = {.last_level = UINT32_MAX, .slice = true, .axis = 2, .at = -0.5};
    assert_ok(draw(&scene, "extents", options, &image, error));
    /* The scene is 6 wide, in 96 % of the image. Only the middle sphere reaches z = -0.5, in x from -1 to 1.
     */
    double scale = 0.96 * SIDE / 6;
    assert_true(ink_at(&image, (int)(100 - scale), 100) > 150);
    assert_int_equal(pixel(&image, (int)(100 - 3 * scale) + 1, 20)[0], 255);
    options.at = 5;
    assert_bad_input(draw(&scene, "extents", options, &image, error), "");
}

/* Of the pixels between the balls of five_balls, in voxels without objects: those that are not white. */
static int count_between_balls(const RtImage *image) {
    int count = 0;
    for (int y = 65; y < 135; y++) {
        for (int x = 142; x < 190; x++) count += pixel(image, x, y)[0] != 255;
    }
    return count;
}

RT_TEST(a_section_outlines_empty_voxels_but_fills_only_those_with_objects) {
    OWNED_IMAGE all = {0};
    OWNED_IMAGE leaves = {0};
    OWNED_SCENE scene = five_balls();
    RtStructureOptions options = {.last_level = UINT32_MAX, .slice = true, .axis = 2, .at = 0.5};
    assert_ok(draw(&scene, "grid:density=64", options, &all, error));
    assert_in_range(count_between_balls(&all), 100, 48 * 70 / 2); /* lines, and white between them */
    options.leaves = true;
    assert_ok(draw(&scene, "grid:density=64", options, &leaves, error));
    assert_int_equal(count_between_balls(&leaves), 0);
}

RT_TEST(a_section_outlines_csg_trees) {
    OWNED_IMAGE image = {0};
    uint32_t drawn = 0;
    OWNED_SCENE scene = open_scene("csg-field");
    assert_ok(rt_scene_sample(&scene, SIDE, SIDE, 1, false, error));
    RtStructureOptions options = {.slice = true, .axis = 2}; /* no boxes inside that of the root */
    options.at = (double)rt_box_center(scene.geometry.box).z;
    assert_ok(draw(&scene, "bvh", options, &image, error));
    for (int y = 20; y < SIDE - 20; y++) {
        for (int x = 20; x < SIDE - 20; x++) drawn += pixel(&image, x, y)[0] < 200;
    }
    assert_true(drawn > 50);
}

RT_TEST(a_wall_that_is_far_larger_than_a_section_is_outlined_where_it_is) {
    OWNED_IMAGE image = {0};
    RtVec3 wall[4] = {
        {{-1000, -1499.5f, -9}}, {{1000, 1500.5f, -9}}, {{1000, 1500.5f, 9}}, {{-1000, -1499.5f, 9}}};
    OWNED_SCENE scene = start_scene(rt_default_material());
    scene.camera.fov = 45;
    assert_ok(rt_scene_add_polygon(&scene, 0, wall, 4, error));
    assert_ok(rt_scene_finish(&scene, error));
    assert_ok(rt_scene_sample(&scene, SIDE, SIDE, 1, false, error));
    RtStructureOptions options = {.last_level = UINT32_MAX, .slice = true, .axis = 2, .at = -0.5};
    assert_ok(draw(&scene, "extents", options, &image, error));
    double scale = 100 / (10 * tan(45 * 3.14159265358979 / 360)); /* what the camera sees at its aim */
    for (int i = -8; i <= 8; i++) {
        double x = 0.25 * i, y = 1.5 * x + 0.5;
        int column = (int)floor(100 + scale * x), row = (int)floor(100 - scale * y), grey = 0;
        for (int near = row - 2; near <= row + 2; near++)
            grey += near >= 0 && near < SIDE && pixel(&image, column, near)[2] < 205;
        assert_true(grey > 0);
    }
}

RT_TEST(the_topmost_layer_that_can_be_drawn_is_and_any_can_be_named) {
    const RtAccel *layer = NULL;
    RtSpec spec;
    OWNED_SCENE scene = five_balls();
    OWNED_ACCEL RtAccel *accel = open_accel(&scene, "cache+item+bvh");
    assert_ok(rt_structure_layer(accel, NULL, &layer, error));
    assert_string_equal(layer->ops->name, "item");
    assert_ok(rt_structure_layer(accel, "bvh", &layer, error));
    assert_string_equal(layer->ops->name, "bvh");
    assert_fails_with(rt_structure_layer(accel, "cache", &layer, error), RT_NOT_AVAILABLE, "");
    assert_bad_input(rt_structure_layer(accel, "grid", &layer, error), "");
    assert_ok(rt_spec_parse("brute", &spec, error));
    assert_fails_with(rt_structure_available(&spec, NULL, error), RT_NOT_AVAILABLE, "");
    assert_ok(rt_spec_parse("item+brute", &spec, error));
    assert_ok(rt_structure_available(&spec, NULL, error));
}

static RtImage draw_buffer(const RtScene *scene, const char *spec, const RtRay *ray) {
    OWNED_ACCEL RtAccel *accel = open_accel(scene, spec);
    assert_ok(rt_buffer_draw(PICTURE_FILE, accel, 0, ray, error));
    return read_picture();
}

RT_TEST(the_item_buffer_has_a_color_for_each_object_and_white_for_none) {
    OWNED_SCENE scene = five_balls();
    OWNED_IMAGE image = draw_buffer(&scene, "item+bvh", NULL);
    RtColor middle = rt_color_of_id(0);
    assert_memory_equal(pixel(&image, 100, 100), middle.rgb, 3);
    assert_memory_equal(pixel(&image, 2, 2), RT_WHITE.rgb, 3);
}

/* A picture looks up the cells that the kernel reads: a ray's steps are entries of that cell. */
RT_TEST(a_shadow_ray_reads_the_cell_that_is_marked) {
    OWNED_SCENE scene = five_balls();
    OWNED_ACCEL RtAccel *accel = open_accel(&scene, "light:cells=16,full_occlusion=off+bvh");
    OWNED_QUERY query = open_query(accel);
    RtVec3 light = scene.lights[0].position;
    uint32_t listed = 0;
    for (int i = 0; i < 400; i++) {
        /* From the far side of the scene to the light: no entry is deeper than the ray. */
        int column = i % 20, row = i / 20;
        RtRay ray = {.org = rt_vec3(-3 + 6 * (float)column / 19, -3 + 6 * (float)row / 19, -1),
                     .tmax = 1,
                     .kind = RT_RAY_SHADOW};
        RtTally tallies[RT_RAY_KIND_COUNT] = {0};
        RtCellView cell = {0};
        bool occluded, there;
        ray.dir = rt_sub(light, ray.org);
        rt_occluded(&query, &ray, 1, &occluded, tallies);
        there = accel->ops->find_cell(accel, &ray, &cell);
        uint64_t steps = tallies[RT_RAY_SHADOW].steps;
        assert_true(steps <= (there ? cell.length : 0));
        if (there && !occluded && !cell.cut) assert_int_equal(steps, cell.length);
        listed += there && cell.length > 0;
    }
    assert_true(listed > 20);
}

RT_TEST(the_cells_around_a_light_are_drawn_and_a_light_without_cells_is_refused) {
    OWNED_SCENE scene = five_balls();
    OWNED_ACCEL RtAccel *cells = open_accel(&scene, "light:cells=16+bvh");
    OWNED_ACCEL RtAccel *none = open_accel(&scene, "light+bvh");
    RtRay ray = {.org = rt_vec3(0, 0, -1), .tmax = 1, .kind = RT_RAY_SHADOW};
    ray.dir = rt_sub(scene.lights[0].position, ray.org);
    OWNED_IMAGE image = draw_buffer(&scene, "light:cells=16+bvh", &ray);
    assert_true(image.width > 900 && image.height > 700);
    const uint8_t *hidden = pixel(&image, 4 * 240 - 10, 10); /* beside the cross */
    assert_memory_equal(hidden, RT_WHITE.rgb, 3);
    /* Lists without an object have the scale's colour of 0. */
    assert_true(count_color(&image, rt_color_scale(0)) > 1000);
    assert_bad_input(rt_buffer_draw(PICTURE_FILE, cells, 7, NULL, error), "");
    assert_fails_with(rt_buffer_draw(PICTURE_FILE, none, 0, NULL, error), RT_NOT_AVAILABLE, "");
}

RT_TESTS(structure, NULL, assert_nothing_is_kept)
