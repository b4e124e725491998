/* SPDX-License-Identifier: Apache-2.0 */
/* What the explorer draws in 3-D: objects as spheres and triangles, and the boxes of structures.
 *
 *   objects:  u32 spheres; of each center[3], radius, material; triangles likewise with 9 floats; of CSG
 *             trees their boxes, lo[3], hi[3], material. All numbers but floats are LEB128.
 *   boxes:    lo[3], hi[3] (floats), depth, 0 for an inner node, 1 + length of its list for a leaf */
#ifndef RT_REPORT_EXPLORE_SHAPES_H
#define RT_REPORT_EXPLORE_SHAPES_H

#include "accel/accel.h"
#include "report/explore_bytes.h"

enum { RT_MAX_SHOWN_OBJECTS = 100000, RT_MAX_SHOWN_BOXES = 50000 };

/* Appends every kth object, so that RT_MAX_SHOWN_OBJECTS are enough; returns k. */
uint32_t rt_explore_objects(const RtScene *scene, RtBytes *out);

/* The boxes of a structure that are shown: the levels above `level` in full, every kth box of that level, and
 * none below. */
typedef struct RtShownBoxes {
    const RtAccel *layer; /* the topmost that has boxes; NULL if none has */
    uint32_t shown, all;
    uint32_t level, every; /* UINT32_MAX if all are shown */
} RtShownBoxes;

/* Appends at most RT_MAX_SHOWN_BOXES. */
RtShownBoxes rt_explore_boxes(const RtAccel *accel, RtBytes *out);

#endif
