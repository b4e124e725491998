/* SPDX-License-Identifier: Apache-2.0 */
/* Splitting a group of references in two, in place: by the surface area heuristic, sought in equal bins of
 * centres along all three axes (Wald 2007, "On fast Construction of SAH-based Bounding Volume Hierarchies"),
 * or in halves. Boxes are moved with their ids, so that groups are read in a row, however large the scene.
 *
 * Which references come to the front depends on them alone, not on the order in which they stand. */
#ifndef RT_ACCEL_TREE_SPLIT_H
#define RT_ACCEL_TREE_SPLIT_H

#include "accel/tree/bins.h"

/* The box about all centres, and its longest axis. */
RtBox4 rt_refs_centers(const RtTreeRef *refs, uint32_t count);
int rt_longest_axis(RtBox4 box);

/* Moves the references of the left side of the best split in 2..RT_MAX_BINS bins to the front, and gives
 * their number; both sides get some. `centers` are theirs; those of the sides go to centers_of[2]. No more
 * references than bins have a bin each: every place between centres is tried. 0 where no plane parts the
 * centres: they coincide. */
uint32_t rt_split_binned(RtTreeRef *refs, uint32_t count, int bins, RtBox4 centers, RtBox4 centers_of[2]);

/* Moves the half of refs[0..count) with the lesser centres along the longest axis of all centres to the front
 * (equal ones by id, which differ), and gives its number, (count + 1) / 2; count >= 1. */
uint32_t rt_split_median(RtTreeRef *refs, uint32_t count);

#endif
