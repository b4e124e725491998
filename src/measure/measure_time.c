/* SPDX-License-Identifier: Apache-2.0 */
/* Timing accelerators against each other, wherever they live. */
#include "accel/remote.h"
#include "core/base/memory.h"
#include "measure/measure_local.h"
#include "measure/measure_remote.h"

RtStatus rt_runner_open(RtRunner *runner, const RtTimed *timed, int threads, RtError *error) {
    bool away = rt_accel_is_remote(timed->accel);
    return away ? rt_runner_open_away(runner, timed, threads, error)
                : rt_runner_open_here(runner, timed, threads, error);
}

void rt_runner_close(RtRunner *runner) {
    if (runner->time) {
        rt_runner_close_away(runner);
    } else {
        rt_runner_close_here(runner);
    }
}

RtStatus rt_measure_time(const RtTimed *timed, size_t count, const RtTiming *timing, uint32_t *done,
                         RtError *error) {
    RtRunner *runners = rt_alloc(count, sizeof(RtRunner));
    if (!runners) return rt_fail_memory(error, "the rounds", count * sizeof(RtRunner));
    RtStatus status = RT_OK;
    for (size_t i = 0; status == RT_OK && i < count; i++) {
        status = rt_runner_open(&runners[i], &timed[i], timing->threads, error);
        if (status != RT_BROKEN || !timed[i].broken) continue;
        *timed[i].broken = true;
        status = RT_OK;
    }
    if (status == RT_OK) status = rt_rounds_run(runners, count, &timing->rounds, done, error);
    for (size_t i = 0; i < count; i++) rt_runner_close(&runners[i]);
    rt_free(runners);
    return status;
}
