/* SPDX-License-Identifier: Apache-2.0 */
/* Entering instances: the hit function of a part placed in a scene (core/shape/instance.h), which asks the
 * accelerator of the part.
 *
 * The base of a stack owns an accelerator for each part of its scene, of the same spec, or of the one after
 * '/' (RtSpec). A query has a query in each of them. A part is on the path of a ray at most once at a time,
 * since parts contain no cycles, so one for each is enough.
 *
 * The part is asked for hits up to the best one, but not where the interval of the instance's thick box ends
 * before it: a hit beyond would be clamped to that end, and so be nearer. */
#include "accel/kernel.h"

RT_KERNEL bool enter(const RtGeometry *geometry, uint32_t id, const RtPreparedRay *ray, bool any, RtHit *best,
                     RtTally *tally) {
    const RtInstance *instance = &geometry->instances[rt_ref_index(geometry->objects[id])];
    const RtQuery *query = &((RtHitMemory *)ray->crossings)->parts[instance->part];
    RtRay inside;
    RtHit hit = RT_MISS;
    float near, far;
    rt_count_test(geometry, id, tally);
    rt_box_own_span(&geometry->boxes[id], ray, &near, &far);
    if (!(near <= far && near <= rt_limit(ray, best) && far >= ray->tmin)) return false;
    if (!rt_instance_enter(instance, (const RtRay *)ray->ray, &inside)) return false;
    if (best->t < far) inside.tmax = rt_minf(inside.tmax, best->t);
    inside.kind = 0; /* one tally for all kinds */
    const uint64_t rays = tally ? tally->rays : 0, hits = tally ? tally->hits : 0;
    rt_trace_stream(query->accel, query->scratch, &inside, 1, any ? NULL : &hit, any ? &hit.object : NULL, tally);
    if (tally) {
        tally->rays = rays; /* it is the same ray */
        tally->hits = hits;
    }
    if (hit.object == RT_NO_OBJECT) return false;
    hit.object += instance->first;
    hit.t = any ? near : hit.t < near ? near : hit.t > far ? far : hit.t;
    if (rt_hit_before(hit.t, hit.object, *best)) *best = hit;
    return any;
}

bool rt_enter_timed(const RtGeometry *geometry, uint32_t id, const RtPreparedRay *ray, bool any, RtHit *best) {
    return any ? enter(geometry, id, ray, true, best, NULL) : enter(geometry, id, ray, false, best, NULL);
}

bool rt_enter_counted(const RtGeometry *geometry, uint32_t id, const RtPreparedRay *ray, bool any, RtHit *best,
                      RtTally *tally) {
    return enter(geometry, id, ray, any, best, tally);
}
