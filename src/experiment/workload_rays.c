/* SPDX-License-Identifier: Apache-2.0 */
/* The rays of a workload: recorded from a frame of its scene, or read from a file. */
#include "experiment/workload.h"
#include "measure/ray_file.h"

/* Keeps of the recorded sets what the experiment asks for, at most `limit` of each kind. */
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
