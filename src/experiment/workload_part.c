/* SPDX-License-Identifier: Apache-2.0 */
/* Which part of a workload is measured: what is asked for, without what goes beyond a limit. */
#include "core/base/clock.h"
#include "experiment/workload_state.h"

#include <stdio.h>
#include <string.h>

/* ---- what is asked for ---- */

static bool is_called(const char *name, const char *label, const char *base) {
    return !name || strcmp(name, label) == 0 || strcmp(name, base) == 0;
}

bool rt_only_scene(const RtOnly *only, const RtExperiment *experiment, uint32_t workload) {
    const RtWorkload *setup = &experiment->workloads[workload];
    if (only->shards && workload % only->shards != only->shard - 1) return false;
    return is_called(only->scene, setup->label, setup->base);
}

bool rt_only_accel(const RtOnly *only, const RtExperiment *experiment, uint32_t candidate) {
    const RtCandidate *setup = &experiment->candidates[candidate];
    if (candidate == experiment->candidate_count || rt_candidate_is_baseline(experiment, candidate))
        return true;
    return is_called(only->accel, setup->label, setup->base);
}

bool rt_only_kind(const RtOnly *only, RtRayKind kind) {
    return !only->kind || strcmp(only->kind, rt_ray_kind_name(kind)) == 0;
}

/* ---- limits ---- */

RtStatus rt_workload_leave_out(RtWorkloadState *workload, uint32_t c, RtEventKind what, RtRayKind kind,
                               char *limit, RtError *error) {
    const RtExperiment *experiment = workload->experiment;
    bool broken = what == RT_EVENT_BROKEN || what == RT_EVENT_BROKEN_BUILD;
    if (c == experiment->candidate_count || rt_candidate_is_baseline(experiment, c)) {
        RtStatus status = broken ? RT_BROKEN : RT_BAD_INPUT;
        rt_fail(error, status, "the baseline '%s' %s on '%s': %s", rt_candidate_label(experiment, c),
                broken ? "is broken" : "goes beyond a limit", experiment->workloads[workload->index].label,
                limit);
        *limit = '\0';
        return status;
    }
    const RtObserver *observer = &workload->options->observer;
    if (broken && observer->notice) {
        char message[RT_MAX_LIMIT + 2 * RT_MAX_SPEC_CHARS];
        snprintf(message, sizeof message, "%s on %s: %s", rt_candidate_label(experiment, c),
                 experiment->workloads[workload->index].label, limit);
        observer->notice(observer->context, message);
    }
    return rt_workload_tell(workload, what, c, kind, error);
}

RtStatus rt_workload_break(RtWorkloadState *workload, uint32_t c, RtRayKind kind, RtError *error) {
    RtCell *cell = rt_cell_at(workload->results, workload->index, c, kind);
    snprintf(cell->limit, RT_MAX_LIMIT, "%.511s", error->message);
    cell->broken = true;
    workload->accels[c] = NULL;
    return rt_workload_leave_out(workload, c, RT_EVENT_BROKEN, kind, cell->limit, error);
}

RtStatus rt_workload_draw_probe(RtWorkloadState *workload, const RtRaySet *set, uint64_t first,
                                RtError *error) {
    RtRaySet drawn;
    RT_TRY(rt_rayset_limit(set, RT_PROBE_RAYS, RT_PROBE_RAYS, &drawn, error));
    memcpy(set->rays + first, drawn.rays, drawn.count * sizeof(RtRay));
    workload->probe = (RtWorkloadShare){.set = *set, .expected = workload->answers + first};
    workload->probe.set.rays = set->rays + first;
    workload->probe.set.count = drawn.count;
    rt_rayset_clear(&drawn);
    return rt_measure_answers(workload->reference, &workload->probe.set, workload->options->threads,
                              workload->answers + first, error);
}

/* Whether a cell would take longer than it may to be counted and timed, by what a part of its rays takes. */
static RtStatus check_seconds(RtWorkloadState *workload, uint32_t c, RtRayKind kind, RtError *error) {
    const RtExperiment *experiment = workload->experiment;
    RtCell *cell = rt_cell_at(workload->results, workload->index, c, kind);
    const RtRaySet *part = &workload->probe.set;
    RtCount count;
    double all = (double)workload->shares[c].set.count;
    double passes = workload->count_only ? 1 : 2 + experiment->rounds;
    double start = rt_wall_seconds();
    RtStatus status = rt_measure_count(workload->accels[c], part, workload->probe.expected, 1, &count, error);
    if (rt_workload_is_own_fault(workload, c, status)) return rt_workload_break(workload, c, kind, error);
    RT_TRY(status);
    double seconds = (rt_wall_seconds() - start) / (double)part->count * all * passes;
    if (seconds <= experiment->limit_seconds) return RT_OK;
    snprintf(cell->limit, RT_MAX_LIMIT, "it would take about %.2g s, more than %g s", seconds,
             experiment->limit_seconds);
    workload->accels[c] = NULL;
    return rt_workload_leave_out(workload, c, RT_EVENT_TOO_LONG, kind, cell->limit, error);
}

RtStatus rt_workload_check_limits(RtWorkloadState *workload, RtRayKind kind, RtError *error) {
    if (workload->experiment->limit_seconds == 0) return RT_OK;
    for (uint32_t c = 0; c < workload->experiment->candidate_count; c++) {
        const RtCell *cell = rt_cell_at(workload->results, workload->index, c, kind);
        if (workload->accels[c] && !cell->counted) RT_TRY(check_seconds(workload, c, kind, error));
    }
    return RT_OK;
}
