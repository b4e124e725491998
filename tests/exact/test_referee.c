/* SPDX-License-Identifier: Apache-2.0 */
/* The referee: hits at boundaries, true ties, and agreement with our hit functions except
 * within the rounding of float32 of a decision boundary. */
#include "csg_testing.h"

#include "exact/border.h"
#include "exact/referee.h"

/* ---- one object ---- */

static RtRay ray_from(float x, float y, float z, float dx, float dy, float dz) {
    return ray_along(rt_vec3(x, y, z), rt_vec3(dx, dy, dz));
}

/* t, INFINITY for a miss. */
static long double first_t(const RtGeometry *g, uint32_t id, RtRay ray) {
    long double t = HUGE_VALL;
    RtWideRay line = rt_wide_ray(&ray);
    assert_int_not_equal(rt_referee_hit(g, id, &line, &t), RT_UNDECIDED);
    return t;
}

static long double first_t_within(const RtGeometry *g, uint32_t id, RtRay ray, float tmin, float tmax) {
    ray.tmin = tmin;
    ray.tmax = tmax;
    return first_t(g, id, ray);
}

RT_TEST(the_unit_sphere_is_met_at_9_and_11) {
    OWNED_OBJECT(g, sphere, rt_vec3(0, 0, 0), 1);
    RtRay ray = ray_from(0, 0, 10, 0, 0, -1);
    assert_true(first_t(&g, 0, ray) == 9);
    assert_true(first_t_within(&g, 0, ray, 9, 9) == 9);
    assert_true(first_t_within(&g, 0, ray, nextafterf(9, 10), INFINITY) == 11);
    assert_true(first_t_within(&g, 0, ray, nextafterf(9, 10), nextafterf(11, 10)) == HUGE_VALL);
}

/* 3-4-5: the distance of the line from the centre is 5, not nearly 5. */
RT_TEST(a_sphere_is_touched_in_one_point_exactly) {
    OWNED_GEOMETRY g = {0};
    assert_ok(rt_geometry_add_sphere(&g, rt_vec3(1, 1, 0), 5, error));
    assert_ok(rt_geometry_add_sphere(&g, rt_vec3(1, 1, 0), nextafterf(5, 4), error));
    assert_ok(rt_geometry_add_sphere(&g, rt_vec3(1, 1, 0), nextafterf(5, 6), error));
    assert_ok(rt_geometry_finish(&g, error));
    RtRay ray = ray_from(4, 5, -10, 0, 0, 2);
    assert_true(first_t(&g, 0, ray) == 5);
    assert_true(first_t(&g, 1, ray) == HUGE_VALL);
    assert_true(first_t(&g, 2, ray) < 5 && first_t(&g, 2, ray) > 4.99L);
}

/* Corners (0, 0), (4, 0), (0, 4) at z = 0; the edge between the last two is x + y = 4. */
RT_TEST(edges_and_vertices_belong_to_triangles_and_polygons) {
    OWNED_GEOMETRY g = {0};
    const RtVec3 v[4] = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, 0}}; /* with the last: concave */
    const RtVec3 needle[3] = {{0, 0, 0}, {1, 1, 0}, {3, 3, 0}};
    assert_ok(rt_geometry_add_triangle(&g, v, NULL, error));
    assert_ok(rt_geometry_add_polygon(&g, v, 3, error));
    assert_ok(rt_geometry_add_polygon(&g, v, 4, error));
    assert_ok(rt_geometry_add_triangle(&g, needle, NULL, error));
    assert_ok(rt_geometry_finish(&g, error));
    float above = nextafterf(1, 2);
    const struct {
        float x, y;
        bool in[3];
    } points[] = {{0, 0, {1, 1, 1}},       {4, 0, {1, 1, 1}},          {0, 4, {1, 1, 1}},
                  {2, 0, {1, 1, 1}},       {1, 3, {1, 1, 1}},          {above, 3, {0, 0, 0}},
                  {3, above, {0, 0, 0}},   {-0x1p-149f, 0, {0, 0, 0}}, {1, 1, {1, 1, 1}},
                  {0.5f, 0.5f, {1, 1, 1}}, {0.5f, 1, {1, 1, 0}},       {0.25f, 3, {1, 1, 0}},
                  {1, 0.5f, {1, 1, 1}}};
    for (size_t i = 0; i < sizeof points / sizeof points[0]; i++) {
        for (uint32_t id = 0; id < 3; id++) {
            RtRay down = ray_from(points[i].x, points[i].y, 3, 0, 0, -2);
            long double expected = points[i].in[id] ? 1.5L : HUGE_VALL;
            if (first_t(&g, id, down) != expected) fail_msg("point %zu, object %u", i, id);
        }
    }
    for (uint32_t id = 0; id < 3; id++)
        assert_true(first_t(&g, id, ray_from(-1, 1, 0, 1, 0, 0)) == HUGE_VALL);
    assert_true(first_t(&g, 3, ray_from(1, 1, 1, 0, 0, -1)) == HUGE_VALL);
}

/* The vertices are those of a square but for one ulp: they lie in no plane. The hit is in the plane that is
 * as far above two of them as below the others, a quarter of an ulp. */
RT_TEST(a_polygon_that_is_not_planar_has_one_plane_all_the_same) {
    float one = 1, above = nextafterf(1, 2);
    const RtVec3 v[4] = {{0, 0, one}, {1, 0, one}, {1, 1, above}, {0, 1, one}};
    OWNED_OBJECT(g, polygon, v, 4);
    assert_true(first_t(&g, 0, ray_from(0.5f, 0.5f, 2, 0, 0, -1)) == 1 - 0x1p-25L);
}

/* A cylinder of radius 5 about x: met at 3-4-5; a full cone with its tip at the origin, at 45 degrees. */
RT_TEST(circles_and_the_tip_belong_to_cones) {
    OWNED_GEOMETRY g = {0};
    assert_ok(rt_geometry_add_cone(&g, rt_vec3(-2, 0, 0), 5, rt_vec3(2, 0, 0), 5, error));
    assert_ok(rt_geometry_add_cone(&g, rt_vec3(2, 0, 0), 2, rt_vec3(0, 0, 0), 0, error));
    assert_ok(rt_geometry_finish(&g, error));
    assert_true(first_t(&g, 0, ray_from(2, 3, 10, 0, 0, -1)) == 6);
    assert_true(first_t(&g, 0, ray_from(nextafterf(2, 3), 3, 10, 0, 0, -1)) == HUGE_VALL);
    assert_true(first_t(&g, 0, ray_from(-9, 0, 0, 1, 0, 0)) == HUGE_VALL);  /* inside */
    assert_true(first_t(&g, 0, ray_from(0, 5, 10, 0, 0, -1)) == 10);        /* a tangent */
    assert_true(first_t(&g, 1, ray_from(0, 0, 10, 0, 0, -1)) == 10);        /* at the tip */
    assert_true(first_t(&g, 1, ray_from(3, 3, 0, -1, -1, 0)) == HUGE_VALL); /* along the side */
    assert_true(first_t(&g, 1, ray_from(-1, 0, 0, 1, 0, 0)) == 1);          /* along the axis */
    assert_true(first_t(&g, 1, ray_from(-1, 1, 0, 1, 0, 0)) == 2);
}

/* ---- order ---- */

static int order_of(const RtGeometry *g, uint32_t a, uint32_t b, const RtRay *ray) {
    int order = 99;
    long double apart;
    assert_int_equal(rt_referee_order(g, a, b, ray, &order, &apart), RT_HIT);
    assert_true((order == 0) == (apart == 0));
    return order;
}

/* Three triangles across the axis of z, at these heights. */
static void add_walls(RtGeometry *g, const float heights[3]) {
    for (int i = 0; i < 3; i++) {
        const RtVec3 v[3] = {{-9, -9, heights[i]}, {9, -9, heights[i]}, {0, 9, heights[i]}};
        assert_ok(rt_geometry_add_triangle(g, v, NULL, error));
    }
}

/* The ray meets the sphere at z = 4 (3-4-5), where a triangle lies, and others an ulp before and behind. */
RT_TEST(a_sphere_and_a_triangle_tie_where_they_meet_at_a_rational_t) {
    OWNED_GEOMETRY g = {0};
    const float heights[3] = {4, nextafterf(4, 5), nextafterf(4, 3)};
    assert_ok(rt_geometry_add_sphere(&g, rt_vec3(0, 0, 0), 5, error));
    add_walls(&g, heights);
    assert_ok(rt_geometry_finish(&g, error));
    RtRay ray = ray_from(3, 0, 7, 0, 0, -3);
    assert_int_equal(order_of(&g, 0, 1, &ray), 0);
    assert_int_equal(order_of(&g, 0, 2, &ray), 1);
    assert_int_equal(order_of(&g, 0, 3, &ray), -1);
    assert_int_equal(order_of(&g, 2, 3, &ray), -1);
    RtExactAnswer ruling = rt_referee_nearest(&g, &ray);
    assert_int_equal(ruling.object, 2);
    assert_int_equal(ruling.tied, 1);
}

/* Three spheres and a cylinder are met at t = 10 - sqrt(3), which is no number that any of them stores. */
RT_TEST(equal_roots_of_different_objects_are_a_tie) {
    OWNED_GEOMETRY g = {0};
    assert_ok(rt_geometry_add_sphere(&g, rt_vec3(0, 0, 0), 2, error));
    assert_ok(rt_geometry_add_sphere(&g, rt_vec3(4, 2, 0), 4, error));
    assert_ok(rt_geometry_add_cone(&g, rt_vec3(0, -5, 0), 2, rt_vec3(0, 7, 0), 2, error));
    assert_ok(rt_geometry_add_sphere(&g, rt_vec3(2, 0, 0), 2, error));
    assert_ok(rt_geometry_add_sphere(&g, rt_vec3(2, 0, 0), nextafterf(2, 1), error));
    assert_ok(rt_geometry_finish(&g, error));
    RtRay ray = ray_from(1, 0, 10, 0, 0, -1);
    for (uint32_t id = 1; id < 4; id++) assert_int_equal(order_of(&g, 0, id, &ray), 0);
    assert_int_equal(order_of(&g, 0, 4, &ray), -1);
    RtExactAnswer ruling = rt_referee_nearest(&g, &ray);
    assert_int_equal(ruling.object, 0);
    assert_int_equal(ruling.tied, 4);
    assert_true(fabsl(ruling.t - (10 - sqrtl(3))) <= 0x1p-60L);
    ray.tmax = 8;
    assert_int_equal(rt_referee_nearest(&g, &ray).result, RT_MISSED);
}

/* ---- numbers at the ends of float32 ---- */

RT_TEST(huge_and_denormal_numbers_are_as_exact_as_others) {
    OWNED_GEOMETRY g = {0};
    assert_ok(rt_geometry_add_sphere(&g, rt_vec3(0, 0, 0), 0x1p-140f, error));
    assert_ok(rt_geometry_add_sphere(&g, rt_vec3(0, 0x1p58f, 0), 0x1p57f, error));
    assert_ok(rt_geometry_finish(&g, error));
    RtRay denormal = ray_from(0x1p-140f, 0, 0x1p-130f, 0, 0, -0x1p-149f);
    assert_true(first_t(&g, 0, denormal) == 0x1p19L);
    denormal.org.x = 0x1.01p-140f;
    assert_true(first_t(&g, 0, denormal) == HUGE_VALL);
    RtRay far = ray_from(0, 0x1p58f, 0x1p58f, 0, 0, -0x1p-60f);
    assert_true(first_t(&g, 1, far) == 0x1p117L);
    far.dir.z = -0x1p-100f; /* t = 2^157 is beyond the largest float32 */
    assert_true(first_t(&g, 1, far) == HUGE_VALL);
    assert_int_equal(rt_referee_nearest(&g, &far).result, RT_MISSED);
}

/* ---- trees ---- */

RT_TEST(trees_are_met_where_their_inside_begins_and_ends) {
    OWNED_GEOMETRY g = {0};
    OWNED_BUILDER b = {0};
    RtCsgTerm near = ball(&b, rt_vec3(0, 0, 0), 5, 0), touching = ball(&b, rt_vec3(10, 0, 0), 5, 0);
    RtCsgTerm cube = box(&b, rt_vec3(-1, -1, -1), rt_vec3(9, 1, 1), 0);
    RtCsgTerm wall = box(&b, rt_vec3(1, -1, -1), rt_vec3(nextafterf(1, 2), 1, 1), 0);
    RtCsgTerm room = box(&b, rt_vec3(0, -1, -1), rt_vec3(3, 1, 1), 0);
    uint32_t solid;
    assert_ok(rt_solid_add_frustum(&b.set, rt_vec3(0, 0, 0), 5, rt_vec3(8, 0, 0), 0, &solid, error));
    RtCsgTerm cone = term_of(&b, solid);
    add_tree(&g, &b, join(&b, near, touching)); /* 0 */
    add_tree(&g, &b, cut(&b, near, cube));      /* 1 */
    add_tree(&g, &b, meet(&b, near, cube));     /* 2 */
    add_tree(&g, &b, cut(&b, near, near));      /* 3 */
    add_tree(&g, &b, meet(&b, room, wall));     /* 4: an ulp thick */
    add_tree(&g, &b, join(&b, cone, cone));     /* 5 */
    assert_ok(rt_geometry_finish(&g, error));
    RtRay x = ray_from(-8, 0, 0, 1, 0, 0), within = x;
    within.tmin = 4;
    assert_true(first_t(&g, 0, x) == 3);
    assert_true(first_t(&g, 0, within) == 23); /* no wall where they touch */
    assert_true(first_t(&g, 1, x) == 3);
    assert_true(first_t(&g, 1, within) == 7);
    assert_true(first_t(&g, 2, x) == 7);
    assert_true(first_t_within(&g, 2, x, 8, INFINITY) == 13);
    assert_true(first_t(&g, 3, x) == HUGE_VALL);
    assert_true(first_t(&g, 4, x) == 9);
    assert_true(first_t_within(&g, 4, x, nextafterf(9, 10), INFINITY) == HUGE_VALL);
    assert_true(first_t(&g, 5, x) == 8);
    assert_true(first_t_within(&g, 5, x, 9, INFINITY) == 16);
    /* The cone's radius is 2.5 there. */
    assert_true(fabsl(first_t(&g, 5, ray_from(4, 0, 8, 0, 0, -1)) - 5.5L) <= 0x1p-50L);
}

/* ---- judging ---- */

/* 0: a wall at z = 0; 1: one an ulp behind; 2: one at z = -1. */
RT_TEST(the_referee_says_who_is_right) {
    OWNED_GEOMETRY g = {0};
    const float heights[3] = {0, -0x1p-24f, -1};
    add_walls(&g, heights);
    assert_ok(rt_geometry_finish(&g, error));
    RtRay ray = ray_from(0, 0, 1, 0, 0, -1), aside = ray_from(20, 0, 1, 0, 0, -1);
    const struct {
        RtRay ray;
        RtHit expected, got;
        RtSide side;
    } cases[] = {
        {ray, {1, 0}, {1, 0}, RT_SIDE_BOTH},      {ray, {1, 0}, {1, 1}, RT_SIDE_BOTH},
        {ray, {1, 0}, {2, 2}, RT_SIDE_EXPECTED},  {ray, RT_MISS, {1, 0}, RT_SIDE_GOT},
        {ray, {2, 0}, RT_MISS, RT_SIDE_NEITHER},  {ray, {1, 2}, {NAN, 0}, RT_SIDE_NEITHER},
        {ray, {1, 0}, {1, 77}, RT_SIDE_EXPECTED}, {aside, RT_MISS, {1, 0}, RT_SIDE_EXPECTED},
        {aside, RT_MISS, RT_MISS, RT_SIDE_BOTH},  {ray, {1.001f, 0}, {1, 0}, RT_SIDE_GOT},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        RtSide side = rt_referee_judge(&g, &cases[i].ray, cases[i].expected, cases[i].got, 0).side;
        if (side != cases[i].side) fail_msg("case %zu: %s", i, rt_side_name(side));
    }
    assert_int_equal(rt_referee_judge(&g, &ray, (RtHit){1.001f, 0}, RT_MISS, 0.01).side, RT_SIDE_EXPECTED);
    long double off, ulps;
    assert_int_equal(error_of_t(&g, 0, &ray, nextafterf(1, 2), &off, &ulps), RT_HIT);
    assert_true(ulps == 1);
    assert_int_equal(error_of_t(&g, 0, &ray, nextafterf(1, 0), &off, &ulps), RT_HIT);
    assert_true(ulps == -0.5L);
    assert_int_equal(error_of_t(&g, 0, &aside, 1, &off, &ulps), RT_MISSED);
}

RT_TESTS(referee, NULL, NULL)
