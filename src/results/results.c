/* SPDX-License-Identifier: Apache-2.0 */
#include "results/results.h"

#include "core/base/memory.h"
#include "experiment/claim.h"

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
    const RtCell *cell = rt_cell_at(results, workload, candidate, kind);
    return cell->chosen ? cell->choice : candidate;
}

bool rt_results_times(const RtResults *results, uint32_t workload, uint32_t candidate, RtRayKind kind) {
    const RtExperiment *e = results->experiment;
    if (candidate >= e->candidate_count || !e->candidates[candidate].tried) return true;
    if (candidate == rt_candidate_built(e, e->candidate_count)) return true;
    for (uint32_t best = 0; best < e->candidate_count; best++) {
        const RtCell *cell = rt_cell_at(results, workload, best, kind);
        if (cell->chosen && cell->choice == candidate) return true;
    }
    return false;
}

bool rt_cell_is_learnt(const RtCell *cell) {
    return cell->timed && cell->learnt > RT_LEARNT;
}

const char *rt_candidate_label(const RtExperiment *experiment, uint32_t candidate) {
    return candidate < experiment->candidate_count ? experiment->candidates[candidate].label
                                                   : experiment->again;
}

void rt_candidate_show(const RtExperiment *experiment, uint32_t candidate, char out[RT_MAX_SHOWN]) {
    const bool null = candidate == experiment->candidate_count;
    snprintf(out, RT_MAX_SHOWN, "%s%s",
             experiment->candidates[rt_candidate_built(experiment, candidate)].shown, null ? " (again)" : "");
}

bool rt_results_next(const RtResults *results, RtCellCursor *at) {
    const RtExperiment *e = results->experiment;
    uint32_t i = at->next++;
    while (e->candidates[i / e->kind_count % e->candidate_count].member_count > 0) i = at->next++;
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

void rt_results_leave_out(RtResults *results, uint32_t workload, uint32_t candidate, const char *why,
                          bool refused, bool broken) {
    const RtExperiment *e = results->experiment;
    RtBuildResult *build = rt_build_at(results, workload, candidate);
    snprintf(build->left_out, sizeof build->left_out, "%s", why);
    build->refused = refused;
    build->broken = broken;
    rt_spec_format(&e->candidates[rt_candidate_built(e, candidate)].parsed, build->spec);
}

bool rt_results_refused(const RtResults *results, uint32_t workload, uint32_t candidate) {
    const RtCandidate *best = &results->experiment->candidates[candidate];
    bool all = best->member_count > 0 || rt_build_at(results, workload, candidate)->refused;
    for (uint32_t i = 0; i < best->member_count; i++)
        all &= rt_build_at(results, workload, best->members[i])->refused;
    return all;
}

/* The first reason, if all accelerators of all known scenes refused them; NULL if not. */
static const char *refused_by_all(const RtResults *results) {
    const char *why = NULL;
    for (RtCellCursor at = {0}; rt_results_next(results, &at);) {
        const RtBuildResult *build = rt_build_at(results, at.workload, at.candidate);
        if (!results->workloads[at.workload].known ||
            !rt_candidate_runs(results->experiment, at.candidate, at.workload))
            continue;
        if (!build->refused) return NULL;
        why = why ? why : build->left_out;
    }
    return why;
}

RtStatus rt_results_check(const RtResults *results, RtError *error) {
    const RtExperiment *e = results->experiment;
    const char *why = refused_by_all(results);
    if (why)
        return rt_fail(error, RT_BAD_INPUT, "every accelerator refuses %s: %s",
                       e->workload_count == 1 ? "the scene" : "every scene; the first", why);
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
            fprintf(out, "%s: %s on %s: %s\n", build->refused ? "Refused" : "Left out", accel, scene,
                    build->left_out);
        if (*at.cell->left_out)
            fprintf(out, "Left out: %s on %s, %s rays: %s\n", accel, scene, rt_ray_kind_name(at.kind),
                    at.cell->left_out);
    }
}

/* Whether any candidate was measured on the workload's rays of that kind. */
static bool has_kind(const RtResults *results, uint32_t workload, RtRayKind kind) {
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

/* The seconds that a ray of the cell takes less than the baseline's. */
static RtEstimate saved_by(const RtCell *cell) {
    const RtEstimate *ratio = &cell->ratio, *wall = &cell->wall;
    return (RtEstimate){.median = (ratio->median - 1) * wall->median,
                        .low = (ratio->low - 1) * (ratio->low > 1 ? wall->low : wall->high),
                        .high = (ratio->high - 1) * (ratio->high > 1 ? wall->high : wall->low)};
}

static RtCost cost_of_cell(const RtResults *results, uint32_t workload, uint32_t candidate, RtRayKind kind) {
    const RtEstimate none = rt_estimate_exactly((double)NAN);
    const uint32_t c = rt_results_candidate(results, workload, candidate, kind);
    const RtBuildResult *build = rt_build_at(results, workload, c);
    const RtCell *cell = rt_cell_at(results, workload, c, kind);
    return (RtCost){.whole = true,
                    .rays = cell->tally.rays,
                    .weight = 1,
#define PER_RAY(name) .name = per_ray(cell, build, cell->tally.name),
                    RT_COST_COUNTERS(PER_RAY)
#undef PER_RAY
                        .seconds = cell->timed ? cell->seconds : none,
                    .saved = cell->timed ? saved_by(cell) : none,
                    .ratio = cell->timed ? cell->ratio : none};
}

double rt_results_weight(const RtResults *results, uint32_t workload, RtRayKind kind) {
    const RtWorkloadResult *w = &results->workloads[workload];
    return (double)(w->rays[kind] && w->whole_rays[kind] ? w->whole_rays[kind] : w->rays[kind]);
}

static void add_weighed(RtEstimate *sum, const RtEstimate *estimate, double weight) {
    sum->median += weight * estimate->median;
    sum->low += weight * estimate->low;
    sum->high += weight * estimate->high;
}

RtCost rt_results_total(const RtResults *results, uint32_t workload, uint32_t candidate, RtKinds kinds) {
    const double unknown = (double)NAN;
    double baseline = 0;
    RtCost sum = {.whole = true, .seconds.least = unknown, .saved.least = unknown};
    for (int k = 0; k < RT_RAY_KIND_COUNT; k++) {
        const double weight = rt_results_weight(results, workload, (RtRayKind)k);
        if (weight == 0 || !(kinds >> k & 1)) continue;
        const bool measured = has_kind(results, workload, (RtRayKind)k);
        sum.whole &= measured;
        if (!measured) continue;
        const RtCost cost = cost_of_cell(results, workload, candidate, (RtRayKind)k);
        sum.weight += weight;
        sum.rays += cost.rays;
#define ADD(name) sum.name += weight * cost.name;
        RT_COST_COUNTERS(ADD)
#undef ADD
        add_weighed(&sum.seconds, &cost.seconds, weight);
        add_weighed(&sum.saved, &cost.saved, weight);
        baseline += weight * (cost.ratio.median * cost.seconds.median);
    }
    sum.ratio = (RtEstimate){baseline / sum.seconds.median, unknown, unknown, unknown};
    return sum;
}

RtKinds rt_experiment_kinds(const RtExperiment *experiment) {
    RtKinds kinds = 0;
    for (uint32_t k = 0; k < experiment->kind_count; k++) kinds |= 1u << experiment->kinds[k];
    return kinds;
}

RtCost rt_results_cost(const RtResults *results, uint32_t workload, uint32_t candidate, RtRayKind kind) {
    if (kind != RT_ALL_RAYS) return cost_of_cell(results, workload, candidate, kind);
    RtCost mean = rt_results_total(results, workload, candidate, rt_experiment_kinds(results->experiment));
#define DIVIDE(name) mean.name /= mean.weight; /* 0 / 0 is NAN: unknown */
    RT_COST_COUNTERS(DIVIDE)
#undef DIVIDE
    RtEstimate *const estimates[] = {&mean.seconds, &mean.saved};
    for (int i = 0; i < 2; i++) {
        estimates[i]->median /= mean.weight;
        estimates[i]->low /= mean.weight;
        estimates[i]->high /= mean.weight;
    }
    return mean;
}

void rt_results_say_part(const RtResults *results, uint32_t workloads, RtKinds kinds,
                         char out[RT_MAX_PART_TEXT]) {
    double rays = 0, whole = 0;
    bool known = true;
    for (uint32_t t = 0; t < results->experiment->workload_count; t++) {
        const RtWorkloadResult *w = &results->workloads[t];
        for (int k = 0; k < RT_RAY_KIND_COUNT; k++) {
            if (!(workloads >> t & 1) || !(kinds >> k & 1)) continue;
            known &= w->rays[k] == 0 || w->whole_rays[k] > 0;
            const double weight = rt_results_weight(results, t, (RtRayKind)k);
            rays += fmin((double)w->rays[k], weight); /* there may be more random ones */
            whole += weight;
        }
    }
    if (known)
        snprintf(out, RT_MAX_PART_TEXT, "of %.0f rays, %.0f measured", whole, rays);
    else
        snprintf(out, RT_MAX_PART_TEXT, "of the measured part");
}

/* Rays that save as much time as the build takes more, both above 0; else none or any. */
static double rays_from(double more, double saved) {
    return more <= 0 ? 0 : saved <= 0 ? INFINITY : more / saved;
}

static RtEstimate negated(RtEstimate e) {
    return (RtEstimate){-e.median, -e.high, -e.low, (double)NAN};
}

/* `more`: seconds that the build takes more than the baseline's; `saved`: seconds that a ray takes less. Up
 * to so many rays lose as much time as the build takes less. */
static void set_rays(RtBreakEven *even, RtEstimate more, RtEstimate saved) {
    even->up_to = saved.high < 0 || (saved.low <= 0 && more.median < 0);
    if (even->up_to) {
        more = negated(more);
        saved = negated(saved);
    }
    even->rays.median = rays_from(more.median, saved.median);
    even->rays.low = rays_from(more.low, saved.high);
    even->rays.high = rays_from(more.high, saved.low);
}

RtBreakEven rt_results_break_even(const RtResults *results, uint32_t workload, uint32_t candidate) {
    const double unknown = (double)NAN;
    const RtBuildResult *own = rt_build_at(results, workload, candidate), *baseline = NULL;
    RtBreakEven even = {.rays = rt_estimate_exactly(unknown)};
    const RtEstimate saved = rt_results_cost(results, workload, candidate, RT_ALL_RAYS).saved;
    if (rt_candidate_is_baseline(results->experiment, candidate) || !own->known || isnan(saved.median))
        return even;
    for (uint32_t k = 0; k < RT_RAY_KIND_COUNT; k++) {
        const RtCell *cell = rt_cell_at(results, workload, candidate, (RtRayKind)k);
        if (!cell->timed) continue;
        const RtBuildResult *build = rt_build_at(results, workload, cell->baseline);
        const uint32_t threads = (uint32_t)cell->threads;
        if (own->threads != threads || build->threads != threads) return even;
        if (!baseline || build->seconds.median < baseline->seconds.median) baseline = build;
    }
    const RtEstimate *a = &own->seconds, *b = &baseline->seconds,
                     more = {a->median - b->median, a->low - b->high, a->high - b->low, unknown};
    set_rays(&even, more, saved);
    even.builds = own->builds < baseline->builds ? own->builds : baseline->builds;
    return even;
}

/* ---- paired times ---- */

/* Times of rounds, summed over kinds of rays; the second of a pair is unused for a single accelerator. */
typedef struct Sums {
    double over[RT_MAX_ROUNDS], under[RT_MAX_ROUNDS];
    uint32_t rounds; /* the fewest of any kind; 0 before the first */
} Sums;

static const RtCell *timed_cell(const RtResults *results, uint32_t t, uint32_t c, RtRayKind kind) {
    const RtCell *cell = rt_cell_at(results, t, rt_results_candidate(results, t, c, kind), kind);
    return cell->timed && cell->round_times ? cell : NULL;
}

/* Whether they were timed in the same rounds on the same rays: they have the same times of the baseline. */
static bool are_together(const RtCell *one, const RtCell *other) {
    return one->rounds == other->rounds && one->baseline == other->baseline &&
           memcmp(rt_cell_round_times(one, RT_ROUND_BASELINE), rt_cell_round_times(other, RT_ROUND_BASELINE),
                  one->rounds * sizeof(double)) == 0;
}

/* Times of other rounds are scaled by the baseline's; of other rays only if their kind is `alone`: in a sum
 * it would weigh what the baseline took on the few rays of a thinned set. */
static bool add_kind(const RtCell *over, const RtCell *under, double weight, bool alone, Sums *sums) {
    if (!over || !under || over->baseline != under->baseline) return false;
    const bool as_they_are = are_together(over, under) || (!alone && over->tally.rays != under->tally.rays);
    const double *a = rt_cell_round_times(over, RT_ROUND_SECONDS),
                 *b = rt_cell_round_times(under, RT_ROUND_SECONDS),
                 *base_a = rt_cell_round_times(over, RT_ROUND_BASELINE),
                 *base_b = rt_cell_round_times(under, RT_ROUND_BASELINE);
    const uint32_t rounds = over->rounds < under->rounds ? over->rounds : under->rounds;
    if (sums->rounds == 0 || rounds < sums->rounds) sums->rounds = rounds;
    for (uint32_t r = 0; r < sums->rounds; r++) {
        sums->over[r] += weight * a[r];
        sums->under[r] += weight * (as_they_are ? b[r] : b[r] / base_b[r] * base_a[r]);
    }
    return true;
}

/* Sums over the kinds of rays; false if one of them cannot be paired. */
static bool sum_rounds(const RtResults *results, uint32_t t, uint32_t over, uint32_t under, RtRayKind kind,
                       Sums *sums) {
    const RtExperiment *e = results->experiment;
    const bool alone = kind != RT_ALL_RAYS;
    double weights = 0;
    *sums = (Sums){.rounds = 0};
    for (uint32_t k = 0; k < e->kind_count; k++) weights += rt_results_weight(results, t, e->kinds[k]);
    for (uint32_t k = 0; k < e->kind_count; k++) {
        const RtRayKind one = e->kinds[k];
        const double weight = alone ? one == kind : rt_results_weight(results, t, one) / weights;
        if (weight > 0 && !add_kind(timed_cell(results, t, over, one), timed_cell(results, t, under, one),
                                    weight, alone, sums))
            return false;
    }
    return sums->rounds > 0;
}

RtEstimate rt_results_time(const RtResults *results, uint32_t workload, uint32_t candidate, RtRayKind kind,
                           double coverage) {
    Sums sums;
    if (sum_rounds(results, workload, candidate, candidate, kind, &sums))
        return rt_estimate_covering(sums.over, sums.rounds, coverage);
    const RtCost cost = rt_results_cost(results, workload, candidate, kind);
    return cost.whole ? cost.seconds : rt_estimate_exactly((double)NAN);
}

/* What the journal has of a cell and its baseline without the times of rounds. */
static bool kept_ratio(const RtResults *results, uint32_t t, uint32_t over, uint32_t under, RtRayKind kind,
                       RtEstimate *ratio) {
    if (kind == RT_ALL_RAYS) return false;
    over = rt_results_candidate(results, t, over, kind);
    under = rt_results_candidate(results, t, under, kind);
    const RtCell *own = rt_cell_at(results, t, over, kind), *its = rt_cell_at(results, t, under, kind);
    if (!own->timed || !its->timed) return false;
    *ratio = its->ratio;
    if (own->baseline == under)
        *ratio = (RtEstimate){.median = 1 / own->ratio.median,
                              .low = 1 / own->ratio.high,
                              .high = 1 / own->ratio.low,
                              .least = (double)NAN};
    return (own->baseline == under || its->baseline == over) && ratio->median > 0 && isfinite(ratio->median);
}

RtEstimate rt_results_time_ratio(const RtResults *results, uint32_t workload, uint32_t over, uint32_t under,
                                 RtRayKind kind, double coverage) {
    Sums sums;
    RtEstimate kept;
    if (sum_rounds(results, workload, over, under, kind, &sums)) {
        for (uint32_t r = 0; r < sums.rounds; r++) sums.over[r] /= sums.under[r];
        return rt_estimate_covering(sums.over, sums.rounds, coverage);
    }
    if (kept_ratio(results, workload, over, under, kind, &kept)) return kept;
    const RtEstimate a = rt_results_time(results, workload, over, kind, coverage),
                     b = rt_results_time(results, workload, under, kind, coverage);
    if (over == under) return rt_estimate_exactly(a.median / a.median);
    return (RtEstimate){a.median / b.median, a.low / b.high, a.high / b.low, (double)NAN};
}

/* ---- the best ---- */

/* What candidates are compared by; NAN if it is unknown. */
static double compared_cost(bool time, const RtResults *results, uint32_t t, uint32_t c, RtRayKind kind) {
    const RtExperiment *e = results->experiment;
    if (c >= e->candidate_count || e->candidates[c].tried ||
        strcmp(e->candidates[c].spec, rt_accel_yardstick()) == 0)
        return (double)NAN;
    const RtCost cost = rt_results_cost(results, t, c, kind);
    return time ? cost.seconds.median : cost.object_tests;
}

RtStanding rt_standing(const RtResults *results, uint32_t workload, uint32_t candidate, RtRayKind kind) {
    uint32_t least;
    const bool timed = rt_results_rounds(results, workload, &least) > 0;
    return rt_standing_by(timed, results, workload, candidate, kind);
}

RtStanding rt_standing_by(bool time, const RtResults *results, uint32_t workload, uint32_t candidate,
                          RtRayKind kind) {
    const double coverage = rt_coverage_of_each(1);
    uint32_t best = candidate;
    double least = compared_cost(time, results, workload, candidate, kind);
    if (isnan(least)) return RT_STANDING_BEHIND;
    for (uint32_t c = 0; c < results->experiment->candidate_count; c++) {
        const double cost = compared_cost(time, results, workload, c, kind);
        if (c == best || isnan(cost)) continue;
        const bool less = time ? rt_results_time_ratio(results, workload, c, best, kind, coverage).median < 1
                               : cost < least;
        best = less ? c : best;
        least = less ? cost : least;
    }
    if (best == candidate) return RT_STANDING_BEST;
    if (!time) return RT_STANDING_BEHIND;
    return rt_results_time_ratio(results, workload, candidate, best, kind, coverage).low <= 1
               ? RT_STANDING_LEVEL
               : RT_STANDING_BEHIND;
}

/* ---- claims that changed ---- */

json_t *rt_claims_json(const RtExperiment *experiment) {
    json_t *list = json_array();
    for (uint32_t i = 0; i < experiment->claim_count; i++)
        json_array_append_new(list, json_string(experiment->claims[i]));
    return list;
}

/* A claim that cannot be parsed any more, because what it names is gone, is none. */
static bool is_readout(const RtExperiment *experiment, const char *text) {
    RtClaim claim;
    return rt_claim_parse(experiment, text, &claim, NULL) == RT_OK && claim.readout;
}

bool rt_claim_is_later(const RtResults *results, uint32_t i) {
    const char *claim = results->experiment->claims[i];
    const json_t *first;
    size_t k;
    if (!results->first_claims || is_readout(results->experiment, claim)) return false;
    json_array_foreach(results->first_claims, k, first) {
        const char *text = json_string_value(first);
        if (text && strcmp(text, claim) == 0) return false;
    }
    return true;
}

json_t *rt_claims_dropped(const RtResults *results) {
    const RtExperiment *experiment = results->experiment;
    json_t *dropped = json_array();
    for (size_t k = 0; k < json_array_size(results->first_claims); k++) {
        const char *text = json_string_value(json_array_get(results->first_claims, k));
        uint32_t i = 0;
        while (text && i < experiment->claim_count && strcmp(experiment->claims[i], text) != 0) i++;
        if (!text || i < experiment->claim_count || is_readout(experiment, text)) continue;
        json_array_append_new(dropped, json_string(text));
    }
    return dropped;
}

bool rt_claims_are_changed(const RtResults *results) {
    json_t *dropped = rt_claims_dropped(results);
    bool any = json_array_size(dropped) > 0;
    json_decref(dropped);
    for (uint32_t i = 0; i < results->experiment->claim_count; i++) any |= rt_claim_is_later(results, i);
    return any;
}
