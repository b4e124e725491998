#include "experiments/results.h"

#include "base/memory.h"

#include <math.h>

RtStatus rt_results_init(RtResults *results, const RtExperiment *experiment, RtError *error) {
    size_t trials = experiment->trial_count, builds = trials * (experiment->contender_count + 1);
    *results = (RtResults){.experiment = experiment};
    results->trials = rt_alloc(trials, sizeof(RtTrialResult));
    results->builds = rt_alloc(builds, sizeof(RtBuildResult));
    results->cells = rt_alloc(builds * RT_RAY_KIND_COUNT, sizeof(RtCell));
    if (results->trials && results->builds && results->cells) return RT_OK;
    return rt_fail_memory(error, "the results", builds * RT_RAY_KIND_COUNT * sizeof(RtCell));
}

void rt_results_clear(RtResults *results) {
    rt_free(results->trials);
    rt_free(results->builds);
    rt_free(results->cells);
    *results = (RtResults){0};
}

static size_t build_index(const RtResults *results, uint32_t trial, uint32_t contender) {
    return (size_t)trial * (results->experiment->contender_count + 1) + contender;
}

RtBuildResult *rt_build_at(const RtResults *results, uint32_t trial, uint32_t contender) {
    return &results->builds[build_index(results, trial, contender)];
}

RtCell *rt_cell_at(const RtResults *results, uint32_t trial, uint32_t contender, RtRayKind kind) {
    return &results->cells[build_index(results, trial, contender) * RT_RAY_KIND_COUNT + (size_t)kind];
}

const char *rt_contender_label(const RtExperiment *experiment, uint32_t contender) {
    return contender < experiment->contender_count ? experiment->contenders[contender].label : "null";
}

void rt_null_verdict(const RtResults *results, uint32_t *runs, uint32_t *straddling) {
    *runs = *straddling = 0;
    for (uint32_t t = 0; t < results->experiment->trial_count; t++) {
        for (uint32_t k = 0; k < RT_RAY_KIND_COUNT; k++) {
            const RtCell *cell = rt_cell_at(results, t, results->experiment->contender_count, (RtRayKind)k);
            *runs += cell->timed;
            *straddling += cell->timed && cell->ratio.low <= 1 && 1 <= cell->ratio.high;
        }
    }
}

bool rt_cell_has_tests(const RtResults *results, uint32_t trial, uint32_t contender, RtRayKind kind) {
    const RtCell *cell = rt_cell_at(results, trial, contender, kind);
    const RtTally *tally = &cell->tally;
    bool some = tally->object_tests || tally->extent_tests || tally->steps;
    return cell->counted && (some || rt_build_at(results, trial, contender)->counts);
}

RtTotal rt_results_total(const RtResults *results, uint32_t trial, uint32_t contender) {
    RtTotal total = {0};
    double counted = 0, timed = 0;
    for (uint32_t k = 0; k < RT_RAY_KIND_COUNT; k++) {
        const RtCell *cell = rt_cell_at(results, trial, contender, (RtRayKind)k);
        double weight = (double)results->trials[trial].rays[k], rays = (double)cell->tally.rays;
        total.rays += cell->tally.rays;
        if (rt_cell_has_tests(results, trial, contender, (RtRayKind)k)) {
            counted += weight;
            total.object_tests += weight * (double)cell->tally.object_tests / rays;
            total.extent_tests += weight * (double)cell->tally.extent_tests / rays;
            total.steps += weight * (double)cell->tally.steps / rays;
        }
        if (cell->timed) {
            timed += weight;
            total.seconds += weight * cell->seconds.median;
        }
    }
    /* 0 / 0 is NAN: not known. */
    total.object_tests /= counted;
    total.extent_tests /= counted;
    total.steps /= counted;
    total.seconds /= timed;
    return total;
}
