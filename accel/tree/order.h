/* SPDX-License-Identifier: Apache-2.0 */
/* Sorting boxes by their centres: along the Morton curve (Morton 1966) or along an axis. Radix sort, in
 * linear time; equal keys stay in the order of ids. */
#ifndef RT_ACCEL_TREE_ORDER_H
#define RT_ACCEL_TREE_ORDER_H

#include "core/base/box.h"
#include "core/base/memory.h"

typedef struct RtKeyed {
    uint64_t key;
    uint32_t id;
} RtKeyed;

/* Allocates in `memory`, and sets *order to, boxes[0..count) in ascending order of keys. It does not depend
 * on the number of `threads` (0 = all processors). morton  the box of all centres is divided into 2^bits
 * cells along each axis, bits 1..RT_MAX_MORTON_BITS; the key interleaves the coordinates of the centre's
 * cell, x in the lowest bit, then y, then z axis    the key increases with the centre along `axis` */
RtStatus rt_order_morton(const RtBox *boxes, uint32_t count, uint32_t bits, int threads, RtArena *memory,
                         const RtKeyed **order, RtError *error);
RtStatus rt_order_axis(const RtBox *boxes, uint32_t count, int axis, int threads, RtArena *memory,
                       const RtKeyed **order, RtError *error);

#endif
