/* SPDX-License-Identifier: Apache-2.0 */
#include "experiment/selection.h"

#include <string.h>

static bool has_scene(const RtPart *part, const RtExperiment *experiment, uint32_t workload) {
    return !part->scene || rt_workload_is_called(&experiment->workloads[workload], part->scene);
}

static bool has_kind(const RtPart *part, RtRayKind kind) {
    return kind == RT_ALL_RAYS || !part->kind || strcmp(part->kind, rt_ray_kind_name(kind)) == 0;
}

bool rt_selection_has(const RtSelection *only, const RtExperiment *experiment, uint32_t workload,
                      uint32_t candidate, RtRayKind kind) {
    bool found = only->part_count == 0;
    if (only->shards && workload % only->shards != only->shard - 1) return false;
    for (uint32_t i = 0; i < only->part_count && !found; i++) {
        const RtPart *part = &only->parts[i];
        const bool accel = candidate == experiment->candidate_count || !part->accel ||
                           rt_candidate_is_baseline(experiment, candidate) ||
                           rt_candidate_is_called(&experiment->candidates[candidate], part->accel);
        found = accel && has_scene(part, experiment, workload) && has_kind(part, kind);
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

RtStatus rt_selection_check(const RtSelection *only, const RtExperiment *e, RtError *error) {
    for (uint32_t i = 0; i < only->part_count; i++) RT_TRY(check_part(&only->parts[i], e, error));
    return RT_OK;
}
