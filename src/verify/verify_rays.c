/* SPDX-License-Identifier: Apache-2.0 */
#include "verify/verify_rays.h"

#include "core/base/memory.h"
#include "verify/ray_families.h"

#include <string.h>

/* The levels of the camera's frame, and the part of the rays that is its: one in so many. */
enum { FRAME_DEPTH = 4, CAMERA_PART = 10 };

/* Half of the camera's rays are primary ones at most, in the shape of its image. */
static RtStatus sample(const RtVerifyRays *wanted, RtScene *scene, RtError *error) {
    if (wanted->given) return RT_OK;
    uint64_t primary = wanted->count / (UINT64_C(2) * CAMERA_PART);
    double samples = (double)primary;
    double aspect = (double)scene->camera.width / (double)scene->camera.height;
    double width = fmin(fmax(sqrt(samples * aspect), 1), RT_MAX_IMAGE_SIDE);
    double height = fmin(fmax(width / aspect, 1), RT_MAX_IMAGE_SIDE);
    return rt_scene_sample(scene, (uint32_t)width, (uint32_t)height, 1, false, error);
}

/* Appends at most `limit` rays of `set`, evenly spread. */
static RtStatus append(RtRay *rays, uint64_t *count, const RtRaySet *set, uint64_t limit, RtError *error) {
    RtRaySet thin;
    if (limit == 0) return RT_OK;
    RT_TRY(rt_rayset_limit(set, limit, 1, &thin, error));
    memcpy(rays + *count, thin.rays, thin.count * sizeof(RtRay));
    *count += thin.count;
    rt_rayset_clear(&thin);
    return RT_OK;
}

/* Appends the share of each kind of ray that the camera's frame produces. */
static RtStatus append_camera_rays(const RtVerifyRays *wanted, const RtAccel *oracle, RtRay *rays,
                                   uint64_t *count, RtError *error) {
    RtRecording recording = {.depth = FRAME_DEPTH, .seed = wanted->seed, .threads = wanted->threads};
    RtRaySet sets[RT_RAY_KIND_COUNT];
    RT_TRY(rt_rayset_record(sets, oracle, &recording, error));
    uint64_t kinds = 0;
    for (int kind = 0; kind < RT_RAY_RANDOM; kind++) kinds += sets[kind].count > 0;
    RtStatus status = RT_OK;
    for (int kind = 0; kind < RT_RAY_RANDOM && status == RT_OK; kind++) {
        if (sets[kind].count > 0)
            status = append(rays, count, &sets[kind], wanted->count / CAMERA_PART / kinds, error);
    }
    for (int kind = 0; kind < RT_RAY_KIND_COUNT; kind++) rt_rayset_clear(&sets[kind]);
    return status;
}

/* Appends `count` rays of all families, the same number of each to within one. They take turns: the slowest
 * family for a structure is not all of one thread's work, and neighbours of a ray are of more than one
 * family. */
static void append_family_rays(RtQuery *query, uint64_t seed, RtRay *rays, uint64_t count) {
    uint64_t families = rt_ray_family_count(), done = 0;
    for (uint64_t turn = 0; done < count; turn += RT_RAY_BUNDLE) {
        for (uint64_t f = 0; f < families; f++) {
            uint64_t share = count * (f + 1) / families - count * f / families;
            if (share <= turn) continue;
            uint64_t some = share - turn < RT_RAY_BUNDLE ? share - turn : RT_RAY_BUNDLE;
            rt_ray_family_fill((size_t)f, query, seed, turn, (size_t)some, rays + done);
            done += some;
        }
    }
}

/* What the camera's kinds leave goes to the families. */
RtStatus rt_verify_rays(const RtVerifyRays *wanted, const RtAccel *oracle, RtRay *rays, RtError *error) {
    RtQuery query;
    uint64_t count = 0;
    if (wanted->given) {
        memcpy(rays, wanted->given->rays, wanted->count * sizeof(RtRay));
        return RT_OK;
    }
    RT_TRY(append_camera_rays(wanted, oracle, rays, &count, error));
    RT_TRY(rt_query_init(&query, oracle, error));
    append_family_rays(&query, wanted->seed, rays + count, wanted->count - count);
    rt_query_clear(&query);
    return rt_accel_check(oracle, error);
}

RtStatus rt_verify_stage_init(RtVerifyStage *stage, const RtScene *scene, const RtVerifyRays *wanted,
                              RtError *error) {
    *stage = (RtVerifyStage){.scene = *scene};
    RT_TRY(sample(wanted, &stage->scene, error));
    RT_TRY(rt_accel_open_on(rt_accel_truth(), &stage->scene, wanted->threads, &stage->truth, error));
    stage->rays = rt_alloc(wanted->count, sizeof(RtRay));
    if (!stage->rays) return rt_fail_memory(error, "rays", wanted->count * sizeof(RtRay));
    return rt_verify_rays(wanted, stage->truth, stage->rays, error);
}

RtStatus rt_verify_stage_answer(RtVerifyStage *stage, const RtVerifyRays *wanted, RtError *error) {
    return rt_reference_init(&stage->reference, stage->truth, stage->rays, wanted->count, wanted->threads,
                             error);
}

void rt_verify_stage_clear(RtVerifyStage *stage) {
    rt_reference_clear(&stage->reference);
    rt_free(stage->rays);
    rt_accel_destroy(stage->truth);
    *stage = (RtVerifyStage){0};
}
