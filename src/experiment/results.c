/* SPDX-License-Identifier: Apache-2.0 */
#include "experiment/results.h"

#include "core/base/memory.h"

#include <math.h>
#include <string.h>

RtStatus rt_results_init(RtResults *results, const RtExperiment *experiment, RtError *error) {
    const size_t builds = experiment->workload_count * ((size_t)experiment->candidate_count + 1);
    *results = (RtResults){.experiment = experiment, .machine_count = 1};
    results->builds = rt_alloc(builds, sizeof(RtBuildResult));
    results->cells = rt_alloc(builds * RT_RAY_KIND_COUNT, sizeof(RtCell));
    if (results->builds && results->cells) return RT_OK;
    return rt_fail_memory(error, "the results", builds * RT_RAY_KIND_COUNT * sizeof(RtCell));
}

void rt_results_clear(RtResults *results) {
    const RtExperiment *e = results->experiment;
    size_t builds = e ? e->workload_count * (e->candidate_count + (size_t)1) : 0;
    for (size_t i = 0; results->cells && i < builds * RT_RAY_KIND_COUNT; i++) {
        rt_free(results->cells[i].round_times);
        rt_free(results->cells[i].distributions);
    }
    for (size_t i = 0; results->builds && i < builds; i++) rt_free(results->builds[i].leaves);
    rt_free(results->builds);
    rt_free(results->cells);
    json_decref(results->first_claims);
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

RtStatus rt_cell_make_round_times(RtCell *cell, RtError *error) {
    rt_free(cell->round_times);
    cell->round_times = rt_alloc((size_t)RT_ROUND_TIME_COUNT * cell->rounds, sizeof(double));
    return cell->round_times ? RT_OK
                             : rt_fail_memory(error, "the times of rounds", cell->rounds * sizeof(double));
}

double *rt_cell_round_times(const RtCell *cell, RtRoundTime which) {
    return cell->round_times + (size_t)which * cell->rounds;
}

uint32_t rt_results_candidate(const RtResults *results, uint32_t workload, uint32_t candidate,
                              RtRayKind kind) {
    if (candidate != RT_FASTEST_BASELINE) return candidate;
    for (uint32_t c = 0; c < results->experiment->candidate_count; c++) {
        const RtCell *cell = rt_cell_at(results, workload, c, kind);
        if (cell->timed) return cell->baseline;
    }
    return RT_FASTEST_BASELINE;
}

const char *rt_candidate_label(const RtExperiment *experiment, uint32_t candidate) {
    if (candidate == RT_FASTEST_BASELINE) return rt_baseline_label(experiment);
    return candidate < experiment->candidate_count ? experiment->candidates[candidate].label
                                                   : experiment->again;
}

bool rt_results_next(const RtResults *results, RtCellCursor *at) {
    const RtExperiment *e = results->experiment;
    const uint32_t i = at->next++;
    at->kind = e->kinds[i % e->kind_count];
    at->candidate = i / e->kind_count % e->candidate_count;
    at->workload = i / e->kind_count / e->candidate_count;
    if (at->workload >= e->workload_count) return false;
    at->cell = rt_cell_at(results, at->workload, at->candidate, at->kind);
    return true;
}

uint64_t rt_results_size(const RtResults *results, uint32_t *scenes) {
    uint64_t cells = 0;
    *scenes = 0;
    for (uint32_t t = 0; t < results->experiment->workload_count; t++) *scenes += results->workloads[t].known;
    for (RtCellCursor at = {0}; rt_results_next(results, &at);) cells += at.cell->counted || at.cell->timed;
    return cells;
}

uint32_t rt_results_rounds(const RtResults *results, uint32_t workload, uint32_t *least) {
    uint32_t most = 0;
    for (uint32_t c = 0; c <= results->experiment->candidate_count; c++) {
        for (uint32_t k = 0; k < results->experiment->kind_count; k++) {
            const RtCell *cell = rt_cell_at(results, workload, c, results->experiment->kinds[k]);
            if (!cell->timed) continue;
            *least = most == 0 || cell->rounds < *least ? cell->rounds : *least;
            most = cell->rounds > most ? cell->rounds : most;
        }
    }
    return most;
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

RtStatus rt_results_check_broken(const RtResults *results, RtError *error) {
    const RtExperiment *e = results->experiment;
    for (RtCellCursor at = {0}; rt_results_next(results, &at);) {
        if (!at.cell->broken && !rt_build_at(results, at.workload, at.candidate)->broken) continue;
        return rt_fail(error, RT_BROKEN,
                       "'%s' is broken and left out, at least on %s: see above; `raytally verify --accel %s` "
                       "says more. All other accelerators were measured",
                       e->candidates[at.candidate].label, e->workloads[at.workload].label,
                       e->candidates[at.candidate].spec);
    }
    return RT_OK;
}

void rt_print_left_out(const RtResults *results, FILE *out) {
    const RtExperiment *e = results->experiment;
    for (RtCellCursor at = {0}; rt_results_next(results, &at);) {
        const char *scene = e->workloads[at.workload].label, *accel = e->candidates[at.candidate].label;
        const RtBuildResult *build = rt_build_at(results, at.workload, at.candidate);
        if (*build->left_out && at.kind == e->kinds[0])
            fprintf(out, "Left out: %s on %s: %s\n", accel, scene, build->left_out);
        if (*at.cell->left_out)
            fprintf(out, "Left out: %s on %s, %s rays: %s\n", accel, scene, rt_ray_kind_name(at.kind),
                    at.cell->left_out);
    }
}

bool rt_results_has_kind(const RtResults *results, uint32_t workload, RtRayKind kind) {
    for (uint32_t c = 0; c < results->experiment->candidate_count; c++) {
        const RtCell *cell = rt_cell_at(results, workload, c, kind);
        if (cell->counted || cell->timed) return true;
    }
    return false;
}

/* A count per ray. Unknown if nothing was counted, or if the counter stayed at 0 in an accelerator that does
 * not count everything (Embree's own boxes). */
static double per_ray(const RtCell *cell, const RtBuildResult *build, uint64_t counter) {
    bool known = cell->counted && (counter || build->counts);
    return known ? (double)counter / (double)cell->tally.rays : (double)NAN;
}

static RtCost cost_of_cell(const RtResults *results, uint32_t workload, uint32_t candidate, RtRayKind kind) {
    const double unknown = (double)NAN;
    const RtEstimate none = rt_estimate_exactly(unknown);
    candidate = rt_results_candidate(results, workload, candidate, kind);
    if (candidate == RT_FASTEST_BASELINE)
        return (RtCost){true, 0, unknown, unknown, unknown, unknown, none, none};
    const RtBuildResult *build = rt_build_at(results, workload, candidate);
    const RtCell *cell = rt_cell_at(results, workload, candidate, kind);
    return (RtCost){.whole = true,
                    .rays = cell->tally.rays,
                    .object_tests = per_ray(cell, build, cell->tally.object_tests),
                    .extent_tests = per_ray(cell, build, cell->tally.extent_tests),
                    .steps = per_ray(cell, build, cell->tally.steps),
                    .csg_tests = per_ray(cell, build, cell->tally.csg_tests),
                    .seconds = cell->timed ? cell->seconds : none,
                    .ratio = cell->timed ? cell->ratio : none};
}

RtCost rt_results_cost(const RtResults *results, uint32_t workload, uint32_t candidate, RtRayKind kind) {
    const RtExperiment *experiment = results->experiment;
    const double unknown = (double)NAN;
    double weights = 0, baseline = 0;
    RtCost sum = {.whole = true, .seconds.least = unknown};
    if (kind != RT_ALL_RAYS) return cost_of_cell(results, workload, candidate, kind);
    for (uint32_t k = 0; k < experiment->kind_count; k++) {
        const RtCost cost = cost_of_cell(results, workload, candidate, experiment->kinds[k]);
        const double weight = (double)results->workloads[workload].rays[experiment->kinds[k]];
        if (weight == 0) continue;
        const bool measured = rt_results_has_kind(results, workload, experiment->kinds[k]);
        sum.whole &= measured;
        if (!measured) continue;
        weights += weight;
        sum.rays += cost.rays;
        sum.object_tests += weight * cost.object_tests;
        sum.extent_tests += weight * cost.extent_tests;
        sum.steps += weight * cost.steps;
        sum.csg_tests += weight * cost.csg_tests;
        sum.seconds.median += weight * cost.seconds.median;
        sum.seconds.low += weight * cost.seconds.low;
        sum.seconds.high += weight * cost.seconds.high;
        baseline += weight * (cost.ratio.median * cost.seconds.median);
    }
    sum.ratio = (RtEstimate){baseline / sum.seconds.median, unknown, unknown, unknown};
    sum.object_tests /= weights; /* 0 / 0 is NAN: unknown */
    sum.extent_tests /= weights;
    sum.steps /= weights;
    sum.csg_tests /= weights;
    sum.seconds.median /= weights;
    sum.seconds.low /= weights;
    sum.seconds.high /= weights;
    return sum;
}

/* Rays that save as much time as the build takes more, both above 0; else none or any. */
static double rays_from(double more, double saved) {
    return more <= 0 ? 0 : saved <= 0 ? INFINITY : more / saved;
}

/* Rays that lose as much time as the build takes less. */
static double rays_up_to(double more, double saved) {
    return more >= 0 ? 0 : saved >= 0 ? INFINITY : more / saved;
}

/* `more`: seconds that the build takes more than the baseline's; `saved`: seconds that a ray takes less. */
static void set_rays(RtBreakEven *even, const RtEstimate *more, const RtEstimate *saved) {
    even->up_to = saved->high < 0 || (saved->low <= 0 && more->median < 0);
    if (even->up_to) {
        even->rays.median = rays_up_to(more->median, saved->median);
        even->rays.low = rays_up_to(more->high, saved->low);
        even->rays.high = rays_up_to(more->low, saved->high);
    } else {
        even->rays.median = rays_from(more->median, saved->median);
        even->rays.low = rays_from(more->low, saved->high);
        even->rays.high = rays_from(more->high, saved->low);
    }
}

/* Adds the seconds that a ray of the cell takes less than the baseline's, to the weighted sums. */
static void add_saved(RtEstimate *saved, const RtCell *cell, double weight) {
    const RtEstimate *ratio = &cell->ratio, *wall = &cell->wall;
    saved->median += weight * (ratio->median - 1) * wall->median;
    saved->low += weight * (ratio->low - 1) * (ratio->low > 1 ? wall->low : wall->high);
    saved->high += weight * (ratio->high - 1) * (ratio->high > 1 ? wall->high : wall->low);
}

RtBreakEven rt_results_break_even(const RtResults *results, uint32_t workload, uint32_t candidate) {
    const double unknown = (double)NAN;
    const RtBuildResult *own = rt_build_at(results, workload, candidate), *baseline = NULL;
    RtBreakEven even = {.rays = rt_estimate_exactly(unknown)};
    RtEstimate saved = {0};
    double weights = 0;
    if (rt_candidate_is_baseline(results->experiment, candidate)) return even;
    for (uint32_t k = 0; k < RT_RAY_KIND_COUNT; k++) {
        const RtCell *cell = rt_cell_at(results, workload, candidate, (RtRayKind)k);
        const double weight = (double)results->workloads[workload].rays[k];
        if (!rt_results_has_kind(results, workload, (RtRayKind)k)) continue;
        if (!cell->timed) return even;
        add_saved(&saved, cell, weight);
        weights += weight;
        const RtBuildResult *build = rt_build_at(results, workload, cell->baseline);
        if (!baseline || build->seconds.median < baseline->seconds.median) baseline = build;
    }
    if (!(weights > 0)) return even;
    saved = (RtEstimate){saved.median / weights, saved.low / weights, saved.high / weights, unknown};
    const RtEstimate *a = &own->seconds, *b = &baseline->seconds,
                     more = {a->median - b->median, a->low - b->high, a->high - b->low, unknown};
    set_rays(&even, &more, &saved);
    even.builds = own->builds < baseline->builds ? own->builds : baseline->builds;
    return even;
}
