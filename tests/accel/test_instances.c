/* SPDX-License-Identifier: Apache-2.0 */
/* Instances: every accelerator, above and below, answers as the definition says (core/shape/instance.h); ids;
 * matrices at the limits; what is refused; counts; memory. */
#include "crossings_testing.h"
#include "equivalence_testing.h"
#include "instances_testing.h"
#include "random_testing.h"

#include "core/base/random.h"

/* ---- answers ---- */

static RtHit nearest(const RtScene *scene, const char *spec, RtRay ray) {
    OWNED_ACCEL RtAccel *accel = open_valid(scene, spec);
    OWNED_QUERY query = open_query(accel);
    RtHit hit;
    bool blocked;
    assert_true(rt_ray_is_valid(&ray));
    rt_nearest(&query, &ray, 1, &hit, NULL);
    rt_occluded(&query, &ray, 1, &blocked, NULL);
    assert_int_equal(blocked, hit.object != RT_NO_OBJECT);
    return hit;
}

/* As core/shape/instance.h defines it: whatever was hit before, and in whichever order. */
static RtHit by_definition(const RtGeometry *g, const RtRay *ray) {
    RtPreparedRay prepared;
    RtHit best = RT_MISS;
    rt_hit_ray(&prepared, g, ray, hit_memory_of_tests());
    for (uint32_t id = g->object_count; id-- > 0;) {
        RtHit hit = {0, id};
        if (rt_is_instance(g, id)) {
            const RtInstance *instance = &g->instances[rt_ref_index(g->objects[id])];
            RtRay inside;
            float near, far;
            rt_box_own_span(&g->boxes[id], &prepared, &near, &far);
            if (!(near <= far && near <= ray->tmax && far >= ray->tmin)) continue;
            if (!rt_instance_enter(instance, ray, &inside)) continue;
            hit = by_definition(instance->geometry, &inside);
            if (hit.object == RT_NO_OBJECT) continue;
            hit.object += instance->first;
            hit.t = hit.t < near ? near : hit.t > far ? far : hit.t;
        } else if (!rt_object_hit(g, id, &prepared, &hit.t, NULL)) {
            continue;
        }
        if (rt_hit_before(hit.t, hit.object, best)) best = hit;
    }
    return best;
}

static const char *const specs[] = {
    "bvh",
    "bvh:build=spatial,alpha=0",
    "grid:overlap=exact",
    "grid:density=8,depth=3",
    "octree:max_leaf_size=1",
    "octree:traversal=points,max_leaf_size=1",
    "kd:overlap=exact",
    "wide:build=spatial,alpha=0",
    "wide:packets=16,sharing=0",
    "wide:packets=0,in_flight=1",
    "clusters",
    "clusters:extent=slabs",
    "extents:kind=obb",
    "extents:kind=sphere",
    "extents:lanes=1",
    "ideal",
    "cache+bvh",
    "bvh/grid",
    "wide/kd",
    "wide:sharing=0/wide:sharing=0",
    "grid/octree",
    "kd/clusters",
    "octree/wide:packets=16,sharing=0",
    "cache+wide:in_flight=64,packets=0/wide:in_flight=64,packets=0",
    "brute/extents:kind=slabs",
    "ideal/wide",
    "item+bvh/grid",
    "cache+light:cells=20,longest=3+item+wide/wide",
#ifdef RT_WITH_EMBREE
    "embree:mode=user",
    "embree:mode=user,query=16/grid",
    "wide/embree:mode=user,query=8",
#endif
};

/* Brute answers as the definition says, and all others as brute. */
static void assert_exact(const FamilyBench *bench) {
    for (size_t i = 0; i < bench->reference.count; i++) {
        const RtHit hit = by_definition(&bench->scene.geometry, &bench->rays[i]),
                    got = bench->reference.hits[i];
        if (hit.object == got.object && memcmp(&hit.t, &got.t, sizeof hit.t) == 0) continue;
        fail_msg("%s, ray %zu: object %u at %a is %u at %a", bench->scene.name, i, got.object, (double)got.t,
                 hit.object, (double)hit.t);
    }
    for (size_t i = 0; i < sizeof specs / sizeof specs[0]; i++) assert_gives(&bench->reference, specs[i]);
}

static void assert_exact_on(RtScene scene, size_t rays) {
    OWNED_BENCH bench = {.scene = scene};
    set_up_rays(&bench, 5, rays);
    assert_exact(&bench);
}

RT_TEST(every_accelerator_above_and_below_answers_as_the_definition_says) {
    static const char *const kinds[] = {"instanced", "instanced-far"};
    for (uint64_t i = 0; i < RT_SHARE(8, 2); i++) {
        OWNED_BENCH bench;
        set_up_family(&bench, scene_family(kinds[i % 2]), 1 + i / 2, RT_SHARE(60, 12));
        assert_exact(&bench);
    }
}

RT_TEST(instances_may_be_nested_eight_deep) {
    const RtScene scene = nested(8);
    assert_int_equal(scene.geometry.nesting, 8);
    assert_exact_on(scene, RT_SHARE(20, 4));
}

/* Each voxel would enter them again, at each level. */
RT_TEST(nested_instances_need_a_mailbox) {
    static const char *const without[] = {"grid:mailbox=off", "kd:mailbox=off", "octree:mailbox=off",
                                          "bvh/grid:mailbox=off"};
    OWNED_SCENE one_level = nested(1), two_levels = nested(2), three_levels = nested(3);
    rt_accel_destroy(open_valid(&two_levels, without[3]));
    for (size_t i = 0; i < 4; i++) {
        RtAccel *accel = NULL;
        rt_accel_destroy(open_valid(&one_level, without[i]));
        assert_bad_input(rt_accel_open(without[i], &three_levels, &accel, error),
                         "instances in instances need mailbox=on");
    }
}

RT_TEST(instances_may_share_faces) {
    RtScene scene = begin_scene(), part = begin_scene();
    for (uint32_t i = 0; i < 6; i++) { /* the sides of a unit cube */
        const uint32_t w = i / 2, u = (w + 1) % 3, v = (w + 2) % 3;
        RtVec3 corners[4] = {{{0, 0, 0}}, {{0, 0, 0}}, {{0, 0, 0}}, {{0, 0, 0}}};
        for (int k = 0; k < 4; k++) {
            corners[k].at[w] = (float)(i % 2);
            corners[k].at[u] = k == 1 || k == 2;
            corners[k].at[v] = k >= 2;
        }
        assert_ok(rt_scene_add_polygon(&part, 0, corners, 4, error));
    }
    add_part(&scene, &part);
    for (int i = 0; i < 27; i++) place(&scene, &scene, 0, moved(i % 3, i / 3 % 3, i / 9));
    assert_ok(rt_scene_finish(&scene, error));
    assert_exact_on(scene, RT_SHARE(100, 20));
}

RT_TEST(scales_from_a_millionth_to_a_million_are_exact) {
    static const double scales[] = {1e-6, 1e-4, 1, 3e4, 1e6};
    for (size_t i = 0; i < sizeof scales / sizeof scales[0]; i++) {
        RtScene scene = one_ball(scaled(scales[i], scales[i], scales[i]));
        const float far = (float)(3 * scales[i]);
        const RtHit hit = nearest(&scene, "bvh", ray_along(rt_vec3(0, 0, far), rt_vec3(0, 0, -1)));
        assert_int_equal(hit.object, 0);
        assert_true(fabs((double)hit.t - 2 * scales[i]) < 1e-6 * scales[i]);
        assert_exact_on(scene, 10);
    }
    assert_exact_on(one_ball(scaled(1, 1e-3, 1e3)), 20);
}

/* A strong shear far from the zero of coordinates moves rays by roundings that exceed the pad of extents for
 * other shapes; what is hit is within the thickness of the box all the same. */
RT_TEST(extents_are_wide_enough_for_the_rounding_of_moved_rays) {
    const float c = 98304, shear = 100;
    RtScene part = begin_scene();
    OWNED_BENCH bench = {.scene = begin_scene()};
    enum { RAYS = 7 * 64 };
    RtVec3 v[4];
    for (int k = 0; k < 4; k++)
        v[k] = rt_vec3(c - shear * c + (float)(k == 1 || k == 2), c, c + (float)(k >= 2));
    assert_ok(rt_scene_add_polygon(&part, 0, v, 4, error));
    add_part(&bench.scene, &part);
    place(&bench.scene, &bench.scene, 0, sheared((double)shear));
    assert_ok(rt_scene_finish(&bench.scene, error));
    bench.brute = open_accel(&bench.scene, "brute");
    bench.rays = rt_alloc(RAYS, sizeof(RtRay));
    assert_true(bench.scene.geometry.box.lo.x == c && bench.scene.geometry.box.hi.x == c + 1);
    for (int i = 0; i < RAYS; i++) { /* along y, within 3 floats of where the polygon ends */
        const float side = i % 2 ? c : c + 1;
        bench.rays[i] = ray_along(rt_vec3(side + (float)(i % 7 - 3) / 128, c - (float)(i / 7) / 8, c + 0.5f),
                                  rt_vec3(0, 1, 0));
    }
    assert_ok(rt_reference_init(&bench.reference, bench.brute, bench.rays, RAYS, 0, error));
    assert_exact(&bench);
}

/* In a part that is far from its own zero, hits are off by thousands of times the thickness of the box: t is
 * clamped to it, so the instance is before a polygon just behind it, though the moved ray ends at that. */
RT_TEST(a_hit_beyond_the_box_of_the_instance_is_moved_into_it) {
    const float far = 131072, at[2] = {0.5f, 0.50001f};
    RtScene part = begin_scene();
    OWNED_BENCH bench = {.scene = begin_scene()};
    enum { RAYS = 256 };
    int beyond = 0;
    for (int k = 0; k < 2; k++) {
        RtVec3 v[4];
        for (int i = 0; i < 4; i++)
            v[i] = rt_vec3(k == 0 ? far + at[k] : at[k], i == 1 || i == 2 ? 1 : -1, i >= 2 ? 1 : -1);
        assert_ok(rt_scene_add_polygon(k == 0 ? &part : &bench.scene, 0, v, 4, error));
    }
    add_part(&bench.scene, &part);
    place(&bench.scene, &bench.scene, 0, moved(-(double)far, 0, 0));
    assert_ok(rt_scene_finish(&bench.scene, error));
    bench.brute = open_accel(&bench.scene, "brute");
    bench.rays = rt_alloc(RAYS, sizeof(RtRay));
    for (int i = 0; i < RAYS; i++)
        bench.rays[i] = ray_along(rt_vec3(-1 - (float)i / 1000, 0.1f, 0.2f), rt_vec3(1, 0, 0));
    assert_ok(rt_reference_init(&bench.reference, bench.brute, bench.rays, RAYS, 0, error));
    for (int i = 0; i < RAYS; i++) {
        const double exact = 0.5 - (double)bench.rays[i].org.x;
        const double moved_by = (double)(float)((double)bench.rays[i].org.x + (double)far) - (double)far;
        assert_int_equal(bench.reference.hits[i].object, 1);
        assert_true(fabs((double)bench.reference.hits[i].t - exact) < 5e-6);
        beyond += 0.5 - moved_by > exact + 1e-4;
    }
    assert_true(beyond > RAYS / 4);
    assert_exact(&bench);
}

static double shift(const RtBox *box, const RtRay *ray, int axis) {
    return (double)rt_thickness(ray->org, box) + 0x1p-23 * fabs((double)ray->org.at[axis]);
}

/* What clamping moves t by, at most, and what it did: of an instance alone in a scene. */
static double part_of_clamp_bound(const RtGeometry *g, const RtRay *ray) {
    const RtInstance *instance = &g->instances[0];
    RtPreparedRay prepared;
    RtRay inside;
    float near, far;
    rt_hit_ray(&prepared, g, ray, hit_memory_of_tests());
    rt_box_own_span(&g->boxes[0], &prepared, &near, &far);
    if (!(near <= far) || !rt_instance_enter(instance, ray, &inside)) return 0;
    const RtHit hit = by_definition(instance->geometry, &inside);
    if (hit.object == RT_NO_OBJECT || (hit.t >= near && hit.t <= far)) return 0;
    const bool before = hit.t < near;
    const double end = (double)(before ? near : far);
    double off = HUGE_VAL, share = 0;
    for (int a = 0; a < 3; a++) {
        const double dir = (double)ray->dir.at[a], outer = shift(&g->boxes[0], ray, a);
        const bool low = before == (dir > 0);
        const double plane =
            low ? (double)g->boxes[0].lo.at[a] - outer : (double)g->boxes[0].hi.at[a] + outer;
        const double beside = fabs((plane - (double)ray->org.at[a]) / dir - end);
        double bound = -0.75 * outer;
        for (int b = 0; b < 3; b++)
            bound += 1.75 * fabs(instance->to_world.m[a][b]) *
                     shift(&instance->geometry->boxes[hit.object], &inside, b);
        if (!(beside < off)) continue; /* t ends in the nearest plane */
        off = beside;
        share = bound > 0 ? fabs(end - (double)hit.t) * fabs(dir) / bound : HUGE_VAL;
    }
    return share;
}

RT_TEST(clamping_moves_a_hit_by_no_more_than_is_proved) {
    double most = 0;
    uint32_t clamped = 0;
    for (uint64_t i = 0; i < 40000; i++) {
        RtRandom random = rt_random(31, i);
        const float far = ldexpf(1, (int)rt_random_below(&random, 20));
        const RtVec3 center = rt_scale(rt_random_point(&random, 1), far);
        RtTransform at = i % 3 ? rt_transform_identity() : sheared(rt_random_betweend(&random, -9, 9));
        RtVec3 axis = {{0, 0, 0}};
        OWNED_SCENE scene = begin_scene();
        RtScene part = begin_scene();
        RtVec3 v[3];
        for (int k = 0; k < 3; k++) v[k] = rt_add(center, rt_random_point(&random, 1));
        axis.at[i % 3] = 1;
        for (int k = 0; k < 3 && i % 2; k++) v[k].at[i % 3] = center.at[i % 3];
        if (rt_scene_add_triangle(&part, 0, v, NULL, &(RtError){RT_OK, ""}) != RT_OK) continue;
        add_part(&scene, &part);
        const RtVec3d here = rt_transform_pointd(&at, rt_widen(center));
        for (int a = 0; a < 3; a++) at.m[a][3] = -here.at[a];
        place(&scene, &scene, 0, at);
        assert_ok(rt_scene_finish(&scene, error));
        const RtVec3 from = rt_scale(rt_random_point(&random, 1), 1 + (float)(i % 5));
        RtRay ray = ray_along(from, i % 4 ? rt_scale(axis, from.at[i % 3] > 0 ? -1 : 1)
                                          : rt_sub(rt_random_point(&random, 0.3f), from));
        if (!rt_ray_is_valid(&ray)) continue;
        const double share = part_of_clamp_bound(&scene.geometry, &ray);
        clamped += share > 0;
        most = fmax(most, share);
    }
    print_message("%u hits are clamped, by up to %.3f of the bound\n", clamped, most);
    assert_true(most <= 1 && most > 0.2 && clamped > 20);
}

/* ---- ids ---- */

RT_TEST(ids_are_places_in_the_flattened_order) {
    OWNED_SCENE scene = begin_scene();
    RtScene a = begin_scene(), b = begin_scene();
    add_ball(&a, 0, 0, 0, 1), add_ball(&a, 4, 0, 0, 1);
    add_part(&scene, &a);
    add_ball(&b, 0, 0, 0, 1);
    place(&b, &scene, 0, moved(4, 0, 0)), place(&b, &scene, 0, moved(12, 0, 0));
    add_part(&scene, &b);
    add_ball(&scene, 0, 0, 0, 1);
    place(&scene, &scene, 1, moved(4, 0, 0)), place(&scene, &scene, 0, moved(24, 0, 0));
    assert_ok(rt_scene_finish(&scene, error));
    OWNED_SCENE flat;
    assert_ok(rt_scene_flatten(&scene, &flat, error));
    assert_int_equal(rt_geometry_id_count(&scene.geometry), 8);
    assert_int_equal(flat.geometry.object_count, 8);
    for (uint32_t id = 0; id < 8; id++) {
        static const uint32_t holders[] = {0, 1, 1, 1, 1, 1, 2, 2}, inside[] = {0, 0, 0, 1, 0, 1, 0, 1};
        const RtRay ray = ray_along(rt_vec3(4 * (float)id, 0, 9), rt_vec3(0, 0, -1));
        RtPlace at;
        assert_int_equal(nearest(&scene, "wide/grid", ray).object, id);
        assert_int_equal(nearest(&flat, "bvh", ray).object, id);
        assert_int_equal(rt_geometry_holder(&scene.geometry, id), holders[id]);
        rt_scene_place(&scene, id, &ray, &at);
        assert_int_equal(at.object, inside[id]);
        assert_ptr_equal(at.scene, id == 0 ? &scene : scene.parts[id == 1]);
        assert_true(at.ray.org.x + (float)at.to_world.m[0][3] == ray.org.x);
    }
}

RT_TEST(of_a_thousand_instances_that_coincide_the_first_is_hit) {
    RtScene scene = begin_balls();
    for (int i = 0; i < RT_SHARE(1000, 200); i++) place(&scene, &scene, 0, rt_transform_identity());
    assert_ok(rt_scene_finish(&scene, error));
    assert_ok(rt_scene_sample(&scene, 8, 8, 1, false, error)); /* item draws them all at each sample */
    for (size_t i = 0; i < sizeof specs / sizeof specs[0]; i++)
        assert_int_equal(nearest(&scene, specs[i], ray_along(rt_vec3(0, 0, 9), rt_vec3(0, 0, -1))).object, 0);
    assert_exact_on(scene, 1);
}

/* Sheared, their boxes bound them more tightly than their parts' reach does. */
RT_TEST(extents_contain_sheared_instances) {
    static const char *const extents[] = {"extents", "extents:kind=obb", "extents:kind=sphere", "clusters",
                                          "clusters:extent=obb"};
    OWNED_SCENE scene = open_scene("family:kind=instanced-far,seed=328");
    for (size_t i = 0; i < sizeof extents / sizeof extents[0]; i++) describe_spec(&scene, extents[i]);
}

RT_TEST(a_million_coincident_instances_are_built_and_answer) {
    OWNED_SCENE scene = begin_balls();
    for (int i = 0; i < RT_SHARE(1000000, 10000); i++) place(&scene, &scene, 0, rt_transform_identity());
    assert_ok(rt_scene_finish(&scene, error));
    const RtHit hit = nearest(&scene, "bvh", ray_along(rt_vec3(0, 0, 9), rt_vec3(0, 0, -1)));
    assert_int_equal(hit.object, 0);
    assert_true(hit.t == 8);
}

RT_TEST(an_instance_of_a_part_without_objects_is_left_out) {
    RtScene scene = begin_balls(), empty = begin_scene();
    const uint32_t nothing = add_part(&scene, &empty);
    place(&scene, &scene, nothing, moved(1, 2, 3));
    place(&scene, &scene, 0, rt_transform_identity());
    place(&scene, &scene, nothing, moved(1, 2, 3));
    assert_ok(rt_scene_finish(&scene, error));
    assert_int_equal(scene.geometry.object_count, 1);
    assert_int_equal(rt_geometry_id_count(&scene.geometry), 1);
    assert_exact_on(scene, 10);
}

/* ---- refused ---- */

static RtStatus try_matrix(RtTransform at, RtError *error) {
    OWNED_SCENE scene = begin_balls();
    return rt_scene_add_instance(&scene, &scene, 0, &at, RT_OWN_MATERIALS, error);
}

RT_TEST(a_matrix_that_rounding_would_spoil_is_refused) {
    assert_ok(try_matrix(sheared(998.9), error));
    assert_bad_input(try_matrix(sheared(999.5), error), "at most a factor of 1e6 apart");
    assert_ok(try_matrix(scaled(1, 1, 1e6), error));
    assert_ok(try_matrix(scaled(1e-6, 1, 1), error));
    assert_ok(try_matrix(scaled((double)1e-6f, (double)1e-6f, (double)1e-6f), error)); /* as a float32 */
    assert_bad_input(try_matrix(scaled(1, 1, 1.01e6), error), "between 1e-6 and 1e6");
    assert_bad_input(try_matrix(scaled(0.99e-6, 1, 1), error), "between 1e-6 and 1e6");
    assert_bad_input(try_matrix(scaled(1e-4, 1, 1e3), error), "at most a factor of 1e6 apart");
    assert_ok(try_matrix(scaled(1, 1, -1), error));
    assert_bad_input(try_matrix(scaled(1, 0, 1), error), "can be undone");
    assert_bad_input(try_matrix(scaled(1, NAN, 1), error), "can be undone");
    assert_bad_input(try_matrix(scaled(INFINITY, 1, 1), error), "can be undone");
    assert_bad_input(try_matrix(moved(0, NAN, 0), error), "can be undone");
    assert_exact_on(one_ball(sheared(998.9)), 20);
}

RT_TEST(an_instance_beyond_the_largest_coordinate_is_refused) {
    assert_ok(try_matrix(moved(4e17, 0, 0), error));
    assert_bad_input(try_matrix(moved(0, -6e17, 0), error), "exceeds 5e+17");
    assert_bad_input(try_matrix(moved(0, 0, 1e300), error), "exceeds 5e+17");
}

RT_TEST(an_object_after_an_instance_is_refused) {
    OWNED_SCENE scene = one_ball(rt_transform_identity());
    assert_bad_input(rt_geometry_add_sphere(&scene.geometry, rt_vec3(0, 0, 0), 1, error),
                     "instances come after all other objects");
}

RT_TEST(too_many_levels_are_refused) {
    OWNED_SCENE scene = begin_balls();
    const RtTransform here = rt_transform_identity();
    for (uint32_t level = 1; level <= RT_MAX_NESTING; level++) {
        RtScene part = begin_scene();
        place(&part, &scene, level - 1, here);
        add_part(&scene, &part);
    }
    assert_bad_input(rt_scene_add_instance(&scene, &scene, RT_MAX_NESTING, &here, RT_OWN_MATERIALS, error),
                     "more than 16 levels");
    place(&scene, &scene, RT_MAX_NESTING - 1, here);
    assert_ok(rt_scene_finish(&scene, error));
    assert_int_equal(nearest(&scene, "wide/wide", ray_along(rt_vec3(0, 0, 9), rt_vec3(0, 0, -1))).object, 0);
}

RT_TEST(more_objects_than_ids_are_refused) {
    OWNED_SCENE scene = begin_balls();
    const RtTransform here = rt_transform_identity();
    for (uint32_t level = 1; level < 8; level++) { /* 16^7 balls */
        RtScene part = begin_scene();
        for (int i = 0; i < 16; i++) place(&part, &scene, level - 1, here);
        add_part(&scene, &part);
    }
    for (int i = 0; i < 15; i++) place(&scene, &scene, 7, here);
    assert_bad_input(rt_scene_add_instance(&scene, &scene, 7, &here, RT_OWN_MATERIALS, error),
                     "more than 4e9 objects");
    assert_int_equal(rt_geometry_id_count(&scene.geometry), 15U << 28);
    for (int i = 0; i < 15; i++) place(&scene, &scene, 6, here);
    assert_ok(rt_scene_finish(&scene, error));
    const RtRay ray = ray_along(rt_vec3(0, 0, 9), rt_vec3(0, 0, -1));
    RtPlace at;
    rt_scene_place(&scene, (15U << 28) + (15U << 24) - 1, &ray, &at);
    assert_int_equal(at.object, 0);
    assert_ptr_equal(at.scene, scene.parts[0]);
}

RT_TEST(an_accelerator_that_is_not_of_parts_cannot_stand_after_a_slash) {
    static const char *const wrong[] = {"bvh/cache", "bvh/item"};
    RtSpec spec;
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        RtError why = {RT_OK, ""};
        const RtStatus status = rt_spec_parse(wrong[i], &spec, &why);
        assert_int_equal(status, RT_BAD_INPUT);
        assert_non_null(strstr(why.message, "cannot stand after a '/'"));
    }
    assert_bad_input(rt_spec_parse("bvh/", &spec, error), "is not the spec");
    assert_bad_input(rt_spec_parse("bvh/grid/kd", &spec, error), "");
    assert_bad_input(rt_spec_parse("/bvh", &spec, error), "is not the spec");
}

/* ---- rays that leave the numbers ---- */

RT_TEST(a_ray_that_is_not_valid_in_the_part_misses) {
    RtScene scene = one_ball(scaled(1e-6, 1e-6, 1e-6));
    const RtVec3 down = rt_vec3(0, 0, -1);
    const uint32_t missed = RT_NO_OBJECT;
    assert_int_equal(nearest(&scene, "bvh", ray_along(rt_vec3(0, 0, 4e11f), down)).object, 0);
    assert_int_equal(nearest(&scene, "bvh", ray_along(rt_vec3(0, 0, 6e11f), down)).object, missed);
    assert_int_equal(nearest(&scene, "bvh", ray_along(rt_vec3(0, 0, 9), rt_vec3(0, 0, -3e38f))).object,
                     missed);
    rt_scene_clear(&scene);
    scene = one_ball(scaled(1e6, 1e6, 1e6));
    assert_int_equal(nearest(&scene, "bvh", ray_along(rt_vec3(0, 0, 2e6f), rt_vec3(0, 0, -1e-38f))).object,
                     missed);
    rt_scene_clear(&scene);
}

RT_TEST(the_interval_of_a_ray_is_closed_in_a_part_too) {
    OWNED_SCENE scene = one_ball(moved(0, 0, 1));
    RtRay ray = ray_along(rt_vec3(0, 0, 4), rt_vec3(0, 0, -1)); /* hits at 2 and 4 */
    for (size_t i = 0; i < sizeof specs / sizeof specs[0]; i++) {
        const struct {
            float tmin, tmax, t;
        } rows[] = {{0, 2, 2},           {2, 2, 2}, {2.5f, 4, 4}, {2.5f, 3.5f, INFINITY},
                    {0, 1.5f, INFINITY}, {4, 4, 4}};
        for (size_t k = 0; k < sizeof rows / sizeof rows[0]; k++) {
            ray.tmin = rows[k].tmin, ray.tmax = rows[k].tmax;
            assert_true(nearest(&scene, specs[i], ray).t == rows[k].t);
        }
    }
}

/* ---- counts ---- */

static RtTally count(const RtAccel *accel, RtRay ray, bool any) {
    OWNED_QUERY query = open_query(accel);
    RtTally tallies[RT_RAY_KIND_COUNT] = {{0}};
    RtHit hit;
    bool blocked;
    rt_query_begin(&query);
    if (any)
        rt_occluded(&query, &ray, 1, &blocked, tallies);
    else
        rt_nearest(&query, &ray, 1, &hit, tallies);
    for (uint32_t kind = 0; kind < RT_RAY_KIND_COUNT; kind++) {
        if (kind != ray.kind) assert_tally("another kind", &tallies[kind], &(RtTally){0});
    }
    return tallies[ray.kind];
}

/* A ball, and two instances of a part of two balls: one below the other, and one aside. */
static RtScene counted_scene(void) {
    RtScene scene = begin_scene(), part = begin_scene();
    add_ball(&part, 0, 0, 0, 1), add_ball(&part, 0, 0, -4, 1);
    add_part(&scene, &part);
    add_ball(&scene, 0, 0, -9, 1);
    place(&scene, &scene, 0, rt_transform_identity()), place(&scene, &scene, 0, moved(50, 0, 0));
    assert_ok(rt_scene_add_light(&scene, rt_vec3(0, 0, -20), rt_vec3(1, 1, 1), error));
    assert_ok(rt_scene_finish(&scene, error));
    return scene;
}

RT_TEST(a_ray_counts_once_and_tests_in_parts_count) {
    OWNED_SCENE scene = counted_scene();
    RtRay ray = ray_along(rt_vec3(0, 0, 9), rt_vec3(0, 0, -1));
    ray.kind = RT_RAY_REFLECTION;
    OWNED_ACCEL RtAccel *brute = open_accel(&scene, "brute");
    RtTally got = count(brute, ray, false);
    /* The ball, both instances, and the part's balls, which are both nearer than the ball. */
    assert_tally(
        "brute", &got,
        &(RtTally){.rays = 1, .hits = 1, .object_tests = 5, .object_hits = 3, .instances_entered = 1});
    got = count(brute, ray, true);
    assert_tally("any", &got, &(RtTally){.rays = 1, .hits = 1, .object_tests = 1, .object_hits = 1});
    ray.org.x = 50;
    ray.kind = RT_RAY_OCCLUSION;
    got = count(brute, ray, true);
    assert_tally(
        "aside", &got,
        &(RtTally){.rays = 1, .hits = 1, .object_tests = 4, .object_hits = 1, .instances_entered = 1});
    ray.org.x = 20;
    got = count(brute, ray, false);
    assert_tally("missed", &got, &(RtTally){.rays = 1, .object_tests = 3});
}

RT_TEST(ideal_tests_the_instance_that_holds_the_answer) {
    OWNED_SCENE scene = counted_scene();
    const RtRay ray = ray_along(rt_vec3(50, 0, 9), rt_vec3(0, 0, -1));
    OWNED_ACCEL RtAccel *accel = open_accel(&scene, "ideal/brute");
    OWNED_QUERY query = open_query(accel);
    RtHit hit;
    rt_nearest(&query, &ray, 1, &hit, NULL);
    assert_int_equal(hit.object, 3);
    assert_ok(rt_accel_learn(accel, &ray, &hit, 1, error));
    assert_ok(rt_accel_validate(accel, error));
    RtTally tallies[RT_RAY_KIND_COUNT] = {{0}};
    rt_nearest(&query, &ray, 1, &hit, tallies);
    assert_int_equal(hit.object, 3);
    assert_int_equal(tallies[0].object_tests, 3);
}

RT_TEST(the_shadow_cache_remembers_an_instance) {
    OWNED_SCENE scene = counted_scene();
    OWNED_ACCEL RtAccel *accel = open_accel(&scene, "cache+brute");
    OWNED_QUERY query = open_query(accel);
    RtTally tallies[RT_RAY_KIND_COUNT] = {{0}};
    RtRay ray = shadow_ray(&scene, rt_vec3(0, 0, 9), 0);
    ray.org.x = ray.dir.x = 50, ray.dir.x = 0;
    bool blocked;
    for (uint64_t i = 0; i < 3; i++) {
        rt_occluded(&query, &ray, 1, &blocked, tallies);
        assert_true(blocked);
        assert_int_equal(tallies[RT_RAY_SHADOW].passed_on, 1);
        assert_int_equal(tallies[RT_RAY_SHADOW].rays, i + 1);
        /* The ball and the first instance only once; then the second, and one ball of its part. */
        assert_int_equal(tallies[RT_RAY_SHADOW].object_tests, 4 + 2 * i);
    }
}

RT_TEST(parts_are_described_once_and_builds_include_them) {
    OWNED_SCENE scene = counted_scene();
    OWNED_ACCEL RtAccel *accel = open_valid(&scene, "bvh/grid:resolution=1x1x3");
    RtDescription description;
    rt_accel_describe(accel, &description);
    const RtDescription above = describe_spec(&scene, "bvh/brute");
    assert_int_equal(description.leaves, above.leaves + 3);
}

/* ---- the rays of verify ---- */

/* Rays of a family over a scene. */
static void fill(const RtScene *scene, const char *name, RtRay *rays, size_t count) {
    OWNED_ACCEL RtAccel *brute = open_accel(scene, "brute");
    OWNED_QUERY query = open_query(brute);
    size_t family = 0;
    while (strcmp(rt_ray_family_name(family), name) != 0) assert_true(++family < rt_ray_family_count());
    rt_ray_family_fill(family, &query, 1, 0, count, rays);
}

enum { SOME = 200 };

RT_TEST(rays_touch_the_surfaces_of_objects_in_instances) {
    OWNED_SCENE scene = begin_scene();
    RtScene part = begin_scene();
    const RtVec3 v[3] = {{{0, 0, 0}}, {{1, 0, 0}}, {{0, 1, 0}}};
    RtTransform at = rt_transform_identity();
    RtRay rays[SOME];
    assert_ok(rt_scene_add_triangle(&part, 0, v, NULL, error));
    add_part(&scene, &part);
    assert_ok(rt_transform_rotate(&at, rt_vec3(1, 2, 3), 70, error));
    place(&part, &scene, 0, at);
    add_part(&scene, &part);
    place(&scene, &scene, 1, sheared(2));
    assert_ok(rt_scene_finish(&scene, error));
    const RtTransform skew = sheared(2), both = rt_transform_compose(&at, &skew);
    const RtVec3d normal = rt_normalized(rt_transform_normald(&both, rt_vec3d(0, 0, 1)));
    fill(&scene, "tangent", rays, SOME);
    for (int i = 0; i < SOME; i++)
        assert_true(fabs(rt_dotd(normal, rt_normalized(rt_widen(rays[i].dir)))) < 1e-6);
}

RT_TEST(rays_start_on_the_boxes_of_objects_in_instances) {
    OWNED_SCENE scene = begin_scene();
    RtScene part = begin_scene();
    RtRay rays[SOME];
    int on_inner = 0;
    for (int i = 0; i < 3; i++) add_ball(&part, 8 * (float)i, 0, 0, 1);
    add_part(&scene, &part);
    place(&scene, &scene, 0, moved(3, 0, 0));
    assert_ok(rt_scene_finish(&scene, error));
    fill(&scene, "from-box-face", rays, SOME);
    for (int i = 0; i < SOME; i++) on_inner += rays[i].org.x == 10 || rays[i].org.x == 12;
    assert_true(on_inner > 3);
}

/* ---- memory ---- */

RT_TEST(a_shortage_of_memory_is_a_status_and_leaks_nothing) {
    OWNED_SCENE scene = open_family(scene_family("instanced"), 1);
    static const char *const tried[] = {"brute", "cache+grid/kd", "wide/clusters", "octree/extents",
                                        "light:cells=20+item+bvh"};
    for (size_t i = 0; i < sizeof tried / sizeof tried[0]; i++)
        assert_fails_cleanly(try_accel(&scene, tried[i], error), (void)0);
    assert_failed_allocations_are_reported("family:kind=instanced");
}

RT_TEST(nothing_is_allocated_while_rays_enter_instances) {
    OWNED_BENCH bench;
    set_up_family(&bench, scene_family("instanced"), 2, 4);
    const size_t rays = bench.reference.count;
    OWNED_MEMORY RtHit *hits = rt_alloc(rays, sizeof(RtHit));
    for (size_t i = 0; i < sizeof specs / sizeof specs[0]; i++) {
        OWNED_ACCEL RtAccel *accel = open_accel(&bench.scene, specs[i]);
        OWNED_QUERY query = open_query(accel);
        RtTally tallies[RT_RAY_KIND_COUNT] = {{0}};
        rt_alloc_fail_at(1);
        rt_nearest(&query, bench.rays, rays, hits, i % 2 ? tallies : NULL);
        assert_null(rt_alloc(1, 1)); /* the first one asked for */
        assert_memory_equal(hits, bench.reference.hits, rays * sizeof *hits);
    }
}

RT_TESTS(instances, NULL, assert_nothing_is_kept)
