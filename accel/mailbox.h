/* SPDX-License-Identifier: Apache-2.0 */
/* Mailboxes, for structures that may list an object more than once, and tests of the objects of a list.
 *
 * Paper: Kirk & Arvo 1991, Improved Ray Tagging for Voxel-Based Ray Tracing, Graphics Gems II.
 *
 * A mailbox is part of a query's scratch memory, which is zeroed at first, so each thread has its own. It
 * stores for every object the number of the last ray that tested it. */
#ifndef RT_ACCEL_MAILBOX_H
#define RT_ACCEL_MAILBOX_H

#include "accel/kernel.h"

#include <string.h>

typedef struct RtMailbox {
    uint32_t ray;
    uint32_t last[]; /* [object_count] */
} RtMailbox;

static inline size_t rt_mailbox_bytes(const RtGeometry *geometry) {
    return sizeof(RtMailbox) + geometry->object_count * sizeof(uint32_t);
}

/* Call before each ray. The mailbox may be NULL. */
RT_KERNEL void rt_mailbox_next_ray(RtMailbox *mailbox, const RtGeometry *geometry) {
    if (!mailbox || ++mailbox->ray != 0) return;
    memset(mailbox->last, 0, geometry->object_count * sizeof(uint32_t));
    mailbox->ray = 1;
}

/* Tests the objects ids[0..count), except those that this ray has already tested, as `mailbox` (or NULL)
 * knows. Returns true if the search is over. */
RT_KERNEL bool rt_test_list(const RtGeometry *geometry, RtMailbox *mailbox, const uint32_t *ids,
                            uint32_t count, const RtPreparedRay *ray, bool any, RtHit *best, RtTally *tally) {
    for (uint32_t i = 0; i < count; i++) {
        uint32_t id = ids[i];
        if (mailbox) {
            if (mailbox->last[id] == mailbox->ray) {
                RT_COUNT(tally, repeats_avoided, 1);
                RT_OBSERVE(tally, .kind = RT_TRACED_REPEAT_AVOIDED, .index = id);
                continue;
            }
            mailbox->last[id] = mailbox->ray;
        }
        if (rt_test_object(geometry, id, ray, any, best, tally)) return true;
    }
    return false;
}

#endif
