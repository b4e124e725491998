/* SPDX-License-Identifier: Apache-2.0 */
/* The timing of one kind of rays in a workload. */
#include "core/base/clock.h"
#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "experiment/workload_state.h"
#include "measure/machine.h"

#include <math.h>
#include <string.h>

/* All that is timed against each other: each candidate on its share, and the baseline (all that it is the
 * best of) on every share that is thinned, so that a ratio compares times on the same rays. */
typedef struct Contest {
    const RtWorkloadState *workload;
    RtRayKind kind;
    uint32_t count;
    uint32_t rounds, most; /* done, and as many as there is room for */
    double start;          /* wall seconds */
    RtTimed *timed;        /* [count] */
    double *seconds;       /* [count][2][most], where they go */
    bool *broken;          /* [count] */
    uint32_t *place;       /* [workload->count] of a candidate among them */
    uint32_t *rival; /* [workload->count] of the first candidate of the baseline on its rays; others follow */
} Contest;

static uint32_t enter(Contest *contest, const RtAccel *accel, const RtRaySet *set) {
    double *place = contest->seconds + 2 * (size_t)contest->count * contest->most;
    contest->timed[contest->count] =
        (RtTimed){accel, set, place, place + contest->most, &contest->broken[contest->count]};
    return contest->count++;
}

/* Clear it also after a failure. */
static RtStatus contest_init(Contest *contest, const RtWorkloadState *workload, RtRayKind kind,
                             RtError *error) {
    const uint32_t baseline = workload->experiment->baseline, rivals = workload->experiment->baseline_count;
    const uint32_t rounds = workload->options->until > 0 ? RT_MAX_ROUNDS : workload->experiment->rounds;
    size_t most = (1 + (size_t)rivals) * workload->count, doubles = 2 * most * rounds;
    *contest = (Contest){.workload = workload,
                         .kind = kind,
                         .most = rounds,
                         .start = rt_wall_seconds(),
                         .timed = rt_alloc(most, sizeof(RtTimed)),
                         .seconds = rt_alloc(doubles, sizeof(double)),
                         .broken = rt_alloc(most, sizeof(bool)),
                         .place = rt_alloc(workload->count, sizeof(uint32_t)),
                         .rival = rt_alloc(workload->count, sizeof(uint32_t))};
    if (!contest->timed || !contest->seconds || !contest->broken || !contest->place || !contest->rival) {
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
    rt_free(contest->broken);
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
static uint32_t pick_rival(const Contest *contest, uint32_t candidate) {
    const RtExperiment *experiment = contest->workload->experiment;
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

/* ---- until the intervals are narrow ---- */

/* Which candidate's ratio has the widest interval, and how wide that is (rt_estimate_width). */
static double widest_of(const Contest *contest, uint32_t *candidate) {
    double widest = 0;
    *candidate = 0;
    for (uint32_t c = 0; c < contest->workload->count; c++) {
        if (!contest->workload->accels[c] || contest->broken[contest->place[c]]) continue;
        const RtTimed *rival = &contest->timed[contest->rival[c] + pick_rival(contest, c)];
        RtEstimate ratio =
            rt_estimate_ratio(rival->seconds, contest->timed[contest->place[c]].seconds, contest->rounds);
        double width = rt_estimate_width(&ratio);
        if (width <= widest) continue;
        widest = width;
        *candidate = c;
    }
    return widest;
}

/* To stop as soon as intervals are narrow favours those that are so by chance; as they narrow, their coverage
 * still tends to what they promise (Chow & Robbins 1965, "On the Asymptotic Theory of Fixed-Width Sequential
 * Confidence Intervals for the Mean", Annals of Mathematical Statistics 36(2)). */
static bool is_enough(void *context, uint32_t rounds) {
    Contest *contest = context;
    const RtWorkloadOptions *options = contest->workload->options;
    uint32_t candidate;
    contest->rounds = rounds;
    return rt_wall_seconds() - contest->start > options->patience ||
           widest_of(contest, &candidate) <= options->until;
}

/* Says so where time or rounds were over before. */
static void tell_width(const Contest *contest) {
    const RtWorkloadState *workload = contest->workload;
    const RtObserver *observer = &workload->options->observer;
    char message[RT_MAX_LABEL * 3 + 160];
    uint32_t candidate;
    double width = widest_of(contest, &candidate);
    if (workload->options->until <= 0 || width <= workload->options->until || !observer->notice) return;
    snprintf(message, sizeof message,
             "%s rays on %s: after %u rounds in %.0f s intervals are within %.2g %%, not %.2g %%; the widest "
             "is that of "
             "%s",
             rt_experiment_kind_name(workload->experiment, contest->kind),
             workload->experiment->workloads[workload->index].label, contest->rounds,
             rt_wall_seconds() - contest->start, 100 * width, 100 * workload->options->until,
             rt_candidate_label(workload->experiment, candidate));
    observer->notice(observer->context, message);
}

/* ---- all of it ---- */

/* Leaves out those that broke on any of the rays: a baseline may have broken on those of another's share. */
static RtStatus leave_out_broken(RtWorkloadState *workload, RtRayKind kind, RtError *error) {
    for (uint32_t c = 0; c < workload->count; c++) {
        const RtAccel *accel = workload->accels[c];
        if (!accel || rt_accel_check(accel, error) == RT_OK) continue;
        RT_TRY(rt_workload_break(workload, c, kind, error));
    }
    return RT_OK;
}

/* Takes what was timed into the cells. */
static RtStatus keep_times(RtWorkloadState *workload, RtRayKind kind, const Contest *contest,
                           RtError *error) {
    const RtMachine here = rt_machine_here();
    uint32_t rounds = contest->rounds, machine = rt_results_machine(workload->results, &here);
    for (uint32_t c = 0; c < workload->count; c++) {
        RtCell *cell = rt_cell_at(workload->results, workload->index, c, kind);
        if (!workload->accels[c] || cell->timed) continue;
        uint32_t best = pick_rival(contest, c);
        const RtTimed *own = &contest->timed[contest->place[c]];
        const RtTimed *rival = &contest->timed[contest->rival[c] + best];
        cell->rounds = rounds;
        RT_TRY(rt_cell_make_rounds(cell, error));
        memcpy(rt_cell_rounds(cell, RT_EACH_SECONDS), own->seconds, rounds * sizeof(double));
        memcpy(rt_cell_rounds(cell, RT_EACH_WALL), own->wall, rounds * sizeof(double));
        memcpy(rt_cell_rounds(cell, RT_EACH_BASELINE), rival->seconds, rounds * sizeof(double));
        cell->timed = true;
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
    Contest contest;
    RtStatus status = contest_init(&contest, workload, kind, error);
    RtTiming timing = {.rounds = {.rounds = experiment->rounds,
                                  .most = contest.most,
                                  .least = 1e-3 * experiment->milliseconds,
                                  .seed = experiment->seed + (uint64_t)kind,
                                  .enough = is_enough,
                                  .context = &contest},
                       .threads = workload->options->timing};
    if (status == RT_OK)
        status = rt_measure_time(contest.timed, contest.count, &timing, &contest.rounds, error);
    if (status == RT_OK) status = leave_out_broken(workload, kind, error);
    if (status == RT_OK) tell_width(&contest);
    if (status == RT_OK) status = keep_times(workload, kind, &contest, error);
    contest_clear(&contest);
    return status;
}
