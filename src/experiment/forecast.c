/* SPDX-License-Identifier: Apache-2.0 */
#include "experiment/forecast.h"

#include <math.h>

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
    return t->rays ? (double)(t->object_tests + t->extent_tests + t->steps) / (double)t->rays : 0;
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

static void add_cell(Forecast *f, const RateEstimate *rates, uint32_t t, uint32_t c, RtRayKind kind) {
    const RtExperiment *e = f->experiment;
    const RtCell *cell = rt_cell_at(f->results, t, c, kind);
    const RtWorkloadResult *workload = &f->results->workloads[t];
    uint64_t stride = c < e->candidate_count ? e->candidates[c].ray_stride : 1;
    bool null = c == e->candidate_count;
    const RtWorkload *setup = &e->workloads[t];
    double rays = (double)(workload->known ? workload->rays[kind] : e->limit);
    /* A frame that is not recorded yet: one ray of a kind per pixel. */
    if (!workload->known && setup->width && rt_ray_kind_is_of_frame(kind))
        rays = fmin(rays, (double)setup->width * setup->height);
    rays /= (double)stride;
    /* A candidate that was not timed yet: as much time per test and step as the others take, if they are
     * counted; else as much as the baseline. */
    const double operations = operations_of(cell);
    const double other = operations > 0 ? operations * mean(f->all.seconds, f->all.operations, 0)
                                        : mean(f->baseline.seconds, f->baseline.rays, 0);
    double ray = cell->timed ? cell->wall.median : mean(rates->seconds, rates->rays, other);
    if (!null) {
        f->sums.cells++;
        f->sums.finished += cell->counted && (cell->timed || f->count_only);
        add(f, cell->counted, rays * ray);
    }
    if (f->count_only) return;
    /* A thinned accelerator is timed together with the baseline on its rays. */
    double runs = (1 + e->rounds) * (stride > 1 ? 1.0 + e->baseline_count : 1.0);
    add(f, cell->timed, runs * fmax(1e-3 * e->milliseconds, rays * ray));
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
                !rt_only_cell(&options->only, e, t, c, RT_ALL_RAYS))
                continue;
            double once = mean(rates.build, rates.builds, mean(f.all.build, f.all.builds, 0));
            add(&f, build->known, build_seconds(&f, build->known ? build->seconds.median : once));
            for (uint32_t k = 0; k < e->kind_count; k++) {
                RtRayKind kind = e->kinds[k];
                bool none = results->workloads[t].known && !results->workloads[t].rays[kind];
                if (none || *rt_cell_at(results, t, c, kind)->left_out ||
                    !rt_only_cell(&options->only, e, t, c, kind))
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
