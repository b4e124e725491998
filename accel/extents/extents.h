/* SPDX-License-Identifier: Apache-2.0 */
/* The structure behind `extents`: for its own files and its tests, one of which breaks it on purpose. */
#ifndef RT_ACCEL_EXTENTS_EXTENTS_H
#define RT_ACCEL_EXTENTS_EXTENTS_H

#include "accel/extent.h"
#include "accel/isa.h"

/* One extent per object, by id; boxes are the scene's own. */
typedef struct RtExtents {
    RtAccel base;
    RtExtentSet set;
} RtExtents;

RT_DECLARE_KERNELS(extents); /* of boxes, RT_LANES at a time */

#endif
