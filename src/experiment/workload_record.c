/* SPDX-License-Identifier: Apache-2.0 */
/* Recording: the scene of a workload, and its rays, recorded from a frame or read from a file. */
#include "experiment/workload_state.h"
#include "measure/ray_file.h"
#include "scenes/open.h"

#include <stdio.h>

/* ---- the scene ---- */

RtStatus rt_workload_open_scene(const RtWorkload *workload, RtScene *scene, RtError *error) {
    *scene = (RtScene){0};
    if (!workload->file || rt_file_exists(workload->path)) return rt_scene_open(workload->path, scene, error);
    if (rt_file_is_dead_link(workload->path, error)) return RT_BAD_INPUT;
    return rt_fail(error, RT_BAD_INPUT,
                   "%s: there is no such file; `scenes/fetch.sh` fetches the public meshes", workload->path);
}

RtStatus rt_workload_open(RtResults *results, uint32_t index, const RtWorkloadOptions *options,
                          RtScene *scene, RtError *error) {
    const RtWorkload *setup = &results->experiment->workloads[index];
    const RtRunObserver *observer = &options->observer;
    char message[RT_MAX_PATH + 128];
    *scene = (RtScene){0};
    if (!setup->optional || !setup->file || rt_file_exists(setup->path))
        return rt_workload_open_scene(setup, scene, error);
    snprintf(message, sizeof message,
             "%s is missing, so '%s' is skipped; `scenes/fetch.sh` fetches the public meshes", setup->path,
             setup->label);
    if (observer->notice) observer->notice(observer->context, message);
    results->workloads[index].skipped = true;
    return RT_OK;
}

/* ---- the rays ---- */

/* Keeps at most `limit` rays of each kind that the experiment asks for. */
static RtStatus keep_sets(const RtExperiment *experiment, const RtRaySet *recorded, RtRaySet *sets,
                          RtError *error) {
    for (uint32_t k = 0; k < experiment->kind_count; k++) {
        RtRayKind kind = experiment->kinds[k];
        RT_TRY(rt_rayset_limit(&recorded[kind], experiment->limit, experiment->coherent_run, &sets[kind],
                               error));
    }
    return RT_OK;
}

RtStatus rt_workload_record(const RtExperiment *experiment, uint32_t index, int threads, RtScene *scene,
                            RtAccel **reference, RtRaySet *sets, RtError *error) {
    const RtWorkload *setup = &experiment->workloads[index];
    RtRecording recording = {.depth = setup->depth,
                             .seed = experiment->seed,
                             .random = experiment->limit,
                             .threads = threads,
                             .light_from_outside = setup->light_from_outside};
    RtRaySet recorded[RT_RAY_KIND_COUNT] = {0};
    RT_TRY(rt_scene_sample(scene, setup->width, setup->height, 1, setup->corners, error));
    RT_TRY(rt_accel_open_on(rt_accel_default(), scene, threads, reference, error));
    if (*experiment->rays_from) {
        RtRayKind kind = experiment->kinds[0];
        return rt_rays_load(experiment->rays_from, kind, &sets[kind], error);
    }
    RtStatus status = rt_rayset_record(recorded, *reference, &recording, error);
    if (status == RT_OK) status = keep_sets(experiment, recorded, sets, error);
    for (int k = 0; k < RT_RAY_KIND_COUNT; k++) rt_rayset_clear(&recorded[k]);
    return status;
}

RtStatus rt_workload_prepare(RtWorkloadState *workload, RtError *error) {
    RT_TRY(rt_workload_record(workload->experiment, workload->index, workload->options->threads,
                              workload->scene, &workload->reference, workload->sets, error));
    RtWorkloadResult *result = &workload->results->workloads[workload->index];
    RtWorkloadResult now = {.known = true,
                            .objects = workload->scene->geometry.object_count,
                            .width = workload->scene->sampling.width,
                            .height = workload->scene->sampling.height,
                            .scene = rt_scene_fingerprint(workload->scene)};
    bool same = now.scene == result->scene;
    for (int k = 0; k < RT_RAY_KIND_COUNT; k++) {
        now.rays[k] = workload->sets[k].count;
        now.ray_fingerprints[k] = workload->sets[k].fingerprint;
        same &= now.ray_fingerprints[k] == result->ray_fingerprints[k];
    }
    if (result->known && !same) {
        return rt_fail(error, RT_BAD_INPUT,
                       "'%s' has changed since this run was interrupted: start over with --force",
                       workload->experiment->workloads[workload->index].label);
    }
    if (result->known) return RT_OK;
    *result = now;
    return rt_workload_tell(workload, RT_EVENT_WORKLOAD, 0, RT_RAY_PRIMARY, error);
}
