/* SPDX-License-Identifier: Apache-2.0 */
/* The path of a ray: the events that counted kernels report to an observer add up to their counts. */
#define PICTURE_FILE RT_BINARY_DIR "/test_path_picture.png"
#include "accel_testing.h"

#include "picture/picture_testing.h"
#include "picture/pictures.h"
#include "verify/verify.h"

/* Looks on as a ray is traced by the counted kernels, which is what a path is made of, and compares with the
 * tally that the same ray has where nobody looks on. */
static void assert_adds_up(RtAccel *accel, const char *spec, const RtRay *ray) {
    RtTally counted[RT_RAY_KIND_COUNT] = {0};
    OWNED(rt_path_clear) RtPath path;
    RtHit hit;
    bool occluded;
    RtError problem;
    if (rt_path_trace(&path, accel, ray, &problem) != RT_OK) fail_msg("%s: %s", spec, problem.message);
    OWNED_QUERY query = open_query(accel);
    rt_query_begin(&query);
    if (path.any)
        rt_occluded(&query, &path.ray, 1, &occluded, counted);
    else
        rt_nearest(&query, &path.ray, 1, &hit, counted);
    if (memcmp(&counted[ray->kind], &path.tally, sizeof path.tally) != 0)
        fail_msg("%s: a %s ray's path does not add up", spec, rt_ray_kind_name((RtRayKind)ray->kind));
    if (path.any)
        assert_int_equal(occluded, path.hit.object != RT_NO_OBJECT);
    else
        assert_memory_equal(&hit, &path.hit, sizeof hit);
}

static const RtRayKind kinds[] = {RT_RAY_PRIMARY, RT_RAY_SHADOW, RT_RAY_REFLECTION, RT_RAY_TRANSMISSION};

/* Primary rays over the image, and the rays that follow from them where there are any; counted by kind. */
static void assert_paths_add_up(RtAccel *accel, const char *spec, uint32_t compared[RT_RAY_KIND_COUNT]) {
    const RtSampling *sampling = &accel->scene->sampling;
    for (uint32_t i = 0; i < RT_SHARE(40, 12); i++) {
        RtRay ray;
        RtError error;
        uint32_t column = i * 7 % sampling->columns, row = i * 11 % sampling->rows;
        RtRayKind kind = kinds[i % 4];
        uint32_t lights = accel->scene->light_count;
        if (rt_path_ray(accel, kind, column, row, i / 4 % lights, &ray, &error) != RT_OK) continue;
        assert_adds_up(accel, spec, &ray);
        compared[kind]++;
    }
}

RT_TEST(what_happens_to_a_ray_adds_up_to_its_tally_for_every_accelerator_at_every_setting) {
    static const char *const scenes[] = {"balls:size=2", "csg-field", "teapot:size=2",
                                         RT_SOURCE_DIR "/scenes/lecture.yaml"};
    uint32_t compared[RT_RAY_KIND_COUNT] = {0};
    for (size_t s = 0; s < sizeof scenes / sizeof scenes[0]; s++) {
        OWNED_SCENE scene = open_scene(scenes[s]);
        assert_ok(rt_scene_sample(&scene, 32, 32, 1, false, error));
        for (size_t i = 0; i < rt_accel_count(); i++) {
            char spec[RT_MAX_SPEC_CHARS];
            for (size_t n = 0; rt_spread_spec(rt_accel_at(i), n, spec); n++) {
                OWNED_ACCEL RtAccel *accel = open_available(&scene, spec, 0);
                if (accel) assert_paths_add_up(accel, spec, compared);
            }
        }
    }
    for (size_t k = 0; k < sizeof kinds / sizeof kinds[0]; k++) {
        if (compared[kinds[k]] == 0) fail_msg("no %s ray was compared", rt_ray_kind_name(kinds[k]));
    }
}

RT_TEST(a_path_inside_instances_adds_up_and_has_the_rows_of_each_level) {
    static const char *const specs[] = {"bvh",           "grid", "wide", "kd/octree", "extents/clusters",
                                        "cache+bvh/grid"};
    OWNED_SCENE scene = open_scene("balls:size=3,instances=on");
    uint32_t compared[RT_RAY_KIND_COUNT] = {0};
    assert_ok(rt_scene_sample(&scene, 32, 32, 1, false, error));
    for (size_t i = 0; i < sizeof specs / sizeof specs[0]; i++) {
        OWNED_ACCEL RtAccel *accel = open_accel(&scene, specs[i]);
        OWNED(rt_path_clear) RtPath path;
        RtRay ray;
        assert_paths_add_up(accel, specs[i], compared);
        assert_ok(rt_path_ray(accel, RT_RAY_PRIMARY, 16, 16, 0, &ray, error));
        assert_ok(rt_path_trace(&path, accel, &ray, error));
        uint32_t entered = 0, levels = 0;
        for (uint32_t k = 0; k < path.count; k++) {
            const RtPathRow *row = &path.rows[k];
            const bool object = row->kind == RT_TRACED_OBJECT_TEST && strcmp(row->what, "object") == 0;
            entered += row->kind == RT_TRACED_ENTERED;
            if (row->level > levels) levels = row->level;
            if (object && row->met && rt_path_row_index(&path, row) == path.hit.object) {
                assert_true(row->level > 0 && row->t == path.hit.t && row->nearest == row->t);
                assert_true(row->enter <= (double)row->t && (double)row->t <= row->leave);
                levels |= 0x100; /* found */
            }
        }
        assert_int_equal(entered, path.tally.instances_entered);
        assert_true(levels >= 0x102 && path.place_count == entered + 1);
    }
}

/* `path` along three unit cubes' worth of spheres in a row, seen from the left, at a height `up` above their
 * centres. */
#define PATH_ALONG_THE_ROW(spec, up)                                                                         \
    OWNED_SCENE scene = make_lattice(3, 1, 1);                                                               \
    OWNED_ACCEL RtAccel *accel = open_accel(&scene, spec);                                                   \
    OWNED(rt_path_clear) RtPath path = path_at(accel, up)

static RtPath path_at(RtAccel *accel, float up) {
    RtPath path;
    RtRay ray = {.org = {{-3, up, up}}, .dir = {{1, 0, 0}}, .tmax = INFINITY};
    assert_ok(rt_path_trace(&path, accel, &ray, error));
    return path;
}

RT_TEST(a_path_says_where_the_ray_is_in_boxes_and_what_is_nearest_so_far) {
    PATH_ALONG_THE_ROW("extents", 0);
    /* Of each object a step, an extent test, and of the first an object test; the others lie behind its hit.
     */
    assert_int_equal(path.count, 7);
    assert_int_equal(path.rows[0].kind, RT_TRACED_STEP);
    assert_int_equal(path.rows[1].kind, RT_TRACED_EXTENT_TEST);
    assert_true(path.rows[1].met);
    assert_true(path.rows[1].enter == 2.5 && path.rows[1].leave == 3.5);
    assert_true(path.rows[1].nearest == INFINITY);
    assert_int_equal(path.rows[2].kind, RT_TRACED_OBJECT_TEST);
    assert_true(path.rows[2].met && path.rows[2].t == 2.5f && path.rows[2].nearest == 2.5f);
    assert_false(path.rows[4].met);
    assert_true(path.rows[4].enter == 3.5 && path.rows[4].leave == 4.5);
    assert_int_equal(path.hit.object, 0);
}

RT_TEST(voxels_are_met_in_order_each_where_the_one_before_is_left) {
    /* Past the spheres, in the corners of their boxes: nothing is hit, and the walk goes through. */
    PATH_ALONG_THE_ROW("grid:resolution=6x1x1", 0.45f);
    double left = -INFINITY;
    uint32_t voxels = 0;
    for (uint32_t i = 0; i < path.count; i++) {
        const RtPathRow *row = &path.rows[i];
        if (row->kind != RT_TRACED_STEP) continue;
        assert_true(row->boxed && row->leaf);
        assert_true(row->enter < row->leave);
        if (voxels++) assert_true(row->enter == left);
        left = row->leave;
    }
    assert_int_equal(path.hit.object, RT_NO_OBJECT);
    assert_int_equal(voxels, 6);
}

/* The row of a CSG test or result has these ends. */
static void assert_ends(const RtPath *path, const RtPathRow *row, const char *what, uint32_t count,
                        const float *ends) {
    assert_string_equal(row->what, what);
    assert_true(row->listed);
    assert_int_equal(row->end_count, count);
    for (uint32_t i = 0; i < count; i++) assert_true(fabsf(path->ends[row->first_end + i] - ends[i]) < 1e-6f);
}

RT_TEST(a_path_through_a_csg_tree_has_the_intervals_of_its_solids_and_operations_and_then_its_hit) {
    /* (block & ball) - bore | ring, whose ring lies below the ray. */
    OWNED_SCENE scene = open_scene(RT_SOURCE_DIR "/scenes/csg-lecture.yaml");
    OWNED_ACCEL RtAccel *accel = open_accel(&scene, "brute");
    OWNED(rt_path_clear) RtPath path = path_at(accel, 0);
    static const char *const names[] = {"solid", "solid", "intersection", "solid", "difference", "union"};
    static const float ends[6][4] = {{2, 4},       {1.65f, 4.35f},     {2, 4},
                                     {2.4f, 3.6f}, {2, 2.4f, 3.6f, 4}, {2, 2.4f, 3.6f, 4}};
    uint32_t lists = 0, at = 1; /* row 0: the table */
    for (; path.rows[at].kind != RT_TRACED_OBJECT_TEST; at++) {
        const RtPathRow *row = &path.rows[at];
        if (row->kind == RT_TRACED_EXTENT_TEST) continue;
        assert_int_equal(row->kind, *names[lists] == 's' ? RT_TRACED_CSG_TEST : RT_TRACED_CSG_RESULT);
        assert_ends(&path, row, names[lists], lists < 4 ? 2 : 4, ends[lists]);
        lists++;
    }
    assert_int_equal(lists, 6);
    assert_true(path.rows[at].index == 0 && path.rows[at].met && path.rows[at].t == 2);
    assert_int_equal(path.count, at + 1);
}

RT_TEST(operations_that_need_not_be_carried_out_have_empty_results) {
    OWNED_SCENE scene = open_scene(RT_SOURCE_DIR "/scenes/csg-lecture.yaml");
    OWNED_ACCEL RtAccel *accel = open_accel(&scene, "brute");
    RtPath path;
    RtRay ray = {.org = {{-3, 0.98f, 0.95f}}, .dir = {{1, 0, 0}}, .tmax = INFINITY}; /* beside the ball */
    assert_ok(rt_path_trace(&path, accel, &ray, error));
    uint32_t empty = 0;
    for (uint32_t i = 0; i < path.count; i++)
        empty +=
            path.rows[i].kind == RT_TRACED_CSG_RESULT && path.rows[i].listed && path.rows[i].end_count == 0;
    assert_int_equal(empty, 3);
    assert_int_equal(path.hit.object, RT_NO_OBJECT);
    rt_path_clear(&path);
}

RT_TEST(nobody_looks_on_after_a_path) {
    PATH_ALONG_THE_ROW("bvh", 0);
    assert_true(path.hit.object != RT_NO_OBJECT);
    assert_null(rt_trace_observer);
}

/* ---- the drawing ---- */

static cairo_t *new_canvas(double width, double height) {
    cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, (int)width, (int)height);
    cairo_t *cairo = cairo_create(surface);
    cairo_surface_destroy(surface);
    return cairo;
}

/* A line is cut to three times the size of the picture. */
RT_TEST(a_line_that_leaves_the_picture_is_cut_and_keeps_its_slope) {
    cairo_t *cairo = new_canvas(100, 200);
    double x0, y0, x1, y1;
    for (double far = 1e3; far < 1e12; far *= 10) {
        rt_add_line(cairo, (RtPoint){-far, 50 - far / 3}, (RtPoint){far, 50 + far / 3});
        cairo_path_extents(cairo, &x0, &y0, &x1, &y1);
        assert_true(fabs(x0 + 100) < 0.1 && fabs(x1 - 200) < 0.1);
        assert_true(fabs(y0 - (50 - 100 / 3.0)) < 0.1 && fabs(y1 - (50 + 200 / 3.0)) < 0.1);
        cairo_new_path(cairo);
        rt_add_line(cairo, (RtPoint){far, -far}, (RtPoint){far, far});
        assert_false(cairo_has_current_point(cairo)); /* beside it */
        cairo_new_path(cairo);
    }
    cairo_destroy(cairo);
}

RT_TEST(a_circle_of_any_size_passes_the_middle_of_the_picture_at_its_distance) {
    cairo_t *cairo = new_canvas(100, 200);
    double x0, y0, x1, y1;
    for (double r = 10; r < 1e12; r *= 100) { /* its right end is 7 to the left of the middle */
        rt_add_circle(cairo, (RtPoint){43 - r, 100}, r);
        cairo_path_extents(cairo, &x0, &y0, &x1, &y1);
        assert_true(fabs(x1 - 43) < 0.1 && x0 >= -2.1e6);
        cairo_new_path(cairo);
    }
    cairo_destroy(cairo);
}

RT_TEST(an_axis_has_few_ticks_also_where_the_rows_are_far_away_and_of_no_length) {
    OWNED_SCENE scene = make_lattice(1, 1, 1);
    for (double far = 1; far < 1e30; far *= 10) {
        RtPathRow row = {.kind = RT_TRACED_STEP,
                         .boxed = true,
                         .box = {{{1, -1, -1}}, {{2, 1, 1}}},
                         .enter = far,
                         .leave = nextafter(far, INFINITY)};
        RtPathPlace whole = {.scene = &scene};
        RtPath path = {.ray = {.dir = {{1, 0, 0}}, .tmax = INFINITY},
                       .hit = RT_MISS,
                       .rows = &row,
                       .count = 1,
                       .places = &whole};
        assert_ok(rt_path_draw(&path, &scene, "title \xff", "spec", PICTURE_FILE, error));
        OWNED_IMAGE image = read_picture();
        uint32_t ticks = 0;
        for (int x = 0; x < (int)image.width; x++)
            ticks += pixel(&image, x, 558)[0] == 221; /* above the row */
        assert_true(ticks >= 3 && ticks <= 20);
    }
}

RT_TEST(a_path_is_drawn_large_where_objects_are_tested) {
    enum { LEAF_ROW = 560 + 14 + 7 }; /* of pixels: through the second bar */
    OWNED_SCENE scene = make_lattice(1, 1, 1);
    RtPathRow rows[] = {
        {.kind = RT_TRACED_STEP, .boxed = true, .box = {{{0, -1, -1}}, {{100, 1, 1}}}, .leave = 100},
        {.kind = RT_TRACED_STEP,
         .boxed = true,
         .box = {{{50, -1, -1}}, {{51, 1, 1}}},
         .enter = 50,
         .leave = 51},
        {.kind = RT_TRACED_OBJECT_TEST, .what = "object", .met = true, .t = 50.5f}};
    RtPathPlace whole = {.scene = &scene};
    RtPath path = {.ray = {.dir = {{1, 0, 0}}, .tmax = INFINITY},
                   .hit = {50.5f, 0},
                   .rows = rows,
                   .count = 3,
                   .places = &whole};
    rows[1].leaf = true;
    for (int i = 0; i < 3; i++) rows[i].nearest = i == 2 ? 50.5f : INFINITY;
    assert_ok(rt_path_draw(&path, &scene, "title", "spec", PICTURE_FILE, error));
    OWNED_IMAGE image = read_picture();
    uint32_t width = 0;
    for (int x = 250; x < 980; x++) width += pixel(&image, x, LEAF_ROW)[0] < 200;
    assert_true(width > 150 && width < 300); /* 7 pixels if the whole path were drawn */
}

/* Pixels that are grey but neither white nor black. */
static uint32_t count_pale(const RtPath *path, const RtScene *scene) {
    uint32_t count = 0;
    assert_ok(rt_path_draw(path, scene, "title", "spec", PICTURE_FILE, error));
    OWNED_IMAGE image = read_picture();
    for (int i = 0; i < 730 * 450; i++) {
        const uint8_t *rgb = pixel(&image, 250 + i % 730, 64 + i / 730);
        count += rgb[0] == rgb[1] && rgb[1] == rgb[2] && rgb[0] > 160 && rgb[0] < 254;
    }
    return count;
}

RT_TEST(objects_that_are_not_tested_and_leaves_that_are_not_visited_are_drawn_pale) {
    OWNED_SCENE alone = make_lattice(1, 1, 1);
    PATH_ALONG_THE_ROW("bvh:max_leaf_size=1", 0.3f);
    uint32_t all = count_pale(&path, &scene), first = count_pale(&path, &alone);
    assert_true(all > first + 100); /* the other spheres */
    path.accel = NULL;
    assert_true(count_pale(&path, &scene) + 30 < all); /* their leaves */
}

RT_TESTS(path, NULL, assert_nothing_is_kept)
