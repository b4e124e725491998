/* SPDX-License-Identifier: Apache-2.0 */
/* Hardware counters of the rays of a workload: separate interleaved rounds after the timed ones, so that
 * counting changes no time. */
#include "core/base/parallel.h"
#include "measure/machine.h"
#include "run/workload_state.h"

#include <math.h>

enum { ROUNDS = 5 }; /* of which medians are taken; the counts differ little */

typedef struct TimingRun {
    RtHardware hardware;
    RtRunner runners[RT_MAX_CANDIDATES];                /* [count] */
    RtHardwareCounts counts[RT_MAX_CANDIDATES][ROUNDS]; /* [count] per ray */
    bool broken[RT_MAX_CANDIDATES];                     /* [count] */
    uint32_t count;
} TimingRun;

static RtStatus run_counted(TimingRun *run, uint32_t i, int round, RtError *error) {
    const RtRunner *runner = &run->runners[i];
    RtHardwareCounts *counts = &run->counts[i][round];
    RtStatus status = RT_OK;
    if (runner->count) {
        status = runner->count(runner->context, runner->repeats, counts, error);
    } else {
        RtHardwareStart start = rt_hardware_start(&run->hardware);
        for (uint32_t k = 0; k < runner->repeats && status == RT_OK; k++)
            status = runner->run(runner->context, error);
        *counts = rt_hardware_stop(&run->hardware, &start);
    }
    for (int e = 0; e < RT_HARDWARE_COUNT; e++) counts->of[e] /= runner->repeats * runner->work;
    return status;
}

/* A plugin that breaks is skipped from then on. */
static RtStatus skip_broken(TimingRun *run, uint32_t i, RtStatus status) {
    run->broken[i] |= status == RT_BROKEN;
    return status == RT_BROKEN ? RT_OK : status;
}

static RtStatus run_rounds(TimingRun *run, double least, RtError *error) {
    for (uint32_t i = 0; i < run->count; i++) {
        double seconds = 1, wall;
        if (run->broken[i]) continue;
        RtStatus status = rt_runner_time(&run->runners[i], 1, &seconds, &wall, error); /* also warms up */
        RT_TRY(skip_broken(run, i, status));
        run->runners[i].repeats = rt_runner_repeats(seconds, least);
    }
    for (int round = 0; round < ROUNDS; round++) {
        for (uint32_t i = 0; i < run->count; i++) {
            if (!run->broken[i]) RT_TRY(skip_broken(run, i, run_counted(run, i, round, error)));
        }
    }
    return RT_OK;
}

/* Medians of the rounds; unknown if not counted in every round. */
static RtHardwareCounts median_of(const RtHardwareCounts counts[ROUNDS]) {
    RtHardwareCounts median = {.running = 1};
    for (int e = 0; e < RT_HARDWARE_COUNT; e++) {
        double values[ROUNDS], sum = 0;
        for (int r = 0; r < ROUNDS; r++) sum += values[r] = counts[r].of[e];
        median.of[e] = isnan(sum) ? (double)NAN : rt_median(values, ROUNDS);
    }
    for (int r = 0; r < ROUNDS; r++) median.running = fmin(median.running, counts[r].running);
    return median;
}

/* The counters of a remote accelerator are those of its own process. */
static RtStatus count_all(RtWorkloadState *workload, RtRayKind kind, TimingRun *run,
                          const RtHardwareEvent *events, RtError *error) {
    const uint32_t candidates = workload->experiment->candidate_count;
    RtStatus status = RT_OK;
    for (uint32_t c = 0; c < candidates && status == RT_OK; c++) {
        RtTimed timed = {.accel = workload->accels[c], .set = &workload->shares[c].set, .events = events};
        if (!timed.accel) continue;
        const uint32_t i = run->count++;
        status = rt_runner_open(&run->runners[i], &timed, workload->options->timing, error);
        status = skip_broken(run, i, status);
    }
    if (status == RT_OK) status = run_rounds(run, 1e-3 * workload->experiment->milliseconds, error);
    for (uint32_t c = 0, i = 0; c < candidates && status == RT_OK; c++) {
        if (!workload->accels[c]) continue;
        RtCell *cell = rt_cell_at(workload->results, workload->index, c, kind);
        cell->hardware.counts = median_of(run->counts[i++]);
    }
    for (uint32_t i = 0; i < run->count; i++) rt_runner_close(&run->runners[i]);
    return status == RT_OK ? rt_workload_exclude_broken(workload, kind, error) : status;
}

/* Counts, or records the reason why nothing can be counted. */
RtStatus rt_workload_hardware(RtWorkloadState *workload, RtRayKind kind, RtError *error) {
    const RtMachine here = rt_machine_here();
    const RtHardwareEvent *events =
        workload->options->events ? workload->options->events : rt_hardware_events;
    RtError why = {RT_OK, ""};
    TimingRun run = {.count = 0};
    bool available = rt_hardware_open(&run.hardware, events, &why) == RT_OK;
    RtStatus status = available ? count_all(workload, kind, &run, events, error) : RT_OK;
    rt_hardware_close(&run.hardware);
    for (uint32_t c = 0; c < workload->experiment->candidate_count && status == RT_OK; c++) {
        RtCellHardware *hardware = &rt_cell_at(workload->results, workload->index, c, kind)->hardware;
        if (!workload->accels[c] || hardware->known) continue;
        hardware->known = true;
        hardware->threads = rt_thread_count(workload->options->timing);
        hardware->machine = rt_results_machine(workload->results, &here);
        snprintf(hardware->why, sizeof hardware->why, "%.*s", RT_MAX_WHY - 1, available ? "" : why.message);
        for (int e = 0; e < RT_HARDWARE_COUNT && !available; e++) hardware->counts.of[e] = (double)NAN;
        status = rt_workload_tell(workload, RT_EVENT_HARDWARE, c, kind, error);
    }
    return status;
}
