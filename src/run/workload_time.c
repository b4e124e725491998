/* SPDX-License-Identifier: Apache-2.0 */
/* Timing: all candidates of a workload against each other on the rays of one kind. */
#include "core/base/clock.h"
#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "measure/machine.h"
#include "run/workload_state.h"

#include <math.h>
#include <string.h>

/* Each candidate is timed on its share, and the baseline (with all settings of a best-of) on every thinned
 * share, so that ratios compare times on the same rays. */
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
    double credit[RT_MAX_MEASURED];       /* [workload->count] seconds that may be spent on building */
    uint32_t renewed;                     /* rounds after which that was done */
    uint32_t structures[RT_MAX_MEASURED]; /* [workload->count] timed so far */
    uint32_t place[RT_MAX_MEASURED];      /* [workload->count] index of a candidate in `timed` */
    uint32_t baselines[RT_MAX_CANDIDATES],
        baseline_count; /* those that did not refuse the scene; may be none */
    /* [workload->count] of the first candidate of the baseline on its rays; others follow */
    uint32_t baseline_entry[RT_MAX_MEASURED];
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

/* Clear its memory also after a failure. */
static RtStatus timing_run_init(TimingRun *run, RtWorkloadState *workload, RtRayKind kind, RtError *error) {
    const uint32_t baselines = workload->experiment->baseline_count;
    const uint32_t rounds = workload->options->until > 0 ? RT_MAX_ROUNDS : workload->experiment->rounds;
    size_t most = (1 + (size_t)baselines) * workload->count, doubles = 2 * most * rounds;
    *run = (TimingRun){.workload = workload,
                       .kind = kind,
                       .most = rounds,
                       .start = rt_wall_seconds(),
                       .random = rt_random(workload->experiment->seed, 2 + (uint64_t)kind)};
    run->timed = rt_arena_alloc(&run->memory, most, sizeof(RtTimed));
    run->seconds = rt_arena_alloc(&run->memory, doubles, sizeof(double));
    run->broken = rt_arena_alloc(&run->memory, most, sizeof(bool));
    run->candidates = rt_arena_alloc(&run->memory, most, sizeof(uint32_t));
    RT_TRY(rt_arena_check(&run->memory, "times", error));
    for (uint32_t c = 0; c < workload->count; c++) {
        run->structures[c] = 1;
        if (workload->accels[c]) run->place[c] = enter(run, c, &workload->shares[c].set);
    }
    for (uint32_t i = 0; i < baselines; i++) {
        const uint32_t c = workload->experiment->baseline + i;
        if (workload->accels[c]) run->baselines[run->baseline_count++] = c;
    }
    for (uint32_t c = 0; c < workload->count && run->baseline_count > 0; c++) {
        run->baseline_entry[c] = run->place[run->baselines[0]];
        if (!workload->accels[c] || rt_workload_setup(workload, c)->ray_stride == 1) continue;
        run->baseline_entry[c] = run->count;
        for (uint32_t i = 0; i < run->baseline_count; i++)
            enter(run, run->baselines[i], &workload->shares[c].set);
    }
    return RT_OK;
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

/* The median part of baselines[i] in the time that baselines[0..count) take in a round: paired, as ratios
 * are, so that drift cancels. */
static double part_of_round(const RtTimed *baselines, uint32_t count, uint32_t i, uint32_t rounds) {
    double part[RT_MAX_ROUNDS];
    for (uint32_t r = 0; r < rounds; r++) {
        double all = 0;
        for (uint32_t k = 0; k < count; k++) all += baselines[k].seconds[r];
        part[r] = baselines[i].seconds[r] / all;
    }
    return rt_median(part, rounds);
}

/* The baseline's fastest setting on the rays of `candidate`. Choosing it by the same times as the ratios can
 * only favour the baseline. The null run is compared with the setting that it repeats. */
static uint32_t pick_baseline(const TimingRun *run, uint32_t candidate) {
    const RtExperiment *experiment = run->workload->experiment;
    const RtTimed *baselines = &run->timed[run->baseline_entry[candidate]];
    uint32_t best = 0, count = run->baseline_count;
    if (candidate == experiment->candidate_count) return 0;
    double least = INFINITY;
    for (uint32_t i = 0; i < count; i++) {
        double part = part_of_round(baselines, count, i, run->rounds);
        if (part < least) {
            least = part;
            best = i;
        }
    }
    return best;
}

/* ---- until the intervals are narrow ---- */

/* The width of the widest interval of a ratio (rt_estimate_width), and whose it is. */
static double widest_of(const TimingRun *run, uint32_t *candidate) {
    double widest = 0;
    *candidate = 0;
    for (uint32_t c = 0; c < run->workload->count && run->baseline_count > 0; c++) {
        if (!run->workload->accels[c] || run->broken[run->place[c]]) continue;
        const RtTimed *baseline = &run->timed[run->baseline_entry[c] + pick_baseline(run, c)];
        RtEstimate ratio =
            rt_estimate_ratio(baseline->seconds, run->timed[run->place[c]].seconds, run->rounds);
        double width = rt_estimate_width(&ratio);
        if (width <= widest) continue;
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
    cell->baseline = run->workload->experiment->baseline;
    for (uint32_t r = 0; r < run->rounds; r++) times[r] = (double)NAN;
    if (run->baseline_count == 0) return;
    const uint32_t best = pick_baseline(run, c);
    const RtTimed *baseline = &run->timed[run->baseline_entry[c] + best];
    memcpy(times, baseline->seconds, run->rounds * sizeof(double));
    cell->ratio = rt_estimate_ratio(baseline->seconds, own->seconds, run->rounds);
    cell->baseline = run->baselines[best];
}

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
    RtStatus status = timing_run_init(&run, workload, kind, error);
    RtTiming timing = {.rounds = {.rounds = experiment->rounds,
                                  .most = run.most,
                                  .least = 1e-3 * experiment->milliseconds,
                                  .seed = experiment->seed + (uint64_t)kind,
                                  .enough = is_enough,
                                  .context = &run},
                       .renew = renew,
                       .threads = workload->options->timing};
    if (status == RT_OK) status = rt_measure_time(run.timed, run.count, &timing, &run.rounds, error);
    if (status == RT_OK) status = exclude_broken(workload, kind, error);
    if (status == RT_OK) report_width(&run);
    if (status == RT_OK) status = keep_times(workload, kind, &run, error);
    rt_arena_clear(&run.memory);
    return status;
}
