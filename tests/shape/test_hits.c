/* SPDX-License-Identifier: Apache-2.0 */
/* shape/: the guarantees of all hit functions: closed intervals of t, exact scaling by powers of two, and
 * no hits beyond an object, however flat. */
#include "crossings_testing.h"
#include "random_testing.h"
#include "testing.h"

#include "base/ray_testing.h"

#include <float.h>

/* One object of each kind, about the origin, 2^exponent in size; 0.75 and the like survive the scaling. */
static RtGeometry one_of_each(int exponent) {
    RtGeometry g = {0};
    float s = ldexpf(1, exponent);
    const RtVec3 notched[] = {{{-s, -s, 0.25f * s}},
                              {{s, -s, 0.25f * s}},
                              {{s, s, -0.25f * s}},
                              {{0, 0, 0}},
                              {{-s, s, -0.25f * s}}};
    const RtVec3 triangle[] = {{{-s, -s, 0}}, {{s, -0.5f * s, 0.5f * s}}, {{0.25f * s, s, -0.25f * s}}};
    assert_ok(rt_geometry_add_sphere(&g, rt_vec3(0.125f * s, 0, 0), 0.75f * s, error));
    assert_ok(rt_geometry_add_polygon(&g, notched, 5, error));
    assert_ok(rt_geometry_add_triangle(&g, triangle, NULL, error));
    assert_ok(rt_geometry_add_cone(&g, rt_vec3(0, -s, 0), s, rt_vec3(0.5f * s, s, 0), 0, error));
    assert_ok(rt_geometry_add_cone(&g, rt_vec3(0, 0, -s), 0.5f * s, rt_vec3(0, 0, s), 0.5f * s, error));
    assert_ok(rt_geometry_add_cone(&g, rt_vec3(-s, 0, 0), 0.25f * s, rt_vec3(s, s, s), 0.75f * s, error));
    assert_ok(rt_geometry_finish(&g, error));
    return g;
}

/* Through a point of [-1, 1]^3, from up to 3 before it. */
static RtRay random_ray(RtRandom *random) {
    RtVec3 target = rt_random_point(random, 1);
    RtVec3d dir = rt_random_direction(random);
    RtVec3d org = rt_add_scaledd(rt_widen(target), dir, -3 * (double)rt_random_unit(random));
    return ray_along(rt_narrow(org), rt_narrow(dir));
}

enum { RAYS = 4000 };

RT_TEST(both_ends_of_the_interval_of_t_belong_to_it) {
    OWNED_GEOMETRY g = one_of_each(0);
    RtRandom random = rt_random(1, 0);
    int hits = 0;
    for (int i = 0; i < RAYS; i++) {
        RtRay ray = random_ray(&random);
        uint32_t id = (uint32_t)i % g.object_count;
        float t, again;
        if (!hit(&g, id, &ray, &t) || t == 0) continue;
        hits++;
        ray.tmin = ray.tmax = t;
        assert_true(hit(&g, id, &ray, &again) && again == t);
        ray.tmin = 0, ray.tmax = nextafterf(t, 0);
        assert_false(hit(&g, id, &ray, &again));
        ray.tmin = nextafterf(t, INFINITY), ray.tmax = INFINITY;
        assert_true(!hit(&g, id, &ray, &again) || again > t);
    }
    assert_true(hits > RAYS / 8);
}

RT_TEST(a_direction_twice_as_long_halves_t_to_the_bit) {
    OWNED_GEOMETRY g = one_of_each(0);
    RtRandom random = rt_random(2, 0);
    for (int i = 0; i < RAYS; i++) {
        RtRay ray = random_ray(&random), longer = ray;
        uint32_t id = (uint32_t)i % g.object_count;
        float t = 0, half = 0, third = 0;
        longer.dir = rt_scale(ray.dir, 2);
        bool met = hit(&g, id, &ray, &t);
        assert_int_equal(met, hit(&g, id, &longer, &half));
        assert_true(half == t / 2);
        longer.dir = rt_scale(ray.dir, 3);
        if (met && hit(&g, id, &longer, &third)) assert_true(fabsf(third * 3 - t) <= 1e-4f);
    }
}

RT_TEST(a_scene_scaled_by_a_power_of_two_scales_t_to_the_bit) {
    static const int exponents[] = {-40, -17, 1, 23, 40};
    OWNED_GEOMETRY unit = one_of_each(0);
    for (int e = 0; e < 5; e++) {
        OWNED_GEOMETRY g = one_of_each(exponents[e]);
        RtRandom random = rt_random(3, 0);
        for (int i = 0; i < RAYS; i++) {
            RtRay ray = random_ray(&random), scaled = ray;
            uint32_t id = (uint32_t)i % g.object_count;
            float t = 0, t_scaled = 0;
            scaled.org = rt_scale(ray.org, ldexpf(1, exponents[e]));
            assert_int_equal(hit(&unit, id, &ray, &t), hit(&g, id, &scaled, &t_scaled));
            assert_true(t_scaled == ldexpf(t, exponents[e]));
        }
    }
}

/* Nearly a disc with a hole, tilted: what is hit must not depend on heights that have lost their digits. */
RT_TEST(a_flat_cone_is_hit_between_its_circles_only) {
    RtRandom random = rt_random(4, 0);
    int hits = 0;
    for (int i = 0; i < RAYS; i++) {
        RtVec3 apex = rt_narrow(rt_scaled(rt_random_direction(&random), ldexp(1, -20 - i % 40)));
        OWNED_OBJECT(g, cone, rt_vec3(0, 0, 0), 0.75f, apex, 0.25f);
        RtRay ray = random_ray(&random);
        float t;
        if (hit(&g, 0, &ray, &t)) {
            double from_center = rt_lengthd(rt_ray_point(&ray, t));
            assert_true(from_center > 0.2499 && from_center < 0.7501);
            hits++;
        }
    }
    assert_true(hits > RAYS / 20);
}

/* raytally/types.h: t is a float32 at most, and 1 / dir one as well. */
RT_TEST(a_ray_with_a_short_direction_reaches_as_far_as_the_largest_t) {
    static const float lengths[] = {1e-36f, 1e-37f, 2e-38f, 0x1p-126f, 1e-38f, 5e-39f, 0x1p-127f};
    static const float distances[] = {1e-9f, 0.001f, 0.5f, 2, 3, 3.5f, 4, 8, 20, 100};
    for (size_t i = 0; i < sizeof distances / sizeof distances[0]; i++) {
        const float d = distances[i];
        const RtVec3 square[4] = {{{-1, -1, d}}, {{1, -1, d}}, {{1, 1, d}}, {{-1, 1, d}}};
        OWNED_GEOMETRY g = {0};
        assert_ok(rt_geometry_add_sphere(&g, rt_vec3(0, 0, d + d / 2), d / 2, error));
        assert_ok(rt_geometry_add_triangle(&g, square, NULL, error));
        assert_ok(rt_geometry_add_polygon(&g, square, 4, error));
        assert_ok(rt_geometry_add_cone(&g, rt_vec3(0, -1, d + d / 2), d / 2, rt_vec3(0, 1, d + d / 2), d / 2,
                                       error));
        assert_ok(rt_geometry_finish(&g, error));
        for (size_t k = 0; k < sizeof lengths / sizeof lengths[0]; k++) {
            RtRay ray = {.dir = rt_vec3(0, 0, lengths[k]), .tmax = INFINITY};
            RtPreparedRay prepared;
            rt_hit_ray(&prepared, &g, &ray, NULL);
            for (uint32_t id = 0; id < g.object_count; id++) {
                const double exact = (double)d / (double)lengths[k];
                float t = 0;
                const bool hit = rt_object_hit(&g, id, &prepared, &t, NULL);
                assert_int_equal(hit, exact <= (double)FLT_MAX);
                if (hit) assert_true(fabs((double)t / exact - 1) < 1e-6);
            }
        }
    }
}

/* ---- triangles, number by number ----
 *
 * The vector code of raytally/hit.h, on triangles in place among others, returns the same bits as a
 * scalar version, for difficult triangles and rays. */

enum { TRIES = 400000, LANES = 4 };

/* Woop, Benthin & Wald's test as described in raytally/hit.h, from the original ray. */
static bool hit_by_hand(const RtTriangle *triangle, const RtRay *ray, float *t) {
    int kz = rt_major_axis(ray->dir), kx = (kz + 1) % 3, ky = (kx + 1) % 3;
    float inv = 1 / ray->dir.at[kz], shear_x = ray->dir.at[kx] * inv, shear_y = ray->dir.at[ky] * inv;
    float x[3], y[3], z[3], e[3];
    double d[3];
    for (int i = 0; i < 3; i++) {
        const float *v = triangle->v[i].at;
        z[i] = v[kz] - ray->org.at[kz];
        x[i] = v[kx] - ray->org.at[kx] - shear_x * z[i];
        y[i] = v[ky] - ray->org.at[ky] - shear_y * z[i];
    }
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        e[i] = x[k] * y[j] - y[k] * x[j];
        d[i] = (double)x[k] * (double)y[j] - (double)y[k] * (double)x[j];
    }
    if ((e[0] < 0 || e[1] < 0 || e[2] < 0) && (e[0] > 0 || e[1] > 0 || e[2] > 0)) return false;
    if ((d[0] < 0 || d[1] < 0 || d[2] < 0) && (d[0] > 0 || d[1] > 0 || d[2] > 0)) return false;
    double determinant = d[0] + d[1] + d[2];
    if (determinant == 0) return false;
    double depth = (d[0] * (double)z[0] + d[1] * (double)z[1] + d[2] * (double)z[2]) / determinant;
    float near, far, at = (float)(depth / (double)ray->dir.at[kz]);
    RtBox box = RT_EMPTY_BOX;
    for (int i = 0; i < 3; i++) box = rt_box_add_point(box, triangle->v[i]);
    own_span_by_hand(&box, ray, &near, &far);
    if (!(near <= far)) return false;
    if (at < near) at = near;
    if (at > far) at = far;
    *t = at;
    return at >= ray->tmin && at <= ray->tmax && at <= FLT_MAX;
}

/* In a third of all cases all vertices are near to each other, or to 0; without area in some. */
static RtTriangle make_triangle(RtRandom *random, float size) {
    RtTriangle triangle;
    bool near = rt_random_below(random, 3) == 0;
    for (int i = 0; i < 3; i++)
        triangle.v[i] = near ? rt_random_point(random, rt_minf(size, 1)) : hostile_point(random, size);
    switch (rt_random_below(random, 8)) {
    case 0: triangle.v[2] = triangle.v[1]; break;
    case 1: triangle.v[2] = rt_scale(rt_add(triangle.v[0], triangle.v[1]), 0.5f); break;
    case 2: triangle.v[1].z = triangle.v[2].z = triangle.v[0].z; break;
    default: break;
    }
    return triangle;
}

/* As it comes, or aimed at a point of an edge, or at a vertex. */
static RtRay make_ray_at(RtRandom *random, const RtTriangle *triangle, float size) {
    RtRay ray = hostile_ray(random, size), aimed = ray;
    uint32_t pick = rt_random_below(random, 4);
    if (pick == 0) return ray;
    float u = pick == 1 ? 1 : rt_random_unit(random), w = pick == 3 ? (1 - u) * rt_random_unit(random) : 0;
    for (int a = 0; a < 3; a++) {
        float at = triangle->v[0].at[a] * (1 - u - w) + triangle->v[1].at[a] * u + triangle->v[2].at[a] * w;
        aimed.dir.at[a] = at - ray.org.at[a];
    }
    return rt_ray_is_valid(&aimed) ? aimed : ray;
}

RT_TEST(triangles_are_hit_as_number_by_number_wherever_they_lie) {
    RtRandom random = rt_random(1, 8);
    int hits = 0;
    for (int i = 0; i < TRIES; i++) {
        float size = hostile_size(&random);
        RtTriangle triangle = make_triangle(&random, size);
        RtRay ray = make_ray_at(&random, &triangle, size);
        RtBox box = rt_triangle_box(&triangle);
        RtPreparedRay p = rt_ray_prepare(&ray, &box);
        float block[3][3][LANES], t = -1, strided = -1, by_hand = -1;
        int lane = i % LANES;
        for (int k = 0; k < 9 * LANES; k++)
            block[k / LANES / 3][k / LANES % 3][k % LANES] =
                k % LANES == lane ? triangle.v[k / LANES / 3].at[k / LANES % 3] : NAN;
        bool hit = hit_by_hand(&triangle, &ray, &by_hand);
        assert_int_equal(rt_triangle_hit(&triangle, &p, &t), hit);
        assert_int_equal(raytally_triangle_hit(&block[0][0][lane], (size_t)3 * LANES, LANES, &p, &strided),
                         hit);
        if (!hit) continue;
        assert_true(same_bits(t, by_hand) && same_bits(strided, by_hand));
        hits++;
    }
    assert_in_range(hits, TRIES / 10, TRIES / 10 * 9);
}

RT_TESTS(hits, NULL, NULL)
