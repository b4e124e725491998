/* SPDX-License-Identifier: Apache-2.0 */
/* scenes/: built-in scenes that repeat themselves, as instances and flattened. */
#include "accel_testing.h"

#include "core/base/random.h"

static const char *const repeating[] = {"balls:size=3", "forest:n=40,seed=3", "city:size=3,seed=2,parts=3"};
enum { REPEATING = sizeof repeating / sizeof repeating[0], RAYS = 4000 };

static RtScene open_with(const char *spec, const char *instances) {
    char text[128];
    snprintf(text, sizeof text, "%s,instances=%s", spec, instances);
    return open_scene(text);
}

RT_TEST(copies_in_place_of_instances_have_the_same_ids_materials_and_lights) {
    for (size_t i = 0; i < REPEATING; i++) {
        OWNED_SCENE on = open_with(repeating[i], "on"), flat = open_with(repeating[i], "flattened");
        const uint32_t count = flat.geometry.object_count;
        assert_true(on.geometry.instance_count > 0 && flat.geometry.instance_count == 0);
        assert_int_equal(flat.part_count, 0);
        assert_int_equal(rt_geometry_id_count(&on.geometry), count);
        assert_int_equal(flat.material_count, on.material_count);
        assert_int_equal(flat.light_count, on.light_count);
        assert_memory_equal(&flat.camera, &on.camera, sizeof on.camera);
        for (uint32_t id = 0; id < count; id++) {
            RtPlace place;
            rt_scene_place(&on, id, &(RtRay){.dir = {1, 0, 0}, .tmax = 1}, &place);
            const char *name = on.materials[place.scene->material_of[place.object]].name;
            assert_string_equal(flat.materials[flat.material_of[id]].name, name);
        }
    }
}

/* From a random point of the scene to the middle of a random object's box, and as far beyond. */
static RtRay ray_at_an_object(RtRandom *random, const RtGeometry *g) {
    RtVec3 from, at = rt_box_center(g->boxes[rt_random_below(random, g->object_count)]);
    for (int a = 0; a < 3; a++) from.at[a] = rt_random_between(random, g->box.lo.at[a], g->box.hi.at[a]);
    return (RtRay){.org = from, .dir = rt_sub(at, from), .tmax = 2};
}

static bool equal_up_to_rounding(RtHit a, RtHit b) {
    return a.object == b.object && (a.object == RT_NO_OBJECT || fabsf(a.t - b.t) <= 1e-4f);
}

/* Rounding moves edges, so that a ray that nearly misses an object may hit another. */
RT_TEST(rays_hit_the_same_objects_in_instances_and_in_their_copies) {
    for (size_t i = 0; i < REPEATING; i++) {
        OWNED_SCENE on = open_with(repeating[i], "on"), flat = open_with(repeating[i], "flattened");
        OWNED_ACCEL RtAccel *instanced = open_valid(&on, "bvh"), *copied = open_valid(&flat, "bvh");
        OWNED_QUERY in_instances = open_query(instanced), in_copies = open_query(copied);
        RtRandom random = rt_random(1, i);
        uint32_t hits = 0, differ = 0;
        for (uint32_t k = 0; k < RAYS; k++) {
            const RtRay ray = ray_at_an_object(&random, &flat.geometry);
            RtHit a, b;
            rt_nearest(&in_instances, &ray, 1, &a, NULL);
            rt_nearest(&in_copies, &ray, 1, &b, NULL);
            hits += b.object != RT_NO_OBJECT;
            differ += !equal_up_to_rounding(a, b);
        }
        assert_true(hits > RAYS / 2);
        if (differ > RAYS / 1000) fail_msg("%s: %u of %u rays differ", repeating[i], differ, RAYS);
    }
}

RT_TEST(balls_of_instances_are_as_many_as_of_separate_ones_and_nested) {
    for (uint32_t size = 1; size <= 7; size++) {
        char spec[16];
        uint32_t spheres = 1;
        for (uint32_t level = 0; level < size; level++) spheres = 9 * spheres + 1;
        snprintf(spec, sizeof spec, "balls:size=%u", size);
        OWNED_SCENE scene = open_with(spec, "on");
        assert_int_equal(rt_geometry_id_count(&scene.geometry), spheres + 1);
        assert_int_equal(scene.part_count, size + 1);
        assert_int_equal(scene.geometry.nesting, size + 1);
    }
}

/* The whole flake of the scene reaches as far as that of separate spheres. */
RT_TEST(balls_of_instances_are_as_large_as_separate_ones) {
    OWNED_SCENE off = open_scene("balls"), flat = open_with("balls:size=4", "flattened");
    RtVec3 a = off.geometry.box.hi, b = flat.geometry.box.hi;
    assert_true(fabsf(a.z - b.z) < 1e-4f);
    assert_float_equal(off.geometry.spheres[0].radius, flat.geometry.spheres[0].radius, 0);
    for (uint32_t child = 0; child < 9; child++) { /* each has 820 spheres, and is first of them */
        const RtSphere *one = &off.geometry.spheres[1 + 820 * child],
                       *other = &flat.geometry.spheres[1 + 820 * child];
        assert_true(rt_lengthd(rt_subd(rt_widen(one->center), rt_widen(other->center))) < 1e-6);
        assert_float_equal(one->radius, other->radius, 1e-6);
    }
}

static uint64_t bytes_of(const char *spec, const char *instances) {
    OWNED_SCENE scene = open_with(spec, instances);
    return rt_scene_bytes(&scene);
}

/* A square of ground of two triangles, and an instance; or a thousand triangles more. */
RT_TEST(a_tree_more_takes_less_than_a_kilobyte_as_an_instance_and_70_as_a_copy) {
    const double few = (double)bytes_of("forest:n=100", "on"), many = (double)bytes_of("forest:n=4900", "on");
    assert_true((many - few) / 4800 < 1000);
    const double copies = (double)bytes_of("forest:n=400", "flattened"),
                 fewer = (double)bytes_of("forest:n=100", "flattened");
    assert_true((copies - fewer) / 300 > 70000);
}

RT_TEST(a_forest_of_instances_has_as_many_triangles_as_its_trees_and_ground) {
    OWNED_SCENE scene = open_scene("forest:n=10000,instances=on,parts=5");
    uint32_t ids = scene.geometry.triangle_count;
    assert_int_equal(ids, 2 * 106 * 106);
    assert_int_equal(scene.geometry.instance_count, 10000);
    assert_int_equal(scene.part_count, 5);
    uint32_t placed[5] = {0};
    for (uint32_t i = 0; i < 10000; i++) {
        const uint32_t part = scene.geometry.instances[i].part;
        placed[part]++;
        ids += scene.parts[part]->geometry.triangle_count;
    }
    for (uint32_t part = 0; part < 5; part++) assert_true(placed[part] > 1800 && placed[part] < 2200);
    assert_int_equal(rt_geometry_id_count(&scene.geometry), ids);
}

/* Towers are likely in the middle: the part of the block there is a later one than those at the corners. */
RT_TEST(a_city_of_instances_has_its_towers_in_the_middle) {
    OWNED_SCENE scene = open_scene("city:size=9,instances=on");
    const RtInstance *blocks = scene.geometry.instances;
    assert_int_equal(scene.geometry.instance_count, 81);
    const uint32_t corners[4] = {0, 8, 72, 80};
    for (int i = 0; i < 4; i++) assert_true(blocks[corners[i]].part < 4 && blocks[40].part >= 4);
    for (uint32_t i = 0; i < 81; i++) { /* turned about its middle or not, a block has the same ground */
        const RtVec3d corner = {90 * (i % 9), 90 * (i / 9.0 - i % 9 / 9.0), 0};
        const RtVec3d middle = rt_transform_pointd(&blocks[i].to_world, rt_vec3d(36, 36, 0));
        assert_true(rt_lengthd(rt_subd(middle, rt_addd(corner, rt_vec3d(36, 36, 0)))) < 1e-9);
    }
}

RT_TESTS(repeats, NULL, NULL)
