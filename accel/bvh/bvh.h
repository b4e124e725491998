/* SPDX-License-Identifier: Apache-2.0 */
/* The data of `bvh`, for its own file and its test, which breaks invariants. */
#ifndef RT_ACCEL_BVH_BVH_H
#define RT_ACCEL_BVH_BVH_H

#include "accel/tree/hierarchy.h"

typedef struct RtBvh {
    RtAccel base;
    RtHierarchy hierarchy; /* binary */
} RtBvh;

#endif
