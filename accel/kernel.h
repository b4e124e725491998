/* What the files of accelerators share: expanding one traversal into its four kernels, and testing an object.
 *
 * A file writes its traversal once, as an RT_KERNEL function of its own struct Type,
 *
 *     void search(const Type *self, void *scratch, const RtPreparedRay *ray, bool any, RtHit *best,
 *                 RtTally *tally);
 *
 * which improves *best, and which may return as soon as rt_test_object or rt_test_all says that the search is
 * over. `any` and the nullness of `tally` are constants where it is inlined. RT_DEFINE_KERNELS(Type, search)
 * then defines nearest_timed, nearest_counted, occluded_timed and occluded_counted for the table of
 * operations. */
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
                               bool *blocked) {                                                              \
        for (size_t i = 0; i < count; i++) {                                                                 \
            blocked[i] = search_one(accel, scratch, &rays[i], true, NULL).object != RT_NO_OBJECT;            \
        }                                                                                                    \
    }                                                                                                        \
    static void occluded_counted(const RtAccel *accel, void *scratch, const RtRay *rays, size_t count,       \
                                 bool *blocked, RtTally *tallies) {                                          \
        for (size_t i = 0; i < count; i++) {                                                                 \
            RtTally *tally = &tallies[rays[i].kind];                                                         \
            blocked[i] = search_one(accel, scratch, &rays[i], true, tally).object != RT_NO_OBJECT;           \
        }                                                                                                    \
    }

#endif
