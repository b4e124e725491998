/* SPDX-License-Identifier: Apache-2.0 */
#include "measure/rounds.h"

#include "core/base/clock.h"
#include "core/base/memory.h"
#include "core/base/random.h"

#include <assert.h>
#include <math.h>

enum { MOST_REPEATS = 1000000 };

RtStatus rt_runner_time(const RtRunner *runner, uint32_t repeats, double *seconds, double *wall,
                        RtError *error) {
    if (runner->time) return runner->time(runner->context, repeats, seconds, wall, error);
    double processor_start = rt_thread_seconds(), wall_start = rt_wall_seconds();
    for (uint32_t i = 0; i < repeats; i++) RT_TRY(runner->run(runner->context, error));
    *wall = rt_wall_seconds() - wall_start;
    *seconds = runner->parallel ? *wall : rt_thread_seconds() - processor_start;
    return RT_OK;
}

uint32_t rt_runner_repeats(double seconds, double least) {
    return (uint32_t)fmin(fmax(ceil(least / fmax(seconds, 1e-9)), 1), MOST_REPEATS);
}

/* Takes a tenth of the least round, a hundredth of ten rounds, and extrapolates to a whole run. */
static RtStatus warm_one(const RtRunner *runner, double least, double *seconds, RtError *error) {
    double wall, part = 1, start = rt_thread_seconds();
    if (!runner->warm || runner->parallel) return rt_runner_time(runner, 1, seconds, &wall, error);
    RT_TRY(runner->warm(runner->context, 0.1 * least, &part, error));
    *seconds = (rt_thread_seconds() - start) / part;
    return RT_OK;
}

/* Whether a runner that returned `status` is excluded from now on. */
static bool becomes_broken(const RtRunner *runner, RtStatus status) {
    if (status != RT_BROKEN || !runner->broken) return false;
    *runner->broken = true;
    return true;
}

static bool is_excluded(const RtRunner *runner) {
    return runner->broken && *runner->broken;
}

/* Loads code and data into the caches, and finds how often each must run to last `least` seconds. */
static RtStatus warm_up(RtRunner *runners, size_t count, double least, RtError *error) {
    for (size_t i = 0; i < count; i++) {
        double seconds;
        if (is_excluded(&runners[i])) continue;
        RtStatus status = warm_one(&runners[i], least, &seconds, error);
        if (becomes_broken(&runners[i], status)) continue;
        RT_TRY(status);
        runners[i].repeats = rt_runner_repeats(seconds, least);
    }
    return RT_OK;
}

static RtStatus run_rounds(RtRunner *runners, size_t *order, size_t count, const RtRounds *rounds,
                           uint32_t *done, RtError *error) {
    RtRandom random = rt_random(rounds->seed, 0);
    for (size_t i = 0; i < count; i++) order[i] = i;
    RT_TRY(warm_up(runners, count, rounds->least, error));
    for (uint32_t round = 0; round < rounds->most; round++) {
        if (round >= rounds->rounds && (!rounds->enough || rounds->enough(rounds->context, round))) break;
        rt_random_shuffle(&random, order, count);
        for (size_t i = 0; i < count; i++) {
            RtRunner *runner = &runners[order[i]];
            double seconds, wall, work = runner->repeats * runner->work;
            if (is_excluded(runner)) continue;
            RtStatus status = rt_runner_time(runner, runner->repeats, &seconds, &wall, error);
            if (becomes_broken(runner, status)) continue;
            RT_TRY(status);
            runner->seconds[round] = seconds / work;
            if (seconds < rounds->least) /* the extrapolation was wrong */
                runner->repeats = rt_runner_repeats(seconds / runner->repeats, rounds->least);
            if (runner->wall) runner->wall[round] = wall / work;
        }
        *done = round + 1;
    }
    return RT_OK;
}

RtStatus rt_rounds_run(RtRunner *runners, size_t count, const RtRounds *rounds, uint32_t *done,
                       RtError *error) {
    assert(rounds->rounds >= 1 && rounds->rounds <= rounds->most && rounds->most <= RT_MAX_ROUNDS);
    size_t *order = rt_alloc(count, sizeof(size_t));
    if (!order) return rt_fail_memory(error, "the rounds", count * sizeof(size_t));
    RtStatus status = run_rounds(runners, order, count, rounds, done, error);
    rt_free(order);
    return status;
}
