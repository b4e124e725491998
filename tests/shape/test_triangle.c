/* SPDX-License-Identifier: Apache-2.0 */
/* The vector code of core/shape/triangle.h, on triangles in place among others, returns the same bits as a
 * scalar version, for difficult triangles and rays. */
#include "testing.h"

#include "base/ray_testing.h"
#include "core/shape/triangle.h"

enum { TRIES = 400000, LANES = 4 };

/* Woop, Benthin & Wald's test as described in core/shape/triangle.h, from the original ray. */
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

RT_TESTS(triangle, NULL, NULL)
