/* SPDX-License-Identifier: Apache-2.0 */
/* The sphere prefilter: which of RT_LANES spheres may a ray hit? rt_sphere_hit rejects all others.
 *
 * A ray from org along the unit vector u passes a centre at o from org at the distance |o x u|. In float32
 * the error of this distance is less than 2^-21 |o|: in units of 2^-24 |o| rounding o and rounding u add one
 * each, the products sqrt(2), their differences one. rt_sphere_hit computes it in double, with an error below
 * 2^-48 |o|, and rejects the ray if it is greater than the radius. So a ray that it does not reject has
 *
 *     |o x u| <= r + 2^-21 |o|,  and hence  |o x u|^2 <= (1 + 2^-10) r^2 + (1 + 2^10) 2^-42 |o|^2,
 *
 * for 2ab <= 2^-10 a^2 + 2^10 b^2. The prefilter passes a lane if |o x u|^2 <= (1 + 2^-9) r^2 + 2^-31 |o|^2 +
 * 2^-120: its first two terms exceed those above by more than the rounding of both sides, 2^-20 of them; its
 * third exceeds all that underflow in products can lose. Nothing overflows, since coordinates stay below
 * RT_MAX_COORDINATE. Spheres that pass needlessly are small and far away, r < 2^-15 |o|, or nearly hit.
 *
 * A lane that holds a NaN does not pass. */
#ifndef RT_ACCEL_SPHERE_PREFILTER_H
#define RT_ACCEL_SPHERE_PREFILTER_H

#include "core/base/ray.h"
#include "core/base/simd.h"

/* A ray, prepared for the prefilter once. */
typedef struct RtSphereLine {
    RtVec3 org, dir; /* dir: unit */
} RtSphereLine;

static inline RtSphereLine rt_sphere_line(const RtPreparedRay *ray) {
    return (RtSphereLine){rt_vec3_load(ray->org), rt_narrow(rt_normalized(rt_widen(rt_vec3_load(ray->dir))))};
}

/* Bit i: the ray may hit sphere i, 0 <= i < RT_LANES. Its centre is spheres[i], spheres[stride + i] and
 * spheres[2 * stride + i], its radius spheres[3 * stride + i]; they need not be aligned. */
static inline uint32_t rt_sphere_prefilter(const float *spheres, size_t stride, const RtSphereLine *line) {
    const RtVec3 u = line->dir;
    RtFloats x = rt_loadu(spheres) - line->org.x, y = rt_loadu(spheres + stride) - line->org.y;
    RtFloats z = rt_loadu(spheres + 2 * stride) - line->org.z, r = rt_loadu(spheres + 3 * stride);
    RtFloats a = y * u.z - z * u.y, b = z * u.x - x * u.z, c = x * u.y - y * u.x;
    RtFloats passed = a * a + b * b + c * c, far = x * x + y * y + z * z;
    return rt_le_bits(passed, r * r * (1 + 0x1p-9f) + (far * 0x1p-31f + 0x1p-120f));
}

#endif
