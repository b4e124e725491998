/* A trial in order: the rays of its scene are recorded by the default accelerator, which also gives
 * the answers that all others are held against; every contender is built; then, ray kind by ray kind, each is
 * counted, and all are timed against each other. */
#include "bench/trial_state.h"

#include "base/clock.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "scenes/open.h"

#include <string.h>

/* Builds are repeated while that is cheap. */
enum { MOST_BUILDS = 3 };
static const double CHEAP_BUILD = 0.25; /* seconds */

/* ---- what is left to do ---- */

static bool runs(const RtTrialState *trial, uint32_t contender) {
    return rt_contender_runs(trial->experiment, contender, trial->index);
}

static bool kind_is_done(const RtTrialState *trial, RtRayKind kind) {
    for (uint32_t c = 0; c < trial->count; c++) {
        const RtCell *cell = rt_cell_at(trial->results, trial->index, c, kind);
        bool null = c == trial->experiment->contender_count;
        if (!runs(trial, c)) continue;
        if ((!cell->counted && !null) || (!cell->timed && !trial->count_only)) return false;
    }
    return true;
}

static bool trial_is_done(const RtTrialState *trial) {
    const RtTrialResult *result = &trial->results->trials[trial->index];
    if (!result->known) return result->skipped;
    for (uint32_t c = 0; c < trial->count; c++) {
        if (runs(trial, c) && !rt_build_at(trial->results, trial->index, c)->known) return false;
    }
    for (uint32_t k = 0; k < trial->experiment->kind_count; k++) {
        RtRayKind kind = trial->experiment->kinds[k];
        if (result->rays[kind] && !kind_is_done(trial, kind)) return false;
    }
    return true;
}

/* ---- scene, rays, structures ---- */

/* Keeps of the recorded sets what the experiment asks for, at most `limit` of each kind. */
static RtStatus keep_sets(RtTrialState *trial, const RtRaySet *recorded, RtError *error) {
    for (uint32_t k = 0; k < trial->experiment->kind_count; k++) {
        RtRayKind kind = trial->experiment->kinds[k];
        RT_TRY(rt_rayset_limit(&recorded[kind], trial->experiment->limit, trial->experiment->together,
                               &trial->sets[kind], error));
    }
    return RT_OK;
}

static RtStatus record_rays(RtTrialState *trial, RtError *error) {
    const RtTrial *setup = &trial->experiment->trials[trial->index];
    RtRecording recording = {.depth = setup->depth,
                             .seed = trial->experiment->seed,
                             .random = trial->experiment->limit,
                             .threads = trial->options->threads,
                             .light_from_outside = setup->light_from_outside};
    RtRaySet recorded[RT_RAY_KIND_COUNT] = {0};
    RtSpec spec;
    RT_TRY(rt_spec_parse(rt_accel_default(), &spec, error));
    RT_TRY(rt_accel_build(&spec, trial->scene, recording.threads, &trial->reference, error));
    RtStatus status = rt_rayset_record(recorded, trial->reference, &recording, error);
    if (status == RT_OK) status = keep_sets(trial, recorded, error);
    for (int k = 0; k < RT_RAY_KIND_COUNT; k++) rt_rayset_clear(&recorded[k]);
    return status;
}

/* Fills the trial's part of the results, or holds it against what an earlier run found. */
static RtStatus describe_trial(RtTrialState *trial, RtError *error) {
    RtTrialResult *result = &trial->results->trials[trial->index];
    RtTrialResult now = {.known = true,
                         .objects = trial->scene->geometry.object_count,
                         .width = trial->scene->sampling.width,
                         .height = trial->scene->sampling.height,
                         .scene = rt_scene_fingerprint(trial->scene)};
    bool same = now.scene == result->scene;
    for (int k = 0; k < RT_RAY_KIND_COUNT; k++) {
        now.rays[k] = trial->sets[k].count;
        now.ray_fingerprints[k] = trial->sets[k].fingerprint;
        same &= now.ray_fingerprints[k] == result->ray_fingerprints[k];
    }
    if (result->known && !same) {
        return rt_fail(error, RT_BAD_INPUT,
                       "'%s' has changed since this run was interrupted: begin anew, with --force",
                       trial->experiment->trials[trial->index].label);
    }
    if (result->known) return RT_OK;
    *result = now;
    return rt_trial_tell(trial, RT_EVENT_TRIAL, 0, RT_RAY_PRIMARY, error);
}

static RtStatus prepare(RtTrialState *trial, RtError *error) {
    const RtTrial *setup = &trial->experiment->trials[trial->index];
    RT_TRY(rt_scene_sample(trial->scene, setup->width, setup->height, 1, setup->corners, error));
    RT_TRY(record_rays(trial, error));
    return describe_trial(trial, error);
}

/* Builds one contender up to MOST_BUILDS times, keeps the last, and gives the median of the seconds. */
static RtStatus build_one(RtTrialState *trial, const RtSpec *spec, RtAccel **out, double *median,
                          RtError *error) {
    double seconds[MOST_BUILDS], sum = 0;
    uint32_t builds = 0;
    *out = NULL;
    do {
        rt_accel_destroy(*out);
        *out = NULL;
        double start = rt_wall_seconds();
        RT_TRY(rt_accel_build(spec, trial->scene, trial->options->threads, out, error));
        seconds[builds] = rt_wall_seconds() - start;
        sum += seconds[builds++];
    } while (builds < MOST_BUILDS && sum < CHEAP_BUILD);
    *median = rt_median(seconds, builds);
    return RT_OK;
}

static RtStatus build_all(RtTrialState *trial, RtError *error) {
    for (uint32_t c = 0; c < trial->count; c++) {
        RtSpec spec;
        double seconds;
        RtBuildResult *result = rt_build_at(trial->results, trial->index, c);
        if (!runs(trial, c)) continue;
        RT_TRY(rt_spec_parse(trial->experiment->contenders[rt_trial_origin(trial, c)].spec, &spec, error));
        RT_TRY(build_one(trial, &spec, &trial->accels[c], &seconds, error));
        if (result->known) continue;
        const RtAccel *accel = trial->accels[c];
        *result = (RtBuildResult){.known = true, .exact = accel->exact, .counts = accel->counts};
        result->seconds = seconds;
        rt_spec_format(&spec, result->spec);
        rt_accel_describe(accel, &result->shape);
        RT_TRY(rt_trial_tell(trial, RT_EVENT_BUILD, c, RT_RAY_PRIMARY, error));
    }
    return RT_OK;
}

/* ---- the rays of one kind ---- */

/* Rays in a set that is thinned by `every`. */
static uint64_t thinned_count(const RtRaySet *set, uint64_t every) {
    return (set->count + every - 1) / every;
}

/* Rays of the set and of all shares that are thinned. */
static uint64_t count_with_shares(const RtTrialState *trial, const RtRaySet *set) {
    uint64_t count = set->count;
    for (uint32_t c = 0; c < trial->count; c++) {
        if (trial->accels[c] && rt_trial_every(trial, c) > 1)
            count += thinned_count(set, rt_trial_every(trial, c));
    }
    return count;
}

/* Picks the rays and answers of a share, to lie from `first` on. */
static void thin_share(const RtTrialState *trial, const RtRaySet *set, uint64_t every, uint64_t first,
                       RtTrialShare *share) {
    share->set.rays = set->rays + first;
    share->set.count = thinned_count(set, every);
    share->expected = trial->answers + first;
    for (uint64_t i = 0; i < share->set.count; i++) {
        share->set.rays[i] = set->rays[i * every];
        trial->answers[first + i] = trial->answers[i * every];
    }
}

/* Gives every contender its share of the set, and the answers to those that learn. Thinned shares are copies
 * behind the set, in the same array: the baseline, which may be one that learns and knows rays by their
 * places, is timed on all of them. */
static RtStatus deal_shares(RtTrialState *trial, RtRaySet *set, RtError *error) {
    uint64_t all = count_with_shares(trial, set), used = set->count;
    uint32_t capacity = (uint32_t)set->count;
    RT_TRY(rt_reserve(&set->rays, &capacity, all, sizeof(RtRay), error));
    trial->answers = rt_alloc(all, sizeof(RtHit));
    if (!trial->answers) return rt_fail_memory(error, "answers", all * sizeof(RtHit));
    RT_TRY(rt_measure_answers(trial->reference, set, trial->options->threads, trial->answers, error));
    for (uint32_t c = 0; c < trial->count; c++) {
        uint64_t every = rt_trial_every(trial, c);
        if (!trial->accels[c]) continue;
        trial->shares[c] = (RtTrialShare){.set = *set, .expected = trial->answers};
        if (every == 1) continue;
        thin_share(trial, set, every, used, &trial->shares[c]);
        used += trial->shares[c].set.count;
    }
    for (uint32_t c = 0; c < trial->count; c++) {
        if (trial->accels[c]) RT_TRY(rt_accel_learn(trial->accels[c], set->rays, trial->answers, all, error));
    }
    return RT_OK;
}

/* The invariants of Havran & Sixta 1999: equal for every correct accelerator are the rays, the rays that hit,
 * and, stronger, each answer. */
static RtStatus check_answers(const RtTrialState *trial, uint32_t contender, RtRayKind kind,
                              const RtCount *count, RtError *error) {
    const RtTrialShare *share = &trial->shares[contender];
    const char *scene = trial->experiment->trials[trial->index].label;
    const char *accel = rt_contender_label(trial->experiment, contender);
    uint64_t hits = 0;
    for (uint64_t i = 0; i < share->set.count; i++) hits += share->expected[i].object != RT_NO_OBJECT;
    if (count->differ) {
        return rt_fail(error, RT_MISMATCH,
                       "%s on %s answers %llu of %llu %s rays unlike %s, the first of them ray %llu; "
                       "`raytally verify` shows what is wrong",
                       accel, scene, (unsigned long long)count->differ, (unsigned long long)share->set.count,
                       rt_ray_kind_name(kind), rt_accel_default(), (unsigned long long)count->first);
    }
    if (count->tally.rays == share->set.count && count->tally.hits == hits) return RT_OK;
    return rt_fail(error, RT_MISMATCH,
                   "%s on %s counts %llu %s rays with %llu hits, where there are %llu with %llu", accel,
                   scene, (unsigned long long)count->tally.rays, rt_ray_kind_name(kind),
                   (unsigned long long)count->tally.hits, (unsigned long long)share->set.count,
                   (unsigned long long)hits);
}

static RtStatus count_kind(RtTrialState *trial, RtRayKind kind, RtError *error) {
    for (uint32_t c = 0; c < trial->experiment->contender_count; c++) {
        RtCell *cell = rt_cell_at(trial->results, trial->index, c, kind);
        const RtTrialShare *share = &trial->shares[c];
        RtCount count;
        if (!trial->accels[c] || cell->counted) continue;
        RT_TRY(rt_measure_count(trial->accels[c], &share->set, share->expected, trial->options->threads,
                                &count, error));
        if (trial->accels[c]->exact) RT_TRY(check_answers(trial, c, kind, &count, error));
        cell->counted = true;
        cell->tally = count.tally;
        cell->differ = count.differ;
        RT_TRY(rt_trial_tell(trial, RT_EVENT_COUNT, c, kind, error));
    }
    return RT_OK;
}

/* ---- all of it ---- */

static RtStatus measure_kind(RtTrialState *trial, RtRayKind kind, RtError *error) {
    if (trial->sets[kind].count == 0 || kind_is_done(trial, kind)) return RT_OK;
    RtStatus status = deal_shares(trial, &trial->sets[kind], error);
    if (status == RT_OK) status = count_kind(trial, kind, error);
    if (status == RT_OK && !trial->count_only) status = rt_trial_time(trial, kind, error);
    rt_free(trial->answers);
    trial->answers = NULL;
    return status;
}

static RtStatus measure(RtTrialState *trial, RtError *error) {
    RT_TRY(prepare(trial, error));
    RT_TRY(build_all(trial, error));
    for (uint32_t k = 0; k < trial->experiment->kind_count; k++) {
        RT_TRY(measure_kind(trial, trial->experiment->kinds[k], error));
    }
    return RT_OK;
}

static RtTrialState state_of(RtResults *results, uint32_t index, const RtTrialOptions *options) {
    RtTrialState trial = {
        .results = results, .experiment = results->experiment, .options = options, .index = index};
    trial.count_only = options->count_only || trial.experiment->count_only;
    trial.count = trial.experiment->contender_count + !trial.count_only;
    return trial;
}

bool rt_trial_is_done(RtResults *results, uint32_t index, const RtTrialOptions *options) {
    RtTrialState trial = state_of(results, index, options);
    return trial_is_done(&trial);
}

RtStatus rt_trial_open(RtResults *results, uint32_t index, const RtTrialOptions *options, RtScene *scene,
                       RtError *error) {
    const RtTrial *setup = &results->experiment->trials[index];
    const RtObserver *observer = &options->observer;
    char message[RT_MAX_PATH + 128];
    *scene = (RtScene){0};
    if (!setup->file || rt_file_exists(setup->path)) return rt_scene_open(setup->path, scene, error);
    if (!setup->optional) {
        return rt_fail(error, RT_BAD_INPUT,
                       "%s: there is no such file; `scenes/fetch.sh` fetches the public meshes", setup->path);
    }
    snprintf(message, sizeof message,
             "%s is missing, so '%s' is skipped; `scenes/fetch.sh` fetches the public meshes", setup->path,
             setup->label);
    if (observer->notice) observer->notice(observer->context, message);
    results->trials[index].skipped = true;
    return RT_OK;
}

RtStatus rt_trial_measure(RtResults *results, uint32_t index, const RtTrialOptions *options, RtScene *scene,
                          RtError *error) {
    RtTrialState trial = state_of(results, index, options);
    trial.scene = scene;
    if (trial_is_done(&trial)) return RT_OK;
    trial.accels = rt_alloc(trial.count, sizeof(RtAccel *));
    trial.shares = rt_alloc(trial.count, sizeof(RtTrialShare));
    RtStatus status = RT_OK;
    if (!trial.accels || !trial.shares)
        status = rt_fail_memory(error, "a trial", trial.count * sizeof(RtTrialShare));
    if (status == RT_OK) status = measure(&trial, error);
    for (uint32_t c = 0; trial.accels && c < trial.count; c++) rt_accel_destroy(trial.accels[c]);
    rt_accel_destroy(trial.reference);
    for (int k = 0; k < RT_RAY_KIND_COUNT; k++) rt_rayset_clear(&trial.sets[k]);
    rt_free(trial.accels);
    rt_free(trial.shares);
    return status;
}

RtStatus rt_trial_run(RtResults *results, uint32_t index, const RtTrialOptions *options, RtError *error) {
    RtScene scene;
    if (rt_trial_is_done(results, index, options)) return RT_OK;
    RT_TRY(rt_trial_open(results, index, options, &scene, error));
    RtStatus status = rt_trial_measure(results, index, options, &scene, error);
    rt_scene_clear(&scene);
    return status;
}
