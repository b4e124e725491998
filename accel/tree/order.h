/* SPDX-License-Identifier: Apache-2.0 */
/* Orders of boxes by their centres: along the Morton curve (Morton 1966) or along an axis. Sorted by radix,
 * so in time linear in their number; what has equal keys stays in the order of ids. */
#ifndef RT_ACCEL_TREE_ORDER_H
#define RT_ACCEL_TREE_ORDER_H

#include "core/base/box.h"

#include <stdint.h>

enum { RT_MAX_MORTON_BITS = 21 };

typedef struct RtKeyed {
    uint64_t key;
    uint32_t id;
} RtKeyed;

/* boxes[0..count) in ascending order of keys; NULL where memory is short. Free with rt_free. The same on any
 * number of `threads` (0 = all processors).
 *   morton  the box about all centres is cut into 2^bits cells along each axis (bits 1..RT_MAX_MORTON_BITS);
 *           the key is the cell of the centre, of whose numbers x gives the lowest bit, y the next, z
 *   axis    the key ascends with the centre along `axis` */
RtKeyed *rt_order_morton(const RtBox *boxes, uint32_t count, uint32_t bits, int threads);
RtKeyed *rt_order_axis(const RtBox *boxes, uint32_t count, int axis, int threads);

#endif
