/* SPDX-License-Identifier: Apache-2.0 */
/* Timing: all candidates of a workload against each other on the rays of one kind. */
#include "core/base/clock.h"
#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "measure/machine.h"
#include "run/workload_state.h"

#include <math.h>
#include <string.h>

/* Each candidate is timed on its share, and the baseline on every thinned share, so that ratios compare times
 * on the same rays. */
typedef struct TimingRun {
    RtWorkloadState *workload;
    RtRayKind kind;
    uint32_t count;
    uint32_t rounds, most; /* done, and most */
    double start;          /* wall seconds */
    RtTimed *timed;        /* [count] */
    double *seconds;       /* [count][2][most] of `timed` */
    bool *broken;          /* [count] */
    uint32_t *candidates;  /* [count] */
    RtArena memory;        /* of these */
    RtRandom random;
    double credit[RT_MAX_MEASURED];           /* [workload->count] seconds that may be spent on building */
    uint32_t renewed;                         /* rounds after which that was done */
    uint32_t structures[RT_MAX_MEASURED];     /* [workload->count] timed so far */
    uint32_t place[RT_MAX_MEASURED];          /* [workload->count] index of a candidate in `timed` */
    bool has_baseline;                        /* it did not refuse the scene */
    uint32_t baseline_entry[RT_MAX_MEASURED]; /* [workload->count] that of the baseline on its rays */
} TimingRun;

static uint32_t enter(TimingRun *run, uint32_t candidate, const RtRaySet *set) {
    double *place = run->seconds + 2 * (size_t)run->count * run->most;
    run->candidates[run->count] = candidate;
    run->timed[run->count] = (RtTimed){.accel = run->workload->accels[candidate],
                                       .set = set,
                                       .seconds = place,
                                       .wall = place + run->most,
                                       .broken = &run->broken[run->count]};
    return run->count++;
}

/* The baseline on the rays of `candidate`; the null run is compared with the setting that it repeats. */
static uint32_t baseline_of(const RtWorkloadState *workload, uint32_t candidate, RtRayKind kind) {
    const RtExperiment *experiment = workload->experiment;
    if (candidate == experiment->candidate_count) return rt_candidate_built(experiment, candidate);
    return rt_results_candidate(workload->results, workload->index, experiment->baseline, kind);
}

/* Makes room for `most` entries of so many rounds. Clear its memory also after a failure. */
static RtStatus timing_run_init(TimingRun *run, RtWorkloadState *workload, RtRayKind kind, uint32_t most,
                                uint32_t rounds, RtError *error) {
    *run = (TimingRun){.workload = workload,
                       .kind = kind,
                       .most = rounds,
                       .start = rt_wall_seconds(),
                       .random = rt_random(workload->experiment->seed, 2 + (uint64_t)kind)};
    run->timed = rt_arena_alloc(&run->memory, most, sizeof(RtTimed));
    run->seconds = rt_arena_alloc(&run->memory, 2 * (size_t)most * rounds, sizeof(double));
    run->broken = rt_arena_alloc(&run->memory, most, sizeof(bool));
    run->candidates = rt_arena_alloc(&run->memory, most, sizeof(uint32_t));
    return rt_arena_check(&run->memory, "times", error);
}

static void enter_all(TimingRun *run) {
    const RtWorkloadState *workload = run->workload;
    for (uint32_t c = 0; c < workload->count; c++) {
        run->structures[c] = 1;
        if (workload->accels[c]) run->place[c] = enter(run, c, &workload->shares[c].set);
    }
    run->has_baseline = workload->accels[baseline_of(workload, 0, run->kind)] != NULL;
    for (uint32_t c = 0; c < workload->count && run->has_baseline; c++) {
        const uint32_t baseline = baseline_of(workload, c, run->kind);
        run->baseline_entry[c] = run->place[baseline];
        if (workload->accels[c] && rt_workload_setup(workload, c)->ray_stride > 1)
            run->baseline_entry[c] = enter(run, baseline, &workload->shares[c].set);
    }
}

/* ---- structures built anew ---- */

/* Earns what the last round of tracing took, but at least RT_RENEWAL_BUDGET, for building. So building takes
 * no more time than tracing where that takes long; structures that take longer to build stay for some rounds.
 */
static void earn(TimingRun *run) {
    const uint32_t round = run->renewed++;
    for (uint32_t c = 0; c < run->workload->count; c++) {
        const RtTimed *own = &run->timed[run->place[c]];
        const double traced = own->wall[round] * (double)own->set->count * own->repeats;
        run->credit[c] += fmax(RT_RENEWAL_BUDGET, traced);
    }
}

static RtStatus build_one(TimingRun *run, uint32_t c, RtError *error) {
    RtWorkloadState *workload = run->workload;
    const double start = rt_wall_seconds();
    const RtStatus status = rt_workload_build_elsewhere(workload, c, run->kind, &run->random, error);
    run->credit[c] -= rt_wall_seconds() - start;
    run->structures[c]++;
    workload->accels[c] = workload->built[c];
    return status == RT_BROKEN ? rt_workload_break(workload, c, run->kind, error) : status;
}

/* First destroys all that are renewed, so that each may get the place of any of them. */
static RtStatus renew(void *context, RtTimed *timed, size_t count, RtError *error) {
    TimingRun *run = context;
    RtWorkloadState *workload = run->workload;
    size_t order[RT_MAX_MEASURED], renewed = 0;
    earn(run);
    for (uint32_t c = 0; c < workload->count; c++) {
        const double once = rt_build_at(workload->results, workload->index, c)->seconds.median;
        if (!workload->accels[c] || run->broken[run->place[c]] || run->credit[c] < once) continue;
        order[renewed++] = c;
        rt_workload_destroy(workload, c);
    }
    rt_random_shuffle(&run->random, order, renewed);
    for (size_t i = 0; i < renewed; i++) RT_TRY(build_one(run, (uint32_t)order[i], error));
    for (size_t i = 0; i < count; i++) timed[i].accel = workload->accels[run->candidates[i]];
    return RT_OK;
}

/* ---- until the intervals are narrow ---- */

/* The width of the widest interval of a ratio (rt_estimate_width), and whose it is. */
static double widest_of(const TimingRun *run, uint32_t *candidate) {
    double widest = 0;
    *candidate = 0;
    for (uint32_t c = 0; c < run->workload->count && run->has_baseline; c++) {
        if (!run->workload->accels[c] || run->broken[run->place[c]]) continue;
        const RtTimed *baseline = &run->timed[run->baseline_entry[c]];
        RtEstimate ratio =
            rt_estimate_ratio(baseline->seconds, run->timed[run->place[c]].seconds, run->rounds);
        double width = rt_estimate_width(&ratio);
        if (!(width > widest)) continue; /* nor is an unknown one */
        widest = width;
        *candidate = c;
    }
    return widest;
}

/* Stopping as soon as intervals are narrow favours those that are narrow by chance; still, as they narrow,
 * their coverage tends to the nominal one (Chow & Robbins 1965, "On the Asymptotic Theory of Fixed-Width
 * Sequential Confidence Intervals for the Mean", Annals of Mathematical Statistics 36(2)). */
static bool is_enough(void *context, uint32_t rounds) {
    TimingRun *run = context;
    const RtWorkloadOptions *options = run->workload->options;
    uint32_t candidate;
    run->rounds = rounds;
    return rt_wall_seconds() - run->start > options->patience || widest_of(run, &candidate) <= options->until;
}

static void report_width(const TimingRun *run) {
    const RtWorkloadState *workload = run->workload;
    uint32_t candidate;
    double width = widest_of(run, &candidate);
    if (workload->options->until <= 0 || width <= workload->options->until) return;
    rt_notify(
        &workload->options->observer,
        "%s rays on %s: after %u rounds in %.0f s the intervals are within %.2g %%, not within %.2g %%; "
        "the widest is that of %s",
        rt_experiment_kind_name(workload->experiment, run->kind),
        workload->experiment->workloads[workload->index].label, run->rounds, rt_wall_seconds() - run->start,
        100 * width, 100 * workload->options->until, rt_candidate_label(workload->experiment, candidate));
}

/* ---- timing ---- */

/* The times of the baseline, and the ratio to them; NAN without a baseline. */
static void compare_times(const TimingRun *run, uint32_t c, RtCell *cell) {
    const RtTimed *own = &run->timed[run->place[c]];
    double *times = rt_cell_round_times(cell, RT_ROUND_BASELINE);
    cell->ratio = rt_estimate_exactly((double)NAN);
    cell->baseline = baseline_of(run->workload, c, run->kind);
    for (uint32_t r = 0; r < run->rounds; r++) times[r] = (double)NAN;
    if (!run->has_baseline) return;
    const RtTimed *baseline = &run->timed[run->baseline_entry[c]];
    memcpy(times, baseline->seconds, run->rounds * sizeof(double));
    cell->ratio = rt_estimate_ratio(baseline->seconds, own->seconds, run->rounds);
}

/* ---- rays that are learnt ---- */

/* Sets as large are not learnt, and rounds of one pass have other accelerators' rays between them. */
static bool may_learn(const RtTimed *timed) {
    for (const RtAccel *layer = timed->accel; layer; layer = layer->below) {
        if (layer->ops->learn || layer->ops->remote) return false; /* it knows the rays; it is elsewhere */
    }
    return timed->set->count < RT_LEARNABLE_RAYS && timed->repeats > 1;
}

static RtStatus check_learning(TimingRun *run, RtError *error) {
    RtWorkloadState *workload = run->workload;
    for (uint32_t c = 0; c < workload->count; c++) {
        RtCell *cell = rt_cell_at(workload->results, workload->index, c, run->kind);
        const RtRaySet *others = &workload->others[run->kind];
        if (!workload->accels[c] || cell->timed) continue;
        cell->learnt = (double)NAN;
        if (!may_learn(&run->timed[run->place[c]]) || others->count == 0 || run->broken[run->place[c]])
            continue;
        RT_TRY(rt_measure_learning(workload->accels[c], &workload->shares[c].set, others,
                                   run->timed[run->place[c]].repeats, &cell->learnt, error));
    }
    return RT_OK;
}

/* ---- what is kept ---- */

static RtStatus keep_times(RtWorkloadState *workload, RtRayKind kind, const TimingRun *run, RtError *error) {
    const RtMachine here = rt_machine_here();
    uint32_t rounds = run->rounds, machine = rt_results_machine(workload->results, &here);
    for (uint32_t c = 0; c < workload->count; c++) {
        RtCell *cell = rt_cell_at(workload->results, workload->index, c, kind);
        if (!workload->accels[c] || cell->timed) continue;
        const RtTimed *own = &run->timed[run->place[c]];
        cell->rounds = rounds;
        cell->repeats = own->repeats;
        cell->structures = run->structures[c];
        RT_TRY(rt_cell_make_round_times(cell, error));
        memcpy(rt_cell_round_times(cell, RT_ROUND_SECONDS), own->seconds, rounds * sizeof(double));
        memcpy(rt_cell_round_times(cell, RT_ROUND_WALL), own->wall, rounds * sizeof(double));
        cell->timed = true;
        cell->threads = rt_thread_count(workload->options->timing);
        cell->machine = machine;
        cell->tally.rays = own->set->count;
        cell->seconds = rt_estimate(own->seconds, rounds);
        cell->wall = rt_estimate(own->wall, rounds);
        compare_times(run, c, cell);
        RT_TRY(rt_workload_tell(workload, RT_EVENT_TIME, c, kind, error));
    }
    return RT_OK;
}

/* Excludes candidates that broke on any rays; the baseline may have broken on another's share. */
static RtStatus exclude_broken(RtWorkloadState *workload, RtRayKind kind, RtError *error) {
    for (uint32_t c = 0; c < workload->count; c++) {
        const RtAccel *accel = workload->accels[c];
        if (!accel || rt_accel_check(accel, error) == RT_OK) continue;
        RT_TRY(rt_workload_break(workload, c, kind, error));
    }
    return RT_OK;
}

RtStatus rt_workload_time(RtWorkloadState *workload, RtRayKind kind, RtError *error) {
    const RtExperiment *experiment = workload->experiment;
    TimingRun run;
    const uint32_t rounds = workload->options->until > 0 ? RT_MAX_ROUNDS : experiment->rounds;
    RtStatus status = timing_run_init(&run, workload, kind, 2 * workload->count, rounds, error);
    RtTiming timing = {.rounds = {.rounds = experiment->rounds,
                                  .most = run.most,
                                  .least = 1e-3 * experiment->milliseconds,
                                  .seed = experiment->seed + (uint64_t)kind,
                                  .enough = is_enough,
                                  .context = &run},
                       .renew = renew,
                       .threads = workload->options->timing};
    if (status == RT_OK) enter_all(&run);
    if (status == RT_OK) status = rt_measure_time(run.timed, run.count, &timing, &run.rounds, error);
    if (status == RT_OK) status = exclude_broken(workload, kind, error);
    if (status == RT_OK) report_width(&run);
    if (status == RT_OK) status = check_learning(&run, error);
    if (status == RT_OK) status = keep_times(workload, kind, &run, error);
    rt_arena_clear(&run.memory);
    return status;
}

/* ---- the best of several ---- */

/* Rounds and seconds that choose among settings; with six rounds an interval spans all of them. */
enum { CHOICE_ROUNDS = 6 };
static const double choice_seconds = 5e-3;

/* Chooses among the members of a best-of by their times on `set`: the fastest by the median of paired ratios;
 * but the default, if the interval of its ratio to that contains 1. */
static uint32_t choose_fastest(const TimingRun *run) {
    uint32_t best = 0;
    for (uint32_t i = 1; i < run->count; i++) {
        if (run->broken[i]) continue;
        const RtEstimate gain =
            rt_estimate_ratio(run->timed[best].seconds, run->timed[i].seconds, run->rounds);
        if (run->broken[best] || gain.median > 1) best = i;
    }
    if (run->broken[0]) return run->candidates[best];
    const RtEstimate gain = rt_estimate_ratio(run->timed[0].seconds, run->timed[best].seconds, run->rounds);
    return run->candidates[gain.low > 1 ? best : 0];
}

static RtStatus choose(RtWorkloadState *workload, uint32_t best, RtRayKind kind, RtError *error) {
    const RtCandidate *candidate = &workload->experiment->candidates[best];
    RtCell *cell = rt_cell_at(workload->results, workload->index, best, kind);
    TimingRun run;
    RT_OWNED(RtRaySet, set, rt_rayset_clear);
    RT_TRY(rt_rayset_limit(&workload->others[kind], 1 + RT_CHOICE_RAYS / candidate->ray_stride,
                           workload->experiment->coherent_run, &set, error));
    RtStatus status = timing_run_init(&run, workload, kind, candidate->member_count, CHOICE_ROUNDS, error);
    for (uint32_t i = 0; status == RT_OK && i < candidate->member_count; i++) {
        if (workload->accels[candidate->members[i]]) enter(&run, candidate->members[i], &set);
    }
    RtTiming timing = {.rounds = {.rounds = CHOICE_ROUNDS,
                                  .most = CHOICE_ROUNDS,
                                  .least = choice_seconds,
                                  .seed = workload->experiment->seed + (uint64_t)kind},
                       .threads = workload->options->timing};
    if (status == RT_OK && run.count > 1 && set.count > 0)
        status = rt_measure_time(run.timed, run.count, &timing, &run.rounds, error);
    if (status == RT_OK && run.count > 0) {
        cell->chosen = true;
        cell->choice = run.rounds > 0 ? choose_fastest(&run) : run.candidates[0];
        status = rt_workload_tell(workload, RT_EVENT_CHOICE, best, kind, error);
    }
    rt_arena_clear(&run.memory);
    return status;
}

RtStatus rt_workload_choose(RtWorkloadState *workload, RtRayKind kind, RtError *error) {
    for (uint32_t c = 0; c < workload->experiment->candidate_count; c++) {
        const bool best = workload->experiment->candidates[c].member_count > 0;
        if (best && !rt_cell_at(workload->results, workload->index, c, kind)->chosen)
            RT_TRY(choose(workload, c, kind, error));
    }
    for (uint32_t c = 0; c < workload->count; c++) {
        if (!rt_results_times(workload->results, workload->index, c, kind)) workload->accels[c] = NULL;
    }
    return RT_OK;
}
