/* SPDX-License-Identifier: Apache-2.0 */
/* The largest rounding errors in accel/ that a search finds, with exact or nearly exact arithmetic: none is
 * larger than its proof says, and one is as large as the test says, which is what the search finds less a
 * sixteenth. A bound below that is wrong for a ray. */
#include "item_testing.h"
#include "random_testing.h"

#include "accel/batch.h"

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

/* In float32, |o x u| is off by less than 2^-21 |o| (accel/batch.h). */
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

RT_TESTS(largest_errors, NULL, NULL)
