/* SPDX-License-Identifier: Apache-2.0 */
/* What the explorer draws in 3-D: objects as spheres and triangles, the boxes of structures, and the cells
 * around lights.
 *
 *   objects:  spheres; of each center[3], radius, material; triangles likewise with 9 floats; of CSG
 *             trees their boxes, lo[3], hi[3], material. All numbers but floats are LEB128.
 *   boxes:    lo[3], hi[3] (floats), depth, 0 for an inner node, 1 + length of its list for a leaf
 *   cells:    of each light the six sides of a cube, -x, +x, -y, ..., of RT_CELL_MAP x RT_CELL_MAP
 *             directions: 1 + number of the cell or 0, and length of its list. On a side of axis a, columns
 *             go along axis a + 1, rows along a + 2 (mod 3) */
#ifndef RT_REPORT_EXPLORE_SHAPES_H
#define RT_REPORT_EXPLORE_SHAPES_H

#include "accel/accel.h"
#include "report/explore_bytes.h"

enum { RT_MAX_SHOWN_OBJECTS = 100000, RT_MAX_SHOWN_BOXES = 50000, RT_CELL_MAP = 40 };

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

/* The topmost layer of `accel` that looks rays of a kind up in cells, or NULL. */
const RtAccel *rt_cell_layer(const RtAccel *accel, uint32_t kind);

/* Appends the cells around lights; nothing if no layer looks shadow rays up in cells. */
void rt_explore_cells(const RtAccel *accel, RtBytes *out);

#endif
