/* SPDX-License-Identifier: Apache-2.0 */
/* core/shape/overlap.h: boxes that the surface of an object meets, and grids that list objects by surface. */
#include "equivalence_testing.h"

#include "accel/clipping.h"
#include "accel/grid/grid.h"
#include "accel/tree/tree.h"
#include "core/shape/overlap.h"

static bool object_meets_box(const RtGeometry *g, uint32_t id, const RtBox *box, double margin) {
    RtOutline outline = rt_object_outline(g, id);
    return rt_outline_meets_box(&outline, box, margin);
}

static const double margin = 1e-9;

static RtBox cube(float x, float y, float z, float half) {
    return (RtBox){{x - half, y - half, z - half}, {x + half, y + half, z + half}};
}

static bool meets(const RtGeometry *g, RtBox box) {
    return object_meets_box(g, 0, &box, margin);
}

RT_TEST(a_box_inside_a_sphere_or_off_its_corner_is_not_met) {
    OWNED_OBJECT(g, sphere, rt_vec3(0, 0, 0), 1);
    assert_false(meets(&g, cube(0, 0, 0, 0.5f)));
    assert_true(meets(&g, cube(0, 0, 0, 0.6f))); /* its corners stick out */
    assert_true(meets(&g, cube(1, 0, 0, 0.1f)));
    assert_false(meets(&g, cube(0.9f, 0.9f, 0.9f, 0.1f))); /* inside the sphere's box */
}

RT_TEST(a_box_in_the_box_of_a_triangle_is_met_by_plane_and_edges) {
    const RtVec3 v[3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 1}};
    OWNED_OBJECT(g, triangle, v, NULL);
    assert_true(meets(&g, cube(0.25f, 0.25f, 0.25f, 0.01f)));
    assert_false(meets(&g, cube(0.25f, 0.25f, 0.5f, 0.1f))); /* above the plane */
    assert_false(meets(&g, cube(0.8f, 0.8f, 0.8f, 0.2f)));   /* beyond the slanted edge */
    RtBox above = cube(0.25f, 0.25f, 0.5f, 0.1f);
    assert_true(object_meets_box(&g, 0, &above, 0.1));
}

RT_TEST(a_slanted_polygon_is_met_like_a_triangle) {
    const RtVec3 v[4] = {{0, 0, 0}, {1, 0, 1}, {1, 1, 1}, {0, 1, 0}};
    OWNED_OBJECT(g, polygon, v, 4);
    assert_true(meets(&g, cube(0.5f, 0.5f, 0.5f, 0.01f)));
    assert_false(meets(&g, cube(0.25f, 0.5f, 0.75f, 0.2f)));
}

RT_TEST(a_slanted_cylinder_leaves_corners_of_its_box_free) {
    OWNED_OBJECT(g, cone, rt_vec3(0, 0, 0), 0.1f, rt_vec3(10, 10, 0), 0.1f);
    assert_true(meets(&g, cube(5, 5, 0.1f, 0.01f)));
    assert_false(meets(&g, cube(1, 9, 0, 0.5f)));
}

/* Asserts the part of object 0 in a box, to a few units of float32. */
static void assert_part(const RtGeometry *g, RtBox box, RtBox expected) {
    RtBox part;
    assert_true(rt_object_part(g, 0, &box, margin, &part));
    for (int a = 0; a < 3; a++) {
        if (fabsf(part.lo.at[a] - expected.lo.at[a]) < 1e-6f &&
            fabsf(part.hi.at[a] - expected.hi.at[a]) < 1e-6f) {
            continue;
        }
        fail_msg("axis %d: %g to %g for %g to %g", a, (double)part.lo.at[a], (double)part.hi.at[a],
                 (double)expected.lo.at[a], (double)expected.hi.at[a]);
    }
}

RT_TEST(parts_of_a_triangle_and_of_a_concave_polygon_are_clipped) {
    const RtVec3 v[3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 1}};
    const RtVec3 l[6] = {{0, 0, 0}, {4, 0, 0}, {4, 1, 0}, {1, 1, 0}, {1, 4, 0}, {0, 4, 0}};
    OWNED_GEOMETRY triangle = {0}, concave = {0};
    assert_ok(rt_geometry_add_triangle(&triangle, v, NULL, error));
    assert_ok(rt_geometry_finish(&triangle, error));
    assert_part(&triangle, (RtBox){{0.75f, 0, 0}, {1, 1, 1}}, (RtBox){{0.75f, 0, 0}, {1, 0.25f, 0.25f}});
    assert_part(&triangle, (RtBox){{0, 0.5f, 0}, {1, 1, 1}}, (RtBox){{0, 0.5f, 0.5f}, {0.5f, 1, 1}});
    RtBox beyond = cube(0.9f, 0.9f, 0.9f, 0.1f), part;
    assert_false(rt_object_part(&triangle, 0, &beyond, margin, &part));
    assert_ok(rt_geometry_add_polygon(&concave, l, 6, error));
    assert_ok(rt_geometry_finish(&concave, error));
    assert_part(&concave, (RtBox){{0, 2, -1}, {4, 4, 1}}, (RtBox){{0, 2, 0}, {1, 4, 0}});
    assert_part(&concave, (RtBox){{0.5f, 0, -1}, {4, 4, 1}}, (RtBox){{0.5f, 0, 0}, {4, 4, 0}});
}

RT_TEST(parts_of_balls_and_cones_end_where_they_narrow) {
    OWNED_GEOMETRY ball = {0}, cone = {0};
    RtBox inside = cube(0, 0, 0, 0.5f), part;
    assert_ok(rt_geometry_add_sphere(&ball, rt_vec3(0, 0, 0), 1, error));
    assert_ok(rt_geometry_finish(&ball, error));
    assert_part(&ball, (RtBox){{0.8f, -1, -1}, {1, 1, 1}}, (RtBox){{0.8f, -0.6f, -0.6f}, {1, 0.6f, 0.6f}});
    assert_false(rt_object_part(&ball, 0, &inside, margin, &part));
    assert_ok(rt_geometry_add_cone(&cone, rt_vec3(0, 0, 0), 1, rt_vec3(0, 0, 4), 0, error));
    assert_ok(rt_geometry_finish(&cone, error));
    assert_part(&cone, (RtBox){{-1, -1, 2}, {1, 1, 3}}, (RtBox){{-0.5f, -0.5f, 2}, {0.5f, 0.5f, 3}});
    assert_part(&cone, (RtBox){{0.75f, -1, 0}, {1, 1, 4}}, (RtBox){{0.75f, -1, 0}, {1, 1, 1}});
}

/* The box of the object is cut into eight by planes through a point of its surface: the point is in the part
 * in each of them. */
static void assert_parts_hold(const RtScene *scene, uint32_t id, RtVec3 point, double near) {
    RtBox own = scene->geometry.boxes[id], part;
    point = rt_vec_min(rt_vec_max(point, own.lo), own.hi);
    for (uint32_t octant = 0; octant < 8; octant++) {
        RtBox box = own;
        for (int a = 0; a < 3; a++) (octant >> a & 1 ? &box.lo : &box.hi)->at[a] = point.at[a];
        if (rt_object_part(&scene->geometry, id, &box, near, &part) &&
            rt_box_contains(part, (RtBox){point, point}) && rt_box_contains(box, part)) {
            continue;
        }
        fail_msg("%s: the part of object %u in octant %u does not hold a hit", scene->name, id, octant);
    }
}

/* Points that rays hit are points of surfaces: boxes around them are met, for every shape. */
RT_TEST(boxes_about_hits_are_met) {
    for (size_t family = 0; family < rt_family_count(); family++) {
        enum { RAYS = 500 };
        RtRay rays[RAYS];
        RtHit hits[RAYS];
        OWNED_SCENE scene = open_family(family, 1);
        OWNED_ACCEL RtAccel *brute = open_accel(&scene, "brute");
        OWNED_QUERY query = open_query(brute);
        rt_ray_family_fill(0, &query, 7, 0, RAYS, rays);
        rt_nearest(&query, rays, RAYS, hits, NULL);
        for (size_t i = 0; i < RAYS && scene.geometry.object_count > 0; i++) {
            if (hits[i].object == RT_NO_OBJECT) continue;
            RtVec3 p = rt_narrow(rt_ray_point(&rays[i], hits[i].t));
            RtBox point = {p, p};
            RtVec3 size = rt_box_size(scene.geometry.box);
            double far = fabs((double)p.x) + fabs((double)p.y) + fabs((double)p.z);
            double near = 0x1p-16 * rt_lengthd(rt_widen(size)) + 0x1p-22 * far;
            const uint32_t object = rt_geometry_holder(&scene.geometry, hits[i].object);
            if (!object_meets_box(&scene.geometry, object, &point, near))
                fail_msg("%s: ray %zu hits object %u where it is not", scene.name, i, object);
            assert_parts_hold(&scene, object, p, near);
        }
    }
}

/* One sphere in 4 x 4 x 4 voxels of half its radius: its box touches all of them, its surface all but the 8
 * in the middle, whose farthest points are at 0.87 of the radius, as are the nearest of the corners. */
RT_TEST(a_grid_leaves_out_voxels_inside_a_sphere) {
    OWNED_SCENE_OF(scene, sphere, rt_vec3(0, 0, 0), 1);
    assert_int_equal(describe_spec(&scene, "grid:resolution=4x4x4").references, 64);
    assert_int_equal(describe_spec(&scene, "grid:resolution=4x4x4,overlap=exact").references, 56);
    assert_int_equal(describe_spec(&scene, "grid:resolution=1x1x1,overlap=exact").references, 1);
}

/* Half a square, x >= y, that rises with x, and a ray past it: at org the line is beyond the slanted edge, by
 * the time it is as high as the triangle it has moved an eighth of that along x, and hits. Its dir is so
 * short that 1 / dir.x is infinite: to crossings it looks as if it stayed at x = 0.3, where voxels do not
 * list the triangle. accel/clipping.h has such rays tested against every object. */
RT_TEST(a_ray_with_the_shortest_of_directions_is_not_trusted_to_voxels) {
    static const char *const specs[] = {"brute", "grid:resolution=32x32x32,overlap=exact"};
    const RtVec3 v[3] = {{0, 0, 0.5f}, {1, 0, 1.5f}, {1, 1, 1.5f}};
    const RtRay ray = {.org = {0.3f, 0.35f, 0}, .dir = {0x1p-129f, 0, 0x1p-126f}, .tmax = INFINITY};
    OWNED_SCENE_OF(scene, triangle, v, NULL);
    for (size_t i = 0; i < 2; i++) {
        RtHit hit;
        OWNED_ACCEL RtAccel *accel = open_accel(&scene, specs[i]);
        OWNED_QUERY query = open_query(accel);
        rt_nearest(&query, &ray, 1, &hit, NULL);
        assert_int_equal(hit.object, 0);
        assert_true(hit.t > 0.9f * 0x1p126f && hit.t < 0.95f * 0x1p126f);
    }
}

/* ---- the size of the bounds ----
 *
 * Cases at the edge of a bound: what is off by 31/32 of it is not culled, so the tests fail with 15/16. */

static const double within = 31.0 / 32, beyond = 33.0 / 32;

/* Voxels 2 x 2 over the unit square, and a triangle whose slanted edge passes their common corner at `off`
 * along each axis. The other object is in one voxel. */
static uint32_t references_at(double off) {
    const float side = (float)(1 - 2 * off);
    const RtVec3 slanted[3] = {{{0, 0, 0.5f}}, {{side, 0, 0.5f}}, {{0, side, 0.5f}}};
    const RtVec3 corner[3] = {{{1, 1, 0}}, {{0.875f, 1, 0}}, {{1, 0.875f, 1}}};
    OWNED_SCENE scene = begin_scene();
    assert_ok(rt_scene_add_triangle(&scene, 0, slanted, NULL, error));
    assert_ok(rt_scene_add_triangle(&scene, 0, corner, NULL, error));
    assert_ok(rt_scene_finish(&scene, error));
    return (uint32_t)describe_spec(&scene, "grid:resolution=2x2x1,overlap=exact").references;
}

RT_TEST(a_voxel_lists_the_surfaces_within_the_margin) {
    const double bound = 0x1p-18 * 9;
    assert_int_equal(references_at(within * bound), 1 + 4);
    assert_int_equal(references_at(beyond * bound), 1 + 3);
}

RT_TEST(rays_from_outside_the_domain_are_not_served_on_any_side) {
    const RtBox scene = cube(3, 3, 3, 1);
    const RtClippedRays served = rt_clipped_rays(&scene, &scene);
    RtPreparedRay ray = {.org = {3, 3, 3}, .dir = {0, 0, 1}, .kz = 2};
    assert_true(rt_clipped_serves(&served, &ray));
    for (int a = 0; a < 3; a++) {
        for (int side = -1; side <= 1; side += 2) {
            ray.org[a] = 3 + (float)side * (1 + 2 * RT_CLIPPED_SIDES);
            assert_true(rt_clipped_serves(&served, &ray));
            ray.org[a] += (float)side;
            assert_false(rt_clipped_serves(&served, &ray));
        }
        ray.org[a] = 3;
    }
}

RT_TEST(the_margin_of_surfaces_covers_large_coordinates_and_the_least_numbers) {
    const RtBox far = {{{0x1p40f, 0, 0}}, {{0x1p40f, 0, 0}}}, point = {{{0, 0, 0}}, {{0, 0, 0}}};
    assert_true(rt_clipped_rays(&far, &far).margin >= within * 1);
    assert_true(rt_clipped_rays(&point, &point).margin >= within * 0x1p-80);
}

/* Half a square, x >= y, cut at y = 0: its part begins at x = 0, less the margin by which the cut is late,
 * and the margin by which the part is grown. */
RT_TEST(the_part_of_an_object_reaches_beyond_its_surface_by_the_margin) {
    const RtVec3 v[3] = {{{-1, -1, 0}}, {{1, 1, 0}}, {{1, -1, 0}}};
    const RtBox above = {{{-1, 0, -1}}, {{1, 1, 1}}};
    RtBox part;
    OWNED_OBJECT(g, triangle, v, NULL);
    assert_true(rt_object_part(&g, 0, &above, rt_tree_part_margin(&g.box), &part));
    assert_true((double)part.lo.x <= -within * 0x1p-39 && (double)part.lo.x >= -beyond * 0x1p-39);
}

/* The pole of the unit sphere, where rounding the distance by 2^-40 moves the circle by 2^-20. */
RT_TEST(the_part_of_a_sphere_covers_the_rounding_of_a_square) {
    const RtBox above = {{{-2, 1, -2}}, {{2, 2, 2}}};
    RtBox part;
    OWNED_OBJECT(g, sphere, rt_vec3(0, 0, 0), 1);
    assert_true(rt_object_part(&g, 0, &above, 0x1p-60, &part));
    assert_true((double)part.hi.x >= 0.98 * 0x1p-20 && (double)part.hi.x <= 1.02 * 0x1p-20);
}

RT_TESTS(overlap, NULL, NULL)
