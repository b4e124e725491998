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
 * nearest_timed, nearest_counted, occluded_timed and occluded_counted, and RT_KERNEL_OPS enters them in the
 * table of operations. */
#ifndef RT_ACCEL_KERNEL_H
#define RT_ACCEL_KERNEL_H

#include "accel/accel.h"
#include "core/base/observe.h"

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

/* One object test, by the hit function. Returns as rt_take_hit. */
RT_KERNEL bool rt_test_object(const RtGeometry *geometry, uint32_t id, const RtPreparedRay *ray, bool any,
                              RtHit *best, RtTally *tally) {
    float t;
    rt_count_test(geometry, id, tally);
    return rt_object_hit(geometry, id, ray, &t, tally) && rt_take_hit((RtHit){t, id}, any, best, tally);
}

/* The same for a test that was made, with this t, or NaN if the object is not hit. */
RT_KERNEL bool rt_take_test(const RtGeometry *geometry, uint32_t id, float t, bool any, RtHit *best,
                            RtTally *tally) {
    rt_count_test(geometry, id, tally);
    return !isnan(t) && rt_take_hit((RtHit){t, id}, any, best, tally);
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

/* The kernels defined by an RT_DEFINE_..._KERNELS macro, as members of RtAccelOps. */
#define RT_KERNEL_OPS                                                                                        \
    .nearest = nearest_timed, .occluded = occluded_timed, .nearest_counted = nearest_counted,                \
    .occluded_counted = occluded_counted

/* The four kernels from a function that traces a whole stream,
 *
 *     void trace(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
 *                RtHit *hits, uint32_t *occluders, RtTally *tallies, bool any, bool counted);
 *
 * Answers go to `hits`, or to `occluders` if `any`; the other pointer is NULL, and so is `tallies` if not
 * `counted`. After inlining, `any` and `counted` are constants. */
#define RT_DEFINE_STREAM_KERNELS(trace)                                                                      \
    static void nearest_timed(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays,             \
                              size_t count, RtHit *hits) {                                                   \
        trace(accel, scratch, rays, count, hits, NULL, NULL, false, false);                                  \
    }                                                                                                        \
    static void nearest_counted(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays,           \
                                size_t count, RtHit *hits, RtTally *tallies) {                               \
        trace(accel, scratch, rays, count, hits, NULL, tallies, false, true);                                \
    }                                                                                                        \
    static void occluded_timed(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays,            \
                               size_t count, uint32_t *occluders) {                                          \
        trace(accel, scratch, rays, count, NULL, occluders, NULL, true, false);                              \
    }                                                                                                        \
    static void occluded_counted(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays,          \
                                 size_t count, uint32_t *occluders, RtTally *tallies) {                      \
        trace(accel, scratch, rays, count, NULL, occluders, tallies, true, true);                            \
    }

/* The four kernels from a search for one ray. */
#define RT_DEFINE_KERNELS(Type, search)                                                                      \
    RT_KERNEL void search_each(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays,            \
                               size_t count, RtHit *hits, uint32_t *occluders, RtTally *tallies, bool any,   \
                               bool counted) {                                                               \
        for (size_t i = 0; i < count; i++) {                                                                 \
            RtTally *tally = counted ? &tallies[rays[i].kind] : NULL;                                        \
            RtPreparedRay prepared;                                                                          \
            rt_hit_ray(&prepared, &accel->scene->geometry, &rays[i], scratch->crossings);                    \
            RtHit best = RT_MISS;                                                                            \
            search((const Type *)accel, scratch->own, &prepared, any, &best, tally);                         \
            rt_put_answer(&best, i, any, hits, occluders, tally);                                            \
        }                                                                                                    \
    }                                                                                                        \
    RT_DEFINE_STREAM_KERNELS(search_each)

/* For accelerators with kernels for several instruction sets (accel/isa.h): defines the table of the kernels
 * defined by an RT_DEFINE_..._KERNELS macro, and the bytes of scratch memory that they need. */
#define RT_DEFINE_KERNEL_TABLE(name, bytes)                                                                  \
    const RtKernels RT_OF_ISA(name) = {nearest_timed, occluded_timed, nearest_counted, occluded_counted,     \
                                       bytes}

/* ---- overlays ---- */

/* Hand a stream of rays down to the layer below. `tallies` may be NULL. */
RT_KERNEL void rt_hand_down_nearest(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays,
                                    size_t count, RtHit *hits, RtTally *tallies) {
    rt_trace_stream(accel->below, scratch + 1, rays, count, hits, NULL, tallies);
}

RT_KERNEL void rt_hand_down_occluded(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays,
                                     size_t count, uint32_t *occluders, RtTally *tallies) {
    rt_trace_stream(accel->below, scratch + 1, rays, count, NULL, occluders, tallies);
}

/* Expands the function `all`, which answers a query for a stream, into the timed and the counted kernel. */
#define RT_DEFINE_BOTH(query, Answer, all)                                                                   \
    static void query##_timed(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays,             \
                              size_t count, Answer *answers) {                                               \
        all(accel, scratch, rays, count, answers, NULL);                                                     \
    }                                                                                                        \
    static void query##_counted(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays,           \
                                size_t count, Answer *answers, RtTally *tallies) {                           \
        all(accel, scratch, rays, count, answers, tallies);                                                  \
    }

/* The two kernels of a query that an overlay hands down for every ray. */
#define RT_DEFINE_HANDED_DOWN(query, Answer) RT_DEFINE_BOTH(query, Answer, rt_hand_down_##query)

#endif
