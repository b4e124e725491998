/* SPDX-License-Identifier: Apache-2.0 */
/* accel/extents: counters by hand, what describe tells, a broken extent found, and that every kind of extent
 * is exact where hits are least certain. */
#include "equivalence_testing.h"
#include "random_testing.h"

#include "accel/extents/extents.h"

static const char *const specs[] = {"extents:kind=box",           "extents:kind=box,lanes=1",
                                    "extents:kind=sphere",        "extents:kind=obb",
                                    "extents:kind=slabs,slabs=3", "extents:kind=slabs,slabs=7",
                                    "extents:kind=slabs,slabs=13"};
enum { SPEC_COUNT = sizeof specs / sizeof specs[0] };

/* ---- counters by hand ---- */

static RtTally count(const RtScene *scene, const char *spec, RtVec3 org, RtVec3 dir, bool any) {
    RtTally tallies[RT_RAY_KIND_COUNT] = {0};
    RtRay ray = {.org = org, .dir = dir, .tmin = 0, .tmax = INFINITY};
    RtHit hit;
    uint32_t occluder;
    OWNED_ACCEL RtAccel *accel = open_accel(scene, spec);
    OWNED_QUERY query = open_query(accel);
    rt_trace_stream(accel, query.scratch, &ray, 1, any ? NULL : &hit, &occluder, tallies);
    return tallies[RT_RAY_PRIMARY];
}

RT_TEST(a_ray_along_three_spheres_tests_three_extents_and_the_objects_not_yet_beyond_its_hit) {
#define HITS(extents, tests)                                                                                 \
    {                                                                                                        \
        .rays = 1, .hits = 1, .extent_tests = (extents), .steps = (extents), .object_tests = (tests),        \
        .object_hits = (tests)                                                                               \
    }
    static const struct {
        float from, to; /* along x */
        bool any;
        RtTally by_hand;
    } rows[] = {{-5, 1, false, HITS(3, 1)},  /* the others begin behind the first hit */
                {25, -1, false, HITS(3, 3)}, /* every one is nearer than the last */
                {25, -1, true, HITS(1, 1)},  /* any hit will do: the first ends the search */
                {5, 1, false, HITS(3, 1)}};  /* from between the first two: the first is behind */
    OWNED_SCENE scene = make_row(3, 10);
    for (int s = 0; s < SPEC_COUNT; s++) {
        for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
            const RtTally tally =
                count(&scene, specs[s], rt_vec3(rows[i].from, 0, 0), rt_vec3(rows[i].to, 0, 0), rows[i].any);
            assert_tally(specs[s], &tally, &rows[i].by_hand);
        }
    }
}

RT_TEST(a_ray_by_the_corner_of_the_boxes_meets_the_boxes_only) {
    OWNED_SCENE scene = make_row(3, 10);
    RtVec3 org = rt_vec3(-5, 0.9f, 0.9f), dir = rt_vec3(1, 0, 0);
    static const uint64_t object_tests[SPEC_COUNT] = {3, 3, 0, 3, 3, 0, 0};
    for (int s = 0; s < SPEC_COUNT; s++) {
        RtTally tally = count(&scene, specs[s], org, dir, false);
        assert_int_equal(tally.hits, 0);
        assert_int_equal(tally.extent_tests, 3);
        assert_int_equal(tally.object_tests, object_tests[s]);
    }
}

/* ---- describe and validate ---- */

static void count_box(void *context, const RtBoxView *view) {
    assert_true(view->depth == 0 && view->leaf);
    ++*(uint32_t *)context;
}

RT_TEST(describe_tells_references_bytes_and_expected_tests_and_each_box_is_shown) {
    OWNED_SCENE scene = make_row(3, 10);
    /* The scene's box is 22 x 2 x 2, of half area 92; a sphere's box has 12, a sphere 2 pi. */
    static const double expected[SPEC_COUNT] = {
        36.0 / 92, 36.0 / 92, 6 * 3.14159265358979 / 92, 36.0 / 92, NAN, NAN, NAN};
    static const size_t each[SPEC_COUNT] = {0,
                                            0,
                                            sizeof(RtBall),
                                            sizeof(RtOrientedBox),
                                            3 * sizeof(RtSlab),
                                            7 * sizeof(RtSlab),
                                            13 * sizeof(RtSlab)};
    for (int s = 0; s < SPEC_COUNT; s++) {
        RtDescription description;
        OWNED_ACCEL RtAccel *accel = open_accel(&scene, specs[s]);
        uint32_t boxes = 0;
        accel->ops->describe(accel, &description);
        accel->ops->each_box(accel, (RtBoxViewer){count_box, &boxes});
        assert_int_equal(boxes, 3);
        assert_int_equal(description.references, 3);
        assert_int_equal(description.bytes, 3 * each[s]);
        if (isnan(expected[s]))
            assert_true(isnan(description.predicted_cost));
        else
            assert_true(fabs(description.predicted_cost - expected[s]) < 1e-9);
    }
}

RT_TEST(validate_names_the_extent_that_is_too_small) {
    OWNED_SCENE scene = make_row(3, 10);
    OWNED_ACCEL RtExtents *sphere = open_valid(&scene, "extents:kind=sphere");
    OWNED_ACCEL RtExtents *obb = open_valid(&scene, "extents:kind=obb");
    OWNED_ACCEL RtExtents *slabs = open_valid(&scene, "extents:kind=slabs,slabs=5");
    OWNED_ACCEL RtAccel *box = open_valid(&scene, "extents:kind=box");
    double *radius = &sphere->set.balls[1].radius, *half = &obb->set.oriented[2].half[1];
    RtVec3d *axes = obb->set.oriented[0].axes;
    RtSlab *first = &slabs->set.slabs[0], *last = &slabs->set.slabs[5 + 4];
    assert_broken_by(&sphere->base, *radius, *radius * (1 - 1e-6),
                     "the sphere 1 does not contain object 1 (sphere) along (1, 0, 0)");
    assert_broken_by(&obb->base, *half, *half * (1 - 1e-6),
                     "the oriented box 2 does not contain object 2 (sphere)");
    assert_broken_by(&obb->base, axes[1], axes[0], "the axes of the oriented box 0 are not orthonormal");
    assert_broken_by(&slabs->base, last->hi, last->hi - 0.5f,
                     "the set of slabs 1 does not contain object 1 (sphere)");
    assert_broken_by(&slabs->base, first->lo, NAN,
                     "the set of slabs 0 does not contain object 0 (sphere) along (-1, 0, 0)");
    assert_broken_by(box, scene.geometry.boxes[1].hi.y, 0.5f,
                     "the box 1 does not contain object 1 (sphere) along (0, 1, 0)");
}

/* ---- a soup of everything that is hard ---- */

/* Coplanar to about 1/2000 of its size, the most that is let in: five points about `center`, one of them
 * pulled inward so that the polygon is concave. */
static void add_warped_polygon(RtScene *scene, RtRandom *random, RtVec3 center) {
    RtVec3d u = rt_random_direction(random), v = rt_normalized(rt_crossd(u, rt_random_direction(random)));
    static const float at[5][2] = {{-1, -1}, {1, -1}, {1, 1}, {0, -0.5f}, {-1, 1}};
    RtVec3 vertices[5];
    for (int i = 0; i < 5; i++) {
        RtVec3d p = rt_add_scaledd(rt_widen(center), u, 0.2 * (double)at[i][0]);
        vertices[i] = rt_narrow(rt_add_scaledd(p, v, 0.2 * (double)at[i][1]));
        vertices[i] = rt_add(vertices[i], rt_random_point(random, 1e-4f));
    }
    assert_ok(rt_scene_add_polygon(scene, 0, vertices, 5, error));
}

static void add_triangles(RtScene *scene, RtRandom *random, RtVec3 center) {
    RtVec3 a = rt_add(center, rt_random_point(random, 0.3f)),
           b = rt_add(center, rt_random_point(random, 0.3f));
    RtVec3 ordinary[3] = {center, a, b};
    RtVec3 sliver[3] = {a, b, rt_add(rt_scale(rt_add(a, b), 0.5f), rt_random_point(random, 1e-7f))};
    RtVec3 without_area[3] = {a, a, b};
    assert_ok(rt_scene_add_triangle(scene, 0, ordinary, NULL, error));
    assert_ok(rt_scene_add_triangle(scene, 0, sliver, NULL, error));
    assert_ok(rt_scene_add_triangle(scene, 0, without_area, NULL, error));
}

static void add_cones(RtScene *scene, RtRandom *random, RtVec3 center) {
    RtVec3 apex = rt_add(center, rt_random_point(random, 0.3f));
    RtVec3 just_above = rt_add(center, rt_random_point(random, 1e-6f));
    assert_ok(rt_scene_add_cone(scene, 0, center, 0.1f, apex, 0, error));
    assert_ok(rt_scene_add_cone(scene, 0, center, 0.02f, apex, 0.02f, error));
    if (memcmp(&center, &just_above, sizeof center) == 0) return;
    assert_ok(rt_scene_add_cone(scene, 0, center, 0.3f, just_above, 0.1f, error));
}

static RtScene make_soup(uint64_t seed, float shift) {
    RtRandom random = rt_random(seed, 0);
    RtScene scene = begin_scene();
    for (int i = 0; i < 6; i++) {
        RtVec3 center = rt_add(rt_random_point(&random, 1), rt_vec3(shift, 0, -shift));
        RtRandom again = random;
        for (int copy = 0; copy < 2; copy++) {
            random = again;
            assert_ok(rt_scene_add_sphere(&scene, 0, center, rt_random_between(&random, 1e-3f, 0.2f), error));
            add_warped_polygon(&scene, &random, center);
            add_triangles(&scene, &random, center);
            add_cones(&scene, &random, center);
        }
    }
    assert_ok(rt_scene_finish(&scene, error));
    strcpy(scene.name, "a soup");
    return scene;
}

/* ---- rays ---- */

/* A point that an object touches or nearly touches: its extreme in a random direction, a corner of its
 * box. */
static RtVec3 delicate_point(const RtGeometry *geometry, uint32_t id, RtRandom *random) {
    RtRef ref = geometry->objects[id];
    uint32_t index = rt_ref_index(ref), bits = rt_random_bits(random);
    const RtBox *box = &geometry->boxes[id];
    RtVec3 corner = {bits & 1 ? box->lo.x : box->hi.x, bits & 2 ? box->lo.y : box->hi.y,
                     bits & 4 ? box->lo.z : box->hi.z};
    if (bits & 8) return corner;
    if (bits & 16) return rt_box_center(*box);
    if (rt_ref_shape(ref) == RT_SHAPE_TRIANGLE) return geometry->triangles[index].v[bits % 3];
    if (rt_ref_shape(ref) == RT_SHAPE_POLYGON)
        return geometry->polygon_vertices[geometry->polygons[index].first + bits % 5];
    RtVec3d direction = rt_random_direction(random);
    if (rt_ref_shape(ref) == RT_SHAPE_SPHERE) {
        const RtSphere *sphere = &geometry->spheres[index];
        return rt_narrow(rt_add_scaledd(rt_widen(sphere->center), direction, (double)sphere->radius));
    }
    const RtCone *cone = &geometry->cones[index];
    RtVec3d across = rt_normalized(rt_crossd(direction, cone->axis));
    return rt_narrow(rt_add_scaledd(rt_widen(cone->base), across, (double)cone->base_radius));
}

static RtRay make_ray(const RtGeometry *geometry, RtRandom *random) {
    uint32_t id = rt_random_below(random, geometry->object_count);
    uint32_t other = rt_random_below(random, geometry->object_count);
    RtVec3 target = delicate_point(geometry, id, random), org = delicate_point(geometry, other, random);
    RtVec3d axes[3];
    rt_object_frame(geometry, id, axes);
    uint32_t how = rt_random_bits(random);
    static const float away[] = {0, 1, 10, 1e3f, 1e4f, 1e5f, 1e6f};
    RtVec3d back = rt_scaled(rt_random_direction(random), (double)away[how / 64 % 7]);
    RtRay ray = {.tmin = 0, .tmax = INFINITY, .kind = RT_RAY_RANDOM};
    switch (how % 4) {
    case 0: /* along an axis of the world, from the target's plane or from a box */
        ray.dir.at[how / 4 % 3] = how & 16 ? -1 : 1;
        ray.org = how & 32 ? org : target;
        ray.org.at[how / 4 % 3] = how & 16 ? geometry->box.hi.at[how / 4 % 3] : org.at[how / 4 % 3];
        return ray;
    case 1: /* along an axis of the object: within a triangle's plane, parallel to a cone's axis */
        ray.dir = rt_narrow(axes[how / 4 % 3]);
        ray.org = rt_narrow(rt_add_scaledd(rt_widen(target), axes[how / 4 % 3], -rt_lengthd(back)));
        return ray;
    case 2: /* from one object to another */
        ray.org = org;
        ray.tmax = how & 16 ? 1 : INFINITY;
        break;
    case 3: ray.org = rt_add(target, rt_narrow(back)); break; /* from far away */
    }
    ray.dir = rt_sub(target, ray.org);
    if (ray.dir.x == 0 && ray.dir.y == 0 && ray.dir.z == 0) ray.dir.z = 1;
    return ray;
}

/* ---- exactness ---- */

enum { RAYS = 6000 };

static void compare_with_brute(const RtScene *scene, const RtRay *rays) {
    OWNED(rt_reference_clear) RtReference reference;
    OWNED_ACCEL RtAccel *brute = open_accel(scene, "brute");
    assert_ok(rt_reference_init(&reference, brute, rays, RAYS, 0, error));
    for (int s = 0; s < SPEC_COUNT; s++) assert_gives(&reference, specs[s]);
}

static void check_soup(uint64_t seed, float shift) {
    static RtRay rays[RAYS];
    OWNED_SCENE scene = make_soup(seed, shift);
    RtRandom random = rt_random(seed, 1);
    for (int i = 0; i < RAYS; i++) {
        rays[i] = make_ray(&scene.geometry, &random);
        assert_true(rt_ray_is_valid(&rays[i]));
    }
    compare_with_brute(&scene, rays);
}

RT_TEST(every_kind_answers_like_brute_on_soups_of_all_shapes) {
    for (uint64_t seed = 1; seed <= 4; seed++) check_soup(seed, 0);
}

RT_TEST(every_kind_answers_like_brute_far_from_the_zero_of_coordinates) {
    check_soup(5, 30);
    check_soup(6, 1e3f);
}

/* Multiples of the least number that float32 has: sheared coordinates are rounded by as much as objects are
 * apart. */
static RtVec3 least_point(RtRandom *random) {
    RtVec3 p;
    for (int a = 0; a < 3; a++) p.at[a] = 0x1p-149f * ((float)(rt_random_below(random, 17)) - 8);
    return p;
}

RT_TEST(every_kind_answers_like_brute_among_the_least_numbers) {
    static RtRay rays[RAYS];
    RtRandom random = rt_random(5, 0);
    OWNED_SCENE scene = begin_scene();
    for (int i = 0; i < 40; i++) {
        RtVec3 v[3];
        for (int k = 0; k < 3; k++) v[k] = least_point(&random);
        assert_ok(rt_scene_add_triangle(&scene, 0, v, NULL, error));
    }
    assert_ok(rt_scene_finish(&scene, error));
    for (int i = 0; i < RAYS; i++) {
        rays[i] = (RtRay){.org = least_point(&random), .tmax = INFINITY, .kind = RT_RAY_RANDOM};
        rays[i].dir = rt_narrow(rt_random_direction(&random));
    }
    strcpy(scene.name, "the least numbers");
    compare_with_brute(&scene, rays);
}

RT_TESTS(extents, NULL, NULL)
