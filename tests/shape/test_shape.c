/* SPDX-License-Identifier: Apache-2.0 */
/* shape/: hits, normals and rejected input of every shape, against results known by hand. */
#include "crossings_testing.h"
#include "testing.h"

/* ---- hits ---- */

#define MISS NAN

/* A ray, in words, and where it first meets the only object: t, or MISS. */
typedef struct Case {
    const char *what;
    RtVec3 org, dir;
    float t;
} Case;

/* Asks every case of object 0. */
static void check(const RtGeometry *g, const Case *cases, size_t count) {
    for (size_t i = 0; i < count; i++) {
        RtRay ray = ray_along(cases[i].org, cases[i].dir);
        float t = NAN;
        bool met = hit(g, 0, &ray, &t);
        if (met == !isnan(cases[i].t) && (!met || t == cases[i].t)) continue;
        fail_msg("%s: %s at %.9g, expected %.9g", cases[i].what, met ? "hit" : "missed", (double)t,
                 (double)cases[i].t);
    }
}

/* Asks them of one object: CHECK(cases, sphere, center, radius). */
#define CHECK(cases, shape, ...)                                                                             \
    OWNED_OBJECT(g, shape, __VA_ARGS__);                                                                     \
    check(&g, cases, sizeof cases / sizeof *(cases))

RT_TEST(unit_normals_are_kept_bit_for_bit_and_others_made_unit) {
    const RtVec3 corners[3] = {{{0, 0, 0}}, {{1, 0, 0}}, {{0, 1, 0}}};
    OWNED_GEOMETRY g = {0};
    for (uint32_t i = 0; i < 50; i++) {
        RtVec3d n = rt_vec3d(1, 0.1 * i, 0.01 * i * i);
        RtVec3 unit = rt_narrow(rt_scaled(rt_normalized(n), 1 + 0x1p-24)),
               twice = rt_narrow(rt_scaled(rt_normalized(n), 2));
        const RtVec3 normals[3] = {unit, unit, twice};
        assert_ok(rt_geometry_add_triangle(&g, corners, normals, error));
        const RtVec3 *kept = g.vertex_normals[i].n;
        assert_memory_equal(kept, normals, 2 * sizeof(RtVec3));
        assert_true(fabs(rt_lengthd(rt_widen(kept[2])) - 1) < 1e-7);
    }
}

RT_TEST(the_lecture_ray_meets_the_unit_sphere_at_9_and_11) {
    OWNED_OBJECT(g, sphere, rt_vec3(0, 0, 0), 1);
    RtRay ray = ray_along(rt_vec3(0, 0, 10), rt_vec3(0, 0, -1));
    float t;
    assert_true(hit(&g, 0, &ray, &t));
    assert_true(t == 9.0f);
    ray.tmin = 9.5f;
    assert_true(hit(&g, 0, &ray, &t));
    assert_true(t == 11.0f);
    ray.tmin = 11.5f;
    assert_false(hit(&g, 0, &ray, &t));
}

RT_TEST(a_sphere_is_hit_from_outside_and_inside_and_touched) {
    static const Case cases[] = {
        {"from outside", {{1, 2, -7}}, {{0, 0, 1}}, 8},
        {"from the centre", {{1, 2, 3}}, {{0, 1, 0}}, 2},
        {"from inside, off the centre", {{1, 2, 4}}, {{0, 0, 1}}, 1},
        {"from the surface inward", {{1, 2, 1}}, {{0, 0, 1}}, 0},
        {"from the surface outward", {{1, 2, 1}}, {{0, 0, -1}}, 0},
        {"towards it, off the centre", {{-6, 2, 3}}, {{0.5f, 0, 0}}, 10},
        {"touching", {{3, 2, -7}}, {{0, 0, 1}}, 10},
        {"just outside of touching", {{3.001f, 2, -7}}, {{0, 0, 1}}, MISS},
        {"behind", {{1, 2, -7}}, {{0, 0, -1}}, MISS},
        {"passing far away", {{100, 2, -7}}, {{0, 0, 1}}, MISS},
    };
    CHECK(cases, sphere, rt_vec3(1, 2, 3), 2);
}

RT_TEST(a_triangle_is_hit_on_both_sides_with_its_edges_and_vertices) {
    static const Case cases[] = {
        {"from the front", {{1, 1, 5}}, {{0, 0, -1}}, 4},
        {"from behind it", {{1, 1, -5}}, {{0, 0, 2}}, 3},
        {"from its plane, across", {{1, 1, 1}}, {{0, 0, 1}}, 0},
        {"through an edge", {{2, 0, 5}}, {{0, 0, -1}}, 4},
        {"through the slanting edge", {{2, 2, 5}}, {{0, 0, -1}}, 4},
        {"through a vertex", {{0, 0, 5}}, {{0, 0, -1}}, 4},
        {"through another vertex", {{4, 0, 5}}, {{0, 0, -1}}, 4},
        {"just outside of an edge", {{2, -1e-6f, 5}}, {{0, 0, -1}}, MISS},
        {"beyond the slanting edge", {{2, 2.001f, 5}}, {{0, 0, -1}}, MISS},
        {"away from it", {{1, 1, 5}}, {{0, 0, 1}}, MISS},
        {"parallel to it", {{-1, 1, 5}}, {{1, 0, 0}}, MISS},
        {"in its plane", {{-1, 1, 1}}, {{1, 0, 0}}, MISS},
        {"in its plane, along an edge", {{-1, 0, 1}}, {{1, 0, 0}}, MISS},
    };
    CHECK(cases, triangle, (RtVec3[]){{{0, 0, 1}}, {{4, 0, 1}}, {{0, 4, 1}}}, NULL);
}

RT_TEST(a_triangle_without_area_is_let_in_and_never_hit) {
    static const Case cases[] = {
        {"across it", {{1, 0, 5}}, {{0, 0, -1}}, MISS},
        {"along it", {{-1, 0, 0}}, {{1, 0, 0}}, MISS},
        {"at its end", {{0, -3, 0}}, {{0, 1, 0}}, MISS},
    };
    CHECK(cases, triangle, (RtVec3[]){{{0, 0, 0}}, {{4, 0, 0}}, {{2, 0, 0}}}, NULL);
}

/* A U in the plane x = 2, with its notch open towards +z. */
RT_TEST(a_concave_polygon_is_missed_in_its_notch) {
    static const Case cases[] = {
        {"through the left arm", {{0, 0.5f, 2}}, {{1, 0, 0}}, 2},
        {"through the right arm, from behind", {{4, 2.5f, 2}}, {{-1, 0, 0}}, 2},
        {"through the bottom", {{0, 1.5f, 0.5f}}, {{1, 0, 0}}, 2},
        {"through the notch", {{0, 1.5f, 2}}, {{1, 0, 0}}, MISS},
        {"through the notch, level with its bottom corners", {{0, 1.5f, 1.5f}}, {{1, 0, 0}}, MISS},
        {"on the floor of the notch", {{0, 1.5f, 1}}, {{1, 0, 0}}, 2},
        {"on the wall of the notch", {{0, 1, 2}}, {{1, 0, 0}}, 2},
        {"on the upper edge of an arm", {{0, 0.5f, 3}}, {{1, 0, 0}}, 2},
        {"on the lower left corner", {{0, 0, 0}}, {{1, 0, 0}}, 2},
        {"on the upper right corner", {{0, 3, 3}}, {{1, 0, 0}}, 2},
        {"between the corners of the arms", {{0, 1.5f, 3}}, {{1, 0, 0}}, MISS},
        {"beside it", {{0, 3.5f, 1}}, {{1, 0, 0}}, MISS},
        {"level with a corner, beside it", {{0, -1, 1}}, {{1, 0, 0}}, MISS},
        {"slanting", {{0, 0, 0}}, {{4, 1, 1}}, 0.5f},
        {"behind", {{3, 0.5f, 2}}, {{1, 0, 0}}, MISS},
        {"parallel to it", {{0, 0.5f, 2}}, {{0, 1, 0}}, MISS},
        {"in its plane", {{2, -1, 0.5f}}, {{0, 1, 0}}, MISS},
    };
    static const RtVec3 vertices[] = {{{2, 0, 0}}, {{2, 3, 0}}, {{2, 3, 3}}, {{2, 2, 3}},
                                      {{2, 2, 1}}, {{2, 1, 1}}, {{2, 1, 3}}, {{2, 0, 3}}};
    CHECK(cases, polygon, vertices, 8);
}

RT_TEST(a_cylinder_is_open_at_both_ends) {
    static const Case cases[] = {
        {"from outside", {{-5, 0, 2}}, {{1, 0, 0}}, 4},
        {"from inside", {{0, 0, 2}}, {{0, -1, 0}}, 1},
        {"touching", {{-5, 1, 2}}, {{1, 0, 0}}, 5},
        {"just outside of touching", {{-5, 1.001f, 2}}, {{1, 0, 0}}, MISS},
        {"on the circle of an end", {{-5, 0, 0}}, {{1, 0, 0}}, 4},
        {"on the circle of the other end", {{-5, 0, 4}}, {{1, 0, 0}}, 4},
        {"beyond an end", {{-5, 0, 4.001f}}, {{1, 0, 0}}, MISS},
        {"along the axis", {{0, 0, -5}}, {{0, 0, 1}}, MISS},
        {"parallel to the axis, inside", {{0.5f, 0, -5}}, {{0, 0, 1}}, MISS},
        {"parallel to the axis, outside", {{1.5f, 0, -5}}, {{0, 0, 1}}, MISS},
        {"in by the open end, out by the wall", {{0, 0, -1}}, {{0.5f, 0, 1}}, 2},
        {"behind", {{-5, 0, 2}}, {{-1, 0, 0}}, MISS},
    };
    CHECK(cases, cone, rt_vec3(0, 0, 0), 1, rt_vec3(0, 0, 4), 1);
}

RT_TEST(a_full_cone_is_hit_up_to_its_tip) {
    static const Case cases[] = {
        {"half way up", {{-5, 0, 0.5f}}, {{1, 0, 0}}, 4.5f},
        {"half way up, from inside", {{0, 0, 0.5f}}, {{1, 0, 0}}, 0.5f},
        {"at the tip, across", {{-5, 0, 1}}, {{1, 0, 0}}, 5},
        {"at the tip, along the axis through the open end", {{0, 0, -5}}, {{0, 0, 1}}, 6},
        {"at the tip, from above", {{0, 0, 5}}, {{0, 0, -1}}, 4},
        {"above the tip, where the other half of the double cone is", {{-5, 0, 1.5f}}, {{1, 0, 0}}, MISS},
        {"through the open end", {{0, 0, -0.5f}}, {{1, 0, 1}}, 0.75f},
        {"along the side, outside", {{0, 0, -2}}, {{1, 0, -1}}, MISS},
        {"on the circle", {{-5, 0, 0}}, {{1, 0, 0}}, 4},
        {"below the circle", {{-5, 0, -0.001f}}, {{1, 0, 0}}, MISS},
    };
    CHECK(cases, cone, rt_vec3(0, 0, 0), 1, rt_vec3(0, 0, 1), 0);
}

/* ---- normals ---- */

/* The hit of a ray that starts at `point`. */
static RtNormals normals_at(const RtGeometry *g, uint32_t id, RtVec3d point) {
    RtRay ray = {.org = rt_narrow(point), .dir = {0, 0, 1}, .tmax = INFINITY};
    return rt_object_normals(g, id, &ray, 0, hit_memory_of_tests());
}

static void assert_vector(RtVec3d a, double x, double y, double z) {
    if (rt_lengthd(rt_subd(a, rt_vec3d(x, y, z))) < 1e-12) return;
    fail_msg("(%g, %g, %g) is not (%g, %g, %g)", a.x, a.y, a.z, x, y, z);
}

RT_TEST(normals_point_outward_or_by_the_right_hand_rule) {
    OWNED_GEOMETRY g = {0};
    static const RtVec3 square[] = {{{0, 0, 5}}, {{0, 2, 5}}, {{2, 2, 5}}, {{2, 0, 5}}};
    assert_ok(rt_geometry_add_sphere(&g, rt_vec3(1, 0, 0), 2, error));
    assert_ok(rt_geometry_add_polygon(&g, square, 4, error));
    assert_ok(rt_geometry_add_triangle(&g, (RtVec3[]){{{0, 0, 0}}, {{0, 1, 0}}, {{0, 0, 1}}}, NULL, error));
    assert_ok(rt_geometry_add_cone(&g, rt_vec3(0, 0, 0), 1, rt_vec3(0, 0, 4), 1, error));
    assert_ok(rt_geometry_add_cone(&g, rt_vec3(0, 0, 0), 5, rt_vec3(0, 0, 4), 2, error));
    assert_ok(rt_geometry_add_cone(&g, rt_vec3(0, 0, 0), 2, rt_vec3(0, 0, 4), 5, error));
    assert_ok(rt_geometry_finish(&g, error));
    assert_vector(normals_at(&g, 0, rt_vec3d(-1, 0, 0)).geometric, -1, 0, 0);
    assert_vector(normals_at(&g, 1, rt_vec3d(1, 1, 5)).geometric, 0, 0, -1);
    assert_vector(normals_at(&g, 2, rt_vec3d(0, 0, 0)).geometric, 1, 0, 0);
    assert_vector(normals_at(&g, 3, rt_vec3d(0, 1, 2)).geometric, 0, 1, 0);
    /* A frustum that narrows by 3 over a height of 4 leans outward and up, one that widens outward and
     * down. */
    assert_vector(normals_at(&g, 4, rt_vec3d(3.5, 0, 2)).geometric, 0.8, 0, 0.6);
    assert_vector(normals_at(&g, 5, rt_vec3d(0, -3.5, 2)).geometric, 0, -0.8, -0.6);
}

RT_TEST(vertex_normals_are_interpolated_for_shading_only) {
    OWNED_GEOMETRY g = {0};
    const RtVec3 vertices[3] = {{{0, 0, 0}}, {{1, 0, 0}}, {{0, 1, 0}}};
    const RtVec3 normals[3] = {{{0, 0, 7}}, {{3, 0, 0}}, {{0, 0.5f, 0}}};
    assert_ok(rt_geometry_add_triangle(&g, vertices, NULL, error));
    assert_ok(rt_geometry_add_triangle(&g, vertices, normals, error));
    assert_ok(rt_geometry_finish(&g, error));
    assert_vector(normals_at(&g, 0, rt_vec3d(0.5, 0.5, 0)).shading, 0, 0, 1);
    assert_vector(normals_at(&g, 1, rt_vec3d(0, 0, 0)).shading, 0, 0, 1);
    assert_vector(normals_at(&g, 1, rt_vec3d(1, 0, 0)).shading, 1, 0, 0);
    assert_vector(normals_at(&g, 1, rt_vec3d(0.5, 0.5, 0)).shading, sqrt(0.5), sqrt(0.5), 0);
    assert_vector(normals_at(&g, 1, rt_vec3d(0.5, 0.5, 0)).geometric, 0, 0, 1);
}

/* ---- refusals ---- */

RT_TEST(degenerate_objects_are_refused_with_the_reason) {
    OWNED_GEOMETRY g = {0};
    const RtVec3 o = {{0, 0, 0}}, z = {{0, 0, 1}}, nan = {{NAN, 0, 0}}, huge = {{0, 6e17f, 0}};
    const RtVec3 line[] = {{{0, 0, 0}}, {{1, 1, 1}}, {{2, 2, 2}}, {{5, 5, 5}}};
    const RtVec3 warped[] = {{{0, 0, 0}}, {{1, 0, 0}}, {{1, 1, 0.1f}}, {{0, 1, 0}}};
    const RtVec3 infinite[] = {{{0, 0, 0}}, {{1, 0, 0}}, {{0, INFINITY, 0}}};
    const RtVec3 normals[] = {{{0, 0, 1}}, {{0, 0, 0}}, {{0, 0, 1}}};
    assert_bad_input(rt_geometry_add_sphere(&g, o, 0, error), "radius above 0");
    assert_bad_input(rt_geometry_add_sphere(&g, o, -1, error), "radius above 0");
    assert_bad_input(rt_geometry_add_sphere(&g, o, NAN, error), "a radius of nan");
    assert_bad_input(rt_geometry_add_sphere(&g, o, INFINITY, error), "a radius of inf");
    assert_bad_input(rt_geometry_add_sphere(&g, nan, 1, error), "not a finite number");
    assert_bad_input(rt_geometry_add_sphere(&g, huge, 1, error), "scale the scene down");
    assert_bad_input(rt_geometry_add_polygon(&g, line, 0, error), "at least 3 vertices");
    assert_bad_input(rt_geometry_add_polygon(&g, line, 2, error), "at least 3 vertices");
    assert_bad_input(rt_geometry_add_polygon(&g, line, 4, error), "has no area");
    assert_bad_input(rt_geometry_add_polygon(&g, warped, 4, error), "not planar");
    assert_bad_input(rt_geometry_add_polygon(&g, infinite, 3, error), "not a finite number");
    assert_bad_input(rt_geometry_add_triangle(&g, infinite, NULL, error), "not a finite number");
    assert_bad_input(rt_geometry_add_triangle(&g, warped, normals, error), "vertex normal 1 is zero");
    assert_bad_input(rt_geometry_add_cone(&g, o, 0, z, 0, error), "one of them above 0");
    assert_bad_input(rt_geometry_add_cone(&g, o, -1, z, 1, error), "radii of at least 0");
    assert_bad_input(rt_geometry_add_cone(&g, z, 1, z, 1, error), "the same point");
    assert_bad_input(rt_geometry_add_cone(&g, o, 1, nan, 1, error), "not a finite number");
    assert_bad_input(rt_geometry_add_cone(&g, o, 1, z, NAN, error), "a radius of nan");
    assert_int_equal(g.object_count, 0);
}

RT_TESTS(shape, NULL, NULL)
