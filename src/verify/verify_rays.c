/* SPDX-License-Identifier: Apache-2.0 */
#include "verify/verify_rays.h"

#include "core/base/memory.h"
#include "verify/ray_families.h"

#include <string.h>

/* The levels of the camera's frame, and the share of its rays: one in CAMERA_PART. */
enum { FRAME_DEPTH = 4, CAMERA_PART = 10 };

/* At most half of the camera's rays are primary ones, in the shape of its image. */
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

/* Appends an equal share of each kind of ray in the camera's frame. */
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

/* Appends `count` rays of all families, in equal numbers to within one. Families alternate, so that no
 * thread gets all rays of a slow family and neighbouring rays differ. */
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

/* The families get the rest. */
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

RtStatus rt_verify_scene_init(RtVerifyScene *scene, const RtScene *from, const RtVerifyRays *wanted,
                              RtError *error) {
    *scene = (RtVerifyScene){.scene = *from};
    RT_TRY(sample(wanted, &scene->scene, error));
    RT_TRY(rt_accel_open_on(rt_accel_truth(), &scene->scene, wanted->threads, &scene->truth, error));
    scene->rays = rt_alloc(wanted->count, sizeof(RtRay));
    if (!scene->rays) return rt_fail_memory(error, "rays", wanted->count * sizeof(RtRay));
    return rt_verify_rays(wanted, scene->truth, scene->rays, error);
}

RtStatus rt_verify_scene_answer(RtVerifyScene *scene, const RtVerifyRays *wanted, RtError *error) {
    return rt_reference_init(&scene->reference, scene->truth, scene->rays, wanted->count, wanted->threads,
                             error);
}

void rt_verify_scene_clear(RtVerifyScene *scene) {
    rt_reference_clear(&scene->reference);
    rt_free(scene->rays);
    rt_accel_destroy(scene->truth);
    *scene = (RtVerifyScene){0};
}
