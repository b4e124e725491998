/* SPDX-License-Identifier: Apache-2.0 */
#include "run/forecast.h"

#include "core/base/memory.h"
#include "results/journal.h"
#include "results/result_directory.h"

#include <math.h>
#include <string.h>

/* ---- the run of another version ---- */

/* The workload of the same frames; workload_count if there is none. */
static uint32_t find_workload(const RtExperiment *in, const RtWorkload *like) {
    uint32_t t = 0;
    for (; t < in->workload_count; t++) {
        const RtWorkload *w = &in->workloads[t];
        if (strcmp(w->spec, like->spec) == 0 && w->width == like->width && w->height == like->height &&
            w->depth == like->depth && w->corners == like->corners &&
            w->light_from_outside == like->light_from_outside)
            break;
    }
    return t;
}

/* The candidate with the same spec on workload `t`; candidate_count if there is none. */
static uint32_t find_candidate(const RtExperiment *in, uint32_t t, const RtCandidate *like) {
    uint32_t c = 0;
    while (c < in->candidate_count &&
           (strcmp(in->candidates[c].spec, like->spec) != 0 ||
            in->candidates[c].ray_stride != like->ray_stride || !rt_candidate_runs(in, c, t)))
        c++;
    return c;
}

static void learn_candidate(const RtResults *from, uint32_t t, uint32_t c, RtResults *to, uint32_t to_t,
                            uint32_t to_c) {
    const RtBuildResult *build = rt_build_at(from, t, c);
    RtBuildResult *to_build = rt_build_at(to, to_t, to_c);
    to_build->known = build->known;
    to_build->seconds = build->seconds;
    to_build->render = build->render;
    for (RtRayKind kind = 0; kind < RT_RAY_KIND_COUNT; kind++) {
        const RtCell *cell = rt_cell_at(from, t, c, kind);
        RtCell *to_cell = rt_cell_at(to, to_t, to_c, kind);
        to_cell->counted = cell->counted;
        to_cell->timed = cell->timed;
        to_cell->tally = cell->tally;
        to_cell->wall = cell->wall;
    }
}

static void learn_all(const RtResults *from, RtResults *to) {
    const RtExperiment *old = from->experiment, *e = to->experiment;
    const bool same_sets =
        old->seed == e->seed && old->limit == e->limit && memcmp(old->kinds, e->kinds, sizeof e->kinds) == 0;
    for (uint32_t t = 0; t < e->workload_count; t++) {
        const uint32_t old_t = find_workload(old, &e->workloads[t]);
        if (old_t == old->workload_count) continue;
        if (same_sets) to->workloads[t] = from->workloads[old_t];
        for (uint32_t c = 0; c < e->candidate_count; c++) {
            const uint32_t old_c = find_candidate(old, old_t, &e->candidates[c]);
            if (old_c < old->candidate_count && rt_candidate_runs(e, c, t))
                learn_candidate(from, old_t, old_c, to, t, c);
        }
    }
}

/* The experiment of the directory, if this build can read it; else *experiment gets no scenes. */
static RtStatus load_old(const char *directory, const char *journal, RtExperiment *experiment,
                         RtError *error) {
    char path[RT_MAX_PATH];
    json_t *lines;
    RT_TRY(rt_path_join(directory, rt_result_files[RT_FILE_EXPERIMENT], path, error));
    RT_TRY(rt_json_lines_load(journal, &lines, error));
    const bool quick = json_is_true(json_object_get(json_array_get(lines, 0), "quick"));
    json_decref(lines);
    if (rt_experiment_load(experiment, path, quick, error) != RT_OK) rt_experiment_init(experiment);
    return RT_OK;
}

RtStatus rt_forecast_learn(const char *directory, RtResults *results, RtError *error) {
    char journal[RT_MAX_PATH];
    RtResults old = {0};
    RT_TRY(rt_path_join(directory, RT_RUN_JOURNAL, journal, error));
    RtExperiment *experiment = rt_alloc(1, sizeof *experiment);
    if (!experiment) return rt_fail_memory(error, "an experiment", sizeof *experiment);
    RtStatus status = load_old(directory, journal, experiment, error);
    if (status == RT_OK && experiment->workload_count) {
        status = rt_results_init(&old, experiment, error);
        if (status == RT_OK) status = rt_journal_load(journal, &old, NULL, false, error);
        if (status == RT_OK) learn_all(&old, results);
        rt_results_clear(&old);
    }
    rt_free(experiment);
    return status;
}

/* ---- the forecast ---- */

/* Sums over the known cells of one candidate, to estimate the others. */
typedef struct RateEstimate {
    double seconds, rays; /* to trace them */
    double operations;    /* per ray, a sum as the others */
    double build, builds;
} RateEstimate;

typedef struct Forecast {
    const RtResults *results;
    const RtExperiment *experiment;
    bool count_only;
    RateEstimate all, baseline;
    RtForecast sums;
} Forecast;

/* Tests and steps per ray of a counted cell. */
static double operations_of(const RtCell *cell) {
    const RtTally *t = &cell->tally;
    return t->rays ? ((double)t->object_tests + (double)t->extent_tests + (double)t->steps) / (double)t->rays
                   : 0;
}

static void learn(RateEstimate *rates, const RtResults *results, uint32_t t, uint32_t c) {
    const RtBuildResult *build = rt_build_at(results, t, c);
    if (build->known) {
        rates->build += build->seconds.median;
        rates->builds++;
    }
    for (uint32_t k = 0; k < RT_RAY_KIND_COUNT; k++) {
        const RtCell *cell = rt_cell_at(results, t, c, (RtRayKind)k);
        if (!cell->timed) continue;
        rates->seconds += cell->wall.median;
        rates->rays++;
        rates->operations += operations_of(cell);
    }
}

static double mean(double sum, double count, double other) {
    return count > 0 ? sum / count : other;
}

/* The seconds of all builds of a structure (workload_build.c). */
static double build_seconds(const Forecast *f, double once) {
    const double builds = f->experiment->builds;
    return f->count_only ? once : fmin((1 + builds) * once, RT_BUILD_BUDGET * builds + once);
}

static void add(Forecast *f, bool known, double seconds) {
    if (known)
        f->sums.known += seconds;
    else
        f->sums.left += seconds;
}

/* Pixels of a frame; of a frame that is not recorded yet and as large as the camera's, as many as rays. */
static double pixels_of(const Forecast *f, uint32_t t) {
    const RtWorkloadResult *workload = &f->results->workloads[t];
    const RtWorkload *setup = &f->experiment->workloads[t];
    return workload->known ? (double)workload->width * workload->height
           : setup->width  ? (double)setup->width * setup->height
                           : (double)f->experiment->limit;
}

/* Seconds per ray. A candidate that was not timed yet: as much time per test and step as the others take, if
 * they are counted; else as much as the baseline. */
static double ray_seconds(const Forecast *f, const RateEstimate *rates, uint32_t t, uint32_t c,
                          RtRayKind kind) {
    const RtCell *cell = rt_cell_at(f->results, t, c, kind);
    const double operations = operations_of(cell);
    const double other = operations > 0 ? operations * mean(f->all.seconds, f->all.operations, 0)
                                        : mean(f->baseline.seconds, f->baseline.rays, 0);
    return cell->timed ? cell->wall.median : mean(rates->seconds, rates->rays, other);
}

/* A frame that was not rendered yet: a ray of each of its kinds per pixel. */
static void add_frames(Forecast *f, const RateEstimate *rates, uint32_t t, uint32_t c) {
    const RtExperiment *e = f->experiment;
    const RtRenderResult *render = &rt_build_at(f->results, t, c)->render;
    double frame = 0;
    if (f->count_only || !rt_candidate_renders(e, c)) return;
    for (uint32_t k = 0; k < e->kind_count; k++) {
        if (rt_ray_kind_is_of_frame(e->kinds[k]))
            frame += pixels_of(f, t) * ray_seconds(f, rates, t, c, e->kinds[k]);
    }
    add(f, render->known, (1 + e->rounds) * (render->known ? render->seconds.median : frame));
}

static void add_cell(Forecast *f, const RateEstimate *rates, uint32_t t, uint32_t c, RtRayKind kind) {
    const RtExperiment *e = f->experiment;
    const RtCell *cell = rt_cell_at(f->results, t, c, kind);
    const RtWorkloadResult *workload = &f->results->workloads[t];
    uint64_t stride = c < e->candidate_count ? e->candidates[c].ray_stride : 1;
    bool null = c == e->candidate_count;
    double rays = (double)(workload->known ? workload->rays[kind] : e->limit);
    if (!workload->known && rt_ray_kind_is_of_frame(kind)) rays = fmin(rays, pixels_of(f, t));
    rays /= (double)stride;
    const double ray = ray_seconds(f, rates, t, c, kind);
    if (!null) {
        f->sums.cells++;
        f->sums.finished += cell->counted && (cell->timed || f->count_only);
        add(f, cell->counted, rays * ray);
    }
    if (f->count_only) return;
    /* A thinned accelerator is timed together with the baseline on its rays. */
    double runs = (1 + e->rounds) * (stride > 1 ? 1.0 + e->baseline_count : 1.0);
    const double round = fmax(1e-3 * e->milliseconds, rays * ray);
    const double build = rt_build_at(f->results, t, c)->seconds.median; /* 0: not known yet */
    add(f, cell->timed, runs * round + (e->rounds - 1) * fmin(build, fmax(RT_RENEWAL_BUDGET, round)));
}

RtForecast rt_forecast(const RtResults *results, const RtWorkloadOptions *options) {
    const RtExperiment *e = results->experiment;
    Forecast f = {.results = results, .experiment = e, .count_only = options->count_only || e->count_only};
    for (uint32_t t = 0; t < e->workload_count; t++) {
        for (uint32_t c = 0; c <= e->candidate_count; c++) learn(&f.all, results, t, c);
        learn(&f.baseline, results, t, e->baseline);
    }
    for (uint32_t c = 0; c < e->candidate_count + !f.count_only; c++) {
        RateEstimate rates = {0};
        for (uint32_t t = 0; t < e->workload_count; t++) learn(&rates, results, t, c);
        for (uint32_t t = 0; t < e->workload_count; t++) {
            const RtBuildResult *build = rt_build_at(results, t, c);
            if (results->workloads[t].skipped) continue;
            if (*build->left_out || !rt_candidate_runs(e, c, t) ||
                !rt_selection_has(&options->only, e, t, c, RT_ALL_RAYS))
                continue;
            double once = mean(rates.build, rates.builds, mean(f.all.build, f.all.builds, 0));
            add(&f, build->known, build_seconds(&f, build->known ? build->seconds.median : once));
            add_frames(&f, &rates, t, c);
            for (uint32_t k = 0; k < e->kind_count; k++) {
                RtRayKind kind = e->kinds[k];
                bool none = results->workloads[t].known && !results->workloads[t].rays[kind];
                if (none || *rt_cell_at(results, t, c, kind)->left_out ||
                    !rt_selection_has(&options->only, e, t, c, kind))
                    continue;
                add_cell(&f, &rates, t, c, kind);
            }
        }
    }
    f.sums.guessed = f.all.rays == 0;
    return f.sums;
}

double rt_forecast_left(const RtForecast *now, double before, double elapsed) {
    double done = now->known - before;
    return done > 0 && !now->guessed ? now->left * elapsed / done : (double)NAN;
}
