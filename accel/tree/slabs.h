/* SPDX-License-Identifier: Apache-2.0 */
/* References chopped into equal slabs of space along each axis, and the cheapest plane between slabs by the
 * surface area heuristic. The parts are for the comparison of planes alone: of triangles they are computed in
 * float32 and cut at planes of one axis only; of other shapes rt_object_part gives them. */
#ifndef RT_ACCEL_TREE_SLABS_H
#define RT_ACCEL_TREE_SLABS_H

#include "accel/tree/bins.h"
#include "core/shape/geometry.h"

/* A split in two, and what it costs. */
typedef struct RtSides {
    double cost;
    RtBox4 box[2];
    uint32_t count[2];
} RtSides;

static inline void rt_sides_set_cost(RtSides *sides) {
    RtDouble2 areas = rt_box4_half_areas(sides->box[0], sides->box[1]);
    sides->cost = areas[0] * sides->count[0] + areas[1] * sides->count[1];
}

typedef struct RtCut {
    RtSides sides; /* cost INFINITY: there is none */
    int axis;
    float at;
} RtCut;

/* References whose parts are to be compared: refs[0..count), in `box`. */
typedef struct RtSlabGroup {
    const RtGeometry *geometry;
    const RtTreeRef *refs;
    uint32_t count, spare; /* a plane may make so many more of them */
    RtBox4 box;
    double margin; /* for rt_object_part */
} RtSlabGroup;

/* The cheapest of the planes between `count` slabs, 2..RT_MAX_BINS, along any axis; of equal ones that of the
 * lower axis, and the lower one. */
RtCut rt_slabs_find_plane(const RtSlabGroup *group, int count);

/* To *part what of a reference is from `lo` to `hi` along `axis`; false where nothing is. It holds all of the
 * surface that is there. */
bool rt_ref_part(const RtSlabGroup *group, const RtTreeRef *ref, int axis, float lo, float hi, RtBox *part);

#endif
