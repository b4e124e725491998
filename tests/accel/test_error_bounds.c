/* SPDX-License-Identifier: Apache-2.0 */
/* The size of the bounds on rounding errors in accel/. A test builds the case at the edge of a bound as its
 * proof states it: what is off by 31/32 of the bound is not culled. With 15/16 of the bound the test fails. A
 * test of both sides also fails with 17/16. Most proofs leave a margin that no ray uses up: the last tests
 * search for the largest errors that there are. */
#include "item_testing.h"
#include "light_testing.h"
#include "random_testing.h"

#include "accel/batch.h"
#include "accel/extent.h"

static const double within = 31.0 / 32, beyond = 33.0 / 32;

/* ---- extents (accel/extent.h) ---- */

/* The line along z from `org`, in a scene of this box. */
static RtLine line_along_z(const RtExtentSet *set, RtVec3 org, RtBox scene_box) {
    const RtRay ray = {.org = org, .dir = {{0, 0, 1}}, .tmax = INFINITY};
    const RtPreparedRay prepared = rt_ray_prepare(&ray, &scene_box);
    return rt_line(set, set->kind, &(RtGeometry){.box = scene_box}, &prepared);
}

static bool meets_ball(RtVec3 org, RtBox scene_box, double off, double radius) {
    const RtExtentSet set = {.kind = RT_EXTENT_SPHERE};
    RtLine line = line_along_z(&set, org, scene_box);
    const RtBall ball = {{{(double)org.x + radius + off, (double)org.y, (double)org.z + 5}}, radius};
    return rt_line_meets_ball(&line, &ball);
}

RT_TEST(a_line_meets_an_extent_that_it_misses_by_the_pad) {
    const RtBox box = {{{-1, -1, -1}}, {{1000, 2, 2}}}; /* 1000 away */
    const RtExtentSet oriented = {.kind = RT_EXTENT_OBB}, slabs = {.kind = RT_EXTENT_SLABS, .slabs_each = 3};
    for (int side = 0; side < 2; side++) {
        double off = (side ? beyond : within) * 0x1p-18 * 1000;
        RtOrientedBox cube = {
            {rt_slab_normals[0], rt_slab_normals[1], rt_slab_normals[2]}, {{1 + off, 0, 5}}, {1, 1, 1}};
        const RtSlab three[3] = {{(float)off, 2}, {-1, 1}, {4, 6}};
        RtLine line = line_along_z(&oriented, rt_vec3(0, 0, 0), box);
        assert_int_equal(rt_line_meets_oriented_box(&line, &cube), side == 0);
        line = line_along_z(&slabs, rt_vec3(0, 0, 0), box);
        assert_int_equal(rt_line_meets_slabs(&line, three, 3), side == 0);
        assert_int_equal(meets_ball(rt_vec3(0, 0, 0), box, off, 1), side == 0);
    }
}

/* In a scene that is a point, the pad is 2^-48 of the origin's coordinate, 16 units of its last place; at 0
 * it is 2^-140. */
RT_TEST(the_pad_covers_the_last_places_of_coordinates_and_the_least_numbers) {
    const RtVec3 one = rt_vec3(1, 1, 1), zero = rt_vec3(0, 0, 0);
    assert_true(meets_ball(one, (RtBox){one, one}, 0x1p-48, 0));
    assert_false(meets_ball(one, (RtBox){one, one}, 0x1.1p-48, 0));
    assert_true(meets_ball(zero, (RtBox){zero, zero}, within * 0x1p-140, 0));
    assert_false(meets_ball(zero, (RtBox){zero, zero}, beyond * 0x1p-140, 0));
}

/* The sphere of radius 1 about (1, 0, 0): its largest coordinate is 2. */
RT_TEST(fitted_extents_are_inflated_by_their_rounding) {
    const double least = within * 0x1p-46 * 2, most = beyond * 0x1p-46 * 2;
    const uint32_t id = 0;
    OWNED_OBJECT(g, sphere, rt_vec3(1, 0, 0), 1);
    const RtGroup group = {&g, &id, 1, g.box};
    for (RtExtentKind kind = RT_EXTENT_SPHERE; kind <= RT_EXTENT_SLABS; kind++) {
        RT_ARENA(arena);
        RtExtentSet set;
        assert_ok(rt_extent_set_init(&set, &arena, kind, 3, 1, error));
        rt_extent_fit(&set, 0, &group);
        double by = kind == RT_EXTENT_SPHERE ? set.balls[0].radius - 1
                    : kind == RT_EXTENT_OBB  ? set.oriented[0].half[0] - 1
                                             : -(double)set.slabs[0].lo;
        assert_true(by >= least && by <= most);
    }
}

/* ---- spheres in lanes (accel/batch.h) ---- */

static bool passes_sphere(float x, float z, float radius) {
    float spheres[4 * RT_LANES] = {0};
    const RtSphereLine line = {{{0, 0, 0}}, {{0, 0, 1}}};
    spheres[0] = x;
    spheres[2 * RT_LANES] = z;
    spheres[3 * RT_LANES] = radius;
    return rt_sphere_prefilter(spheres, RT_LANES, &line) & 1;
}

/* Each term alone: of the distance, of the radius, and for the least numbers. */
RT_TEST(the_sphere_prefilter_passes_what_its_bound_allows) {
    for (int side = 0; side < 2; side++) {
        double part = side ? beyond : within;
        assert_int_equal(passes_sphere((float)sqrt(part * 0x1p-31), 1, 0), side == 0);
        assert_int_equal(passes_sphere((float)sqrt(1 + part * 0x1p-9), 0, 1), side == 0);
        assert_int_equal(passes_sphere((float)sqrt(part * 0x1p-120), 0, 0), side == 0);
    }
}

/* ---- item (accel/item) ---- */

/* A square picture of half this width at distance 1, of samples x samples. */
static RtScene begin_square(RtVec3 eye, double half_width, uint32_t samples) {
    RtScene scene = begin_view();
    scene.camera.width = scene.camera.height = samples;
    scene.camera.fov = (float)(2 * atan(half_width) * 180 / 3.14159265358979);
    look(&scene, eye, rt_add(eye, rt_vec3(0, 1, 0)));
    return scene;
}

/* A polygon, or a triangle, at depth y from `eye`: beside the axis by `off`, as high as `height` either way.
 */
static void add_beside(RtScene *scene, bool polygon, RtVec3 eye, double off, double y, float width,
                       float height) {
    const float x[2] = {(float)off, width}, at = (float)y;
    RtVec3 v[4] = {{{x[0], at, -height}}, {{x[0], at, height}}, {{x[1], at, height}}, {{x[1], at, -height}}};
    if (!polygon) v[2] = v[3] = rt_vec3(x[1], at, 0);
    for (int i = 0; i < 4; i++) v[i] = rt_add(v[i], eye);
    if (polygon)
        assert_ok(rt_scene_add_polygon(scene, 0, v, 4, error));
    else
        assert_ok(rt_scene_add_triangle(scene, 0, v, NULL, error));
}

/* Where an object is seen that is beside the axis by `off`; false if the middle column is not among these. */
static bool is_seen_on_axis(RtVec3 eye, double off, float height, RtItemFootprint *at) {
    OWNED_SCENE scene = begin_square(eye, 1, 5);
    add_beside(&scene, true, eye, off, 1, 0.5f, height);
    assert_ok(rt_scene_finish(&scene, error));
    OWNED_ACCEL RtItemBuffer *buffer = open_accel(&scene, "item+brute");
    assert_true(rt_item_footprint(buffer, 0, at));
    return at->lo[0] <= 2 && at->hi[0] >= 2;
}

/* E = 2^-19 M + 2^-21 |eye|, first mostly by M, then by the eye. */
RT_TEST(the_footprint_of_an_object_is_grown_by_its_bound) {
    const RtVec3 eyes[2] = {{{0, 0, 0}}, {{0, 0, 1000}}};
    const float heights[2] = {100, 1};
    for (int i = 0; i < 2; i++) {
        RtItemFootprint at;
        double grow = 0x1p-19 * (double)heights[i] + 0x1p-21 * (double)eyes[i].z;
        assert_false(is_seen_on_axis(eyes[i], beyond * grow, heights[i], &at));
        assert_true(is_seen_on_axis(eyes[i], within * grow, heights[i], &at));
        assert_true((double)at.near <= 1 - within * grow && (double)at.near >= 1 - beyond * grow);
    }
}

/* A direction's rounding moves its place in the image by 2^-22 g (1 + 1 / right + 1 / down), g being the
 * longest direction: here by 9 * 2^-22, beside E = 2^-19. */
RT_TEST(the_footprint_of_an_object_covers_the_rounding_of_directions) {
    RtItemFootprint at;
    const double error = 9.003 * 0x1p-22;
    assert_true(is_seen_on_axis(rt_vec3(0, 0, 0), 0x1p-19 + within * error, 1, &at));
    assert_false(is_seen_on_axis(rt_vec3(0, 0, 0), 0x1p-19 + beyond * error, 1, &at));
}

/* A triangle at depth 1 in a picture of 64 x 64, 2 wide, whose vertex is seen to the right of column 31 by a
 * part of the bound; and the part of the bound by which its t may be less. Both rise with |q|, the largest
 * sum of a vertex's coordinates. */
static RtItemRange place_triangle(float height, double part) {
    const double longest = 3.001, reach = (32 + 64) * longest, oblique = 1.25 + (double)height;
    const double pad = reach * (0x1p-17 + oblique * 0x1p-20) * oblique, x = (31.5 + part * pad) / 32 - 1;
    const RtVec3 v[3] = {{{(float)x, 1, 0}}, {{0.25f, 1, -height}}, {{0.25f, 1, height}}};
    RtItemRange placed[1];
    OWNED_SCENE scene = begin_square(rt_vec3(0, 0, 0), 1, 64);
    assert_ok(rt_scene_add_triangle(&scene, 0, v, NULL, error));
    assert_ok(rt_scene_finish(&scene, error));
    OWNED_ACCEL RtItemBuffer *buffer = open_accel(&scene, "item+brute");
    for (int i = 0; i < RT_ITEM_CLASSES - 1; i++)
        buffer->farther[i] = (float)(1 - part * oblique * 0x1p-16 * longest);
    assert_int_equal(buffer->raster->place(buffer, 0, 1, placed), 1);
    return placed[0];
}

RT_TEST(a_triangle_is_placed_where_its_vertices_may_be_seen_within_their_bound) {
    for (int tall = 0; tall < 2; tall++) {
        float height = tall ? 30 : 0.25f;
        RtItemRange in = place_triangle(height, within), out = place_triangle(height, beyond);
        assert_true(in.lo[0] == 0 && in.depth == 0);
        assert_true(out.lo[0] == 1 && out.depth > 0);
    }
}

/* ---- light (accel/light) ---- */

/* A screen below a light at the height of 10, all moved by `away`. */
static RtScene make_lit(float away) {
    const RtVec3 square[4] = {{{-4, -4, 5}}, {{4, -4, 5}}, {{4, 4, 5}}, {{-4, 4, 5}}};
    RtVec3 v[4];
    RtScene scene = begin_scene();
    for (int i = 0; i < 4; i++) v[i] = moved(square[i], away);
    assert_ok(rt_scene_add_polygon(&scene, 0, v, 4, error));
    assert_ok(rt_scene_add_light(&scene, moved(rt_vec3(0, 0, 10), away), rt_vec3(1, 1, 1), error));
    assert_ok(rt_scene_finish(&scene, error));
    return scene;
}

/* E = 2^-18 of the longest side of the box around domain and light, and 2^-20 of its largest coordinate. */
static double light_margin(const RtLightBuffer *buffer, const RtScene *scene) {
    RtBox all = rt_box_add_point(buffer->domain, scene->lights[0].position);
    return 0x1p-18 * rt_box_longest_side(all) + 0x1p-20 * rt_box_largest_coordinate(all);
}

/* Near 0 the longest side matters, far off the largest coordinate. */
RT_TEST(boxes_seen_from_a_light_are_grown_by_the_margin) {
    for (int far = 0; far < 2; far++) {
        OWNED_SCENE scene = make_lit(far ? 1e4f : 0);
        OWNED_ACCEL RtLightBuffer *buffer = open_accel(&scene, "light:cells=16+brute");
        const double margin = light_margin(buffer, &scene);
        const RtLightFace down = rt_light_face(buffer, 0, 4);
        RtVec3 place = scene.lights[0].position;
        RtLightView view;
        RtBox box = {rt_add(place, rt_vec3(-1, -1, -2)), rt_add(place, rt_vec3(1, 1, -1))};
        assert_true(rt_light_view(&down, &box, &view));
        double by[2] = {1 - view.near, view.far - 2};
        for (int i = 0; i < 2; i++) assert_true(by[i] >= within * margin && by[i] <= beyond * margin);
    }
}

RT_TEST(views_from_a_light_are_wider_by_an_edge) {
    OWNED_SCENE scene = make_lit(0);
    OWNED_ACCEL RtLightBuffer *buffer = open_accel(&scene, "light:cells=16+brute");
    const double margin = buffer->cubes[0].margin;
    const RtLightFace down = rt_light_face(buffer, 0, 4);
    const RtBox box = {{{-1, -1, 8}}, {{1, 1, 9}}};
    RtLightView view;
    assert_true(rt_light_view(&down, &box, &view));
    /* Nearest at depth 1, where it is 1 to either side; beyond the border of the face it is cut. */
    const RtBox narrow = {{{-0.5f, -0.5f, 8}}, {{0.5f, 0.5f, 9}}};
    for (int k = 0; k < 2; k++) assert_true(view.hi[k] >= 1 + within * 0x1p-20 && view.lo[k] <= -view.hi[k]);
    assert_true(rt_light_view(&down, &narrow, &view));
    double without = (0.5 + margin) / (1 - margin);
    for (int k = 0; k < 2; k++) {
        assert_true(view.hi[k] - without >= within * 0x1p-20 && view.hi[k] - without <= beyond * 0x1p-20);
        assert_true(-view.lo[k] - without >= within * 0x1p-20);
    }
}

/* ---- the largest errors ---- */

/* With exact or nearly exact arithmetic: none is larger than its proof says, and one is as large as the test
 * says, which is what the search finds less a sixteenth. A bound below that is wrong for a ray. */

typedef struct Case {
    RtRay ray;
    RtVec3 v[3];
} Case;

/* How far the line of a ray passes a triangle beyond an edge, along the two axes across the ray, in units of
 * 2^-24 of the farthest coordinate from its origin: the least shift of both coordinates that makes up for it.
 */
static double units_beyond_an_edge(const Case *c) {
    int z = rt_major_axis(c->ray.dir), axes[2] = {rt_next_axis(z), rt_next_axis(rt_next_axis(z))};
    long double far = 0, at[3][2], area = 0, most = 0;
    for (int i = 0; i < 3; i++) {
        long double d[3];
        for (int a = 0; a < 3; a++) {
            d[a] = (long double)c->v[i].at[a] - (long double)c->ray.org.at[a];
            far = fmaxl(far, fabsl(d[a]));
        }
        for (int k = 0; k < 2; k++)
            at[i][k] =
                d[axes[k]] - d[z] * (long double)c->ray.dir.at[axes[k]] / (long double)c->ray.dir.at[z];
    }
    for (int i = 0; i < 3; i++) area += at[i][0] * at[(i + 1) % 3][1] - at[i][1] * at[(i + 1) % 3][0];
    for (int i = 0; i < 3; i++) {
        const long double *a = at[i], *b = at[(i + 1) % 3];
        long double side = (a[0] * b[1] - a[1] * b[0]) * (area < 0 ? -1 : 1);
        long double length = fabsl(b[0] - a[0]) + fabsl(b[1] - a[1]);
        if (length > 0) most = fmaxl(most, -side / length);
    }
    return (double)(most / (far * 0x1p-24L));
}

static bool hits_triangle(const Case *c) {
    RtBox box = rt_box_add_point(rt_box_add_point((RtBox){c->v[0], c->v[0]}, c->v[1]), c->v[2]);
    RtPreparedRay prepared = rt_ray_prepare(&c->ray, &box);
    float t;
    return raytally_triangle_hit(c->v[0].at, 3, 1, &prepared, &t);
}

/* A ray along a diagonal, for the largest products, past an edge along ky by a few units along kx. Its
 * distances are just above powers of two, where rounding is coarsest. */
static Case random_case(RtRandom *random) {
    Case c = {.ray = {.org = rt_random_point(random, 1), .tmax = INFINITY}};
    c.ray.dir = rt_vec3(rt_random_between(random, 0.95f, 1), rt_random_between(random, 0, 0.5f), 1);
    c.ray.dir = rt_scale(c.ray.dir, rt_random_between(random, 0.9f, 1));
    RtVec3d p = rt_ray_point(&c.ray, rt_random_between(random, 1, 1.2f));
    p.x += rt_random_betweend(random, 0, 7) * 0x1p-24;
    for (int i = 0; i < 3; i++) c.v[i] = rt_narrow(p);
    c.v[0].y -= 0.1f, c.v[1].y += 0.1f, c.v[2].x += 0.1f;
    return c;
}

/* A coordinate moves by some units of the last place, that of the edge along its whole length. */
static Case changed_case(RtRandom *random, Case c) {
    int axis = rt_random_below(random, 2) ? 0 : 2;
    float by = ldexpf(rt_random_between(random, -1, 1), -16 - (int)rt_random_below(random, 8));
    switch (rt_random_below(random, 3)) {
    case 0: c.ray.org.at[axis] += by; break;
    case 1: c.ray.dir.at[axis] += by; break;
    case 2: c.v[0].at[axis] = c.v[1].at[axis] += by; break;
    }
    return c;
}

/* The shear of vertices is off by 7 units (accel/extent.h): what misses a triangle by more is never hit. */
RT_TEST(no_triangle_is_hit_farther_off_than_its_bound_and_one_nearly_so) {
    enum { STARTS = RT_SHARE(1000, 20), STEPS = 1500 };
    RtRandom random = rt_random(7, 0);
    double most = 0;
    for (int start = 0; start < STARTS; start++) {
        Case best = random_case(&random);
        double units = hits_triangle(&best) ? units_beyond_an_edge(&best) : 0;
        for (int i = 0; i < STEPS; i++) {
            Case next = changed_case(&random, best);
            if (!rt_ray_is_valid(&next.ray) || !hits_triangle(&next)) continue;
            double now = units_beyond_an_edge(&next);
            if (now >= units) units = now, best = next;
        }
        most = fmax(most, units);
    }
    if (!(most <= 7 && most >= RT_SHARE(3.5, 1))) fail_msg("the largest error is %g units", most);
}

/* In float32, |o x u| is off by less than 2^-21 |o| (accel/sphere_prefilter.h). */
RT_TEST(the_distance_of_a_sphere_in_lanes_is_off_by_less_than_its_bound) {
    RtRandom random = rt_random(8, 0);
    double most = 0;
    for (int i = 0; i < 300000; i++) {
        RtVec3 center = rt_random_point(&random, 1);
        RtRay ray = {.org = rt_random_point(&random, 1), .tmax = INFINITY};
        ray.dir = rt_add(rt_sub(center, ray.org), rt_random_point(&random, i % 2 ? 0x1p-10f : 1));
        RtPreparedRay prepared = rt_ray_prepare(&ray, &(RtBox){center, center});
        const RtVec3 u = rt_sphere_line(&prepared).dir, o = rt_sub(center, ray.org);
        RtVec3d exact = rt_crossd(rt_subd(rt_widen(center), rt_widen(ray.org)), rt_widen(ray.dir));
        const float across[3] = {o.y * u.z - o.z * u.y, o.z * u.x - o.x * u.z, o.x * u.y - o.y * u.x};
        RtVec3d rounded = {{(double)across[0], (double)across[1], (double)across[2]}};
        double off = rt_lengthd(rounded) - rt_lengthd(exact) / rt_lengthd(rt_widen(ray.dir));
        most = fmax(most, fabs(off) / (0x1p-21 * rt_lengthd(rt_widen(o))));
    }
    if (!(most <= 1 && most >= 0.24)) fail_msg("the largest error is %g of the bound", most);
}

/* Where the rounded direction of a sample is seen, against where the sample is. */
RT_TEST(rounded_directions_are_seen_within_their_bound) {
    double most = 0;
    for (int k = 0; k < 24; k++) {
        OWNED_SCENE scene = begin_view();
        RtRandom random = rt_random(9, (uint64_t)k);
        scene.camera.fov = 5 + 7 * (float)k;
        look(&scene, rt_vec3(0, 0, 0), rt_narrow(rt_random_direction(&random)));
        assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(0, 0, 0), 1, error));
        assert_ok(rt_scene_finish(&scene, error));
        OWNED_ACCEL RtItemBuffer *buffer = open_accel(&scene, "item+brute");
        const RtItemProjection *to = &buffer->projection;
        const uint32_t columns = buffer->view.sampling.columns, rows = buffer->view.sampling.rows;
        for (uint32_t i = 0; i < columns * rows; i++) {
            RtVec3d dir = rt_widen(rt_view_ray(&buffer->view, i % columns, i / columns).dir);
            double depth = rt_dotd(dir, to->depth);
            double x = (rt_dotd(dir, to->x) / depth - i % columns) * 2 / columns;
            double y = (rt_dotd(dir, to->y) / depth - i / columns) * 2 / rows;
            most = fmax(most, fmax(fabs(x), fmax(fabs(y), fabs(depth - 1))) / to->direction_error);
        }
    }
    if (!(most <= 1 && most >= 0.0715)) fail_msg("the largest error is %g of the bound", most);
}

RT_TESTS(error_bounds, NULL, NULL)
