/* SPDX-License-Identifier: Apache-2.0 */
/* The distributions of a workload: over rays, each asked by itself, and over the leaves of structures. */
#include "core/base/memory.h"
#include "experiment/workload_state.h"

static uint64_t value_of(const RtTally *tally, RtRayQuantity quantity) {
#define GET(name, meaning)                                                                                   \
    case RT_QUANTITY_##name: return tally->name;
    switch (quantity) {
        RT_RAY_QUANTITIES(GET)
    case RT_RAY_QUANTITY_COUNT: break;
    }
#undef GET
    return 0;
}

static RtStatus distribute_rows(const RtRows *rows, RtDistribution *out, RtError *error) {
    RtStatus status = RT_OK;
    for (int q = 0; q < RT_RAY_QUANTITY_COUNT && status == RT_OK; q++) {
        RtOccurrences values = {0};
        for (uint64_t i = 0; i < rows->count && status == RT_OK; i++)
            status = rt_occurrences_add(&values, value_of(&rows->tallies[i], (RtRayQuantity)q), error);
        out[q] = rt_distribution_of(&values);
        rt_occurrences_clear(&values);
    }
    return status;
}

static RtStatus distribute_cell(const RtWorkloadState *workload, uint32_t c, RtCell *cell, RtError *error) {
    RtRows rows;
    RtDistribution *made = rt_alloc(RT_RAY_QUANTITY_COUNT, sizeof(RtDistribution));
    if (!made) return rt_fail_memory(error, "distributions", RT_RAY_QUANTITY_COUNT * sizeof(RtDistribution));
    RtStatus status = rt_measure_rows(workload->accels[c], &workload->shares[c].set,
                                      workload->options->threads, &rows, error);
    if (status == RT_OK) status = distribute_rows(&rows, made, error);
    if (status == RT_NO_MEMORY && rt_accel_is_away(workload->accels[c]))
        status = RT_BROKEN; /* it counts beyond all reason: its own fault */
    rt_rows_clear(&rows);
    if (status == RT_OK) {
        cell->distributions = made;
    } else {
        rt_free(made);
    }
    return status;
}

RtStatus rt_workload_distribute(RtWorkloadState *workload, RtRayKind kind, RtError *error) {
    for (uint32_t c = 0; c < workload->experiment->candidate_count; c++) {
        RtCell *cell = rt_cell_at(workload->results, workload->index, c, kind);
        if (!workload->accels[c] || cell->distributions) continue;
        RtStatus status = distribute_cell(workload, c, cell, error);
        if (rt_workload_is_own_fault(workload, c, status)) {
            RT_TRY(rt_workload_break(workload, c, kind, error));
            continue;
        }
        RT_TRY(status);
        RT_TRY(rt_workload_tell(workload, RT_EVENT_DISTRIBUTION, c, kind, error));
    }
    return RT_OK;
}

/* ---- leaves ---- */

typedef struct Leaves {
    RtOccurrences values[RT_LEAF_QUANTITY_COUNT];
    RtStatus status;
    RtError *error;
} Leaves;

static void take_leaf(void *context, uint32_t objects, uint32_t depth) {
    Leaves *leaves = context;
    const uint32_t values[RT_LEAF_QUANTITY_COUNT] = {
        [RT_QUANTITY_leaf_size] = objects, [RT_QUANTITY_leaf_depth] = depth};
    for (int q = 0; q < RT_LEAF_QUANTITY_COUNT && leaves->status == RT_OK; q++)
        leaves->status = rt_occurrences_add(&leaves->values[q], values[q], leaves->error);
}

RtStatus rt_workload_distribute_leaves(const RtAccel *accel, RtBuildResult *result, RtError *error) {
    const RtAccel *base = rt_accel_base(accel);
    Leaves leaves = {.error = error};
    if (!base->ops->each_leaf) return RT_OK;
    RtStatus status = base->ops->each_leaf(base, (RtLeafViewer){take_leaf, &leaves}, error);
    if (status == RT_OK) status = leaves.status;
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
