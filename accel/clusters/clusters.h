/* SPDX-License-Identifier: Apache-2.0 */
/* The data of `clusters`, for its own file and its test, which breaks invariants. */
#ifndef RT_ACCEL_CLUSTERS_CLUSTERS_H
#define RT_ACCEL_CLUSTERS_CLUSTERS_H

#include "accel/extent.h"
#include "accel/tree/hierarchy.h"

typedef struct RtClusters {
    RtAccel base;
    RtHierarchy hierarchy;
    bool nearest_first; /* traversal_order=nearest */
    RtExtentSet set;    /* an extent per node */
} RtClusters;

#endif
