/* SPDX-License-Identifier: Apache-2.0 */
/* The timing of one kind of rays in a workload. */
#include "base/memory.h"
#include "base/parallel.h"
#include "bench/machine.h"
#include "bench/workload_state.h"

#include <math.h>

/* All that is timed against each other: each candidate on its share, and the baseline (all that it is the
 * best of) on every share that is thinned, so that a ratio compares times on the same rays. */
typedef struct Contest {
    uint32_t count, rounds;
    RtTimed *timed;  /* [count] */
    double *seconds; /* [count][2][rounds], where they go */
    uint32_t *place; /* [workload->count] of a candidate among them */
    uint32_t *rival; /* [workload->count] of the first candidate of the baseline on its rays; others follow */
} Contest;

static uint32_t enter(Contest *contest, const RtAccel *accel, const RtRaySet *set) {
    double *place = contest->seconds + 2 * (size_t)contest->count * contest->rounds;
    contest->timed[contest->count] = (RtTimed){accel, set, place, place + contest->rounds};
    return contest->count++;
}

/* Clear it also after a failure. */
static RtStatus contest_init(Contest *contest, const RtWorkloadState *workload, RtError *error) {
    const uint32_t baseline = workload->experiment->baseline, rivals = workload->experiment->baseline_count;
    size_t most = (1 + (size_t)rivals) * workload->count, doubles = 2 * most * workload->experiment->rounds;
    *contest = (Contest){.rounds = workload->experiment->rounds,
                         .timed = rt_alloc(most, sizeof(RtTimed)),
                         .seconds = rt_alloc(doubles, sizeof(double)),
                         .place = rt_alloc(workload->count, sizeof(uint32_t)),
                         .rival = rt_alloc(workload->count, sizeof(uint32_t))};
    if (!contest->timed || !contest->seconds || !contest->place || !contest->rival) {
        return rt_fail_memory(error, "times", doubles * sizeof(double));
    }
    for (uint32_t c = 0; c < workload->count; c++) {
        if (workload->accels[c])
            contest->place[c] = enter(contest, workload->accels[c], &workload->shares[c].set);
    }
    for (uint32_t c = 0; c < workload->count; c++) {
        contest->rival[c] = contest->place[baseline];
        if (!workload->accels[c] || rt_workload_ray_stride(workload, c) == 1) continue;
        contest->rival[c] = contest->count;
        for (uint32_t i = 0; i < rivals; i++) {
            enter(contest, workload->accels[baseline + i], &workload->shares[c].set);
        }
    }
    return RT_OK;
}

static void contest_clear(Contest *contest) {
    rt_free(contest->timed);
    rt_free(contest->seconds);
    rt_free(contest->place);
    rt_free(contest->rival);
}

/* The median of what part number `i` of rivals[0..count) has of the time that all of them take in a round:
 * paired as ratios are, so that a drift does not decide. */
static double part_of_round(const RtTimed *rivals, uint32_t count, uint32_t i, uint32_t rounds) {
    double part[RT_MAX_ROUNDS];
    for (uint32_t r = 0; r < rounds; r++) {
        double all = 0;
        for (uint32_t k = 0; k < count; k++) all += rivals[k].seconds[r];
        part[r] = rivals[i].seconds[r] / all;
    }
    return rt_median(part, rounds);
}

/* Which of the baseline's candidates is the fastest on the rays of `candidate`. To pick it by the times that
 * ratios are then made of favours the baseline, if anyone. The null run is compared with what it repeats. */
static uint32_t pick_rival(const RtWorkloadState *workload, const Contest *contest, uint32_t candidate) {
    const RtExperiment *experiment = workload->experiment;
    const RtTimed *rivals = &contest->timed[contest->rival[candidate]];
    uint32_t best = 0, count = experiment->baseline_count;
    if (candidate == experiment->candidate_count) return 0;
    double least = INFINITY;
    for (uint32_t i = 0; i < count; i++) {
        double part = part_of_round(rivals, count, i, contest->rounds);
        if (part < least) {
            least = part;
            best = i;
        }
    }
    return best;
}

/* Takes what was timed into the cells. */
static RtStatus keep_times(RtWorkloadState *workload, RtRayKind kind, const Contest *contest,
                           RtError *error) {
    const RtMachine here = rt_machine_here();
    uint32_t rounds = contest->rounds, machine = rt_results_machine(workload->results, &here);
    for (uint32_t c = 0; c < workload->count; c++) {
        RtCell *cell = rt_cell_at(workload->results, workload->index, c, kind);
        if (!workload->accels[c] || cell->timed) continue;
        uint32_t best = pick_rival(workload, contest, c);
        const RtTimed *own = &contest->timed[contest->place[c]];
        const RtTimed *rival = &contest->timed[contest->rival[c] + best];
        cell->timed = true;
        cell->rounds = rounds;
        cell->threads = rt_thread_count(workload->options->timing);
        cell->machine = machine;
        cell->tally.rays = own->set->count;
        cell->seconds = rt_estimate(own->seconds, rounds);
        cell->wall = rt_estimate(own->wall, rounds);
        cell->ratio = rt_estimate_ratio(rival->seconds, own->seconds, rounds);
        cell->baseline = workload->experiment->baseline + best;
        RT_TRY(rt_workload_tell(workload, RT_EVENT_TIME, c, kind, error));
    }
    return RT_OK;
}

RtStatus rt_workload_time(RtWorkloadState *workload, RtRayKind kind, RtError *error) {
    const RtExperiment *experiment = workload->experiment;
    RtTiming timing = {.rounds = experiment->rounds,
                       .least = 1e-3 * experiment->milliseconds,
                       .threads = workload->options->timing,
                       .seed = experiment->seed + (uint64_t)kind};
    Contest contest;
    RtStatus status = contest_init(&contest, workload, error);
    if (status == RT_OK) status = rt_measure_time(contest.timed, contest.count, &timing, error);
    if (status == RT_OK) status = keep_times(workload, kind, &contest, error);
    contest_clear(&contest);
    return status;
}
