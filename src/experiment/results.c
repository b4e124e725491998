/* SPDX-License-Identifier: Apache-2.0 */
#include "experiment/results.h"

#include "core/base/memory.h"

#include <math.h>
#include <string.h>

RtStatus rt_results_init(RtResults *results, const RtExperiment *experiment, RtError *error) {
    size_t workloads = experiment->workload_count, builds = workloads * (experiment->candidate_count + 1);
    *results = (RtResults){.experiment = experiment};
    results->workloads = rt_alloc(workloads, sizeof(RtWorkloadResult));
    results->builds = rt_alloc(builds, sizeof(RtBuildResult));
    results->cells = rt_alloc(builds * RT_RAY_KIND_COUNT, sizeof(RtCell));
    results->machines = rt_alloc(RT_MAX_MACHINES, sizeof(RtMachine));
    results->machine_count = 1;
    if (results->workloads && results->builds && results->cells && results->machines) return RT_OK;
    return rt_fail_memory(error, "the results", builds * RT_RAY_KIND_COUNT * sizeof(RtCell));
}

void rt_results_clear(RtResults *results) {
    const RtExperiment *e = results->experiment;
    size_t builds = e ? e->workload_count * (e->candidate_count + (size_t)1) : 0;
    for (size_t i = 0; results->cells && i < builds * RT_RAY_KIND_COUNT; i++) {
        rt_free(results->cells[i].each);
        rt_free(results->cells[i].distributions);
    }
    for (size_t i = 0; results->builds && i < builds; i++) rt_free(results->builds[i].leaves);
    rt_free(results->workloads);
    rt_free(results->builds);
    rt_free(results->cells);
    rt_free(results->machines);
    *results = (RtResults){0};
}

uint32_t rt_results_machine(RtResults *results, const RtMachine *machine) {
    uint32_t m = 0;
    for (; m < results->machine_count; m++) {
        const RtMachine *known = &results->machines[m];
        if (strcmp(known->host, machine->host) == 0 && strcmp(known->cpu, machine->cpu) == 0) return m;
    }
    if (m == RT_MAX_MACHINES) return 0;
    results->machines[results->machine_count++] = *machine;
    return m;
}

static size_t build_index(const RtResults *results, uint32_t workload, uint32_t candidate) {
    return (size_t)workload * (results->experiment->candidate_count + 1) + candidate;
}

RtBuildResult *rt_build_at(const RtResults *results, uint32_t workload, uint32_t candidate) {
    return &results->builds[build_index(results, workload, candidate)];
}

RtCell *rt_cell_at(const RtResults *results, uint32_t workload, uint32_t candidate, RtRayKind kind) {
    return &results->cells[build_index(results, workload, candidate) * RT_RAY_KIND_COUNT + (size_t)kind];
}

RtStatus rt_cell_make_rounds(RtCell *cell, RtError *error) {
    rt_free(cell->each);
    cell->each = rt_alloc((size_t)RT_EACH_COUNT * cell->rounds, sizeof(double));
    return cell->each ? RT_OK : rt_fail_memory(error, "the times of rounds", cell->rounds * sizeof(double));
}

double *rt_cell_rounds(const RtCell *cell, RtEach each) {
    return cell->each + (size_t)each * cell->rounds;
}

const char *rt_candidate_label(const RtExperiment *experiment, uint32_t candidate) {
    return candidate < experiment->candidate_count ? experiment->candidates[candidate].label
                                                   : experiment->again;
}

uint64_t rt_results_size(const RtResults *results, uint32_t *scenes) {
    const RtExperiment *experiment = results->experiment;
    uint64_t cells = 0;
    *scenes = 0;
    for (uint32_t t = 0; t < experiment->workload_count; t++) {
        *scenes += results->workloads[t].known;
        for (uint32_t c = 0; c < experiment->candidate_count; c++) {
            for (uint32_t k = 0; k < experiment->kind_count; k++) {
                const RtCell *cell = rt_cell_at(results, t, c, experiment->kinds[k]);
                cells += cell->counted || cell->timed;
            }
        }
    }
    return cells;
}

void rt_null_verdict(const RtResults *results, uint32_t *runs, uint32_t *straddling) {
    *runs = *straddling = 0;
    for (uint32_t t = 0; t < results->experiment->workload_count; t++) {
        for (uint32_t k = 0; k < RT_RAY_KIND_COUNT; k++) {
            const RtCell *cell = rt_cell_at(results, t, results->experiment->candidate_count, (RtRayKind)k);
            *runs += cell->timed;
            *straddling += cell->timed && rt_estimate_holds(&cell->ratio, 1);
        }
    }
}

static bool any_cell_is_broken(const RtResults *results, uint32_t t, uint32_t c) {
    bool broken = rt_build_at(results, t, c)->broken;
    for (int k = 0; k < RT_RAY_KIND_COUNT; k++) broken |= rt_cell_at(results, t, c, (RtRayKind)k)->broken;
    return broken;
}

RtStatus rt_results_check_broken(const RtResults *results, RtError *error) {
    const RtExperiment *e = results->experiment;
    for (uint32_t t = 0; t < e->workload_count; t++) {
        for (uint32_t c = 0; c < e->candidate_count; c++) {
            if (!any_cell_is_broken(results, t, c)) continue;
            return rt_fail(error, RT_BROKEN,
                           "'%s' is broken and left out, at least on %s: see above; `raytally verify --accel "
                           "%s` says more. The others are measured",
                           e->candidates[c].label, e->workloads[t].label, e->candidates[c].spec);
        }
    }
    return RT_OK;
}

void rt_print_limits(const RtResults *results, FILE *out) {
    const RtExperiment *experiment = results->experiment;
    for (uint32_t t = 0; t < experiment->workload_count; t++) {
        for (uint32_t c = 0; c < experiment->candidate_count; c++) {
            const char *scene = experiment->workloads[t].label, *accel = experiment->candidates[c].label;
            const RtBuildResult *build = rt_build_at(results, t, c);
            if (*build->limit) fprintf(out, "Left out: %s on %s: %s\n", accel, scene, build->limit);
            for (uint32_t k = 0; k < RT_RAY_KIND_COUNT; k++) {
                const RtCell *cell = rt_cell_at(results, t, c, (RtRayKind)k);
                if (!*cell->limit) continue;
                fprintf(out, "Left out: %s on %s, %s rays: %s\n", accel, scene,
                        rt_ray_kind_name((RtRayKind)k), cell->limit);
            }
        }
    }
}

double rt_cell_per_ray(const RtResults *results, uint32_t workload, uint32_t candidate, RtRayKind kind,
                       uint64_t counter) {
    const RtCell *cell = rt_cell_at(results, workload, candidate, kind);
    bool known = cell->counted && (counter || rt_build_at(results, workload, candidate)->counts);
    return known ? (double)counter / (double)cell->tally.rays : (double)NAN;
}

bool rt_results_has_kind(const RtResults *results, uint32_t workload, RtRayKind kind) {
    for (uint32_t c = 0; c < results->experiment->candidate_count; c++) {
        const RtCell *cell = rt_cell_at(results, workload, c, kind);
        if (cell->counted || cell->timed) return true;
    }
    return false;
}

/* A weighted mean; NAN as soon as one of its values is. */
typedef struct Mean {
    double sum, weight;
} Mean;

static void add(Mean *mean, double value, double weight) {
    mean->sum += weight * value;
    mean->weight += weight;
}

static double timed(const RtCell *cell, double figure) {
    return cell->timed ? figure : (double)NAN;
}

RtTotal rt_results_total(const RtResults *results, uint32_t workload, uint32_t candidate) {
    const RtExperiment *experiment = results->experiment;
    Mean object_tests = {0}, extent_tests = {0}, steps = {0}, seconds = {0}, baseline = {0}, low = {0},
         high = {0};
    RtTotal total = {.whole = true};
    for (uint32_t k = 0; k < experiment->kind_count; k++) {
        RtRayKind kind = experiment->kinds[k];
        const RtCell *cell = rt_cell_at(results, workload, candidate, kind);
        const RtTally *tally = &cell->tally;
        double weight = (double)results->workloads[workload].rays[kind];
        if (weight == 0) continue;
        total.whole &= rt_results_has_kind(results, workload, kind);
        if (!rt_results_has_kind(results, workload, kind)) continue;
        total.rays += tally->rays;
        add(&object_tests, rt_cell_per_ray(results, workload, candidate, kind, tally->object_tests), weight);
        add(&extent_tests, rt_cell_per_ray(results, workload, candidate, kind, tally->extent_tests), weight);
        add(&steps, rt_cell_per_ray(results, workload, candidate, kind, tally->steps), weight);
        add(&seconds, timed(cell, cell->seconds.median), weight);
        add(&low, timed(cell, cell->seconds.low), weight);
        add(&high, timed(cell, cell->seconds.high), weight);
        add(&baseline, timed(cell, cell->ratio.median * cell->seconds.median), weight);
    }
    /* 0 / 0 is NAN: not known. */
    total.object_tests = object_tests.sum / object_tests.weight;
    total.extent_tests = extent_tests.sum / extent_tests.weight;
    total.steps = steps.sum / steps.weight;
    total.seconds = seconds.sum / seconds.weight;
    total.ratio = baseline.sum / seconds.sum;
    total.seconds_low = low.sum / low.weight;
    total.seconds_high = high.sum / high.weight;
    return total;
}

double rt_results_pay_off(const RtResults *results, uint32_t workload, uint32_t candidate) {
    Mean saved = {0};
    double build = INFINITY;
    if (rt_candidate_is_baseline(results->experiment, candidate)) return (double)NAN;
    for (uint32_t k = 0; k < RT_RAY_KIND_COUNT; k++) {
        const RtCell *cell = rt_cell_at(results, workload, candidate, (RtRayKind)k);
        if (!rt_results_has_kind(results, workload, (RtRayKind)k)) continue;
        if (!cell->timed) return (double)NAN;
        double ray = cell->wall.median;
        add(&saved, (cell->ratio.median - 1) * ray, (double)results->workloads[workload].rays[k]);
        build = fmin(build, rt_build_at(results, workload, cell->baseline)->seconds);
    }
    double more = rt_build_at(results, workload, candidate)->seconds - build, each = saved.sum / saved.weight;
    if (isnan(each)) return (double)NAN;
    if (more <= 0 && each >= 0) return 0;
    return more * each > 0 ? copysign(more / each, each) : (double)INFINITY;
}
