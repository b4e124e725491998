/* SPDX-License-Identifier: Apache-2.0 */
/* A workload in order: record, build, and then for each kind of rays count, time, and read hardware counters.
 */
#include "core/base/memory.h"
#include "experiment/workload_state.h"
#include "measure/ray_file.h"

#include <string.h>

/* ---- what is left to do ---- */

static bool kind_is_done(const RtWorkloadState *workload, RtRayKind kind) {
    for (uint32_t c = 0; c < workload->count; c++) {
        const RtCell *cell = rt_cell_at(workload->results, workload->index, c, kind);
        bool null = c == workload->experiment->candidate_count;
        if (!rt_workload_runs(workload, c) || *cell->limit) continue;
        if ((!cell->counted && !null) || (!cell->timed && !workload->count_only)) return false;
        if (workload->hardware && !cell->hardware.known && !null) return false;
        if (workload->distributions && !cell->distributions && !null) return false;
    }
    return true;
}

static bool workload_is_done(const RtWorkloadState *workload) {
    const RtWorkloadResult *result = &workload->results->workloads[workload->index];
    if (!rt_only_scene(&workload->options->only, workload->experiment, workload->index)) return true;
    if (result->skipped || !result->known) return result->skipped;
    for (uint32_t c = 0; c < workload->count; c++) {
        if (rt_workload_runs(workload, c) && !rt_build_at(workload->results, workload->index, c)->known)
            return false;
    }
    for (uint32_t k = 0; k < workload->experiment->kind_count; k++) {
        RtRayKind kind = workload->experiment->kinds[k];
        if (!rt_only_kind(&workload->options->only, kind)) continue;
        if (result->rays[kind] && !kind_is_done(workload, kind)) return false;
    }
    return true;
}

/* ---- the steps ---- */

/* Row by row what each ray met and cost, where that is asked for: of one candidate, on one kind of rays. */
static RtStatus save_rows(const RtWorkloadState *workload, RtRayKind kind, RtError *error) {
    const RtWorkloadOptions *options = workload->options;
    RtRows rows;
    if (!options->hits && !options->counts) return RT_OK;
    RtStatus status =
        rt_measure_rows(workload->accels[0], &workload->sets[kind], options->threads, &rows, error);
    if (status == RT_OK && options->hits) status = rt_hits_save(&rows, options->hits, error);
    if (status == RT_OK && options->counts) status = rt_counts_save(&rows, options->counts, error);
    rt_rows_clear(&rows);
    return status;
}

/* One that broke on other rays is built anew for these. Whatever goes wrong then is its own fault, too. */
static RtStatus rebuild_broken(RtWorkloadState *workload, uint32_t c, RtError *error) {
    RtAccel *accel = workload->built[c];
    if (!accel || rt_accel_check(accel, NULL) == RT_OK) return RT_OK;
    rt_accel_destroy(accel);
    workload->built[c] = NULL;
    return rt_accel_build(&rt_workload_setup(workload, c)->parsed, workload->scene,
                          workload->options->threads, &workload->built[c], error);
}

/* Those that are not known to go beyond a limit, or to break. */
static RtStatus choose_accels(RtWorkloadState *workload, RtRayKind kind, RtError *error) {
    for (uint32_t c = 0; c < workload->count; c++) {
        const RtCell *cell = rt_cell_at(workload->results, workload->index, c, kind);
        RtStatus status = rebuild_broken(workload, c, error);
        workload->accels[c] = status != RT_OK || *cell->limit ? NULL : workload->built[c];
        if (status != RT_OK) RT_TRY(rt_workload_break(workload, c, kind, error));
    }
    return RT_OK;
}

static RtStatus measure_kind(RtWorkloadState *workload, RtRayKind kind, RtError *error) {
    if (workload->sets[kind].count == 0 || kind_is_done(workload, kind)) return RT_OK;
    if (!rt_only_kind(&workload->options->only, kind)) return RT_OK;
    RT_TRY(choose_accels(workload, kind, error));
    RtStatus status = rt_workload_count(workload, kind, error);
    if (status == RT_OK) status = save_rows(workload, kind, error);
    if (status == RT_OK && workload->options->rays)
        status = workload->options->rays(workload->options->rays_context, workload->index,
                                         &workload->sets[kind], workload->reference, error);
    if (status == RT_OK && workload->options->timer) {
        status = workload->options->timer(workload->options->timer_context, workload, kind, error);
    } else if (status == RT_OK && !workload->count_only) {
        status = rt_workload_time(workload, kind, error);
    }
    if (status == RT_OK && workload->hardware) status = rt_workload_hardware(workload, kind, error);
    rt_free(workload->answers);
    workload->answers = NULL;
    return status;
}

static RtStatus measure(RtWorkloadState *workload, RtError *error) {
    RT_TRY(rt_workload_prepare(workload, error));
    RT_TRY(rt_workload_build(workload, error));
    for (uint32_t k = 0; k < workload->experiment->kind_count; k++) {
        RT_TRY(measure_kind(workload, workload->experiment->kinds[k], error));
    }
    return RT_OK;
}

static RtWorkloadState state_of(RtResults *results, uint32_t index, const RtWorkloadOptions *options) {
    RtWorkloadState workload = {
        .results = results, .experiment = results->experiment, .options = options, .index = index};
    workload.count_only = options->count_only || workload.experiment->count_only;
    workload.hardware = workload.experiment->hardware && !workload.count_only && !options->timer;
    workload.distributions = workload.experiment->distributions && !options->timer;
    workload.count = workload.experiment->candidate_count + (!workload.count_only && !options->timer);
    return workload;
}

bool rt_workload_is_done(RtResults *results, uint32_t index, const RtWorkloadOptions *options) {
    RtWorkloadState workload = state_of(results, index, options);
    return workload_is_done(&workload);
}

RtStatus rt_workload_measure(RtResults *results, uint32_t index, const RtWorkloadOptions *options,
                             RtScene *scene, RtError *error) {
    RtWorkloadState workload = state_of(results, index, options);
    workload.scene = scene;
    if (workload_is_done(&workload)) return RT_OK;
    workload.built = rt_alloc(workload.count, sizeof(RtAccel *));
    workload.accels = rt_alloc(workload.count, sizeof(RtAccel *));
    workload.shares = rt_alloc(workload.count, sizeof(RtWorkloadShare));
    RtStatus status = RT_OK;
    if (!workload.built || !workload.accels || !workload.shares)
        status = rt_fail_memory(error, "a workload", workload.count * sizeof(RtWorkloadShare));
    if (status == RT_OK) status = measure(&workload, error);
    for (uint32_t c = 0; workload.built && c < workload.count; c++) rt_accel_destroy(workload.built[c]);
    rt_accel_destroy(workload.reference);
    for (int k = 0; k < RT_RAY_KIND_COUNT; k++) rt_rayset_clear(&workload.sets[k]);
    rt_free(workload.built);
    rt_free(workload.accels);
    rt_free(workload.shares);
    return status;
}

RtStatus rt_workload_run(RtResults *results, uint32_t index, const RtWorkloadOptions *options,
                         RtError *error) {
    RtScene scene;
    if (rt_workload_is_done(results, index, options)) return RT_OK;
    RT_TRY(rt_workload_open(results, index, options, &scene, error));
    RtStatus status = rt_workload_measure(results, index, options, &scene, error);
    rt_scene_clear(&scene);
    return status;
}
