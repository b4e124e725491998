/* SPDX-License-Identifier: Apache-2.0 */
/* Which candidates take part in a workload, and how they leave it; and their structures.
 *
 * To time builds, each structure is built several times, in interleaved rounds like those of rays, in place
 * of the one before, so that no more of them exist at once. The first build of each is a warm-up, which finds
 * the memory that later ones use again. It counts only if it spends the whole budget.
 *
 * Equal structures are not equally fast: where their data lies decides what shares a cache set or a page. So
 * timing builds them anew for its rounds, each behind a block of random size. */
#include "run/workload_state.h"

#include "core/base/parallel.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

bool rt_workload_runs(const RtWorkloadState *workload, uint32_t c) {
    return rt_workload_setup(workload, c)->member_count == 0 &&
           rt_candidate_runs(workload->experiment, c, workload->index) &&
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
    if (!null && refused && rt_results_refused(workload->results, workload->index, experiment->baseline) &&
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
    if (status == RT_OK) result->leaves = rt_alloc(RT_LEAF_QUANTITY_COUNT, sizeof(RtDistribution));
    if (status == RT_OK && !result->leaves)
        status = rt_fail_memory(error, "distributions", RT_LEAF_QUANTITY_COUNT * sizeof(RtDistribution));
    for (int q = 0; q < RT_LEAF_QUANTITY_COUNT; q++) {
        if (status == RT_OK) result->leaves[q] = rt_distribution_of(&leaves.values[q]);
        rt_occurrences_clear(&leaves.values[q]);
    }
    return status;
}

/* ---- builds ---- */

typedef struct Builds {
    RtWorkloadState *workload;
    uint32_t candidate;
    uint32_t done, left;           /* the warm-up included */
    double budget;                 /* seconds that are left */
    double seconds[RT_MAX_ROUNDS]; /* the first measured build takes the place of the warm-up */
} Builds;

static RtEstimate estimate_of(const Builds *builds, uint32_t *count) {
    *count = builds->done > 1 ? builds->done - 1 : 1;
    return rt_estimate(builds->seconds, *count);
}

static int build_threads(const RtWorkloadState *workload) {
    return rt_workload_is_timed(workload) ? workload->options->timing : workload->options->threads;
}

/* Builds a structure in place of the one before. */
static RtStatus build_limited(RtWorkloadState *workload, uint32_t c, RtError *error) {
    rt_accel_destroy(workload->built[c]);
    workload->built[c] = NULL;
    rt_memory_limit(workload->experiment->limit_bytes);
    return rt_memory_unlimit(rt_accel_build(&rt_workload_setup(workload, c)->parsed, workload->scene,
                                            build_threads(workload), &workload->built[c], error),
                             error);
}

RtStatus rt_workload_rebuild(RtWorkloadState *workload, uint32_t c, RtError *error) {
    if (!rt_workload_runs(workload, c)) return RT_OK;
    if (workload->built[c] && rt_accel_check(workload->built[c], NULL) == RT_OK) return RT_OK;
    return build_limited(workload, c, error);
}

void rt_workload_destroy(RtWorkloadState *workload, uint32_t c) {
    rt_accel_destroy(workload->built[c]);
    rt_free(workload->displacements[c]);
    workload->built[c] = NULL;
    workload->displacements[c] = NULL;
}

RtStatus rt_workload_teach(const RtWorkloadState *workload, RtRayKind kind, RtAccel *accel, RtError *error) {
    return rt_accel_learn(accel, workload->sets[kind].rays, workload->answers, workload->answer_count, error);
}

RtStatus rt_workload_build_elsewhere(RtWorkloadState *workload, uint32_t c, RtRayKind kind, RtRandom *random,
                                     RtError *error) {
    enum { MOST_LINES = 4096 }; /* 256 KiB: pages and the sets of caches */
    const size_t lines = rt_random_below(random, MOST_LINES);
    rt_workload_destroy(workload, c);
    workload->displacements[c] = rt_alloc_unset(1 + lines, RT_CACHE_LINE);
    if (!workload->displacements[c]) return rt_fail_memory(error, "a block", lines * RT_CACHE_LINE);
    RT_TRY(build_limited(workload, c, error));
    return rt_workload_teach(workload, kind, workload->built[c], error);
}

/* Leaves out a candidate that refuses the scene, or whose plugin breaks: only its own results are lost. */
static RtStatus exclude(RtWorkloadState *workload, uint32_t c, RtStatus status, RtError *error) {
    const bool refused = rt_accel_refuses(status);
    const bool broken = !refused && rt_spec_is_remote(&rt_workload_setup(workload, c)->parsed);
    if (!broken && !refused) return status;
    return rt_workload_leave_out(workload, c, RT_EVENT_NO_BUILD, RT_RAY_PRIMARY,
                                 refused ? RT_CAUSE_REFUSED : RT_CAUSE_BROKEN, error, "%s", error->message);
}

/* Destroys a structure that took longer than the limit; not in a resumed run that kept it before. */
static RtStatus check_seconds(const Builds *builds, RtError *error) {
    RtWorkloadState *workload = builds->workload;
    const double limit = workload->experiment->limit_seconds;
    const bool known = rt_build_at(workload->results, workload->index, builds->candidate)->known;
    uint32_t count;
    const double seconds = estimate_of(builds, &count).median;
    if (limit <= 0 || seconds <= limit || known) return RT_OK;
    rt_accel_destroy(workload->built[builds->candidate]);
    workload->built[builds->candidate] = NULL;
    return rt_workload_leave_out(workload, builds->candidate, RT_EVENT_NO_BUILD, RT_RAY_PRIMARY,
                                 RT_CAUSE_TIME, error, "building takes %.3g s, more than %g s", seconds,
                                 limit);
}

static RtStatus build_once_more(Builds *builds, RtError *error) {
    const RtStatus status = build_limited(builds->workload, builds->candidate, error);
    builds->left--;
    if (status != RT_OK) {
        builds->left = 0;
        return exclude(builds->workload, builds->candidate, status, error);
    }
    const double seconds = builds->workload->built[builds->candidate]->build_seconds;
    builds->seconds[builds->done > 0 ? builds->done - 1 : 0] = seconds;
    builds->done++;
    builds->budget -= seconds;
    if (builds->budget <= 0) builds->left = 0;
    return builds->left > 0 ? RT_OK : check_seconds(builds, error);
}

/* The warm-up in order, then each round in a new random one. */
static RtStatus build_rounds(Builds *all, size_t count, uint64_t seed, RtError *error) {
    RtRandom random = rt_random(seed, 0);
    size_t order[RT_MAX_MEASURED];
    for (size_t i = 0; i < count; i++) order[i] = i;
    for (bool any = count > 0; any; rt_random_shuffle(&random, order, count)) {
        any = false;
        for (size_t i = 0; i < count; i++) {
            Builds *builds = &all[order[i]];
            if (builds->left > 0) RT_TRY(build_once_more(builds, error));
            any |= builds->left > 0;
        }
    }
    return RT_OK;
}

/* ---- all structures ---- */

static RtStatus keep_result(const Builds *builds, RtError *error) {
    const RtWorkloadState *workload = builds->workload;
    const RtAccel *accel = workload->built[builds->candidate];
    RtBuildResult *result = rt_build_at(workload->results, workload->index, builds->candidate);
    if (!accel || result->known) return RT_OK;
    *result = (RtBuildResult){.known = true, .exact = accel->exact, .counts = accel->counts};
    result->seconds = estimate_of(builds, &result->builds);
    result->threads = (uint32_t)rt_thread_count(build_threads(workload));
    rt_spec_format(&rt_workload_setup(workload, builds->candidate)->parsed, result->spec);
    for (const RtAccel *layer = accel; layer; layer = layer->below) {
        if (layer->idle)
            rt_notify(&workload->options->observer, "%s on %s: %s passes on every ray: %s",
                      rt_candidate_label(workload->experiment, builds->candidate),
                      workload->experiment->workloads[workload->index].label, layer->ops->name, layer->idle);
    }
    rt_accel_describe(accel, &result->structure);
    if (workload->distributions) RT_TRY(distribute_leaves(accel, result, error));
    return rt_workload_tell(workload, RT_EVENT_BUILD, builds->candidate, RT_RAY_PRIMARY, error);
}

RtStatus rt_workload_build(RtWorkloadState *workload, RtError *error) {
    RT_ARENA(arena);
    const RtExperiment *experiment = workload->experiment;
    const bool timed = rt_workload_is_timed(workload);
    Builds *all = rt_arena_alloc(&arena, workload->count, sizeof(Builds));
    RT_TRY(rt_arena_check(&arena, "build times", error));
    size_t count = 0;
    for (uint32_t c = 0; c < workload->count; c++) {
        if (!rt_workload_runs(workload, c)) continue;
        const bool known = rt_build_at(workload->results, workload->index, c)->known;
        all[count++] = (Builds){.workload = workload,
                                .candidate = c,
                                .left = timed && !known ? 1 + experiment->builds : 1,
                                .budget = RT_BUILD_BUDGET * experiment->builds};
    }
    RT_TRY(build_rounds(all, count, experiment->seed, error));
    for (size_t i = 0; i < count; i++) RT_TRY(keep_result(&all[i], error));
    return RT_OK;
}
