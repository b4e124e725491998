/* Splitting a group of objects in two: by the surface area heuristic, sought in equal bins of centres along
 * all three axes (Wald 2007, "On fast Construction of SAH-based Bounding Volume Hierarchies"), or in halves.
 */
#ifndef RT_ACCEL_SPLIT_H
#define RT_ACCEL_SPLIT_H

#include "base/box.h"

#include <stdint.h>

enum { RT_MAX_BINS = 64 };

typedef struct RtSplit {
    double cost; /* sum over both sides of half area x number; INFINITY where all centres coincide */
    int axis, bin, bins;
    float lo, scale; /* bin of a centre c: (c - lo) * scale */
} RtSplit;

/* The best split of ids[0..count), which index `boxes`, with 2..RT_MAX_BINS bins; both sides get some. */
RtSplit rt_split_find(const RtBox *boxes, const uint32_t *ids, uint32_t count, int bins);

/* Moves the ids that go left to the front, and gives their number. `split` has a finite cost. */
uint32_t rt_split_partition(const RtSplit *split, const RtBox *boxes, uint32_t *ids, uint32_t count);

/* Moves the half of ids[0..count) with the lesser centres along the longest axis of all centres to the front
 * (equal ones by id), and gives its number, (count + 1) / 2; count >= 1. */
uint32_t rt_split_median(const RtBox *boxes, uint32_t *ids, uint32_t count);

#endif
