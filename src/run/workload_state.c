/* SPDX-License-Identifier: Apache-2.0 */
/* Which candidates take part in a workload, and how they leave it. */
#include "run/workload_state.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

bool rt_workload_runs(const RtWorkloadState *workload, uint32_t c) {
    return rt_candidate_runs(workload->experiment, c, workload->index) &&
           rt_selection_has(&workload->options->only, workload->experiment, workload->index, c,
                            RT_ALL_RAYS) &&
           !*rt_build_at(workload->results, workload->index, c)->left_out;
}

RtStatus rt_workload_leave_out(RtWorkloadState *workload, uint32_t c, RtEventKind what, RtRayKind kind,
                               RtCause cause, RtError *error, const char *why, ...) {
    const RtExperiment *experiment = workload->experiment;
    const bool broken = cause == RT_CAUSE_BROKEN, refused = cause == RT_CAUSE_REFUSED;
    const bool null = c == experiment->candidate_count;
    const char *label = rt_candidate_label(experiment, c);
    const char *scene = experiment->workloads[workload->index].label;
    char text[RT_MAX_LEFT_OUT];
    va_list args;
    va_start(args, why);
    /* clang-tidy 14 does not see va_start. NOLINTNEXTLINE(clang-analyzer-valist.Uninitialized) */
    vsnprintf(text, sizeof text, why, args);
    va_end(args);
    if (!refused && (null || rt_candidate_is_baseline(experiment, c)))
        return rt_fail(error, broken ? RT_BROKEN : RT_BAD_INPUT, "the baseline '%s' %s on '%s': %s", label,
                       broken ? "is broken" : "is left out", scene, text);
    if (what == RT_EVENT_NO_BUILD) {
        rt_results_leave_out(workload->results, workload->index, c, text, refused, broken);
    } else {
        RtCell *cell = rt_cell_at(workload->results, workload->index, c, kind);
        strcpy(cell->left_out, text);
        cell->broken = broken;
    }
    if (!null)
        rt_notify(&workload->options->observer, "%s on %s: %s%s", label, scene,
                  broken    ? ""
                  : refused ? "refused: "
                            : "left out: ",
                  text);
    if (!null && refused && rt_results_refused(workload->results, workload->index, RT_FASTEST_BASELINE) &&
        rt_candidate_is_baseline(experiment, c))
        rt_notify(&workload->options->observer, "%s: without the baseline '%s' there are no ratios", scene,
                  rt_baseline_label(experiment));
    return rt_workload_tell(workload, what, c, kind, error);
}

RtStatus rt_workload_break(RtWorkloadState *workload, uint32_t c, RtRayKind kind, RtError *error) {
    workload->accels[c] = NULL;
    return rt_workload_leave_out(workload, c, RT_EVENT_NO_CELL, kind, RT_CAUSE_BROKEN, error, "%s",
                                 error->message);
}

RtStatus rt_workload_exclude_broken(RtWorkloadState *workload, RtRayKind kind, RtError *error) {
    for (uint32_t c = 0; c < workload->count; c++) {
        const RtAccel *accel = workload->accels[c];
        if (!accel || rt_accel_check(accel, error) == RT_OK) continue;
        RT_TRY(rt_workload_break(workload, c, kind, error));
    }
    return RT_OK;
}
