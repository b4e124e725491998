/* SPDX-License-Identifier: Apache-2.0 */
/* A workload in order: record, build, for each kind of rays count and time, and render. */
#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/words.h"
#include "measure/measure.h"
#include "render/frame.h"
#include "run/workload_state.h"
#include "scenes/open.h"

/* ---- what is unknown ---- */

/* Whether a frame is rendered with candidate `c`: with the null run none is. */
static bool renders(const RtWorkloadState *workload, uint32_t c) {
    const RtExperiment *e = workload->experiment;
    if (!e->render || !rt_workload_is_timed(workload) || c == e->candidate_count) return false;
    for (int k = 0; k < RT_RAY_KIND_COUNT; k++) {
        if (*rt_cell_at(workload->results, workload->index, c, (RtRayKind)k)->left_out) return false;
    }
    return e->candidates[c].ray_stride == 1 && !rt_spec_is_remote(&e->candidates[c].parsed) &&
           rt_workload_runs(workload, c);
}

static bool is_asked(const RtWorkloadState *workload, uint32_t c, RtRayKind kind) {
    return rt_selection_has(&workload->options->only, workload->experiment, workload->index, c, kind);
}

/* Whether a best-of that has members to choose from has not chosen yet. */
static bool must_choose(const RtWorkloadState *workload, uint32_t best, RtRayKind kind) {
    const RtCandidate *candidate = &workload->experiment->candidates[best];
    const RtResults *results = workload->results;
    bool any = false;
    for (uint32_t i = 0; i < candidate->member_count; i++) {
        const uint32_t c = candidate->members[i];
        any |= is_asked(workload, c, kind) && rt_workload_runs(workload, c) &&
               !*rt_cell_at(results, workload->index, c, kind)->left_out;
    }
    return any && !rt_cell_at(results, workload->index, best, kind)->chosen;
}

static bool kind_is_done(const RtWorkloadState *workload, RtRayKind kind) {
    for (uint32_t c = 0; c < workload->experiment->candidate_count && rt_workload_is_timed(workload); c++) {
        if (must_choose(workload, c, kind)) return false;
    }
    for (uint32_t c = 0; c < workload->count; c++) {
        const RtCell *cell = rt_cell_at(workload->results, workload->index, c, kind);
        bool null = c == workload->experiment->candidate_count;
        if (!is_asked(workload, c, kind) || !rt_workload_runs(workload, c) || *cell->left_out) continue;
        const bool times =
            !workload->count_only && rt_results_times(workload->results, workload->index, c, kind);
        if ((!cell->counted && !null) || (!cell->timed && times)) return false;
        if (workload->distributions && !cell->distributions && !null) return false;
    }
    return true;
}

static bool workload_is_done(const RtWorkloadState *workload) {
    const RtWorkloadResult *result = &workload->results->workloads[workload->index];
    if (!rt_selection_has_scene(&workload->options->only, workload->experiment, workload->index)) return true;
    if (result->skipped || !result->known) return result->skipped;
    for (uint32_t c = 0; c < workload->count; c++) {
        const RtBuildResult *build = rt_build_at(workload->results, workload->index, c);
        if (rt_workload_runs(workload, c) && !build->known) return false;
        if (renders(workload, c) && !build->render.known) return false;
    }
    for (uint32_t k = 0; k < workload->experiment->kind_count; k++) {
        RtRayKind kind = workload->experiment->kinds[k];
        if (result->rays[kind] && !kind_is_done(workload, kind)) return false;
    }
    return true;
}

/* ---- the scene ---- */

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
    *scene = (RtScene){0};
    if (!setup->optional || !setup->file || rt_file_exists(setup->path))
        return rt_workload_open_scene(setup, scene, error);
    rt_notify(&options->observer,
              "%s is missing, so '%s' is skipped; `scenes/fetch.sh` fetches the public meshes", setup->path,
              setup->label);
    results->workloads[index].skipped = true;
    return RT_OK;
}

/* ---- the rays ---- */

/* Keeps at most `limit` rays of each kind that the experiment asks for. */
static RtStatus keep_sets(const RtExperiment *experiment, const RtScene *scene, uint64_t limit,
                          const RtRaySet *recorded, RtRaySet *sets, uint64_t *whole_rays, RtError *error) {
    const uint64_t samples = (uint64_t)scene->sampling.columns * scene->sampling.rows;
    for (uint32_t k = 0; k < experiment->kind_count; k++) {
        RtRayKind kind = experiment->kinds[k];
        whole_rays[kind] = kind == RT_RAY_RANDOM ? samples : recorded[kind].count;
        RT_TRY(rt_rayset_limit(&recorded[kind], limit, experiment->coherent_run, &sets[kind], error));
    }
    return RT_OK;
}

/* `other`: those of the next seed, at the other places of pixels. */
static RtStatus record(const RtExperiment *experiment, uint32_t index, int threads, bool other,
                       const RtAccel *reference, RtScene *scene, RtRaySet *sets, uint64_t *whole_rays,
                       RtError *error) {
    const RtWorkload *setup = &experiment->workloads[index];
    const uint64_t limit =
        other && experiment->limit > RT_LEARNABLE_RAYS ? RT_LEARNABLE_RAYS : experiment->limit;
    RtRecording recording = {.depth = setup->depth,
                             .seed = experiment->seed + other,
                             .random = limit,
                             .threads = threads,
                             .light_from_outside = setup->light_from_outside};
    RtRaySet recorded[RT_RAY_KIND_COUNT] = {0};
    for (uint32_t k = 0; k < experiment->kind_count; k++) recording.kinds |= 1u << experiment->kinds[k];
    RT_TRY(rt_scene_sample(scene, setup->width, setup->height, 1, setup->corners != other, error));
    RtStatus status = rt_rayset_record(recorded, reference, &recording, error);
    if (status == RT_OK) status = keep_sets(experiment, scene, limit, recorded, sets, whole_rays, error);
    for (int k = 0; k < RT_RAY_KIND_COUNT; k++) rt_rayset_clear(&recorded[k]);
    return status;
}

static bool has_best(const RtExperiment *experiment) {
    bool any = false;
    for (uint32_t c = 0; c < experiment->candidate_count; c++)
        any |= experiment->candidates[c].member_count > 0;
    return any;
}

/* Moves every second coherent run of the set to `other`. */
static RtStatus divide(RtRaySet *set, uint64_t run, RtRaySet *other, RtError *error) {
    const uint64_t all = set->count;
    RT_TRY(rt_rayset_init(other, set->kind, all, error));
    set->count = other->count = 0;
    for (uint64_t i = 0; i < all; i++) {
        RtRaySet *to = i / run % 2 ? other : set;
        to->rays[to->count++] = set->rays[i];
    }
    rt_rayset_seal(set);
    rt_rayset_seal(other);
    return RT_OK;
}

/* What is measured does not depend on whether times are taken. */
static RtStatus load_rays(const RtExperiment *experiment, RtRaySet *sets, RtRaySet *others,
                          uint64_t *whole_rays, RtError *error) {
    const RtRayKind kind = experiment->kinds[0];
    RT_OWNED(RtRaySet, unused, rt_rayset_clear);
    RT_TRY(rt_rays_load(experiment->rays_from, kind, &sets[kind], error));
    whole_rays[kind] = sets[kind].count;
    if (!has_best(experiment)) return RT_OK;
    return divide(&sets[kind], experiment->coherent_run, others ? &others[kind] : &unused, error);
}

RtStatus rt_workload_record(const RtExperiment *experiment, uint32_t index, int threads, RtScene *scene,
                            RtAccel **reference, RtRaySet *sets, RtRaySet *others, uint64_t *whole_rays,
                            RtError *error) {
    const RtWorkload *setup = &experiment->workloads[index];
    uint64_t ignored[RT_RAY_KIND_COUNT];
    RT_TRY(rt_scene_sample(scene, setup->width, setup->height, 1, setup->corners, error));
    RT_TRY(rt_accel_open_on(rt_accel_default(), scene, threads, reference, error));
    if (*experiment->rays_from) return load_rays(experiment, sets, others, whole_rays, error);
    if (others) RT_TRY(record(experiment, index, threads, true, *reference, scene, others, ignored, error));
    return record(experiment, index, threads, false, *reference, scene, sets, whole_rays, error);
}

static void say(void *observer, const char *text) {
    rt_notify(observer, "%s", text);
}

/* Lists the warnings of a scene's files that fit, whole, and how many do not. */
static void list_warnings(const RtWarnings *warnings, char *out, size_t size) {
    enum { LAST = 40 };
    char text[RT_WARNING_TEXT];
    size_t length = 0;
    for (uint32_t i = 0; i < warnings->count; i++) {
        const char *line = rt_warning_text(&warnings->list[i], text);
        if (length + strlen(line) + LAST > size) {
            snprintf(out + length, size - length, "%sand %u more", i > 0 ? "\n" : "", warnings->count - i);
            return;
        }
        length += (size_t)snprintf(out + length, size - length, "%s%s", i > 0 ? "\n" : "", line);
    }
}

/* Records the rays; fills the workload's part of the results, or compares it with the previous run's. */
static RtStatus prepare(RtWorkloadState *workload, RtError *error) {
    uint64_t whole_rays[RT_RAY_KIND_COUNT] = {0};
    RT_TRY(rt_workload_record(workload->experiment, workload->index, workload->options->threads,
                              workload->scene, &workload->reference, workload->sets,
                              rt_workload_is_timed(workload) ? workload->others : NULL, whole_rays, error));
    RtWorkloadResult *result = &workload->results->workloads[workload->index];
    RtWorkloadResult now = {.known = true,
                            .objects = rt_geometry_id_count(&workload->scene->geometry),
                            .width = workload->scene->sampling.width,
                            .height = workload->scene->sampling.height,
                            .scene = rt_scene_fingerprint(workload->scene)};
    bool same = now.scene == result->scene;
    for (int k = 0; k < RT_RAY_KIND_COUNT; k++) {
        now.rays[k] = workload->sets[k].count;
        now.whole_rays[k] = whole_rays[k];
        now.ray_fingerprints[k] = workload->sets[k].fingerprint;
        same &= now.ray_fingerprints[k] == result->ray_fingerprints[k];
    }
    if (result->known && !same)
        return rt_fail(error, RT_BAD_INPUT,
                       "'%s' has changed since this run was interrupted: start over with --force",
                       workload->experiment->workloads[workload->index].label);
    if (result->known) return RT_OK;
    rt_warnings_tell(&workload->scene->warnings, say, (void *)&workload->options->observer);
    list_warnings(&workload->scene->warnings, now.warnings, sizeof now.warnings);
    *result = now;
    return rt_workload_tell(workload, RT_EVENT_WORKLOAD, 0, RT_RAY_PRIMARY, error);
}

/* ---- a kind of rays ---- */

/* Selects accelerators that are not known to exceed a limit, or to break. */
static RtStatus choose_accels(RtWorkloadState *workload, RtRayKind kind, RtError *error) {
    for (uint32_t c = 0; c < workload->count; c++) {
        const RtCell *cell = rt_cell_at(workload->results, workload->index, c, kind);
        RtStatus status = rt_workload_rebuild(workload, c, error);
        const bool traces = status == RT_OK && !*cell->left_out && is_asked(workload, c, kind);
        workload->accels[c] = traces ? workload->built[c] : NULL;
        if (status != RT_OK) RT_TRY(rt_workload_break(workload, c, kind, error));
    }
    return RT_OK;
}

static RtStatus measure_kind(RtWorkloadState *workload, RtRayKind kind, RtError *error) {
    if (workload->sets[kind].count == 0 || kind_is_done(workload, kind)) return RT_OK;
    RT_TRY(choose_accels(workload, kind, error));
    RtStatus status = rt_workload_count(workload, kind, error);
    if (status == RT_OK && workload->options->rays)
        status = workload->options->rays(workload->options->rays_context, workload->index,
                                         &workload->sets[kind], workload->reference, error);
    if (status == RT_OK && workload->options->timer) {
        status = workload->options->timer(workload->options->timer_context, workload, kind, error);
    } else if (status == RT_OK && rt_workload_is_timed(workload)) {
        status = rt_workload_choose(workload, kind, error);
        if (status == RT_OK) status = rt_workload_time(workload, kind, error);
    }
    rt_free(workload->answers);
    workload->answers = NULL;
    return status;
}

/* ---- frames: how long rendering takes with each candidate, and which part of that its queries take ----
 *
 * Candidates with a stride, or of which a limit left out a cell, are too slow for whole frames. Plugins are
 * left out: their rays travel to another process. */

typedef struct Rendering {
    uint32_t candidate;
    const RtAccel *accel;
    RtFrameOptions options;
    double seconds[RT_MAX_ROUNDS], shares[RT_MAX_ROUNDS];
    uint32_t runs; /* the first is the warm-up */
} Rendering;

static RtStatus render_once(void *context, RtError *error) {
    Rendering *rendering = context;
    RT_OWNED(RtFrame, frame, rt_frame_clear);
    RT_TRY(rt_frame_trace(&frame, rendering->accel, &rendering->options, error));
    if (rendering->runs > 0) rendering->shares[rendering->runs - 1] = frame.share;
    rendering->runs++;
    return RT_OK;
}

/* The candidates still to be rendered, one runner each. */
static uint32_t enter(RtWorkloadState *workload, Rendering *renderings, RtRunner *runners) {
    const RtExperiment *experiment = workload->experiment;
    const RtWorkload *setup = &experiment->workloads[workload->index];
    const int threads = workload->options->timing;
    uint32_t count = 0;
    for (uint32_t c = 0; c < experiment->candidate_count; c++) {
        if (!workload->built[c] || !renders(workload, c) ||
            rt_build_at(workload->results, workload->index, c)->render.known)
            continue;
        Rendering *rendering = &renderings[count];
        *rendering = (Rendering){.candidate = c,
                                 .accel = workload->built[c],
                                 .options = {.depth = setup->depth,
                                             .threads = threads,
                                             .light_from_outside = setup->light_from_outside,
                                             .share = true}};
        runners[count++] = (RtRunner){.run = render_once,
                                      .context = rendering,
                                      .work = 1,
                                      .parallel = rt_thread_count(threads) > 1,
                                      .seconds = rendering->seconds};
    }
    return count;
}

static RtStatus keep(RtWorkloadState *workload, const Rendering *renderings, uint32_t count, RtError *error) {
    const RtMachine here = rt_machine_here();
    const uint32_t rounds = workload->experiment->rounds;
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t c = renderings[i].candidate;
        rt_build_at(workload->results, workload->index, c)->render =
            (RtRenderResult){.known = true,
                             .rounds = rounds,
                             .threads = rt_thread_count(workload->options->timing),
                             .machine = rt_results_machine(workload->results, &here),
                             .seconds = rt_estimate(renderings[i].seconds, rounds),
                             .share = rt_estimate(renderings[i].shares, rounds)};
        RT_TRY(rt_workload_tell(workload, RT_EVENT_RENDER, c, RT_RAY_PRIMARY, error));
    }
    return RT_OK;
}

static RtStatus render(RtWorkloadState *workload, RtError *error) {
    const RtExperiment *experiment = workload->experiment;
    RT_ARENA(arena);
    const RtRounds rounds = {
        .rounds = experiment->rounds, .most = experiment->rounds, .seed = experiment->seed};
    Rendering *renderings = rt_arena_alloc(&arena, experiment->candidate_count, sizeof(Rendering));
    RT_TRY(rt_arena_check(&arena, "times of frames", error));
    RtRunner runners[RT_MAX_CANDIDATES];
    uint32_t count = enter(workload, renderings, runners), done;
    if (count > 0) RT_TRY(rt_rounds_run(runners, count, &rounds, &done, error));
    return keep(workload, renderings, count, error);
}

/* ---- all of it ---- */

/* Without rays of any kind the tables would be empty. */
static void notify_empty(const RtWorkloadState *workload) {
    const RtExperiment *experiment = workload->experiment;
    const char *names[RT_RAY_KIND_COUNT];
    char list[128];
    for (uint32_t k = 0; k < experiment->kind_count; k++) {
        if (workload->sets[experiment->kinds[k]].count > 0) return;
        names[k] = rt_experiment_kind_name(experiment, experiment->kinds[k]);
    }
    rt_join_names(names, experiment->kind_count, list, sizeof list);
    rt_notify(
        &workload->options->observer,
        "%s: there are no rays to measure (%s): no surface, light or material in its image causes them; "
        "choose other kinds (--rays; in an experiment `rays`) or a larger image",
        experiment->workloads[workload->index].label, list);
}

static RtStatus measure(RtWorkloadState *workload, RtError *error) {
    RT_TRY(prepare(workload, error));
    notify_empty(workload);
    RT_TRY(rt_workload_build(workload, error));
    for (uint32_t k = 0; k < workload->experiment->kind_count; k++)
        RT_TRY(measure_kind(workload, workload->experiment->kinds[k], error));
    return render(workload, error);
}

static RtWorkloadState state_of(RtResults *results, uint32_t index, const RtWorkloadOptions *options) {
    RtWorkloadState workload = {
        .results = results, .experiment = results->experiment, .options = options, .index = index};
    workload.count_only = options->count_only || workload.experiment->count_only;
    workload.distributions = workload.experiment->distributions && !options->timer;
    workload.count = workload.experiment->candidate_count + rt_workload_is_timed(&workload);
    return workload;
}

bool rt_workload_is_done(RtResults *results, uint32_t index, const RtWorkloadOptions *options) {
    RtWorkloadState workload = state_of(results, index, options);
    return workload_is_done(&workload);
}

RtStatus rt_workload_measure(RtResults *results, uint32_t index, const RtWorkloadOptions *options,
                             RtScene *scene, RtError *error) {
    RtWorkloadState workload = state_of(results, index, options);
    workload.scene = scene;
    if (workload_is_done(&workload)) return RT_OK;
    RtStatus status = measure(&workload, error);
    for (uint32_t c = 0; c < workload.count; c++) rt_workload_destroy(&workload, c);
    rt_accel_destroy(workload.reference);
    for (int k = 0; k < RT_RAY_KIND_COUNT; k++) {
        rt_rayset_clear(&workload.sets[k]);
        rt_rayset_clear(&workload.others[k]);
    }
    return status;
}

RtStatus rt_workloads_run(RtResults *results, const RtWorkloadOptions *options, RtError *error) {
    for (uint32_t t = 0; t < results->experiment->workload_count; t++) {
        RT_OWNED(RtScene, scene, rt_scene_clear);
        if (rt_workload_is_done(results, t, options)) continue;
        RT_TRY(rt_workload_open(results, t, options, &scene, error));
        RT_TRY(rt_workload_measure(results, t, options, &scene, error));
    }
    return RT_OK;
}
