/* SPDX-License-Identifier: Apache-2.0 */
#include "experiment/standing.h"

#include "accel/accel.h"

#include <math.h>
#include <string.h>

/* Of a ray: its median and the ends of its interval; NAN where it was not measured. */
typedef struct Cost {
    double median, low, high;
} Cost;

static Cost exact(double value) {
    return (Cost){value, value, value};
}

static Cost cost_of(const RtResults *results, uint32_t t, uint32_t c, RtRayKind kind, bool timed) {
    if (kind == RT_RAY_KIND_COUNT) {
        const RtTotal total = rt_results_total(results, t, c);
        return timed ? (Cost){total.seconds, total.seconds_low, total.seconds_high}
                     : exact(total.object_tests);
    }
    const RtCell *cell = rt_cell_at(results, t, c, kind);
    if (!timed) return exact(rt_cell_per_ray(results, t, c, kind, cell->tally.object_tests));
    return cell->timed ? (Cost){cell->seconds.median, cell->seconds.low, cell->seconds.high} : exact(NAN);
}

static bool takes_part(const RtExperiment *experiment, uint32_t candidate) {
    return candidate < experiment->candidate_count &&
           strcmp(experiment->candidates[candidate].spec, rt_accel_yardstick()) != 0;
}

static bool is_timed(const RtResults *results, uint32_t t) {
    for (uint32_t c = 0; c < results->experiment->candidate_count; c++) {
        for (uint32_t k = 0; k < RT_RAY_KIND_COUNT; k++) {
            if (rt_cell_at(results, t, c, (RtRayKind)k)->timed) return true;
        }
    }
    return false;
}

RtStanding rt_standing(const RtResults *results, uint32_t workload, uint32_t candidate, RtRayKind kind) {
    const RtExperiment *experiment = results->experiment;
    if (!takes_part(experiment, candidate)) return RT_STANDING_BEHIND;
    const bool timed = is_timed(results, workload);
    const Cost own = cost_of(results, workload, candidate, kind, timed);
    Cost best = {INFINITY, INFINITY, INFINITY};
    for (uint32_t c = 0; c < experiment->candidate_count; c++) {
        const Cost cost = cost_of(results, workload, c, kind, timed);
        if (takes_part(experiment, c) && cost.median < best.median) best = cost;
    }
    if (own.median == best.median) return RT_STANDING_BEST; /* not of NAN */
    return own.low <= best.high ? RT_STANDING_LEVEL : RT_STANDING_BEHIND;
}
