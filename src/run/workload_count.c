/* SPDX-License-Identifier: Apache-2.0 */
/* Counting: each candidate gets a share of the rays of one kind. Those that would exceed a limit are
 * excluded; the others are counted, their answers are compared with the expected ones, and distributions are
 * computed. */
#include "accel/plugin.h"
#include "core/base/file.h"
#include "core/base/memory.h"
#include "core/base/words.h"
#include "measure/measure.h"
#include "run/workload_state.h"

#include <inttypes.h>
#include <string.h>

enum { PROBE_RAYS = 256 }; /* at most */

/* ---- shares ---- */

/* Rays that stay if every `stride`th is kept. */
static uint64_t thinned_count(const RtRaySet *set, uint64_t stride) {
    return (set->count + stride - 1) / stride;
}

/* Copies the rays and answers of a thinned share to index `first`. */
static void thin_share(const RtWorkloadState *workload, const RtRaySet *set, uint64_t stride, uint64_t first,
                       RtWorkloadShare *share) {
    share->set.rays = set->rays + first;
    share->set.count = thinned_count(set, stride);
    share->expected = workload->answers + first;
    for (uint64_t i = 0; i < share->set.count; i++) {
        share->set.rays[i] = set->rays[i * stride];
        workload->answers[first + i] = workload->answers[i * stride];
    }
}

/* Draws the probe from the whole set, in short runs, to index `first`. The first rays of a set would be those
 * at the top of the image, which are usually cheaper than others. */
static RtStatus draw_probe(RtWorkloadState *workload, const RtRaySet *set, uint64_t first, RtError *error) {
    RT_OWNED(RtRaySet, drawn, rt_rayset_clear);
    RT_TRY(rt_rayset_limit(set, PROBE_RAYS, PROBE_RAYS, &drawn, error));
    memcpy(set->rays + first, drawn.rays, drawn.count * sizeof(RtRay));
    workload->probe = (RtWorkloadShare){.set = *set, .expected = workload->answers + first};
    workload->probe.set.rays = set->rays + first;
    workload->probe.set.count = drawn.count;
    return rt_measure_answers(workload->reference, &workload->probe.set, workload->options->threads,
                              workload->answers + first, error);
}

/* Gives every candidate its share of the set, and the answers to those that learn. Thinned shares and the
 * probe are copies after the set, in the same array: the baseline is timed on all of them, and may be an
 * accelerator that learns, which knows rays by their addresses. */
static RtStatus deal_shares(RtWorkloadState *workload, RtRayKind kind, RtError *error) {
    RtRaySet *set = &workload->sets[kind];
    uint64_t all = set->count + PROBE_RAYS, used = set->count;
    uint32_t capacity = (uint32_t)set->count;
    for (uint32_t c = 0; c < workload->count; c++) {
        const uint64_t stride = rt_workload_setup(workload, c)->ray_stride;
        if (workload->accels[c] && stride > 1) all += thinned_count(set, stride);
    }
    RT_TRY(rt_reserve(&set->rays, &capacity, all, sizeof(RtRay), error));
    workload->answers = rt_alloc(all, sizeof(RtHit));
    if (!workload->answers) return rt_fail_memory(error, "answers", all * sizeof(RtHit));
    RT_TRY(
        rt_measure_answers(workload->reference, set, workload->options->threads, workload->answers, error));
    for (uint32_t c = 0; c < workload->count; c++) {
        uint64_t stride = rt_workload_setup(workload, c)->ray_stride;
        if (!workload->accels[c]) continue;
        workload->shares[c] = (RtWorkloadShare){.set = *set, .expected = workload->answers};
        if (stride == 1) continue;
        thin_share(workload, set, stride, used, &workload->shares[c]);
        used += workload->shares[c].set.count;
    }
    if (workload->experiment->limit_seconds > 0) {
        RT_TRY(draw_probe(workload, set, used, error));
        used += workload->probe.set.count;
    }
    workload->answer_count = used;
    for (uint32_t c = 0; c < workload->count; c++) {
        if (workload->accels[c]) RT_TRY(rt_workload_teach(workload, kind, workload->accels[c], error));
    }
    return RT_OK;
}

/* ---- limits ---- */

/* Predicts how long counting and timing a cell takes, from a part of its rays, and excludes it if that is too
 * long. */
static RtStatus check_seconds(RtWorkloadState *workload, uint32_t c, RtRayKind kind, RtCell *cell,
                              RtError *error) {
    const RtExperiment *experiment = workload->experiment;
    const RtRaySet *part = &workload->probe.set;
    RtCount count;
    double all = (double)workload->shares[c].set.count;
    double passes = workload->count_only ? 1 : 2 + experiment->rounds;
    if (cell->counted) return RT_OK;
    RT_TRY(rt_measure_count(workload->accels[c], part, workload->probe.expected, 1, &count, error));
    double seconds = count.seconds / (double)part->count * all * passes;
    if (seconds <= experiment->limit_seconds) return RT_OK;
    workload->accels[c] = NULL;
    return rt_workload_leave_out(workload, c, RT_EVENT_NO_CELL, kind, RT_CAUSE_TIME, error,
                                 "it would take about %.2g s, more than %g s", seconds,
                                 experiment->limit_seconds);
}

/* ---- answers ---- */

/* The invariants of Havran & Sixta 1999: every correct accelerator has the same number of rays and of hits,
 * and, stronger, the same answers. */
static RtStatus check_answers(const RtWorkloadState *workload, uint32_t candidate, RtRayKind kind,
                              const RtCount *count, RtError *error) {
    const RtWorkloadShare *share = &workload->shares[candidate];
    const char *scene = workload->experiment->workloads[workload->index].label;
    const char *accel = rt_candidate_label(workload->experiment, candidate);
    const char *kind_name = rt_experiment_kind_name(workload->experiment, kind);
    const uint64_t rays = share->set.count;
    uint64_t hits = 0;
    if (count->differ > 0)
        return rt_fail(error, RT_MISMATCH,
                       "%s on %s: the answers to %" PRIu64 " of %" PRIu64 " %s rays differ from those of "
                       "%s%s, the first for ray %" PRIu64 "; `raytally verify` shows what is wrong",
                       accel, scene, count->differ, rays, kind_name, rt_accel_default(),
                       count->timed_kernel ? " in the timed kernel" : "", count->first);
    for (uint64_t i = 0; i < rays; i++) hits += share->expected[i].object != RT_NO_OBJECT;
    if (count->tally.rays == rays && count->tally.hits == hits) return RT_OK;
    return rt_fail(error, RT_MISMATCH,
                   "%s on %s counts %" PRIu64 " %s rays with %" PRIu64 " hits, but there are %" PRIu64
                   " with %" PRIu64,
                   accel, scene, count->tally.rays, kind_name, count->tally.hits, rays, hits);
}

static RtStatus count_cell(RtWorkloadState *workload, uint32_t c, RtRayKind kind, RtCell *cell,
                           RtError *error) {
    const RtWorkloadShare *share = &workload->shares[c];
    const RtAccel *accel = workload->accels[c];
    RtCount count;
    if (cell->counted) return RT_OK;
    RT_TRY(rt_measure_count(accel, &share->set, share->expected, workload->options->threads, &count, error));
    if (accel->exact) RT_TRY(check_answers(workload, c, kind, &count, error));
    cell->counted = true;
    cell->tally = count.tally;
    cell->differ = count.differ;
    return rt_workload_tell(workload, RT_EVENT_COUNT, c, kind, error);
}

/* ---- distributions over rays, each traced by itself ---- */

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

static RtStatus distribute_cell(RtWorkloadState *workload, uint32_t c, RtRayKind kind, RtCell *cell,
                                RtError *error) {
    RT_OWNED(RtRows, rows, rt_rows_clear);
    RtDistribution made[RT_RAY_QUANTITY_COUNT];
    if (cell->distributions) return RT_OK;
    RT_TRY(rt_measure_rows(workload->accels[c], &workload->shares[c].set, workload->options->threads, &rows,
                           error));
    for (int q = 0; q < RT_RAY_QUANTITY_COUNT; q++) {
        RT_OWNED(RtOccurrences, values, rt_occurrences_clear);
        for (uint64_t i = 0; i < rows.count; i++)
            RT_TRY(rt_occurrences_add(&values, value_of(&rows.tallies[i], (RtRayQuantity)q), error));
        made[q] = rt_distribution_of(&values);
    }
    cell->distributions = rt_alloc(RT_RAY_QUANTITY_COUNT, sizeof(RtDistribution));
    if (!cell->distributions) return rt_fail_memory(error, "distributions", sizeof made);
    memcpy(cell->distributions, made, sizeof made);
    return rt_workload_tell(workload, RT_EVENT_DISTRIBUTION, c, kind, error);
}

/* ---- the hit of each ray ---- */

static RtStatus save_hits(RtWorkloadState *workload, uint32_t c, RtRayKind kind, RtCell *cell,
                          RtError *error) {
    (void)kind, (void)cell;
    const RtWorkloadOptions *options = workload->options;
    RT_OWNED(RtRows, rows, rt_rows_clear);
    RtOutput output;
    RT_TRY(rt_measure_rows(workload->accels[c], &workload->shares[c].set, options->threads, &rows, error));
    RT_TRY(rt_output_open(&output, options->hits, error));
    rt_hits_put(&rows, options->hits, output.file);
    return rt_output_commit(&output, error);
}

/* ---- all steps ---- */

typedef RtStatus Step(RtWorkloadState *workload, uint32_t c, RtRayKind kind, RtCell *cell, RtError *error);

/* A plugin that is broken, or gives wrong answers, is excluded; other candidates are unaffected. */
static RtStatus each_cell(RtWorkloadState *workload, RtRayKind kind, Step *step, RtError *error) {
    for (uint32_t c = 0; c < workload->experiment->candidate_count; c++) {
        const RtAccel *accel = workload->accels[c];
        if (!accel) continue;
        RtCell *cell = rt_cell_at(workload->results, workload->index, c, kind);
        RtStatus status = step(workload, c, kind, cell, error);
        const bool wrong = status == RT_MISMATCH && rt_accel_is_remote(accel);
        if (status == RT_BROKEN || wrong) status = rt_workload_break(workload, c, kind, error);
        RT_TRY(status);
    }
    return RT_OK;
}

RtStatus rt_workload_count(RtWorkloadState *workload, RtRayKind kind, RtError *error) {
    RT_TRY(deal_shares(workload, kind, error));
    if (workload->experiment->limit_seconds > 0) RT_TRY(each_cell(workload, kind, check_seconds, error));
    RT_TRY(each_cell(workload, kind, count_cell, error));
    if (workload->options->hits) RT_TRY(each_cell(workload, kind, save_hits, error));
    return workload->distributions ? each_cell(workload, kind, distribute_cell, error) : RT_OK;
}
