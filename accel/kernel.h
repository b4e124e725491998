/* SPDX-License-Identifier: Apache-2.0 */
/* For the source files of accelerators: object tests, and the expansion of one traversal into four kernels.
 *
 * A file writes its traversal once, as an RT_KERNEL function of its own struct Type,
 *
 *     void search(const Type *self, void *scratch, const RtPreparedRay *ray, bool any, RtHit *best,
 *                 RtTally *tally);
 *
 * which improves *best, and may return as soon as rt_test_object or rt_test_all returns true. After inlining,
 * `any` and whether `tally` is NULL are constants. RT_DEFINE_KERNELS(Type, search) then defines
 * the table `kernels` of its operations. */
#ifndef RT_ACCEL_KERNEL_H
#define RT_ACCEL_KERNEL_H

#include "accel/accel.h"
#include "core/base/observe.h"

#include <string.h>

#define RT_KERNEL static inline __attribute__((always_inline))

RT_KERNEL void rt_count_test(const RtGeometry *geometry, uint32_t id, RtTally *tally) {
    RT_COUNT(tally, object_tests, 1);
    RT_OBSERVE(tally, .kind = RT_TRACED_OBJECT_TEST, .index = id, .box = &geometry->boxes[id]);
}

/* Keeps the better hit. Returns true if the search is over: the query asks for any hit, and this is one. */
RT_KERNEL bool rt_take_hit(RtHit hit, bool any, RtHit *best, RtTally *tally) {
    RT_COUNT(tally, object_hits, 1);
    RT_OBSERVE(tally, .kind = RT_TRACED_OBJECT_HIT, .index = hit.object, .t = hit.t);
    if (rt_hit_before(hit.t, hit.object, *best)) *best = hit;
    return any;
}

/* Tests an instance, whose hit is on an object of its part (accel/instance.c). Returns as rt_take_hit. */
bool rt_enter_timed(const RtGeometry *geometry, uint32_t id, const RtPreparedRay *ray, bool any, RtHit *best);
bool rt_enter_counted(const RtGeometry *geometry, uint32_t id, const RtPreparedRay *ray, bool any,
                      RtHit *best, RtTally *tally);

/* One object test, by the hit function. Returns as rt_take_hit. */
RT_KERNEL bool rt_test_object(const RtGeometry *geometry, uint32_t id, const RtPreparedRay *ray, bool any,
                              RtHit *best, RtTally *tally) {
    float t;
    if (__builtin_expect(rt_is_instance(geometry, id), 0))
        return tally ? rt_enter_counted(geometry, id, ray, any, best, tally)
                     : rt_enter_timed(geometry, id, ray, any, best);
    rt_count_test(geometry, id, tally);
    return rt_object_hit(geometry, id, ray, &t, tally) && rt_take_hit((RtHit){t, id}, any, best, tally);
}

/* The same for a test that was made, with this t, or NaN if the object is not hit. */
RT_KERNEL bool rt_take_test(const RtGeometry *geometry, uint32_t id, float t, bool any, RtHit *best,
                            RtTally *tally) {
    rt_count_test(geometry, id, tally);
    return !isnan(t) && rt_take_hit((RtHit){t, id}, any, best, tally);
}

/* ---- lists of objects ---- */

/* For structures that may list an object more than once: Kirk & Arvo 1991, Improved Ray Tagging for
 * Voxel-Based Ray Tracing, Graphics Gems II. A mailbox is part of a query's scratch memory, which is zeroed
 * at first, so each thread has its own. It stores for every object the number of the last ray that tested it.
 */
typedef struct RtMailbox {
    uint32_t ray;
    uint32_t last[]; /* [object_count] */
} RtMailbox;

/* Gives a layer that is being built a mailbox, or none, where instances in instances are refused: each voxel
 * would enter them again, at each level. */
static inline RtStatus rt_set_mailbox(RtAccel *accel, bool on, RtError *error) {
    const RtGeometry *g = &accel->scene->geometry;
    accel->scratch_bytes = on ? sizeof(RtMailbox) + g->object_count * sizeof(uint32_t) : 0;
    if (on || g->nesting < 2) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT, "%s: instances in instances need mailbox=on", accel->ops->name);
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

/* Tests every object, shape by shape, each in ascending order of ids. This defines the right answer. Compiled
 * once, in accel.c: most structures come here for few rays. Returns true if the search is over. */
bool rt_test_all_timed(const RtGeometry *geometry, const RtPreparedRay *ray, bool any, RtHit *best);
bool rt_test_all_counted(const RtGeometry *geometry, const RtPreparedRay *ray, bool any, RtHit *best,
                         RtTally *tally);

RT_KERNEL bool rt_test_all(const RtGeometry *geometry, const RtPreparedRay *ray, bool any, RtHit *best,
                           RtTally *tally) {
    return tally ? rt_test_all_counted(geometry, ray, any, best, tally)
                 : rt_test_all_timed(geometry, ray, any, best);
}

/* Counts a ray that is answered. */
RT_KERNEL void rt_count_answer(bool hit, RtTally *tally) {
    RT_COUNT(tally, rays, 1);
    RT_COUNT(tally, hits, hit);
}

/* Writes the answer of ray i of a stream, and counts it. */
RT_KERNEL void rt_put_answer(const RtHit *best, size_t i, bool any, RtHit *hits, uint32_t *occluders,
                             RtTally *tally) {
    rt_count_answer(best->object != RT_NO_OBJECT, tally);
    if (any)
        occluders[i] = best->object;
    else
        hits[i] = *best;
}

/* The largest t at which a hit is still of interest: the best t so far, or tmax if there is none. */
RT_KERNEL float rt_limit(const RtPreparedRay *ray, const RtHit *best) {
    return rt_minf(best->t, ray->tmax);
}

/* The table `kernels`, with `bytes` of scratch memory for a query, from a function that traces a whole
 * stream,
 *
 *     void trace(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
 *                RtHit *hits, uint32_t *occluders, RtTally *tallies, bool any, bool counted);
 *
 * Answers go to `hits`, or to `occluders` if `any`; the other pointer is NULL, and so is `tallies` if not
 * `counted`. After inlining, `any` and `counted` are constants. */
#define RT_DEFINE_STREAM_KERNELS(trace, bytes)                                                               \
    RT_DEFINE_KERNEL(nearest_timed, trace, false, false)                                                     \
    RT_DEFINE_KERNEL(nearest_counted, trace, false, true)                                                    \
    RT_DEFINE_KERNEL(occluded_timed, trace, true, false)                                                     \
    RT_DEFINE_KERNEL(occluded_counted, trace, true, true)                                                    \
    static const RtKernels kernels = {nearest_timed, occluded_timed, nearest_counted, occluded_counted,      \
                                      bytes};
#define RT_DEFINE_KERNEL(name, trace, any, counted)                                                          \
    static void name(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,        \
                     RtHit *hits, uint32_t *occluders, RtTally *tallies) {                                   \
        trace(accel, scratch, rays, count, (any) ? NULL : hits, (any) ? occluders : NULL,                    \
              (counted) ? tallies : NULL, any, counted);                                                     \
    }

/* The same from a search for one ray; `build` sets the bytes of scratch memory, if any. */
#define RT_DEFINE_KERNELS(Type, search)                                                                      \
    RT_KERNEL void search_each(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays,            \
                               size_t count, RtHit *hits, uint32_t *occluders, RtTally *tallies, bool any,   \
                               bool counted) {                                                               \
        for (size_t i = 0; i < count; i++) {                                                                 \
            RtTally *tally = counted ? &tallies[rays[i].kind] : NULL;                                        \
            RtPreparedRay prepared;                                                                          \
            rt_hit_ray(&prepared, &accel->scene->geometry, &rays[i], scratch->hit_memory);                   \
            RtHit best = RT_MISS;                                                                            \
            search((const Type *)accel, scratch->own, &prepared, any, &best, tally);                         \
            rt_put_answer(&best, i, any, hits, occluders, tally);                                            \
        }                                                                                                    \
    }                                                                                                        \
    RT_DEFINE_STREAM_KERNELS(search_each, 0)

/* For accelerators with kernels for several instruction sets (accel/isa.h): names the table `kernels`. */
#define RT_DEFINE_KERNEL_TABLE(name)                                                                         \
    extern const RtKernels *const RT_OF_ISA(name);                                                           \
    const RtKernels *const RT_OF_ISA(name) = &kernels

/* ---- overlays ---- */

/* Hands a stream of rays down to the layer below, for answers as of rt_trace_stream. */
RT_KERNEL void rt_hand_down(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                            RtHit *hits, uint32_t *occluders, RtTally *tallies) {
    rt_trace_stream(accel->below, scratch + 1, rays, count, hits, occluders, tallies);
}

#endif
