/* SPDX-License-Identifier: Apache-2.0 */
/* Building: every candidate on the scene of a workload, within the limits of the experiment. */
#include "core/base/memory.h"
#include "experiment/workload_state.h"

#include <stdio.h>

/* ---- leaves ---- */

typedef struct Leaves {
    RtOccurrences values[RT_LEAF_QUANTITY_COUNT];
    RtStatus status;
    RtError *error;
} Leaves;

static void take_leaf(void *context, const RtBoxView *view) {
    Leaves *leaves = context;
    if (!view->leaf) return;
    const uint32_t values[RT_LEAF_QUANTITY_COUNT] = {
        [RT_QUANTITY_leaf_size] = view->objects, [RT_QUANTITY_leaf_depth] = view->depth};
    for (int q = 0; q < RT_LEAF_QUANTITY_COUNT && leaves->status == RT_OK; q++)
        leaves->status = rt_occurrences_add(&leaves->values[q], values[q], leaves->error);
}

static RtStatus distribute_leaves(const RtAccel *accel, RtBuildResult *result, RtError *error) {
    const RtAccel *base = rt_accel_base(accel);
    Leaves leaves = {.error = error};
    if (!base->ops->shows_lists) return RT_OK;
    base->ops->each_box(base, (RtBoxViewer){take_leaf, &leaves});
    RtStatus status = leaves.status;
    if (status == RT_OK && !result->leaves)
        result->leaves = rt_alloc(RT_LEAF_QUANTITY_COUNT, sizeof(RtDistribution));
    if (status == RT_OK && !result->leaves)
        status = rt_fail_memory(error, "distributions", RT_LEAF_QUANTITY_COUNT * sizeof(RtDistribution));
    for (int q = 0; q < RT_LEAF_QUANTITY_COUNT; q++) {
        if (status == RT_OK) result->leaves[q] = rt_distribution_of(&leaves.values[q]);
        rt_occurrences_clear(&leaves.values[q]);
    }
    return status;
}

/* ---- structures ---- */

/* Builds one candidate up to RT_MOST_BUILDS times and keeps the last; *median gets the median seconds. */
static RtStatus build_one(RtWorkloadState *workload, const RtSpec *spec, RtAccel **out, double *median,
                          RtError *error) {
    double seconds[RT_MOST_BUILDS], sum = 0;
    uint32_t builds = 0;
    *out = NULL;
    do {
        rt_accel_destroy(*out);
        *out = NULL;
        RT_TRY(rt_accel_build(spec, workload->scene, workload->options->threads, out, error));
        seconds[builds] = (*out)->build_seconds;
        sum += seconds[builds++];
    } while (builds < RT_MOST_BUILDS && sum < RT_CHEAP_BUILD);
    *median = rt_median(seconds, builds);
    return RT_OK;
}

/* Builds a candidate within the limits. If it exceeds one, it is destroyed, and result->limit names the
 * limit. */
static RtStatus build_within(RtWorkloadState *workload, uint32_t c, const RtSpec *spec, double *seconds,
                             RtError *error) {
    const RtExperiment *experiment = workload->experiment;
    RtBuildResult *result = rt_build_at(workload->results, workload->index, c);
    rt_memory_limit(1000000 * experiment->limit_megabytes);
    RtStatus status = build_one(workload, spec, &workload->built[c], seconds, error);
    rt_memory_limit(0);
    bool too_large = status == RT_NO_MEMORY && experiment->limit_megabytes;
    /* If a plugin rejects the scene, or takes all memory, only its own results are lost. */
    bool broken = status == RT_BROKEN || (status != RT_OK && !too_large && rt_spec_is_remote(spec));
    if (status != RT_OK && !broken && !too_large) return status;
    if (broken) {
        snprintf(result->limit, RT_MAX_LIMIT, "%.511s", error->message);
        result->broken = true;
        return rt_workload_leave_out(workload, c, RT_EVENT_BROKEN_BUILD, RT_RAY_PRIMARY, result->limit,
                                     error);
    }
    if (too_large) {
        snprintf(result->limit, RT_MAX_LIMIT, "its structure takes more than %llu MB",
                 (unsigned long long)experiment->limit_megabytes);
    } else if (experiment->limit_seconds > 0 && *seconds > experiment->limit_seconds) {
        snprintf(result->limit, RT_MAX_LIMIT, "building takes %.3g s, more than %g s", *seconds,
                 experiment->limit_seconds);
    } else {
        return RT_OK;
    }
    rt_accel_destroy(workload->built[c]);
    workload->built[c] = NULL;
    return rt_workload_leave_out(workload, c, RT_EVENT_TOO_LARGE, RT_RAY_PRIMARY, result->limit, error);
}

RtStatus rt_workload_build(RtWorkloadState *workload, RtError *error) {
    for (uint32_t c = 0; c < workload->count; c++) {
        const RtSpec *spec = &rt_workload_setup(workload, c)->parsed;
        double seconds = 0;
        RtBuildResult *result = rt_build_at(workload->results, workload->index, c);
        if (!rt_workload_runs(workload, c)) continue;
        RT_TRY(build_within(workload, c, spec, &seconds, error));
        if (!workload->built[c] || result->known) continue;
        const RtAccel *accel = workload->built[c];
        *result = (RtBuildResult){.known = true, .exact = accel->exact, .counts = accel->counts};
        result->seconds = seconds;
        rt_spec_format(spec, result->spec);
        rt_accel_describe(accel, &result->shape);
        if (workload->distributions) RT_TRY(distribute_leaves(accel, result, error));
        RT_TRY(rt_workload_tell(workload, RT_EVENT_BUILD, c, RT_RAY_PRIMARY, error));
    }
    return RT_OK;
}
