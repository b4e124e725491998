/* SPDX-License-Identifier: Apache-2.0 */
/* Spheres in lanes: which of four, or of eight, can the ray hit at all?
 *
 * rt_sphere_hit turns a ray away where the square of its half chord is not at least 0. Here that square is
 * computed for a sphere per lane, in double, by the same operations in the same order: so the lanes that are
 * left are, bit for bit, those that rt_sphere_hit does not turn away by it, and it is asked about these
 * alone. A lane that holds a NaN is never left.
 *
 * For files that are compiled for one instruction set; without AVX2 the lanes go in pairs. */
#ifndef RT_ACCEL_LANES_H
#define RT_ACCEL_LANES_H

#include "base/ray.h"

#if defined(__AVX2__)
#include <immintrin.h>
#endif

/* The ray as rt_sphere_hit sees it. */
typedef struct RtSphereLine {
    RtVec3d org, dir;
    double dd; /* dir . dir */
} RtSphereLine;

static inline RtSphereLine rt_sphere_line(const RtPreparedRay *ray) {
    RtVec3d dir = rt_widen(ray->dir);
    return (RtSphereLine){rt_widen(ray->org), dir, rt_dotd(dir, dir)};
}

typedef double RtDoubles4 __attribute__((vector_size(32)));
typedef float RtFloats4 __attribute__((vector_size(16)));

/* Four, or eight, floats from `at` on, which need not be aligned, as doubles. */
#define RT_WIDENED(N, at)                                                                                    \
    __extension__({                                                                                          \
        RtFloats##N floats;                                                                                  \
        memcpy(&floats, at, sizeof floats);                                                                  \
        __builtin_convertvector(floats, RtDoubles##N);                                                       \
    })

/* Bit i: the ray can hit sphere i of 0..N-1. Its centre is spheres[i], spheres[stride + i] and
 * spheres[2 * stride + i], its radius spheres[3 * stride + i]. */
#define RT_DEFINE_SPHERES_MET(N)                                                                             \
    static inline uint32_t rt_spheres_met##N(const float *spheres, size_t stride,                            \
                                             const RtSphereLine *line) {                                     \
        const RtVec3d dir = line->dir;                                                                       \
        RtDoubles##N x = line->org.x - RT_WIDENED(N, spheres);                                               \
        RtDoubles##N y = line->org.y - RT_WIDENED(N, spheres + stride);                                      \
        RtDoubles##N z = line->org.z - RT_WIDENED(N, spheres + 2 * stride);                                  \
        RtDoubles##N radius = RT_WIDENED(N, spheres + 3 * stride);                                           \
        RtDoubles##N closest = -(x * dir.x + y * dir.y + z * dir.z) / line->dd;                              \
        x = x + closest * dir.x;                                                                             \
        y = y + closest * dir.y;                                                                             \
        z = z + closest * dir.z;                                                                             \
        RtDoubles##N half_chord_squared = radius * radius - (x * x + y * y + z * z);                         \
        return RT_NOT_NEGATIVE##N(half_chord_squared);                                                       \
    }

/* Bit i: lane i is at least 0. */
#if defined(__AVX2__)
#define RT_NOT_NEGATIVE4(a)                                                                                  \
    (uint32_t) _mm256_movemask_pd(_mm256_cmp_pd((__m256d)(a), _mm256_setzero_pd(), _CMP_GE_OQ))
#else
#define RT_NOT_NEGATIVE4(a)                                                                                  \
    ((uint32_t)((a)[0] >= 0) | (uint32_t)((a)[1] >= 0) << 1 | (uint32_t)((a)[2] >= 0) << 2 |                 \
     (uint32_t)((a)[3] >= 0) << 3)
#endif
RT_DEFINE_SPHERES_MET(4)

#if defined(__AVX512F__)
typedef double RtDoubles8 __attribute__((vector_size(64)));
typedef float RtFloats8 __attribute__((vector_size(32)));
#define RT_NOT_NEGATIVE8(a) _mm512_cmp_pd_mask((__m512d)(a), _mm512_setzero_pd(), _CMP_GE_OQ)
RT_DEFINE_SPHERES_MET(8)
#else
static inline uint32_t rt_spheres_met8(const float *spheres, size_t stride, const RtSphereLine *line) {
    return rt_spheres_met4(spheres, stride, line) | rt_spheres_met4(spheres + 4, stride, line) << 4;
}
#endif

#endif
