/* SPDX-License-Identifier: Apache-2.0 */
/* The structure behind `bvh`: for its own file and its test, which breaks it on purpose. */
#ifndef RT_ACCEL_BVH_BVH_H
#define RT_ACCEL_BVH_BVH_H

#include "accel/tree/hierarchy.h"

typedef struct RtBvh {
    RtAccel base;
    RtHierarchy hierarchy; /* of pairs */
    bool mailbox;          /* where objects are divided */
} RtBvh;

#endif
