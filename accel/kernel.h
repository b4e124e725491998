/* What the files of accelerators share: expanding one traversal into its four kernels, and testing an object.
 *
 * A file defines, as RT_KERNEL functions of its own struct Type,
 *
 *     RtHit find_nearest(const Type *self, void *scratch, const RtPreparedRay *ray, RtTally *tally);
 *     bool  find_any    (const Type *self, void *scratch, const RtPreparedRay *ray, RtTally *tally);
 *
 * and then says RT_DEFINE_KERNELS(Type, find_nearest, find_any), which defines nearest_timed,
 * nearest_counted, occluded_timed and occluded_counted for its table of operations. */
#ifndef RT_ACCEL_KERNEL_H
#define RT_ACCEL_KERNEL_H

#include "accel/accel.h"

#define RT_KERNEL static inline __attribute__((always_inline))

/* One object test for the nearest hit: enters the hit function and keeps the better of the two hits. */
RT_KERNEL void rt_test_nearest(const RtGeometry *geometry, uint32_t id, const RtPreparedRay *ray, RtHit *best,
                               RtTally *tally) {
    float t;
    RT_COUNT(tally, object_tests, 1);
    if (!rt_object_hit(geometry, id, ray, &t)) return;
    RT_COUNT(tally, object_hits, 1);
    if (rt_hit_before(t, id, *best)) *best = (RtHit){t, id};
}

/* One object test for occlusion. */
RT_KERNEL bool rt_test_any(const RtGeometry *geometry, uint32_t id, const RtPreparedRay *ray,
                           RtTally *tally) {
    float t;
    RT_COUNT(tally, object_tests, 1);
    if (!rt_object_hit(geometry, id, ray, &t)) return false;
    RT_COUNT(tally, object_hits, 1);
    return true;
}

/* What a traversal compares entries with: the best t so far, or tmax while there is none. */
RT_KERNEL float rt_limit(const RtPreparedRay *ray, const RtHit *best) {
    return rt_minf(best->t, ray->tmax);
}

#define RT_DEFINE_KERNELS(Type, find_nearest, find_any)                                                      \
    static void nearest_timed(const RtAccel *accel, void *scratch, const RtRay *rays, size_t count,          \
                              RtHit *hits) {                                                                 \
        for (size_t i = 0; i < count; i++) {                                                                 \
            RtPreparedRay ray = rt_ray_prepare(&rays[i], &accel->scene->geometry.box);                       \
            hits[i] = find_nearest((const Type *)accel, scratch, &ray, NULL);                                \
        }                                                                                                    \
    }                                                                                                        \
    static void nearest_counted(const RtAccel *accel, void *scratch, const RtRay *rays, size_t count,        \
                                RtHit *hits, RtTally *tallies) {                                             \
        for (size_t i = 0; i < count; i++) {                                                                 \
            RtPreparedRay ray = rt_ray_prepare(&rays[i], &accel->scene->geometry.box);                       \
            RtTally *tally = &tallies[rays[i].kind];                                                         \
            hits[i] = find_nearest((const Type *)accel, scratch, &ray, tally);                               \
            tally->rays++;                                                                                   \
            tally->hits += hits[i].object != RT_NO_OBJECT;                                                   \
        }                                                                                                    \
    }                                                                                                        \
    static void occluded_timed(const RtAccel *accel, void *scratch, const RtRay *rays, size_t count,         \
                               bool *blocked) {                                                              \
        for (size_t i = 0; i < count; i++) {                                                                 \
            RtPreparedRay ray = rt_ray_prepare(&rays[i], &accel->scene->geometry.box);                       \
            blocked[i] = find_any((const Type *)accel, scratch, &ray, NULL);                                 \
        }                                                                                                    \
    }                                                                                                        \
    static void occluded_counted(const RtAccel *accel, void *scratch, const RtRay *rays, size_t count,       \
                                 bool *blocked, RtTally *tallies) {                                          \
        for (size_t i = 0; i < count; i++) {                                                                 \
            RtPreparedRay ray = rt_ray_prepare(&rays[i], &accel->scene->geometry.box);                       \
            RtTally *tally = &tallies[rays[i].kind];                                                         \
            blocked[i] = find_any((const Type *)accel, scratch, &ray, tally);                                \
            tally->rays++;                                                                                   \
            tally->hits += blocked[i];                                                                       \
        }                                                                                                    \
    }

#endif
