/* SPDX-License-Identifier: Apache-2.0 */
/* References chopped into equal spatial bins along each axis, and the cheapest plane between bins by the
 * surface area heuristic (Stich et al. 2009). The parts serve to compare planes only: those of triangles are
 * computed in float32 and cut at planes of one axis; those of other shapes are rt_object_part's. */
#ifndef RT_ACCEL_TREE_SPATIAL_BINS_H
#define RT_ACCEL_TREE_SPATIAL_BINS_H

#include "accel/tree/sah_split.h"
#include "core/shape/geometry.h"

/* The two sides of a split, and its cost. */
typedef struct RtSides {
    double cost;
    RtBox4 box[2];
    uint32_t count[2];
} RtSides;

static inline void rt_sides_set_cost(RtSides *sides) {
    RtDouble2 areas = rt_box4_half_areas(sides->box[0], sides->box[1]);
    sides->cost = areas[0] * sides->count[0] + areas[1] * sides->count[1];
}

typedef struct RtSpatialSplit {
    RtSides sides; /* cost INFINITY: no plane */
    int axis;
    float at;
} RtSpatialSplit;

/* refs[0..count), in `box`. */
typedef struct RtSpatialGroup {
    const RtGeometry *geometry;
    const RtTreeRef *refs;
    uint32_t count, spare; /* references, and how many a split may add */
    RtBox4 box;
    double margin; /* for rt_object_part */
} RtSpatialGroup;

/* The cheapest plane between `count` bins, 2..RT_MAX_BINS, along any axis. Ties go to the lower axis, then to
 * the lower plane. */
RtSpatialSplit rt_spatial_bins_split(const RtSpatialGroup *group, int count);

/* Clips a reference to `lo`..`hi` along `axis`: *part contains all of its surface there, or all of a CSG
 * tree's box (accel/clipping.h). False if there is none. */
bool rt_ref_part(const RtSpatialGroup *group, const RtTreeRef *ref, int axis, float lo, float hi,
                 RtBox *part);

#endif
