/* SPDX-License-Identifier: Apache-2.0 */
/* core/shape/solid.h: lines through solids of each kind with crossings known by hand, and rejected input. */
#include "solids_testing.h"

/* ---- by hand ---- */

/* A line, in words, and where it crosses the solid: t of the crossings, ended by NAN. */
typedef struct Case {
    const char *what;
    RtVec3 org, dir;
    float t[5];
} Case;

static void check_cases(const RtSolidSet *set, uint32_t index, const Case *cases, size_t count) {
    for (size_t i = 0; i < count; i++) {
        RtRay ray = ray_along(cases[i].org, cases[i].dir);
        List list = cross(set, index, &ray);
        uint32_t expected = 0;
        while (!isnan(cases[i].t[expected])) expected++;
        bool same = list.count == expected;
        for (uint32_t k = 0; same && k < expected; k++) same = list.at[k].t == cases[i].t[k];
        if (same) continue;
        fail_msg("%s %s: %u crossings, the first at %.9g", rt_solid_kind_name(set->solids[index].kind),
                 cases[i].what, list.count, list.count ? (double)list.at[0].t : NAN);
    }
}

/* A set of one solid: OWNED_SOLID(set, box, lo, hi). */
#define OWNED_SOLID(set, kind, ...)                                                                          \
    OWNED_SOLIDS set = {0};                                                                                  \
    uint32_t only;                                                                                           \
    assert_ok(rt_solid_add_##kind(&(set), __VA_ARGS__, &only, error))

#define CHECK(set, index, cases) check_cases(set, index, cases, sizeof cases / sizeof *(cases))

RT_TEST(a_box_has_no_skin) {
    static const Case cases[] = {
        {"straight through", {{5, 0, 0}}, {{-2, 0, 0}}, {2, 3, NAN}},
        {"from the inside", {{0, 0, 0}}, {{0, 0, 1}}, {-1, 1, NAN}},
        {"behind the origin", {{5, 0, 0}}, {{1, 0, 0}}, {-6, -4, NAN}},
        {"from a face inward", {{1, 0, 0}}, {{-1, 0, 0}}, {0, 2, NAN}},
        {"from edge to edge", {{2, 2, 0}}, {{-1, -1, 0}}, {1, 3, NAN}},
        {"from corner to corner", {{2, 2, 2}}, {{-1, -1, -1}}, {1, 3, NAN}},
        {"in the plane of a face", {{5, 1, 0}}, {{-1, 0, 0}}, {NAN}},
        {"in the plane of the face opposite", {{5, -1, 0}}, {{-1, 0, 0}}, {NAN}},
        {"in the plane of a face, from there", {{0, 1, 0}}, {{-1, 0, 1}}, {NAN}},
        {"along an edge", {{5, 1, 1}}, {{-1, 0, 0}}, {NAN}},
        {"touching an edge", {{2, 0, 0}}, {{-1, 1, 0}}, {NAN}},
        {"touching a corner", {{2, 0, 1}}, {{-1, 1, 0}}, {NAN}},
        {"beside it", {{5, 1.5f, 0}}, {{-1, 0, 0}}, {NAN}},
    };
    OWNED_SOLID(set, box, rt_vec3(-1, -1, -1), rt_vec3(1, 1, 1));
    CHECK(&set, 0, cases);
}

RT_TEST(a_half_space_has_no_end) {
    static const Case cases[] = {
        {"into it", {{0, 0, 5}}, {{1, 0, -2}}, {2, INFINITY, NAN}},
        {"out of it", {{0, 0, 0}}, {{0, 0, 2}}, {-INFINITY, 0.5f, NAN}},
        {"along it, inside", {{0, 0, 0}}, {{1, 0, 0}}, {-INFINITY, INFINITY, NAN}},
        {"along it, outside", {{0, 0, 2}}, {{1, 0, 0}}, {NAN}},
        {"in its plane", {{0, 0, 1}}, {{1, 0, 0}}, {NAN}},
    };
    OWNED_SOLID(set, half_space, rt_vec3(7, 8, 1), rt_vec3(0, 0, 3));
    CHECK(&set, 0, cases);
}

RT_TEST(a_plane_does_not_depend_on_the_length_of_its_normal) {
    OWNED_SOLIDS set = {0};
    const double lengths[] = {1, 1e150, 1e-150};
    for (uint32_t i = 0; i < 3; i++) {
        double length = lengths[i];
        RtPlane wedge[2] = {{{{3 * length, 4 * length, 0}}, 5 * length},
                            {{{-3 * length, 4 * length, 0}}, 5 * length}};
        uint32_t at;
        assert_ok(rt_solid_add_polyhedron(&set, wedge, 2, NULL, &at, error));
        for (uint32_t k = 0; k < 2; k++) {
            const RtPlane *plane = &set.planes[set.solids[at].first + k];
            assert_true(fabs(plane->normal.x - (k ? -0.6 : 0.6)) < 1e-15);
            assert_true(fabs(plane->normal.y - 0.8) < 1e-15);
            assert_true(fabs(plane->offset - 1) < 1e-15);
        }
    }
}

RT_TEST(a_sphere_that_is_touched_is_not_crossed) {
    static const Case cases[] = {
        {"through its centre", {{1, 2, 10}}, {{0, 0, -1}}, {5, 9, NAN}},
        {"from the centre", {{1, 2, 3}}, {{0, 0, 4}}, {-0.5f, 0.5f, NAN}},
        {"from its surface", {{1, 2, 5}}, {{0, 0, -1}}, {0, 4, NAN}},
        {"touched", {{3, 2, 10}}, {{0, 0, -1}}, {NAN}},
        {"missed", {{3.5f, 2, 10}}, {{0, 0, -1}}, {NAN}},
    };
    OWNED_SOLID(set, ellipsoid, rt_vec3(1, 2, 3), rt_vec3(2, 2, 2));
    CHECK(&set, 0, cases);
}

/* Apex at (0, 0, 4), base of radius 2 at z = 0. */
RT_TEST(a_full_cone_ends_in_its_apex) {
    static const Case cases[] = {
        {"along the axis", {{0, 0, 10}}, {{0, 0, -1}}, {6, 10, NAN}},
        {"along the axis, upward", {{0, 0, -1}}, {{0, 0, 1}}, {1, 5, NAN}},
        {"parallel to the axis", {{1, 0, 10}}, {{0, 0, -1}}, {8, 10, NAN}},
        {"across", {{-5, 0, 2}}, {{1, 0, 0}}, {4, 6, NAN}},
        {"across, above the apex", {{-5, 0, 5}}, {{1, 0, 0}}, {NAN}},
        {"across, at the apex", {{-5, 0, 4}}, {{1, 0, 0}}, {NAN}},
        {"through the apex, aslant and outside", {{-4, 0, 2}}, {{2, 0, 1}}, {NAN}},
        {"through the apex, steep", {{-1, 0, 8}}, {{0.25f, 0, -1}}, {4, 8, NAN}},
        {"along its side", {{0, 0, 4}}, {{0.5f, 0, -1}}, {NAN}},
        {"parallel to its side, inside", {{-1, 0, 4}}, {{0.5f, 0, -1}}, {1, 4, NAN}},
        {"parallel to its side, outside", {{1, 0, 4}}, {{0.5f, 0, -1}}, {NAN}},
        {"in the plane of its base", {{-5, 0, 0}}, {{1, 0, 0}}, {NAN}},
        {"touching the rim of its base", {{-2, -5, 0}}, {{0, 1, 0}}, {NAN}},
    };
    OWNED_SOLIDS set = {0};
    uint32_t up, down;
    assert_ok(rt_solid_add_frustum(&set, rt_vec3(0, 0, 0), 2, rt_vec3(0, 0, 4), 0, &up, error));
    assert_ok(rt_solid_add_frustum(&set, rt_vec3(0, 0, 4), 0, rt_vec3(0, 0, 0), 2, &down, error));
    CHECK(&set, up, cases);
    CHECK(&set, down, cases);
}

RT_TEST(a_cylinder_is_entered_by_cap_or_side) {
    static const Case cases[] = {
        {"along the axis", {{-3, 0, 0}}, {{1, 0, 0}}, {3, 7, NAN}},
        {"parallel to the axis", {{-3, 1, 1}}, {{2, 0, 0}}, {1.5f, 3.5f, NAN}},
        {"across", {{2, -5, 0}}, {{0, 1, 0}}, {3, 7, NAN}},
        {"cap to side", {{-2, 0, 0}}, {{1, 0.5f, 0}}, {2, 4, NAN}},
        {"along its side", {{-3, 2, 0}}, {{1, 0, 0}}, {NAN}},
        {"in the plane of a cap", {{4, -5, 0}}, {{0, 1, 0}}, {NAN}},
        {"touching its side", {{-1, 2, -3}}, {{1, 0, 1}}, {NAN}},
        {"outside, parallel to the axis", {{-3, 3, 1}}, {{1, 0, 0}}, {NAN}},
    };
    OWNED_SOLID(set, frustum, rt_vec3(0, 0, 0), 2, rt_vec3(4, 0, 0), 2);
    CHECK(&set, 0, cases);
    RtRay ray = ray_along(rt_vec3(-2, 0, 0), rt_vec3(1, 0.5f, 0));
    List list = cross(&set, 0, &ray);
    assert_int_equal(list.at[0].face, 1);
    assert_int_equal(list.at[1].face, 0);
}

/* Circle of radius 2 in the plane z = 1, tube of radius 1. */
RT_TEST(a_torus_has_a_hole) {
    static const Case cases[] = {
        {"across both sides", {{-5, 0, 1}}, {{1, 0, 0}}, {2, 4, 6, 8, NAN}},
        {"through the hole", {{0, 0, 5}}, {{0, 0, -1}}, {NAN}},
        {"through the hole, aslant", {{0, 0, 1}}, {{1, 0, 8}}, {NAN}},
        {"through the tube", {{0, 2, 5}}, {{0, 0, -2}}, {1.5f, 2.5f, NAN}},
        {"from inside the tube", {{2, 0, 1}}, {{0, 0, 1}}, {-1, 1, NAN}},
        {"touched from outside", {{3, -4, 1}}, {{0, 1, 0}}, {NAN}},
        {"touched on top", {{-5, 0, 2}}, {{1, 0, 0}}, {NAN}},
        {"touched on top, from below", {{2, 0, -2}}, {{0, 0, 1}}, {2, 4, NAN}},
        {"touched at the hole", {{0, 1, 5}}, {{0, 0, -1}}, {NAN}},
        {"missed", {{-5, 0, 2.5f}}, {{1, 0, 0}}, {NAN}},
    };
    OWNED_SOLID(set, ring, rt_vec3(0, 0, 1), rt_vec3(0, 0, 7), 2, 1);
    CHECK(&set, 0, cases);

    /* In the tube, touching the hole's rim on the way: two spans that touch are one. */
    RtRay ray = ray_along(rt_vec3(1, -8, 1), rt_vec3(0, 1, 0));
    List list = cross(&set, 0, &ray);
    assert_int_equal(list.count, 2);
    assert_float_equal(list.at[0].t, 8 - sqrtf(8), 1e-6f);
    assert_float_equal(list.at[1].t, 8 + sqrtf(8), 1e-6f);
}

/* ---- refusals ---- */

RT_TEST(bad_solids_are_refused_and_leave_nothing) {
    OWNED_SOLIDS set = {0};
    uint32_t at;
    RtTransform here = rt_transform_identity(), flat = here, endless = here, far = here;
    flat.m[2][2] = 0;
    endless.m[0][3] = INFINITY;
    far.m[0][3] = 1e18;
    RtPlane planes[3] = {{{{1, 0, 0}}, 0}, {{{-1, 0, 0}}, -1}, {{{0, 0, 0}}, 1}};
    RtVec3 zero = {{0, 0, 0}}, one = {{1, 1, 1}},
           corners[5] = {{{0, 0, 0}}, {{1, 0, 0}}, {{0, 1, 0}}, {{1, 1, 0}}, {{3, 1, 0}}};
    RtTriangle triangles[12];
    uint32_t count = cube_mesh(triangles);

    assert_bad_input(rt_solid_add_sphere(&set, &flat, &at, error), "flat");
    assert_bad_input(rt_solid_add_sphere(&set, &endless, &at, error), "finite");
    assert_bad_input(rt_solid_add_sphere(&set, &far, &at, error), "scale it down");
    assert_bad_input(rt_solid_add_cone(&set, 1.5, &here, &at, error), "expected 0..1");
    assert_bad_input(rt_solid_add_torus(&set, 1, &here, &at, error), "below 1");
    assert_bad_input(rt_solid_add_torus(&set, (double)NAN, &here, &at, error), "below 1");
    assert_bad_input(rt_solid_add_polyhedron(&set, planes, 0, &here, &at, error), "expected 1..");
    assert_bad_input(rt_solid_add_polyhedron(&set, planes, 2, &here, &at, error), "enclose nothing");
    assert_bad_input(rt_solid_add_polyhedron(&set, planes, 3, &here, &at, error), "plane 2");
    planes[1].offset = 0;
    assert_bad_input(rt_solid_add_polyhedron(&set, planes, 2, &here, &at, error), "enclose nothing");
    RtPlane sheet[2] = {{{{1, 2, 2}}, 3}, {{{-1, -2, -2}}, -3 + 1e-13}};
    assert_bad_input(rt_solid_add_polyhedron(&set, sheet, 2, &here, &at, error), "enclose nothing");
    assert_bad_input(rt_solid_add_box(&set, one, zero, &at, error), "lo < hi");
    assert_bad_input(rt_solid_add_half_space(&set, one, zero, &at, error), "normal not 0");
    assert_bad_input(rt_solid_add_ellipsoid(&set, one, zero, &at, error), "above 0");
    assert_bad_input(rt_solid_add_frustum(&set, zero, 0, one, 0, &at, error), "above 0");
    assert_bad_input(rt_solid_add_frustum(&set, one, 1, one, 1, &at, error), "same point");
    assert_bad_input(rt_solid_add_ring(&set, zero, one, 1, 1, &at, error), "minor < major");
    assert_bad_input(rt_solid_add_ring(&set, zero, zero, 2, 1, &at, error), "length 0");
    assert_bad_input(rt_solid_add_hull(&set, corners, 3, &at, error), "expected 4..");
    assert_bad_input(rt_solid_add_hull(&set, corners, 5, &at, error), "one plane");
    assert_bad_input(rt_solid_add_mesh(&set, triangles, 3, &here, &at, error), "4 triangles");
    assert_bad_input(rt_solid_add_mesh(&set, triangles, count - 1, &here, &at, error), "not closed");
    for (uint32_t i = 0; i < count; i++) {
        RtVec3 kept = triangles[i].v[1];
        triangles[i].v[1] = triangles[i].v[2], triangles[i].v[2] = kept;
        if (i == 0)
            assert_bad_input(rt_solid_add_mesh(&set, triangles, count, &here, &at, error), "not closed");
    }
    assert_bad_input(rt_solid_add_mesh(&set, triangles, count, &here, &at, error), "inside out");
    triangles[3].v[0].y = NAN;
    assert_bad_input(rt_solid_add_mesh(&set, triangles, count, &here, &at, error), "triangle 3");
    assert_int_equal(set.solid_count + set.plane_count + set.triangle_count, 0);
}

static RtStatus add_one_of_each(RtSolidSet *set, uint32_t i, uint32_t *at, RtError *error) {
    RtTransform here = rt_transform_identity();
    RtTriangle triangles[12];
    static const RtVec3 corners[4] = {{{0, 0, 0}}, {{1, 0, 0}}, {{0, 1, 0}}, {{0, 0, 1}}};
    switch (i) {
    case 0: return rt_solid_add_sphere(set, &here, at, error);
    case 1: return rt_solid_add_cone(set, 0.5, &here, at, error);
    case 2: return rt_solid_add_torus(set, 0.5, &here, at, error);
    case 3: return rt_solid_add_hull(set, corners, 4, at, error);
    case 4: return rt_solid_add_mesh(set, triangles, cube_mesh(triangles), &here, at, error);
    default: return rt_solid_add_moved(set, set, i - 5, &here, at, error);
    }
}

static RtStatus add_each(RtError *error) {
    OWNED_SOLIDS set = {0};
    for (uint32_t i = 0, at; i < 10; i++) {
        const RtSolidSet kept = set;
        const RtStatus status = add_one_of_each(&set, i, &at, error);
        assert_int_equal(set.solid_count, kept.solid_count + (status == RT_OK));
        if (status == RT_OK) continue;
        assert_int_equal(set.plane_count, kept.plane_count);
        assert_int_equal(set.triangle_count, kept.triangle_count);
        return status;
    }
    assert_true(rt_solid_set_bytes(&set) > 10 * sizeof(RtSolid));
    return RT_OK;
}

RT_TEST(without_memory_nothing_is_added) {
    assert_fails_cleanly(add_each(error), (void)0);
}

RT_TESTS(solid_cases, NULL, NULL)
