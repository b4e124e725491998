/* SPDX-License-Identifier: Apache-2.0 */
/* What the files of accelerators share: expanding one traversal into its four kernels, and testing an object.
 *
 * A file writes its traversal once, as an RT_KERNEL function of its own struct Type,
 *
 *     void search(const Type *self, void *scratch, const RtPreparedRay *ray, bool any, RtHit *best,
 *                 RtTally *tally);
 *
 * which improves *best, and which may return as soon as rt_test_object or rt_test_all says that the search is
 * over. `any` and the nullness of `tally` are constants where it is inlined. RT_DEFINE_KERNELS(Type, search)
 * then defines nearest_timed, nearest_counted, occluded_timed and occluded_counted, which RT_KERNEL_OPS puts
 * into the table of operations. */
#ifndef RT_ACCEL_KERNEL_H
#define RT_ACCEL_KERNEL_H

#include "accel/accel.h"
#include "core/base/observe.h"

#define RT_KERNEL static inline __attribute__((always_inline))

/* One object test: enters the hit function and keeps the better of the two hits. True when the search is
 * over: any hit will do, and here is one. */
RT_KERNEL bool rt_test_object(const RtGeometry *geometry, uint32_t id, const RtPreparedRay *ray, bool any,
                              RtHit *best, RtTally *tally) {
    float t;
    RT_COUNT(tally, object_tests, 1);
    RT_OBSERVE(tally, .kind = RT_TRACED_OBJECT_TEST, .index = id, .box = &geometry->boxes[id]);
    if (!rt_object_hit(geometry, id, ray, &t, tally)) return false;
    RT_COUNT(tally, object_hits, 1);
    RT_OBSERVE(tally, .kind = RT_TRACED_OBJECT_HIT, .index = id, .t = t);
    if (rt_hit_before(t, id, *best)) *best = (RtHit){t, id};
    return any;
}

/* Tests every object, shape by shape, each in ascending order of ids: the definition of the answer. */
RT_KERNEL bool rt_test_all(const RtGeometry *geometry, const RtPreparedRay *ray, bool any, RtHit *best,
                           RtTally *tally) {
#define LOOP(CONSTANT, name, Type)                                                                           \
    for (uint32_t i = 0; i < geometry->name##_count; i++) {                                                  \
        if (rt_test_object(geometry, geometry->name##_ids[i], ray, any, best, tally)) return true;           \
    }
    RT_SHAPES(LOOP)
#undef LOOP
    return false;
}

/* What a traversal compares entries with: the best t so far, or tmax while there is none. */
RT_KERNEL float rt_limit(const RtPreparedRay *ray, const RtHit *best) {
    return rt_minf(best->t, ray->tmax);
}

/* The kernels that one of the RT_DEFINE_..._KERNELS has defined, as members of RtAccelOps. */
#define RT_KERNEL_OPS                                                                                        \
    .nearest = nearest_timed, .occluded = occluded_timed, .nearest_counted = nearest_counted,                \
    .occluded_counted = occluded_counted

/* The search for one ray, and the bookkeeping common to all. */
#define RT_DEFINE_KERNELS(Type, search)                                                                      \
    RT_KERNEL RtHit search_one(const RtAccel *accel, const RtScratch *scratch, const RtRay *ray, bool any,   \
                               RtTally *tally) {                                                             \
        RtPreparedRay prepared;                                                                              \
        rt_hit_ray(&prepared, &accel->scene->geometry, ray, scratch->room);                                  \
        RtHit best = RT_MISS;                                                                                \
        search((const Type *)accel, scratch->own, &prepared, any, &best, tally);                             \
        RT_COUNT(tally, rays, 1);                                                                            \
        RT_COUNT(tally, hits, best.object != RT_NO_OBJECT);                                                  \
        return best;                                                                                         \
    }                                                                                                        \
    static void nearest_timed(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays,             \
                              size_t count, RtHit *hits) {                                                   \
        for (size_t i = 0; i < count; i++) hits[i] = search_one(accel, scratch, &rays[i], false, NULL);      \
    }                                                                                                        \
    static void nearest_counted(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays,           \
                                size_t count, RtHit *hits, RtTally *tallies) {                               \
        for (size_t i = 0; i < count; i++) {                                                                 \
            hits[i] = search_one(accel, scratch, &rays[i], false, &tallies[rays[i].kind]);                   \
        }                                                                                                    \
    }                                                                                                        \
    static void occluded_timed(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays,            \
                               size_t count, uint32_t *occluders) {                                          \
        for (size_t i = 0; i < count; i++) {                                                                 \
            occluders[i] = search_one(accel, scratch, &rays[i], true, NULL).object;                          \
        }                                                                                                    \
    }                                                                                                        \
    static void occluded_counted(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays,          \
                                 size_t count, uint32_t *occluders, RtTally *tallies) {                      \
        for (size_t i = 0; i < count; i++) {                                                                 \
            RtTally *tally = &tallies[rays[i].kind];                                                         \
            occluders[i] = search_one(accel, scratch, &rays[i], true, tally).object;                         \
        }                                                                                                    \
    }

/* The four kernels from one that traces a whole stream,
 *
 *     void trace(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
 *                RtHit *hits, uint32_t *occluders, RtTally *tallies, bool any, bool counted);
 *
 * answers of which go to `hits`, or where any hit will do to `occluders`. `any` and `counted` are constants
 * where it is inlined; pointers that are of no use are NULL. */
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

/* For an accelerator with kernels for each instruction set (accel/isa.h): the table of those that one of the
 * RT_DEFINE_..._KERNELS has defined, and the bytes of scratch memory that they need. */
#define RT_DEFINE_KERNEL_TABLE(name, bytes)                                                                  \
    const RtKernels RT_OF_ISA(name) = {nearest_timed, occluded_timed, nearest_counted, occluded_counted,     \
                                       bytes}

/* ---- overlays ---- */

/* What an overlay does with rays of one question, `nearest` or `occluded`, whose answers are of type Answer;
 * `tallies` may be NULL.
 *   rt_hand_down_...  rays that are none of its business
 *   rt_pass_on_...    a ray that it ought to answer and cannot */
#define RT_DEFINE_HAND_DOWN(question, Answer)                                                                \
    RT_KERNEL void rt_hand_down_##question(const RtAccel *accel, const RtScratch *scratch,                   \
                                           const RtRay *rays, size_t count, Answer *answers,                 \
                                           RtTally *tallies) {                                               \
        const RtAccel *below = accel->below;                                                                 \
        scratch++; /* of the layer below */                                                                  \
        if (tallies) {                                                                                       \
            below->ops->question##_counted(below, scratch, rays, count, answers, tallies);                   \
        } else {                                                                                             \
            below->ops->question(below, scratch, rays, count, answers);                                      \
        }                                                                                                    \
    }                                                                                                        \
    RT_KERNEL Answer rt_pass_on_##question(const RtAccel *accel, const RtScratch *scratch, const RtRay *ray, \
                                           RtTally *tallies) {                                               \
        Answer answer;                                                                                       \
        if (tallies) tallies[ray->kind].passed_on++;                                                         \
        RT_OBSERVE(tallies, .kind = RT_TRACED_PASSED_ON, .what = accel->ops->name);                          \
        rt_hand_down_##question(accel, scratch, ray, 1, &answer, tallies);                                   \
        return answer;                                                                                       \
    }
RT_DEFINE_HAND_DOWN(nearest, RtHit)
RT_DEFINE_HAND_DOWN(occluded, uint32_t)

/* A ray that this overlay has answered. Gives `hit` back, or `occluder`. */
RT_KERNEL RtHit rt_answer_nearest(RtHit hit, RtTally *tally) {
    RT_COUNT(tally, rays, 1);
    RT_COUNT(tally, hits, hit.object != RT_NO_OBJECT);
    return hit;
}

RT_KERNEL uint32_t rt_answer_occluded(uint32_t occluder, RtTally *tally) {
    RT_COUNT(tally, rays, 1);
    RT_COUNT(tally, hits, occluder != RT_NO_OBJECT);
    return occluder;
}

/* The two kernels of a question that an overlay answers for rays of `own_kind`, one by one; runs of others
 * are handed down in streams. */
#define RT_ANSWER_QUESTION(Type, question, Answer, own_kind, answer_one)                                     \
    RT_KERNEL void question##_all(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays,         \
                                  size_t count, Answer *answers, RtTally *tallies) {                         \
        for (size_t i = 0, next; i < count; i = next) {                                                      \
            for (next = i; next < count && rays[next].kind != (own_kind); next++) {                          \
            }                                                                                                \
            if (next > i) rt_hand_down_##question(accel, scratch, rays + i, next - i, answers + i, tallies); \
            for (; next < count && rays[next].kind == (own_kind); next++) {                                  \
                answers[next] = answer_one((const Type *)accel, scratch, &rays[next], tallies);              \
            }                                                                                                \
        }                                                                                                    \
    }                                                                                                        \
    RT_DEFINE_BOTH(question, Answer, question##_all)

/* The two kernels of a question that an overlay does not answer for any ray. */
#define RT_REFUSE_QUESTION(question, Answer) RT_DEFINE_BOTH(question, Answer, rt_hand_down_##question)

/* Expands `all` into the timed and the counted kernel. */
#define RT_DEFINE_BOTH(question, Answer, all)                                                                \
    static void question##_timed(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays,          \
                                 size_t count, Answer *answers) {                                            \
        all(accel, scratch, rays, count, answers, NULL);                                                     \
    }                                                                                                        \
    static void question##_counted(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays,        \
                                   size_t count, Answer *answers, RtTally *tallies) {                        \
        all(accel, scratch, rays, count, answers, tallies);                                                  \
    }

/* The kernels of an overlay for shadow rays, from
 *
 *     uint32_t shade(const Type *self, const RtScratch *scratch, const RtRay *ray, RtTally *tallies);
 *
 * which gives the occluder of one shadow ray, through rt_answer_occluded or rt_pass_on_occluded; and those of
 * an overlay for primary rays, from
 *
 *     RtHit see(const Type *self, const RtScratch *scratch, const RtRay *ray, RtTally *tallies);
 *
 * which gives the nearest hit of one, through rt_answer_nearest or rt_pass_on_nearest. All else is handed
 * down. */
#define RT_DEFINE_SHADOW_KERNELS(Type, shade)                                                                \
    RT_REFUSE_QUESTION(nearest, RtHit)                                                                       \
    RT_ANSWER_QUESTION(Type, occluded, uint32_t, RT_RAY_SHADOW, shade)

#define RT_DEFINE_PRIMARY_KERNELS(Type, see)                                                                 \
    RT_ANSWER_QUESTION(Type, nearest, RtHit, RT_RAY_PRIMARY, see)                                            \
    RT_REFUSE_QUESTION(occluded, uint32_t)

#endif
