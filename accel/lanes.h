/* SPDX-License-Identifier: Apache-2.0 */
/* Spheres in lanes: which of four, eight or sixteen may the ray hit? The others rt_sphere_hit would turn
 * away.
 *
 * A ray from org along the unit vector u passes a centre at o from org at the distance |o x u|. Computed in
 * float32 this is off by less than 2^-21 |o|: of units of 2^-24 |o| the rounding of o and that of u take one
 * each, the products sqrt(2), their differences one. rt_sphere_hit computes it in double, off by less than
 * 2^-48 |o|, and turns the ray away where it is greater than the radius. So a ray that it does not turn away
 * has
 *
 *     |o x u| <= r + 2^-21 |o|,  and hence  |o x u|^2 <= (1 + 2^-10) r^2 + (1 + 2^10) 2^-42 |o|^2,
 *
 * for 2ab <= 2^-10 a^2 + 2^10 b^2. A lane is left where |o x u|^2 <= (1 + 2^-9) r^2 + 2^-31 |o|^2 + 2^-120:
 * the first two terms are greater than those above by more than the rounding of both sides, 2^-20 of them;
 * and the third is by more than all that is lost where products are too small for float32. None is too large,
 * since coordinates stay below RT_MAX_COORDINATE. What is left needlessly is small and far away, r < 2^-15
 * |o|, or nearly met.
 *
 * A lane that holds a NaN is not left. */
#ifndef RT_ACCEL_LANES_H
#define RT_ACCEL_LANES_H

#include "core/base/ray.h"

#if defined(__AVX__)
#include <immintrin.h>
#endif

/* A ray as spheres in lanes see it; to be made once. */
typedef struct RtSphereLine {
    RtVec3 org, dir; /* dir: unit */
} RtSphereLine;

static inline RtSphereLine rt_sphere_line(const RtPreparedRay *ray) {
    return (RtSphereLine){ray->org, rt_narrow(rt_normalized(rt_widen(ray->dir)))};
}

/* Bit i: the ray may hit sphere i, 0 <= i < N. Its centre is spheres[i], spheres[stride + i] and
 * spheres[2 * stride + i], its radius spheres[3 * stride + i]; they need not be aligned. */
#define RT_DEFINE_SPHERES_LEFT(N)                                                                            \
    static inline uint32_t rt_spheres_left##N(const float *spheres, size_t stride,                           \
                                              const RtSphereLine *line) {                                    \
        const RtVec3 org = line->org, u = line->dir;                                                         \
        RtFloats##N x, y, z, r;                                                                              \
        memcpy(&x, spheres, sizeof x);                                                                       \
        memcpy(&y, spheres + stride, sizeof y);                                                              \
        memcpy(&z, spheres + 2 * stride, sizeof z);                                                          \
        memcpy(&r, spheres + 3 * stride, sizeof r);                                                          \
        x -= org.x, y -= org.y, z -= org.z;                                                                  \
        RtFloats##N a = y * u.z - z * u.y, b = z * u.x - x * u.z, c = x * u.y - y * u.x;                     \
        RtFloats##N passed = a * a + b * b + c * c, far = x * x + y * y + z * z;                             \
        return RT_AT_MOST##N(passed, r * r * (1 + 0x1p-9f) + (far * 0x1p-31f + 0x1p-120f));                  \
    }

/* Bit i: a[i] <= b[i]. */
#if defined(__SSE__)
#define RT_AT_MOST4(a, b) (uint32_t) _mm_movemask_ps((__m128)((a) <= (b)))
#else
#define RT_AT_MOST4(a, b)                                                                                    \
    ((uint32_t)((a)[0] <= (b)[0]) | (uint32_t)((a)[1] <= (b)[1]) << 1 | (uint32_t)((a)[2] <= (b)[2]) << 2 |  \
     (uint32_t)((a)[3] <= (b)[3]) << 3)
#endif
typedef RtFour RtFloats4;
RT_DEFINE_SPHERES_LEFT(4)

#if defined(__AVX__)
#define RT_AT_MOST8(a, b) (uint32_t) _mm256_movemask_ps((__m256)((a) <= (b)))
typedef float RtFloats8 __attribute__((vector_size(32)));
RT_DEFINE_SPHERES_LEFT(8)
#else
static inline uint32_t rt_spheres_left8(const float *spheres, size_t stride, const RtSphereLine *line) {
    return rt_spheres_left4(spheres, stride, line) | rt_spheres_left4(spheres + 4, stride, line) << 4;
}
#endif

#if defined(__AVX512F__)
#define RT_AT_MOST16(a, b) _mm512_cmp_ps_mask((__m512)(a), (__m512)(b), _CMP_LE_OQ)
typedef float RtFloats16 __attribute__((vector_size(64)));
RT_DEFINE_SPHERES_LEFT(16)
#else
static inline uint32_t rt_spheres_left16(const float *spheres, size_t stride, const RtSphereLine *line) {
    return rt_spheres_left8(spheres, stride, line) | rt_spheres_left8(spheres + 8, stride, line) << 8;
}
#endif

#endif
