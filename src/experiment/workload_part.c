/* SPDX-License-Identifier: Apache-2.0 */
/* The part of an experiment that is measured, and reports of what is excluded. */
#include "experiment/workload_state.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* ---- parts ---- */

static bool has_scene(const RtPart *part, const RtExperiment *experiment, uint32_t workload) {
    return !part->scene || rt_workload_is_called(&experiment->workloads[workload], part->scene);
}

static bool has_accel(const RtPart *part, const RtExperiment *experiment, uint32_t candidate) {
    return candidate == experiment->candidate_count || rt_candidate_is_baseline(experiment, candidate) ||
           !part->accel || rt_candidate_is_called(&experiment->candidates[candidate], part->accel);
}

static bool has_kind(const RtPart *part, RtRayKind kind) {
    return kind == RT_ALL_RAYS || !part->kind || strcmp(part->kind, rt_ray_kind_name(kind)) == 0;
}

bool rt_only_cell(const RtOnly *only, const RtExperiment *experiment, uint32_t workload, uint32_t candidate,
                  RtRayKind kind) {
    bool found = only->part_count == 0;
    if (only->shards && workload % only->shards != only->shard - 1) return false;
    for (uint32_t i = 0; i < only->part_count && !found; i++) {
        const RtPart *part = &only->parts[i];
        found = has_scene(part, experiment, workload) && has_accel(part, experiment, candidate) &&
                has_kind(part, kind);
    }
    return found;
}

static RtStatus check_part(const RtPart *part, const RtExperiment *e, RtError *error) {
    bool scene = !part->scene, accel = !part->accel, kind = !part->kind;
    for (uint32_t t = 0; t < e->workload_count; t++) scene |= has_scene(part, e, t);
    for (uint32_t c = 0; c < e->candidate_count; c++)
        accel |= part->accel && rt_candidate_is_called(&e->candidates[c], part->accel);
    for (uint32_t k = 0; k < e->kind_count; k++) kind |= has_kind(part, e->kinds[k]);
    if (scene && accel && kind) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT, "--only: '%s' is not the label of one of the %s",
                   !scene   ? part->scene
                   : !accel ? part->accel
                            : part->kind,
                   !scene   ? "scenes"
                   : !accel ? "accelerators"
                            : "kinds of rays");
}

RtStatus rt_only_check(const RtOnly *only, const RtExperiment *e, RtError *error) {
    for (uint32_t i = 0; i < only->part_count; i++) RT_TRY(check_part(&only->parts[i], e, error));
    return RT_OK;
}

bool rt_workload_runs(const RtWorkloadState *workload, uint32_t c) {
    return rt_candidate_runs(workload->experiment, c, workload->index) &&
           rt_only_cell(&workload->options->only, workload->experiment, workload->index, c, RT_ALL_RAYS) &&
           !*rt_build_at(workload->results, workload->index, c)->left_out;
}

/* ---- reports ---- */

void rt_notify(const RtRunObserver *observer, const char *format, ...) {
    char message[RT_MAX_PATH + 1024];
    va_list args;
    if (!observer->notice) return;
    va_start(args, format);
    /* clang-tidy 14 does not see va_start. NOLINTNEXTLINE(clang-analyzer-valist.Uninitialized) */
    vsnprintf(message, sizeof message, format, args);
    va_end(args);
    observer->notice(observer->context, message);
}

bool rt_event_is_broken(const RtResults *results, const RtEvent *event) {
    if (event->what == RT_EVENT_NO_BUILD)
        return rt_build_at(results, event->workload, event->candidate)->broken;
    return event->what == RT_EVENT_NO_CELL &&
           rt_cell_at(results, event->workload, event->candidate, event->kind)->broken;
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
