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

#define RT_KERNEL static inline __attribute__((always_inline))

/* One object test: enters the hit function and keeps the better of the two hits. True when the search is
 * over: any hit will do, and here is one. */
RT_KERNEL bool rt_test_object(const RtGeometry *geometry, uint32_t id, const RtPreparedRay *ray, bool any,
                              RtHit *best, RtTally *tally) {
    float t;
    RT_COUNT(tally, object_tests, 1);
    if (!rt_object_hit(geometry, id, ray, &t)) return false;
    RT_COUNT(tally, object_hits, 1);
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

/* The kernels that RT_DEFINE_KERNELS or RT_DEFINE_SHADOW_KERNELS has defined, as members of RtAccelOps. */
#define RT_KERNEL_OPS                                                                                        \
    .nearest = nearest_timed, .occluded = occluded_timed, .nearest_counted = nearest_counted,                \
    .occluded_counted = occluded_counted

/* The search for one ray, and the bookkeeping common to all. */
#define RT_DEFINE_KERNELS(Type, search)                                                                      \
    RT_KERNEL RtHit search_one(const RtAccel *accel, void *scratch, const RtRay *ray, bool any,              \
                               RtTally *tally) {                                                             \
        RtPreparedRay prepared = rt_ray_prepare(ray, &accel->scene->geometry.box);                           \
        RtHit best = RT_MISS;                                                                                \
        search((const Type *)accel, scratch, &prepared, any, &best, tally);                                  \
        RT_COUNT(tally, rays, 1);                                                                            \
        RT_COUNT(tally, hits, best.object != RT_NO_OBJECT);                                                  \
        return best;                                                                                         \
    }                                                                                                        \
    static void nearest_timed(const RtAccel *accel, void *scratch, const RtRay *rays, size_t count,          \
                              RtHit *hits) {                                                                 \
        for (size_t i = 0; i < count; i++) hits[i] = search_one(accel, scratch, &rays[i], false, NULL);      \
    }                                                                                                        \
    static void nearest_counted(const RtAccel *accel, void *scratch, const RtRay *rays, size_t count,        \
                                RtHit *hits, RtTally *tallies) {                                             \
        for (size_t i = 0; i < count; i++) {                                                                 \
            hits[i] = search_one(accel, scratch, &rays[i], false, &tallies[rays[i].kind]);                   \
        }                                                                                                    \
    }                                                                                                        \
    static void occluded_timed(const RtAccel *accel, void *scratch, const RtRay *rays, size_t count,         \
                               uint32_t *blockers) {                                                         \
        for (size_t i = 0; i < count; i++) {                                                                 \
            blockers[i] = search_one(accel, scratch, &rays[i], true, NULL).object;                           \
        }                                                                                                    \
    }                                                                                                        \
    static void occluded_counted(const RtAccel *accel, void *scratch, const RtRay *rays, size_t count,       \
                                 uint32_t *blockers, RtTally *tallies) {                                     \
        for (size_t i = 0; i < count; i++) {                                                                 \
            RtTally *tally = &tallies[rays[i].kind];                                                         \
            blockers[i] = search_one(accel, scratch, &rays[i], true, tally).object;                          \
        }                                                                                                    \
    }

/* ---- overlays ---- */

static inline void *rt_scratch_below(const RtAccel *accel, void *scratch) {
    return (char *)scratch + accel->scratch_room;
}

/* Rays that are none of this overlay's business; `tallies` may be NULL. */
RT_KERNEL void rt_hand_down_nearest(const RtAccel *accel, void *scratch, const RtRay *rays, size_t count,
                                    RtHit *hits, RtTally *tallies) {
    const RtAccel *below = accel->below;
    scratch = rt_scratch_below(accel, scratch);
    if (tallies) {
        below->ops->nearest_counted(below, scratch, rays, count, hits, tallies);
    } else {
        below->ops->nearest(below, scratch, rays, count, hits);
    }
}

RT_KERNEL void rt_hand_down_occluded(const RtAccel *accel, void *scratch, const RtRay *rays, size_t count,
                                     uint32_t *blockers, RtTally *tallies) {
    const RtAccel *below = accel->below;
    scratch = rt_scratch_below(accel, scratch);
    if (tallies) {
        below->ops->occluded_counted(below, scratch, rays, count, blockers, tallies);
    } else {
        below->ops->occluded(below, scratch, rays, count, blockers);
    }
}

/* A ray that this overlay ought to answer and cannot. */
RT_KERNEL uint32_t rt_pass_on_occluded(const RtAccel *accel, void *scratch, const RtRay *ray,
                                       RtTally *tallies) {
    uint32_t blocker;
    if (tallies) tallies[ray->kind].passed_on++;
    rt_hand_down_occluded(accel, scratch, ray, 1, &blocker, tallies);
    return blocker;
}

/* A ray that this overlay has answered. Gives `blocker` back. */
RT_KERNEL uint32_t rt_answer_occluded(uint32_t blocker, RtTally *tally) {
    RT_COUNT(tally, rays, 1);
    RT_COUNT(tally, hits, blocker != RT_NO_OBJECT);
    return blocker;
}

/* The kernels of an overlay for shadow rays, from
 *
 *     uint32_t shade(const Type *self, void *scratch, const RtRay *ray, RtTally *tallies);
 *
 * which gives the blocker of one shadow ray, through rt_answer_occluded or rt_pass_on_occluded. Queries for
 * the nearest hit, and rays of other kinds, are handed down in streams. */
#define RT_DEFINE_SHADOW_KERNELS(Type, shade)                                                                \
    RT_KERNEL void shade_all(const RtAccel *accel, void *scratch, const RtRay *rays, size_t count,           \
                             uint32_t *blockers, RtTally *tallies) {                                         \
        for (size_t i = 0, next; i < count; i = next) {                                                      \
            for (next = i; next < count && rays[next].kind != RT_RAY_SHADOW; next++) {                       \
            }                                                                                                \
            if (next > i) rt_hand_down_occluded(accel, scratch, rays + i, next - i, blockers + i, tallies);  \
            for (; next < count && rays[next].kind == RT_RAY_SHADOW; next++) {                               \
                blockers[next] = shade((const Type *)accel, scratch, &rays[next], tallies);                  \
            }                                                                                                \
        }                                                                                                    \
    }                                                                                                        \
    static void nearest_timed(const RtAccel *accel, void *scratch, const RtRay *rays, size_t count,          \
                              RtHit *hits) {                                                                 \
        rt_hand_down_nearest(accel, scratch, rays, count, hits, NULL);                                       \
    }                                                                                                        \
    static void nearest_counted(const RtAccel *accel, void *scratch, const RtRay *rays, size_t count,        \
                                RtHit *hits, RtTally *tallies) {                                             \
        rt_hand_down_nearest(accel, scratch, rays, count, hits, tallies);                                    \
    }                                                                                                        \
    static void occluded_timed(const RtAccel *accel, void *scratch, const RtRay *rays, size_t count,         \
                               uint32_t *blockers) {                                                         \
        shade_all(accel, scratch, rays, count, blockers, NULL);                                              \
    }                                                                                                        \
    static void occluded_counted(const RtAccel *accel, void *scratch, const RtRay *rays, size_t count,       \
                                 uint32_t *blockers, RtTally *tallies) {                                     \
        shade_all(accel, scratch, rays, count, blockers, tallies);                                           \
    }

#endif
