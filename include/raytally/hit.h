/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The exact hit functions of triangles and spheres, which raytally's own accelerators use, too. They are
 * frozen like the box test (box.h): the same ray and object give the same bits of t, whatever was found
 * before, with any compiler and any instruction set. raytally_object_hits (accel.h) calls them. A plugin that
 * keeps triangles or spheres in an order of its own may call them itself where nothing is counted; where
 * `counters` is not NULL, it must call raytally_object_hits, since raytally compares the counts with the
 * tests that it makes itself. They need gcc 12, clang, or a later version. */
#ifndef RAYTALLY_HIT_H
#define RAYTALLY_HIT_H

#include "raytally/box.h"

#ifdef __cplusplus
extern "C" {
#endif

/** A product that is not fused with a sum. */
RAYTALLY_INLINE double raytally_rounded(double product) {
    RAYTALLY_ROUND(product);
    return product;
}

/** The square root of a number that is not negative. */
RAYTALLY_INLINE double raytally_root(double a) {
#ifdef __SSE2__
    /* sqrt would have to set errno; valgrind lacks the instruction that _mm_set_sd can be. */
    const __m128d lanes = _mm_set1_pd(a);
    return _mm_cvtsd_f64(_mm_sqrt_sd(lanes, lanes));
#else
    return __builtin_sqrt(a);
#endif
}

/** Bit i is the sign of lane i. */
RAYTALLY_INLINE uint32_t raytally_bits4(raytally_int4 mask) {
#ifdef __SSE2__
    return (uint32_t)_mm_movemask_ps((raytally_float4)mask);
#else
    uint32_t bits = 0;
    for (int i = 0; i < 4; i++) bits |= (uint32_t)(mask[i] < 0) << i;
    return bits;
#endif
}

/* ---- the box of an object ---- */

/** The interval [*near, *far] of t in which the ray is within an object's box lo..hi, with the thickness of
 * that box alone; empty if *near > *far. */
RAYTALLY_INLINE void raytally_own_span4(raytally_float4 lo, raytally_float4 hi, const raytally_prepared *ray,
                                        float *near, float *far) {
    const raytally_float4 org = raytally_load4(ray->org), inv = raytally_load4(ray->inv);
    const raytally_int4 sign = (raytally_int4)raytally_load4(ray->dir) & INT32_MIN, negative = sign < 0;
    const raytally_float4 shift = raytally_shift4(raytally_thickness4(lo, hi, org), org, sign);
    const raytally_float4 first = (raytally_select4(negative, hi, lo) - (org + shift)) * inv;
    const raytally_float4 second = (raytally_select4(negative, lo, hi) - (org - shift)) * inv;
    *near = -__builtin_inff();
    *far = __builtin_inff();
    for (int a = 0; a < 3; a++) {
        *near = first[a] > *near ? first[a] : *near;
        *far = second[a] < *far ? second[a] : *far;
    }
}

/** Decides whether a candidate t is a hit on an object with box lo..hi: the thick ray must meet the box, t is
 * clamped to the interval in which it does (a change within rounding), and must then lie in [tmin, tmax].
 * NaN is rejected.
 * @return 1 or 0 */
RAYTALLY_INLINE int raytally_admit4(raytally_float4 lo, raytally_float4 hi, const raytally_prepared *ray,
                                    float *t) {
    float near, far;
    raytally_own_span4(lo, hi, ray, &near, &far);
    if (!(near <= far)) return 0;
    const float clamped = *t < near ? near : *t > far ? far : *t;
    if (!(clamped >= ray->tmin && clamped <= ray->tmax)) return 0;
    *t = clamped;
    return 1;
}

/* ---- triangles ----
 *
 * Both sides, edges and vertices can be hit; a ray in the plane of a triangle misses it. Woop, Benthin & Wald
 * 2013, "Watertight Ray/Triangle Intersection" (JCGT 2(1)): vertices are moved to the ray's origin and
 * sheared until the ray is the z axis; the three edge functions of the projection decide. A shared vertex is
 * transformed to the same position for every triangle, and the signs of edge functions are exact. So
 * neighbouring triangles agree, and no ray passes between them.
 *
 * An edge function in float32 has the right sign or is 0, because rounding is monotone; that rejects nearly
 * all rays. Only for the rest are the functions evaluated in double, where products of two float32 are exact
 * and only one rounding is left. Their ratios, the barycentric weights, are then accurate too; on a sliver
 * those of float32 would be noise, and t with them. Only + - * / in a fixed order, so that SIMD kernels can
 * repeat it bit for bit: in float32 up to the first test, in double for the few lanes that pass it. */

/** A coordinate of each vertex, and 0: loading an arbitrary fourth lane would take another shuffle. */
RAYTALLY_INLINE raytally_float4 raytally_triangle_along(const float *v, size_t vertex, size_t axis) {
    const raytally_float4 along = {v[axis], v[axis + vertex], v[axis + 2 * vertex], 0};
    return along;
}

/** A vertex, and 0. */
RAYTALLY_INLINE raytally_float4 raytally_triangle_vertex(const float *v, size_t axis) {
    const raytally_float4 at = {v[0], v[axis], v[2 * axis], 0};
    return at;
}

/** Whether the ray hits a triangle for some t in [tmin, tmax].
 * @param v       coordinate a of vertex i is v[i * vertex + a * axis], so that a triangle which is stored
 *                coordinate by coordinate among others can be tested in place; in
 *                raytally_build_input.triangles, vertex is 3 and axis 1
 * @param vertex  distance of the vertices, in floats
 * @param axis    distance of the coordinates
 * @param ray     from raytally_prepare
 * @param t       out: that t, if it is a hit
 * @return 1 or 0 */
RAYTALLY_INLINE int raytally_triangle_hit(const float *v, size_t vertex, size_t axis,
                                          const raytally_prepared *ray, float *t) {
    const float *org = ray->org;
    const raytally_float4 z = raytally_triangle_along(v, vertex, (size_t)ray->kz * axis) - org[ray->kz];
    const raytally_float4 x = raytally_triangle_along(v, vertex, (size_t)ray->kx * axis) - org[ray->kx] -
                              raytally_rounded4(ray->shear_x * z);
    const raytally_float4 y = raytally_triangle_along(v, vertex, (size_t)ray->ky * axis) - org[ray->ky] -
                              raytally_rounded4(ray->shear_y * z);
    const raytally_float4 x1 = __builtin_shufflevector(x, x, 1, 2, 0, 3);
    const raytally_float4 x2 = __builtin_shufflevector(x, x, 2, 0, 1, 3);
    const raytally_float4 y1 = __builtin_shufflevector(y, y, 1, 2, 0, 3);
    const raytally_float4 y2 = __builtin_shufflevector(y, y, 2, 0, 1, 3);
    const raytally_float4 edges = raytally_rounded4(x2 * y1) - raytally_rounded4(y2 * x1);
    if ((raytally_bits4(edges < 0.0f) & 7) && (raytally_bits4(edges > 0.0f) & 7)) return 0;
    /* Exact products: fusing them would change nothing. */
    const double u = (double)x[2] * (double)y[1] - (double)y[2] * (double)x[1];
    const double w1 = (double)x[0] * (double)y[2] - (double)y[0] * (double)x[2];
    const double w2 = (double)x[1] * (double)y[0] - (double)y[1] * (double)x[0];
    if ((u < 0 || w1 < 0 || w2 < 0) && (u > 0 || w1 > 0 || w2 > 0)) return 0;
    const double determinant = u + w1 + w2;
    if (determinant == 0) return 0;
    const double depth = (raytally_rounded(u * (double)z[0]) + raytally_rounded(w1 * (double)z[1]) +
                          raytally_rounded(w2 * (double)z[2])) /
                         determinant;
    *t = (float)(depth / (double)ray->dir[ray->kz]);
    const raytally_float4 a = raytally_triangle_vertex(v, axis);
    const raytally_float4 b = raytally_triangle_vertex(v + vertex, axis);
    const raytally_float4 c = raytally_triangle_vertex(v + 2 * vertex, axis);
    return raytally_admit4(raytally_min4(raytally_min4(a, b), c), raytally_max4(raytally_max4(a, b), c), ray,
                           t);
}

/* ---- spheres ----
 *
 * The surface, hit from outside and from inside. The hit is computed in double about the point of the ray
 * nearest to the centre (Haines, Günther & Akenine-Möller 2019, "Precision Improvements for Ray/Sphere
 * Intersection", Ray Tracing Gems ch. 7): the half chord is sqrt(r^2 - |l|^2), with l the vector from the
 * centre to that point, which loses no precision for distant origins. */

/** The real roots of a t^2 + 2 b t + c = 0, without cancellation (q = -(b + sign(b) sqrt(d)), t = q / a and
 * c / q: Press et al., Numerical Recipes, section 5.6).
 * @param discriminant  b^2 - a c, which the caller may know more precisely
 * @param roots         out: in ascending order; equal if the discriminant is 0
 * @return their number: 0, 1 (a = 0) or 2 */
RAYTALLY_INLINE int raytally_quadratic_roots(double a, double half_b, double c, double discriminant,
                                             double roots[2]) {
    if (!(discriminant >= 0)) return 0;
    const double root = raytally_root(discriminant);
    const double q = half_b > 0 ? -(half_b + root) : root - half_b;
    if (a == 0) {
        if (half_b == 0) return 0;
        roots[0] = -c / (2 * half_b);
        return 1;
    }
    /* For a double root c / q is the ratio of two rounding errors; near 0 it could be anything. */
    const double first = q / a, second = discriminant > 0 ? c / q : first;
    roots[0] = first < second ? first : second;
    roots[1] = first < second ? second : first;
    return 2;
}

RAYTALLY_INLINE double raytally_dot(const double a[3], const double b[3]) {
    return raytally_rounded(a[0] * b[0]) + raytally_rounded(a[1] * b[1]) + raytally_rounded(a[2] * b[2]);
}

/** The t at which the line of a ray meets a sphere, in ascending order.
 * @param sphere  centre x, y, z and radius, as in raytally_build_input.spheres
 * @return their number: 0, 1 or 2 */
RAYTALLY_INLINE int raytally_sphere_roots(const float sphere[4], const float ray_org[3],
                                          const float ray_dir[3], double roots[2]) {
    const double radius = (double)sphere[3], radius_squared = raytally_rounded(radius * radius);
    double org[3], dir[3], l[3];
    for (int a = 0; a < 3; a++) {
        org[a] = (double)ray_org[a] - (double)sphere[a];
        dir[a] = (double)ray_dir[a];
    }
    const double dd = raytally_dot(dir, dir), od = raytally_dot(org, dir), closest = -od / dd;
    for (int a = 0; a < 3; a++) l[a] = org[a] + raytally_rounded(closest * dir[a]);
    const double half_chord_squared = radius_squared - raytally_dot(l, l);
    if (!(half_chord_squared >= 0)) return 0;
    return raytally_quadratic_roots(dd, od, raytally_dot(org, org) - radius_squared, half_chord_squared * dd,
                                    roots);
}

/** Whether the ray hits a sphere for some t in [tmin, tmax].
 * @param sphere  as above
 * @param own     its box, as in raytally_build_input.boxes
 * @param ray     from raytally_prepare
 * @param t       out: the first such t, if it is a hit
 * @return 1 or 0 */
RAYTALLY_INLINE int raytally_sphere_hit(const float sphere[4], const raytally_box *own,
                                        const raytally_prepared *ray, float *t) {
    double roots[2];
    const int count = raytally_sphere_roots(sphere, ray->org, ray->dir, roots);
    for (int i = 0; i < count; i++) {
        *t = (float)roots[i];
        if (raytally_admit4(raytally_box_lo4(own), raytally_box_hi4(own), ray, t)) return 1;
    }
    return 0;
}

#ifdef __cplusplus
}
#endif

#endif
