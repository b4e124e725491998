/* SPDX-License-Identifier: Apache-2.0 */
/* Sixteen pairs of a ray and a triangle in lanes: what rt_triangle_hit does in float32, operation by
 * operation, up to its first test, which turns nearly all of them away (core/shape/triangle.h). Coordinates
 * are along kx, ky and kz of the ray. */
#ifndef RT_ACCEL_SIEVE_H
#define RT_ACCEL_SIEVE_H

#include "accel/kernel.h"
#include "accel/simd.h"

/* Of each ray. */
typedef struct RtSieveLine {
    RtV16 org_x, org_y, org_z, shear_x, shear_y;
} RtSieveLine;

/* Moves and shears vertices i in place, until the ray is the z axis. */
RT_KERNEL void rt_sieve_shear(const RtSieveLine *line, RtV16 x[3], RtV16 y[3], RtV16 z[3]) {
    for (int i = 0; i < 3; i++) {
        z[i] = rt_v16_sub(z[i], line->org_z);
        x[i] = rt_v16_sub(rt_v16_sub(x[i], line->org_x), rt_v16_mul(line->shear_x, z[i]));
        y[i] = rt_v16_sub(rt_v16_sub(y[i], line->org_y), rt_v16_mul(line->shear_y, z[i]));
    }
}

RT_KERNEL RtV16 rt_sieve_edge(RtV16 ax, RtV16 ay, RtV16 bx, RtV16 by) {
    return rt_v16_sub(rt_v16_mul(ax, by), rt_v16_mul(ay, bx));
}

/* Bit i: the edge functions of sheared triangle i are not of different signs. */
RT_KERNEL uint32_t rt_sieve(const RtV16 x[3], const RtV16 y[3]) {
    const RtV16 zero = rt_v16_all(0);
    RtV16 u = rt_sieve_edge(x[2], y[2], x[1], y[1]), v = rt_sieve_edge(x[0], y[0], x[2], y[2]);
    RtV16 w = rt_sieve_edge(x[1], y[1], x[0], y[0]);
    RtV16 least = rt_v16_min(rt_v16_min(u, v), w), most = rt_v16_max(rt_v16_max(u, v), w);
    return rt_v16_at_most(zero, least) | rt_v16_at_most(most, zero);
}

#endif
