/* SPDX-License-Identifier: Apache-2.0 */
/* render/ray_tree.h: the tree adds up to the frame's colour, bit for bit, and says why it has that colour. */
#include "accel_testing.h"
#include "render_testing.h"

#include "render/ray_tree.h"

#define OWNED_TREE OWNED(rt_ray_tree_clear) RtRayTree

static RtRayTree tree_of(const RtAccel *accel, uint32_t column, uint32_t row, uint32_t depth) {
    RtRayTree tree;
    assert_ok(rt_ray_trees_trace(&tree, accel, &(RtSample){column, row}, 1, depth, error));
    return tree;
}

/* Compares the tree of every `stride`th sample with the frame. */
static void assert_trees_make_the_frame(const RtAccel *accel, uint32_t depth, uint32_t stride) {
    const RtFrameOptions options = {.depth = depth, .threads = 2};
    const uint32_t columns = accel->scene->sampling.columns, samples = columns * accel->scene->sampling.rows;
    OWNED_FRAME frame;
    assert_ok(rt_frame_trace(&frame, accel, &options, error));
    for (uint32_t i = 0; i < samples; i += stride) {
        OWNED_TREE tree = tree_of(accel, i % columns, i / columns, depth);
        RtVec3 color = rt_vec3(0, 0, 0);
        for (uint32_t k = 0; k < tree.count; k++) color = rt_add(color, tree.rays[k].added);
        assert_memory_equal(&color, &frame.color[i], sizeof color);
        assert_memory_equal(&tree.color, &frame.color[i], sizeof color);
        assert_int_equal(tree.rays[0].hit.object, frame.object[i]);
        assert_memory_equal(&tree.rays[0].hit.t, &frame.depth[i], sizeof(float));
    }
}

RT_TEST(the_rays_of_a_tree_add_up_to_the_color_of_the_frame_bit_for_bit) {
    static const char *const scenes[] = {"balls:size=2",
                                         "tetra:size=2",
                                         "random:n=60,shape=mixed,radius=2",
                                         RT_SOURCE_DIR "/scenes/csg-lecture.yaml",
                                         RT_SOURCE_DIR "/scenes/lecture.yaml",
                                         RT_SOURCE_DIR "/scenes/jewel.nff"};
    for (size_t s = 0; s < sizeof scenes / sizeof scenes[0]; s++) {
        OWNED_SCENE scene = open_scene(scenes[s]);
        assert_ok(rt_scene_sample(&scene, 12, 9, 1, s % 2 == 1, error));
        OWNED_ACCEL RtAccel *accel = open_accel(&scene, s % 2 ? "grid" : "bvh");
        for (uint32_t depth = 1; depth <= 6; depth++)
            assert_trees_make_the_frame(accel, depth, RT_SHARE(1, 7));
    }
}

/* A stack of panes that reflect and transmit: rays multiply, so the levels of a tile exceed a stream. */
RT_TEST(the_order_of_rays_is_that_of_the_frame_where_a_tile_is_cut_into_streams) {
    OWNED_SCENE scene = start_scene((RtMaterial){.color = {0.7f, 0.6f, 0.9f},
                                                 .ambient = 0.3f,
                                                 .diffuse = 0.3f,
                                                 .reflection = 0.45f,
                                                 .transmission = 0.55f,
                                                 .ior = 1.3f});
    for (int i = 0; i < 5; i++) add_square(&scene, 4, (float)i);
    assert_ok(rt_scene_add_light(&scene, rt_vec3(3, 4, 8), rt_vec3(0.6f, 0.7f, 0.5f), error));
    assert_ok(rt_scene_finish(&scene, error));
    assert_ok(rt_scene_sample(&scene, 15, 16, 1, false, error));
    OWNED_ACCEL RtAccel *accel = open_accel(&scene, "bvh");
    assert_trees_make_the_frame(accel, 9, RT_SHARE(1, 41));
}

RT_TEST(the_trees_of_a_tile_are_those_of_its_samples_one_by_one) {
    OWNED_SCENE scene = busy_scene();
    assert_ok(rt_scene_sample(&scene, 20, 20, 1, false, error));
    OWNED_ACCEL RtAccel *accel = open_accel(&scene, "item+light+bvh");
    const RtSample samples[] = {{19, 0}, {16, 15}, {17, 3}};
    RtRayTree trees[3];
    assert_ok(rt_ray_trees_trace(trees, accel, samples, 3, 4, error));
    for (uint32_t i = 0; i < 3; i++) {
        OWNED_TREE alone = tree_of(accel, samples[i].column, samples[i].row, 4);
        assert_int_equal(trees[i].rays[0].ray.source, samples[i].row * 20 + samples[i].column);
        assert_memory_equal(&trees[i].color, &alone.color, sizeof alone.color);
        assert_int_equal(trees[i].count, alone.count);
        for (uint32_t k = 0; k < alone.count; k++) {
            assert_int_equal(trees[i].rays[k].parent, alone.rays[k].parent);
            assert_memory_equal(&trees[i].rays[k].terms, &alone.rays[k].terms, sizeof alone.rays[k].terms);
        }
        rt_ray_tree_clear(&trees[i]);
    }
}

/* `item` does not know it, and passes it on. */
RT_TEST(the_tree_of_a_given_ray_is_that_of_the_sample_whose_ray_it_is) {
    OWNED_SCENE scene = busy_scene();
    assert_ok(rt_scene_sample(&scene, 20, 20, 1, false, error));
    OWNED_ACCEL RtAccel *accel = open_accel(&scene, "item+bvh");
    for (uint32_t row = 0; row < 20; row += 3) {
        OWNED_TREE tree = tree_of(accel, 17, row, 4), given = {0};
        RtRay ray = tree.rays[0].ray;
        ray.kind = RT_RAY_RANDOM;
        assert_ok(rt_ray_tree_trace_given(&given, accel, &ray, 4, error));
        assert_memory_equal(&given.color, &tree.color, sizeof tree.color);
        assert_int_equal(given.count, tree.count);
        assert_int_equal(given.rays[0].ray.source, RT_NO_RAY);
        for (uint32_t k = 0; k < tree.count; k++) {
            assert_int_equal(given.rays[k].ray.kind, tree.rays[k].ray.kind);
            assert_memory_equal(&given.rays[k].terms, &tree.rays[k].terms, sizeof tree.rays[k].terms);
        }
    }
}

RT_TEST(the_five_terms_of_a_hit_add_up_to_the_light_that_comes_from_it_bit_for_bit) {
    OWNED_SCENE scene = busy_scene();
    assert_ok(rt_scene_sample(&scene, 16, 12, 1, false, error));
    OWNED_ACCEL RtAccel *accel = open_accel(&scene, "bvh");
    uint32_t used[RT_TERM_COUNT] = {0};
    for (uint32_t i = 0; i < 16 * 12; i += 5) {
        OWNED_TREE tree = tree_of(accel, i % 16, i / 16, 5);
        for (int a = 0; a < 3; a++)
            assert_near(tree.rays[0].light.at[a], tree.color.at[a], 1e-5); /* one sum in float32, one not */
        for (uint32_t k = 0; k < tree.count; k++) {
            const RtTreeRay *ray = &tree.rays[k];
            RtVec3d sum = {{0, 0, 0}}, of_children = {{0, 0, 0}};
            double of_kind[RT_RAY_KIND_COUNT] = {0};
            for (uint32_t child = ray->child; child != RT_NO_RAY; child = tree.rays[child].next) {
                assert_true(child > k && tree.rays[child].parent == k);
                of_children = rt_addd(of_children, tree.rays[child].light);
                of_kind[tree.rays[child].ray.kind] += tree.rays[child].light.x;
            }
            for (int t = 0; t < RT_TERM_COUNT; t++) {
                sum = rt_addd(sum, ray->terms[t]);
                used[t] += ray->terms[t].x > 0;
            }
            const RtVec3d added = rt_widen(ray->added);
            if (ray->ray.kind == RT_RAY_SHADOW) assert_memory_equal(&ray->light, &added, sizeof added);
            if (!ray->surface.material) continue;
            assert_memory_equal(&sum, &ray->light, sizeof sum);
            assert_near(sum.x, (double)ray->added.x + of_children.x, 1e-6);
            assert_near(ray->terms[RT_TERM_REFLECTED].x, of_kind[RT_RAY_REFLECTION], 1e-12);
            assert_near(ray->terms[RT_TERM_TRANSMITTED].x, of_kind[RT_RAY_TRANSMISSION], 1e-12);
        }
    }
    for (int t = 0; t < RT_TERM_COUNT; t++) assert_true(used[t] > 0);
}

RT_TEST(rays_are_numbered_depth_first_and_each_once) {
    OWNED_SCENE scene = busy_scene();
    assert_ok(rt_scene_sample(&scene, 16, 12, 1, false, error));
    OWNED_ACCEL RtAccel *accel = open_accel(&scene, "bvh");
    OWNED_TREE tree = tree_of(accel, 5, 6, 4);
    uint32_t number = 0, deepest = 0, last = 0;
    for (uint32_t i = 0; i != RT_NO_RAY; last = i, i = rt_ray_tree_next(&tree, i)) {
        assert_int_equal(tree.rays[i].number, ++number);
        if (tree.rays[last].child != RT_NO_RAY && i > 0) assert_int_equal(tree.rays[i].parent, last);
        if (tree.rays[i].level > deepest) deepest = tree.rays[i].level;
    }
    assert_int_equal(number, tree.count);
    assert_int_equal(deepest, 4);
    assert_int_equal(tree.levels, 4);
}

/* A mirror below, and one above the camera, which looks straight down. */
RT_TEST(each_reflection_between_two_mirrors_carries_half_of_the_light) {
    OWNED_SCENE scene =
        start_scene((RtMaterial){.color = {1, 1, 1}, .ambient = 1, .reflection = 0.5f, .ior = 1});
    add_square(&scene, 1000, 0);
    add_square(&scene, 1000, 20);
    assert_ok(rt_scene_finish(&scene, error));
    OWNED_ACCEL RtAccel *accel = open_accel(&scene, "brute");
    OWNED_TREE tree = tree_of(accel, 0, 0, 4);
    assert_int_equal(tree.levels, 4);
    uint32_t level = 0;
    for (uint32_t i = 0; i < tree.count; i++) {
        const RtTreeRay *ray = &tree.rays[i];
        if (ray->ray.kind == RT_RAY_SHADOW) continue;
        assert_int_equal(ray->hit.object, level % 2);
        assert_true(ray->factor == powf(0.5f, (float)level));
        assert_true(ray->cut == (level == 3));
        assert_false(ray->total);
        assert_int_equal(ray->level, ++level);
    }
    assert_int_equal(level, 4);
}

/* The camera is inside a ball of glass, above its centre, and looks along the surface. */
RT_TEST(a_ray_that_glass_holds_back_is_reflected_with_all_of_its_light) {
    RtMaterial glass = {.color = {1, 1, 1}, .reflection = 0.1f, .transmission = 0.75f, .ior = 1.5f};
    OWNED_SCENE scene = start_scene(glass);
    scene.camera.from = rt_vec3(0, 0, 0.9f);
    scene.camera.at = rt_vec3(1, 0, 0.9f);
    assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(0, 0, 0), 1, error));
    assert_ok(rt_scene_finish(&scene, error));
    OWNED_ACCEL RtAccel *accel = open_accel(&scene, "brute");
    OWNED_TREE tree = tree_of(accel, 0, 0, 2);
    uint32_t reflected = 0;
    for (uint32_t i = 1; i < tree.count; i++) {
        const RtTreeRay *ray = &tree.rays[i];
        if (ray->ray.kind == RT_RAY_SHADOW) continue;
        assert_int_equal(ray->ray.kind, RT_RAY_REFLECTION);
        assert_true(ray->total);
        assert_true(ray->factor == 0.1f + 0.75f);
        reflected++;
    }
    assert_int_equal(reflected, 1);
    assert_false(tree.rays[0].surface.entering);
}

/* A square, and a ball between it and one of two lights. */
RT_TEST(a_shadow_ray_knows_what_is_in_the_way_and_adds_nothing_then) {
    OWNED_SCENE scene = start_scene(rt_default_material());
    add_square(&scene, 4, 0);
    assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(2, 0, 2), 0.5f, error));
    assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(4, 0, 4), 0.5f, error));
    assert_ok(rt_scene_add_light(&scene, rt_vec3(6, 0, 6), rt_vec3(1, 1, 1), error));
    assert_ok(rt_scene_add_light(&scene, rt_vec3(-6, 0, 6), rt_vec3(1, 1, 1), error));
    assert_ok(rt_scene_finish(&scene, error));
    OWNED_ACCEL RtAccel *accel = open_accel(&scene, "brute");
    OWNED_TREE tree = tree_of(accel, 0, 0, 1);
    assert_int_equal(tree.count, 3);
    const RtTreeRay *blocked = &tree.rays[1], *free = &tree.rays[2];
    assert_int_equal(blocked->ray.source, 0);
    assert_int_equal(blocked->hit.object, 1);
    assert_near(blocked->hit.t, 1.0 / 3 - 0.5 / sqrt(72), 1e-3);
    assert_true(blocked->light.x == 0);
    assert_int_equal(free->hit.object, RT_NO_OBJECT);
    assert_near(free->light.x, scene.materials[0].diffuse * scene.materials[0].color.x * sqrt(0.5), 1e-6);
    assert_near(tree.rays[0].terms[RT_TERM_DIFFUSE].x, free->light.x, 0);
    assert_int_equal(free->level, 1);
}

RT_TEST(a_tree_that_memory_does_not_suffice_for_leaves_nothing_behind) {
    OWNED_SCENE scene = busy_scene();
    assert_ok(rt_scene_sample(&scene, 4, 4, 1, false, error));
    OWNED_ACCEL RtAccel *accel = open_accel(&scene, "bvh");
    RtRayTree tree;
    assert_fails_cleanly(rt_ray_trees_trace(&tree, accel, &(RtSample){1, 1}, 1, 8, error),
                         rt_ray_tree_clear(&tree));
}

RT_TESTS(ray_tree, NULL, assert_nothing_is_kept)
