/* SPDX-License-Identifier: Apache-2.0 */
/* Instances against copies in their place: the objects hit, and materials. */
#include "crossings_testing.h"
#include "instances_testing.h"

#include "core/base/random.h"

/* Multiples of 2^-8 in [-size, size). */
static RtVec3 coarse(RtRandom *random, int size) {
    RtVec3 p;
    for (int a = 0; a < 3; a++)
        p.at[a] = ((float)rt_random_below(random, (uint32_t)size << 9) / 256) - (float)size;
    return p;
}

/* Turned by multiples of 90 degrees about an axis, scaled by 2 or 1, and moved by multiples of 1/4. */
static RtTransform exact_matrix(RtRandom *random) {
    RtTransform t = rt_transform_identity();
    RtVec3 axis = {{0, 0, 0}}, by;
    const float scale = 1 + (float)rt_random_below(random, 2);
    axis.at[rt_random_below(random, 3)] = 1;
    for (int a = 0; a < 3; a++) by.at[a] = (float)rt_random_below(random, 33) / 4 - 4;
    assert_ok(rt_transform_rotate(&t, axis, 90 * (double)rt_random_below(random, 4), error));
    assert_ok(rt_transform_scale(&t, rt_vec3(scale, scale, scale), error));
    assert_ok(rt_transform_translate(&t, by, error));
    return t;
}

RT_TEST(where_a_matrix_rounds_nothing_hits_name_the_objects_of_the_flattened_scene) {
    RtRandom random = rt_random(11, 0);
    OWNED_SCENE scene = begin_scene(), flat;
    uint32_t hits = 0;
    for (uint32_t k = 0; k < 4; k++) {
        RtScene part = begin_scene(), *to = k < 3 ? &part : &scene;
        for (int i = 0; i < 4; i++) {
            const RtVec3 at = coarse(&random, 2);
            const RtVec3 v[3] = {coarse(&random, 2), coarse(&random, 2), coarse(&random, 2)};
            add_ball(to, at.x, at.y, at.z, 0.25f);
            assert_ok(rt_scene_add_triangle(to, 0, v, NULL, error));
        }
        for (int i = 0; k > 0 && i < 4; i++)
            place(to, &scene, rt_random_below(&random, scene.part_count), exact_matrix(&random));
        if (k < 3)
            add_part(&scene, &part);
        else
            rt_scene_clear(&part);
    }
    assert_ok(rt_scene_finish(&scene, error));
    assert_ok(rt_scene_flatten(&scene, &flat, error));
    assert_int_equal(flat.geometry.object_count, rt_geometry_id_count(&scene.geometry));
    OWNED_ACCEL RtAccel *above = open_accel(&scene, "wide/bvh"), *of_flat = open_accel(&flat, "bvh");
    OWNED_QUERY query = open_query(above), query_of_flat = open_query(of_flat);
    for (int i = 0; i < RT_SHARE(20000, 2000); i++) {
        const RtVec3 from = coarse(&random, 8);
        RtRay ray = ray_along(from, rt_sub(coarse(&random, 4), from));
        RtHit hit, same;
        if (!rt_ray_is_valid(&ray)) continue;
        rt_nearest(&query, &ray, 1, &hit, NULL);
        rt_nearest(&query_of_flat, &ray, 1, &same, NULL);
        hits += hit.object != RT_NO_OBJECT;
        if (hit.object == same.object && hit.t == same.t) continue;
        if (hit.object != RT_NO_OBJECT && same.object != RT_NO_OBJECT &&
            fabsf(hit.t - same.t) <= 0x1p-22f * hit.t)
            continue; /* a tie, or the scale of the box's thickness */
        fail_msg("ray %d: object %u at %a, flattened %u at %a", i, hit.object, (double)hit.t, same.object,
                 (double)same.t);
    }
    assert_true(hits > RT_SHARE(5000, 500));
}

RT_TEST(the_outermost_paint_is_the_one_that_is_seen) {
    OWNED_SCENE scene = begin_balls();
    RtScene part = begin_scene();
    RtMaterial red = rt_default_material(), blue = red;
    uint32_t index;
    memcpy(red.name, "red", 4), memcpy(blue.name, "blue", 5);
    red.color = rt_vec3(1, 0, 0), blue.color = rt_vec3(0, 0, 1);
    assert_ok(rt_scene_add_material(&part, &red, &index, error));
    assert_ok(rt_scene_add_material(&scene, &blue, &index, error));
    const RtTransform here = rt_transform_identity(), there = moved(4, 0, 0);
    assert_ok(rt_scene_add_instance(&part, &scene, 0, &here, 1, error));
    assert_ok(rt_scene_add_instance(&part, &scene, 0, &there, RT_OWN_MATERIALS, error));
    add_part(&scene, &part);
    assert_ok(rt_scene_add_instance(&scene, &scene, 1, &here, RT_OWN_MATERIALS, error));
    assert_ok(rt_scene_add_instance(&scene, &scene, 1, &here, 1, error));
    assert_ok(rt_scene_finish(&scene, error));
    OWNED_SCENE flat;
    assert_ok(rt_scene_flatten(&scene, &flat, error));
    for (uint32_t id = 0; id < 4; id++) {
        static const char *const names[] = {"red", NULL, "blue", "blue"};
        RtPlace at;
        const RtRay ray = ray_along(rt_vec3(0, 0, 9), rt_vec3(0, 0, -1));
        rt_scene_place(&scene, id, &ray, &at);
        if (names[id])
            assert_string_equal(at.material->name, names[id]);
        else
            assert_null(at.material);
        assert_string_equal(flat.materials[flat.material_of[id]].name, names[id] ? names[id] : "default");
    }
}

/* A name alone does not make materials the same. */
RT_TEST(copies_share_materials_that_are_equal) {
    OWNED_SCENE scene = begin_balls();
    RtScene part = begin_scene();
    part.materials[0].diffuse = 0.5f;
    add_ball(&part, 0, 0, 0, 1);
    add_part(&scene, &part);
    for (uint32_t i = 0; i < 10; i++) place(&scene, &scene, i % 2, rt_transform_identity());
    assert_ok(rt_scene_finish(&scene, error));
    OWNED_SCENE flat;
    assert_ok(rt_scene_flatten(&scene, &flat, error));
    assert_int_equal(flat.material_count, 2);
}

RT_TESTS(instances_copies, NULL, assert_nothing_is_kept)
