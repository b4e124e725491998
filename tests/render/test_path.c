/* SPDX-License-Identifier: Apache-2.0 */
/* The path of a ray: what counted kernels tell an onlooker adds up to what they count. */
#include "accel_testing.h"

#include "render/path.h"
#include "scenes/open.h"
#include "verify/spread.h"

/* Looks on as a ray is traced by the counted kernels, which is what a path is made of, and compares with the
 * tally that the same ray has where nobody looks on. */
static void assert_adds_up(RtAccel *accel, const char *spec, const RtRay *ray) {
    RtQuery query;
    RtTally counted[RT_RAY_KIND_COUNT] = {0};
    RtPath path;
    RtHit hit;
    bool blocked;
    RtError problem;
    if (rt_path_trace(&path, accel, ray, &problem) != RT_OK) fail_msg("%s: %s", spec, problem.message);
    assert_ok(rt_query_init(&query, accel, error));
    rt_query_begin(&query);
    if (path.any)
        rt_occluded(&query, &path.ray, 1, &blocked, counted);
    else
        rt_nearest(&query, &path.ray, 1, &hit, counted);
    if (memcmp(&counted[ray->kind], &path.tally, sizeof path.tally) != 0)
        fail_msg("%s: a %s ray's path does not add up", spec, rt_ray_kind_name((RtRayKind)ray->kind));
    if (path.any)
        assert_int_equal(blocked, path.hit.object != RT_NO_OBJECT);
    else
        assert_memory_equal(&hit, &path.hit, sizeof hit);
    rt_query_clear(&query);
    rt_path_clear(&path);
}

/* Primary rays over the image, and the rays that follow from them. */
static void assert_paths_add_up(RtAccel *accel, const char *spec) {
    static const RtRayKind kinds[] = {RT_RAY_PRIMARY, RT_RAY_SHADOW, RT_RAY_REFLECTION, RT_RAY_TRANSMISSION};
    const RtSampling *sampling = &accel->scene->sampling;
    for (uint32_t i = 0; i < 40; i++) {
        RtRay ray;
        RtError error;
        uint32_t column = i * 7 % sampling->columns, row = i * 11 % sampling->rows;
        RtRayKind kind = kinds[i % 4];
        uint32_t lights = accel->scene->light_count;
        if (rt_path_ray(accel, kind, column, row, i / 4 % lights, &ray, &error) == RT_OK)
            assert_adds_up(accel, spec, &ray);
    }
}

RT_TEST(what_happens_to_a_ray_adds_up_to_its_tally_for_every_accelerator_at_every_setting) {
    static const char *const scenes[] = {"balls:size=2", "csg-field", "teapot:size=2"};
    for (size_t s = 0; s < sizeof scenes / sizeof scenes[0]; s++) {
        RtScene scene;
        assert_ok(rt_scene_open(scenes[s], &scene, error));
        assert_ok(rt_scene_sample(&scene, 32, 32, 1, false, error));
        for (size_t i = 0; i < rt_accel_count(); i++) {
            char spec[RT_MAX_SPEC_CHARS];
            for (size_t n = 0; rt_spread_spec(rt_accel_at(i), n, spec); n++) {
                RtAccel *accel;
                RtError error;
                RtStatus status = rt_accel_open(spec, &scene, &accel, &error);
                if (status == RT_NOT_AVAILABLE) continue;
                assert_int_equal(status, RT_OK);
                assert_paths_add_up(accel, spec);
                rt_accel_destroy(accel);
            }
        }
        rt_scene_clear(&scene);
    }
}

/* Three unit cubes' worth of spheres in a row, seen from the right. */
static RtPath path_along_the_row(const char *spec, RtScene *scene, RtAccel **accel) {
    RtPath path;
    RtRay ray = {.org = {{-3, 0, 0}}, .dir = {{1, 0, 0}}, .tmax = INFINITY};
    make_lattice(scene, 3, 1, 1);
    assert_ok(rt_accel_open(spec, scene, accel, error));
    assert_ok(rt_path_trace(&path, *accel, &ray, error));
    return path;
}

static void forget(RtPath *path, RtScene *scene, RtAccel *accel) {
    rt_path_clear(path);
    rt_accel_destroy(accel);
    rt_scene_clear(scene);
}

RT_TEST(a_path_says_where_the_ray_is_in_boxes_and_what_is_nearest_so_far) {
    RtScene scene;
    RtAccel *accel;
    RtPath path = path_along_the_row("extents", &scene, &accel);
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
    forget(&path, &scene, accel);
}

RT_TEST(voxels_are_met_in_order_each_where_the_one_before_is_left) {
    RtScene scene;
    RtAccel *accel;
    RtPath path = path_along_the_row("grid:resolution=6x1x1", &scene, &accel);
    double left = -INFINITY;
    uint32_t voxels = 0;
    for (uint32_t i = 0; i < path.count; i++) {
        const RtPathRow *row = &path.rows[i];
        if (row->kind != RT_TRACED_STEP) continue;
        assert_true(row->boxed && row->leaf);
        if (voxels++) assert_true(row->enter == left);
        left = row->leave;
    }
    assert_true(voxels >= 1);
    forget(&path, &scene, accel);
}

RT_TEST(nobody_looks_on_after_a_path) {
    RtScene scene;
    RtAccel *accel;
    RtPath path = path_along_the_row("bvh", &scene, &accel);
    assert_null(rt_onlooker);
    forget(&path, &scene, accel);
}

RT_TESTS(path, NULL, assert_nothing_is_kept)
