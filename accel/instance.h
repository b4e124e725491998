/* SPDX-License-Identifier: Apache-2.0 */
/* Entering instances (core/shape/instance.h), with a begin and an end: between them the part is asked for the
 * hit of the moved ray, which is alone (instance.c) or one of a stream (packets of wide, item).
 *
 * The part is asked for hits up to the best one, but not where the interval of the instance's thick box ends
 * before it: a hit beyond would be clamped to that end, and so be nearer. */
#ifndef RT_ACCEL_INSTANCE_H
#define RT_ACCEL_INSTANCE_H

#include "accel/kernel.h"

/* Where a ray is in an instance's own thick box. */
typedef struct RtEntry {
    float near, far;
} RtEntry;

/* Moves a ray that meets the instance's box into the part, *inside, up to the limit above. False if it is no
 * valid ray there. Counts nothing. */
RT_KERNEL bool rt_enter_move(const RtInstance *instance, const RtRay *ray, const RtHit *best,
                             const RtEntry *entry, RtRay *inside) {
    if (!rt_instance_enter(instance, ray, inside)) return false;
    if (best->t < entry->far) inside->tmax = rt_minf(inside->tmax, best->t);
    return true;
}

/* The same for any ray, counted. False if it misses the instance, or can find nothing better there. */
RT_KERNEL bool rt_enter_begin(const RtGeometry *geometry, uint32_t id, const RtPreparedRay *ray,
                              const RtHit *best, RtEntry *entry, RtRay *inside, RtTally *tally) {
    rt_count_test(geometry, id, tally);
    rt_box_own_span(&geometry->boxes[id], ray, &entry->near, &entry->far);
    if (!(entry->near <= entry->far && entry->near <= rt_limit(ray, best) && entry->far >= ray->tmin))
        return false;
    if (!rt_enter_move(rt_instance_of(geometry, id), (const RtRay *)ray->ray, best, entry, inside))
        return false;
    RT_COUNT(tally, instances_entered, 1);
    RT_OBSERVE(tally, .kind = RT_TRACED_ENTERED, .index = id);
    return true;
}

/* In the part, hits may be beyond the interval by rounding. */
RT_KERNEL float rt_clamp_entry(const RtEntry *entry, float t) {
    return t < entry->near ? entry->near : t > entry->far ? entry->far : t;
}

/* Takes the answer of the part, which has counted the ray, too: its nearest hit, or if `any` an occluder,
 * with any t. Returns as rt_take_hit. */
RT_KERNEL bool rt_enter_end(const RtInstance *instance, const RtEntry *entry, RtHit hit, bool any,
                            RtHit *best, RtTally *tally) {
    RT_COUNT(tally, rays, -1);
    RT_COUNT(tally, hits, -(uint64_t)(hit.object != RT_NO_OBJECT));
    if (hit.object == RT_NO_OBJECT) {
        RT_OBSERVE(tally, .kind = RT_TRACED_LEFT);
        return false;
    }
    hit.t = any ? entry->near : rt_clamp_entry(entry, hit.t);
    if (hit.object != RT_UNNAMED_OBJECT) hit.object += instance->first;
    RT_OBSERVE(tally, .kind = RT_TRACED_LEFT, .met = true, .t = hit.t);
    if (rt_hit_before(hit.t, hit.object, *best)) *best = hit;
    return any;
}

#endif
