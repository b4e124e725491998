/* SPDX-License-Identifier: Apache-2.0 */
/* Pairs of result directories: their cells, and verdicts of accelerators over scenes. */
#include "compare/compare.h"

#include <math.h>
#include <string.h>

/* ---- cells ---- */

/* A pair of runs whose counts differ is kept in preference to one whose counts do not. */
static void take_counts(RtComparedCell *cell, const RtTally *before, const RtTally *after) {
    if (rt_compared_counts_differ(cell)) return;
    cell->counted = true;
    cell->counts_before = *before;
    cell->counts = *after;
}

static RtStatus take_times(RtComparison *comparison, RtComparedCell *cell, uint32_t pair, const RtCell *one,
                           const RtCell *other, RtError *error) {
    if (!cell->runs) cell->runs = rt_arena_alloc(&comparison->memory, comparison->pairs, sizeof *cell->runs);
    RT_TRY(rt_arena_check(&comparison->memory, "times", error));
    cell->runs[pair][0] = one;
    cell->runs[pair][1] = other;
    cell->timed = true;
    cell->before = one->seconds.median;
    cell->after = other->seconds.median;
    return RT_OK;
}

/* Whether the run's rays and scene are those of the cell. */
static bool is_of(const RtComparedCell *cell, const RtResults *results, uint32_t t, RtRayKind kind,
                  const RtCell *run) {
    return cell->scene_hash == results->workloads[t].scene &&
           cell->ray_hash == results->workloads[t].ray_fingerprints[kind] && cell->rays == run->tally.rays;
}

static RtStatus exclude_cell(RtComparedCell *cell) {
    cell->timed = cell->counted = false;
    cell->change = RT_CHANGE_OTHER_RAYS;
    return RT_OK;
}

/* What a pair of runs is compared with. */
typedef struct Pair {
    const RtResults *before, *after;
    uint32_t number;
    bool swapped; /* looks only for cells that are missing before */
} Pair;

static RtStatus compare_cell(const Pair *pair, const RtCellCursor *at, RtComparison *comparison,
                             RtError *error) {
    const RtResults *before = pair->before, *after = pair->after;
    const uint32_t t = at->workload, c = at->candidate;
    const RtRayKind kind = at->kind;
    const char *scene = before->experiment->workloads[t].label;
    const char *accel = before->experiment->candidates[c].label;
    const RtCell *one = at->cell;
    if (!rt_candidate_runs(before->experiment, c, t) || (!one->counted && !one->timed)) return RT_OK;
    RtComparedCell *cell = rt_comparison_cell(comparison, scene, accel, rt_ray_kind_name(kind));
    if (!cell) return rt_fail_memory(error, "a comparison", 0);
    const RtExperiment *e = after->experiment;
    const uint32_t t2 = rt_workload_find(e, scene);
    const uint32_t c2 = t2 < e->workload_count ? rt_candidate_find(e, accel, t2) : e->candidate_count;
    const RtCell *other = c2 < e->candidate_count ? rt_cell_at(after, t2, c2, kind) : NULL;
    if (cell->change == RT_CHANGE_OTHER_RAYS) return RT_OK;
    if (cell->rays == 0) {
        cell->rays = one->tally.rays;
        cell->scene_hash = before->workloads[t].scene;
        cell->ray_hash = before->workloads[t].ray_fingerprints[kind];
    }
    if (!is_of(cell, before, t, kind, one)) return exclude_cell(cell);
    if (!other || (!other->counted && !other->timed)) {
        cell->change = pair->swapped ? RT_CHANGE_ONLY_AFTER : RT_CHANGE_ONLY_BEFORE;
        return RT_OK;
    }
    if (pair->swapped) return RT_OK;
    if (!is_of(cell, after, t2, kind, other)) return exclude_cell(cell);
    if (one->counted && other->counted && rt_build_at(before, t, c)->counts &&
        rt_build_at(after, t2, c2)->counts)
        take_counts(cell, &one->tally, &other->tally);
    if (!one->round_times || !other->round_times || one->threads != other->threads) return RT_OK;
    return take_times(comparison, cell, pair->number, one, other, error);
}

static RtStatus compare_all(const Pair *pair, RtComparison *comparison, RtError *error) {
    for (RtCellCursor at = {0}; rt_results_next(pair->before, &at);)
        RT_TRY(compare_cell(pair, &at, comparison, error));
    return RT_OK;
}

/* ---- intervals of cells, over the rounds of these processes ---- */

/* All times of a cell on one side. */
static double *gather(const RtComparedCell *cell, int side, uint32_t pairs, RtArena *arena, uint32_t *count) {
    uint32_t all = 0;
    for (uint32_t p = 0; p < pairs; p++) all += cell->runs[p][side] ? cell->runs[p][side]->rounds : 0;
    double *times = rt_arena_alloc(arena, all, sizeof(double));
    *count = 0;
    for (uint32_t p = 0; p < pairs && times; p++) {
        const RtCell *run = cell->runs[p][side];
        if (!run) continue;
        memcpy(times + *count, rt_cell_round_times(run, RT_ROUND_SECONDS), run->rounds * sizeof(double));
        *count += run->rounds;
    }
    return times;
}

static RtStatus estimate_cell(RtComparison *comparison, RtComparedCell *cell, RtError *error) {
    RT_ARENA(arena);
    const double each = rt_coverage_of_each(comparison->timed);
    uint32_t rounds[2];
    const double *before = gather(cell, 0, comparison->pairs, &arena, &rounds[0]),
                 *after = gather(cell, 1, comparison->pairs, &arena, &rounds[1]);
    RT_TRY(rt_arena_check(&arena, "times", error));
    RT_TRY(rt_estimate_unpaired(before, rounds[0], after, rounds[1], each, &cell->ratio, error));
    const double covered = fmin(each, rt_unpaired_coverage(rounds[0], rounds[1]));
    comparison->together -= 1 - covered;
    comparison->coverage = fmin(comparison->coverage, covered);
    return RT_OK;
}

/* ---- verdicts of accelerators ---- */

/* The median of the cells of one accelerator on a scene in a pair of runs; its kinds of rays are not
 * independent, because they share a structure. NAN: there is no such cell. */
static double ratio_on(const RtComparison *comparison, const char *scene, const char *accel, uint32_t pair) {
    double ratios[RT_RAY_KIND_COUNT];
    uint32_t count = 0;
    for (uint32_t i = 0; i < comparison->count; i++) {
        const RtComparedCell *cell = &comparison->cells[i];
        if (!cell->timed || !cell->runs[pair][0] || strcmp(cell->scene, scene) != 0 ||
            strcmp(cell->accel, accel) != 0)
            continue;
        ratios[count++] = cell->runs[pair][0]->seconds.median / cell->runs[pair][1]->seconds.median;
    }
    return count > 0 ? rt_median(ratios, count) : (double)NAN;
}

static void find_accels(RtComparison *comparison) {
    for (uint32_t i = 0; i < comparison->count; i++) {
        uint32_t found = 0;
        if (!comparison->cells[i].timed) continue;
        while (found < comparison->accel_count &&
               strcmp(comparison->accels[found].accel, comparison->cells[i].accel) != 0)
            found++;
        if (found == comparison->accel_count)
            strcpy(comparison->accels[comparison->accel_count++].accel, comparison->cells[i].accel);
    }
}

/* Ratios of all accelerators on one scene in a pair of runs, each relative to their median; only where three
 * or more have one, since otherwise the median does not show which of them changed. */
typedef struct Groups {
    double *ratios;   /* [accel][most] */
    double *together; /* [count] the medians */
    uint32_t count;
    size_t most;
} Groups;

static void add_group(RtComparison *comparison, const char *scene, uint32_t pair, Groups *groups) {
    double all[RT_MAX_CANDIDATES];
    uint32_t count = 0;
    for (uint32_t a = 0; a < comparison->accel_count; a++) {
        double ratio = ratio_on(comparison, scene, comparison->accels[a].accel, pair);
        if (!isnan(ratio)) all[count++] = ratio;
    }
    if (count < RT_LEAST_ACCELS) return;
    const double median = groups->together[groups->count++] = rt_median(all, count);
    for (uint32_t a = 0; a < comparison->accel_count; a++) {
        RtComparedAccel *accel = &comparison->accels[a];
        double ratio = ratio_on(comparison, scene, accel->accel, pair);
        if (!isnan(ratio)) groups->ratios[a * groups->most + accel->groups++] = ratio / median;
    }
}

static void judge(RtComparison *comparison, const Groups *groups) {
    uint32_t judged = 0;
    for (uint32_t a = 0; a < comparison->accel_count; a++) judged += comparison->accels[a].groups >= 2;
    comparison->judged = judged;
    for (uint32_t a = 0; a < comparison->accel_count; a++) {
        RtComparedAccel *accel = &comparison->accels[a];
        accel->change = RT_CHANGE_NOT_JUDGED;
        if (accel->groups < 2) continue;
        accel->ratio = rt_estimate_student(&groups->ratios[a * groups->most], accel->groups,
                                           rt_coverage_of_each(judged));
        accel->change = rt_comparison_verdict(comparison, &accel->ratio);
    }
    comparison->all_accels = groups->count > 0 ? rt_median(groups->together, groups->count) : (double)NAN;
}

/* Scenes are those of the cells, each at its first one. */
static bool is_first_of_scene(const RtComparison *comparison, uint32_t cell) {
    for (uint32_t i = 0; i < cell; i++) {
        if (strcmp(comparison->cells[i].scene, comparison->cells[cell].scene) == 0) return false;
    }
    return true;
}

static RtStatus judge_accels(RtComparison *comparison, RtError *error) {
    RtArena *memory = &comparison->memory;
    const size_t most = (size_t)RT_MAX_WORKLOADS * comparison->pairs;
    comparison->accels = rt_arena_alloc(memory, comparison->count, sizeof(RtComparedAccel));
    Groups groups = {.ratios = rt_arena_alloc(memory, comparison->count * most, sizeof(double)),
                     .together = rt_arena_alloc(memory, most, sizeof(double)),
                     .most = most};
    RT_TRY(rt_arena_check(memory, "the comparison of accelerators", error));
    find_accels(comparison);
    for (uint32_t i = 0; i < comparison->count; i++) {
        if (!is_first_of_scene(comparison, i)) continue;
        for (uint32_t p = 0; p < comparison->pairs; p++)
            add_group(comparison, comparison->cells[i].scene, p, &groups);
    }
    judge(comparison, &groups);
    return RT_OK;
}

RtStatus rt_compare_results(const RtResults *results, uint32_t pairs, RtComparison *comparison,
                            RtError *error) {
    comparison->pairs = pairs;
    for (uint32_t p = 0; p < pairs; p++) {
        const RtResults *before = &results[(size_t)2 * p], *after = before + 1;
        const Pair straight = {before, after, p, false}, swapped = {after, before, p, true};
        RT_TRY(compare_all(&straight, comparison, error));
        RT_TRY(compare_all(&swapped, comparison, error));
    }
    uint32_t shared = 0;
    for (uint32_t i = 0; i < comparison->count; i++) {
        const RtComparedCell *cell = &comparison->cells[i];
        comparison->timed += cell->timed;
        shared += cell->change != RT_CHANGE_ONLY_BEFORE && cell->change != RT_CHANGE_ONLY_AFTER;
    }
    if (shared == 0 && comparison->count > 0)
        return rt_fail(error, RT_BAD_INPUT,
                       "there is nothing to compare: no scene, accelerator and kind of rays is in both");
    comparison->together = comparison->coverage = 1;
    for (uint32_t i = 0; i < comparison->count; i++) {
        RtComparedCell *cell = &comparison->cells[i];
        if (!cell->timed) continue;
        RT_TRY(estimate_cell(comparison, cell, error));
        cell->change = RT_CHANGE_BY_ACCEL;
    }
    comparison->together = fmax(0, comparison->together);
    return judge_accels(comparison, error);
}
