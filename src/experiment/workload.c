/* SPDX-License-Identifier: Apache-2.0 */
/* A workload in order: the rays of its scene are recorded by the default accelerator, which also gives
 * the answers that all others are held against; every candidate is built; then, ray kind by ray kind, each is
 * counted, and all are timed against each other. */
#include "experiment/workload_state.h"

#include "accel/away.h"
#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "measure/ray_file.h"
#include "scenes/open.h"

#include <string.h>

/* Builds are repeated while that is cheap. */
enum { MOST_BUILDS = 3 };
static const double CHEAP_BUILD = 0.25; /* seconds */

/* ---- what is left to do ---- */

static bool runs(const RtWorkloadState *workload, uint32_t candidate) {
    return rt_candidate_runs(workload->experiment, candidate, workload->index) &&
           rt_only_accel(&workload->options->only, workload->experiment, candidate) &&
           !*rt_build_at(workload->results, workload->index, candidate)->limit;
}

static bool kind_is_done(const RtWorkloadState *workload, RtRayKind kind) {
    for (uint32_t c = 0; c < workload->count; c++) {
        const RtCell *cell = rt_cell_at(workload->results, workload->index, c, kind);
        bool null = c == workload->experiment->candidate_count;
        if (!runs(workload, c) || *cell->limit) continue;
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
        if (runs(workload, c) && !rt_build_at(workload->results, workload->index, c)->known) return false;
    }
    for (uint32_t k = 0; k < workload->experiment->kind_count; k++) {
        RtRayKind kind = workload->experiment->kinds[k];
        if (!rt_only_kind(&workload->options->only, kind)) continue;
        if (result->rays[kind] && !kind_is_done(workload, kind)) return false;
    }
    return true;
}

/* ---- scene, rays, structures ---- */

/* Fills the workload's part of the results, or holds it against what an earlier run found. */
static RtStatus describe_workload(RtWorkloadState *workload, RtError *error) {
    RtWorkloadResult *result = &workload->results->workloads[workload->index];
    RtWorkloadResult now = {.known = true,
                            .objects = workload->scene->geometry.object_count,
                            .width = workload->scene->sampling.width,
                            .height = workload->scene->sampling.height,
                            .scene = rt_scene_fingerprint(workload->scene)};
    bool same = now.scene == result->scene;
    for (int k = 0; k < RT_RAY_KIND_COUNT; k++) {
        now.rays[k] = workload->sets[k].count;
        now.ray_fingerprints[k] = workload->sets[k].fingerprint;
        same &= now.ray_fingerprints[k] == result->ray_fingerprints[k];
    }
    if (result->known && !same) {
        return rt_fail(error, RT_BAD_INPUT,
                       "'%s' has changed since this run was interrupted: start over with --force",
                       workload->experiment->workloads[workload->index].label);
    }
    if (result->known) return RT_OK;
    *result = now;
    return rt_workload_tell(workload, RT_EVENT_WORKLOAD, 0, RT_RAY_PRIMARY, error);
}

static RtStatus prepare(RtWorkloadState *workload, RtError *error) {
    RT_TRY(rt_workload_record(workload->experiment, workload->index, workload->options->threads,
                              workload->scene, &workload->reference, workload->sets, error));
    return describe_workload(workload, error);
}

/* Builds one candidate up to MOST_BUILDS times, keeps the last, and gives the median of the seconds. */
static RtStatus build_one(RtWorkloadState *workload, const RtSpec *spec, RtAccel **out, double *median,
                          RtError *error) {
    double seconds[MOST_BUILDS], sum = 0;
    uint32_t builds = 0;
    *out = NULL;
    do {
        rt_accel_destroy(*out);
        *out = NULL;
        RT_TRY(rt_accel_build(spec, workload->scene, workload->options->threads, out, error));
        seconds[builds] = (*out)->build_seconds;
        sum += seconds[builds++];
    } while (builds < MOST_BUILDS && sum < CHEAP_BUILD);
    *median = rt_median(seconds, builds);
    return RT_OK;
}

/* Builds a candidate within the limits; says in result->limit, without keeping it, which it went beyond. */
static RtStatus build_within(RtWorkloadState *workload, uint32_t c, const RtSpec *spec, double *seconds,
                             RtError *error) {
    const RtExperiment *experiment = workload->experiment;
    RtBuildResult *result = rt_build_at(workload->results, workload->index, c);
    rt_memory_limit(1000000 * experiment->limit_megabytes);
    RtStatus status = build_one(workload, spec, &workload->built[c], seconds, error);
    rt_memory_limit(0);
    bool too_large = status == RT_NO_MEMORY && experiment->limit_megabytes;
    /* A plugin that refuses the scene, or takes all memory for it, does so for itself alone. */
    bool broken = status == RT_BROKEN || (status != RT_OK && !too_large && rt_spec_is_away(spec));
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

static RtStatus build_all(RtWorkloadState *workload, RtError *error) {
    for (uint32_t c = 0; c < workload->count; c++) {
        RtSpec spec;
        double seconds = 0;
        RtBuildResult *result = rt_build_at(workload->results, workload->index, c);
        if (!runs(workload, c)) continue;
        RT_TRY(rt_spec_parse(workload->experiment->candidates[rt_workload_origin(workload, c)].spec, &spec,
                             error));
        RT_TRY(build_within(workload, c, &spec, &seconds, error));
        if (!workload->built[c]) continue;
        if (result->known) continue;
        const RtAccel *accel = workload->built[c];
        *result = (RtBuildResult){.known = true, .exact = accel->exact, .counts = accel->counts};
        result->seconds = seconds;
        rt_spec_format(&spec, result->spec);
        rt_accel_describe(accel, &result->shape);
        if (workload->distributions) RT_TRY(rt_workload_distribute_leaves(accel, result, error));
        RT_TRY(rt_workload_tell(workload, RT_EVENT_BUILD, c, RT_RAY_PRIMARY, error));
    }
    return RT_OK;
}

/* ---- the rays of one kind ---- */

/* Rays in a set that is of which every `stride`th is kept. */
static uint64_t thinned_count(const RtRaySet *set, uint64_t stride) {
    return (set->count + stride - 1) / stride;
}

/* Rays of the set, of all shares that are thinned, and of the probe. */
static uint64_t count_with_shares(const RtWorkloadState *workload, const RtRaySet *set) {
    uint64_t count = set->count + RT_PROBE_RAYS;
    for (uint32_t c = 0; c < workload->count; c++) {
        if (workload->accels[c] && rt_workload_ray_stride(workload, c) > 1)
            count += thinned_count(set, rt_workload_ray_stride(workload, c));
    }
    return count;
}

/* Picks the rays and answers of a share, to lie from `first` on. */
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

/* Gives every candidate its share of the set, and the answers to those that learn. Thinned shares and the
 * probe are copies behind the set, in the same array: the baseline, which may be one that learns and knows
 * rays by their places, is timed on all of them. */
static RtStatus deal_shares(RtWorkloadState *workload, RtRaySet *set, RtError *error) {
    uint64_t all = count_with_shares(workload, set), used = set->count;
    uint32_t capacity = (uint32_t)set->count;
    RT_TRY(rt_reserve(&set->rays, &capacity, all, sizeof(RtRay), error));
    workload->answers = rt_alloc(all, sizeof(RtHit));
    if (!workload->answers) return rt_fail_memory(error, "answers", all * sizeof(RtHit));
    RT_TRY(
        rt_measure_answers(workload->reference, set, workload->options->threads, workload->answers, error));
    for (uint32_t c = 0; c < workload->count; c++) {
        uint64_t stride = rt_workload_ray_stride(workload, c);
        if (!workload->accels[c]) continue;
        workload->shares[c] = (RtWorkloadShare){.set = *set, .expected = workload->answers};
        if (stride == 1) continue;
        thin_share(workload, set, stride, used, &workload->shares[c]);
        used += workload->shares[c].set.count;
    }
    if (workload->experiment->limit_seconds > 0) {
        RT_TRY(rt_workload_draw_probe(workload, set, used, error));
        used += workload->probe.set.count;
    }
    for (uint32_t c = 0; c < workload->count; c++) {
        if (workload->accels[c])
            RT_TRY(rt_accel_learn(workload->accels[c], set->rays, workload->answers, used, error));
    }
    return RT_OK;
}

/* The invariants of Havran & Sixta 1999: equal for every correct accelerator are the rays, the rays that hit,
 * and, stronger, each answer. */
static RtStatus check_differ(const RtWorkloadState *workload, uint32_t candidate, RtRayKind kind,
                             const char *where, const RtCount *count, RtError *error) {
    const RtWorkloadShare *share = &workload->shares[candidate];
    if (count->differ == 0) return RT_OK;
    return rt_fail(error, RT_MISMATCH,
                   "%s on %s answers %llu of %llu %s rays unlike %s%s, the first of them ray %llu; "
                   "`raytally verify` shows what is wrong",
                   rt_candidate_label(workload->experiment, candidate),
                   workload->experiment->workloads[workload->index].label, (unsigned long long)count->differ,
                   (unsigned long long)share->set.count, rt_experiment_kind_name(workload->experiment, kind),
                   rt_accel_default(), where, (unsigned long long)count->first);
}

static RtStatus check_answers(const RtWorkloadState *workload, uint32_t candidate, RtRayKind kind,
                              const RtCount *count, RtError *error) {
    const RtWorkloadShare *share = &workload->shares[candidate];
    const char *scene = workload->experiment->workloads[workload->index].label;
    const char *accel = rt_candidate_label(workload->experiment, candidate);
    uint64_t hits = 0;
    for (uint64_t i = 0; i < share->set.count; i++) hits += share->expected[i].object != RT_NO_OBJECT;
    RT_TRY(check_differ(workload, candidate, kind, "", count, error));
    if (count->tally.rays == share->set.count && count->tally.hits == hits) return RT_OK;
    return rt_fail(error, RT_MISMATCH,
                   "%s on %s counts %llu %s rays with %llu hits, where there are %llu with %llu", accel,
                   scene, (unsigned long long)count->tally.rays,
                   rt_experiment_kind_name(workload->experiment, kind), (unsigned long long)count->tally.hits,
                   (unsigned long long)share->set.count, (unsigned long long)hits);
}

/* What is timed gives the answers that were counted: of a plugin that is asked, too. */
static RtStatus answer_as_timed(const RtWorkloadState *workload, uint32_t c, RtRayKind kind, RtError *error) {
    const RtWorkloadShare *share = &workload->shares[c];
    RtCount timed;
    if (!workload->accels[c]->exact) return RT_OK;
    RT_TRY(rt_measure_differ(workload->accels[c], &share->set, share->expected, workload->options->threads,
                             &timed, error));
    return check_differ(workload, c, kind, " where nothing is counted", &timed, error);
}

/* Counts are promised to be the same every time. Of a plugin that is asked. */
static RtStatus count_again(const RtWorkloadState *workload, uint32_t c, const RtCount *first,
                            RtError *error) {
    const RtWorkloadShare *share = &workload->shares[c];
    RtCount again;
    RT_TRY(rt_measure_count(workload->accels[c], &share->set, share->expected, workload->options->threads,
                            &again, error));
    for (size_t i = 0; i < RT_TALLY_COUNTER_COUNT; i++) {
        uint64_t was = rt_tally_get(&first->tally, i), is = rt_tally_get(&again.tally, i);
        if (was == is) continue;
        return rt_fail(error, RT_BROKEN, "%s: it counts %llu %s on some rays, and %llu when asked again",
                       rt_candidate_label(workload->experiment, c), (unsigned long long)was, rt_tally_name(i),
                       (unsigned long long)is);
    }
    return RT_OK;
}

static RtStatus count_kind(RtWorkloadState *workload, RtRayKind kind, RtError *error) {
    for (uint32_t c = 0; c < workload->experiment->candidate_count; c++) {
        RtCell *cell = rt_cell_at(workload->results, workload->index, c, kind);
        const RtWorkloadShare *share = &workload->shares[c];
        RtCount count;
        if (!workload->accels[c] || cell->counted) continue;
        RtStatus status = rt_measure_count(workload->accels[c], &share->set, share->expected,
                                           workload->options->threads, &count, error);
        if (status == RT_OK && workload->accels[c]->exact)
            status = check_answers(workload, c, kind, &count, error);
        if (status == RT_OK && rt_accel_is_away(workload->accels[c]))
            status = count_again(workload, c, &count, error);
        if (status == RT_OK && rt_accel_is_away(workload->accels[c]))
            status = answer_as_timed(workload, c, kind, error);
        if (rt_workload_is_own_fault(workload, c, status)) {
            RT_TRY(rt_workload_break(workload, c, kind, error));
            continue;
        }
        RT_TRY(status);
        cell->counted = true;
        cell->tally = count.tally;
        cell->differ = count.differ;
        RT_TRY(rt_workload_tell(workload, RT_EVENT_COUNT, c, kind, error));
    }
    return RT_OK;
}

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

/* ---- all of it ---- */

/* One that broke on other rays is built anew for these. Whatever goes wrong then is its own fault, too. */
static RtStatus rebuild_broken(RtWorkloadState *workload, uint32_t c, RtError *error) {
    RtSpec spec;
    RtAccel *accel = workload->built[c];
    if (!accel || !rt_accel_is_away(accel) || rt_accel_check(accel, NULL) == RT_OK) return RT_OK;
    rt_accel_destroy(accel);
    workload->built[c] = NULL;
    RT_TRY(
        rt_spec_parse(workload->experiment->candidates[rt_workload_origin(workload, c)].spec, &spec, error));
    return rt_accel_build(&spec, workload->scene, workload->options->threads, &workload->built[c], error);
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
    RtStatus status = deal_shares(workload, &workload->sets[kind], error);
    if (status == RT_OK) status = rt_workload_check_limits(workload, kind, error);
    if (status == RT_OK) status = count_kind(workload, kind, error);
    if (status == RT_OK && workload->distributions) status = rt_workload_distribute(workload, kind, error);
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
    RT_TRY(prepare(workload, error));
    RT_TRY(build_all(workload, error));
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

RtStatus rt_workload_open_scene(const RtWorkload *workload, RtScene *scene, RtError *error) {
    *scene = (RtScene){0};
    if (!workload->file || rt_file_exists(workload->path)) return rt_scene_open(workload->path, scene, error);
    if (rt_file_is_dead_link(workload->path, error)) return RT_BAD_INPUT;
    return rt_fail(error, RT_BAD_INPUT,
                   "%s: there is no such file; `scenes/fetch.sh` fetches the public meshes", workload->path);
}

RtStatus rt_workload_open(RtResults *results, uint32_t index, const RtWorkloadOptions *options,
                          RtScene *scene, RtError *error) {
    const RtWorkload *setup = &results->experiment->workloads[index];
    const RtObserver *observer = &options->observer;
    char message[RT_MAX_PATH + 128];
    *scene = (RtScene){0};
    if (!setup->optional || !setup->file || rt_file_exists(setup->path))
        return rt_workload_open_scene(setup, scene, error);
    snprintf(message, sizeof message,
             "%s is missing, so '%s' is skipped; `scenes/fetch.sh` fetches the public meshes", setup->path,
             setup->label);
    if (observer->notice) observer->notice(observer->context, message);
    results->workloads[index].skipped = true;
    return RT_OK;
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
