/* SPDX-License-Identifier: Apache-2.0 */
#include "results/paired.h"

#include <math.h>
#include <string.h>

/* Times of rounds, summed over kinds of rays; the second of a pair is unused for a single accelerator. */
typedef struct Sums {
    double over[RT_MAX_ROUNDS], under[RT_MAX_ROUNDS];
    uint32_t rounds; /* the fewest of any kind; 0 before the first */
} Sums;

static const RtCell *timed_cell(const RtResults *results, uint32_t t, uint32_t c, RtRayKind kind) {
    c = rt_results_candidate(results, t, c, kind);
    const RtCell *cell = c == RT_FASTEST_BASELINE ? NULL : rt_cell_at(results, t, c, kind);
    return cell && cell->timed && cell->round_times ? cell : NULL;
}

/* Whether they were timed in the same rounds on the same rays: they have the same times of the baseline. */
static bool are_together(const RtCell *one, const RtCell *other) {
    return one->rounds == other->rounds && one->baseline == other->baseline &&
           memcmp(rt_cell_round_times(one, RT_ROUND_BASELINE), rt_cell_round_times(other, RT_ROUND_BASELINE),
                  one->rounds * sizeof(double)) == 0;
}

static bool add_kind(const RtCell *over, const RtCell *under, double weight, Sums *sums) {
    if (!over || !under || over->baseline != under->baseline) return false;
    const bool together = are_together(over, under);
    const double *a = rt_cell_round_times(over, RT_ROUND_SECONDS),
                 *b = rt_cell_round_times(under, RT_ROUND_SECONDS),
                 *base_a = rt_cell_round_times(over, RT_ROUND_BASELINE),
                 *base_b = rt_cell_round_times(under, RT_ROUND_BASELINE);
    const uint32_t rounds = over->rounds < under->rounds ? over->rounds : under->rounds;
    if (sums->rounds == 0 || rounds < sums->rounds) sums->rounds = rounds;
    for (uint32_t r = 0; r < sums->rounds; r++) {
        sums->over[r] += weight * a[r];
        sums->under[r] += weight * (together ? b[r] : b[r] / base_b[r] * base_a[r]);
    }
    return true;
}

/* Sums over the kinds of rays; false if one of them cannot be paired. */
static bool sum_rounds(const RtResults *results, uint32_t t, uint32_t over, uint32_t under, RtRayKind kind,
                       Sums *sums) {
    const RtExperiment *e = results->experiment;
    double weights = 0;
    *sums = (Sums){.rounds = 0};
    if (kind != RT_ALL_RAYS)
        return add_kind(timed_cell(results, t, over, kind), timed_cell(results, t, under, kind), 1, sums);
    for (uint32_t k = 0; k < e->kind_count; k++) weights += rt_results_weight(results, t, e->kinds[k]);
    for (uint32_t k = 0; k < e->kind_count; k++) {
        const RtRayKind one = e->kinds[k];
        const double weight = rt_results_weight(results, t, one) / weights;
        if (weight > 0 &&
            !add_kind(timed_cell(results, t, over, one), timed_cell(results, t, under, one), weight, sums))
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
    if (over == RT_FASTEST_BASELINE || under == RT_FASTEST_BASELINE) return false;
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

bool rt_candidate_is_compared(const RtExperiment *experiment, uint32_t candidate) {
    return candidate < experiment->candidate_count &&
           strcmp(experiment->candidates[candidate].spec, rt_accel_yardstick()) != 0;
}

static bool is_timed(const RtResults *results, uint32_t t) {
    const RtExperiment *e = results->experiment;
    for (uint32_t c = 0; c <= e->candidate_count; c++) {
        for (uint32_t k = 0; k < e->kind_count; k++) {
            if (rt_cell_at(results, t, c, e->kinds[k])->timed) return true;
        }
    }
    return false;
}

static RtEstimate time_ratio(const RtResults *results, uint32_t t, uint32_t c, uint32_t other,
                             RtRayKind kind) {
    return rt_results_time_ratio(results, t, c, other, kind, rt_coverage_of_each(1));
}

static double tests_of(const RtResults *results, uint32_t t, uint32_t c, RtRayKind kind) {
    return rt_results_cost(results, t, c, kind).object_tests;
}

static bool is_known(bool time, const RtResults *results, uint32_t t, uint32_t c, RtRayKind kind) {
    if (!rt_candidate_is_compared(results->experiment, c)) return false;
    return !isnan(time ? rt_results_cost(results, t, c, kind).seconds.median : tests_of(results, t, c, kind));
}

static bool costs_less(bool time, const RtResults *results, uint32_t t, uint32_t c, uint32_t other,
                       RtRayKind kind) {
    if (time) return time_ratio(results, t, c, other, kind).median < 1;
    return tests_of(results, t, c, kind) < tests_of(results, t, other, kind);
}

RtStanding rt_standing(const RtResults *results, uint32_t workload, uint32_t candidate, RtRayKind kind) {
    return rt_standing_by(is_timed(results, workload), results, workload, candidate, kind);
}

RtStanding rt_standing_by(bool time, const RtResults *results, uint32_t workload, uint32_t candidate,
                          RtRayKind kind) {
    uint32_t best = candidate;
    if (!is_known(time, results, workload, candidate, kind)) return RT_STANDING_BEHIND;
    for (uint32_t c = 0; c < results->experiment->candidate_count; c++) {
        if (c != best && is_known(time, results, workload, c, kind) &&
            costs_less(time, results, workload, c, best, kind))
            best = c;
    }
    if (best == candidate) return RT_STANDING_BEST;
    if (!time) return RT_STANDING_BEHIND;
    return time_ratio(results, workload, candidate, best, kind).low <= 1 ? RT_STANDING_LEVEL
                                                                         : RT_STANDING_BEHIND;
}
