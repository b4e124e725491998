/* SPDX-License-Identifier: Apache-2.0 */
/* The hit function of a part placed in a scene, which asks the accelerator of the part.
 *
 * The base of a stack owns an accelerator for each part of its scene, of the same spec, or of the one after
 * '/' (RtSpec). A query has a query in each of them. A part is on the path of a ray at most once at a time,
 * since parts contain no cycles, so one for each is enough. */
#include "accel/instance.h"

RT_KERNEL bool enter(const RtGeometry *geometry, uint32_t id, const RtPreparedRay *ray, bool any, RtHit *best,
                     RtTally *tally) {
    const RtInstance *instance = rt_instance_of(geometry, id);
    const RtQuery *query = &((RtHitMemory *)ray->crossings)->parts[instance->part];
    RtEntry entry;
    RtRay inside;
    RtHit hit = RT_MISS;
    if (!rt_enter_begin(geometry, id, ray, best, &entry, &inside, tally)) return false;
    inside.kind = 0; /* one tally for all kinds */
    rt_trace_stream(query->accel, query->scratch, &inside, 1, any ? NULL : &hit, any ? &hit.object : NULL,
                    tally);
    return rt_enter_end(instance, &entry, hit, any, best, tally);
}

bool rt_enter_timed(const RtGeometry *geometry, uint32_t id, const RtPreparedRay *ray, bool any,
                    RtHit *best) {
    return any ? enter(geometry, id, ray, true, best, NULL) : enter(geometry, id, ray, false, best, NULL);
}

bool rt_enter_counted(const RtGeometry *geometry, uint32_t id, const RtPreparedRay *ray, bool any,
                      RtHit *best, RtTally *tally) {
    return enter(geometry, id, ray, any, best, tally);
}
